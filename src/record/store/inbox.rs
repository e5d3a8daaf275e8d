//! What waits to be written.

use std::collections::{HashSet, VecDeque};

use super::super::history::{MOST_EVENTS, Record};
use super::super::objects::{Event, SeriesId};
use super::super::trend::{Micros, Sample};

/// Samples that may wait while the disk cannot be written: 24 bytes each.
const MOST_SAMPLES: usize = 5_000_000;
/// Samples of one transaction, which bounds how much is written in vain.
const AT_ONCE: usize = 100_000;

/// News in the order in which they came: samples and events each by themselves, both after what describes them.
#[derive(Debug)]
pub struct Inbox {
    described: Vec<Record>,
    events: VecDeque<Event>,
    samples: VecDeque<(SeriesId, Sample)>,
    /// Samples that may wait.
    room: usize,
    /// Samples and events that are being written.
    in_hand: usize,
    lost: u64,
    /// Series whose next sample comes after one that was lost.
    broken: HashSet<SeriesId>,
}

/// What is written at once.
#[derive(Debug, Default)]
pub struct Batch {
    pub described: Vec<Record>,
    pub events: Vec<Event>,
    pub samples: Vec<(SeriesId, Sample)>,
}

impl Batch {
    pub fn len(&self) -> usize {
        self.events.len().saturating_add(self.samples.len())
    }

    pub fn is_empty(&self) -> bool {
        self.described.is_empty() && self.len() == 0
    }
}

impl Default for Inbox {
    fn default() -> Self {
        let (described, events, samples) = Default::default();
        Self { described, events, samples, room: MOST_SAMPLES, in_hand: 0, lost: 0, broken: HashSet::new() }
    }
}

impl Inbox {
    pub fn put(&mut self, records: Vec<Record>) {
        for record in records {
            match record {
                Record::Sample(id, sample) => self.samples.push_back((id, sample)),
                Record::Event(event) => self.events.push_back(event),
                record => self.described.push(record),
            }
        }
        self.make_room();
    }

    /// The oldest are given up.
    fn make_room(&mut self) {
        while self.samples.len() > self.room {
            let Some((id, _)) = self.samples.pop_front() else { break };
            self.broken.insert(id);
            self.lost = self.lost.saturating_add(1);
        }
        while self.events.len() > MOST_EVENTS {
            self.events.pop_front();
            self.lost = self.lost.saturating_add(1);
        }
    }

    /// Takes out what is to be written next; [`Inbox::written`] or [`Inbox::put_back`] follows.
    pub fn take(&mut self) -> Batch {
        let count = self.samples.len().min(AT_ONCE);
        let mut samples: Vec<(SeriesId, Sample)> = self.samples.drain(..count).collect();
        if !self.broken.is_empty() {
            for (id, sample) in &mut samples {
                sample.gap |= self.broken.remove(id);
            }
        }
        let batch =
            Batch { described: std::mem::take(&mut self.described), events: self.events.drain(..).collect(), samples };
        self.in_hand = batch.len();
        batch
    }

    /// What was taken out is on the disk, or was put back.
    pub fn written(&mut self) {
        self.in_hand = 0;
    }

    /// It could not be written. What describes series was taken in all the same.
    pub fn put_back(&mut self, batch: Batch) {
        self.in_hand = 0;
        batch.samples.into_iter().rev().for_each(|sample| self.samples.push_front(sample));
        batch.events.into_iter().rev().for_each(|event| self.events.push_front(event));
        self.make_room();
    }

    /// Takes out all samples and events that wait, each in their order.
    pub fn drain(&mut self) -> Vec<Record> {
        let mut all = Vec::with_capacity(self.events.len().saturating_add(self.samples.len()));
        while !self.is_empty() {
            let Batch { events, samples, .. } = self.take();
            all.extend(events.into_iter().map(Record::Event));
            all.extend(samples.into_iter().map(|(id, sample)| Record::Sample(id, sample)));
        }
        self.written();
        all
    }

    pub fn is_empty(&self) -> bool {
        self.described.is_empty() && self.events.is_empty() && self.samples.is_empty()
    }

    /// Samples and events that are not on the disk.
    pub fn waiting(&self) -> u64 {
        self.events.len().saturating_add(self.samples.len()).saturating_add(self.in_hand) as u64
    }

    /// Samples and events for which there was no room.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// The earliest time of what waits.
    pub fn earliest(&self) -> Option<Micros> {
        self.samples.iter().map(|(_, sample)| sample.at).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(id: u32, at: Micros) -> Record {
        Record::Sample(SeriesId(id), Sample { at, value: at, gap: false })
    }

    fn times(batch: &Batch) -> Vec<(Micros, bool)> {
        batch.samples.iter().map(|(_, sample)| (sample.at, sample.gap)).collect()
    }

    #[test]
    fn what_could_not_be_written_comes_first_again() {
        let mut inbox = Inbox::default();
        inbox.put(vec![sample(0, 1), sample(0, 2)]);
        let batch = inbox.take();
        inbox.put(vec![sample(0, 3)]);
        assert_eq!(inbox.waiting(), 3);
        inbox.put_back(batch);
        assert_eq!(inbox.waiting(), 3);
        assert_eq!(times(&inbox.take()), [(1, false), (2, false), (3, false)]);
        inbox.written();
        assert_eq!((inbox.waiting(), inbox.is_empty()), (0, true));
    }

    #[test]
    fn where_there_is_no_room_the_oldest_are_lost_which_leaves_a_gap() {
        let mut inbox = Inbox { room: 3, ..Inbox::default() };
        inbox.put((1..=5).map(|at| sample(0, at)).collect());
        assert_eq!((inbox.lost(), inbox.waiting(), inbox.earliest()), (2, 3, Some(3)));
        let batch = inbox.take();
        inbox.put(vec![sample(0, 6)]);
        assert_eq!(inbox.lost(), 2, "what is in hand takes no room");
        inbox.put_back(batch);
        assert_eq!(inbox.lost(), 3);
        assert_eq!(times(&inbox.take()), [(4, true), (5, false), (6, false)]);
        inbox.written();
        inbox.put(vec![sample(0, 7), sample(1, 7)]);
        assert_eq!(times(&inbox.take()), [(7, false), (7, false)]);
    }

    #[test]
    fn all_that_waits_can_be_taken_away_with_its_gaps() {
        let mut inbox = Inbox { room: AT_ONCE + 2, ..Inbox::default() };
        inbox.put((0..AT_ONCE as i64 + 5).map(|at| sample(0, at)).collect());
        let all = inbox.drain();
        let samples = all.iter().filter_map(|record| match record {
            Record::Sample(_, sample) => Some((sample.at, sample.gap)),
            _ => None,
        });
        assert!(samples.eq((3..AT_ONCE as i64 + 5).map(|at| (at, at == 3))));
        assert_eq!((inbox.waiting(), inbox.is_empty()), (0, true));
    }
}
