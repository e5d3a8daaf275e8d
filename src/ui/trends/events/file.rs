//! Events as a file, made in steps so that the window goes on.

use std::io;
use std::ops::ControlFlow;

use jiff::tz::TimeZone;

use super::rows::event;
use crate::bench::{Bench, RecordingId};
use crate::record::{EventRows, Export, ExportError, Format, History};
use crate::ui::saving::{Contents, Step};
use crate::ui::tables::{Form, grouped};

/// Events put into the file at a time.
const AT_ONCE: usize = 2_000;

/// Events by their numbers; those that are forgotten meanwhile are passed over.
pub struct EventsFile {
    pub form: Form,
    /// `None` for the live history.
    pub recording: Option<RecordingId>,
    pub zone: TimeZone,
    pub numbers: Vec<u64>,
    pub done: usize,
}

impl EventsFile {
    /// The same rows as `export --events` writes.
    fn lines(&self, history: &History, numbers: &[u64]) -> io::Result<Vec<u8>> {
        let rows = EventRows::of(history, numbers.iter().filter_map(|number| event(history, *number)));
        let rows = if self.done == 0 { rows } else { rows.continued() };
        let format = match self.form {
            Form::Csv => Format::Csv,
            Form::JsonLines => Format::JsonLines,
        };
        let mut bytes = Vec::new();
        match Export::run_events(rows, format, &self.zone, &mut bytes, |_| ControlFlow::Continue(())) {
            Ok(_) => Ok(bytes),
            Err(ExportError::Write(error)) => Err(error),
            Err(error) => Err(io::Error::other(error)),
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Change, Event, EventKind, ModuleInfo, timestamp};

    fn history() -> History {
        let mut history = History::default();
        let module = history.module(ModuleInfo { label: "PIR-234".into(), address: 1, ..ModuleInfo::default() });
        for second in 0..5 {
            let change = Change { item: "pir_on_time".into(), before: None, after: "33".into() };
            history.add_event(Event {
                at: timestamp(second * 1_000_000),
                module: (second != 2).then_some(module),
                kind: EventKind::Written,
                text: "0042".into(),
                change: (second != 3).then_some(change),
            });
        }
        history
    }

    #[test]
    fn the_window_writes_the_same_rows_as_the_command_line_whatever_the_steps() {
        let history = history();
        for (form, format) in [(Form::Csv, Format::Csv), (Form::JsonLines, Format::JsonLines)] {
            let mut file = EventsFile { form, recording: None, zone: TimeZone::UTC, numbers: Vec::new(), done: 0 };
            let mut shown = file.lines(&history, &[0, 1]).unwrap();
            file.done = 2;
            shown.extend(file.lines(&history, &[2, 3, 4]).unwrap());
            let (mut expected, rows) = (Vec::new(), EventRows::new(&history, &[], None, None));
            Export::run_events(rows, format, &TimeZone::UTC, &mut expected, |_| ControlFlow::Continue(())).unwrap();
            assert_eq!(String::from_utf8(shown).unwrap(), String::from_utf8(expected).unwrap());
        }
    }
}
