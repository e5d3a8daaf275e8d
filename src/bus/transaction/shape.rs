//! What tells the answers of one question from those of another.

use crate::bus::judge::Expected;
use crate::bus::target::Target;
use crate::protocol::{AnswerFrom, Protocol, Query, dcon};

/// A question as seen from its answer: who is asked, and what the answer carries that shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Rtu {
        address: u8,
        function: u8,
    },
    Dcon {
        /// `None` if the request does not tell whom it asks.
        address: Option<u8>,
        carries: Carries,
        checksum: bool,
        /// It sets an output, which may be answered by a lone `!`, whoever says it.
        output: bool,
    },
}

/// How a DCON answer shows whose it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carries {
    /// By the address that it begins with.
    Address,
    /// By nothing: it is data behind a `>`, as every answer to a `#` command.
    Data,
    /// Not known.
    Anything,
}

impl Shape {
    /// `None` if nobody answers.
    pub fn of_request(request: &[u8], expected: &Expected) -> Option<Self> {
        match expected {
            Expected::Nothing { .. } => None,
            Expected::Rtu { address } => {
                Some(Self::Rtu { address: *address, function: request.get(1).copied().unwrap_or_default() })
            }
            Expected::Dcon { from, checksum, .. } => Some(Self::dcon(request, from, *checksum)),
        }
    }

    /// Some question to `target`, for comparing whom others ask; `None` if it is not on a serial line.
    pub fn of_module(target: &Target) -> Option<Self> {
        let Target { address, checksum, .. } = *target;
        match target.protocol {
            Protocol::ModbusRtu => Some(Self::Rtu { address, function: 0 }),
            Protocol::Dcon => {
                Some(Self::Dcon { address: Some(address), carries: Carries::Address, checksum, output: false })
            }
            Protocol::ModbusTcp => None,
        }
    }

    /// The shape that `query` to `target` will have on a serial line; `None` if nobody answers.
    pub fn of_query(target: &Target, query: &Query) -> Option<Self> {
        let function = match query {
            Query::Dcon { from: AnswerFrom::Nobody, .. } => return None,
            Query::Dcon { text, from, .. } => return Some(Self::dcon(text.as_bytes(), from, target.checksum)),
            Query::ReadCoils { .. } => 0x01,
            Query::ReadHoldingRegisters { .. } => 0x03,
            Query::ReadInputRegisters { .. } => 0x04,
            Query::WriteCoil { .. } => 0x05,
            Query::WriteRegister { .. } => 0x06,
            Query::WriteCoils { .. } => 0x0F,
            Query::WriteRegisters { .. } => 0x10,
            Query::Custom { function, .. } => *function,
        };
        (target.protocol == Protocol::ModbusRtu).then_some(Self::Rtu { address: target.address, function })
    }

    fn dcon(request: &[u8], from: &AnswerFrom, checksum: bool) -> Self {
        let carries = match from {
            AnswerFrom::Addresses(_) => Carries::Address,
            _ if request.first() == Some(&b'#') => Carries::Data,
            _ => Carries::Anything,
        };
        Self::Dcon { address: spoken_to(request), carries, checksum, output: sets_output(request) }
    }

    /// The module that is asked.
    pub fn address(self) -> Option<u8> {
        match self {
            Self::Rtu { address, .. } => Some(address),
            Self::Dcon { address, .. } => address,
        }
    }

    /// The DCON module that is asked, and whether with checksum.
    pub fn dcon_module(self) -> Option<(u8, bool)> {
        match self {
            Self::Dcon { address, checksum, .. } => Some((address?, checksum)),
            Self::Rtu { .. } => None,
        }
    }

    /// Whether the answer says no: all such answers have the same length.
    pub fn is_exception(self, answer: &[u8]) -> bool {
        matches!(self, Self::Rtu { .. }) && answer.get(1).is_some_and(|function| function & 0x80 != 0)
    }

    /// Whether something in `bytes` looks like the beginning of an answer to this `request`, and of nothing else.
    pub fn begins_an_answer_in(self, request: &[u8], bytes: &[u8]) -> bool {
        match self {
            Self::Rtu { address, function } => {
                let bytes = behind_echo(request, bytes);
                let wanted = wanted_bytes(request);
                bytes.windows(3).any(|begin| match begin {
                    [from, with, next] if *from == address => {
                        let refusal = *with == function | 0x80;
                        refusal || (*with == function && wanted.is_none_or(|wanted| usize::from(*next) == wanted))
                    }
                    _ => false,
                })
            }
            Self::Dcon { carries: Carries::Address, address: Some(address), .. } => {
                let digits = format!("{address:02X}");
                bytes.windows(3).any(|begin| {
                    begin.first().is_some_and(|byte| dcon::ANSWER_DELIMITERS.contains(byte))
                        && begin.get(1..) == Some(digits.as_bytes())
                })
            }
            // Without an address it could be that of any module.
            Self::Dcon { .. } => false,
        }
    }

    /// Whether the same module is asked in the same protocol.
    pub fn asks_whom(self, other: Self) -> bool {
        let same_protocol = matches!(self, Self::Rtu { .. }) == matches!(other, Self::Rtu { .. });
        same_protocol && self.address().is_some() && self.address() == other.address()
    }

    /// Whether an answer to this carries the address of a module that `other` does not ask: wherever it comes, it shows that
    /// it belongs elsewhere.
    pub fn shows_another_than(self, other: Self) -> bool {
        match (self, other) {
            (
                Self::Dcon { address: Some(address), carries: Carries::Address, output, .. },
                Self::Dcon { address: Some(asked), output: sets_output, .. },
            ) => address != asked && !(output && sets_output),
            _ => false,
        }
    }

    /// Whether `answer` begins as one to this does that carries its address.
    pub fn stands_in_front_of(self, answer: &[u8]) -> bool {
        let Self::Dcon { address: Some(address), .. } = self else { return false };
        answer.get(1..3) == Some(format!("{address:02X}").as_bytes())
    }

    /// Whether an answer to this question could be taken for one to `other`.
    pub fn could_answer(self, other: Self) -> bool {
        match (self, other) {
            (Self::Rtu { .. }, Self::Rtu { .. }) => self == other,
            (
                Self::Dcon { address, carries, checksum, output },
                Self::Dcon { address: asked, carries: awaited, checksum: with_checksum, output: sets_output },
            ) => {
                let fits = match (carries, awaited) {
                    (_, Carries::Anything) | (Carries::Anything, _) | (Carries::Data, Carries::Data) => true,
                    (Carries::Address, Carries::Data) | (Carries::Data, Carries::Address) => false,
                    (Carries::Address, Carries::Address) => address == asked || address.is_none() || asked.is_none(),
                };
                // An answer with checksum passes where none is looked for.
                (!with_checksum || checksum) && (fits || (output && sets_output))
            }
            _ => false,
        }
    }
}

/// `@AADO…` (PIR-234 manual 5.26, whose answer to an ignored command is a lone `!`).
fn sets_output(request: &[u8]) -> bool {
    request.first() == Some(&b'@') && request.get(3..5) == Some(b"DO")
}

/// The address that stands in a DCON command.
fn spoken_to(request: &[u8]) -> Option<u8> {
    let digits = request.get(1..3).and_then(|digits| std::str::from_utf8(digits).ok())?;
    u8::from_str_radix(digits, 16).ok()
}

/// `bytes` without a beginning that is the request's, and more than an answer shares with it: an echo that broke off.
fn behind_echo<'a>(request: &[u8], bytes: &'a [u8]) -> &'a [u8] {
    let shared = request.iter().zip(bytes).take_while(|(sent, came)| sent == came).count();
    if shared > SHARED_WITH_REQUEST { bytes.get(shared..).unwrap_or_default() } else { bytes }
}

/// Address, function, and by chance one more byte.
const SHARED_WITH_REQUEST: usize = 3;

/// How many bytes the answer counts, which functions 01 and 02 ask for in bits, 03 and 04 in words; `None` for others.
fn wanted_bytes(request: &[u8]) -> Option<usize> {
    let count = |high: &u8, low: &u8| usize::from(u16::from_be_bytes([*high, *low]));
    match request {
        [_, 0x01 | 0x02, _, _, high, low, ..] => Some(count(high, low).div_ceil(8)),
        [_, 0x03 | 0x04, _, _, high, low, ..] => Some(count(high, low).saturating_mul(2)),
        _ => None,
    }
}

/// Whether the answers to two requests of the same shape have the same length.
pub fn want_equally_much(request: &[u8], other: &[u8]) -> bool {
    wanted_bytes(request) == wanted_bytes(other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_is_asked_is_found_by_the_module_in_either_protocol() {
        let name = Query::Dcon { text: "$01M".to_owned(), from: AnswerFrom::Addresses(vec![1]), write: false };
        let coils = Query::ReadCoils { first: 0, count: 1 };
        let target = |protocol| Target { address: 1, protocol, settings: Default::default(), checksum: false };
        for (protocol, query) in [(Protocol::Dcon, &name), (Protocol::ModbusRtu, &coils)] {
            let module = Shape::of_module(&target(protocol)).unwrap();
            let other = if protocol == Protocol::Dcon { Protocol::ModbusRtu } else { Protocol::Dcon };
            assert!(module.asks_whom(Shape::of_query(&target(protocol), query).unwrap()), "{protocol:?}");
            assert!(!module.asks_whom(Shape::of_module(&target(other)).unwrap()), "{protocol:?}");
        }
    }
}
