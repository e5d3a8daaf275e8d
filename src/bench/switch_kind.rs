//! What a reading that is on or off stands for, by the public names, which every definition shares.

use super::journal::EntryKind;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SwitchKind {
    Motion,
    Output,
    Sound,
    Alarm,
    Watchdog,
}

impl SwitchKind {
    pub fn of(id: &str) -> Self {
        match id {
            _ if id.starts_with("pir") => Self::Motion,
            _ if id.ends_with("tripped") => Self::Watchdog,
            _ if id.starts_with("alarm") => Self::Alarm,
            _ if id.starts_with("buzzer") => Self::Sound,
            _ => Self::Output,
        }
    }

    pub fn word(self, on: bool) -> &'static str {
        match (self, on) {
            (Self::Motion, true) => "motion",
            (Self::Motion, false) => "quiet",
            (Self::Watchdog, true) => "yes",
            (Self::Watchdog, false) => "no",
            (Self::Alarm, true) => "alarm",
            (Self::Alarm, false) => "none",
            (Self::Output | Self::Sound, true) => "on",
            (Self::Output | Self::Sound, false) => "off",
        }
    }

    pub fn entry_kind(self) -> EntryKind {
        match self {
            Self::Motion => EntryKind::Motion,
            Self::Output | Self::Sound => EntryKind::Output,
            Self::Alarm => EntryKind::Alarm,
            Self::Watchdog => EntryKind::Watchdog,
        }
    }
}
