//! `dcon-bench soak`: the real program for some seconds on a bad line.

#[path = "common/program.rs"]
mod program;

use program::{bad, bench, text};
use serde_json::Value;

const ROWS: [&str; 59] = [
    "duration_s",
    "seed",
    "modules",
    "window",
    "phases",
    "transactions",
    "injected_flipped",
    "injected_lost",
    "injected_inserted",
    "injected_noise",
    "injected_late",
    "injected_cut",
    "injected_doubled",
    "injected_wrong_address",
    "injected_wrong_checksum",
    "injected_echo",
    "injected_partial_echo",
    "injected_twin",
    "injected_wrong_speed",
    "injected_unplugged",
    "injected_renamed",
    "injected_blocked_write",
    "injected_clock_jump",
    "errors",
    "repeats",
    "answers_missing",
    "answers_broken",
    "answers_with_noise",
    "answers_with_echo",
    "unasked_bytes",
    "undisturbed_ms",
    "line",
    "frames_not_seen",
    "values_accepted",
    "wrong_values",
    "late_values",
    "wrong_values_without_check",
    "values_of_twins",
    "values_not_judged",
    "samples_read_back",
    "wrong_samples",
    "wrong_samples_without_check",
    "memory_start",
    "memory_highest",
    "memory_end",
    "pictures",
    "longest_picture_ms",
    "longest_stall_ms",
    "scans_cancelled",
    "longest_cancel_ms",
    "writes",
    "writes_heard_twice",
    "longest_write_ms",
    "longest_recovery_line_ms",
    "longest_recovery_module_ms",
    "poll_period_ms",
    "quit_ms",
    "panics",
    "failures",
];

#[test]
fn ten_seconds_of_faults_end_with_the_whole_table_and_nothing_that_did_not_hold() {
    let output = bench(&["soak", "--duration", "10s", "--json"]);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{told}");
    let table: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys: Vec<&str> = table.as_object().unwrap().keys().map(String::as_str).collect();
    for row in ROWS {
        assert!(keys.contains(&row), "{row} is missing in {keys:?}");
    }
    assert_eq!(keys.len(), ROWS.len(), "{keys:?}");
    assert_eq!(table["modules"], 16);
    assert_eq!(table["wrong_values"], 0);
    assert_eq!(table["failures"], Value::Array(Vec::new()));
    assert!(table["values_accepted"].as_u64() > Some(500), "{table}");
    assert!(table["samples_read_back"].as_u64() > Some(500), "{table}");
    assert!(table["phases"].as_u64() >= Some(1), "{table}");
    assert!(told.lines().filter(|line| line.contains("all modules after")).count() >= 1, "{told}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_it_early_with_the_table() {
    let mut running = program::Running::start(&["soak", "--duration", "1h"]);
    let mut told = std::io::BufReader::new(running.child.stderr.take().unwrap());
    let mut line = String::new();
    std::io::BufRead::read_line(&mut told, &mut line).unwrap();
    assert!(line.contains("16 modules"), "{line}");
    assert_eq!(running.end_by("-INT"), Some(0));
    let table: Vec<String> = running.lines.by_ref().map(Result::unwrap).collect();
    assert!(table.iter().any(|line| line.starts_with("Duration") && line.ends_with("interrupted")), "{table:?}");
}

#[test]
fn a_recording_that_is_there_already_is_not_touched() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let path = file.path().to_str().unwrap();
    assert!(bad(2, &["soak", "--out", path]).contains("is there already"));
    assert_eq!(std::fs::read(file.path()).unwrap(), Vec::<u8>::new());
}

#[test]
fn a_run_that_is_too_short_for_any_fault_is_refused() {
    assert!(bad(2, &["soak", "--duration", "1s"]).contains("5s"));
}
