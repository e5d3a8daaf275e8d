//! Up to 512 samples in a row.

use std::cell::Cell;
use std::sync::Arc;

use super::node::Node;
use super::{Micros, Sample};

/// Samples in a block.
pub const BLOCK: usize = 512;
/// Samples whose lowest and highest are known without looking at each.
pub const GROUP: usize = 16;

/// Samples column by column: twelve bytes each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    first: Micros,
    /// Microseconds after `first`.
    offsets: Vec<u32>,
    values: Vec<i64>,
    /// Indices of samples that do not continue the one before.
    gaps: Vec<u16>,
    /// Of each group the places of its lowest and its highest sample in it.
    extremes: Vec<[u8; 2]>,
}

impl Columns {
    pub fn len(&self) -> usize {
        self.offsets.len()
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
        let (group, place) = (index / GROUP, u8::try_from(index % GROUP).unwrap_or_default());
        let Some([low, high]) = self.extremes.get(group).copied() else {
            return self.extremes.push([place, place]);
        };
        let of = |place: u8| self.values.get((group * GROUP).saturating_add(usize::from(place))).copied();
        let low = if of(low).is_some_and(|lowest| value < lowest) { place } else { low };
        let high = if of(high).is_some_and(|highest| value > highest) { place } else { high };
        if let Some(extremes) = self.extremes.get_mut(group) {
            *extremes = [low, high];
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

    /// The lowest and highest sample of a group, in order of time.
    pub fn extremes(&self, group: usize) -> Option<[Sample; 2]> {
        let [low, high] = *self.extremes.get(group)?;
        let of = |place: u8| self.get((group * GROUP).saturating_add(usize::from(place)));
        Some([of(low.min(high))?, of(low.max(high))?])
    }
}

/// A block with what is known of it. The samples themselves may be on the disk only.
#[derive(Debug, Clone)]
pub struct Block {
    pub node: Node,
    pub samples: Option<Arc<Columns>>,
    /// When the samples were looked at last, counted in looks.
    pub used: Cell<u32>,
}

impl Block {
    pub fn resident(&self) -> usize {
        self.samples.as_ref().map_or(0, |samples| samples.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_block_takes_no_more() {
        let mut columns = Columns::default();
        let taken = (0..600).filter(|at| columns.push(Sample { at: *at, value: *at, gap: false })).count();
        assert_eq!((taken, columns.len(), columns.extremes.len()), (BLOCK, BLOCK, BLOCK / GROUP));
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
    fn a_long_silence_begins_a_new_block() {
        let mut columns = Columns::default();
        assert!(columns.push(Sample { at: 0, value: 1, gap: false }));
        assert!(!columns.push(Sample { at: 5_000_000_000, value: 1, gap: false }));
    }
}
