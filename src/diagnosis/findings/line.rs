//! What concerns the line as a whole.

use std::collections::{BTreeMap, BTreeSet};

use jiff::Timestamp;

use super::module::symptom_of_unread;
use super::{Finding, Severity, answers, by_share, plural, sorted, times};
use crate::bus::{LatencyTimer, LineProblem, ProblemKind, Target, WithoutPort};
use crate::diagnosis::occurrences::Occurrences;
use crate::diagnosis::station::Station;
use crate::diagnosis::texts::{self, Symptom};
use crate::diagnosis::{Diagnosis, LineFacts, Medium};
use crate::protocol::Protocol;

/// A silent address was insisted on if it was asked again at once so often.
const INSISTED: u64 = 2;
/// Addresses that are named; more are counted.
const MOST_NAMED: usize = 8;
/// A line that was lost so often has a bad contact, even if it comes back each time.
const LOST_OFTEN: u64 = 3;

/// What concerns the line as a whole. `unread` are the places from which only unreadable bytes came and that are told
/// together.
pub fn of_line(diagnosis: &Diagnosis, now: Timestamp, unread: &[(&Target, &Station)]) -> Vec<Finding> {
    let line = diagnosis.line();
    let mut found: Vec<Finding> = diagnosis.problem().map(of_problem).into_iter().collect();
    found.extend(silence(diagnosis));
    found.extend(gathered(unread, diagnosis.stations().any(|(_, station)| station.is_heard())));
    found.extend(losses(line.losses, diagnosis.medium(), now));
    if line.echoes > 0 {
        let evidence = format!("{} came behind the echo of their requests", answers(line.echoes));
        found.push(Finding::new(Severity::Note, Symptom::Echo, evidence));
    }
    found.extend(beside_answers(line, now));
    found.extend(noise(line, now));
    found.extend(diagnosis.adapter().filter(|timer| timer.is_slow()).map(slow_adapter));
    sorted(found.into_iter().map(|finding| finding.on(diagnosis.medium())).collect())
}

fn losses(losses: Occurrences, medium: Medium, now: Timestamp) -> Option<Finding> {
    let evidence = format!("the line was lost {} while it was open", times(losses.count));
    let symptom = if medium == Medium::Network { Symptom::ConnectionLost } else { Symptom::PortVanished };
    match (losses.count, losses.followed) {
        (0, _) => None,
        (_, 0) => Some(Finding::new(Severity::Fault, symptom, evidence)),
        (count, _) => {
            let finding = Finding::past(symptom, losses, now, &evidence);
            let often = count >= LOST_OFTEN && !losses.is_over(0);
            Some(Finding { severity: if often { Severity::Warning } else { Severity::Note }, ..finding })
        }
    }
}

/// Whole answers too many: late ones, and second ones.
fn beside_answers(line: &LineFacts, now: Timestamp) -> Vec<Finding> {
    let mut found = Vec::new();
    if line.late.count > 0 {
        let severity = by_share(line.late.count, line.requests).max(Severity::Warning);
        let evidence = match line.late.count {
            1 => "1 answer came after its request had been given up, or beside another".to_owned(),
            count => format!("{count} answers came after their requests had been given up, or beside others"),
        };
        found.push(Finding::by_chance(severity, Symptom::Late, line.late, line.requests, now, evidence));
    }
    if line.copies.count > 0 {
        let severity = by_share(line.copies.count, line.requests).min(Severity::Warning);
        let evidence = format!("{} came a second time, byte for byte", answers(line.copies.count));
        found.push(Finding::by_chance(severity, Symptom::Twice, line.copies, line.requests, now, evidence));
    }
    found
}

fn noise(line: &LineFacts, now: Timestamp) -> Option<Finding> {
    let mut parts = Vec::new();
    if line.stray.count > 0 {
        parts.push(format!(
            "bytes came {} that nobody had asked for ({} in all)",
            times(line.stray.count),
            line.unasked_bytes
        ));
    }
    let mut severity = by_share(line.stray.count, line.requests);
    if line.stray_answers.count > 0 {
        let addresses = plural(u64::from(line.stray_addresses()), "address", "addresses");
        parts.push(format!("only 00 and FF came {} at {addresses}", times(line.stray_answers.count)));
        severity = severity.max(by_share(line.stray_answers.count, line.requests).min(Severity::Warning));
    }
    let seen = line.stray.and(line.stray_answers);
    let evidence = parts.join("; ");
    (seen.count > 0).then(|| Finding::by_chance(severity, Symptom::Noise, seen, line.requests, now, evidence))
}

/// One finding for all places that are alike, so that noise during a scan does not fill pages.
fn gathered(unread: &[(&Target, &Station)], anybody: bool) -> Vec<Finding> {
    let mut places: BTreeMap<Symptom, (BTreeSet<u8>, u64)> = BTreeMap::new();
    for (target, station) in unread {
        let (addresses, count) = places.entry(symptom_of_unread(station)).or_default();
        addresses.insert(target.address);
        *count = count.saturating_add(station.broken());
    }
    places.into_iter().map(|(symptom, (addresses, count))| of_places(symptom, &addresses, count, anybody)).collect()
}

fn of_places(symptom: Symptom, addresses: &BTreeSet<u8>, count: u64, anybody: bool) -> Finding {
    let number = u64::try_from(addresses.len()).unwrap_or(u64::MAX);
    // Where others are understood and nothing came a second time, it may be a disturbance of that moment.
    let severity = if anybody && count <= number { Severity::Warning } else { Severity::Fault };
    let named: Vec<String> = addresses.iter().take(MOST_NAMED).map(ToString::to_string).collect();
    let more = if addresses.len() > MOST_NAMED { " and others" } else { "" };
    let what = if symptom == Symptom::Garbage { "garbage" } else { "answers that cannot be used" };
    let places = plural(number, "address", "addresses");
    let evidence = format!("{what} at {places}, {} in all: {}{more}", answers(count), named.join(", "));
    Finding::new(severity, symptom, evidence)
}

/// Rows for lines and addresses from which nothing came.
fn silence(diagnosis: &Diagnosis) -> Vec<Finding> {
    let line = diagnosis.line();
    let mut insisted: BTreeMap<u8, (u64, u64)> = BTreeMap::new();
    for (target, again) in line.insisted().filter(|(target, _)| !line.is_heard(target.address)) {
        let (sum, targets) = insisted.entry(target.address).or_default();
        (*sum, *targets) = (sum.saturating_add(again), targets.saturating_add(1));
    }
    let insisted = insisted.into_iter().filter(|(_, (again, _))| *again >= INSISTED);
    let mut found: Vec<Finding> = insisted
        .map(|(address, (again, targets))| {
            // Each was asked a first time.
            let asked = times(again.saturating_add(targets));
            let evidence = format!("address {address} ({address:02X}h) was asked {asked} and never answered");
            Finding::new(Severity::Fault, Symptom::SilentAddress, evidence)
        })
        .collect();
    if diagnosis.stations().next().is_none() && line.silent_addresses() > 1 {
        found.push(silent_line(line));
    }
    found
}

fn silent_line(line: &LineFacts) -> Finding {
    let protocols = line.silent_protocols();
    let one = matches!(protocols[..], [Protocol::Dcon | Protocol::ModbusRtu]);
    let symptom = if one { Symptom::SilentInOneProtocol } else { Symptom::SilentLine };
    let labels: Vec<&str> = protocols.iter().map(|protocol| protocol.label()).collect();
    let settings: Vec<String> = line.silent_settings().take(4).map(ToString::to_string).collect();
    let more = if line.silent_settings().len() > settings.len() { " and others" } else { "" };
    let what = if line.stray_answers.count > 0 { "nothing but stray bytes" } else { "not one byte" };
    let evidence = format!(
        "{} questions to {} addresses in {} at {}{more}: {what} came back",
        line.silent_questions,
        line.silent_addresses(),
        labels.join(" and "),
        settings.join(", ")
    );
    Finding::new(Severity::Fault, symptom, evidence)
}

fn of_problem(problem: &LineProblem) -> Finding {
    let symptom = match &problem.kind {
        ProblemKind::PermissionDenied => Symptom::NoPermission,
        ProblemKind::Busy { .. } => Symptom::PortBusy,
        ProblemKind::NoSuchPort { portless, .. } if !portless.is_empty() => return without_port(problem, portless),
        ProblemKind::NoSuchPort { present, .. } => return no_such_port(problem, present),
        ProblemKind::NotReached(_) => Symptom::NotReached,
        ProblemKind::NotASerialPort => Symptom::NoSerialPort,
        ProblemKind::Other(_) => Symptom::NotOpened,
    };
    Finding::new(Severity::Fault, symptom, problem.to_string())
}

/// Nothing is plugged in that could be meant, or the name is another one.
fn no_such_port(problem: &LineProblem, present: &[String]) -> Finding {
    let finding = Finding::new(Severity::Fault, Symptom::NoSuchPort, format!("there is no port {}", problem.line));
    if present.is_empty() {
        let cause = "The adapter is not plugged in, or has no driver: there is no serial port at all".to_owned();
        let next_step = "Plug the adapter in; `dcon-bench ports` lists the ports that are there".to_owned();
        return Finding { cause, next_step, ..finding };
    }
    let next_step = format!("{}: at present {}", finding.next_step, present.join(", "));
    Finding { next_step, ..finding }
}

/// The adapter is there and has no port: what is known of it is more than what is likely.
fn without_port(problem: &LineProblem, portless: &[WithoutPort]) -> Finding {
    let finding = Finding::new(Severity::Fault, Symptom::NoSuchPort, format!("there is no port {}", problem.line));
    let causes: Vec<String> = portless.iter().map(WithoutPort::happened).collect();
    let mut steps: Vec<String> = portless.iter().map(|adapter| texts::sentence(&adapter.reason.next_step())).collect();
    steps.dedup();
    Finding { cause: causes.join(". "), next_step: steps.join(". "), ..finding }
}

fn slow_adapter(timer: &LatencyTimer) -> Finding {
    let evidence = match timer.milliseconds {
        Some(milliseconds) => format!("the latency timer of {} is {milliseconds} ms", timer.port),
        None => format!("{} is an FTDI adapter, whose timer is 16 ms unless it was changed", timer.port),
    };
    let finding = Finding::new(Severity::Note, Symptom::SlowAdapter, evidence);
    Finding { next_step: format!("{}: {}", finding.next_step, timer.how_to_change()), ..finding }
}
