//! Finding out, with reads only, which module answers at an address.

use std::sync::Arc;

use super::access::{self, raw_words};
use super::catalogue::Catalogue;
use super::definition::Definition;
use super::read::read_items;
use super::{Ask, Value};
use crate::protocol::modbus::MODULE_SETTINGS;
use crate::protocol::{Failure, Protocol, Query, Reply};

/// 40481 to 40484 on the wire: firmware and name (both manuals, Modbus address mapping).
const IDENTITY_REGISTERS: Query = Query::ReadHoldingRegisters { first: 480, count: 4 };

/// Who answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// `None` if no definition fits.
    pub definition: Option<Arc<Definition>>,
    /// As the module calls itself; raw words where no definition knows them, empty if it told nothing.
    pub name: String,
    /// Empty if it told nothing.
    pub firmware: String,
    /// What an unknown module said, for a person to judge.
    pub said: String,
}

impl Identified {
    /// The public name of the model: a definition's id, or `unknown`.
    pub fn model(&self) -> &str {
        self.definition.as_ref().map_or("unknown", |definition| definition.id.as_str())
    }

    fn unknown(name: String, said: String) -> Self {
        Self { definition: None, name, firmware: String::new(), said }
    }
}

/// Asks the module at `address` what it is. An error means that nothing there answered in a readable way;
/// a refusal is an answer, and its module is `unknown` unless it tells its name in another way.
pub fn identify(
    catalogue: &Catalogue,
    protocol: Protocol,
    address: u8,
    ask: &mut dyn Ask,
) -> Result<Identified, Failure> {
    let found = match protocol {
        Protocol::Dcon => dcon_identity(catalogue, address, ask)?,
        Protocol::ModbusRtu | Protocol::ModbusTcp => modbus_identity(catalogue, protocol, ask)?,
    };
    let Some(definition) = found.definition.clone() else { return Ok(found) };
    let mut found = found;
    for answer in read_items(&definition, protocol, address, ["firmware"], ask) {
        if let (true, Ok(Value::Text(firmware))) = (answer.id == "firmware", answer.result) {
            found.firmware = firmware;
        }
    }
    Ok(found)
}

/// The question that opens an address: its module's name.
pub(super) fn first_question(protocol: Protocol, address: u8) -> Query {
    match protocol {
        Protocol::Dcon => {
            Query::Dcon { text: format!("${address:02X}M"), from: access::answer_from(address), write: false }
        }
        Protocol::ModbusRtu | Protocol::ModbusTcp => IDENTITY_REGISTERS,
    }
}

fn dcon_identity(catalogue: &Catalogue, address: u8, ask: &mut dyn Ask) -> Result<Identified, Failure> {
    let answer = match ask.ask(&first_question(Protocol::Dcon, address)) {
        Ok(Reply::Text(answer)) => answer,
        Ok(other) => return Ok(Identified::unknown(String::new(), format!("{other:?}"))),
        Err(failure) if failure.shows_presence() => {
            return Ok(Identified::unknown(String::new(), failure.to_string()));
        }
        Err(failure) => return Err(failure),
    };
    let name = answer.get(3..).unwrap_or_default().trim().to_owned();
    let definition = catalogue
        .iter()
        .find(|definition| definition.identity.dcon_names.iter().any(|known| known.eq_ignore_ascii_case(&name)));
    Ok(Identified { definition: definition.cloned(), name, firmware: String::new(), said: answer })
}

fn modbus_identity(catalogue: &Catalogue, protocol: Protocol, ask: &mut dyn Ask) -> Result<Identified, Failure> {
    let refusal = match ask.ask(&IDENTITY_REGISTERS) {
        Ok(Reply::Words(words)) => {
            let name_words = words.get(2..).unwrap_or_default();
            if let Some((definition, name)) = by_words(catalogue, name_words, ask)? {
                return Ok(named(definition, name));
            }
            raw_words(&words)
        }
        Ok(other) => format!("{other:?}"),
        Err(failure) if failure.shows_presence() => failure.to_string(),
        Err(failure) => return Err(failure),
    };
    if protocol == Protocol::ModbusRtu {
        let told = ask.ask(&Query::Custom { function: MODULE_SETTINGS, data: vec![0], write: false });
        if let Some(Reply::Bytes(bytes)) = unless_unreadable(told)?
            && let Some((definition, name)) = by_bytes(catalogue, bytes.get(1..).unwrap_or_default(), ask)?
        {
            return Ok(named(definition, name));
        }
    }
    let name = if refusal.starts_with("0x") { refusal.clone() } else { String::new() };
    Ok(Identified::unknown(name, refusal))
}

fn named(definition: Arc<Definition>, name: String) -> Identified {
    Identified { definition: Some(definition), name, firmware: String::new(), said: String::new() }
}

/// A model and how the module calls it.
type Named = (Arc<Definition>, String);

fn by_words(catalogue: &Catalogue, words: &[u16], ask: &mut dyn Ask) -> Result<Option<Named>, Failure> {
    let candidates =
        catalogue.iter().flat_map(|definition| definition.identity.words.iter().map(move |known| (definition, known)));
    for (definition, known) in candidates {
        if words == [known.low, known.high] && all_answer(&known.needs, ask)? {
            return Ok(Some((definition.clone(), known.name.clone())));
        }
    }
    Ok(None)
}

fn by_bytes(catalogue: &Catalogue, bytes: &[u8], ask: &mut dyn Ask) -> Result<Option<Named>, Failure> {
    let candidates =
        catalogue.iter().flat_map(|definition| definition.identity.bytes.iter().map(move |known| (definition, known)));
    for (definition, known) in candidates {
        if bytes == known.bytes && all_answer(&known.needs, ask)? {
            return Ok(Some((definition.clone(), known.name.clone())));
        }
    }
    Ok(None)
}

/// Whether each of these 1-based holding registers is there.
fn all_answer(registers: &[u16], ask: &mut dyn Ask) -> Result<bool, Failure> {
    for register in registers {
        match ask.ask(&Query::ReadHoldingRegisters { first: register.saturating_sub(1), count: 1 }) {
            Ok(_) => {}
            Err(failure) if failure.shows_presence() => return Ok(false),
            // A module refuses registers that it has not; silence is the line's.
            Err(failure) => return Err(failure),
        }
    }
    Ok(true)
}

/// `None` if the module says no or nothing. An answer that was damaged or late says neither yes nor no.
fn unless_unreadable(answer: Result<Reply, Failure>) -> Result<Option<Reply>, Failure> {
    match answer {
        Ok(reply) => Ok(Some(reply)),
        Err(failure) if failure.is_garbage() || matches!(failure, Failure::LineLost(_)) => Err(failure),
        Err(_) => Ok(None),
    }
}
