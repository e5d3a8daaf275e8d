//! What stands between samples or events and the formats: named columns, and rows of cells.

use std::sync::Arc;

use super::ExportError;
use crate::module::Fixed;
use crate::record::trend::Micros;

/// What the cells of a column are; any may be empty, except times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    Time,
    Number,
    Switch,
    Word,
    /// A number, a switch or a word from row to row.
    Value,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Unique within its table.
    pub name: String,
    pub kind: ColumnKind,
}

impl Column {
    pub fn new(name: impl Into<String>, kind: ColumnKind) -> Self {
        Self { name: name.into(), kind }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub enum Cell {
    #[default]
    Empty,
    Time(Micros),
    /// Exact as the module sent it.
    Number(Fixed),
    Switch(bool),
    /// The word of a choice, which may be a number.
    Choice(Arc<str>),
    Word(Arc<str>),
}

/// Rows in order of time.
pub trait Table {
    fn columns(&self) -> &[Column];

    /// False for rows that go on a file that was begun.
    fn has_header(&self) -> bool {
        true
    }

    /// First and last time that there may be.
    fn span(&self) -> [Micros; 2];

    /// Replaces `row` by the next one, a cell for each column. Returns its time; `None` after the last.
    fn next(&mut self, row: &mut Vec<Cell>) -> Result<Option<Micros>, ExportError>;
}

/// A format that is being written.
pub trait Sink {
    fn put(&mut self, row: &[Cell]) -> Result<(), ExportError>;

    /// Writes what is still held back.
    fn end(self) -> Result<(), ExportError>;
}
