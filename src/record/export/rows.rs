//! Rows of samples: one for each time, or one for each sample.

use std::sync::Arc;

use super::ExportError;
use super::merge::Merge;
use super::source::{Source, SourceSeries};
use super::table::{Cell, Column, ColumnKind, Table};
use crate::module::Fixed;
use crate::record::objects::SeriesKind;
use crate::record::trend::Micros;

/// One row for each time at which any series has a sample, or for a short while after it.
pub(super) struct TimeRows {
    merge: Merge,
    /// How much later than its row a sample may be.
    width: Micros,
    columns: Vec<Column>,
    values: Vec<Values>,
}

impl TimeRows {
    pub fn new(source: Source, width: Micros) -> Self {
        let columns = source.series.iter().map(|series| Column::new(&series.column, kind_of(&series.info.kind)));
        let columns = std::iter::once(Column::new("time", ColumnKind::Time)).chain(columns).collect();
        let values = source.series.iter().map(|series| Values::new(&series.info.kind)).collect();
        Self { merge: Merge::new(source), width, columns, values }
    }
}

impl Table for TimeRows {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn span(&self) -> [Micros; 2] {
        self.merge.range()
    }

    fn next(&mut self, row: &mut Vec<Cell>) -> Result<Option<Micros>, ExportError> {
        let Some((at, _)) = self.merge.peek()? else { return Ok(None) };
        let end = at.saturating_add(self.width);
        row.clear();
        row.resize(self.columns.len(), Cell::Empty);
        if let Some(time) = row.first_mut() {
            *time = Cell::Time(at);
        }
        while let Some((next, place)) = self.merge.peek()? {
            let cell = row.get_mut(place.saturating_add(1)).filter(|cell| **cell == Cell::Empty && next <= end);
            let Some(cell) = cell else { break };
            if let (Some((_, sample)), Some(values)) = (self.merge.next()?, self.values.get(place)) {
                *cell = values.cell(sample.value);
            }
        }
        Ok(Some(at))
    }
}

/// One row for each sample.
pub(super) struct SampleRows {
    merge: Merge,
    columns: Vec<Column>,
    series: Vec<Named>,
}

/// What stands in the rows of a series.
struct Named {
    module: Arc<str>,
    item: Arc<str>,
    unit: Arc<str>,
    values: Values,
}

impl SampleRows {
    pub fn new(source: Source) -> Self {
        let columns = [
            ("time", ColumnKind::Time),
            ("module", ColumnKind::Word),
            ("series", ColumnKind::Word),
            ("value", ColumnKind::Value),
            ("unit", ColumnKind::Word),
            ("gap", ColumnKind::Switch),
        ];
        let columns = columns.map(|(name, kind)| Column::new(name, kind)).into();
        let merge = Merge::new(source);
        let series = merge.series().iter().map(Named::new).collect();
        Self { merge, columns, series }
    }
}

impl Named {
    fn new(series: &SourceSeries) -> Self {
        let (item, unit) = (series.info.item.as_str().into(), series.info.unit.as_str().into());
        Self { module: series.module.clone(), item, unit, values: Values::new(&series.info.kind) }
    }
}

impl Table for SampleRows {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn span(&self) -> [Micros; 2] {
        self.merge.range()
    }

    fn next(&mut self, row: &mut Vec<Cell>) -> Result<Option<Micros>, ExportError> {
        let Some((place, sample)) = self.merge.next()? else { return Ok(None) };
        row.clear();
        if let Some(Named { module, item, unit, values }) = self.series.get(place) {
            let unit = if unit.is_empty() { Cell::Empty } else { Cell::Word(unit.clone()) };
            row.extend([
                Cell::Time(sample.at),
                Cell::Word(module.clone()),
                Cell::Word(item.clone()),
                values.cell(sample.value),
                unit,
                Cell::Switch(sample.gap),
            ]);
        }
        Ok(Some(sample.at))
    }
}

fn kind_of(kind: &SeriesKind) -> ColumnKind {
    match kind {
        SeriesKind::Number { .. } => ColumnKind::Number,
        SeriesKind::Switch => ColumnKind::Switch,
        SeriesKind::Choice { .. } => ColumnKind::Word,
    }
}

/// Makes cells of a series' values.
enum Values {
    Number { decimals: u8 },
    Switch,
    Words(Vec<Arc<str>>),
}

impl Values {
    fn new(kind: &SeriesKind) -> Self {
        match kind {
            SeriesKind::Number { decimals } => Self::Number { decimals: *decimals },
            SeriesKind::Switch => Self::Switch,
            SeriesKind::Choice { words } => Self::Words(words.iter().map(|word| word.as_str().into()).collect()),
        }
    }

    fn cell(&self, value: i64) -> Cell {
        match self {
            Self::Number { decimals } => Cell::Number(Fixed::new(value, *decimals)),
            Self::Switch => Cell::Switch(value != 0),
            Self::Words(words) => {
                let word = usize::try_from(value).ok().and_then(|place| words.get(place));
                Cell::Choice(word.cloned().unwrap_or_else(|| value.to_string().into()))
            }
        }
    }
}
