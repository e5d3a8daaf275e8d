//! What is known of a stretch of samples without looking at each.

use super::{Micros, Sample};

/// A stretch of samples in a row. Times in microseconds since 1970 UTC, values in units of the last decimal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Node {
    pub first: Micros,
    pub last: Micros,
    pub count: u64,
    pub low: i64,
    pub high: i64,
    /// The lowest sample comes before the highest, or is the same one.
    pub low_first: bool,
    /// The first sample does not continue the one before the stretch.
    pub gap: bool,
    pub sum: i64,
    /// How often the value came from zero, or out of a gap, to something else.
    pub rises: u64,
    /// Time during which the value was not zero, and time that was observed at all; each sample stands for the time
    /// until the next one. The time from the sample before the stretch to its first counts here.
    pub on: Micros,
    pub observed: Micros,
}

impl Node {
    /// A single sample after `before`.
    pub fn of(sample: Sample, before: Option<Sample>) -> Self {
        let Sample { at, value, gap } = sample;
        let before = before.filter(|_| !gap);
        let observed = before.map_or(0, |before| at.saturating_sub(before.at));
        let was_on = before.is_some_and(|before| before.value != 0);
        Self {
            first: at,
            last: at,
            count: 1,
            low: value,
            high: value,
            low_first: true,
            gap,
            sum: value,
            rises: u64::from(value != 0 && !was_on),
            on: if was_on { observed } else { 0 },
            observed,
        }
    }

    /// Takes in the stretch that follows.
    pub fn merge(&mut self, later: &Self) {
        let (new_low, new_high) = (later.low < self.low, later.high > self.high);
        self.low_first = match (new_low, new_high) {
            (false, false) => self.low_first,
            (true, true) => later.low_first,
            (new_low, _) => !new_low,
        };
        self.low = self.low.min(later.low);
        self.high = self.high.max(later.high);
        self.last = later.last;
        self.count = self.count.saturating_add(later.count);
        self.sum = self.sum.saturating_add(later.sum);
        self.rises = self.rises.saturating_add(later.rises);
        self.on = self.on.saturating_add(later.on);
        self.observed = self.observed.saturating_add(later.observed);
    }

    /// From the first sample to the last.
    pub fn width(&self) -> Micros {
        self.last.saturating_sub(self.first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(values: &[i64]) -> Node {
        let samples: Vec<Sample> =
            values.iter().zip(0..).map(|(value, at)| Sample { at, value: *value, gap: false }).collect();
        let mut nodes = samples.iter().scan(None, |before, sample| {
            let node = Node::of(*sample, *before);
            *before = Some(*sample);
            Some(node)
        });
        let first = nodes.next().unwrap();
        nodes.fold(first, |mut all, node| {
            all.merge(&node);
            all
        })
    }

    #[test]
    fn the_order_of_lowest_and_highest_is_kept() {
        assert!(joined(&[3, 1, 2, 9]).low_first);
        assert!(!joined(&[3, 9, 1, 2]).low_first);
        assert!(joined(&[5, 5]).low_first);
    }

    #[test]
    fn visits_and_their_time_are_counted() {
        let node = joined(&[0, 1, 1, 0, 0, 1, 0]);
        assert_eq!((node.rises, node.on, node.observed, node.sum, node.count), (2, 3, 6, 3, 7));
    }

    #[test]
    fn what_lies_in_a_gap_was_not_observed() {
        let before = Sample { at: 10, value: 1, gap: false };
        let node = Node::of(Sample { at: 90, value: 1, gap: true }, Some(before));
        assert_eq!((node.on, node.observed, node.rises), (0, 0, 1));
    }
}
