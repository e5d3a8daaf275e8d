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
    /// Why it cannot be looked whether it has grown.
    looking: Option<StoreError>,
    /// The first stretch that could not be fetched, until it can: others come and go meanwhile.
    fetching: Option<((SeriesId, [Micros; 2]), StoreError)>,
    ending: bool,
}

impl State {
    fn problem(&self) -> Option<&StoreError> {
        self.looking.as_ref().or_else(|| self.fetching.as_ref().map(|(_, problem)| problem))
    }

    /// What was found earlier waits to be taken: more of it would only take memory.
    fn has_news(&self) -> bool {
        self.found.iter().any(|found| !matches!(found, Found::Samples(..)))
    }

    fn is_due(&self, look_at: Instant) -> bool {
        !self.has_news() && Instant::now() >= look_at
    }

    fn looked(&mut self, found: Result<Option<Found>, StoreError>) {
        match found {
            Ok(found) => {
                self.found.extend(found);
                self.looking = None;
            }
            Err(problem) => self.looking = Some(problem),
        }
    }

    fn fetched(&mut self, wanted: (SeriesId, [Micros; 2]), samples: Result<Vec<Sample>, StoreError>) {
        match samples {
            Ok(samples) => {
                self.found.push(Found::Samples(wanted.0, samples));
                self.fetching = self.fetching.take().filter(|(failed, _)| *failed != wanted);
            }
            Err(problem) => {
                self.fetching.get_or_insert((wanted, problem));
            }
        }
    }
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
        let reader = Reader { path: path.clone(), shared: shared.clone(), recording: None, wake };
        std::thread::Builder::new().name("recording viewer".to_owned()).spawn(move || reader.run())?;
        Ok(Self { path, shared, history: None, problem: None })
    }

    /// Takes in what was read, and asks for what was looked at and is not in memory. True if anything changed. It is
    /// looked once a second whether the recording has grown; what was found then waits until this is called.
    pub fn pump(&mut self) -> bool {
        let mut state = self.shared.state();
        let found = std::mem::take(&mut state.found);
        let problem = state.problem().cloned();
        drop(state);
        let changed = !found.is_empty() || problem != self.problem;
        let taken = !found.is_empty();
        self.problem = problem;
        for found in found {
            match (found, &mut self.history) {
                (Found::All(history), mine) => *mine = Some(*history),
                (Found::More(news), Some(history)) => news.add_to(history),
                (Found::Samples(id, samples), Some(history)) => history.fill(id, &samples),
                (_, None) => {}
            }
        }
        let asked = self.ask();
        if asked || taken {
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

    /// Why it, or a part of it, cannot be read; it is tried again.
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
            if self.shared.state().is_due(look_at) {
                let found = self.look();
                self.tell(|state| state.looked(found));
                look_at = Instant::now().checked_add(LOOK).unwrap_or(look_at);
            }
            let next = self.shared.state().wants.next();
            match (next, &mut self.recording) {
                (Some(wanted @ (id, [from, to])), Some(recording)) => {
                    let samples = recording.samples(id, from, to);
                    self.tell(|state| state.fetched(wanted, samples));
                }
                _ => self.rest(look_at),
            }
        }
    }

    /// Until something is wanted, or it is time to look again.
    fn rest(&self, look_at: Instant) {
        let mut state = self.shared.state();
        loop {
            if state.ending || !state.wants.is_empty() || state.is_due(look_at) {
                return;
            }
            state = if state.has_news() {
                self.shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
            } else {
                let left = look_at.saturating_duration_since(Instant::now());
                self.shared.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0
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

    fn tell(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.shared.state();
        let (was_empty, problem) = (state.found.is_empty(), state.problem().cloned());
        change(&mut state);
        let changed = was_empty && !state.found.is_empty() || problem.as_ref() != state.problem();
        drop(state);
        if changed {
            (self.wake)();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_that_cannot_be_fetched_is_told_once_until_it_can() {
        let mut state = State::default();
        let problem = |reason: &str| StoreError::damaged(Path::new("a.sqlite"), reason);
        let (bad, good) = ((SeriesId(0), [0, 9]), (SeriesId(0), [10, 19]));
        state.fetched(bad, Err(problem("broken")));
        for _ in 0..2 {
            state.looked(Ok(None));
            state.fetched(good, Ok(Vec::new()));
            state.fetched((SeriesId(1), [0, 9]), Err(problem("also broken")));
            assert_eq!(state.problem(), Some(&problem("broken")));
        }
        state.looked(Err(problem("gone")));
        assert_eq!(state.problem(), Some(&problem("gone")));
        state.looked(Ok(None));
        state.fetched(bad, Ok(Vec::new()));
        assert_eq!(state.problem(), None);
    }

    #[test]
    fn it_is_not_looked_again_before_the_news_are_taken() {
        let mut state = State::default();
        let now = Instant::now();
        state.fetched((SeriesId(0), [0, 9]), Ok(Vec::new()));
        assert!(state.is_due(now));
        state.looked(Ok(Some(Found::More(News::default()))));
        assert!(!state.is_due(now));
        state.found.clear();
        assert!(state.is_due(now));
    }
}
