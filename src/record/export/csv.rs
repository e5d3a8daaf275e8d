//! CSV (RFC 4180 with line feeds): a header, then one row a line.

use std::fmt::Write as _;
use std::io::{self, Write};

use jiff::tz::TimeZone;

use super::ExportError;
use super::table::{Cell, Column, Sink};
use super::time::Clock;

const BUFFER: usize = 64 * 1024;

pub(super) struct CsvSink<W: Write> {
    writer: csv::Writer<W>,
    clock: Clock,
    text: String,
}

impl<W: Write> CsvSink<W> {
    /// `header` says whether the names of the columns are written.
    pub fn new(columns: &[Column], header: bool, zone: &TimeZone, writer: W) -> Result<Self, ExportError> {
        let mut writer = csv::WriterBuilder::new().buffer_capacity(BUFFER).from_writer(writer);
        if header {
            writer.write_record(columns.iter().map(|column| &column.name)).map_err(failed)?;
        }
        Ok(Self { writer, clock: Clock::new(zone), text: String::new() })
    }
}

impl<W: Write> Sink for CsvSink<W> {
    fn put(&mut self, row: &[Cell]) -> Result<(), ExportError> {
        let Self { writer, clock, text } = self;
        for cell in row {
            let field = match cell {
                Cell::Empty => "",
                Cell::Time(at) => clock.text(*at)?,
                Cell::Number(number) => {
                    text.clear();
                    // Writing to a string cannot fail.
                    let _ = write!(text, "{number}");
                    text.as_str()
                }
                Cell::Switch(true) => "true",
                Cell::Switch(false) => "false",
                Cell::Word(word) | Cell::Choice(word) => word,
            };
            writer.write_field(field).map_err(failed)?;
        }
        writer.write_record(None::<&[u8]>).map_err(failed)
    }

    fn end(mut self) -> Result<(), ExportError> {
        Ok(self.writer.flush()?)
    }
}

fn failed(error: csv::Error) -> ExportError {
    // Its own conversion hides what kind of error it is.
    ExportError::Write(match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    })
}
