//! The line itself: opening, losing, taking up again, and what is counted on it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::super::adapters::adapters_without_port;
use super::super::dialogue::{Dialogue, Memory};
use super::super::message::{BusEvent, RequestId, Statistics};
use super::super::ports::{KnownPort, ports_of};
use super::super::problem::{LineProblem, Obstacle, ProblemKind};
use super::super::tap::Tap;
use super::super::target::LineAddress;
use super::{LOOK_EVERY, Worker};
use crate::protocol::{Failure, LineSettings};

/// How often a lost port is tried again; an unreachable host takes seconds to fail, so it is tried more rarely.
const REOPEN_PORT_EVERY: Duration = Duration::from_millis(500);
const REOPEN_HOST_EVERY: Duration = Duration::from_secs(5);
const STATISTICS_EVERY: Duration = Duration::from_millis(500);
/// Rates are taken over so many of these times.
const RATE_OVER: usize = 6;

/// A line that is open, or was and is to be taken up again.
pub struct OpenLine {
    address: LineAddress,
    settings: LineSettings,
    /// The port that was opened, if it was listed.
    port: Option<KnownPort>,
    /// `None` while the port is gone.
    dialogue: Option<Dialogue>,
    /// What a lost line was known for, to be carried over when it returns.
    memory: Option<Memory>,
    look_at: Instant,
    frames_missed: Arc<AtomicU64>,
    told: Told,
    /// Why a lost line cannot be taken up although its adapter is there, as it was told last.
    obstacle: Option<Obstacle>,
}

/// Why a lost line cannot be taken up, if it is more than that the adapter is not there.
fn obstacle(problem: Option<LineProblem>) -> Option<Obstacle> {
    match problem {
        Some(problem) if !matches!(problem.kind, ProblemKind::NoSuchPort { .. }) => Some(Obstacle::NotOpened(problem)),
        _ => adapters_without_port().into_iter().next().map(Obstacle::WithoutPort),
    }
}

/// What was told last of the line's use.
struct Told {
    at: Instant,
    transactions: u64,
    rate: f32,
    /// Times and counts before, over which the rate is taken: polls come once a second, so less would swing.
    before: VecDeque<(Instant, u64)>,
}

impl Told {
    fn new(transactions: u64) -> Self {
        Self { at: Instant::now(), transactions, rate: 0.0, before: VecDeque::new() }
    }

    /// Takes in how many transactions there were until now.
    fn note(&mut self, transactions: u64) {
        self.before.push_back((self.at, self.transactions));
        if self.before.len() > RATE_OVER {
            self.before.pop_front();
        }
        (self.at, self.transactions) = (Instant::now(), transactions);
        if let Some((since, count)) = self.before.front() {
            let elapsed = self.at.saturating_duration_since(*since).as_secs_f32().max(f32::EPSILON);
            self.rate = transactions.saturating_sub(*count) as f32 / elapsed;
        }
    }
}

impl OpenLine {
    pub fn is_there(&self) -> bool {
        self.dialogue.is_some()
    }

    /// When something has to be done for the line itself.
    pub fn next_look(&self) -> Instant {
        if self.statistics_due() { self.look_at.min(self.told.at + STATISTICS_EVERY) } else { self.look_at }
    }

    /// The line for the next step of a scan, or why there is none.
    pub fn dialogue_for_scan(&mut self) -> Result<&mut Dialogue, String> {
        let name = &self.address;
        self.dialogue.as_mut().ok_or_else(|| format!("{name} is not there"))
    }

    fn retry_after(&self) -> Duration {
        if self.address.is_tcp() { REOPEN_HOST_EVERY } else { REOPEN_PORT_EVERY }
    }

    /// Whether there are exchanges that were not told yet, or a rate that has fallen to nothing.
    fn statistics_due(&self) -> bool {
        let transactions = self.dialogue.as_ref().map(|dialogue| dialogue.counts().transactions);
        transactions.is_some_and(|count| count != self.told.transactions || self.told.rate > 0.0)
    }
}

impl Worker {
    pub(super) fn open(&mut self, id: RequestId, address: LineAddress, settings: LineSettings) {
        self.forget_line();
        let line = address.to_string();
        let frames_missed = Arc::<AtomicU64>::default();
        // Before it is opened: a port in use is not listed everywhere.
        let port = self.port_of(&address);
        match Dialogue::open(&address, settings, self.tap(&frames_missed)) {
            Ok(mut dialogue) => {
                dialogue.not_before(self.latest);
                dialogue.stop_scans_by(self.hurry.clone());
                let (dialogue, look_at) = (Some(dialogue), Instant::now() + LOOK_EVERY);
                let told = Told::new(0);
                self.line = Some(OpenLine {
                    address,
                    settings,
                    port,
                    dialogue,
                    memory: None,
                    look_at,
                    frames_missed,
                    told,
                    obstacle: None,
                });
                self.tell(BusEvent::Opened { id, line });
            }
            Err(problem) => self.tell(BusEvent::OpenFailed { id, line, problem }),
        }
    }

    /// What the system says of the port of `address`.
    fn port_of(&self, address: &LineAddress) -> Option<KnownPort> {
        let present = ports_of(address, &self.list_ports);
        let name = match address {
            LineAddress::Serial { port } => port.clone(),
            // There is one adapter to a simulated line.
            LineAddress::Simulated { .. } => present.first()?.name.clone(),
            LineAddress::Tcp { .. } => return None,
        };
        KnownPort::among(present, &name)
    }

    /// Where a lost line is now; `None` if its adapter is not there.
    fn whereabouts(&self, line: &OpenLine) -> Option<LineAddress> {
        let Some(known) = &line.port else { return Some(line.address.clone()) };
        let present = ports_of(&line.address, &self.list_ports);
        let name = known.find_again(&present)?.name.clone();
        Some(match &line.address {
            LineAddress::Serial { .. } => LineAddress::Serial { port: name },
            other => other.clone(),
        })
    }

    pub(super) fn close(&mut self, id: RequestId) {
        self.forget_line();
        self.tell(BusEvent::Closed { id });
    }

    fn forget_line(&mut self) {
        self.hurry.store(false, Ordering::Relaxed);
        self.timestamp();
        self.end_scan(true);
        self.reading = None;
        self.line = None;
        self.watches.clear();
        self.repeats.clear();
        self.options.clear();
        self.identified.clear();
    }

    /// Frames are told as they come; when nobody takes them they are counted instead of holding up the line.
    fn tap(&self, missed: &Arc<AtomicU64>) -> Tap {
        let (events, missed) = (self.events.clone(), missed.clone());
        Box::new(move |frame| {
            if events.try_send(BusEvent::Traffic(frame)).is_err() {
                missed.fetch_add(1, Ordering::Relaxed);
            }
        })
    }

    pub(super) fn dialogue(&mut self) -> Result<&mut Dialogue, Failure> {
        let line = self.line.as_mut().ok_or_else(|| Failure::LineLost("no line is open".to_owned()))?;
        let name = &line.address;
        line.dialogue.as_mut().ok_or_else(|| Failure::LineLost(format!("{name} is not there")))
    }

    /// The time of now in UTC, which is never earlier than one that was told before, be it on another line.
    pub(super) fn timestamp(&mut self) -> Timestamp {
        let now = self.dialogue().map(|dialogue| dialogue.timestamp()).unwrap_or_else(|_| Timestamp::now());
        self.latest = self.latest.max(now);
        self.latest
    }

    /// The line's time of now; a line that is not there has the system's.
    pub(super) fn line_time(&mut self) -> Instant {
        self.dialogue().map(|dialogue| dialogue.now()).unwrap_or_else(|_| Instant::now())
    }

    /// Gives the port up if the failure says that it is gone, and plans to take it up again.
    pub(super) fn note_loss(&mut self, failure: Option<Failure>) {
        let Some(Failure::LineLost(reason)) = failure else { return };
        self.timestamp();
        let Some(line) = self.line.as_mut() else { return };
        let Some(dialogue) = line.dialogue.take() else { return };
        line.memory = Some(dialogue.into_memory());
        line.look_at = Instant::now() + line.retry_after();
        // Who comes back behind the adapter may be others.
        self.identified.clear();
        self.tell(BusEvent::LineLost { reason });
    }

    /// Notices a port that vanished while nobody used it.
    pub(super) fn look_at_line(&mut self) {
        let Some(line) = self.line.as_mut() else { return };
        let Some(dialogue) = line.dialogue.as_mut().filter(|_| line.look_at <= Instant::now()) else { return };
        line.look_at = Instant::now() + LOOK_EVERY;
        let lost = dialogue.look().err();
        self.note_loss(lost);
    }

    pub(super) fn reopen(&mut self) {
        let Some(line) = self.line.as_ref() else { return };
        if line.dialogue.is_some() || line.look_at > Instant::now() {
            return;
        }
        let opened = self.whereabouts(line).map(|address| {
            let dialogue = Dialogue::open(&address, line.settings, self.tap(&line.frames_missed));
            dialogue.map(|dialogue| (self.port_of(&address), address, dialogue))
        });
        let (floor, hurry) = (self.latest, self.hurry.clone());
        let Some(line) = self.line.as_mut() else { return };
        match opened {
            Some(Ok((port, address, mut dialogue))) => {
                if let Some(memory) = line.memory.take() {
                    dialogue.remember(memory);
                }
                dialogue.not_before(floor);
                dialogue.stop_scans_by(hurry);
                self.watches.begin_anew(dialogue.now());
                line.dialogue = Some(dialogue);
                line.obstacle = None;
                line.port = port.or(line.port.take());
                line.address = address.clone();
                line.look_at = Instant::now() + LOOK_EVERY;
                self.tell(BusEvent::LineRestored { line: address });
            }
            failed => {
                line.look_at = Instant::now() + line.retry_after();
                let obstacle = obstacle(failed.and_then(Result::err));
                if let Some(obstacle) = obstacle.filter(|obstacle| line.obstacle.as_ref() != Some(obstacle)) {
                    line.obstacle = Some(obstacle.clone());
                    self.tell(BusEvent::StillLost { obstacle });
                }
            }
        }
    }

    pub(super) fn tell_statistics(&mut self) {
        let Some(line) = self.line.as_mut() else { return };
        let elapsed = line.told.at.elapsed();
        if elapsed < STATISTICS_EVERY || !line.statistics_due() {
            return;
        }
        let Some(dialogue) = &line.dialogue else { return };
        let counts = dialogue.counts();
        line.told.note(counts.transactions);
        let rate = line.told.rate;
        let frames_missed = line.frames_missed.load(Ordering::Relaxed);
        self.tell(BusEvent::Statistics(Statistics { transactions_per_second: rate, frames_missed, ..counts }));
    }
}
