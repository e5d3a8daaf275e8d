//! What was measured and what happened: kept in memory, and handed to a recording.

mod shelf;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::{Bench, Module, Severity};
use crate::record::{
    Archive, Destination, Event, EventKind, History, Micros, Recorder, Recording as RecordingFile, RecordingStatus,
    Sample, SeriesId, StoreError, Viewer,
};
pub(super) use shelf::Shelf;

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

    /// Who has the samples of a history that are not in memory: an opened recording, or the files recorded since the
    /// start. To be asked on another thread.
    pub fn archive(&self, opened: Option<RecordingId>) -> Option<Box<dyn Archive>> {
        match opened {
            None => self.shelf.archive(),
            Some(id) => {
                let path = self.opened_recording(id)?.path().to_owned();
                Some(Box::new(LateArchive { path, recording: None }))
            }
        }
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

    /// Whether something was drawn that has to be fetched from the disk first.
    pub fn is_fetching(&self) -> bool {
        self.history.is_wanting() || self.opened.values().filter_map(Viewer::history).any(History::is_wanting)
    }

    pub(super) fn close_recording(&mut self, id: RecordingId) {
        self.opened.remove(&id);
    }

    /// Takes in what was read of opened recordings, and of what the live history has given up. True if anything changed.
    pub(super) fn pump_recordings(&mut self) -> bool {
        let mut problems = Vec::new();
        let mut changed = self.shelf.pump(&mut self.history);
        problems.extend(self.shelf.new_problem());
        for viewer in self.opened.values_mut() {
            let before = viewer.problem().cloned();
            changed |= viewer.pump();
            // One that cannot be shown at all says so in its place.
            let is_new = viewer.history().is_some() && viewer.problem() != before.as_ref();
            problems.extend(viewer.problem().filter(|_| is_new).map(ToString::to_string));
        }
        changed |= !problems.is_empty();
        problems.into_iter().for_each(|problem| self.notify(Severity::Warning, problem));
        changed
    }

    /// Records from now on; what was recorded before is closed. What is in memory and in no file yet goes into the new one.
    pub(super) fn start_recording(&mut self, destination: Destination) {
        self.stop_recording();
        self.starting = Some(destination);
        self.begin_recording();
    }

    /// Begins the recording that was asked for, as soon as the one before is closed.
    fn begin_recording(&mut self) {
        if self.shelf.is_ending() {
            return;
        }
        let Some(destination) = self.starting.take() else { return };
        match Recorder::start(destination, {
            let wake = self.wake.clone();
            move || wake()
        }) {
            Ok(mut recorder) => {
                self.history.begin_news();
                recorder.put(self.history.take_news());
                self.shelf.hand_over_missed(&self.history, |missed| recorder.put(missed));
                if let Err(error) = self.shelf.add(recorder.archive(), &self.wake) {
                    log::warn!("what is given up is not fetched again: {error}");
                }
                // What is wrong from the first is told like everything else.
                let status = RecordingStatus { problem: None, ..recorder.status() };
                self.recording = Some(Recording { recorder, status });
            }
            Err(error) => {
                let text = format!("Nothing is recorded ({error}) – close other programs and try again");
                self.notify(Severity::Error, text);
            }
        }
    }

    /// Writes what waits and closes the file, on a thread of its own: a disk may be slow.
    pub(super) fn stop_recording(&mut self) {
        self.hand_over_news();
        self.starting = None;
        self.history.end_news();
        let Some(Recording { recorder, .. }) = self.recording.take() else { return };
        self.shelf.note_end(&self.history);
        self.shelf.finish(recorder, &self.wake);
    }

    /// Stops recording and waits until everything is written, but not for ever; for the end of the program. What could not
    /// be written.
    pub fn end_recording(&mut self) -> Vec<String> {
        self.drain();
        if self.starting.is_some() {
            self.shelf.wait();
            self.begin_recording();
        }
        self.stop_recording();
        self.shelf.wait()
    }

    fn tell_of_ends(&mut self) {
        let problems = self.shelf.take_problems();
        if self.starting.is_some() {
            // What could not be written goes into the recording that begins now.
            return;
        }
        for problem in problems {
            self.notify(Severity::Error, problem);
        }
    }

    /// A remark of the user about a time.
    pub(super) fn add_note(&mut self, at: Timestamp, text: String) {
        self.add_event(Event { at, module: None, kind: EventKind::Note, text, change: None });
        self.hand_over_news();
    }

    /// Something that concerns the whole line.
    pub(super) fn note_line(&mut self, kind: EventKind, text: String) {
        let at = self.now();
        self.add_event(Event { at, module: None, kind, text, change: None });
    }

    fn add_event(&mut self, event: Event) {
        if self.recording.is_none() {
            self.shelf.note_event(event.clone());
        }
        self.history.add_event(event);
    }

    /// Tells the recording what is new, and looks how it fares.
    pub(super) fn hand_over_news(&mut self) {
        self.tell_of_ends();
        self.begin_recording();
        take_entries(&mut self.modules).into_iter().for_each(|event| self.add_event(event));
        let Self { history, recording, .. } = self;
        let Some(Recording { recorder, status }) = recording else { return history.tidy(self.shelf.saved(), false) };
        let news = history.take_news();
        if !news.is_empty() {
            recorder.put(news);
        }
        let before = std::mem::replace(status, recorder.status());
        // What was measured before it began was handed over too.
        history.tidy(status.saved_until, true);
        let (problem, lost) = (status.problem.clone(), status.lost > before.lost && before.lost == 0);
        match (before.problem, problem) {
            (_, Some(problem)) if lost => self.notify(Severity::Error, format!("Samples are lost: {problem}")),
            // The words may change with each attempt, but the user knows.
            (None, Some(problem)) => {
                self.notify(Severity::Error, format!("What is measured waits in memory: {problem}"));
            }
            (Some(_), None) => {
                self.notify(Severity::Info, "The recording is written again, with what waited".to_owned());
            }
            _ => {}
        }
    }
}

/// What the modules' journals have and the history of all modules has not, in order of time.
fn take_entries(modules: &mut [Module]) -> Vec<Event> {
    let mut events = Vec::new();
    for module in modules {
        let id = module.history_id();
        events.extend(module.journal.take_news().map(|entry| entry.to_event(id)));
    }
    events.sort_by_key(|event| event.at);
    events
}

/// A recording that is opened when it is asked first, on the thread that asks.
struct LateArchive {
    path: PathBuf,
    recording: Option<RecordingFile>,
}

impl Archive for LateArchive {
    fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
        let recording = match &mut self.recording {
            Some(recording) => recording,
            none => {
                let mut recording = RecordingFile::open(&self.path)?;
                // The series are numbered as in the history that was shown.
                recording.load()?;
                none.insert(recording)
            }
        };
        recording.samples(series, from, to)
    }
}
