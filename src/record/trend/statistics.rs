//! Figures of a stretch of a trend, without looking at each of its samples.

use super::node::Node;
use super::{FAN, LEVELS, Micros, Sample, Trend, micros};

/// What is to be said of the samples between two times.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Statistics {
    pub count: u64,
    pub low: f64,
    pub high: f64,
    /// Of the samples.
    pub mean: f64,
    /// How often it came on: for switches, above all for motion.
    pub times: u64,
    /// It was on already when the time began.
    pub on_at_start: bool,
    /// Seconds during which it was on. A sample stands for the time until the next one.
    pub on: f64,
    /// Seconds that were observed, which is less than the span where samples are missing.
    pub observed: f64,
}

impl Trend {
    /// Lowest and highest value between two times; of what is on the disk only, as near as it is known without it.
    pub fn extremes(&self, from: f64, to: f64) -> Option<(f64, f64)> {
        let (from, to) = (micros(from), micros(to));
        let mut found: Option<(i64, i64)> = None;
        let mut note = |low: i64, high: i64| {
            found = Some(found.map_or((low, high), |(lowest, highest)| (lowest.min(low), highest.max(high))));
        };
        self.within(from, to, &mut |part| match part {
            Part::Whole(node) => note(node.low, node.high),
            Part::Sample(sample, _) => note(sample.value, sample.value),
            Part::Absent(node) => note(node.low, node.high),
        });
        found.map(|(low, high)| (low as f64 / self.scale(), high as f64 / self.scale()))
    }

    /// Figures of the samples between two times. `None` if there are none, or while some are still to be fetched.
    pub fn statistics(&self, from: f64, to: f64) -> Option<Statistics> {
        self.look();
        let (from, to) = (micros(from), micros(to).max(micros(from)));
        let (before, after) = (self.sample_before(from).ok()?, self.sample_from(to.saturating_add(1)).ok()?);
        let (mut all, mut last, mut complete) = (None::<Node>, None::<Micros>, true);
        let mut add = |node: &Node| match &mut all {
            Some(all) => all.merge(node),
            None => all = Some(*node),
        };
        self.within(from, to, &mut |part| match part {
            Part::Whole(node) => add(node),
            Part::Sample(sample, before) => add(&Node::of(sample, before)),
            Part::Absent(_) => complete = false,
        });
        if !complete {
            return None;
        }
        if let Some(all) = &all {
            last = Some(all.last);
        }
        let end = match last {
            Some(_) => self.sample_before(to.saturating_add(1)).ok()?,
            None => before,
        };
        let mut result = all.map(|node| self.of_node(&node)).unwrap_or_default();
        self.cut_edges(&mut result, all.as_ref(), [from, to], before, end, after);
        (result.count > 0 || result.observed > 0.0).then_some(result)
    }

    fn of_node(&self, node: &Node) -> Statistics {
        let scale = self.scale();
        Statistics {
            count: node.count,
            low: node.low as f64 / scale,
            high: node.high as f64 / scale,
            mean: node.sum as f64 / node.count.max(1) as f64 / scale,
            times: node.rises,
            on_at_start: false,
            on: node.on as f64 / 1e6,
            observed: node.observed as f64 / 1e6,
        }
    }

    /// A sample stands for the time until the next one, of which only what lies between the two times counts.
    fn cut_edges(
        &self,
        result: &mut Statistics,
        all: Option<&Node>,
        [from, to]: [Micros; 2],
        before: Option<Sample>,
        end: Option<Sample>,
        after: Option<Sample>,
    ) {
        let span = |from: Micros, to: Micros| to.saturating_sub(from) as f64 / 1e6;
        let continues = |next_gap: bool, sample: Option<Sample>| sample.filter(|_| !next_gap);
        if let Some(all) = all
            && let Some(before) = continues(all.gap, before)
        {
            let outside = span(before.at, from);
            result.observed -= outside;
            if before.value != 0 {
                result.on -= outside;
                result.on_at_start = true;
            }
        }
        let Some(after) = after else { return };
        let Some(end) = continues(after.gap, end) else { return };
        let begin = end.at.max(from);
        result.observed += span(begin, to);
        if end.value != 0 {
            result.on += span(begin, to);
            result.on_at_start |= all.is_none();
        }
    }

    /// Tells of everything between two times, in the largest stretches that lie inside as a whole.
    fn within(&self, from: Micros, to: Micros, tell: &mut dyn FnMut(Part<'_>)) {
        let top = self.levels.last().map_or(0, Vec::len);
        let begin = self.levels.last().map_or(0, |nodes| nodes.partition_point(|node| node.last < from));
        for index in begin..top {
            if !self.part(LEVELS, index, from, to, tell) {
                return;
            }
        }
    }

    fn part(&self, level: usize, index: usize, from: Micros, to: Micros, tell: &mut dyn FnMut(Part<'_>)) -> bool {
        let Some(node) = self.node(level, index) else { return false };
        if node.first > to {
            return false;
        }
        if node.last < from {
            return true;
        }
        if node.first >= from && node.last <= to {
            tell(Part::Whole(node));
            return true;
        }
        let Some(below) = level.checked_sub(1) else {
            self.samples_between(index, node, from, to, tell);
            return true;
        };
        let children = index.saturating_mul(FAN)..index.saturating_add(1).saturating_mul(FAN);
        children.into_iter().all(|child| self.part(below, child, from, to, tell))
    }

    fn samples_between(&self, index: usize, node: &Node, from: Micros, to: Micros, tell: &mut dyn FnMut(Part<'_>)) {
        let Ok(samples) = self.samples(index) else { return tell(Part::Absent(node)) };
        let (begin, end) = (samples.count_before(from), samples.count_before(to.saturating_add(1)));
        let before = match begin.checked_sub(1) {
            Some(place) => Ok(samples.get(place)),
            None => self.sample_before(node.first),
        };
        let Ok(mut before) = before else { return tell(Part::Absent(node)) };
        for sample in (begin..end).filter_map(|place| samples.get(place)) {
            tell(Part::Sample(sample, before));
            before = Some(sample);
        }
    }
}

/// What lies between two times.
enum Part<'a> {
    Whole(&'a Node),
    /// A sample and the one before it.
    Sample(Sample, Option<Sample>),
    /// A stretch that lies across an end, and whose samples are on the disk only.
    Absent(&'a Node),
}
