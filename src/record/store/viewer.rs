//! A recording in the window: read on a thread of its own, and kept up to date while it grows.

use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};

use std::time::{Duration, Instant};

use super::super::history::History;
use super::super::objects::SeriesId;
use super::super::trend::{Micros, Sample};
use super::Archive;
use super::fetcher::Wants;
use super::news::News;
use super::problem::StoreError;
use super::reading::Recording;
use super::shared::Shared;

/// How often it is looked whether the recording has grown.
const LOOK: Duration = Duration::from_secs(1);
/// Nobody looks at the recording who has not pumped for so long.
const AWAY: Duration = Duration::from_secs(3);

/// What was read, in the order in which it is to be taken in.
enum Found {
    All(Box<History>),
    More(News),
    Samples(SeriesId, Vec<Sample>),
}

#[derive(Default)]
struct State {
    wants: Wants,
    found: Vec<Found>,
    problem: Option<StoreError>,
    /// When somebody has looked at it last.
    pumped: Option<Instant>,
    ending: bool,
}

/// A recording opened for the window. The thread ends when this is dropped.
pub struct Viewer {
    path: PathBuf,
    shared: Arc<Shared<State>>,
    history: Option<History>,
    problem: Option<StoreError>,
}

impl Viewer {
    /// Begins to open `path`; `wake` is called when there is something new.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn open(path: PathBuf, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::<State>::default());
        shared.state().pumped = Some(Instant::now());
        let reader = Reader { path: path.clone(), shared: shared.clone(), recording: None, wake };
        std::thread::Builder::new().name("recording viewer".to_owned()).spawn(move || reader.run())?;
        Ok(Self { path, shared, history: None, problem: None })
    }

    /// Takes in what was read, and asks for what was looked at and is not in memory. True if anything changed. It is
    /// looked once a second whether the recording has grown, as long as this is called at least every three seconds.
    pub fn pump(&mut self) -> bool {
        let mut state = self.shared.state();
        let found = std::mem::take(&mut state.found);
        let changed = !found.is_empty() || state.problem != self.problem;
        self.problem.clone_from(&state.problem);
        let was_away = state.pumped.is_none_or(|at| at.elapsed() >= AWAY);
        state.pumped = Some(Instant::now());
        drop(state);
        for found in found {
            match (found, &mut self.history) {
                (Found::All(history), mine) => *mine = Some(*history),
                (Found::More(news), Some(history)) => news.add_to(history),
                (Found::Samples(id, samples), Some(history)) => history.fill(id, &samples),
                (_, None) => {}
            }
        }
        let asked = self.ask();
        if asked || was_away {
            self.shared.changed.notify_all();
        }
        changed
    }

    /// Asks for what was looked at. True if it is new.
    fn ask(&mut self) -> bool {
        let Some(history) = &mut self.history else { return false };
        // What is on the disk is given up again when it is too much.
        history.tidy(Some(Micros::MAX), true);
        let ids: Vec<SeriesId> = history.series().map(|(id, _)| id).collect();
        let mut any = false;
        for id in ids {
            let wanted = history.trend_mut(id).map(|trend| trend.take_wanted()).unwrap_or_default();
            if !wanted.is_empty() {
                let mut state = self.shared.state();
                any |= wanted.into_iter().fold(false, |any, stretch| state.wants.add((id, stretch)) | any);
            }
        }
        any
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// `None` until it is read.
    pub fn history(&self) -> Option<&History> {
        self.history.as_ref()
    }

    /// Why it cannot be read; it is tried again every second.
    pub fn problem(&self) -> Option<&StoreError> {
        self.problem.as_ref()
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.shared.state().ending = true;
        self.shared.changed.notify_all();
    }
}

/// The thread's side.
struct Reader<F> {
    path: PathBuf,
    shared: Arc<Shared<State>>,
    recording: Option<Recording>,
    wake: F,
}

impl<F: Fn()> Reader<F> {
    fn run(mut self) {
        let mut look_at = Instant::now();
        while !self.shared.state().ending {
            if Instant::now() >= look_at {
                let found = self.look();
                self.tell(found);
                look_at = Instant::now().checked_add(LOOK).unwrap_or(look_at);
            }
            let next = self.shared.state().wants.next();
            match (next, &mut self.recording) {
                (Some((id, [from, to])), Some(recording)) => {
                    let samples = recording.samples(id, from, to).map(|samples| Some(Found::Samples(id, samples)));
                    self.tell(samples);
                }
                _ => self.rest(look_at),
            }
        }
    }

    /// Until something is wanted, or it is time to look again and somebody is there to see it.
    fn rest(&self, look_at: Instant) {
        let mut state = self.shared.state();
        loop {
            let now = Instant::now();
            let is_seen = state.pumped.is_some_and(|at| now.saturating_duration_since(at) < AWAY);
            if state.ending || !state.wants.is_empty() || (is_seen && now >= look_at) {
                return;
            }
            let left = look_at.saturating_duration_since(now);
            state = if is_seen {
                self.shared.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0
            } else {
                self.shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
            };
        }
    }

    fn look(&mut self) -> Result<Option<Found>, StoreError> {
        if let Some(recording) = &mut self.recording {
            let news = recording.news()?;
            return Ok((!news.is_empty()).then_some(Found::More(news)));
        }
        let mut recording = Recording::open(&self.path)?;
        let history = recording.load()?;
        self.recording = Some(recording);
        Ok(Some(Found::All(Box::new(history))))
    }

    fn tell(&self, found: Result<Option<Found>, StoreError>) {
        let (found, problem) = match found {
            Ok(found) => (found, None),
            Err(problem) => (None, Some(problem)),
        };
        let mut state = self.shared.state();
        let changed = found.is_some() && state.found.is_empty() || problem != state.problem;
        state.found.extend(found);
        state.problem = problem;
        drop(state);
        if changed {
            (self.wake)();
        }
    }
}
