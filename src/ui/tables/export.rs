//! Lists as files, made in steps so that the window goes on.

use std::io;

use serde::Serialize;

use crate::bench::traffic::{FrameRef, append_csv, write_csv, write_json_lines};
use crate::bench::{Bench, Entry};
use crate::capture::{self, CaptureWriter};
use crate::ui::saving::{Contents, Step};

/// Frames or events put into the file at a time.
const AT_ONCE: usize = 2_000;

/// How a file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Csv,
    JsonLines,
}

impl Form {
    pub const ALL: [Self; 2] = [Self::Csv, Self::JsonLines];

    pub fn label(self) -> &'static str {
        match self {
            Self::Csv => "CSV",
            Self::JsonLines => "JSON Lines",
        }
    }

    /// As file names end.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::JsonLines => "jsonl",
        }
    }
}

/// Frames of the line; those that are forgotten meanwhile are passed over.
pub struct FramesFile {
    pub form: Form,
    seqs: Vec<u64>,
    done: usize,
    written: u64,
}

impl FramesFile {
    pub fn new(form: Form, seqs: impl IntoIterator<Item = u64>) -> Self {
        Self { form, seqs: seqs.into_iter().collect(), done: 0, written: 0 }
    }
}

impl Contents for FramesFile {
    fn step(&mut self, bench: &Bench) -> io::Result<Step> {
        let explain =
            |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
        let end = self.done.saturating_add(AT_ONCE).min(self.seqs.len());
        let seqs = self.seqs.get(self.done..end).unwrap_or_default().iter().copied();
        let mut bytes = Vec::new();
        let log = bench.traffic();
        let count = match self.form {
            Form::Csv if self.done == 0 => write_csv(log, seqs, &explain, &mut bytes)?,
            Form::Csv => append_csv(log, seqs, &explain, &mut bytes)?,
            Form::JsonLines => write_json_lines(log, seqs, &explain, &mut bytes)?,
        };
        self.done = end;
        self.written = self.written.saturating_add(count);
        Ok(Step { bytes, is_last: self.done >= self.seqs.len() })
    }

    fn part(&self) -> f32 {
        self.done as f32 / self.seqs.len().max(1) as f32
    }

    fn what(&self) -> String {
        plural(usize::try_from(self.written).unwrap_or(usize::MAX), "frame")
    }
}

/// Frames of the line as a capture; those that are forgotten meanwhile are passed over.
pub struct CaptureFile {
    form: capture::Form,
    seqs: Vec<u64>,
    done: usize,
    written: usize,
    /// Begun with the first step.
    writer: Option<CaptureWriter<Vec<u8>>>,
}

impl CaptureFile {
    pub fn new(form: capture::Form, seqs: impl IntoIterator<Item = u64>) -> Self {
        Self { form, seqs: seqs.into_iter().collect(), done: 0, written: 0, writer: None }
    }
}

impl Contents for CaptureFile {
    fn step(&mut self, bench: &Bench) -> io::Result<Step> {
        let writer = match &mut self.writer {
            Some(writer) => writer,
            none => {
                let line = bench.line().line().map(ToString::to_string).unwrap_or_default();
                none.insert(CaptureWriter::new(self.form, Vec::new(), &line)?)
            }
        };
        let end = self.done.saturating_add(AT_ONCE).min(self.seqs.len());
        let seqs = self.seqs.get(self.done..end).unwrap_or_default();
        for frame in seqs.iter().filter_map(|seq| bench.traffic().get(*seq)) {
            writer.frame(&frame.to_frame())?;
            self.written = self.written.saturating_add(1);
        }
        self.done = end;
        Ok(Step { bytes: std::mem::take(writer.get_mut()), is_last: self.done >= self.seqs.len() })
    }

    fn part(&self) -> f32 {
        self.done as f32 / self.seqs.len().max(1) as f32
    }

    fn what(&self) -> String {
        plural(self.written, "frame")
    }
}

/// Events of a module.
pub struct EventsFile {
    form: Form,
    entries: Vec<Entry>,
    done: usize,
}

impl EventsFile {
    pub fn new(form: Form, entries: Vec<Entry>) -> Self {
        Self { form, entries, done: 0 }
    }
}

/// One line of the file.
#[derive(Serialize)]
struct Row<'a> {
    /// UTC, ISO 8601, in microseconds.
    time: String,
    kind: crate::bench::EntryKind,
    text: &'a str,
}

impl Contents for EventsFile {
    fn step(&mut self, _bench: &Bench) -> io::Result<Step> {
        let end = self.done.saturating_add(AT_ONCE).min(self.entries.len());
        let rows = self.entries.get(self.done..end).unwrap_or_default().iter().map(|entry| Row {
            time: format!("{:.6}", entry.at),
            kind: entry.kind,
            text: &entry.text,
        });
        let mut bytes = Vec::new();
        match self.form {
            Form::Csv => {
                let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut bytes);
                if self.done == 0 {
                    writer.write_record(["time", "kind", "text"])?;
                }
                for row in rows {
                    writer.serialize(row)?;
                }
                writer.flush()?;
            }
            Form::JsonLines => {
                for row in rows {
                    serde_json::to_writer(&mut bytes, &row)?;
                    bytes.push(b'\n');
                }
            }
        }
        self.done = end;
        Ok(Step { bytes, is_last: self.done >= self.entries.len() })
    }

    fn part(&self) -> f32 {
        self.done as f32 / self.entries.len().max(1) as f32
    }

    fn what(&self) -> String {
        plural(self.done, "event")
    }
}

fn plural(count: usize, what: &str) -> String {
    format!("{} {what}{}", super::grouped(count), if count == 1 { "" } else { "s" })
}
