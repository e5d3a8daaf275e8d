//! What a request may do, told before it is sent.

use std::fmt;

use super::super::definition::Definition;
use super::commands::{self, Form};
use super::{dcon, modbus};
use crate::protocol::Protocol;

/// Why a request should not be sent without a thought. What reads only is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Danger {
    /// Heard by every module; `what` it does, empty if unknown.
    Broadcast { what: String },
    /// Changes the module.
    Writes { what: String },
    /// It may change the module: nobody knows; `why`.
    Unknown { why: String },
}

impl fmt::Display for Danger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Broadcast { what } if what.is_empty() => f.write_str("Heard by every module on the line"),
            Self::Broadcast { what } => write!(f, "Heard by every module on the line: {what}"),
            Self::Writes { what } => write!(f, "Changes the module: {what}"),
            Self::Unknown { why } => write!(f, "May change the module: {why}"),
        }
    }
}

/// Judges a request, given as it goes over the wire (the carriage return may be missing). `None` if it only reads.
pub fn danger(definition: Option<&Definition>, protocol: Protocol, checksum: bool, request: &[u8]) -> Option<Danger> {
    match protocol {
        Protocol::Dcon => of_command(definition, &dcon::Text::of(request, checksum).text),
        Protocol::ModbusRtu | Protocol::ModbusTcp => modbus::danger(definition, protocol, request),
    }
}

fn of_command(definition: Option<&Definition>, text: &str) -> Option<Danger> {
    let known = definition.and_then(|definition| commands::recognise(definition, None, text));
    if dcon::is_broadcast(text) {
        return Some(Danger::Broadcast { what: known.map(|known| known.title).unwrap_or_default() });
    }
    match known {
        Some(known) if known.form == Form::Read => None,
        Some(known) => Some(Danger::Writes { what: known.title }),
        None if dcon::is_identification(text) => None,
        None => Some(unknown(definition, "this command")),
    }
}

/// `what` is not in the definition, or there is none.
pub fn unknown(definition: Option<&Definition>, what: &str) -> Danger {
    let why = match definition {
        Some(definition) => format!("the definition of the {} does not know {what}", definition.label),
        None => format!("without a definition of the module nobody knows what {what} does"),
    };
    Danger::Unknown { why }
}
