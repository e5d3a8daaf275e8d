//! The recent history of one reading.

/// Seconds since 1970 UTC and the value.
pub type Sample = [f64; 2];

/// Samples in order of time, bounded in number, with the gaps where none could be taken.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trend {
    samples: Vec<Sample>,
    /// Indices of samples that do not continue the one before.
    breaks: Vec<usize>,
    gap: bool,
}

impl Trend {
    /// Samples kept: a day at two a second.
    pub const CAPACITY: usize = 172_800;

    /// Adds a sample; one that is not later than the last is dropped.
    pub fn push(&mut self, seconds: f64, value: f64) {
        if self.samples.last().is_some_and(|last| seconds <= last[0]) || !value.is_finite() {
            return;
        }
        if self.samples.len() >= Self::CAPACITY {
            self.forget_oldest(Self::CAPACITY / 4);
        }
        if std::mem::take(&mut self.gap) && !self.samples.is_empty() {
            self.breaks.push(self.samples.len());
        }
        self.samples.push([seconds, value]);
    }

    /// Samples are missing from here on: the line is not drawn through.
    pub fn mark_gap(&mut self) {
        self.gap = true;
    }

    fn forget_oldest(&mut self, count: usize) {
        self.samples.drain(..count.min(self.samples.len()));
        self.breaks.retain(|index| *index > count);
        for index in &mut self.breaks {
            *index = index.saturating_sub(count);
        }
    }

    pub fn len(&self) -> usize {
        self.samples.len()
    }

    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    pub fn last(&self) -> Option<Sample> {
        self.samples.last().copied()
    }

    /// The sample nearest in time to `seconds`.
    pub fn nearest(&self, seconds: f64) -> Option<Sample> {
        let after = self.samples.partition_point(|sample| sample[0] < seconds);
        let candidates = [after.checked_sub(1), Some(after)];
        let distance = |sample: &Sample| (sample[0] - seconds).abs();
        candidates
            .into_iter()
            .flatten()
            .filter_map(|index| self.samples.get(index))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .copied()
    }

    /// Lowest and highest value between two times.
    pub fn extremes(&self, from: f64, to: f64) -> Option<(f64, f64)> {
        let range = self.range(from, to);
        let samples = self.samples.get(range)?;
        let first = samples.first()?[1];
        Some(samples.iter().fold((first, first), |(low, high), sample| (low.min(sample[1]), high.max(sample[1]))))
    }

    /// What to draw between two times, one line for each unbroken stretch; of each of `buckets` equal spans at most
    /// its lowest and highest sample, in order of time, so that no peak is hidden. One sample beyond each end is
    /// included, so that lines reach the edges.
    pub fn lines(&self, from: f64, to: f64, buckets: usize) -> Vec<Vec<Sample>> {
        let range = self.range(from, to);
        let (start, end) = (range.start.saturating_sub(1), range.end.saturating_add(1).min(self.samples.len()));
        let cuts = self.breaks.iter().copied().filter(|index| *index > start && *index < end);
        let mut lines = Vec::new();
        let mut begin = start;
        for cut in cuts.chain([end]) {
            let stretch = self.samples.get(begin..cut).unwrap_or_default();
            if !stretch.is_empty() {
                lines.push(decimate(stretch, from, to, buckets));
            }
            begin = cut;
        }
        lines
    }

    fn range(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let start = self.samples.partition_point(|sample| sample[0] < from);
        let end = self.samples.partition_point(|sample| sample[0] <= to);
        start..end.max(start)
    }
}

fn decimate(samples: &[Sample], from: f64, to: f64, buckets: usize) -> Vec<Sample> {
    if samples.len() <= buckets.saturating_mul(2) || to <= from || buckets == 0 {
        return samples.to_vec();
    }
    let bucket_of = |sample: &Sample| ((sample[0] - from) / (to - from) * buckets as f64).floor();
    samples
        .chunk_by(|a, b| bucket_of(a) == bucket_of(b))
        .flat_map(|bucket| {
            let low = bucket.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1]));
            let high = bucket.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1]));
            let (first, second) = if low.map(|s| s[0]) <= high.map(|s| s[0]) { (low, high) } else { (high, low) };
            [first, second.filter(|_| low != high)]
        })
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trend(samples: impl IntoIterator<Item = (f64, f64)>) -> Trend {
        let mut trend = Trend::default();
        samples.into_iter().for_each(|(at, value)| trend.push(at, value));
        trend
    }

    #[test]
    fn a_single_peak_among_many_samples_is_drawn() {
        let trend = trend((0..100_000).map(|i| (f64::from(i), if i == 54_321 { 99.0 } else { 1.0 })));
        let lines = trend.lines(0.0, 100_000.0, 500);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].len() <= 1_004, "{}", lines[0].len());
        assert!(lines[0].contains(&[54_321.0, 99.0]));
        assert!(lines[0].is_sorted_by_key(|sample| sample[0]));
    }

    #[test]
    fn a_gap_splits_the_line() {
        let mut trend = trend([(1.0, 1.0), (2.0, 2.0)]);
        trend.mark_gap();
        trend.push(9.0, 3.0);
        assert_eq!(trend.lines(0.0, 10.0, 100), [vec![[1.0, 1.0], [2.0, 2.0]], vec![[9.0, 3.0]]]);
    }

    #[test]
    fn old_samples_make_room_and_gaps_stay_in_place() {
        let mut trend = trend((0..Trend::CAPACITY as u32).map(|i| (f64::from(i), 0.0)));
        trend.mark_gap();
        trend.push(1e9, 1.0);
        assert!(trend.len() <= Trend::CAPACITY);
        assert_eq!(trend.lines(0.0, 2e9, 100).len(), 2);
    }

    #[test]
    fn time_never_goes_back() {
        let trend = trend([(2.0, 1.0), (1.0, 5.0), (3.0, 2.0)]);
        assert_eq!(trend.len(), 2);
        assert_eq!(trend.nearest(2.4), Some([2.0, 1.0]));
    }
}
