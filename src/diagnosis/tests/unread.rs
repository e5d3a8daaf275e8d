//! Places from which only broken answers came: each is told for what came, and several together.

use super::*;

const CHECKSUM: &str = "wrong checksum: 34 was received, B7 is right";

/// A line with one place that gave these broken answers.
fn place(target: Target, reason: &str, answers: &[&[u8]]) -> Played {
    let mut line = Played::default();
    answers.iter().for_each(|bytes| line.exchange(target, bytes, broken(reason)));
    line
}

#[test]
fn only_00_and_ff_are_noise() {
    let line = place(at(5), "only stray bytes came back: line noise", &[&[0], &[0xFF]]);
    assert_eq!(line.symptoms(), [Symptom::Noise]);
    let finding = line.found(Symptom::Noise);
    assert_eq!(finding.evidence, "only 00 and FF came 2 times at 1 address");
    assert!(line.report().modules.is_empty(), "nobody is there");
}

#[test]
fn something_else_than_was_sent_is_a_collision() {
    let line = place(at(5), "what came back differs from what was sent: two stations sent at once", &[&[1, 9]]);
    assert_eq!(line.symptoms(), [Symptom::Collision]);
}

#[test]
fn the_same_wrong_checksum_each_time_is_a_matter_of_settings() {
    let line = place(dcon_at(5), CHECKSUM, &[b"!05PIR234\r".as_slice(); 3]);
    let finding = line.found(Symptom::SameErrors);
    assert_eq!(line.symptoms(), [Symptom::SameErrors]);
    assert!(finding.cause.contains("DCON checksum on one side only"), "{finding:?}");
    let line = place(dcon_at(5), CHECKSUM, &[b"!05PIR234\r", b"!05PIQ234\r", b"!05PIR2 4\r"]);
    assert_eq!(line.symptoms(), [Symptom::ChangingErrors]);
}

#[test]
fn what_came_most_decides() {
    let mut line = place(dcon_at(5), CHECKSUM, &[b"!05PIR234\r".as_slice(); 3]);
    line.exchange(dcon_at(5), &[0x80, 0xF0], broken("no DCON answer is in it"));
    assert_eq!(line.symptoms(), [Symptom::SameErrors]);
}

#[test]
fn a_wrong_crc_of_bytes_that_are_no_frame_of_the_module_is_garbage() {
    let crc = "wrong CRC: 1C80 was received, 3F01 is right";
    assert_eq!(place(at(5), crc, &[&[0x80, 0xF0, 0x1C, 0x80]]).symptoms(), [Symptom::Garbage]);
    assert_eq!(place(at(5), crc, &[&[5, 3, 2, 0, 7, 0x1C, 0x80]]).symptoms(), [Symptom::ChangingErrors]);
}

#[test]
fn words_that_are_not_known_name_no_cause() {
    let line = place(at(5), "the answer is that to another request", &[&[5, 3, 2, 0, 7]]);
    assert_eq!(line.symptoms(), [Symptom::Unusable]);
}

#[test]
fn garbage_during_a_scan_is_one_finding_of_the_line() {
    let mut line = Played::default();
    line.good(at(1), 20);
    for address in 2..=200 {
        line.exchange(at(address), &[0x80, 0xF0], broken("no DCON answer is in it"));
    }
    let report = line.report();
    assert_eq!(line.symptoms(), [Symptom::Garbage]);
    let finding = &report.line.findings[0];
    let evidence = "garbage at 199 addresses, 199 answers in all: 2, 3, 4, 5, 6, 7, 8, 9 and others";
    assert_eq!((finding.evidence.as_str(), finding.module), (evidence, None));
    assert_eq!(finding.severity, Severity::Warning, "others are understood, and none was asked twice");
    assert_eq!(report.modules.len(), 1);
}

#[test]
fn stray_bytes_during_a_scan_are_one_finding_of_the_line() {
    let mut line = Played::default();
    line.good(at(1), 20);
    (2..=200).for_each(|address| line.exchange(at(address), &[0xFF], broken("only stray bytes came back: line noise")));
    assert_eq!(line.symptoms(), [Symptom::Noise]);
    assert_eq!(line.found(Symptom::Noise).evidence, "only 00 and FF came 199 times at 199 addresses");
    assert_eq!(line.report().modules.len(), 1);
}
