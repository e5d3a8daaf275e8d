//! Events as a file, made in steps so that the window goes on.

use std::collections::BTreeMap;
use std::io;

use jiff::Timestamp;
use jiff::fmt::temporal::DateTimePrinter;
use jiff::tz::TimeZone;
use serde::Serialize;

use super::rows::event;
use crate::bench::{Bench, RecordingId};
use crate::record::{Event, EventKind, History, ModuleId, module_names};
use crate::ui::saving::{Contents, Step};
use crate::ui::tables::{Form, grouped};

/// Events put into the file at a time.
const AT_ONCE: usize = 2_000;
const PRINTER: DateTimePrinter = DateTimePrinter::new().precision(Some(6));

/// Events by their numbers; those that are forgotten meanwhile are passed over.
pub struct EventsFile {
    pub form: Form,
    /// `None` for the live history.
    pub recording: Option<RecordingId>,
    pub zone: TimeZone,
    pub numbers: Vec<u64>,
    pub done: usize,
}

/// One line of the file.
#[derive(Serialize)]
struct Line<'a> {
    /// ISO 8601 with offset, in microseconds.
    time: String,
    module: &'a str,
    kind: EventKind,
    text: &'a str,
}

impl EventsFile {
    fn line<'a>(&self, event: &'a Event, names: &'a BTreeMap<ModuleId, String>) -> Line<'a> {
        let module = event.module.and_then(|module| names.get(&module)).map_or("", String::as_str);
        Line { time: self.time(event.at), module, kind: event.kind, text: &event.text }
    }

    fn time(&self, at: Timestamp) -> String {
        PRINTER.timestamp_with_offset_to_string(&at, self.zone.to_offset(at))
    }

    fn lines(&self, history: &History, numbers: &[u64]) -> io::Result<Vec<u8>> {
        let names = module_names(history);
        let events = numbers.iter().filter_map(|number| event(history, *number));
        let mut bytes = Vec::new();
        match self.form {
            Form::Csv => {
                let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut bytes);
                if self.done == 0 {
                    writer.write_record(["time", "module", "kind", "text"])?;
                }
                for event in events {
                    writer.serialize(self.line(event, &names))?;
                }
                writer.flush()?;
            }
            Form::JsonLines => {
                for event in events {
                    serde_json::to_writer(&mut bytes, &self.line(event, &names))?;
                    bytes.push(b'\n');
                }
            }
        }
        Ok(bytes)
    }
}

impl Contents for EventsFile {
    fn step(&mut self, bench: &Bench) -> io::Result<Step> {
        let history = match self.recording {
            None => bench.history(),
            Some(id) => {
                let viewer = bench.opened_recording(id).and_then(|viewer| viewer.history());
                viewer.ok_or_else(|| io::Error::other("the recording was closed"))?
            }
        };
        let end = self.done.saturating_add(AT_ONCE).min(self.numbers.len());
        let bytes = self.lines(history, self.numbers.get(self.done..end).unwrap_or_default())?;
        self.done = end;
        Ok(Step { bytes, is_last: self.done >= self.numbers.len() })
    }

    fn part(&self) -> f32 {
        self.done as f32 / self.numbers.len().max(1) as f32
    }

    fn what(&self) -> String {
        format!("{} event{}", grouped(self.done), if self.done == 1 { "" } else { "s" })
    }
}
