//! The samples of several series in order of time.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::ExportError;
use super::source::{Source, SourceSeries};
use crate::record::trend::{Micros, Sample};

/// Samples by time; those of the same time in the order of their series.
pub(super) struct Merge {
    source: Source,
    /// Of each series the time of its next sample and its place; nothing before the first sample was asked for.
    next: Option<BinaryHeap<Reverse<(Micros, usize)>>>,
    /// The next sample of each series.
    heads: Vec<Option<Sample>>,
}

impl Merge {
    pub fn new(source: Source) -> Self {
        Self { source, next: None, heads: Vec::new() }
    }

    pub fn series(&self) -> &[SourceSeries] {
        &self.source.series
    }

    pub fn range(&self) -> [Micros; 2] {
        self.source.range()
    }

    /// The next sample with the place of its series.
    pub fn next(&mut self) -> Result<Option<(usize, Sample)>, ExportError> {
        let Some((_, place)) = self.peek()? else { return Ok(None) };
        if let Some(heap) = &mut self.next {
            heap.pop();
        }
        let sample = self.heads.get_mut(place).and_then(Option::take);
        self.advance(place)?;
        Ok(sample.map(|sample| (place, sample)))
    }

    /// The time of the next sample, and the place of its series.
    pub fn peek(&mut self) -> Result<Option<(Micros, usize)>, ExportError> {
        if self.next.is_none() {
            self.begin()?;
        }
        let first = self.next.as_ref().and_then(BinaryHeap::peek);
        Ok(first.map(|Reverse(first)| *first))
    }

    fn begin(&mut self) -> Result<(), ExportError> {
        let count = self.source.series.len();
        self.next = Some(BinaryHeap::with_capacity(count));
        self.heads = vec![None; count];
        (0..count).try_for_each(|place| self.advance(place))
    }

    fn advance(&mut self, place: usize) -> Result<(), ExportError> {
        let Some(sample) = self.source.next(place)? else { return Ok(()) };
        if let (Some(heap), Some(head)) = (&mut self.next, self.heads.get_mut(place)) {
            heap.push(Reverse((sample.at, place)));
            *head = Some(sample);
        }
        Ok(())
    }
}
