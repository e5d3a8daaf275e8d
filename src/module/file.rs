//! The shape of a definition file as it is written; [`super::check`] turns it into a [`super::Definition`].

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::definition::{Applies, Encoding, Field};

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    pub id: Spanned<String>,
    pub label: String,
    /// May be left out where `based_on` brings it.
    #[serde(default)]
    pub manual: String,
    /// The definition that this one completes and overrides, item by item.
    pub based_on: Option<String>,
    #[serde(default)]
    pub identity: Identity,
    #[serde(default)]
    pub optional: Vec<Optional>,
    #[serde(default)]
    pub command: Vec<Command>,
    #[serde(default)]
    pub parameter: Vec<Item>,
    #[serde(default)]
    pub reading: Vec<Item>,
    #[serde(default)]
    pub action: Vec<Action>,
    #[serde(default)]
    pub dip: Vec<Bank>,
    pub rotary: Option<Rotary>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    #[serde(default)]
    pub dcon: Vec<String>,
    #[serde(default)]
    pub words: Vec<NameWords>,
    #[serde(default)]
    pub bytes: Vec<NameBytes>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NameWords {
    pub low: u16,
    pub high: u16,
    pub name: String,
    #[serde(default)]
    pub needs: Vec<u16>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NameBytes {
    pub bytes: Vec<u8>,
    pub name: String,
    #[serde(default)]
    pub needs: Vec<u16>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Optional {
    pub id: Spanned<String>,
    pub label: String,
    pub probe: Modbus,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Command {
    pub id: Spanned<String>,
    pub title: String,
    #[serde(default)]
    pub source: String,
    #[serde(default)]
    pub note: String,
    pub function: Option<u8>,
    pub read: Option<String>,
    #[serde(default)]
    pub answer: Vec<String>,
    pub write: Option<String>,
    #[serde(default)]
    pub fields: BTreeMap<String, Field>,
    /// `{ V = "O" }`: another field; `{ N = "address" }`; `{ T = "=40" }`: a constant.
    #[serde(default)]
    pub filled_from: BTreeMap<String, String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Item {
    pub id: Spanned<String>,
    pub label: String,
    pub help: String,
    #[serde(default)]
    pub unit: String,
    pub tab: String,
    #[serde(rename = "type")]
    pub kind: Kind,
    pub range: Option<[f64; 2]>,
    /// Allowed outside the range too.
    #[serde(default)]
    pub also: Vec<f64>,
    #[serde(default)]
    pub decimals: u8,
    #[serde(default)]
    pub choices: Vec<Choice>,
    pub max_length: Option<usize>,
    #[serde(default)]
    pub applies: Applies,
    #[serde(default)]
    pub read_only: bool,
    #[serde(default)]
    pub live: bool,
    #[serde(default)]
    pub on_request: bool,
    #[serde(default)]
    pub secret: bool,
    pub factory: Option<toml::Value>,
    pub optional: Option<String>,
    #[serde(default)]
    pub source: String,
    /// Where manual and reality may differ, and what was decided.
    #[serde(default)]
    #[allow(dead_code, reason = "written for the reader of the file")]
    pub doubt: String,
    #[serde(default)]
    pub dcon: Vec<Place>,
    #[serde(default)]
    pub modbus: Vec<Modbus>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Bool,
    Number,
    Choice,
    Text,
    Ipv4,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    pub value: toml::Value,
    pub label: Option<String>,
    /// The code in both protocols.
    pub code: Option<u32>,
    #[serde(default)]
    pub dcon: Vec<u32>,
    #[serde(default)]
    pub modbus: Vec<u32>,
    pub dcon_write: Option<String>,
}

/// A field of a command.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    pub command: String,
    pub field: String,
    pub index: Option<usize>,
    pub bits: Option<String>,
    #[serde(default)]
    pub inverted: bool,
    #[serde(default, rename = "as")]
    pub encoding: Encoding,
}

/// Coils, registers, or a field of a non-standard function's command.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Modbus {
    pub coil: Option<u16>,
    /// `"262-263"`: read together, the first is bit 0.
    pub coils: Option<String>,
    pub register: Option<u16>,
    /// `"694-709"`.
    pub registers: Option<String>,
    /// Read by function 04 instead of 03; such a register is read only.
    #[serde(default)]
    pub input: bool,
    pub command: Option<String>,
    pub field: Option<String>,
    pub bits: Option<String>,
    #[serde(default)]
    pub inverted: bool,
    #[serde(default)]
    pub signed: bool,
    /// Raw numbers, where this way takes fewer than the item's `range`.
    pub range: Option<[i64; 2]>,
    #[serde(default, rename = "as")]
    pub encoding: Encoding,
    /// Only over `"rtu"` or only over `"tcp"`.
    pub only: Option<Only>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Only {
    Rtu,
    Tcp,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Action {
    pub id: Spanned<String>,
    pub label: String,
    pub help: String,
    pub tab: String,
    #[serde(default)]
    pub confirm: bool,
    pub optional: Option<String>,
    pub dcon: Option<String>,
    pub modbus: Option<Modbus>,
    #[serde(default)]
    pub source: String,
}

/// A bank of DIP switches.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bank {
    pub id: Spanned<String>,
    pub label: String,
    /// What comes before a position's number in a sentence.
    pub name: String,
    pub positions: u8,
    #[serde(default)]
    #[allow(dead_code, reason = "written for the reader of the file")]
    pub source: String,
    #[serde(default)]
    #[allow(dead_code, reason = "written for the reader of the file")]
    pub doubt: String,
    #[serde(default)]
    pub group: Vec<Group>,
    /// Comes from the definition that the file is based on.
    #[serde(skip)]
    pub inherited: bool,
}

/// Positions of a bank that mean something together.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// `"4"` or `"5-7"`.
    pub positions: Spanned<String>,
    pub label: String,
    pub help: String,
    /// Counts whatever the switch with `switches_rule` says.
    #[serde(default)]
    pub always: bool,
    #[serde(default)]
    #[allow(dead_code, reason = "written for the reader of the file")]
    pub doubt: String,
    #[serde(default)]
    pub rows: Vec<Row>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// `"on off off"`, lowest position first.
    pub set: Spanned<String>,
    pub means: String,
    #[serde(default)]
    pub factory: bool,
    /// Whether the other switches are in force.
    pub switches_rule: Option<bool>,
    /// Values by item id; for a number also `"160-175"`.
    #[serde(default)]
    pub when: BTreeMap<String, toml::Value>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rotary {
    pub label: Spanned<String>,
    pub help: String,
    /// The item that is one of `first` plus the position.
    pub item: String,
    pub first: Vec<i64>,
    #[serde(default)]
    #[allow(dead_code, reason = "written for the reader of the file")]
    pub source: String,
    /// Comes from the definition that the file is based on.
    #[serde(skip)]
    pub inherited: bool,
}
