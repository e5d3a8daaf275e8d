//! The table at the end: what was done, what was noticed, and whether everything held.

use std::time::Duration;

use serde_json::{Value, json};

use super::hands::Done;
use super::limits::{
    EVERY_FAULT_IN, MOST_GROWTH, MOST_LINE_RECOVERY, MOST_MODULE_RECOVERY, MOST_QUIT, MOST_STALL, POLL_PERIOD,
};
use super::recorded::Recorded;
use super::watch::{Noticed, Values};
use crate::bus::Statistics;
use crate::sim::{FaultKind, Injected};

/// One line of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The name in JSON.
    pub key: String,
    pub label: String,
    /// For people.
    pub text: String,
    pub value: Value,
}

/// Times of the pictures.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Pictures {
    pub count: u64,
    /// The longest single one.
    pub longest: Duration,
    /// From the end of one to the end of the next, without the planned pause.
    pub longest_stall: Duration,
    /// The same without what other programs had the processor for.
    pub longest_own_stall: Duration,
    /// What other programs had the processor for, in all.
    pub waited: Duration,
}

/// In bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Memory {
    pub start: Option<u64>,
    pub highest: Option<u64>,
    pub end: Option<u64>,
}

/// The longest recoveries, and after which faults they were.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Recoveries {
    pub line: Duration,
    pub line_after: String,
    pub module: Duration,
    pub module_after: String,
    /// How long it takes until every module was heard anew when nothing is wrong.
    pub undisturbed: Duration,
    /// Modules that did not come back before the next phase.
    pub missed: u64,
}

/// What a run came to.
#[derive(Debug, Clone, Default)]
pub struct Report {
    pub(super) seed: u64,
    pub(super) duration: Duration,
    pub(super) has_window: bool,
    pub(super) interrupted: bool,
    pub(super) phases: u64,
    pub(super) modules: usize,
    /// Kinds that were switched on.
    pub(super) tried: Vec<FaultKind>,
    pub(super) injected: Injected,
    pub(super) statistics: Statistics,
    pub(super) noticed: Noticed,
    pub(super) values: Values,
    pub(super) samples: u64,
    /// `None` if the file could not be read.
    pub(super) recorded: Option<Recorded>,
    pub(super) memory: Memory,
    pub(super) pictures: Pictures,
    pub(super) done: Done,
    pub(super) recoveries: Recoveries,
    pub(super) quit: Duration,
    pub(super) panics: u64,
    /// What is not as it must be, in words; the first ones.
    pub(super) details: Vec<String>,
    /// Why the run could not go on, or what else went wrong.
    pub(super) troubles: Vec<String>,
}

impl Report {
    /// What did not hold; empty if everything did.
    pub fn failures(&self) -> Vec<String> {
        let mut failures = self.troubles.clone();
        failures.extend(self.done.failures.iter().cloned());
        let mut claim = |holds: bool, text: String| {
            if !holds {
                failures.push(text);
            }
        };
        let recorded = self.recorded.unwrap_or_default();
        let Values { wrong, outdated, .. } = self.values;
        claim(wrong == 0, format!("{wrong} wrong values were accepted from modules with checksum or CRC"));
        claim(outdated == 0, format!("{outdated} late values were taken for later answers"));
        claim(recorded.wrong == 0, format!("{} wrong samples of such modules are recorded", recorded.wrong));
        if self.recorded.is_some() {
            let texts = format!("{} samples were taken, {} are in the recording", self.samples, recorded.samples);
            claim(self.samples == recorded.samples, texts);
        }
        claim(self.panics == 0, format!("{} panics", self.panics));
        let growth = self.growth().unwrap_or_default();
        claim(growth <= MOST_GROWTH, format!("memory has grown by {}", megabytes(growth)));
        let stall = self.pictures.longest_own_stall;
        claim(stall <= MOST_STALL, format!("the window stood still for {}", time(stall)));
        let Recoveries { line, module, missed, .. } = self.recoveries;
        claim(line <= MOST_LINE_RECOVERY, format!("the line took {} to recover", time(line)));
        claim(module <= MOST_MODULE_RECOVERY, format!("a module took {} to recover", time(module)));
        claim(missed == 0, format!("{missed} times a module was not heard again before the next fault"));
        claim(self.quit <= MOST_QUIT, format!("quitting took {}", time(self.quit)));
        claim(self.values.accepted > 0 || self.interrupted, "no value was read at all".to_owned());
        if self.duration >= EVERY_FAULT_IN && !self.interrupted {
            let silent = self.never_struck();
            claim(silent.is_empty(), format!("faults that were on and never struck: {silent}"));
        }
        failures
    }

    /// What was seen, in words, where something was wrong.
    pub fn details(&self) -> &[String] {
        &self.details
    }

    /// The table.
    pub fn rows(&self) -> Vec<Row> {
        let mut rows = self.run_rows();
        rows.extend(self.fault_rows());
        rows.extend(self.noticed_rows());
        rows.extend(self.value_rows());
        rows.extend(self.time_rows());
        let failures = self.failures();
        let text = if failures.is_empty() { "everything held".to_owned() } else { failures.join("; ") };
        rows.push(row("failures", "Outcome", text, json!(failures)));
        rows
    }

    fn run_rows(&self) -> Vec<Row> {
        let window = if self.has_window { "drawn off screen" } else { "not in this build" };
        let rate = self.statistics.transactions as f64 / self.duration.as_secs_f64().max(1.0);
        let transactions = format!("{} ({rate:.0} each second)", self.statistics.transactions);
        let seconds = Duration::from_secs(self.duration.as_secs());
        let ended = if self.interrupted { ", interrupted" } else { "" };
        let duration = format!("{}{ended}", humantime::format_duration(seconds));
        vec![
            row("duration_s", "Duration", duration, json!(self.duration.as_secs())),
            number("seed", "Seed", self.seed),
            number("modules", "Modules polled", self.modules as u64),
            row("window", "Window", window.to_owned(), json!(self.has_window)),
            number("phases", "Phases", self.phases),
            row("transactions", "Transactions", transactions, json!(self.statistics.transactions)),
        ]
    }

    fn fault_rows(&self) -> Vec<Row> {
        let count = |kind: &FaultKind| self.injected.get(kind).copied().unwrap_or_default();
        let of_kind = |kind: FaultKind| {
            let struck = count(&kind);
            let text = if self.tried.contains(&kind) { struck.to_string() } else { "was not on".to_owned() };
            row(&format!("injected_{}", kind.word()), &format!("Injected: {}", kind.label()), text, json!(struck))
        };
        FaultKind::ALL.into_iter().map(of_kind).collect()
    }

    fn noticed_rows(&self) -> Vec<Row> {
        let Statistics { errors, repeats, frames_missed, kinds, .. } = &self.statistics;
        let Noticed { lost, restored, with_noise, with_echo, unasked_bytes, broken, silent, overlooked } = self.noticed;
        let by_kind: Vec<String> = kinds.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
        let errors_text =
            if by_kind.is_empty() { errors.to_string() } else { format!("{errors}: {}", by_kind.join(", ")) };
        let lines = format!("{lost} lost, {restored} restored");
        let frames = frames_missed.saturating_add(overlooked);
        vec![
            row("errors", "Noticed: errors", errors_text, json!({ "all": errors, "by_kind": kinds })),
            number("repeats", "Noticed: reads repeated", *repeats),
            number("answers_missing", "Noticed: no answer", silent),
            number("answers_broken", "Noticed: answers that cannot be used", broken),
            number("answers_with_noise", "Noticed: answers among stray bytes", with_noise),
            number("answers_with_echo", "Noticed: answers behind an echo", with_echo),
            number("unasked_bytes", "Noticed: bytes that nobody asked for", unasked_bytes),
            row("line", "Noticed: line", lines, json!({ "lost": lost, "restored": restored })),
            number("frames_not_seen", "Frames that did not reach the log", frames),
        ]
    }

    fn value_rows(&self) -> Vec<Row> {
        let Values { accepted, wrong, wrong_without_check, outdated, of_twins, not_known } = self.values;
        let recorded = self.recorded.unwrap_or_default();
        let samples = match self.recorded {
            Some(recorded) => format!("{} of {}", recorded.samples, self.samples),
            None => "the recording could not be read".to_owned(),
        };
        let label = "Answered by the other module at the same address";
        vec![
            number("values_accepted", "Values accepted", accepted),
            number("wrong_values", "Wrong values accepted, with checksum or CRC", wrong),
            number("late_values", "Late values taken for later answers, with checksum or CRC", outdated),
            number(
                "wrong_values_without_check",
                "Wrong or late values accepted, DCON without checksum",
                wrong_without_check,
            ),
            number("values_of_twins", label, of_twins),
            number("values_not_judged", "Values of which the simulated module does not tell", not_known),
            row("samples_read_back", "Samples read back from the recording", samples, json!(recorded.samples)),
            number("wrong_samples", "Wrong samples recorded, with checksum or CRC", recorded.wrong),
            number(
                "wrong_samples_without_check",
                "Wrong samples recorded, DCON without checksum",
                recorded.wrong_without_check,
            ),
        ]
    }

    fn time_rows(&self) -> Vec<Row> {
        let Memory { start, highest, end } = self.memory;
        let Pictures { count, longest, longest_stall, longest_own_stall, .. } = self.pictures;
        let Done { scans, longest_cancel, writes, taken, refused, unknown, doubled, longest_write, .. } = &self.done;
        let Recoveries { line, line_after, module, module_after, undisturbed, .. } = &self.recoveries;
        let stall = format!("{}, {} without other programs", time(longest_stall), time(longest_own_stall));
        let written = format!("{writes}: {taken} taken, {refused} not, {unknown} said to be unknown");
        let writes_value = json!({ "all": writes, "taken": taken, "refused": refused, "unknown": unknown });
        let recovery = |took: &Duration, after: &String| match after.as_str() {
            "" => time(*took),
            after => format!("{} (after {after})", time(*took)),
        };
        let [picture, stalls] = if self.has_window {
            ["Longest picture of the window", "Longest stall of the window"]
        } else {
            ["Longest time to take in events (no window)", "Longest stall (no window)"]
        };
        vec![
            bytes("memory_start", "Memory at the start", start),
            bytes("memory_highest", "Memory at most", highest),
            bytes("memory_end", "Memory at the end", end),
            number("pictures", "Pictures", count),
            row("longest_picture_ms", picture, time(longest), milliseconds(longest)),
            row(
                "longest_stall_ms",
                stalls,
                stall,
                json!({ "all": milliseconds(longest_stall), "own": milliseconds(longest_own_stall) }),
            ),
            number("scans_cancelled", "Scans cancelled", *scans),
            row(
                "longest_cancel_ms",
                "Longest until a cancelled scan ended",
                time(*longest_cancel),
                milliseconds(*longest_cancel),
            ),
            row("writes", "Settings written", written, writes_value),
            number("writes_heard_twice", "Writes that a module heard more than once", *doubled),
            row(
                "longest_write_ms",
                "Longest until a write's outcome was told",
                time(*longest_write),
                milliseconds(*longest_write),
            ),
            row(
                "longest_recovery_line_ms",
                "Longest until the line recovered",
                recovery(line, line_after),
                milliseconds(*line),
            ),
            row(
                "longest_recovery_module_ms",
                "Longest until the last module recovered",
                recovery(module, module_after),
                milliseconds(*module),
            ),
            row(
                "undisturbed_ms",
                "The same where nothing was wrong before",
                time(*undisturbed),
                milliseconds(*undisturbed),
            ),
            row("poll_period_ms", "Poll period", time(POLL_PERIOD), milliseconds(POLL_PERIOD)),
            row("quit_ms", "Time to quit", time(self.quit), milliseconds(self.quit)),
            number("panics", "Panics", self.panics),
        ]
    }

    fn growth(&self) -> Option<u64> {
        Some(self.memory.end?.saturating_sub(self.memory.start?))
    }

    fn never_struck(&self) -> String {
        let silent = self.tried.iter().filter(|kind| self.injected.get(kind).copied().unwrap_or_default() == 0);
        silent.map(|kind| kind.word()).collect::<Vec<_>>().join(", ")
    }
}

fn row(key: &str, label: &str, text: String, value: Value) -> Row {
    Row { key: key.to_owned(), label: label.to_owned(), text, value }
}

fn number(key: &str, label: &str, number: u64) -> Row {
    row(key, label, number.to_string(), json!(number))
}

fn bytes(key: &str, label: &str, bytes: Option<u64>) -> Row {
    row(key, label, bytes.map_or_else(|| "not told".to_owned(), megabytes), json!(bytes))
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

fn time(time: Duration) -> String {
    if time >= Duration::from_secs(1) {
        format!("{:.2} s", time.as_secs_f64())
    } else {
        format!("{:.1} ms", time.as_secs_f64() * 1e3)
    }
}

fn milliseconds(time: Duration) -> Value {
    json!((time.as_secs_f64() * 1e4).round() / 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Report {
        Report {
            duration: Duration::from_secs(120),
            values: Values { accepted: 10, ..Values::default() },
            samples: 7,
            recorded: Some(Recorded { samples: 7, ..Recorded::default() }),
            ..Report::default()
        }
    }

    fn text(report: &Report, key: &str) -> String {
        report.rows().into_iter().find(|row| row.key == key).unwrap().text
    }

    #[test]
    fn a_run_in_which_everything_held_says_so() {
        let report = good();
        assert_eq!(report.failures(), Vec::<String>::new());
        assert_eq!(text(&report, "failures"), "everything held");
        assert_eq!(text(&report, "samples_read_back"), "7 of 7");
        assert_eq!(text(&report, "duration_s"), "2m");
    }

    #[test]
    fn each_promise_that_was_broken_is_named() {
        type Break = fn(&mut Report);
        let breaks: [(Break, &str); 11] = [
            (|report| report.values.wrong = 1, "1 wrong values"),
            (|report| report.values.outdated = 2, "2 late values"),
            (
                |report| report.recorded = Some(Recorded { samples: 7, wrong: 3, ..Recorded::default() }),
                "3 wrong samples",
            ),
            (|report| report.samples = 8, "8 samples were taken, 7"),
            (|report| report.panics = 1, "1 panics"),
            (|report| report.memory = Memory { start: Some(1), end: Some(300_000_001), highest: None }, "300.0 MB"),
            (|report| report.pictures.longest_own_stall = Duration::from_secs(3), "stood still for 3.00 s"),
            (|report| report.recoveries.module = Duration::from_secs(60), "took 60.00 s"),
            (|report| report.done.failures.push("heard 2 times".to_owned()), "heard 2 times"),
            (|report| report.tried = vec![FaultKind::Late], "never struck: late"),
            (|report| report.troubles.push("the bus thread has ended".to_owned()), "bus thread"),
        ];
        for (spoil, words) in breaks {
            let mut report = good();
            spoil(&mut report);
            let failures = report.failures();
            assert!(matches!(failures.as_slice(), [one] if one.contains(words)), "{words}: {failures:?}");
        }
    }

    #[test]
    fn wrong_values_of_modules_without_checksum_are_told_and_not_judged() {
        let mut report = good();
        report.values.wrong_without_check = 5;
        assert!(report.failures().is_empty());
        assert_eq!(text(&report, "wrong_values_without_check"), "5");
    }

    #[test]
    fn every_fault_has_a_row_and_what_was_not_on_says_so() {
        let mut report = good();
        report.tried = vec![FaultKind::Echo];
        report.injected.insert(FaultKind::Echo, 12);
        assert_eq!(text(&report, "injected_echo"), "12");
        assert_eq!(text(&report, "injected_twin"), "was not on");
        assert_eq!(report.rows().iter().filter(|row| row.key.starts_with("injected_")).count(), 17);
    }

    #[test]
    fn no_two_rows_have_the_same_name() {
        let keys: Vec<String> = good().rows().into_iter().map(|row| row.key).collect();
        let unique: std::collections::BTreeSet<&String> = keys.iter().collect();
        assert_eq!(unique.len(), keys.len());
    }
}
