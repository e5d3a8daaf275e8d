//! The history of one reading: every sample, with what is known of ever longer stretches, so that drawing a month costs
//! the same as drawing a minute and no peak is hidden.
//!
//! Samples stand in blocks of up to 512. Of each block, and of each 16, 256, 4096 and 65 536 blocks, the lowest and
//! highest value are known, with what statistics need. The samples of a block that is on the disk may be given up; whoever
//! looks at them notes that they are wanted ([`Trend::take_wanted`]), and they come back by [`Trend::fill`].

mod block;
mod draw;
mod node;
mod statistics;
#[cfg(test)]
mod tests;

use std::cell::{Cell, RefCell};
use std::sync::Arc;

use block::Sketch;
pub use block::{BLOCK, Block, Columns};
pub use node::Node;
pub use statistics::Statistics;

/// Microseconds since 1970 UTC.
pub type Micros = i64;

/// One value at its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    pub at: Micros,
    /// In units of the series' last decimal.
    pub value: i64,
    /// It does not continue the sample before: samples are missing between them.
    pub gap: bool,
}

/// Seconds since 1970 UTC and the value, as plots take them.
pub type Point = [f64; 2];

/// How many nodes of one level are one of the next.
const FAN: usize = 16;
/// Levels above the blocks; nodes of the highest stand for 33 million samples each.
const LEVELS: usize = 4;
/// Stretches that may be wanted at a time; what is wanted beyond it is wanted again at the next look.
const MOST_WANTED: usize = 256;

/// Samples in order of time, with the gaps where none could be taken.
#[derive(Debug, Clone, Default)]
pub struct Trend {
    decimals: u8,
    blocks: Vec<Block>,
    levels: [Vec<Node>; LEVELS],
    last: Option<Sample>,
    gap: bool,
    /// Looks so far, by which it is known what was not looked at for long.
    looks: Cell<u32>,
    /// Stretches that were looked at and are not in memory.
    wanted: RefCell<Vec<Want>>,
}

/// The samples next to a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    /// At that time or before it.
    pub before: Option<Point>,
    pub after: Option<Point>,
    /// There is no gap between the two.
    pub joined: bool,
}

/// A block whose samples are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Want {
    block: usize,
    /// A sketch is enough.
    coarse: bool,
}

/// Microseconds since 1970 of a time in seconds.
pub fn micros(seconds: f64) -> Micros {
    (seconds * 1e6).round() as Micros
}

/// Seconds since 1970 of a time in microseconds.
pub fn seconds(at: Micros) -> f64 {
    at as f64 / 1e6
}

impl Trend {
    /// A trend whose values are in units of so many decimals.
    pub fn new(decimals: u8) -> Self {
        Self { decimals, ..Self::default() }
    }

    /// Adds a sample and gives it back as it stands here; one that is not later than the last is dropped.
    pub fn push(&mut self, at: Micros, value: i64) -> Option<Sample> {
        if self.last.is_some_and(|last| at <= last.at) {
            return None;
        }
        let sample = Sample { at, value, gap: std::mem::take(&mut self.gap) && self.last.is_some() };
        let node = Node::of(sample, self.last);
        self.last = Some(sample);
        if self.append(sample, &node) {
            let index = self.blocks.len().saturating_sub(1);
            self.lift(index, &node);
        }
        Some(sample)
    }

    /// Samples are missing from here on: the line is not drawn through.
    pub fn mark_gap(&mut self) {
        self.gap = true;
    }

    /// Adds a stretch whose samples are on the disk only. `last` is its last sample.
    pub fn push_stored(&mut self, node: Node, last: Sample) {
        if self.last.is_some_and(|end| node.first <= end.at) {
            return;
        }
        self.gap = false;
        self.last = Some(last);
        self.blocks.push(Block::new(node, None));
        self.lift(self.blocks.len().saturating_sub(1), &node);
    }

    fn append(&mut self, sample: Sample, node: &Node) -> bool {
        if let Some(Block { node: known, samples: Some(samples), .. }) = self.blocks.last_mut()
            && Arc::make_mut(samples).push(sample)
        {
            known.merge(node);
            return true;
        }
        let mut columns = Columns::default();
        let taken = columns.push(sample);
        self.blocks.push(Block::new(*node, Some(Arc::new(columns))));
        taken
    }

    /// Takes a stretch at the end of block `index` into the levels above.
    fn lift(&mut self, index: usize, node: &Node) {
        let mut place = index;
        for level in &mut self.levels {
            place /= FAN;
            match level.get_mut(place) {
                Some(known) => known.merge(node),
                None => level.push(*node),
            }
        }
    }

    pub fn decimals(&self) -> u8 {
        self.decimals
    }

    /// What a value in units of the last decimal is divided by.
    fn scale(&self) -> f64 {
        10f64.powi(i32::from(self.decimals))
    }

    fn point(&self, sample: Sample) -> Point {
        [seconds(sample.at), sample.value as f64 / self.scale()]
    }

    /// Samples, in memory or on the disk.
    pub fn len(&self) -> u64 {
        self.blocks.iter().map(|block| block.node.count).fold(0, u64::saturating_add)
    }

    pub fn is_empty(&self) -> bool {
        self.last.is_none()
    }

    /// Samples in memory.
    pub fn resident(&self) -> usize {
        self.blocks.iter().map(Block::resident).sum()
    }

    /// The blocks in order of time; for whoever takes the samples away.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub fn first(&self) -> Option<f64> {
        self.blocks.first().map(|block| seconds(block.node.first))
    }

    pub fn last(&self) -> Option<Point> {
        self.last.map(|last| self.point(last))
    }

    /// The last sample as it was pushed.
    pub fn last_sample(&self) -> Option<Sample> {
        self.last
    }

    /// The sample nearest in time; none while it is on the disk only.
    pub fn nearest(&self, at: f64) -> Option<Point> {
        let at = micros(at);
        let candidates = [self.sample_before(at).ok()?, self.sample_from(at).ok()?];
        let distance = |sample: &Sample| sample.at.abs_diff(at);
        candidates.into_iter().flatten().min_by_key(distance).map(|sample| self.point(sample))
    }

    /// The samples around a time; none while they are on the disk only.
    pub fn around(&self, at: f64) -> Option<Around> {
        let at = micros(at);
        let (before, after) =
            (self.sample_before(at.saturating_add(1)).ok()?, self.sample_from(at.saturating_add(1)).ok()?);
        let joined = before.is_some() && after.is_some_and(|after| !after.gap);
        let point = |sample: Option<Sample>| sample.map(|sample| self.point(sample));
        Some(Around { before: point(before), after: point(after), joined })
    }

    /// Whether something that was looked at is on the disk only.
    pub fn is_wanting(&self) -> bool {
        !self.wanted.borrow().is_empty()
    }

    /// The last sample earlier than `at`.
    fn sample_before(&self, at: Micros) -> Result<Option<Sample>, Absent> {
        let Some(index) = self.blocks.partition_point(|block| block.node.first < at).checked_sub(1) else {
            return Ok(None);
        };
        let samples = self.samples(index)?;
        Ok(samples.count_before(at).checked_sub(1).and_then(|place| samples.get(place)))
    }

    /// The first sample at `at` or later.
    fn sample_from(&self, at: Micros) -> Result<Option<Sample>, Absent> {
        let index = self.blocks.partition_point(|block| block.node.last < at);
        if index >= self.blocks.len() {
            return Ok(None);
        }
        let samples = self.samples(index)?;
        Ok(samples.get(samples.count_before(at)))
    }

    /// The samples of a block; notes that they are wanted if they are on the disk only.
    fn samples(&self, index: usize) -> Result<&Columns, Absent> {
        let block = self.blocks.get(index).ok_or(Absent)?;
        block.used.set(self.looks.get());
        if let Some(samples) = &block.samples {
            return Ok(samples);
        }
        self.want(index, false);
        Err(Absent)
    }

    fn want(&self, block: usize, coarse: bool) {
        let mut wanted = self.wanted.borrow_mut();
        if let Some(want) = wanted.iter_mut().find(|want| want.block == block) {
            want.coarse &= coarse;
        } else if wanted.len() < MOST_WANTED {
            wanted.push(Want { block, coarse });
        }
    }

    /// The stretches that were looked at since this was last asked and are on the disk only: first and last time.
    pub fn take_wanted(&mut self) -> Vec<[Micros; 2]> {
        let mut stretches = Vec::new();
        for Want { block, coarse } in self.wanted.take() {
            if let Some(block) = self.blocks.get_mut(block) {
                block.coarse = coarse;
                stretches.push([block.node.first, block.node.last]);
            }
        }
        stretches
    }

    /// Takes in the samples of stretches that were wanted, in order of time; what belongs to no such stretch as a whole
    /// is left out. How many more samples are in memory now.
    pub fn fill(&mut self, samples: &[Sample]) -> usize {
        let mut more = 0usize;
        let Some(from) = samples.first() else { return more };
        let begin = self.blocks.partition_point(|block| block.node.first < from.at);
        let mut rest = samples;
        for block in self.blocks.iter_mut().skip(begin) {
            let inside = rest.partition_point(|sample| sample.at <= block.node.last);
            let (of_block, after) = rest.split_at_checked(inside).unwrap_or((rest, &[]));
            rest = after;
            if block.samples.is_none() && of_block.len() as u64 == block.node.count {
                let before = block.resident();
                take_in(block, of_block);
                block.used.set(self.looks.get());
                more = more.saturating_add(block.resident().saturating_sub(before));
            }
            if rest.is_empty() {
                break;
            }
        }
        more
    }

    /// Gives up the samples of a full block that end before `saved`, if they were looked at last at `look` or before. The
    /// number of samples given up.
    pub fn give_up(&mut self, saved: Micros, look: u32) -> usize {
        let last = self.blocks.len().saturating_sub(1);
        let old = self.blocks.iter_mut().take(last).filter(|block| block.node.last < saved && block.used.get() <= look);
        old.map(|block| {
            let resident = block.resident();
            (block.samples, block.sketch) = (None, None);
            resident
        })
        .sum()
    }

    /// Forgets the oldest samples that are in memory, so many at least, as whole blocks; what is on the disk stays. Where
    /// they were is a gap. How many it forgot.
    pub fn forget_oldest(&mut self, samples: usize) -> usize {
        let last = self.blocks.len().saturating_sub(1);
        let (mut forgotten, mut gap, mut kept) = (0usize, false, Vec::with_capacity(self.blocks.len()));
        for (index, mut block) in std::mem::take(&mut self.blocks).into_iter().enumerate() {
            if block.samples.is_some() && forgotten < samples && index < last {
                forgotten = forgotten.saturating_add(block.resident());
                gap = true;
                continue;
            }
            if std::mem::take(&mut gap) {
                block.mark_gap();
            }
            kept.push(block);
        }
        self.blocks = kept;
        self.wanted.take();
        self.levels = Default::default();
        for index in 0..self.blocks.len() {
            if let Some(node) = self.blocks.get(index).map(|block| block.node) {
                self.lift(index, &node);
            }
        }
        forgotten
    }

    /// How often it was looked at.
    pub fn looks(&self) -> u32 {
        self.looks.get()
    }

    /// Begins a look: what is drawn from now on counts as looked at later.
    fn look(&self) {
        self.looks.set(self.looks.get().saturating_add(1));
    }
}

/// The samples of the whole block have come.
fn take_in(block: &mut Block, samples: &[Sample]) {
    let mut columns = Columns::default();
    if !samples.iter().all(|sample| columns.push(*sample)) {
        return;
    }
    if block.coarse {
        block.sketch = Some(Arc::new(Sketch::of(&columns)));
    } else {
        (block.samples, block.sketch) = (Some(Arc::new(columns)), None);
    }
}

/// The samples are on the disk only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Absent;
