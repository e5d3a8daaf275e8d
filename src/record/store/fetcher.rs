//! Fetches samples on a thread of its own, so that the window never waits for the disk.

use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, PoisonError};

use std::time::{Duration, Instant};

use super::super::objects::SeriesId;
use super::super::trend::{Micros, Sample};
use super::Archive;
use super::problem::StoreError;
use super::shared::Shared;

/// Stretches that may wait. The oldest are forgotten: nobody looks at them any more.
const MOST_WANTED: usize = 8_192;
/// What was answered is not read again for so long, whatever the answer was.
const ENOUGH: Duration = Duration::from_secs(2);
/// The archive closes its files when nothing was wanted for so long.
const REST: Duration = Duration::from_secs(5);

/// A stretch of a series, by its first and last time.
type Stretch = (SeriesId, [Micros; 2]);

/// What is wanted, and what was answered not long ago.
#[derive(Debug, Default)]
pub(super) struct Wants {
    wanted: VecDeque<Stretch>,
    answered: VecDeque<(Stretch, Instant)>,
    /// All of both.
    known: HashSet<Stretch>,
}

impl Wants {
    /// True if it was not wanted yet.
    pub fn add(&mut self, stretch: Stretch) -> bool {
        let now = Instant::now();
        while self.answered.front().is_some_and(|(_, at)| now.saturating_duration_since(*at) >= ENOUGH) {
            self.forget_answer();
        }
        if !self.known.insert(stretch) {
            return false;
        }
        if self.wanted.len() >= MOST_WANTED
            && let Some(oldest) = self.wanted.pop_front()
        {
            self.known.remove(&oldest);
        }
        self.wanted.push_back(stretch);
        true
    }

    /// What was wanted last comes first.
    pub fn next(&mut self) -> Option<Stretch> {
        let next = self.wanted.pop_back()?;
        if self.answered.len() >= MOST_WANTED {
            self.forget_answer();
        }
        self.answered.push_back((next, Instant::now()));
        Some(next)
    }

    fn forget_answer(&mut self) {
        if let Some((stretch, _)) = self.answered.pop_front() {
            self.known.remove(&stretch);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.wanted.is_empty()
    }
}

#[derive(Default)]
struct State {
    wants: Wants,
    found: Vec<(SeriesId, Vec<Sample>)>,
    problem: Option<StoreError>,
    ending: bool,
}

/// A thread around an archive; it ends when this is dropped.
pub struct Fetcher {
    shared: Arc<Shared<State>>,
}

impl Fetcher {
    /// `wake` is called when something was found.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn start(archive: Box<dyn Archive>, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::<State>::default());
        let fetch = {
            let shared = shared.clone();
            move || run(&shared, archive, wake)
        };
        std::thread::Builder::new().name("recording reader".to_owned()).spawn(fetch)?;
        Ok(Self { shared })
    }

    /// Asks for the samples between two times, both included; what is under way already is not asked again.
    pub fn want(&self, series: SeriesId, stretch: [Micros; 2]) {
        if self.shared.state().wants.add((series, stretch)) {
            self.shared.changed.notify_all();
        }
    }

    /// What was found since this was last asked, to be given to
    /// [`History::fill`](super::super::history::History::fill).
    pub fn take(&self) -> Vec<(SeriesId, Vec<Sample>)> {
        std::mem::take(&mut self.shared.state().found)
    }

    /// Why the last stretch could not be read.
    pub fn problem(&self) -> Option<StoreError> {
        self.shared.state().problem.clone()
    }
}

impl Drop for Fetcher {
    fn drop(&mut self) {
        self.shared.state().ending = true;
        self.shared.changed.notify_all();
    }
}

fn run(shared: &Shared<State>, mut archive: Box<dyn Archive>, wake: impl Fn()) {
    let mut awake = false;
    loop {
        let mut state = shared.state();
        if state.ending {
            return;
        }
        let Some((series, [from, to])) = state.wants.next() else {
            if awake {
                let waited =
                    shared.changed.wait_timeout_while(state, REST, |state| !state.ending && state.wants.is_empty());
                let (rested, result) = waited.unwrap_or_else(PoisonError::into_inner);
                drop(rested);
                if result.timed_out() {
                    archive.rest();
                    awake = false;
                }
            } else {
                let waited = shared.changed.wait_while(state, |state| !state.ending && state.wants.is_empty());
                drop(waited.unwrap_or_else(PoisonError::into_inner));
            }
            continue;
        };
        drop(state);
        awake = true;
        let found = archive.samples(series, from, to);
        let mut state = shared.state();
        let is_first = state.found.is_empty();
        match found {
            Ok(samples) => {
                state.found.push((series, samples));
                state.problem = None;
            }
            Err(problem) => state.problem = Some(problem),
        }
        drop(state);
        if is_first {
            wake();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// Says what it is asked for, and answers when it is allowed to.
    struct Slow {
        asked: Sender<Stretch>,
        go: Receiver<Result<Vec<Sample>, StoreError>>,
    }

    impl Archive for Slow {
        fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
            self.asked.send((series, [from, to])).unwrap();
            self.go.recv().unwrap_or_else(|_| Ok(Vec::new()))
        }
    }

    type Scripted = (Fetcher, Receiver<Stretch>, Sender<Result<Vec<Sample>, StoreError>>, Receiver<()>);

    fn start() -> Scripted {
        let (asked, questions) = channel();
        let (answer, go) = channel();
        let (wake, woken) = channel();
        let fetcher = Fetcher::start(Box::new(Slow { asked, go }), move || {
            let _ = wake.send(());
        });
        let fetcher = fetcher.unwrap();
        (fetcher, questions, answer, woken)
    }

    #[test]
    fn what_is_wanted_is_read_once_and_the_newest_wish_first() {
        let (fetcher, questions, answer, woken) = start();
        fetcher.want(SeriesId(0), [0, 9]);
        assert_eq!(questions.recv().unwrap(), (SeriesId(0), [0, 9]));
        for stretch in [[0, 9], [10, 19], [20, 29], [10, 19]] {
            fetcher.want(SeriesId(0), stretch);
        }
        let sample = Sample { at: 5, value: 1, gap: false };
        answer.send(Ok(vec![sample])).unwrap();
        assert_eq!(questions.recv().unwrap().1, [20, 29]);
        woken.recv().unwrap();
        assert_eq!(fetcher.take(), [(SeriesId(0), vec![sample])]);
        answer.send(Ok(Vec::new())).unwrap();
        assert_eq!(questions.recv().unwrap().1, [10, 19]);
    }

    #[test]
    fn what_cannot_be_read_is_told_and_the_thread_ends_with_its_handle() {
        let (fetcher, questions, answer, woken) = start();
        fetcher.want(SeriesId(3), [0, 9]);
        questions.recv().unwrap();
        let problem = StoreError::NotThere { path: "a.sqlite".into() };
        answer.send(Err(problem.clone())).unwrap();
        woken.recv().unwrap();
        assert_eq!(fetcher.problem(), Some(problem));
        drop(fetcher);
        assert!(questions.recv().is_err(), "the archive is dropped");
    }
}
