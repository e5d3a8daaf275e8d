//! What the counts mean: symptoms with their evidence in numbers.

use jiff::Timestamp;
use serde::Serialize;

use super::medium::Medium;
use super::occurrences::Occurrences;
use super::texts::Symptom;
use crate::bus::Target;

mod line;
mod module;

pub use line::of_line;
pub use module::{of_module, of_unread};

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Good to know.
    Note,
    /// It works, and should be seen to.
    Warning,
    /// It does not work.
    Fault,
}

impl Severity {
    pub fn word(self) -> &'static str {
        match self {
            Self::Note => "Note",
            Self::Warning => "Warning",
            Self::Fault => "Fault",
        }
    }
}

/// A symptom that was seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    pub severity: Severity,
    pub symptom: Symptom,
    /// The module it is about; `None` for the line.
    pub module: Option<Target>,
    pub title: &'static str,
    /// What was counted.
    pub evidence: String,
    pub cause: String,
    pub next_step: String,
}

impl Finding {
    fn new(severity: Severity, symptom: Symptom, evidence: String) -> Self {
        let (title, cause, next_step) = (symptom.title(), symptom.cause().to_owned(), symptom.next_step());
        Self { severity, symptom, module: None, title, evidence, cause, next_step }
    }

    /// What happened by chance in a part of `all` exchanges; a note that it was, once it would have been seen again.
    fn by_chance(
        severity: Severity,
        symptom: Symptom,
        seen: Occurrences,
        all: u64,
        now: Timestamp,
        evidence: String,
    ) -> Self {
        let is_over = severity > Severity::Note && seen.is_over(all);
        if is_over { Self::past(symptom, seen, now, &evidence) } else { Self::new(severity, symptom, evidence) }
    }

    /// What is over.
    fn past(symptom: Symptom, seen: Occurrences, now: Timestamp, evidence: &str) -> Self {
        let (title, cause, next_step) = symptom.past();
        let evidence = format!("{evidence}; the last was {}, and {} followed", seen.age(now), answers(seen.followed));
        let (cause, next_step) = (cause.to_owned(), next_step.to_owned());
        Self { severity: Severity::Note, symptom, module: None, title, evidence, cause, next_step }
    }

    /// With the cause and the next step of this kind of line, unless more is known than what is likely.
    #[must_use]
    fn on(self, medium: Medium) -> Self {
        match self.symptom.over_network() {
            Some((cause, next_step)) if medium == Medium::Network && self.cause == self.symptom.cause() => {
                Self { cause: cause.to_owned(), next_step: next_step.to_owned(), ..self }
            }
            _ => self,
        }
    }

    fn at(self, target: Target) -> Self {
        Self { module: Some(target), ..self }
    }
}

/// Failures rarer than this are what a line may have; repeated reads hide them.
const RARE: f64 = 0.01;
/// From here on it does not work any more.
const BAD: f64 = 0.2;

fn by_share(part: u64, whole: u64) -> Severity {
    let share = part as f64 / whole.max(1) as f64;
    if share >= BAD {
        Severity::Fault
    } else if share >= RARE {
        Severity::Warning
    } else {
        Severity::Note
    }
}

/// The worst first.
fn sorted(mut findings: Vec<Finding>) -> Vec<Finding> {
    findings.sort_by_key(|finding| (std::cmp::Reverse(finding.severity), finding.symptom));
    findings
}

fn times(count: u64) -> String {
    if count == 1 { "once".to_owned() } else { format!("{count} times") }
}

pub(super) fn plural(count: u64, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn answers(count: u64) -> String {
    plural(count, "answer", "answers")
}

fn exchanges(count: u64) -> String {
    plural(count, "exchange", "exchanges")
}
