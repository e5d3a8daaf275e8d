//! What is wrong with a line, told from its frames alone: the window, the command line and the replay of a capture feed the
//! same [`Diagnosis`] and show the same [`Report`].
//!
//! Pure but for [`bundle`], which makes a file. Memory is bounded, however long a line is watched. An address that never
//! answered is no module: a scan's silence counts nowhere as an error.

pub mod bundle;
mod consistency;
mod findings;
mod histogram;
mod line;
mod medium;
mod occurrences;
mod outcome;
mod rates;
mod report;
mod station;
mod surplus;
mod texts;
mod timeout;
mod watchdog;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use crate::bus::{Direction, Frame, LatencyTimer, LineProblem, ProblemKind, Target, Tuning, may_be_probe};
use crate::protocol::{LineSettings, Protocol};

pub use consistency::{Consistency, ConsistencyTest, DEFAULT_READS, Judgement, READS};
pub use findings::{Finding, Severity};
pub use histogram::{Bar, Histogram, Times};
pub use line::LineFacts;
pub use medium::Medium;
pub use occurrences::Occurrences;
pub use outcome::{FailureKind, Outcome, RefusalKind};
pub use rates::{Rates, SLOT_SECONDS, Slot};
pub use report::{Adapter, LineReport, ModuleReport, Report, adapter_in_words, noise_in_words};
pub use station::Station;
use surplus::{Heard, Surplus};
pub use texts::Symptom;
pub use timeout::{SuggestedTimeout, TimeoutAdvice, Waiting, suggest};

/// Modules kept at most.
pub const MOST_STATIONS: usize = 256;

/// Everything that is known of the health of one line.
#[derive(Debug, Clone, Default)]
pub struct Diagnosis {
    line: LineFacts,
    stations: BTreeMap<Target, Station>,
    tests: BTreeMap<Target, Consistency>,
    /// The last request and whether it has failed; a broadcast is none.
    last: Option<Request>,
    /// The last answer.
    heard: Heard,
    adapter: Option<LatencyTimer>,
    problem: Option<LineProblem>,
    /// How patient the line is.
    tuning: Tuning,
    medium: Medium,
}

#[derive(Debug, Clone)]
struct Request {
    target: Target,
    bytes: Vec<u8>,
    failed: bool,
    /// The request before, to the same module, has failed.
    after_failure: bool,
}

impl Diagnosis {
    /// Takes in what passed the line. Frames come in the order of the line.
    pub fn take(&mut self, frame: &Frame) {
        self.medium = Medium::of(frame.protocol);
        match frame.direction {
            Direction::Sent => self.sent(frame),
            Direction::Received => self.received(frame),
        }
    }

    /// What the system tells of the adapter's latency timer.
    pub fn note_adapter(&mut self, adapter: Option<LatencyTimer>) {
        self.adapter = adapter;
    }

    /// How patient the line is from now on.
    pub fn note_tuning(&mut self, tuning: Tuning) {
        self.tuning = tuning.within_limits();
    }

    /// The line could not be opened.
    pub fn note_problem(&mut self, problem: LineProblem) {
        if matches!(problem.kind, ProblemKind::NotReached(_)) {
            self.medium = Medium::Network;
        }
        self.problem = Some(problem);
    }

    /// How many identical reads of a module came out; it replaces an earlier test of the same module.
    pub fn note_test(&mut self, test: Consistency) {
        if self.tests.len() < MOST_STATIONS || self.tests.contains_key(&test.target) {
            self.tests.insert(test.target, test);
        }
    }

    /// Modules that answered, and places from which bytes came that cannot be read.
    pub fn stations(&self) -> impl Iterator<Item = (&Target, &Station)> {
        self.stations.iter()
    }

    pub fn station(&self, target: &Target) -> Option<&Station> {
        self.stations.get(target)
    }

    pub fn test(&self, target: &Target) -> Option<&Consistency> {
        self.tests.get(target)
    }

    pub fn line(&self) -> &LineFacts {
        &self.line
    }

    pub fn adapter(&self) -> Option<&LatencyTimer> {
        self.adapter.as_ref()
    }

    /// How patient the line is.
    pub fn tuning(&self) -> Tuning {
        self.tuning
    }

    pub fn medium(&self) -> Medium {
        self.medium
    }

    /// How long answers are waited for.
    pub fn waiting(&self) -> Waiting {
        let latency_ms = self.adapter.as_ref().and_then(|timer| timer.milliseconds);
        Waiting { in_use: self.tuning.timeout, latency_ms, medium: self.medium }
    }

    pub fn problem(&self) -> Option<&LineProblem> {
        self.problem.as_ref()
    }

    /// Nothing passed the line yet, and nothing else is known of it.
    pub fn is_empty(&self) -> bool {
        self.line.requests == 0 && self.line.unasked_bytes == 0 && self.problem.is_none()
    }

    fn sent(&mut self, frame: &Frame) {
        self.line.requests = self.line.requests.saturating_add(1);
        let Some(target) = target_of(frame) else {
            self.last = None;
            return;
        };
        let before = self.last.take().filter(|last| last.failed && last.target == target);
        let after_failure = before.is_some();
        if before.is_some_and(|last| last.bytes == frame.bytes) {
            match self.stations.get_mut(&target) {
                Some(station) => station::count(&mut station.repeats),
                None => self.line.insist(target),
            }
        }
        self.last = Some(Request { target, bytes: frame.bytes.clone(), failed: false, after_failure });
    }

    fn received(&mut self, frame: &Frame) {
        let Some(outcome) = Outcome::of(frame) else { return };
        match outcome {
            Outcome::Unasked => {
                let after_silence = self.last.as_ref().is_some_and(|last| last.failed);
                let what = self.heard.behind(frame);
                if after_silence && what.is_whole() {
                    self.late_from_last();
                }
                return self.line.take_unasked(frame, what, after_silence);
            }
            Outcome::LineLost => return self.line.losses.add(frame.at),
            _ => {}
        }
        let Some(target) = target_of(frame) else { return };
        let (mut request, mut after_failure) = (Vec::new(), false);
        if let Some(last) = self.last.as_mut().filter(|last| last.target == target) {
            last.failed = matches!(outcome, Outcome::Failed(_));
            request.clone_from(&last.bytes);
            after_failure = last.after_failure;
        }
        let is_probe = matches!(outcome, Outcome::Refusal(_)) && may_be_probe(frame.protocol, &request);
        let outcome = if is_probe { Outcome::Answer } else { outcome };
        let is_ordinary = !matches!(outcome, Outcome::Failed(_));
        let around = if is_ordinary { Surplus::around(frame, Some(&request)) } else { Surplus::Nothing };
        self.heard = if is_ordinary { Heard::of(frame, Some(&request)) } else { Heard::default() };
        self.line.take(frame, around, is_ordinary);
        if !self.stations.contains_key(&target) {
            match outcome {
                Outcome::Failed(FailureKind::NoAnswer) => return self.line.silent_at(&target),
                Outcome::Failed(FailureKind::StrayBytes) => return self.line.stray_from(frame, &target),
                _ => {}
            }
        }
        self.line.heard_at(&target);
        if let Some(station) = self.station_for(target) {
            station.take(frame, outcome, &request, around);
        }
        if around == Surplus::Other && after_failure {
            self.late_from_last();
        }
    }

    /// An answer to the last request, or to the one before, came when it was not waited for any more.
    fn late_from_last(&mut self) {
        if let Some(station) = self.last.as_ref().and_then(|last| self.stations.get_mut(&last.target)) {
            station::count(&mut station.late);
        }
    }

    /// The counts of `target`; where there is no room, those of a place that never answered make it.
    fn station_for(&mut self, target: Target) -> Option<&mut Station> {
        if self.stations.len() >= MOST_STATIONS && !self.stations.contains_key(&target) {
            let mute = self.stations.iter().find(|(_, station)| !station.is_heard()).map(|(target, _)| *target)?;
            self.stations.remove(&mute);
        }
        Some(self.stations.entry(target).or_default())
    }
}

/// Which module a frame belongs to; speed and format mean nothing over TCP.
fn target_of(frame: &Frame) -> Option<Target> {
    let network = frame.protocol == Protocol::ModbusTcp;
    Some(Target {
        address: frame.address?,
        protocol: frame.protocol,
        settings: if network { LineSettings::default() } else { frame.settings },
        checksum: frame.checksum,
    })
}
