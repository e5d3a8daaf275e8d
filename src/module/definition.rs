//! A module's definition, checked: what the rest of the program works with.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::notation::Template;
use super::switches::SwitchLayout;
use super::value::{Fixed, Value, ValueError};
use crate::protocol::Protocol;

/// Everything that is known of one model.
#[derive(Debug, Clone, PartialEq)]
pub struct Definition {
    /// `pir-234`: the public name of the model.
    pub id: String,
    /// The name for people.
    pub label: String,
    /// Which manual the definition was written from.
    pub manual: String,
    pub identity: Identity,
    /// Parts that only some modules of the model have, found by asking.
    pub optional: Vec<Optional>,
    pub commands: Vec<Command>,
    pub items: Vec<Item>,
    pub actions: Vec<Action>,
    /// DIP and rotary switches; empty where the file describes none.
    pub switch_layout: SwitchLayout,
}

impl Definition {
    pub fn item(&self, id: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.id == id)
    }

    pub fn action(&self, id: &str) -> Option<&Action> {
        self.actions.iter().find(|action| action.id == id)
    }

    /// The items that `protocol` offers, in the order of the file.
    pub fn items_over(&self, protocol: Protocol) -> impl Iterator<Item = &Item> {
        self.items.iter().filter(move |item| item.is_offered(protocol))
    }

    /// What is read again and again while the module is watched.
    pub fn live_items(&self, protocol: Protocol) -> impl Iterator<Item = &Item> {
        self.items_over(protocol).filter(|item| item.live)
    }
}

/// How a module says what it is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Identity {
    /// Answers to `$AAM`.
    pub dcon_names: Vec<String>,
    /// Words of registers 40483 and 40484 with the name they stand for.
    pub words: Vec<NameWords>,
    /// Answers to function 0x46 sub-function 00.
    pub bytes: Vec<NameBytes>,
}

impl Identity {
    /// Whether some module could be either.
    pub fn names_overlap(&self, other: &Self) -> bool {
        let by_name =
            self.dcon_names.iter().any(|name| other.dcon_names.iter().any(|known| known.eq_ignore_ascii_case(name)));
        let same = |a: &NameWords, b: &NameWords| (a.low, a.high) == (b.low, b.high);
        let by_words = self.words.iter().any(|words| other.words.iter().any(|known| same(words, known)));
        by_name || by_words
    }
}

/// Name registers (low word first) and what they mean.
#[derive(Debug, Clone, PartialEq)]
pub struct NameWords {
    pub low: u16,
    pub high: u16,
    pub name: String,
    /// 1-based holding registers that have to answer too, where the words alone are not unique.
    pub needs: Vec<u16>,
}

/// Name bytes of function 0x46 and what they mean.
#[derive(Debug, Clone, PartialEq)]
pub struct NameBytes {
    pub bytes: Vec<u8>,
    pub name: String,
    pub needs: Vec<u16>,
}

/// A part of the module that is there if its probe is answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Optional {
    pub id: String,
    pub label: String,
    pub probe: ModbusPlace,
}

/// One command of the manual: how to read, what comes back, how to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    pub id: String,
    pub title: String,
    /// Sections of the manual.
    pub source: String,
    /// `None` for DCON, the function code for a non-standard Modbus function.
    pub function: Option<u8>,
    pub read: Option<Template>,
    pub answers: Vec<Template>,
    pub write: Option<Template>,
    pub fields: BTreeMap<String, Field>,
    /// Fields of the write that are not in the answer of the read: where their text comes from.
    pub filled_from: BTreeMap<String, FillFrom>,
    /// What a person should know before sending it.
    pub note: String,
}

/// What the characters of a field mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Field {
    /// Hexadecimal digits.
    Hex,
    /// One or more signed decimal numbers, `+030.00+086.00`.
    Decimal,
    Text,
}

/// The source of a field that the read did not bring.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FillFrom {
    /// The module's address.
    Address,
    /// Another field of the answer.
    Field(String),
    /// A constant.
    Text(String),
}

/// Which table of the documentation an item belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ItemKind {
    /// A setting that is kept.
    Parameter,
    /// Something that is measured or that happens.
    Reading,
}

/// When a written value is in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Applies {
    #[default]
    Now,
    /// Writable in INIT mode only (DIP 4 ON), in force after a power cycle.
    Init,
}

/// A parameter or reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    pub id: String,
    pub item_kind: ItemKind,
    pub label: String,
    /// The sentence that explains it.
    pub help: String,
    /// Empty if it has none.
    pub unit: String,
    /// The tab of the module view that shows it.
    pub tab: String,
    pub kind: Kind,
    pub applies: Applies,
    pub read_only: bool,
    /// Polled while the module is watched.
    pub live: bool,
    /// Reading it changes it, so it is read only when asked for by name.
    pub on_request: bool,
    /// Not for reports that are handed on.
    pub secret: bool,
    /// The factory setting, where the manual tells it.
    pub factory: Option<Value>,
    /// The [`Optional`] part it belongs to.
    pub optional: Option<String>,
    /// Sections of the manual.
    pub source: String,
    /// Ways to it, the preferred one of each protocol first.
    pub accesses: Vec<Access>,
}

/// The set of values.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    Bool,
    /// Both ends included; all have the number's decimals.
    Number {
        min: Fixed,
        max: Fixed,
        /// Values outside the range that are allowed too, such as 0 for "off".
        also: Vec<Fixed>,
    },
    Choice(Vec<Choice>),
    Text {
        max_length: usize,
    },
    /// Four bytes, `192.168.255.1`.
    Ipv4,
}

/// One value of a list and its codes.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub word: String,
    pub label: String,
    /// The first is written, all are understood.
    pub dcon: Vec<u32>,
    pub modbus: Vec<u32>,
    /// A command of its own that sets this value over DCON.
    pub dcon_write: Option<Template>,
}

/// One way to read, and perhaps write, an item.
#[derive(Debug, Clone, PartialEq)]
pub enum Access {
    Command(CommandAccess),
    Modbus(ModbusAccess),
}

/// A field of a command's answer.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandAccess {
    /// Index into [`Definition::commands`].
    pub command: usize,
    pub protocol: Protocol,
    pub field: String,
    /// Which of several numbers in the field.
    pub index: Option<usize>,
    pub bits: Option<Bits>,
    pub inverted: bool,
    pub encoding: Encoding,
}

/// Coils or registers.
#[derive(Debug, Clone, PartialEq)]
pub struct ModbusAccess {
    pub place: ModbusPlace,
    pub bits: Option<Bits>,
    pub inverted: bool,
    pub signed: bool,
    /// Raw numbers that this way takes, where they are fewer than the item's range.
    pub range: Option<(i64, i64)>,
    pub encoding: Encoding,
    pub over_rtu: bool,
    pub over_tcp: bool,
}

/// Where in the module's address space; 1-based numbers as the manuals have them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ModbusPlace {
    Coils { first: u16, count: u16 },
    Holding { first: u16, count: u16 },
    Input { first: u16, count: u16 },
}

/// Bits of a word, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bits {
    pub low: u8,
    pub high: u8,
}

impl Bits {
    pub fn mask(self) -> u64 {
        let width = u32::from(self.high.saturating_sub(self.low)).saturating_add(1);
        let ones = u64::MAX.checked_shr(64u32.saturating_sub(width)).unwrap_or(u64::MAX);
        ones.checked_shl(u32::from(self.low)).unwrap_or(0)
    }

    pub fn take(self, word: u64) -> u64 {
        (word & self.mask()).checked_shr(u32::from(self.low)).unwrap_or(0)
    }

    pub fn put(self, word: u64, value: u64) -> u64 {
        let placed = value.checked_shl(u32::from(self.low)).unwrap_or(0) & self.mask();
        (word & !self.mask()) | placed
    }
}

/// How text is laid into words or bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// A number, or the characters themselves.
    #[default]
    Plain,
    /// The module's name, looked up in [`Identity`].
    Name,
    /// `B2.8` as nibbles 0 B 2 8; anything else as `major.minor`.
    Version,
    /// A length byte, then the characters.
    Counted,
    /// Bytes as `00-0D-E0-FF-FF-FF`.
    Mac,
}

/// Something to do that has no value.
#[derive(Debug, Clone, PartialEq)]
pub struct Action {
    pub id: String,
    pub label: String,
    pub help: String,
    pub tab: String,
    /// Asks before it is done.
    pub confirm: bool,
    /// The [`Optional`] part it belongs to.
    pub optional: Option<String>,
    pub dcon: Option<Template>,
    /// Coil or register that takes 1.
    pub modbus: Option<ModbusPlace>,
    pub over_rtu: bool,
    pub over_tcp: bool,
    pub source: String,
}

impl Action {
    pub fn is_offered(&self, protocol: Protocol) -> bool {
        match protocol {
            Protocol::Dcon => self.dcon.is_some(),
            Protocol::ModbusRtu => self.modbus.is_some() && self.over_rtu,
            Protocol::ModbusTcp => self.modbus.is_some() && self.over_tcp,
        }
    }

    /// Heard by every module of the line, answered by none.
    pub fn is_broadcast(&self) -> bool {
        self.dcon.as_ref().is_some_and(|template| !template.has_address())
    }
}

impl Access {
    pub fn serves(&self, protocol: Protocol) -> bool {
        match self {
            Self::Command(access) => access.protocol == protocol,
            Self::Modbus(access) => match protocol {
                Protocol::Dcon => false,
                Protocol::ModbusRtu => access.over_rtu,
                Protocol::ModbusTcp => access.over_tcp,
            },
        }
    }
}

impl Item {
    pub fn is_offered(&self, protocol: Protocol) -> bool {
        self.accesses.iter().any(|access| access.serves(protocol))
    }

    pub fn is_reading(&self) -> bool {
        self.item_kind == ItemKind::Reading || self.live
    }

    /// What values it takes, in words.
    pub fn allowed(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        match &self.kind {
            Kind::Bool => "true or false".to_owned(),
            Kind::Number { min, max, also } => {
                let also: String = also.iter().map(|value| format!("{value} or ")).collect();
                let decimals = match min.decimals {
                    0 => String::new(),
                    1 => ", with at most one decimal".to_owned(),
                    many => format!(", with at most {many} decimals"),
                };
                format!("{also}{min} to {max}{unit}{decimals}")
            }
            Kind::Choice(choices) => {
                let words: Vec<_> = choices.iter().map(|choice| choice.word.as_str()).collect();
                format!("{}{unit}", words.join(", "))
            }
            Kind::Text { max_length } => format!("text of at most {max_length} characters"),
            Kind::Ipv4 => "an address such as 192.168.255.1".to_owned(),
        }
    }

    /// A value for people: a choice by its label, a number with its unit.
    pub fn text(&self, value: &Value) -> String {
        let bare = self.bare_text(value);
        if self.unit.is_empty() || bare.parse::<f64>().is_err() { bare } else { format!("{bare} {}", self.unit) }
    }

    /// A value for people, without its unit.
    pub fn bare_text(&self, value: &Value) -> String {
        match (value, &self.kind) {
            (Value::Bool(on), _) => if *on { "on" } else { "off" }.to_owned(),
            (Value::Choice(word), Kind::Choice(choices)) => choices
                .iter()
                .find(|choice| choice.word == *word)
                .map_or_else(|| word.clone(), |choice| choice.label.clone()),
            _ => value.to_string(),
        }
    }

    /// Reads what a user typed.
    pub fn parse(&self, text: &str) -> Result<Value, ValueError> {
        if self.read_only {
            return Err(ValueError::ReadOnly { id: self.id.clone() });
        }
        self.parse_any(text).ok_or_else(|| self.not_allowed(text))
    }

    pub(super) fn not_allowed(&self, given: &str) -> ValueError {
        ValueError::NotAllowed { id: self.id.clone(), given: given.to_owned(), allowed: self.allowed() }
    }

    /// Reads a value as [`Item::parse`] does, of read-only items too.
    pub(crate) fn parse_any(&self, text: &str) -> Option<Value> {
        let text = text.trim();
        match &self.kind {
            Kind::Bool => match text.to_ascii_lowercase().as_str() {
                "true" | "on" | "1" => Some(Value::Bool(true)),
                "false" | "off" | "0" => Some(Value::Bool(false)),
                _ => None,
            },
            Kind::Number { min, max, also } => {
                let number = parse_number(text, min.decimals)?;
                let allowed = (min.raw..=max.raw).contains(&number.raw) || also.contains(&number);
                allowed.then_some(Value::Number(number))
            }
            Kind::Choice(choices) => choices
                .iter()
                .find(|choice| choice.word.eq_ignore_ascii_case(text))
                .map(|choice| Value::Choice(choice.word.clone())),
            Kind::Text { max_length } => {
                (text.len() <= *max_length && text.is_ascii()).then(|| Value::Text(text.to_owned()))
            }
            Kind::Ipv4 => text.parse::<std::net::Ipv4Addr>().ok().map(|address| Value::Text(address.to_string())),
        }
    }
}

/// Decimal, or for whole numbers hexadecimal as `0xA0` or `A0h`.
fn parse_number(text: &str, decimals: u8) -> Option<Fixed> {
    let hexadecimal = text.strip_prefix("0x").or_else(|| text.strip_suffix(['h', 'H']));
    match hexadecimal {
        Some(digits) if decimals == 0 => i64::from_str_radix(digits, 16).ok().map(|raw| Fixed::new(raw, 0)),
        _ => Fixed::parse(text, decimals),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_taken_and_put_in_place() {
        let bits = Bits { low: 3, high: 4 };
        assert_eq!(bits.mask(), 0b11000);
        assert_eq!(bits.take(0b10111), 0b10);
        assert_eq!(bits.put(0b11111, 0b01), 0b01111);
        assert_eq!(Bits { low: 0, high: 63 }.mask(), u64::MAX);
    }
}
