//! What was measured and what happened: kept in memory, and handed to a recording.

use std::path::PathBuf;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::{Bench, Module, Severity};
use crate::record::{Destination, Event, EventKind, History, Recorder, RecordingStatus, Viewer};

/// Recordings that may be open at a time.
const MOST_OPEN: usize = 8;

/// Names a recording that was opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct RecordingId(pub u32);

/// The recording under way.
pub(super) struct Recording {
    recorder: Recorder,
    status: RecordingStatus,
}

impl Bench {
    /// Everything that was measured since the program was started.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// How the recording fares; `None` while nothing is recorded.
    pub fn recording(&self) -> Option<&RecordingStatus> {
        self.recording.as_ref().map(|recording| &recording.status)
    }

    /// The recordings that were opened to be looked at.
    pub fn opened(&self) -> impl Iterator<Item = (RecordingId, &Viewer)> {
        self.opened.iter().map(|(id, viewer)| (*id, viewer))
    }

    pub fn opened_recording(&self, id: RecordingId) -> Option<&Viewer> {
        self.opened.get(&id)
    }

    /// Opens a recording to be looked at; one that is open already is not opened again.
    pub(super) fn open_recording(&mut self, path: PathBuf) {
        if self.opened.values().any(|viewer| viewer.path() == path) {
            return;
        }
        if self.opened.len() >= MOST_OPEN {
            let text = format!("{MOST_OPEN} recordings are open already – close one of them first");
            return self.notify(Severity::Warning, text);
        }
        let wake = self.wake.clone();
        let id = RecordingId(self.opened.last_key_value().map_or(0, |(last, _)| last.0.saturating_add(1)));
        match Viewer::open(path.clone(), move || wake()) {
            Ok(viewer) => drop(self.opened.insert(id, viewer)),
            Err(error) => {
                let text = format!("{} was not opened ({error}) – close other programs and try again", path.display());
                self.notify(Severity::Error, text);
            }
        }
    }

    pub(super) fn close_recording(&mut self, id: RecordingId) {
        self.opened.remove(&id);
    }

    /// Takes in what was read of opened recordings. True if anything changed.
    pub(super) fn pump_recordings(&mut self) -> bool {
        self.opened.values_mut().map(Viewer::pump).fold(false, |any, changed| any | changed)
    }

    /// Records from now on; what was recorded before is closed.
    pub(super) fn start_recording(&mut self, destination: Destination) {
        self.stop_recording();
        match Recorder::start(destination, {
            let wake = self.wake.clone();
            move || wake()
        }) {
            Ok(recorder) => {
                self.history.begin_news();
                let status = recorder.status();
                self.recording = Some(Recording { recorder, status });
            }
            Err(error) => {
                let text = format!("Nothing is recorded ({error}) – close other programs and try again");
                self.notify(Severity::Error, text);
            }
        }
    }

    /// Writes what waits and closes the file.
    pub(super) fn stop_recording(&mut self) {
        self.hand_over_news();
        self.history.end_news();
        let Some(Recording { recorder, .. }) = self.recording.take() else { return };
        if let Err(error) = recorder.finish() {
            self.notify(Severity::Error, error.to_string());
        }
    }

    /// A remark of the user about a time.
    pub(super) fn add_note(&mut self, at: Timestamp, text: String) {
        self.history.add_event(Event { at, module: None, kind: EventKind::Note, text, change: None });
        self.hand_over_news();
    }

    /// Something that concerns the whole line.
    pub(super) fn note_line(&mut self, kind: EventKind, text: String) {
        let at = self.now();
        self.history.add_event(Event { at, module: None, kind, text, change: None });
    }

    /// Tells the recording what is new, and looks how it fares.
    pub(super) fn hand_over_news(&mut self) {
        let Self { modules, history, recording, .. } = self;
        modules.iter_mut().for_each(|module| note_entries(module, history));
        let Some(Recording { recorder, status }) = recording else { return history.tidy(None) };
        let news = history.take_news();
        if !news.is_empty() {
            recorder.put(news);
        }
        let before = std::mem::replace(status, recorder.status());
        history.tidy(Some(status.saved_until.unwrap_or(i64::MIN)));
        let problem = status.problem.clone();
        if problem != before.problem {
            match problem {
                Some(problem) => self.notify(Severity::Error, format!("Nothing is recorded: {problem}")),
                None => self.notify(Severity::Info, "The recording is complete again".to_owned()),
            }
        }
    }
}

/// What the module's journal has and the history of all modules has not.
fn note_entries(module: &mut Module, history: &mut History) {
    let id = module.history_id();
    module.journal.take_news().for_each(|entry| history.add_event(entry.to_event(id)));
}
