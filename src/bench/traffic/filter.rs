//! The frames of the log that a person wants to see.

use std::collections::VecDeque;

use super::log::{FrameRef, TrafficLog};
use crate::bus::Direction;
use crate::protocol::{Protocol, hex};

/// Which frames are shown; all of its parts have to agree.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FrameFilter {
    /// Address and protocol of one module.
    pub module: Option<(u8, Protocol)>,
    pub direction: Option<Direction>,
    /// Refusals, broken answers and missing ones.
    pub only_errors: bool,
    /// Found in the hexadecimal bytes (with or without spaces), in the text of a DCON frame, in its trouble or in its
    /// meaning, whatever the case; empty for all.
    pub text: String,
}

impl FrameFilter {
    /// Whether it lets everything through.
    pub fn is_empty(&self) -> bool {
        self.module.is_none() && self.direction.is_none() && !self.only_errors && self.text.trim().is_empty()
    }

    /// `explain` tells what the frame means; it is asked only if nothing else decides.
    fn shows(&self, needle: &Needle, frame: &FrameRef<'_>, explain: impl FnOnce() -> String) -> bool {
        let from_module = self.module.is_none_or(|module| frame.address.map(|at| (at, frame.protocol)) == Some(module));
        from_module
            && self.direction.is_none_or(|direction| direction == frame.direction)
            && (!self.only_errors || frame.outcome.is_error())
            && (needle.text.is_empty() || needle.is_in(frame) || contains(&explain(), &needle.text))
    }
}

/// The searched text, prepared.
#[derive(Debug, Clone, Default)]
struct Needle {
    /// In lower case.
    text: String,
    /// If it can be read as bytes.
    bytes: Vec<u8>,
}

impl Needle {
    fn of(text: &str) -> Self {
        Self { text: text.trim().to_lowercase(), bytes: hex::parse(text).unwrap_or_default() }
    }

    fn is_in(&self, frame: &FrameRef<'_>) -> bool {
        let in_bytes = !self.bytes.is_empty() && frame.bytes.windows(self.bytes.len()).any(|part| part == self.bytes);
        in_bytes
            || contains(&hex::spaced(frame.bytes), &self.text)
            || (frame.protocol == Protocol::Dcon && contains(&hex::escaped(frame.bytes), &self.text))
            || contains(frame.outcome.trouble(), &self.text)
    }
}

/// `needle` is in lower case.
fn contains(text: &str, needle: &str) -> bool {
    text.to_lowercase().contains(needle)
}

/// Sequence numbers of the frames that a filter shows, found step by step.
#[derive(Debug, Clone, Default)]
pub struct FilteredTraffic {
    filter: FrameFilter,
    needle: Needle,
    matches: VecDeque<u64>,
    /// The first frame that was not looked at yet.
    next: u64,
}

impl FilteredTraffic {
    pub fn new(filter: FrameFilter) -> Self {
        let needle = Needle::of(&filter.text);
        Self { filter, needle, matches: VecDeque::new(), next: 0 }
    }

    pub fn filter(&self) -> &FrameFilter {
        &self.filter
    }

    /// Starts again from the oldest frame if the filter is another one.
    pub fn set_filter(&mut self, filter: FrameFilter) {
        if filter != self.filter {
            *self = Self::new(filter);
        }
    }

    /// Starts again from the oldest frame: for when meanings have changed, as when a module was identified.
    pub fn restart(&mut self) {
        self.matches.clear();
        self.next = 0;
    }

    /// Looks at `budget` more frames of the log at most. True if it has seen all of them. `explain` tells what a frame
    /// means, given the request that it answers.
    pub fn advance(
        &mut self,
        log: &TrafficLog,
        explain: &dyn Fn(&FrameRef<'_>, Option<&FrameRef<'_>>) -> String,
        budget: usize,
    ) -> bool {
        while self.matches.front().is_some_and(|seq| *seq < log.first_seq()) {
            self.matches.pop_front();
        }
        self.next = self.next.max(log.first_seq());
        let until = self.next.saturating_add(budget as u64).min(log.next_seq());
        for seq in self.next..until {
            let Some(frame) = log.get(seq) else { continue };
            let meaning = || explain(&frame, log.request_of(seq).as_ref());
            if self.filter.shows(&self.needle, &frame, meaning) {
                self.matches.push_back(seq);
            }
        }
        self.next = self.next.max(until);
        self.next >= log.next_seq()
    }

    /// Number of frames shown. Between two advances some of them may have been forgotten by the log.
    pub fn len(&self) -> usize {
        self.matches.len()
    }

    pub fn is_empty(&self) -> bool {
        self.matches.is_empty()
    }

    /// Sequence number of row `row`, the oldest being row 0.
    pub fn seq(&self, row: usize) -> Option<u64> {
        self.matches.get(row).copied()
    }

    /// Row of the frame `seq`, or of the first one after it.
    pub fn row_of(&self, seq: u64) -> usize {
        self.matches.partition_point(|known| *known < seq)
    }

    /// Sequence numbers, oldest first.
    pub fn seqs(&self) -> impl DoubleEndedIterator<Item = u64> + '_ {
        self.matches.iter().copied()
    }
}
