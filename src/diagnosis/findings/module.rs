//! What concerns one module, or one place from which only unreadable bytes came.

use jiff::Timestamp;

use super::{Finding, Severity, answers, by_share, exchanges, sorted, times};
use crate::bus::Target;
use crate::diagnosis::occurrences::Occurrences;
use crate::diagnosis::outcome::{FailureKind, RefusalKind};
use crate::diagnosis::station::Station;
use crate::diagnosis::texts::{self, Symptom};
use crate::diagnosis::{Consistency, Judgement, Medium};

/// A module that was silent so often in a row has gone.
const GONE_AFTER: u64 = 5;

/// What concerns one module that was heard.
pub fn of_module(target: &Target, station: &Station, test: Option<&Consistency>, now: Timestamp) -> Vec<Finding> {
    let mut found = failures(station, station.late_with(test), now);
    if station.noisy.count > 0 {
        let evidence = format!("{} of {} had stray bytes around them", station.noisy.count, answers(station.usable()));
        let severity = by_share(station.noisy.count, station.usable()).min(Severity::Warning);
        let all = station.usable();
        found.push(Finding::by_chance(severity, Symptom::Noise, station.noisy, all, now, evidence));
    }
    found.extend(refusals(station, now));
    of_place(target, tested(found, test))
}

/// With what the test has shown, which answers the question that changing errors leave open.
fn tested(mut found: Vec<Finding>, test: Option<&Consistency>) -> Vec<Finding> {
    if let Some(finding) = test.and_then(of_test) {
        found.retain(|other| other.symptom != Symptom::ChangingErrors);
        found.push(finding);
    }
    found
}

fn of_place(target: &Target, found: Vec<Finding>) -> Vec<Finding> {
    let medium = Medium::of(target.protocol);
    sorted(found.into_iter().map(|finding| finding.on(medium).at(*target)).collect())
}

/// What concerns a place that never said anything that can be read.
pub fn of_unread(target: &Target, station: &Station, test: Option<&Consistency>) -> Vec<Finding> {
    let what = station.main_failure().map_or("not readable", FailureKind::label);
    let evidence = format!("{} came back, and none can be read: {what}", answers(station.broken()));
    let found = vec![Finding::new(Severity::Fault, symptom_of_unread(station), evidence)];
    of_place(target, tested(found, test))
}

/// What the broken answers of a place point to that never gave a good one: that of which most came.
pub(super) fn symptom_of_unread(station: &Station) -> Symptom {
    match station.main_failure() {
        Some(FailureKind::WrongCheck) if station.breaks_alike() => Symptom::SameErrors,
        Some(FailureKind::WrongCheck) => Symptom::ChangingErrors,
        Some(FailureKind::StrayBytes) => Symptom::Noise,
        Some(FailureKind::Collision) => Symptom::Collision,
        Some(FailureKind::WrongAddress) => Symptom::WrongAddress,
        Some(FailureKind::CutShort) => Symptom::CutShort,
        Some(FailureKind::Other) => Symptom::Unusable,
        Some(FailureKind::Garbage | FailureKind::NoAnswer) | None => Symptom::Garbage,
    }
}

/// How its exchanges failed, of which `late` had an answer after all.
fn failures(station: &Station, late: u64, now: Timestamp) -> Vec<Finding> {
    let asked = station.asked();
    let mut found = Vec::new();
    let mut add = |symptom, part: Occurrences, (one, many): (&str, &str)| {
        let what = if part.count == 1 { one } else { many };
        if part.count > 0 {
            let evidence = format!("{} of {} {what}", part.count, exchanges(asked));
            found.push(Finding::by_chance(by_share(part.count, asked), symptom, part, asked, now, evidence));
        }
    };
    let [checks, garbage] = [FailureKind::WrongCheck, FailureKind::Garbage].map(|kind| station.failure(kind));
    let same = |what| (what, what);
    let what = if checks.count >= garbage.count { "had a wrong checksum or CRC" } else { "could not be read" };
    let broken = if station.breaks_alike() { Symptom::SameErrors } else { Symptom::ChangingErrors };
    add(broken, checks.and(garbage), same(what));
    let unusable = ("had an answer that cannot be used", "had answers that cannot be used");
    add(Symptom::Unusable, station.failure(FailureKind::Other), unusable);
    add(Symptom::CutShort, station.failure(FailureKind::CutShort), ("was cut short", "were cut short"));
    add(Symptom::WrongAddress, station.failure(FailureKind::WrongAddress), same("came from another address"));
    let collision = ("differs from what was sent", "differ from what was sent");
    add(Symptom::Collision, station.failure(FailureKind::Collision), collision);
    let stray = ("was nothing but stray bytes", "were nothing but stray bytes");
    add(Symptom::Noise, station.failure(FailureKind::StrayBytes), stray);
    if station.silent_now < GONE_AFTER {
        add(Symptom::Lost, station.failure(FailureKind::NoAnswer), same("had no answer"));
        return found.into_iter().map(|finding| lost(finding, late)).collect();
    }
    let evidence = format!("{} answered before, the last {} did not", exchanges(station.usable()), station.silent_now);
    found.push(Finding::new(Severity::Fault, Symptom::Stopped, evidence));
    found
}

/// Where answers came late, that comes first.
fn lost(finding: Finding, late: u64) -> Finding {
    if finding.symptom != Symptom::Lost || late == 0 {
        return finding;
    }
    let cause = match late {
        1 => "1 answer came when it was not waited for any more: the timeout is too short for the module".to_owned(),
        late => {
            format!(
                "{late} answers came when they were not waited for any more: the timeout is too short for the module"
            )
        }
    };
    let next_step =
        "Set a longer timeout; if answers still do not come, check terminals, power and the cable".to_owned();
    Finding { cause, next_step, ..finding }
}

fn refusals(station: &Station, now: Timestamp) -> Vec<Finding> {
    let refused = |seen: &Occurrences, what: &str, reason: &str| {
        let evidence = format!("{what} came {}", times(seen.count));
        let finding = Finding::new(Severity::Note, Symptom::Refused, evidence);
        Finding { cause: format!("The line is fine: {reason}"), ..finding }
    };
    let each = |(kind, seen): (&RefusalKind, &Occurrences)| match kind {
        RefusalKind::Ignored => watchdog(station, *seen, now),
        RefusalKind::Dcon => refused(seen, "?AA", texts::DCON_REASON),
        RefusalKind::Exception(code) => refused(seen, &format!("exception {code}"), texts::exception_reason(*code)),
    };
    station.refusals.iter().map(each).collect()
}

fn watchdog(station: &Station, seen: Occurrences, now: Timestamp) -> Finding {
    let evidence = format!("a lone ! came {}", times(seen.count));
    if station.is_watchdog_tripped() {
        return Finding::new(Severity::Warning, Symptom::WatchdogTripped, evidence);
    }
    Finding::past(Symptom::WatchdogTripped, seen, now, &evidence)
}

fn of_test(test: &Consistency) -> Option<Finding> {
    let (severity, symptom) = match test.judgement {
        Judgement::Fine | Judgement::Interrupted => return None,
        Judgement::Doubled => (Severity::Fault, Symptom::DoubledAddress),
        Judgement::DoubledOrNoise => (Severity::Fault, Symptom::DoubledOrNoise),
        Judgement::Twice => (Severity::Warning, Symptom::Twice),
        Judgement::SameErrors => (Severity::Fault, Symptom::SameErrors),
        Judgement::Unreadable => (Severity::Fault, Symptom::Garbage),
        Judgement::Noise => (Severity::Warning, Symptom::Noise),
        Judgement::Late if test.late >= test.reads => (Severity::Fault, Symptom::Late),
        Judgement::Late => (Severity::Warning, Symptom::Late),
        Judgement::Lossy => (Severity::Warning, Symptom::Lost),
        Judgement::NoAnswer => (Severity::Fault, Symptom::Stopped),
    };
    Some(Finding::new(severity, symptom, format!("consistency test: {}", test.said)))
}
