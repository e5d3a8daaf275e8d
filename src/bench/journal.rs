//! What happened to a module: found, lost, motion, alarms, settings written or refused.

use std::collections::VecDeque;

use jiff::Timestamp;

pub use crate::record::EventKind as EntryKind;
use crate::record::{Change, Event, ModuleId};

/// Entries kept for each module; the oldest are forgotten.
const KEPT: usize = 100_000;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    pub at: Timestamp,
    pub kind: EntryKind,
    /// One sentence without its full stop.
    pub text: String,
    /// For settings that were written.
    pub change: Option<Change>,
}

impl Entry {
    pub fn new(at: Timestamp, kind: EntryKind, text: String) -> Self {
        Self { at, kind, text, change: None }
    }

    /// As the history of all modules has it.
    pub fn to_event(&self, module: Option<ModuleId>) -> Event {
        let Self { at, kind, text, change } = self.clone();
        Event { at, module, kind, text, change }
    }
}

/// The entries of one module in order of time, bounded in number.
#[derive(Debug, Clone, Default)]
pub struct Journal {
    entries: VecDeque<Entry>,
    forgotten: u64,
    /// The newest entries, so many, are not in the history of all modules yet.
    news: usize,
}

impl Journal {
    pub fn add(&mut self, at: Timestamp, kind: EntryKind, text: String) {
        self.push(Entry::new(at, kind, text));
    }

    pub fn push(&mut self, entry: Entry) {
        if self.entries.len() >= KEPT {
            self.entries.pop_front();
            self.forgotten = self.forgotten.saturating_add(1);
        }
        self.entries.push_back(entry);
        self.news = self.news.saturating_add(1);
    }

    /// What was added since this was last asked.
    pub(super) fn take_news(&mut self) -> impl Iterator<Item = &Entry> {
        let known = self.entries.len().saturating_sub(std::mem::take(&mut self.news));
        self.entries.iter().skip(known)
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
