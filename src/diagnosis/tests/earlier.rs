//! What is over is told as past.

use super::*;

#[test]
fn a_line_that_came_back_is_a_note_with_its_time() {
    let mut line = Played::default();
    line.good(at(1), 5);
    line.exchange(at(1), &[], broken("the line was lost: it was unplugged"));
    assert_eq!(line.found(Symptom::PortVanished).severity, Severity::Fault);
    line.good(at(1), 1);
    let report = line.report_after(3);
    let finding = &report.line.findings[0];
    assert_eq!((finding.severity, finding.title), (Severity::Note, "The port had vanished"));
    assert_eq!(
        finding.evidence,
        "the line was lost once while it was open; the last was 3 minutes ago, and 1 answer followed"
    );
    assert!(!report.is_wrong());
}

#[test]
fn a_line_that_is_lost_again_and_again_stays_a_warning() {
    let mut line = Played::default();
    for _ in 0..3 {
        line.exchange(at(1), &[], broken("the line was lost: it was unplugged"));
        line.good(at(1), 5);
    }
    assert_eq!(line.found(Symptom::PortVanished).severity, Severity::Warning);
    line.good(at(1), 100);
    assert_eq!(line.found(Symptom::PortVanished).severity, Severity::Note);
}

#[test]
fn a_watchdog_that_was_cleared_is_a_note_and_one_that_was_not_stays_whatever_is_read() {
    let mut line = Played::default();
    let mut ask = |request: &[u8], bytes: &[u8], verdict: Verdict| {
        let sent = line.frame(dcon_at(1), Direction::Sent, request, Verdict::Request);
        let received = line.frame(dcon_at(1), Direction::Received, bytes, verdict);
        [sent, received].iter().for_each(|frame| line.diagnosis.take(frame));
        let found = line.found(Symptom::WatchdogTripped);
        (found.severity, found.title)
    };
    let (tripped, cleared) =
        ((Severity::Warning, "The host watchdog has tripped"), (Severity::Note, "The host watchdog had tripped"));
    assert_eq!(ask(b"@0101\r", b"!\r", Verdict::Refusal), tripped);
    for _ in 0..100 {
        assert_eq!(ask(b"#01\r", b">+025.00\r", Verdict::Answer), tripped, "reads are answered as ever");
    }
    assert_eq!(ask(b"~010\r", b"!0104\r", Verdict::Answer), tripped, "its status says so");
    assert_eq!(ask(b"~011\r", b"!01\r", Verdict::Answer), cleared);
    assert_eq!(ask(b"@0101\r", b"!\r", Verdict::Refusal), tripped);
    assert_eq!(ask(b"~010\r", b"!0100\r", Verdict::Answer), cleared);
    assert_eq!(ask(b"@0101\r", b"!\r", Verdict::Refusal), tripped);
    assert_eq!(ask(b"@0100\r", b"!\r", Verdict::Refusal), tripped);
    assert_eq!(ask(b"@0101\r", b">\r", Verdict::Answer), cleared, "it obeys again");
}

#[test]
fn losses_that_ended_are_a_note_when_they_would_have_been_seen_again() {
    let mut line = Played::default();
    for _ in 0..20 {
        line.good(at(1), 3);
        line.silent(at(1));
    }
    assert_eq!(line.found(Symptom::Lost).severity, Severity::Fault);
    line.good(at(1), 60);
    let report = line.report_after(10);
    let finding = &report.modules[0].findings[0];
    assert_eq!((finding.symptom, finding.severity), (Symptom::Lost, Severity::Note));
    assert!(finding.evidence.ends_with("the last was 10 minutes ago, and 60 answers followed"), "{finding:?}");
}
