//! The thread that writes a recording, and its handle.

use std::sync::atomic::AtomicU32;
use std::sync::{Arc, PoisonError};

use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::super::history::Record;
use super::super::trend::Micros;
use super::inbox::Inbox;
use super::problem::StoreError;
use super::session::Session;
use super::shared::Shared;
use super::shelf::{Files, Shelf};
use super::{Destination, RecordingStatus};

/// The time between two transactions. With it, and with what a transaction takes, samples are on the disk well within a
/// second.
const PAUSE: Duration = Duration::from_millis(400);
/// How often it is tried again to write what could not be written.
const RETRY: Duration = Duration::from_secs(2);
/// The status is told as often at most.
const TELL: Duration = Duration::from_secs(1);
/// How long a recorder that is dropped waits for its thread.
const FAREWELL: Duration = Duration::from_secs(5);

#[derive(Default)]
struct State {
    inbox: Inbox,
    status: RecordingStatus,
    /// Nothing comes any more.
    ending: bool,
    ended: bool,
    /// The thread waits for news.
    idle: bool,
}

impl Shared<State> {
    /// Waits until `is_so`, or `until` at the latest; for ever without. Whether it is so.
    fn wait(&self, until: Option<Instant>, is_so: impl Fn(&State) -> bool) -> bool {
        let mut state = self.state();
        while !is_so(&state) {
            state = match until {
                None => self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
                Some(until) => {
                    let left = until.saturating_duration_since(Instant::now());
                    if left.is_zero() {
                        return false;
                    }
                    self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
        true
    }
}

/// Writes a recording on a thread of its own.
pub struct Recorder {
    shared: Arc<Shared<State>>,
    shelf: Shelf,
    thread: Option<JoinHandle<()>>,
}

impl Recorder {
    /// Begins a recording; `wake` is called when its status has changed in a way that people should see.
    ///
    /// # Errors
    /// If no thread can be started. A file that cannot be written is told by [`Recorder::status`].
    pub fn start(destination: Destination, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_limited(destination, None, wake)
    }

    /// The same on a disk that is full when a file has so many pages; for tests.
    #[doc(hidden)]
    pub fn start_limited(
        destination: Destination,
        pages: Option<Arc<AtomicU32>>,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let (shared, shelf) = (Arc::new(Shared::<State>::default()), Shelf::default());
        shared.state().status.since = Some(Timestamp::now());
        let session = Session::new(destination, shelf.clone(), pages);
        let writer = Writer {
            shared: shared.clone(),
            session,
            shelf: shelf.clone(),
            refused: 0,
            saved: None,
            warning: None,
            told: None,
            untold: false,
            wake: Box::new(wake),
        };
        let thread = std::thread::Builder::new().name("recording".to_owned()).spawn(move || writer.run())?;
        Ok(Self { shared, shelf, thread: Some(thread) })
    }

    /// Hands news over, in their order; never blocks.
    pub fn put(&mut self, records: Vec<Record>) {
        if records.is_empty() {
            return;
        }
        let mut state = self.shared.state();
        state.inbox.put(records);
        if state.idle {
            self.shared.changed.notify_all();
        }
    }

    pub fn status(&self) -> RecordingStatus {
        let state = self.shared.state();
        let lost = state.status.lost.saturating_add(state.inbox.lost());
        RecordingStatus { waiting: state.inbox.waiting(), lost, ..state.status.clone() }
    }

    /// What this recording has of the history that is recorded; also after its end.
    pub fn archive(&self) -> Files {
        Files::new(self.shelf.clone())
    }

    /// Writes what waits and closes the file.
    ///
    /// # Errors
    /// What is lost because it cannot be written.
    pub fn finish(mut self) -> Result<RecordingStatus, StoreError> {
        self.finished()
    }

    /// Writes what waits and closes the file, and gives back what cannot be written: events, then samples, each in
    /// their order, without the modules and series that they belong to. Another recorder can take it.
    pub fn finish_keeping(mut self) -> (Result<RecordingStatus, StoreError>, Vec<Record>) {
        let finished = self.finished();
        let unwritten = self.shared.state().inbox.drain();
        (finished, unwritten)
    }

    fn finished(&mut self) -> Result<RecordingStatus, StoreError> {
        self.end();
        let ended = self.thread.take().map(JoinHandle::join);
        let status = self.status();
        let reason = match (ended, &status.problem) {
            (Some(Err(_)), _) => "the program made a mistake, please report it".to_owned(),
            (_, Some(problem)) if status.waiting > 0 => problem.clone(),
            _ => return Ok(status),
        };
        Err(StoreError::Unwritten { count: status.waiting, reason })
    }

    fn end(&self) {
        self.shared.state().ending = true;
        self.shared.changed.notify_all();
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if self.thread.is_some() {
            self.end();
            self.shared.wait(Instant::now().checked_add(FAREWELL), |state| state.ended);
        }
    }
}

/// The thread's side.
struct Writer {
    shared: Arc<Shared<State>>,
    session: Session,
    shelf: Shelf,
    /// Samples that cannot be written at all.
    refused: u64,
    saved: Option<Micros>,
    /// What is wrong although something can be written.
    warning: Option<StoreError>,
    told: Option<Instant>,
    /// The status has changed since it was told.
    untold: bool,
    wake: Box<dyn Fn() + Send>,
}

impl Writer {
    fn run(mut self) {
        loop {
            // What was put before the end came is written after this.
            let ending = self.shared.state().ending;
            let written = self.write_waiting();
            let again = if written.is_ok() { PAUSE } else { RETRY };
            let failed = written.is_err();
            self.note(written.err());
            if ending {
                break;
            }
            self.shared.wait(Instant::now().checked_add(again), |state| state.ending);
            if !failed {
                self.wait_for_news();
            }
        }
        let Self { shared, session, .. } = self;
        session.close();
        shared.state().ended = true;
        shared.changed.notify_all();
    }

    /// Writes all there is, in portions; the first file is made also for nothing.
    fn write_waiting(&mut self) -> Result<(), StoreError> {
        if self.shelf.files().is_empty() {
            self.session.open()?;
        }
        loop {
            let mut batch = self.shared.state().inbox.take();
            if batch.is_empty() {
                return Ok(());
            }
            self.session.describe(std::mem::take(&mut batch.described));
            match self.session.write(&batch) {
                Ok(outcome) => {
                    let refused = outcome.earlier.saturating_add(outcome.strange);
                    self.refused = self.refused.saturating_add(refused);
                    self.saved = self.saved.max(outcome.span.map(|[_, last]| last));
                    if outcome.earlier > 0 {
                        self.warning = self.session.path().map(|path| StoreError::Earlier { path: path.to_owned() });
                    } else if outcome.span.is_some() {
                        self.warning = None;
                    }
                    self.note(None);
                }
                Err(error) => {
                    self.shared.state().inbox.put_back(batch);
                    return Err(error);
                }
            }
        }
    }

    /// Nothing is being written just now: makes the status what it is, and tells of it.
    fn note(&mut self, problem: Option<StoreError>) {
        let files: Vec<_> =
            self.shelf.files().iter().map(|file| (file.path.clone(), file.span, file.samples, file.bytes)).collect();
        let mut state = self.shared.state();
        let State { inbox, status, .. } = &mut *state;
        inbox.written();
        let problem = problem.as_ref().or(self.warning.as_ref()).map(ToString::to_string);
        let before = (status.problem.clone(), status.samples);
        status.file = self.session.path().map(ToOwned::to_owned).or_else(|| status.file.take());
        status.samples = files.iter().map(|file| file.2).fold(0, u64::saturating_add);
        status.bytes = files.iter().map(|file| file.3).fold(0, u64::saturating_add);
        status.files =
            files.into_iter().map(|(path, span, ..)| (span.map_or(Micros::MAX, |[first, _]| first), path)).collect();
        status.lost = self.refused;
        status.saved_until = self.saved.map(|saved| inbox.earliest().map_or(saved, |earliest| earliest.min(saved)));
        status.problem = problem;
        self.untold |= (status.problem.clone(), status.samples) != before;
        let at_once = status.problem != before.0;
        drop(state);
        if at_once || self.tell_at().is_some_and(|at| Instant::now() >= at) {
            self.tell();
        }
    }

    fn tell(&mut self) {
        (self.told, self.untold) = (Some(Instant::now()), false);
        (self.wake)();
    }

    /// When people are to see what has changed.
    fn tell_at(&self) -> Option<Instant> {
        let now = Instant::now();
        self.untold.then(|| self.told.and_then(|told| told.checked_add(TELL)).unwrap_or(now))
    }

    /// Rests until there is something to write, but for what is to be done after a while.
    fn wait_for_news(&mut self) {
        loop {
            let due = [self.tell_at(), self.session.settle_at()].into_iter().flatten().min();
            self.shared.state().idle = true;
            let news = self.shared.wait(due, |state| state.ending || !state.inbox.is_empty());
            self.shared.state().idle = false;
            if news {
                return;
            }
            let now = Instant::now();
            if self.session.settle_at().is_some_and(|at| now >= at) {
                self.session.settle();
            }
            if self.tell_at().is_some_and(|at| now >= at) {
                self.tell();
            }
        }
    }
}
