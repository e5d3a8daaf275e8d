//! The files that were recorded since the start, and what is fetched from them when somebody looks at it again.

use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::record::{
    Archive, Event, Fetcher, Files, History, MOST_EVENTS, Micros, Record, Recorder, Sample, SeriesId, StoreError,
};

/// Samples handed over at once.
const AT_ONCE: usize = 10_000;
/// How long the end of the program waits for a disk.
const PATIENCE: Duration = Duration::from_secs(5);

type Wake = Arc<dyn Fn() + Send + Sync>;

/// All that this run has recorded, and what it has not.
#[derive(Default)]
pub struct Shelf {
    files: Option<SharedFiles>,
    fetcher: Option<Fetcher>,
    /// Why what was given up could not be fetched, as it was told last.
    told: Option<StoreError>,
    /// Recordings that are being closed; each says why something could not be written, and gives it back.
    ending: Vec<Receiver<(Option<String>, Vec<Record>)>>,
    /// What ended recordings could not write, for the next one.
    unwritten: Vec<Record>,
    /// The last sample of each series that was handed to a recording which has ended.
    until: BTreeMap<SeriesId, Micros>,
    /// Events that were handed to no recording.
    events: VecDeque<Event>,
}

/// The same files for several who look things up.
#[derive(Clone)]
struct SharedFiles(Arc<Mutex<Files>>);

impl Archive for SharedFiles {
    fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).samples(series, from, to)
    }

    fn rest(&mut self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).rest();
    }
}

impl Shelf {
    /// Takes in the files of a recording that begins.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn add(&mut self, files: Files, wake: &Wake) -> io::Result<()> {
        if let Some(SharedFiles(known)) = &self.files {
            known.lock().unwrap_or_else(PoisonError::into_inner).join(files);
            return Ok(());
        }
        let files = SharedFiles(Arc::new(Mutex::new(files)));
        let wake = wake.clone();
        self.fetcher = Some(Fetcher::start(Box::new(files.clone()), move || wake())?);
        self.files = Some(files);
        Ok(())
    }

    pub fn archive(&self) -> Option<Box<dyn Archive>> {
        self.files.clone().map(|files| -> Box<dyn Archive> { Box::new(files) })
    }

    /// Asks for what was looked at and is not in memory, and takes in what came. True if anything did.
    pub fn pump(&self, history: &mut History) -> bool {
        let Some(fetcher) = &self.fetcher else { return false };
        let ids: Vec<SeriesId> = history.series().map(|(id, _)| id).collect();
        for id in ids {
            let wanted = history.trend_mut(id).map(|trend| trend.take_wanted()).unwrap_or_default();
            wanted.into_iter().for_each(|stretch| fetcher.want(id, stretch));
        }
        let found = fetcher.take();
        found.iter().for_each(|(id, samples)| history.fill(*id, samples));
        !found.is_empty()
    }

    /// Everything earlier is on the disk, in the files of recordings that have ended.
    pub fn saved(&self) -> Option<Micros> {
        self.until.values().min().copied()
    }

    /// Why what was given up could not be fetched; each reason is told once.
    pub fn new_problem(&mut self) -> Option<String> {
        let problem = self.fetcher.as_ref().and_then(Fetcher::problem);
        let is_new = problem != self.told;
        self.told.clone_from(&problem);
        problem.filter(|_| is_new).map(|problem| problem.to_string())
    }

    /// Remembers an event for the next recording, as nobody records now; the oldest are forgotten.
    pub fn note_event(&mut self, event: Event) {
        if self.events.len() >= MOST_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    /// Everything in `history` was handed to a recording.
    pub fn note_end(&mut self, history: &History) {
        let last = history.series().filter_map(|(id, series)| Some((id, series.trend.last_sample()?.at)));
        self.until = last.collect();
    }

    /// Whether a recording is still being closed: what it cannot write comes before everything newer.
    pub fn is_ending(&self) -> bool {
        !self.ending.is_empty()
    }

    /// Hands over what no file has: what an ended recording could not write, and what is in memory and was handed to none
    /// yet, a part at a time.
    pub fn hand_over_missed(&mut self, history: &History, mut put: impl FnMut(Vec<Record>)) {
        let unwritten = std::mem::take(&mut self.unwritten);
        if !unwritten.is_empty() {
            put(unwritten);
        }
        let samples = history.series().flat_map(|(id, series)| {
            let after = self.until.get(&id).copied().unwrap_or(Micros::MIN);
            let blocks = series.trend.blocks();
            let begin = blocks.partition_point(|block| block.node.last <= after);
            let resident = blocks.iter().skip(begin).filter_map(|block| block.samples.as_ref());
            let samples = resident.flat_map(move |samples| samples.iter().filter(move |sample| sample.at > after));
            samples.map(move |sample| Record::Sample(id, sample))
        });
        let events = std::mem::take(&mut self.events);
        let mut missed = samples.chain(events.into_iter().map(Record::Event)).peekable();
        while missed.peek().is_some() {
            put(missed.by_ref().take(AT_ONCE).collect());
        }
    }

    /// Lets a recording write what waits and close its file; what was not written is told later.
    pub fn finish(&mut self, recorder: Recorder, wake: &Wake) {
        let (tell, ending) = sync_channel(1);
        let wake = wake.clone();
        let finish = move || {
            let (finished, unwritten) = recorder.finish_keeping();
            // Nobody waits any more if the program ends.
            let _ = tell.send((finished.err().map(|error| error.to_string()), unwritten));
            wake();
        };
        match std::thread::Builder::new().name("recording's end".to_owned()).spawn(finish) {
            Ok(_) => self.ending.push(ending),
            // The recorder has ended with its handle.
            Err(error) => log::warn!("a recording was ended in haste: {error}"),
        }
    }

    /// What ended recordings could not write; each is told once.
    pub fn take_problems(&mut self) -> Vec<String> {
        let Self { ending, unwritten, .. } = self;
        let mut problems = Vec::new();
        ending.retain(|ending| match ending.try_recv() {
            Ok((problem, kept)) => {
                problems.extend(problem);
                unwritten.extend(kept);
                false
            }
            Err(TryRecvError::Empty) => true,
            Err(TryRecvError::Disconnected) => false,
        });
        problems
    }

    /// Waits until all recordings are closed, but not for ever. What could not be written.
    pub fn wait(&mut self) -> Vec<String> {
        let deadline = Instant::now().checked_add(PATIENCE);
        let mut problems = Vec::new();
        for ending in std::mem::take(&mut self.ending) {
            let left = deadline.map_or(PATIENCE, |deadline| deadline.saturating_duration_since(Instant::now()));
            match ending.recv_timeout(left) {
                Ok((problem, kept)) => {
                    problems.extend(problem);
                    self.unwritten.extend(kept);
                }
                Err(RecvTimeoutError::Disconnected) => {}
                Err(RecvTimeoutError::Timeout) => problems.push("the disk does not answer".to_owned()),
            }
        }
        problems
    }
}
