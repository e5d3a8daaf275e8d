//! Takes series of a history away, as CSV, JSON Lines or Parquet.
//!
//! A [`Source`] is what is taken: some series, between two times, as they were when it was made. [`Export::run`] streams
//! it, a few blocks of samples at a time; an [`ExportJob`] does so on a thread of its own, into a file that has its name
//! only once it is whole.
//!
//! ```text
//! source   series by series: samples in order of time
//! merge    all series: samples in order of time
//! rows     one row for each time, or for each sample; also events
//! csv, json, parquet
//! ```

mod csv;
mod events;
mod job;
mod json;
mod merge;
mod names;
mod parquet;
mod rows;
mod source;
mod table;
#[cfg(test)]
mod tests;
mod time;

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;

use jiff::Timestamp;
use jiff::tz::TimeZone;

pub use events::EventRows;
pub use job::ExportJob;
pub use names::{column_name, module_names};
pub use source::Source;
use table::{Sink, Table};

use super::store::StoreError;
use super::trend::Micros;

/// Rows between two looks at whether somebody wants it to end.
const LOOK_UP_EVERY: u64 = 1_024;

/// What kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Csv,
    /// One object a line.
    JsonLines,
    Parquet,
}

impl Format {
    pub const ALL: [Self; 3] = [Self::Csv, Self::JsonLines, Self::Parquet];

    /// The word of the command line, which is also the ending of file names.
    pub fn word(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::JsonLines => "jsonl",
            Self::Parquet => "parquet",
        }
    }

    /// The name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Csv => "CSV",
            Self::JsonLines => "JSON Lines",
            Self::Parquet => "Parquet",
        }
    }

    pub fn by_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.word().eq_ignore_ascii_case(word.trim()))
    }

    /// By the ending of a file's name.
    pub fn of_path(path: &Path) -> Option<Self> {
        path.extension()?.to_str().and_then(Self::by_word)
    }
}

/// What a row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rows {
    /// A time, with one column for each series.
    PerTime,
    /// The same, but what comes up to so many microseconds after a row's time stands in it too, unless its series has a
    /// sample there already: the answers of one poll come one after another.
    Within(Micros),
    /// One sample, with its module and series.
    PerSample,
}

/// How far an export is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Progress {
    pub rows: u64,
    /// Of the time to be exported, 0 to 1.
    pub part: f32,
}

/// Why an export did not come to its end.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    #[error("the export was stopped")]
    Stopped,
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The samples are on the disk, and nobody has given the recording.
    #[error("samples are in the recording only, which is not open – open it again")]
    NoArchive,
    /// Times in UTC.
    #[error(
        "the samples of {series} from {from} to {to} cannot be read, because their recording is damaged or was removed – \
         export a shorter range without them"
    )]
    Missing { series: String, from: Timestamp, to: Timestamp },
    #[error("{0}")]
    Write(io::Error),
}

impl From<io::Error> for ExportError {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// An export of samples.
pub struct Export;

impl Export {
    /// Writes `source` to `writer`. Times in text have the offset of `zone`; Parquet has UTC whatever the zone.
    /// `progress` is called now and then, and ends the export with [`ControlFlow::Break`].
    ///
    /// # Errors
    /// If `writer` fails, samples cannot be read or `progress` ended it.
    pub fn run(
        source: Source,
        format: Format,
        rows: Rows,
        zone: &TimeZone,
        writer: impl Write + Send,
        progress: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Progress, ExportError> {
        match rows {
            Rows::PerTime => write_table(rows::TimeRows::new(source, 0), format, zone, writer, progress),
            Rows::Within(width) => write_table(rows::TimeRows::new(source, width), format, zone, writer, progress),
            Rows::PerSample => write_table(rows::SampleRows::new(source), format, zone, writer, progress),
        }
    }

    /// Writes events, one a row, as CSV or JSON Lines; otherwise as [`Export::run`].
    ///
    /// # Errors
    /// As [`Export::run`].
    pub fn run_events(
        events: EventRows,
        format: Format,
        zone: &TimeZone,
        writer: impl Write + Send,
        progress: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Progress, ExportError> {
        write_table(events, format, zone, writer, progress)
    }
}

fn write_table(
    mut table: impl Table,
    format: Format,
    zone: &TimeZone,
    writer: impl Write + Send,
    mut progress: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Progress, ExportError> {
    let (columns, header) = (table.columns().to_vec(), table.has_header());
    match format {
        Format::Csv => pump(&mut table, csv::CsvSink::new(&columns, header, zone, writer)?, &mut progress),
        Format::JsonLines => pump(&mut table, json::JsonSink::new(&columns, zone, writer), &mut progress),
        Format::Parquet => pump(&mut table, parquet::ParquetSink::new(&columns, writer)?, &mut progress),
    }
}

fn pump(
    table: &mut impl Table,
    mut sink: impl Sink,
    progress: &mut impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Progress, ExportError> {
    let span = table.span();
    let (mut row, mut so_far) = (Vec::new(), Progress::default());
    while let Some(at) = table.next(&mut row)? {
        sink.put(&row)?;
        so_far.rows = so_far.rows.saturating_add(1);
        if so_far.rows.is_multiple_of(LOOK_UP_EVERY) {
            so_far.part = part(span, at);
            if progress(so_far).is_break() {
                return Err(ExportError::Stopped);
            }
        }
    }
    sink.end()?;
    so_far.part = 1.0;
    // It is too late to stop what is done.
    let _ = progress(so_far);
    Ok(so_far)
}

fn part([from, to]: [Micros; 2], at: Micros) -> f32 {
    let (done, whole) = (at.saturating_sub(from), to.saturating_sub(from).max(1));
    (done as f32 / whole as f32).clamp(0.0, 1.0)
}
