//! Events and frames of one module in order of time, as a filter shows them.

use std::collections::{BTreeSet, VecDeque};

use crate::bench::traffic::FrameFilter;
use crate::bench::{Bench, Entry, EntryKind, Module};
use crate::ui::tables::Follower;

/// After so many frames were forgotten, their rows are taken out too.
const FORGOTTEN: u64 = 10_000;

/// What of the log is shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Mode {
    #[default]
    Events,
    Communication,
    Both,
}

impl Mode {
    pub const ALL: [Self; 3] = [Self::Events, Self::Communication, Self::Both];

    pub fn label(self) -> &'static str {
        match self {
            Self::Events => "Events",
            Self::Communication => "Communication",
            Self::Both => "Both",
        }
    }

    /// What it shows.
    pub fn means(self) -> &'static str {
        match self {
            Self::Events => "What happened with this module",
            Self::Communication => "Every frame to this module and from it",
            Self::Both => "Events and frames in one list, by time",
        }
    }
}

/// Which rows are shown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter {
    pub mode: Mode,
    /// All kinds if none is named.
    pub kinds: BTreeSet<EntryKind>,
    /// Of frames.
    pub only_errors: bool,
    pub text: String,
}

impl Filter {
    fn shows(&self, entry: &Entry) -> bool {
        let needle = self.text.trim().to_lowercase();
        let holds = |text: &str| text.to_lowercase().contains(&needle);
        (self.kinds.is_empty() || self.kinds.contains(&entry.kind))
            && (needle.is_empty() || holds(&entry.text) || holds(entry.kind.label()))
    }
}

/// What a row shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum What {
    /// By the number that [`event`] knows it by.
    Event(u64),
    /// By its sequence number.
    Frame(u64),
}

/// The event of this number, counted from the first that ever was.
pub fn event(module: &Module, number: u64) -> Option<&Entry> {
    let index = number.checked_sub(module.journal.forgotten())?;
    module.journal.get(usize::try_from(index).ok()?)
}

#[derive(Default)]
pub struct Rows {
    filter: Filter,
    /// With keys that grow from row to row.
    rows: VecDeque<(u64, What)>,
    next_key: u64,
    frames: Follower,
    /// The first frame and the first event that are not taken in.
    next_frame: u64,
    next_event: u64,
    /// Where the events stand still.
    until_event: Option<u64>,
    /// The log's first frame when forgotten rows were last taken out.
    cleaned: u64,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Key and contents of a row, the oldest being row 0.
    pub fn get(&self, row: usize) -> Option<(u64, What)> {
        self.rows.get(row).copied()
    }

    pub fn find(&self, key: u64) -> Option<What> {
        let row = self.rows.partition_point(|(known, _)| *known < key);
        self.get(row).filter(|(found, _)| *found == key).map(|(_, what)| what)
    }

    /// True if the rows are made anew.
    pub fn set_filter(&mut self, filter: Filter, module: &Module, bench: &Bench) -> bool {
        let of_frames = FrameFilter {
            module: Some((module.target.address, module.target.protocol)),
            only_errors: filter.only_errors,
            text: filter.text.clone(),
            ..FrameFilter::default()
        };
        let is_new = self.frames.set_filter(of_frames) | (filter != self.filter) | self.frames.notice_modules(bench);
        if is_new {
            self.filter = filter;
            self.rows.clear();
            self.next_frame = 0;
            self.next_event = 0;
        }
        is_new
    }

    /// Takes in what is new; true if nothing is left to take in.
    pub fn advance(&mut self, module: &Module, bench: &Bench, is_paused: bool) -> bool {
        self.forget(module, bench);
        self.until_event = match self.until_event {
            _ if !is_paused => None,
            None => Some(self.next_event),
            until => until,
        };
        if self.filter.mode == Mode::Events {
            self.take_events(module, |_| true);
            return true;
        }
        let is_done = self.frames.advance(bench, is_paused);
        for row in self.frames.view().row_of(self.next_frame)..self.frames.view().len() {
            let Some(frame) = self.frames.view().seq(row).and_then(|seq| bench.traffic().get(seq)) else { continue };
            self.take_events(module, |entry| entry.at <= frame.at);
            self.next_frame = frame.seq.saturating_add(1);
            self.push(What::Frame(frame.seq));
        }
        if is_done {
            self.take_events(module, |_| true);
        }
        is_done
    }

    fn take_events(&mut self, module: &Module, is_due: impl Fn(&Entry) -> bool) {
        self.next_event = self.next_event.max(module.journal.forgotten());
        while let Some(entry) = event(module, self.next_event).filter(|entry| is_due(entry)) {
            if self.until_event.is_some_and(|until| self.next_event >= until) {
                return;
            }
            if self.filter.mode != Mode::Communication && self.filter.shows(entry) {
                self.push(What::Event(self.next_event));
            }
            self.next_event = self.next_event.saturating_add(1);
        }
    }

    fn push(&mut self, what: What) {
        self.rows.push_back((self.next_key, what));
        self.next_key = self.next_key.saturating_add(1);
    }

    fn forget(&mut self, module: &Module, bench: &Bench) {
        let (first_seq, first_event) = (bench.traffic().first_seq(), module.journal.forgotten());
        let is_there = |what: &What| match what {
            What::Event(number) => *number >= first_event,
            What::Frame(seq) => *seq >= first_seq,
        };
        while self.rows.front().is_some_and(|(_, what)| !is_there(what)) {
            self.rows.pop_front();
        }
        let is_cleared = bench.traffic().is_empty() && self.cleaned < first_seq;
        if is_cleared || first_seq.saturating_sub(self.cleaned) > FORGOTTEN {
            self.cleaned = first_seq;
            self.rows.retain(|(_, what)| is_there(what));
        }
    }
}
