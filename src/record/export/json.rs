//! JSON Lines: one object for each row, without the names of empty cells.

use std::io::{self, BufWriter, Write};

use jiff::tz::TimeZone;

use super::ExportError;
use super::table::{Cell, Column, Sink};
use super::time::Clock;

const BUFFER: usize = 64 * 1024;

pub(super) struct JsonSink<W: Write> {
    writer: BufWriter<W>,
    clock: Clock,
    /// `"name":` of each column.
    names: Vec<String>,
}

impl<W: Write> JsonSink<W> {
    pub fn new(columns: &[Column], zone: &TimeZone, writer: W) -> Self {
        let names = columns.iter().map(|column| format!("{}:", serde_json::Value::from(column.name.as_str())));
        Self { writer: BufWriter::with_capacity(BUFFER, writer), clock: Clock::new(zone), names: names.collect() }
    }
}

impl<W: Write> Sink for JsonSink<W> {
    fn put(&mut self, row: &[Cell]) -> Result<(), ExportError> {
        let Self { writer, clock, names } = self;
        let mut before = "{";
        for (cell, name) in row.iter().zip(names).filter(|(cell, _)| **cell != Cell::Empty) {
            write!(writer, "{before}{name}")?;
            before = ",";
            match cell {
                Cell::Empty => {}
                Cell::Time(at) => write!(writer, "\"{}\"", clock.text(*at)?)?,
                // Its digits are those of JSON, and remain the module's own.
                Cell::Number(number) => write!(writer, "{number}")?,
                Cell::Switch(on) => write!(writer, "{on}")?,
                Cell::Choice(word) if is_number(word) => write!(writer, "{word}")?,
                Cell::Choice(word) | Cell::Word(word) => {
                    serde_json::to_writer(&mut *writer, &**word).map_err(io::Error::from)?;
                }
            }
        }
        Ok(writer.write_all(b"}\n")?)
    }

    fn end(mut self) -> Result<(), ExportError> {
        Ok(self.writer.flush()?)
    }
}

/// As everywhere in the program's JSON: a choice whose word is a number is one, if it reads back as the same word.
fn is_number(word: &str) -> bool {
    word.parse::<i64>().is_ok_and(|number| number.to_string() == word)
}
