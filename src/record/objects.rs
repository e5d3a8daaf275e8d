//! What a recording speaks of: modules, series and events, by names that outlive the program.

use std::fmt;

use jiff::Timestamp;
use serde::Serialize;

use super::trend::Micros;

/// Names a module within a history and the recording made of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ModuleId(pub u32);

/// Names a series within a history and the recording made of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SeriesId(pub u32);

/// A module as it was when it was found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ModuleInfo {
    /// The line as people see it, such as `COM3` or `192.168.255.1:502`.
    pub line: String,
    pub address: u8,
    /// `dcon`, `modbus_rtu` or `modbus_tcp`.
    pub protocol: String,
    /// In bits per second; `None` over TCP.
    pub baud_rate: Option<u32>,
    /// `n81`, `n82`, `e81`, `o81`; `None` over TCP.
    pub data_format: Option<String>,
    pub checksum: bool,
    /// The definition's id, such as `pir-234`.
    pub model: String,
    /// The model for people, such as `PIR-234`.
    pub label: String,
    /// As the module says them.
    pub name: String,
    pub firmware: String,
}

impl fmt::Display for ModuleInfo {
    /// Short and unique on a line with one protocol: `PIR-234@1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.label, self.address)
    }
}

/// What a value of a series means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SeriesKind {
    /// In units of so many decimals.
    Number { decimals: u8 },
    /// 0 is off, 1 is on.
    Switch,
    /// The place of a word in this list.
    Choice { words: Vec<String> },
}

impl SeriesKind {
    pub fn decimals(&self) -> u8 {
        if let Self::Number { decimals } = self { *decimals } else { 0 }
    }
}

/// One reading or state of a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeriesInfo {
    pub module: ModuleId,
    /// The public name, such as `temperature_c`.
    pub item: String,
    pub label: String,
    /// Such as `°C`; empty for switches.
    pub unit: String,
    pub kind: SeriesKind,
}

impl SeriesInfo {
    /// A value in words: `24.99`, `true`, `command`.
    pub fn text(&self, value: i64) -> String {
        match &self.kind {
            SeriesKind::Number { decimals } => crate::module::Fixed::new(value, *decimals).to_string(),
            SeriesKind::Switch => (value != 0).to_string(),
            SeriesKind::Choice { words } => {
                let word = usize::try_from(value).ok().and_then(|place| words.get(place));
                word.cloned().unwrap_or_else(|| value.to_string())
            }
        }
    }
}

/// What an event is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// Found, or answering again.
    Found,
    Lost,
    Motion,
    Output,
    Alarm,
    Watchdog,
    Written,
    Refused,
    /// An action was carried out.
    Done,
    /// Everything else, above all what the user notes.
    Note,
}

impl EventKind {
    pub const ALL: [Self; 10] = [
        Self::Found,
        Self::Lost,
        Self::Motion,
        Self::Output,
        Self::Alarm,
        Self::Watchdog,
        Self::Written,
        Self::Refused,
        Self::Done,
        Self::Note,
    ];

    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Found => "Found",
            Self::Lost => "Lost",
            Self::Motion => "Motion",
            Self::Output => "Output",
            Self::Alarm => "Alarm",
            Self::Watchdog => "Watchdog",
            Self::Written => "Written",
            Self::Refused => "Refused",
            Self::Done => "Action",
            Self::Note => "Note",
        }
    }

    /// The public name, as it stands in recordings and exports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::Lost => "lost",
            Self::Motion => "motion",
            Self::Output => "output",
            Self::Alarm => "alarm",
            Self::Watchdog => "watchdog",
            Self::Written => "written",
            Self::Refused => "refused",
            Self::Done => "done",
            Self::Note => "note",
        }
    }

    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A setting that was written and read back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// The public name.
    pub item: String,
    /// `None` if it was not known.
    pub before: Option<String>,
    pub after: String,
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    pub at: Timestamp,
    /// `None` for what concerns the whole line, and for notes.
    pub module: Option<ModuleId>,
    pub kind: EventKind,
    /// One sentence without its full stop.
    pub text: String,
    /// For settings that were written.
    pub change: Option<Change>,
}

/// A time as recordings have it.
pub fn micros_of(at: Timestamp) -> Micros {
    at.as_microsecond()
}

/// A time of a recording; the nearest one there is for times beyond all calendars.
pub fn timestamp(at: Micros) -> Timestamp {
    let nearest = if at < 0 { Timestamp::MIN } else { Timestamp::MAX };
    Timestamp::from_microsecond(at).unwrap_or(nearest)
}
