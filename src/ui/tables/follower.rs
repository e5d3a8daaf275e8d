//! The frames that a filter shows, found between the pictures of the window, a few at a time.

use crate::bench::Bench;
use crate::bench::traffic::{FilteredTraffic, FrameFilter, FrameRef};

/// Frames looked at in one picture of the window, if their meaning has to be told for it.
const EXPLAINED: usize = 1_000;
/// The same if a look at the frame is enough.
const LOOKED_AT: usize = 50_000;

/// A filtered view that follows the log, or stands still.
#[derive(Default)]
pub struct Follower {
    view: FilteredTraffic,
    /// The first frame that the view has not looked at.
    next: u64,
    /// Where it stands still.
    until: Option<u64>,
    /// Modules whose definition was known when meanings were last told.
    known: usize,
}

impl Follower {
    pub fn view(&self) -> &FilteredTraffic {
        &self.view
    }

    /// True if it starts anew.
    pub fn set_filter(&mut self, filter: FrameFilter) -> bool {
        let is_new = *self.view.filter() != filter;
        if is_new {
            self.view.set_filter(filter);
            self.next = 0;
        }
        is_new
    }

    /// True if it starts anew because meanings have changed: a module was identified.
    pub fn notice_modules(&mut self, bench: &Bench) -> bool {
        let known = bench.modules().iter().filter(|module| module.definition().is_some()).count();
        let has_changed = known != self.known && !self.view.filter().text.trim().is_empty();
        self.known = known;
        if has_changed {
            self.view.restart();
            self.next = 0;
        }
        has_changed
    }

    /// Looks at more frames; true if it has seen all that it should.
    pub fn advance(&mut self, bench: &Bench, is_paused: bool) -> bool {
        let log = bench.traffic();
        self.until = match self.until {
            _ if !is_paused => None,
            None => Some(self.next),
            until => until,
        };
        let end = self.until.unwrap_or_else(|| log.next_seq()).min(log.next_seq());
        self.next = self.next.max(log.first_seq());
        let most = if self.view.filter().text.trim().is_empty() { LOOKED_AT } else { EXPLAINED };
        let budget = usize::try_from(end.saturating_sub(self.next)).unwrap_or(usize::MAX).min(most);
        let explain =
            |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
        self.view.advance(log, &explain, budget);
        self.next = self.next.saturating_add(budget as u64);
        self.next >= end
    }
}
