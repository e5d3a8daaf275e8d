//! Up to 512 samples in a row.

use std::cell::Cell;
use std::sync::Arc;

use super::node::Node;
use super::{Micros, Sample};

/// Samples in a block.
pub const BLOCK: usize = 512;
/// Samples whose lowest and highest are known without looking at each: small groups, and large ones.
pub const GROUPS: [usize; 2] = [16, 128];

/// Samples in a group of a sketch.
const SKETCHED: usize = GROUPS[0];
/// Samples that take the room of a group of a sketch.
const SKETCH_COSTS: usize = 3;

/// Samples column by column: twelve bytes each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    first: Micros,
    /// Microseconds after `first`.
    offsets: Vec<u32>,
    values: Vec<i64>,
    /// Indices of samples that do not continue the one before.
    gaps: Vec<u16>,
    /// Of each group of either size the places of its lowest and its highest sample in it.
    extremes: [Vec<[u8; 2]>; 2],
}

impl Columns {
    pub fn len(&self) -> usize {
        self.offsets.len()
    }

    pub fn is_empty(&self) -> bool {
        self.offsets.is_empty()
    }

    /// False if there is no room for it: the block is full, or the sample comes more than 71 minutes after its first.
    pub fn push(&mut self, sample: Sample) -> bool {
        let index = self.len();
        if index == 0 {
            self.first = sample.at;
        }
        let Ok(offset) = u32::try_from(sample.at.saturating_sub(self.first)) else { return false };
        let (Ok(place), true) = (u16::try_from(index), index < BLOCK) else { return false };
        self.offsets.push(offset);
        self.values.push(sample.value);
        if sample.gap {
            self.gaps.push(place);
        }
        self.note_extreme(index, sample.value);
        true
    }

    fn note_extreme(&mut self, index: usize, value: i64) {
        let Self { values, extremes, .. } = self;
        for (groups, size) in extremes.iter_mut().zip(GROUPS) {
            let (begin, place) = (index / size * size, u8::try_from(index % size).unwrap_or_default());
            let Some([low, high]) = groups.get_mut(index / size) else {
                groups.push([place, place]);
                continue;
            };
            let of = |place: u8| values.get(begin.saturating_add(usize::from(place))).copied();
            if of(*low).is_some_and(|lowest| value < lowest) {
                *low = place;
            }
            if of(*high).is_some_and(|highest| value > highest) {
                *high = place;
            }
        }
    }

    pub fn get(&self, index: usize) -> Option<Sample> {
        let at = self.first.saturating_add(i64::from(*self.offsets.get(index)?));
        let gap = u16::try_from(index).is_ok_and(|index| self.gaps.binary_search(&index).is_ok());
        Some(Sample { at, value: *self.values.get(index)?, gap })
    }

    pub fn iter(&self) -> impl Iterator<Item = Sample> {
        (0..self.len()).filter_map(|index| self.get(index))
    }

    /// How many samples are earlier than `at`.
    pub fn count_before(&self, at: Micros) -> usize {
        let after = at.saturating_sub(self.first);
        self.offsets.partition_point(|offset| i64::from(*offset) < after)
    }

    /// The time of a sample, after the first one, in microseconds.
    pub fn offset(&self, index: usize) -> Option<u32> {
        self.offsets.get(index).copied()
    }

    /// The lowest and highest sample of a group of this size (a place in [`GROUPS`]), in order of time.
    pub fn extremes(&self, size: usize, group: usize) -> Option<[Sample; 2]> {
        let [low, high] = *self.extremes.get(size)?.get(group)?;
        let begin = group.saturating_mul(*GROUPS.get(size)?);
        let of = |place: u8| self.get(begin.saturating_add(usize::from(place)));
        Some([of(low.min(high))?, of(low.max(high))?])
    }
}

/// What is known of each group of a block: enough to draw it from a little farther away, in a sixth of the room.
#[derive(Debug, Clone, PartialEq)]
pub struct Sketch {
    first: Micros,
    groups: Vec<Group>,
    /// The longest time from a group's first sample to its last.
    widest: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Group {
    /// Microseconds after the block's first sample.
    first: u32,
    last: u32,
    low: i64,
    high: i64,
    low_first: bool,
    gap: bool,
}

impl Sketch {
    pub fn of(samples: &Columns) -> Self {
        let groups: Vec<Group> =
            (0..samples.extremes.first().map_or(0, Vec::len)).filter_map(|group| samples.group(group)).collect();
        let widest = groups.iter().map(|group| group.last.saturating_sub(group.first)).max().unwrap_or_default();
        Self { first: samples.first, groups, widest }
    }

    /// Of each group two samples, near enough at the times of its lowest and its highest one.
    pub fn iter(&self) -> impl Iterator<Item = [Sample; 2]> {
        self.groups.iter().map(|group| {
            let Group { first, last, low, high, low_first, gap } = *group;
            let (before, after) = if low_first { (low, high) } else { (high, low) };
            let at = |offset: u32| self.first.saturating_add(i64::from(offset));
            [Sample { at: at(first), value: before, gap }, Sample { at: at(last), value: after, gap: false }]
        })
    }

    /// Whether no group is wider than a column of so many microseconds.
    pub fn is_fine_enough(&self, column: f64) -> bool {
        f64::from(self.widest) <= column
    }
}

impl Columns {
    fn group(&self, group: usize) -> Option<Group> {
        let begin = group.checked_mul(SKETCHED)?;
        let end = begin.saturating_add(SKETCHED).min(self.len()).checked_sub(1)?;
        let [earlier, later] = self.extremes(0, group)?;
        let low_first = earlier.value <= later.value;
        let (low, high) = (earlier.value.min(later.value), earlier.value.max(later.value));
        let (first, last) = (*self.offsets.get(begin)?, *self.offsets.get(end)?);
        Some(Group { first, last, low, high, low_first, gap: self.get(begin)?.gap })
    }
}

/// A block with what is known of it. The samples themselves may be on the disk only.
#[derive(Debug, Clone)]
pub struct Block {
    pub node: Node,
    pub samples: Option<Arc<Columns>>,
    /// In place of the samples where they are not needed one by one.
    pub(super) sketch: Option<Arc<Sketch>>,
    /// When the samples come they are wanted as a sketch only.
    pub(super) coarse: bool,
    /// When it was looked at last, counted in looks; 0 is never.
    pub(super) used: Cell<u32>,
}

impl Block {
    pub(super) fn new(node: Node, samples: Option<Arc<Columns>>) -> Self {
        Self { node, samples, sketch: None, coarse: false, used: Cell::default() }
    }

    /// Samples in memory; a sketch counts as so many as would take its room.
    pub fn resident(&self) -> usize {
        let sketch = self.sketch.as_ref().map_or(0, |sketch| sketch.groups.len().saturating_mul(SKETCH_COSTS));
        self.samples.as_ref().map_or(0, |samples| samples.len()).saturating_add(sketch)
    }

    /// Its first sample does not continue the one before it any more.
    pub(super) fn mark_gap(&mut self) {
        self.node.gap = true;
        let Some(samples) = &mut self.samples else { return };
        let samples = Arc::make_mut(samples);
        if samples.gaps.first() != Some(&0) {
            samples.gaps.insert(0, 0);
        }
        // The time since the sample before does not count any more.
        let mut before = None;
        let mut nodes = samples.iter().map(|sample| Node::of(sample, before.replace(sample)));
        if let Some(mut node) = nodes.next() {
            nodes.for_each(|later| node.merge(&later));
            self.node = node;
        }
    }

    /// Whether the samples' lowest and highest in groups would do for columns of so many microseconds.
    pub(super) fn is_coarse_enough(&self, column: f64) -> bool {
        let samples = self.node.count.max(1) as f64;
        self.node.width() as f64 * SKETCHED as f64 / samples <= column
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_block_takes_no_more() {
        let mut columns = Columns::default();
        let taken = (0..600).filter(|at| columns.push(Sample { at: *at, value: *at, gap: false })).count();
        assert_eq!((taken, columns.len(), columns.extremes[0].len()), (BLOCK, BLOCK, BLOCK / 16));
    }

    #[test]
    fn samples_come_out_as_they_went_in() {
        let samples: Vec<Sample> =
            (0..100).map(|i| Sample { at: i * 1_000_000, value: (i * 37) % 11 - 5, gap: i % 30 == 7 }).collect();
        let mut columns = Columns::default();
        assert!(samples.iter().all(|sample| columns.push(*sample)));
        assert_eq!(columns.iter().collect::<Vec<_>>(), samples);
        assert_eq!(columns.count_before(50_000_000), 50);
    }

    #[test]
    fn a_sketch_has_the_extremes_of_each_group() {
        let mut columns = Columns::default();
        (0..40).for_each(|i| assert!(columns.push(Sample { at: i, value: (i * 7) % 16, gap: i == 16 })));
        let sketch = Sketch::of(&columns);
        let sample = |at, value, gap| Sample { at, value, gap };
        let expected = [
            [sample(0, 0, false), sample(15, 15, false)],
            [sample(16, 0, true), sample(31, 15, false)],
            [sample(32, 0, false), sample(39, 14, false)],
        ];
        assert_eq!(sketch.iter().collect::<Vec<_>>(), expected);
        assert!(sketch.is_fine_enough(15.0) && !sketch.is_fine_enough(14.0));
    }

    #[test]
    fn a_long_silence_begins_a_new_block() {
        let mut columns = Columns::default();
        assert!(columns.push(Sample { at: 0, value: 1, gap: false }));
        assert!(!columns.push(Sample { at: 5_000_000_000, value: 1, gap: false }));
    }
}
