//! What the counts mean: symptoms with their evidence in numbers.

use serde::Serialize;

use super::outcome::{FailureKind, RefusalKind};
use super::station::Station;
use super::texts::{self, Symptom};
use super::{Consistency, Diagnosis, Judgement};
use crate::bus::{LatencyTimer, LineProblem, ProblemKind, Target};
use crate::protocol::Protocol;

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
        let (title, cause, next_step) = (symptom.title(), symptom.cause().to_owned(), symptom.next_step().to_owned());
        Self { severity, symptom, module: None, title, evidence, cause, next_step }
    }

    fn at(self, target: Target) -> Self {
        Self { module: Some(target), ..self }
    }
}

/// Failures rarer than this are what a line may have; repeated reads hide them.
const RARE: f64 = 0.01;
/// From here on it does not work any more.
const BAD: f64 = 0.2;
/// A module that was silent so often in a row has gone.
const GONE_AFTER: u64 = 5;
/// A silent address was insisted on if it was asked again at once so often.
const INSISTED: u64 = 2;

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

/// What concerns the line as a whole.
pub fn of_line(diagnosis: &Diagnosis) -> Vec<Finding> {
    let line = diagnosis.line();
    let mut found: Vec<Finding> = diagnosis.problem().map(of_problem).into_iter().collect();
    found.extend(silence(diagnosis));
    if line.losses > 0 {
        let evidence = format!("the line was lost {} while it was open", times(line.losses));
        found.push(Finding::new(Severity::Fault, Symptom::PortVanished, evidence));
    }
    if line.echoes > 0 {
        let evidence = format!("{} came behind the echo of their requests", answers(line.echoes));
        found.push(Finding::new(Severity::Note, Symptom::Echo, evidence));
    }
    let late = line.unasked_after_silence;
    if late > 0 {
        let evidence = format!("bytes came {} after a request had been given up", times(late));
        found.push(Finding::new(by_share(late, line.requests).max(Severity::Warning), Symptom::Late, evidence));
    }
    let stray = line.unasked.saturating_sub(late);
    if stray > 0 {
        let evidence = format!("bytes came {} that nobody had asked for ({} in all)", times(stray), line.unasked_bytes);
        found.push(Finding::new(by_share(stray, line.requests), Symptom::Noise, evidence));
    }
    found.extend(diagnosis.adapter().filter(|timer| timer.is_slow()).map(slow_adapter));
    sorted(found)
}

/// Rows for lines and addresses from which nothing came.
fn silence(diagnosis: &Diagnosis) -> Vec<Finding> {
    let line = diagnosis.line();
    let anybody = diagnosis.stations().next().is_some();
    let mut insisted: Vec<(u8, u64)> = Vec::new();
    for (target, again) in line.insisted() {
        match insisted.iter_mut().find(|(address, _)| *address == target.address) {
            Some((_, sum)) => *sum = sum.saturating_add(again),
            None => insisted.push((target.address, again)),
        }
    }
    let insisted = insisted.into_iter().filter(|(_, again)| *again >= INSISTED);
    let mut found: Vec<Finding> = insisted
        .map(|(address, again)| {
            let asked = again.saturating_add(1);
            let evidence = format!("address {address} ({address:02X}h) was asked {} and never answered", times(asked));
            Finding::new(Severity::Fault, Symptom::SilentAddress, evidence)
        })
        .collect();
    if !anybody && line.silent_addresses() > 1 {
        let protocols = line.silent_protocols();
        let one = matches!(protocols[..], [Protocol::Dcon | Protocol::ModbusRtu]);
        let symptom = if one { Symptom::SilentInOneProtocol } else { Symptom::SilentLine };
        let labels: Vec<&str> = protocols.iter().map(|protocol| protocol.label()).collect();
        let settings: Vec<String> = line.silent_settings().take(4).map(ToString::to_string).collect();
        let more = if line.silent_settings().len() > settings.len() { " and others" } else { "" };
        let evidence = format!(
            "{} questions to {} addresses in {} at {}{more}: not one byte came back",
            line.silent_questions,
            line.silent_addresses(),
            labels.join(" and "),
            settings.join(", ")
        );
        found.push(Finding::new(Severity::Fault, symptom, evidence));
    }
    found
}

fn of_problem(problem: &LineProblem) -> Finding {
    let symptom = match &problem.kind {
        ProblemKind::PermissionDenied => Symptom::NoPermission,
        ProblemKind::Busy { .. } => Symptom::PortBusy,
        ProblemKind::NoSuchPort { .. } => Symptom::PortVanished,
        _ => Symptom::NotOpened,
    };
    Finding::new(Severity::Fault, symptom, problem.to_string())
}

fn slow_adapter(timer: &LatencyTimer) -> Finding {
    let evidence = match timer.milliseconds {
        Some(milliseconds) => format!("the latency timer of {} is {milliseconds} ms", timer.port),
        None => format!("{} is an FTDI adapter, whose timer is 16 ms unless it was changed", timer.port),
    };
    let finding = Finding::new(Severity::Note, Symptom::SlowAdapter, evidence);
    Finding { next_step: format!("{}: {}", finding.next_step, timer.how_to_change()), ..finding }
}

/// What concerns one module. `elsewhere` tells that its address answered at another speed or in another protocol, so that
/// what cannot be read here says nothing.
pub fn of_station(target: &Target, station: &Station, test: Option<&Consistency>, elsewhere: bool) -> Vec<Finding> {
    let mut found = Vec::new();
    if station.is_heard() {
        found.extend(failures(station));
    } else if !elsewhere {
        let evidence = format!("{} came back, and none can be read", answers(station.broken()));
        found.push(Finding::new(Severity::Fault, Symptom::Garbage, evidence));
    }
    if station.noisy > 0 {
        let evidence = format!("{} of {} had stray bytes around them", station.noisy, answers(station.usable()));
        found.push(Finding::new(
            by_share(station.noisy, station.usable()).min(Severity::Warning),
            Symptom::Noise,
            evidence,
        ));
    }
    found.extend(refusals(station));
    if let Some(test) = test {
        found.extend(of_test(test));
    }
    sorted(found.into_iter().map(|finding| finding.at(*target)).collect())
}

fn failures(station: &Station) -> Vec<Finding> {
    let asked = station.asked();
    let mut found = Vec::new();
    let mut add = |symptom, part: u64, what: &str| {
        if part > 0 {
            let evidence = format!("{part} of {} {what}", exchanges(asked));
            found.push(Finding::new(by_share(part, asked), symptom, evidence));
        }
    };
    let [checks, garbage] = [FailureKind::WrongCheck, FailureKind::Garbage].map(|kind| station.failures(kind));
    let broken = checks.saturating_add(garbage);
    let what = if checks >= garbage { "had a wrong checksum or CRC" } else { "could not be read" };
    // Alike again and again is no chance; once says nothing yet.
    let alike = broken > 2 && station.forms() == 1;
    add(if alike { Symptom::SameErrors } else { Symptom::ChangingErrors }, broken, what);
    add(Symptom::CutShort, station.failures(FailureKind::CutShort), "were cut short");
    add(Symptom::WrongAddress, station.failures(FailureKind::WrongAddress), "came from another address");
    add(Symptom::Collision, station.failures(FailureKind::Collision), "differ from what was sent");
    add(Symptom::Noise, station.failures(FailureKind::StrayBytes), "were nothing but stray bytes");
    let silent = station.failures(FailureKind::NoAnswer);
    if station.silent_now >= GONE_AFTER {
        let evidence =
            format!("{} answered before, the last {} did not", exchanges(station.usable()), station.silent_now);
        found.push(Finding::new(Severity::Fault, Symptom::Stopped, evidence));
    } else if silent > 0 {
        let evidence = format!("{silent} of {} had no answer", exchanges(asked));
        found.push(Finding::new(by_share(silent, asked), Symptom::Lost, evidence));
    }
    found
}

fn refusals(station: &Station) -> Vec<Finding> {
    let mut found = Vec::new();
    for (kind, count) in &station.refusals {
        let (severity, symptom, evidence, reason) = match kind {
            RefusalKind::Ignored => {
                let evidence = format!("a lone ! came {}", times(*count));
                (Severity::Warning, Symptom::WatchdogTripped, evidence, None)
            }
            RefusalKind::Dcon => {
                let evidence = format!("?AA came {}", times(*count));
                (Severity::Note, Symptom::Refused, evidence, Some(texts::DCON_REASON))
            }
            RefusalKind::Exception(code) => {
                let evidence = format!("exception {code} came {}", times(*count));
                (Severity::Note, Symptom::Refused, evidence, Some(texts::exception_reason(*code)))
            }
        };
        let finding = Finding::new(severity, symptom, evidence);
        let cause = reason.map_or_else(|| finding.cause.clone(), |reason| format!("The line is fine: {reason}"));
        found.push(Finding { cause, ..finding });
    }
    found
}

fn of_test(test: &Consistency) -> Option<Finding> {
    let (severity, symptom) = match test.judgement {
        Judgement::Fine | Judgement::Interrupted => return None,
        Judgement::Doubled => (Severity::Fault, Symptom::DoubledAddress),
        Judgement::Noise => (Severity::Warning, Symptom::Noise),
        Judgement::Lossy => (Severity::Warning, Symptom::Lost),
        Judgement::NoAnswer => (Severity::Fault, Symptom::Stopped),
    };
    Some(Finding::new(severity, symptom, format!("consistency test: {}", test.said)))
}

fn times(count: u64) -> String {
    if count == 1 { "once".to_owned() } else { format!("{count} times") }
}

fn plural(count: u64, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn answers(count: u64) -> String {
    plural(count, "answer", "answers")
}

fn exchanges(count: u64) -> String {
    plural(count, "exchange", "exchanges")
}
