//! What a frame means, in the words of its protocol and, where the module is known, of its definition. Pure.
//!
//! Frames are taken as they are on the wire, with carriage return, checksum, CRC or MBAP header. Nothing is trusted: what
//! is broken is explained as far as it goes, and said to be broken.

mod commands;
mod danger;
mod dcon;
mod modbus;
mod places;

pub use danger::{Danger, danger};

use super::Item;
use super::definition::Definition;
use super::value::Value;
use crate::protocol::Protocol;

/// The meaning of one frame.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Explanation {
    /// One line.
    pub summary: String,
    /// The frame's parts, in order.
    pub fields: Vec<ExplainedField>,
    /// What a person should know before the frame is sent; of requests only.
    pub danger: Option<Danger>,
}

/// One part of a frame.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ExplainedField {
    /// As the manuals call it: `CC`, `function`, `register 486 (wire 485)`.
    pub name: String,
    /// As it is in the frame.
    pub raw: String,
    /// Empty if there is nothing to say beyond `raw`.
    pub meaning: String,
}

impl ExplainedField {
    fn new(name: impl Into<String>, raw: impl Into<String>, meaning: impl Into<String>) -> Self {
        Self { name: name.into(), raw: raw.into(), meaning: meaning.into() }
    }
}

/// Explains `answer`, or the request if there is none. Without a definition only the protocol's own structure is told;
/// without the request (an empty one) the same holds for an answer. `checksum` tells whether DCON frames carry one.
pub fn explain(
    definition: Option<&Definition>,
    protocol: Protocol,
    checksum: bool,
    request: &[u8],
    answer: Option<&[u8]>,
) -> Explanation {
    match (protocol, answer) {
        (_, Some([])) => Explanation { summary: "No answer".to_owned(), ..Explanation::default() },
        (Protocol::Dcon, Some(answer)) => dcon::answer(definition, checksum, request, answer),
        (Protocol::Dcon, None) => {
            let danger = danger(definition, protocol, checksum, request);
            Explanation { danger, ..dcon::request(definition, checksum, request) }
        }
        (_, Some(answer)) => modbus::answer(definition, protocol, request, answer),
        (_, None) => {
            let danger = danger(definition, protocol, checksum, request);
            Explanation { danger, ..modbus::request(definition, protocol, request) }
        }
    }
}

/// `baud_rate 9600 bps`, `data_format n81`.
fn named(item: &Item, value: &Value) -> String {
    let number = match value {
        Value::Bool(_) | Value::Text(_) => false,
        value => value.as_f64().is_some(),
    };
    let unit = if number && !item.unit.is_empty() { format!(" {}", item.unit) } else { String::new() };
    format!("{} {value}{unit}", item.id)
}

/// `summary: a, b`, or `summary` alone.
fn with_details(summary: &str, details: &[String]) -> String {
    if details.is_empty() { summary.to_owned() } else { format!("{summary}: {}", details.join(", ")) }
}

#[cfg(test)]
mod tests;
