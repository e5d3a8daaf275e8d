//! The events that a filter shows, in order of their times, found between the pictures of the window, a few at a time.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ops::Range;

use crate::record::{Event, EventKind, History, Micros, ModuleId, micros_of};

/// Events looked at in one picture of the window.
const AT_ONCE: usize = 50_000;
/// Bits of a key that tell events of the same microsecond apart.
const TIE_BITS: u32 = 12;

/// Which events are shown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter {
    /// All kinds if none is named.
    pub kinds: BTreeSet<EventKind>,
    /// All modules, and what concerns none, if none is named.
    pub module: Option<ModuleId>,
    pub text: String,
}

impl Filter {
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty() && self.module.is_none() && self.text.trim().is_empty()
    }

    fn shows(&self, event: &Event, needle: &str, names: &BTreeMap<ModuleId, String>) -> bool {
        let holds = |text: &str| text.to_lowercase().contains(needle);
        let name = || event.module.and_then(|module| names.get(&module));
        (self.kinds.is_empty() || self.kinds.contains(&event.kind))
            && (self.module.is_none() || self.module == event.module)
            && (needle.is_empty()
                || holds(&event.text)
                || holds(event.kind.label())
                || name().is_some_and(|name| holds(name)))
    }
}

/// A row: its key, which grows from row to row with the time, and the event's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Row {
    pub key: u64,
    pub number: u64,
}

/// The event of this number, counted from the first that ever was.
pub fn event(history: &History, number: u64) -> Option<&Event> {
    let index = number.checked_sub(history.events_forgotten())?;
    history.events().get(usize::try_from(index).ok()?)
}

fn key(at: Micros, number: u64) -> u64 {
    let at = u64::try_from(at).unwrap_or(0);
    at.saturating_mul(1 << TIE_BITS).saturating_add(number % (1 << TIE_BITS))
}

#[derive(Default)]
pub struct Rows {
    filter: Filter,
    rows: VecDeque<Row>,
    /// The first event that was not looked at.
    next: u64,
    /// Where the list stands still.
    until: Option<u64>,
    /// The history's first event when forgotten rows were last taken out.
    cleaned: u64,
    /// The history's count of events put before others, whose numbers have changed then.
    reordered: u64,
}

impl Rows {
    pub fn filter(&self) -> &Filter {
        &self.filter
    }

    /// True if the rows are made anew.
    pub fn set_filter(&mut self, filter: &Filter) -> bool {
        let is_new = self.filter != *filter;
        if is_new {
            self.filter = filter.clone();
            self.restart();
        }
        is_new
    }

    fn restart(&mut self) {
        self.rows.clear();
        self.next = 0;
    }

    /// Looks at more events; true if nothing is left to look at.
    pub fn advance(&mut self, history: &History, names: &BTreeMap<ModuleId, String>, is_paused: bool) -> bool {
        let first = history.events_forgotten();
        let end = first.saturating_add(history.events().len() as u64);
        if end < self.next || self.reordered != history.events_reordered() {
            self.reordered = history.events_reordered();
            self.restart();
        }
        self.until = match self.until {
            _ if !is_paused => None,
            None => Some(self.next),
            until => until,
        };
        self.forget(first);
        let end = self.until.unwrap_or(end).min(end);
        self.next = self.next.max(first);
        let stop = end.min(self.next.saturating_add(AT_ONCE as u64));
        let needle = self.filter.text.trim().to_lowercase();
        while self.next < stop {
            let number = self.next;
            self.next = self.next.saturating_add(1);
            let Some(event) = event(history, number) else { continue };
            if self.filter.shows(event, &needle, names) {
                self.insert(Row { key: key(micros_of(event.at), number), number });
            }
        }
        self.next >= end
    }

    /// Almost always at the end; notes can be about earlier times.
    fn insert(&mut self, row: Row) {
        if self.rows.back().is_none_or(|last| last.key < row.key) {
            return self.rows.push_back(row);
        }
        let place = self.rows.partition_point(|known| known.key < row.key);
        self.rows.insert(place, row);
    }

    fn forget(&mut self, first: u64) {
        if self.cleaned != first {
            self.cleaned = first;
            while self.rows.front().is_some_and(|row| row.number < first) {
                self.rows.pop_front();
            }
        }
    }

    /// Events that fit the filter.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn get(&self, place: usize) -> Option<Row> {
        self.rows.get(place).copied()
    }

    pub fn find(&self, key: u64) -> Option<Row> {
        let place = self.rows.partition_point(|row| row.key < key);
        self.get(place).filter(|row| row.key == key)
    }

    /// The places of the rows between two times, both included.
    pub fn within(&self, [from, to]: [Micros; 2]) -> Range<usize> {
        let begin = self.rows.partition_point(|row| row.key < key(from, 0));
        let end = self.rows.partition_point(|row| row.key < key(to.saturating_add(1), 0));
        begin..end.max(begin)
    }

    /// The place of the row that is nearest in time.
    pub fn nearest(&self, at: Micros) -> Option<usize> {
        let wanted = key(at, 0);
        let after = self.rows.partition_point(|row| row.key < wanted);
        let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
        near.filter_map(|place| Some((place, self.rows.get(place)?.key.abs_diff(wanted))))
            .min_by_key(|(_, distance)| *distance)
            .map(|(place, _)| place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::timestamp;

    fn event_at(at: Micros, kind: EventKind, text: &str) -> Event {
        Event { at: timestamp(at), module: None, kind, text: text.to_owned(), change: None }
    }

    fn texts(rows: &Rows, history: &History) -> Vec<String> {
        (0..rows.len()).filter_map(|place| Some(event(history, rows.get(place)?.number)?.text.clone())).collect()
    }

    fn take_all(rows: &mut Rows, history: &History) {
        while !rows.advance(history, &BTreeMap::new(), false) {}
    }

    #[test]
    fn a_note_about_an_earlier_time_stands_where_it_belongs() {
        let mut history = History::default();
        for (at, text) in [(1_000, "first"), (3_000, "third"), (3_000, "third again"), (2_000, "second")] {
            history.add_event(event_at(at, EventKind::Note, text));
        }
        let mut rows = Rows::default();
        take_all(&mut rows, &history);
        assert_eq!(texts(&rows, &history), ["first", "second", "third", "third again"]);
        assert_eq!(rows.within([2_000, 3_000]), 1..4);
        assert_eq!(rows.within([2_001, 2_999]), 2..2);
        assert_eq!([0, 1_499, 1_501, 9_000].map(|at| rows.nearest(at)), [Some(0), Some(0), Some(1), Some(3)]);
        assert!(rows.find(rows.get(2).unwrap().key).is_some());
    }

    #[test]
    fn the_list_grows_with_the_history_and_stands_still_while_it_is_paused() {
        let mut history = History::default();
        let mut rows = Rows::default();
        history.add_event(event_at(1, EventKind::Motion, "a"));
        take_all(&mut rows, &history);
        assert!(rows.advance(&history, &BTreeMap::new(), true));
        history.add_event(event_at(2, EventKind::Motion, "b"));
        assert!(rows.advance(&history, &BTreeMap::new(), true));
        assert_eq!(rows.len(), 1);
        take_all(&mut rows, &history);
        assert_eq!(texts(&rows, &history), ["a", "b"]);
    }

    #[test]
    fn a_filter_shows_kinds_and_texts_whatever_their_case() {
        let mut history = History::default();
        history.add_event(event_at(1, EventKind::Motion, "Motion: on"));
        history.add_event(event_at(2, EventKind::Lost, "Lost: no answer"));
        let mut rows = Rows::default();
        rows.set_filter(&Filter { text: " NO ans ".to_owned(), ..Filter::default() });
        take_all(&mut rows, &history);
        assert_eq!(texts(&rows, &history), ["Lost: no answer"]);
        rows.set_filter(&Filter { kinds: [EventKind::Motion].into(), ..Filter::default() });
        take_all(&mut rows, &history);
        assert_eq!(texts(&rows, &history), ["Motion: on"]);
    }

    #[test]
    fn what_the_history_forgets_leaves_the_list() {
        let mut history = History::default();
        let mut rows = Rows::default();
        for number in 0..crate::record::MOST_EVENTS as i64 + 7 {
            history.add_event(event_at(number, EventKind::Motion, ""));
        }
        take_all(&mut rows, &history);
        assert_eq!(rows.len(), crate::record::MOST_EVENTS);
        history.add_event(event_at(i64::from(u32::MAX), EventKind::Lost, ""));
        take_all(&mut rows, &history);
        assert_eq!((rows.len(), rows.get(0).unwrap().number), (crate::record::MOST_EVENTS, 8));
    }
}
