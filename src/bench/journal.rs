//! What happened to a module: found, lost, motion, alarms, settings written or refused.

use std::collections::VecDeque;

use jiff::Timestamp;
use serde::Serialize;

/// Entries kept for each module; the oldest are forgotten.
const KEPT: usize = 100_000;

/// What an entry is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EntryKind {
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
    /// Everything else.
    Note,
}

impl EntryKind {
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
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Entry {
    pub at: Timestamp,
    pub kind: EntryKind,
    /// One sentence without its full stop.
    pub text: String,
}

/// The entries of one module in order of time, bounded in number.
#[derive(Debug, Clone, Default)]
pub struct Journal {
    entries: VecDeque<Entry>,
    forgotten: u64,
}

impl Journal {
    pub fn add(&mut self, at: Timestamp, kind: EntryKind, text: String) {
        if self.entries.len() >= KEPT {
            self.entries.pop_front();
            self.forgotten = self.forgotten.saturating_add(1);
        }
        self.entries.push_back(Entry { at, kind, text });
    }

    pub fn len(&self) -> usize {
        self.entries.len()
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// How many were forgotten: the number of the oldest entry that is still there.
    pub fn forgotten(&self) -> u64 {
        self.forgotten
    }

    /// Counted from the oldest that is still there.
    pub fn get(&self, index: usize) -> Option<&Entry> {
        self.entries.get(index)
    }

    /// Oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Entry> {
        self.entries.iter()
    }
}
