//! Rows of events.

use std::sync::Arc;

use super::ExportError;
use super::names::module_names;
use super::table::{Cell, Column, ColumnKind, Table};
use crate::record::history::History;
use crate::record::objects::{Event, ModuleId, micros_of};
use crate::record::trend::Micros;

/// The events of a history between two times, one a row.
pub struct EventRows {
    columns: Vec<Column>,
    rows: std::vec::IntoIter<(Micros, Vec<Cell>)>,
    span: [Micros; 2],
    header: bool,
}

impl EventRows {
    /// The events from `from` to `to`, both included, without an end where there is `None`: those of `modules`, and
    /// those that concern no module. All modules if there is none in the list.
    pub fn new(history: &History, modules: &[ModuleId], from: Option<Micros>, to: Option<Micros>) -> Self {
        let [from, to] = [from.unwrap_or(Micros::MIN), to.unwrap_or(Micros::MAX)];
        let concerns = |event: &&Event| {
            let module = event.module.is_none_or(|module| modules.is_empty() || modules.contains(&module));
            module && (from..=to).contains(&micros_of(event.at))
        };
        let mut events: Vec<&Event> = history.events().iter().filter(concerns).collect();
        events.sort_by_key(|event| event.at);
        Self::of(history, events)
    }

    /// These events of a history, in this order, which is that of time.
    pub fn of<'a>(history: &History, events: impl IntoIterator<Item = &'a Event>) -> Self {
        let names = module_names(history);
        let row = |event: &Event| {
            let name = event.module.and_then(|module| names.get(&module)).map(String::as_str);
            (micros_of(event.at), cells(event, name))
        };
        let rows: Vec<_> = events.into_iter().map(row).collect();
        let span = [rows.first().map_or(0, |(at, _)| *at), rows.last().map_or(0, |(at, _)| *at)];
        let words = ["module", "kind", "text", "item", "before", "after"];
        let columns = words.map(|name| Column::new(name, ColumnKind::Word));
        let columns = std::iter::once(Column::new("time", ColumnKind::Time)).chain(columns).collect();
        Self { columns, rows: rows.into_iter(), span, header: true }
    }

    /// Rows that go on a file that was begun: CSV has its header already.
    #[must_use]
    pub fn continued(self) -> Self {
        Self { header: false, ..self }
    }
}

fn cells(event: &Event, module: Option<&str>) -> Vec<Cell> {
    let word = |text: Option<&str>| text.map_or(Cell::Empty, |text| Cell::Word(Arc::from(text)));
    let change = event.change.as_ref();
    vec![
        Cell::Time(micros_of(event.at)),
        word(module),
        word(Some(event.kind.name())),
        word(Some(&event.text)),
        word(change.map(|change| change.item.as_str())),
        word(change.and_then(|change| change.before.as_deref())),
        word(change.map(|change| change.after.as_str())),
    ]
}

impl Table for EventRows {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn has_header(&self) -> bool {
        self.header
    }

    fn span(&self) -> [Micros; 2] {
        self.span
    }

    fn next(&mut self, row: &mut Vec<Cell>) -> Result<Option<Micros>, ExportError> {
        let Some((at, cells)) = self.rows.next() else { return Ok(None) };
        *row = cells;
        Ok(Some(at))
    }
}
