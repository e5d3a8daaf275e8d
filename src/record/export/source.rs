//! Which samples are taken away: series of a history between two times, as they were when it was made.

use std::collections::VecDeque;
use std::sync::Arc;

use super::ExportError;
use super::names::{column_name, module_names};
use crate::record::history::{History, Series};
use crate::record::objects::{SeriesId, SeriesInfo, timestamp};
use crate::record::store::Archive;
use crate::record::trend::{Block, Columns, Micros, Sample};

/// Series between two times, both included. Later changes of the history do not show.
pub struct Source {
    pub(super) series: Vec<SourceSeries>,
    archive: Option<Box<dyn Archive>>,
    range: [Micros; 2],
}

/// A series that is taken away.
pub(super) struct SourceSeries {
    id: SeriesId,
    pub info: SeriesInfo,
    /// The module's unique name.
    pub module: Arc<str>,
    /// The unique name of the series with its unit, for headers.
    pub column: String,
    blocks: VecDeque<Stretch>,
    /// Samples of the stretch that is being taken, not yet taken.
    samples: VecDeque<Sample>,
}

/// A block; its samples may be on the disk only.
struct Stretch {
    first: Micros,
    last: Micros,
    count: u64,
    samples: Option<Arc<Columns>>,
}

impl Source {
    /// The series `series` of `history` from `from` to `to`, without an end where there is `None`. What is not in memory
    /// is fetched from `archive`. Series that are not there are left out.
    pub fn new(
        history: &History,
        series: &[SeriesId],
        from: Option<Micros>,
        to: Option<Micros>,
        archive: Option<Box<dyn Archive>>,
    ) -> Self {
        let asked = [from.unwrap_or(Micros::MIN), to.unwrap_or(Micros::MAX)];
        let names = module_names(history);
        let taken = series.iter().filter_map(|id| {
            let known = history.get(*id)?;
            let module = names.get(&known.info.module)?;
            Some(SourceSeries::new(*id, known, module, asked))
        });
        let series: Vec<SourceSeries> = taken.collect();
        let first = series.iter().filter_map(|one| one.blocks.front()).map(|block| block.first).min();
        let last = series.iter().filter_map(|one| one.blocks.back()).map(|block| block.last).max();
        let [from, to] = asked;
        let range = [first.unwrap_or(0).max(from), last.unwrap_or(0).min(to)];
        Self { series, archive, range }
    }

    /// First and last time that a sample may have.
    pub(super) fn range(&self) -> [Micros; 2] {
        self.range
    }

    /// The next sample of the series at `place`; `None` after its last.
    pub(super) fn next(&mut self, place: usize) -> Result<Option<Sample>, ExportError> {
        let Self { series, archive, range } = self;
        let Some(series) = series.get_mut(place) else { return Ok(None) };
        loop {
            if let Some(sample) = series.samples.pop_front() {
                return Ok(Some(sample));
            }
            let Some(stretch) = series.blocks.pop_front() else { return Ok(None) };
            let samples = stretch.samples(series.id, archive.as_deref_mut(), *range)?;
            if stretch.lacks(&samples, *range) {
                let last = series.last_lacking(archive.as_deref_mut(), *range)?.unwrap_or(stretch.last);
                let series = series.column.clone();
                return Err(ExportError::Missing { series, from: timestamp(stretch.first), to: timestamp(last) });
            }
            series.samples = samples;
        }
    }
}

impl SourceSeries {
    fn new(id: SeriesId, series: &Series, module: &str, [from, to]: [Micros; 2]) -> Self {
        let inside = |block: &&Block| block.node.last >= from && block.node.first <= to;
        let stretch = |Block { node, samples, .. }: &Block| {
            let (first, last, count) = (node.first, node.last, node.count);
            Stretch { first, last, count, samples: samples.clone() }
        };
        Self {
            id,
            info: series.info.clone(),
            module: module.into(),
            column: column_name(module, &series.info),
            blocks: series.trend.blocks().iter().filter(inside).map(stretch).collect(),
            samples: VecDeque::new(),
        }
    }

    /// The last time of the next stretches that lack samples, up to the first that has all of them.
    fn last_lacking(
        &self,
        mut archive: Option<&mut (dyn Archive + 'static)>,
        range: [Micros; 2],
    ) -> Result<Option<Micros>, ExportError> {
        let mut last = None;
        for stretch in &self.blocks {
            let samples = stretch.samples(self.id, archive.as_deref_mut(), range)?;
            if !stretch.lacks(&samples, range) {
                break;
            }
            last = Some(stretch.last);
        }
        Ok(last)
    }
}

impl Stretch {
    fn samples(
        &self,
        series: SeriesId,
        archive: Option<&mut (dyn Archive + 'static)>,
        [from, to]: [Micros; 2],
    ) -> Result<VecDeque<Sample>, ExportError> {
        let inside = |sample: &Sample| (from..=to).contains(&sample.at);
        match &self.samples {
            Some(samples) => Ok(samples.iter().filter(inside).collect()),
            None => {
                let archive = archive.ok_or(ExportError::NoArchive)?;
                let fetched = archive.samples(series, self.first.max(from), self.last.min(to))?;
                Ok(fetched.into_iter().filter(inside).collect())
            }
        }
    }

    /// Of a stretch that is cut by the range it is not known how many samples it should bring.
    fn lacks(&self, samples: &VecDeque<Sample>, [from, to]: [Micros; 2]) -> bool {
        from <= self.first && self.last <= to && (samples.len() as u64) < self.count
    }
}
