//! What is counted of one module.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

use super::consistency::Consistency;
use super::histogram::Histogram;
use super::occurrences::Occurrences;
use super::outcome::{FailureKind, Outcome, RefusalKind};
use super::rates::Rates;
use super::surplus::Surplus;
use super::watchdog::Watchdog;
use crate::bus::Frame;
use crate::protocol::Protocol;

/// Requests whose broken answers are compared; more are as telling as these.
const MOST_FORMS: usize = 32;

/// Broken answers like the one before from which on they are no chance.
const ALIKE: u64 = 2;

/// Counts of one module, or of an address from which bytes came that cannot be read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Station {
    pub answers: u64,
    pub refusals: BTreeMap<RefusalKind, Occurrences>,
    failures: [Occurrences; FailureKind::ALL.len()],
    /// Requests that were sent again at once after a failure.
    pub repeats: u64,
    /// Answers behind the echo of their request.
    pub echoes: u64,
    /// Answers with stray bytes around them.
    pub noisy: Occurrences,
    /// Answers that came when they were not waited for any more.
    pub late: u64,
    /// Silences since it answered last.
    pub silent_now: u64,
    pub times: Histogram,
    pub rates: Rates,
    /// The fingerprint of the last broken answer to each request.
    forms: BTreeMap<u64, u64>,
    /// Broken answers that were like the last one to the same request, and those that were not.
    alike: u64,
    changed: u64,
    /// Broken answers with bytes.
    broken: u64,
    watchdog: Watchdog,
}

impl Station {
    /// Takes in what came back on `request`, and what was around it.
    pub(super) fn take(&mut self, frame: &Frame, outcome: Outcome, request: &[u8], around: Surplus) {
        match outcome {
            Outcome::Answer => self.answered(request, frame, around),
            Outcome::Refusal(kind) => {
                if kind == RefusalKind::Ignored {
                    self.watchdog.ignored(request);
                }
                self.refusals.entry(kind).or_default().add(frame.at);
            }
            Outcome::Failed(kind) => self.failed(frame, kind, request),
            Outcome::Unasked | Outcome::LineLost => return,
        }
        let failed = matches!(outcome, Outcome::Failed(_));
        self.rates.add(frame.at, failed);
        self.echoes = self.echoes.saturating_add(u64::from(frame.echo));
        if !failed {
            self.silent_now = 0;
            self.times.add(answer_time(frame));
        }
    }

    fn answered(&mut self, request: &[u8], frame: &Frame, around: Surplus) {
        count(&mut self.answers);
        self.failures.iter_mut().for_each(Occurrences::follow);
        self.refusals.values_mut().for_each(Occurrences::follow);
        self.noisy.follow();
        if around == Surplus::Stray {
            self.noisy.add(frame.at);
        }
        self.watchdog.answered(request, frame);
    }

    fn failed(&mut self, frame: &Frame, kind: FailureKind, request: &[u8]) {
        if let Some(failures) = self.failures.get_mut(kind.index()) {
            failures.add(frame.at);
        }
        if kind == FailureKind::NoAnswer {
            count(&mut self.silent_now);
        } else {
            count(&mut self.broken);
            self.compare(fingerprint(request), fingerprint(&frame.bytes));
        }
    }

    fn compare(&mut self, request: u64, answer: u64) {
        if self.forms.len() >= MOST_FORMS && !self.forms.contains_key(&request) {
            return;
        }
        match self.forms.insert(request, answer) {
            Some(before) if before == answer => count(&mut self.alike),
            Some(_) => count(&mut self.changed),
            None => {}
        }
    }

    /// Answers that came too late, with those of a test, which listens longer.
    pub fn late_with(&self, test: Option<&Consistency>) -> u64 {
        let Some(test) = test else { return self.late };
        let unmeasured = u64::from(test.late.saturating_sub(test.slow));
        self.late.max(unmeasured).saturating_add(u64::from(test.slow))
    }

    /// Whether it ever said something that can be read.
    pub fn is_heard(&self) -> bool {
        self.usable() > 0
    }

    /// Answers and refusals.
    pub fn usable(&self) -> u64 {
        self.answers.saturating_add(self.refused())
    }

    pub fn refused(&self) -> u64 {
        self.refusals.values().map(|refusals| refusals.count).sum()
    }

    pub fn failures(&self, kind: FailureKind) -> u64 {
        self.failure(kind).count
    }

    /// The same with the time of the last one.
    pub fn failure(&self, kind: FailureKind) -> Occurrences {
        self.failures.get(kind.index()).copied().unwrap_or_default()
    }

    pub fn all_failures(&self) -> u64 {
        self.failures.iter().map(|failures| failures.count).sum()
    }

    /// How it fails most often, silence left aside.
    pub fn main_failure(&self) -> Option<FailureKind> {
        let spoken = FailureKind::ALL.into_iter().filter(|kind| *kind != FailureKind::NoAnswer);
        spoken.max_by_key(|kind| self.failures(*kind)).filter(|kind| self.failures(*kind) > 0)
    }

    /// Whether the host watchdog has tripped, as far as is known, and was not cleared since.
    pub fn is_watchdog_tripped(&self) -> bool {
        self.watchdog.is_tripped()
    }

    /// Exchanges that came to an end, good or bad.
    pub fn asked(&self) -> u64 {
        self.usable().saturating_add(self.all_failures())
    }

    /// The part of all exchanges that failed, 0 to 1.
    pub fn error_rate(&self) -> f64 {
        self.all_failures() as f64 / self.asked().max(1) as f64
    }

    /// Whether the same request draws the same broken answer again and again, which is no chance.
    pub fn breaks_alike(&self) -> bool {
        self.alike >= ALIKE && self.alike > self.changed
    }

    pub fn broken(&self) -> u64 {
        self.broken
    }
}

pub(super) fn count(counter: &mut u64) {
    *counter = counter.saturating_add(1);
}

pub(super) fn fingerprint(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

/// From the end of the request to the first byte. Where the line does not tell it, what the bytes took on the wire is taken
/// off.
pub(super) fn answer_time(frame: &Frame) -> Duration {
    let on_wire = match frame.protocol {
        Protocol::ModbusTcp => Duration::ZERO,
        _ => frame.settings.wire_time(frame.bytes.len()),
    };
    frame.first_byte.unwrap_or_else(|| frame.took.saturating_sub(on_wire))
}
