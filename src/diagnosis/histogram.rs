//! Answer times in buckets that grow with the time, so that few of them tell 1 ms from 2 ms and 1 s from 2 s.

use std::time::Duration;

use serde::Serialize;

/// Buckets; each reaches a quarter of an octave further than the one before, the last one takes all that is longer.
const BUCKETS: usize = 64;
const BUCKETS_PER_OCTAVE: f64 = 4.0;
/// Upper end of the first bucket, in milliseconds.
const FIRST_MS: f64 = 0.5;

/// How long answers took, in bounded memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    counts: [u64; BUCKETS],
    count: u64,
    least: Duration,
    most: Duration,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: [0; BUCKETS], count: 0, least: Duration::MAX, most: Duration::ZERO }
    }
}

/// A stretch of time and how many answers took so long.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bar {
    pub from_ms: f64,
    pub to_ms: f64,
    pub count: u64,
}

/// What is said of answer times, in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Times {
    pub count: u64,
    pub min_ms: f64,
    pub median_ms: f64,
    /// 99 of 100 answers took no longer.
    pub p99_ms: f64,
    pub max_ms: f64,
}

impl Histogram {
    pub fn add(&mut self, time: Duration) {
        if let Some(count) = self.counts.get_mut(bucket(milliseconds(time))) {
            *count = count.saturating_add(1);
        }
        self.count = self.count.saturating_add(1);
        self.least = self.least.min(time);
        self.most = self.most.max(time);
    }

    pub fn merge(&mut self, other: &Self) {
        for (count, more) in self.counts.iter_mut().zip(other.counts) {
            *count = count.saturating_add(more);
        }
        self.count = self.count.saturating_add(other.count);
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    /// The time, in milliseconds, that this part of all answers (0 to 1) did not exceed: exact to the width of a bucket.
    pub fn quantile(&self, part: f64) -> Option<f64> {
        let wanted = (part.clamp(0.0, 1.0) * self.count as f64).max(1.0);
        let mut before = 0u64;
        for (index, count) in self.counts.iter().enumerate() {
            let upto = before.saturating_add(*count);
            if *count > 0 && upto as f64 >= wanted {
                let (from, to) = bounds(index);
                let inside = (wanted - before as f64) / *count as f64;
                let time = from + (to - from) * inside;
                return Some(time.clamp(milliseconds(self.least), milliseconds(self.most)));
            }
            before = upto;
        }
        None
    }

    /// `None` until there was an answer.
    pub fn times(&self) -> Option<Times> {
        Some(Times {
            count: self.count,
            min_ms: (self.count > 0).then(|| milliseconds(self.least))?,
            median_ms: self.quantile(0.5)?,
            p99_ms: self.quantile(0.99)?,
            max_ms: milliseconds(self.most),
        })
    }

    /// From the first bucket that holds something to the last, the empty ones between included; neighbours are joined until
    /// there are `most` at the most.
    pub fn bars(&self, most: usize) -> Vec<Bar> {
        let used = |count: &u64| *count > 0;
        let (Some(first), Some(last)) = (self.counts.iter().position(used), self.counts.iter().rposition(used)) else {
            return Vec::new();
        };
        let width = last.saturating_sub(first).saturating_add(1).div_ceil(most.max(1)).max(1);
        let indices: Vec<usize> = (first..=last).collect();
        let bars = indices.chunks(width).filter_map(|chunk| {
            let (from_ms, to_ms) = (bounds(*chunk.first()?).0, bounds(*chunk.last()?).1);
            let count = chunk.iter().filter_map(|index| self.counts.get(*index)).sum();
            Some(Bar { from_ms, to_ms, count })
        });
        bars.collect()
    }
}

/// In milliseconds.
pub(super) fn milliseconds(time: Duration) -> f64 {
    time.as_micros() as f64 / 1000.0
}

fn bucket(milliseconds: f64) -> usize {
    if milliseconds <= FIRST_MS {
        return 0;
    }
    let index = ((milliseconds / FIRST_MS).log2() * BUCKETS_PER_OCTAVE).ceil() as usize;
    index.min(BUCKETS.saturating_sub(1))
}

/// From where to where a bucket reaches, in milliseconds.
fn bounds(index: usize) -> (f64, f64) {
    let upto = |index: usize| FIRST_MS * (index as f64 / BUCKETS_PER_OCTAVE).exp2();
    (index.checked_sub(1).map_or(0.0, upto), upto(index))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(times: impl IntoIterator<Item = u64>) -> Histogram {
        let mut histogram = Histogram::default();
        times.into_iter().for_each(|time| histogram.add(Duration::from_micros(time)));
        histogram
    }

    #[test]
    fn quantiles_are_right_to_the_width_of_a_bucket() {
        let times = of((1..=1000).map(|time| time * 100)).times().unwrap();
        assert_eq!((times.count, times.min_ms, times.max_ms), (1000, 0.1, 100.0));
        assert!((times.median_ms - 50.0).abs() < 50.0 * 0.1, "{times:?}");
        assert!((times.p99_ms - 99.0).abs() < 99.0 * 0.1, "{times:?}");
    }

    #[test]
    fn one_answer_is_all_quantiles_and_none_has_none() {
        let times = of([12_345]).times().unwrap();
        assert_eq!((times.min_ms, times.median_ms, times.p99_ms, times.max_ms), (12.345, 12.345, 12.345, 12.345));
        assert_eq!(of([]).times(), None);
        assert!(of([]).bars(10).is_empty());
    }

    #[test]
    fn any_time_has_a_bucket_that_holds_it() {
        for time in [0, 1, 499, 500, 501, 5_000, 1_000_000, 20_000_000] {
            let bars = of([time]).bars(10);
            let [bar] = bars[..] else { panic!("{bars:?}") };
            let time = time as f64 / 1000.0;
            assert!(bar.from_ms <= time && time <= bar.to_ms + 1e-9, "{time} {bar:?}");
        }
        assert_eq!(of([u64::MAX]).bars(10).len(), 1);
    }

    #[test]
    fn bars_are_joined_until_there_are_few_and_lose_nothing() {
        let histogram = of((0..10).map(|power| 1 << (power * 2)));
        let bars = histogram.bars(8);
        assert!(bars.len() <= 8, "{bars:?}");
        assert_eq!(bars.iter().map(|bar| bar.count).sum::<u64>(), 10);
        assert!(bars.windows(2).all(|pair| pair[0].to_ms == pair[1].from_ms));
    }

    #[test]
    fn two_histograms_become_one() {
        let mut all = of([1_000, 2_000]);
        all.merge(&of([9_000]));
        assert_eq!(all, of([1_000, 2_000, 9_000]));
    }
}
