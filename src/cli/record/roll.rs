//! What is recorded, on its way from memory to the disk, and what is said of it.

use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::super::Outcome;
use super::super::stop::Stop;
use super::super::terminal::TerminalLine;
use super::trouble::Trouble;
use crate::record::{Event, EventKind, History, ModuleId, Record, Recorder, RecordingStatus};

/// How often it is looked how the recording fares.
const LOOK_EVERY: Duration = Duration::from_millis(100);

pub struct Roll {
    pub history: History,
    recorder: Recorder,
    line: TerminalLine,
    begin: Instant,
    looked: Instant,
    /// Samples that were taken since the beginning.
    samples: u64,
    trouble: Trouble,
}

impl Roll {
    pub fn new(recorder: Recorder, line: TerminalLine) -> Self {
        let mut history = History::default();
        history.begin_news();
        let begin = Instant::now();
        Self { history, recorder, line, begin, looked: begin, samples: 0, trouble: Trouble::default() }
    }

    /// Tells the user something.
    pub fn message(&mut self, text: &str) {
        self.line.message(text);
    }

    /// Something that concerns the whole line: recorded, and told with `advice`.
    pub fn note(&mut self, at: Timestamp, kind: EventKind, text: String, advice: &str) {
        self.message(&format!("{text}{advice}"));
        self.history.add_event(Event { at, module: None, kind, text, change: None });
    }

    /// Something that concerns a module: recorded.
    pub fn of_module(&mut self, module: ModuleId, at: Timestamp, kind: EventKind, text: String) {
        self.history.add_event(Event { at, module: Some(module), kind, text, change: None });
    }

    /// Hands over what is new, and now and then looks how the recording fares.
    pub fn hand_over(&mut self) {
        self.put_news();
        if self.looked.elapsed() < LOOK_EVERY {
            return;
        }
        self.looked = Instant::now();
        let status = self.recorder.status();
        self.history.tidy(status.saved_until, true);
        if let Some(text) = self.trouble.look(&status) {
            self.line.message(&text);
        }
        let (elapsed, samples) = (self.begin.elapsed(), self.samples);
        self.line.show(|| describe(elapsed, samples, &status));
    }

    /// Writes what waits and closes the file: the samples taken, and how the recording fared.
    pub fn finish(mut self) -> Outcome<(u64, RecordingStatus)> {
        self.put_news();
        self.line.clear();
        let status = self.recorder.finish().map_err(|error| Stop::failed(error.to_string()))?;
        Ok((self.samples, status))
    }

    fn put_news(&mut self) {
        let news = self.history.take_news();
        let samples = news.iter().filter(|record| matches!(record, Record::Sample(..))).count();
        self.samples = self.samples.saturating_add(u64::try_from(samples).unwrap_or(u64::MAX));
        if !news.is_empty() {
            self.recorder.put(news);
        }
    }
}

/// `0:12:33  45210 samples  1.2 MB`
fn describe(elapsed: Duration, samples: u64, status: &RecordingStatus) -> String {
    let (minutes, seconds) = (elapsed.as_secs() / 60, elapsed.as_secs() % 60);
    let size = status.bytes as f64 / 1e6;
    let mut text = format!("{}:{:02}:{seconds:02}  {samples} samples  {size:.1} MB", minutes / 60, minutes % 60);
    if status.problem.is_some() && status.waiting > 0 {
        text.push_str(&format!("  {} waiting for the disk", status.waiting));
    }
    if status.lost > 0 {
        text.push_str(&format!("  {} lost", status.lost));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_status_line_says_how_long_how_many_and_what_is_wrong() {
        let mut status = RecordingStatus { bytes: 1_234_567, ..RecordingStatus::default() };
        assert_eq!(describe(Duration::from_secs(753), 45_210, &status), "0:12:33  45210 samples  1.2 MB");
        status.problem = Some("the disk is full".into());
        (status.waiting, status.lost) = (17, 2);
        let shown = describe(Duration::from_secs(360_000), 1, &status);
        assert_eq!(shown, "100:00:00  1 samples  1.2 MB  17 waiting for the disk  2 lost");
    }
}
