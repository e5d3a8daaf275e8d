//! What is counted of one module.

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

use super::histogram::Histogram;
use super::outcome::{FailureKind, Outcome, RefusalKind};
use super::rates::Rates;
use crate::bus::Frame;
use crate::protocol::Protocol;

/// Different broken answers that are told apart; more are as telling as these.
const MOST_FORMS: usize = 32;

/// Counts of one module, or of an address from which bytes came that cannot be read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Station {
    pub answers: u64,
    pub refusals: BTreeMap<RefusalKind, u64>,
    failures: [u64; FailureKind::ALL.len()],
    /// Requests that were sent again at once after a failure.
    pub repeats: u64,
    /// Answers behind the echo of their request.
    pub echoes: u64,
    /// Answers with stray bytes around them.
    pub noisy: u64,
    /// Silences since it answered last.
    pub silent_now: u64,
    pub times: Histogram,
    pub rates: Rates,
    /// Fingerprints of broken answers.
    forms: BTreeSet<u64>,
    /// Broken answers with bytes.
    broken: u64,
}

impl Station {
    pub(super) fn take(&mut self, frame: &Frame, outcome: Outcome) {
        match outcome {
            Outcome::Answer => self.answers = self.answers.saturating_add(1),
            Outcome::Refusal(kind) => count(self.refusals.entry(kind).or_default()),
            Outcome::Failed(kind) => self.failed(frame, kind),
            Outcome::Unasked | Outcome::LineLost => return,
        }
        let failed = matches!(outcome, Outcome::Failed(_));
        self.rates.add(frame.at, failed);
        self.echoes = self.echoes.saturating_add(u64::from(frame.echo));
        self.noisy = self.noisy.saturating_add(u64::from(frame.noise && !failed));
        if !failed {
            self.silent_now = 0;
            self.times.add(answer_time(frame));
        }
    }

    fn failed(&mut self, frame: &Frame, kind: FailureKind) {
        if let Some(failures) = self.failures.get_mut(kind.index()) {
            count(failures);
        }
        if kind == FailureKind::NoAnswer {
            count(&mut self.silent_now);
        } else {
            count(&mut self.broken);
            if self.forms.len() < MOST_FORMS {
                self.forms.insert(fingerprint(&frame.bytes));
            }
        }
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
        self.refusals.values().sum()
    }

    pub fn failures(&self, kind: FailureKind) -> u64 {
        self.failures.get(kind.index()).copied().unwrap_or_default()
    }

    pub fn all_failures(&self) -> u64 {
        self.failures.iter().sum()
    }

    /// Exchanges that came to an end, good or bad.
    pub fn asked(&self) -> u64 {
        self.usable().saturating_add(self.all_failures())
    }

    /// The part of all exchanges that failed, 0 to 1.
    pub fn error_rate(&self) -> f64 {
        self.all_failures() as f64 / self.asked().max(1) as f64
    }

    /// How many different forms broken answers had.
    pub fn forms(&self) -> usize {
        self.forms.len()
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
