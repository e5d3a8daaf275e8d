//! Which model each module of a capture is, by what it said of itself.

use std::collections::BTreeMap;
use std::sync::Arc;

use jiff::Timestamp;

use crate::bus::{Frame, Verdict};
use crate::module::{Ask, Catalogue, Definition, identify};
use crate::protocol::modbus::MODULE_SETTINGS;
use crate::protocol::{Failure, Protocol, Query, Reply};

const READ_HOLDING_REGISTERS: u8 = 3;
/// Registers that are read to tell models apart, at most.
const MOST_REGISTERS: u16 = 4;
/// Bytes before the unit in a frame of Modbus TCP.
const MBAP: usize = 6;

/// The models of the modules on the line.
pub(super) struct Models {
    catalogue: Arc<Catalogue>,
    /// That of all modules, where the user knows it.
    given: Option<Arc<Definition>>,
    modules: BTreeMap<(u8, Protocol), Told>,
}

/// What one module has said.
#[derive(Default)]
struct Told {
    name: Option<String>,
    registers: BTreeMap<(u16, u16), Vec<u16>>,
    settings: Option<Vec<u8>>,
    definition: Option<Arc<Definition>>,
}

impl Models {
    pub fn new(catalogue: Arc<Catalogue>, given: Option<Arc<Definition>>) -> Self {
        Self { catalogue, given, modules: BTreeMap::new() }
    }

    /// The definition of the module that was asked or answers.
    pub fn of(&self, frame: &Frame) -> Option<&Definition> {
        let told = frame.address.and_then(|address| self.modules.get(&(address, frame.protocol)));
        self.given.as_deref().or_else(|| told.and_then(|told| told.definition.as_deref()))
    }

    /// Takes in an exchange.
    pub fn learn(&mut self, request: &Frame, answer: &Frame) {
        let (Some(address), Verdict::Answer) = (request.address, &answer.verdict) else { return };
        if self.given.is_some() {
            return;
        }
        let received = answer.bytes.strip_prefix(&*request.bytes).filter(|_| answer.echo).unwrap_or(&answer.bytes);
        let told = self.modules.entry((address, request.protocol)).or_default();
        let is_new = match request.protocol {
            Protocol::Dcon => told.dcon(&request.bytes, received),
            Protocol::ModbusRtu => told.modbus(&request.bytes, received).is_some(),
            Protocol::ModbusTcp => {
                let unit = |bytes: &[u8]| bytes.get(MBAP..).unwrap_or_default().to_vec();
                told.modbus(&unit(&request.bytes), &unit(received)).is_some()
            }
        };
        if is_new && let Ok(found) = identify(&self.catalogue, request.protocol, address, told) {
            told.definition = found.definition.or(told.definition.take());
        }
    }
}

impl Told {
    /// True if this was the question for the name.
    fn dcon(&mut self, request: &[u8], answer: &[u8]) -> bool {
        let is_name = request.first() == Some(&b'$') && request.get(3) == Some(&b'M');
        let text = String::from_utf8_lossy(answer).trim_end_matches('\r').to_owned();
        if is_name {
            self.name = Some(text);
        }
        is_name
    }

    /// Both begin with the address. `Some` if this tells something of the model.
    fn modbus(&mut self, request: &[u8], answer: &[u8]) -> Option<()> {
        match *request.get(1)? {
            READ_HOLDING_REGISTERS => {
                let (first, rest) = request.get(2..)?.split_first_chunk::<2>()?;
                let (first, count) = (u16::from_be_bytes(*first), u16::from_be_bytes(*rest.first_chunk()?));
                let words = answer.get(3..)?.get(..usize::from(count).checked_mul(2)?)?;
                if count > MOST_REGISTERS {
                    return None;
                }
                let words =
                    words.chunks_exact(2).map(|pair| pair.iter().fold(0, |word, byte| word << 8 | u16::from(*byte)));
                self.registers.insert((first, count), words.collect());
            }
            MODULE_SETTINGS if request.get(2) == Some(&0) => {
                let data = answer.get(2..answer.len().checked_sub(2)?)?;
                self.settings = Some(data.to_vec());
            }
            _ => return None,
        }
        Some(())
    }
}

/// Answers as the module did in the capture.
impl Ask for Told {
    fn ask(&mut self, query: &Query) -> Result<Reply, Failure> {
        let reply = match query {
            Query::Dcon { text, .. } if text.ends_with('M') => self.name.clone().map(Reply::Text),
            Query::ReadHoldingRegisters { first, count } => {
                self.registers.get(&(*first, *count)).cloned().map(Reply::Words)
            }
            Query::Custom { function: MODULE_SETTINGS, data, .. } if *data == [0] => {
                self.settings.clone().map(Reply::Bytes)
            }
            _ => None,
        };
        // Whoever answers an identity exchange is there: the others may still tell the model.
        reply.ok_or(Failure::UnknownShape { answer: String::new() })
    }

    fn answered_at(&self) -> Timestamp {
        Timestamp::UNIX_EPOCH
    }

    fn follow(&mut self, _address: u8) {}
}
