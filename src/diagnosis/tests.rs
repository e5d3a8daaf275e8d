//! Each row of the table of symptoms, from made frames.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};

use super::*;
use crate::bus::{ProblemKind, RawRequest, UNASKED, Verdict};
use crate::protocol::{Failure, modbus};

/// Plays a line: frames come a tenth of a second apart.
#[derive(Default)]
struct Played {
    diagnosis: Diagnosis,
    frames: i64,
}

fn at(address: u8) -> Target {
    Target { address, protocol: Protocol::ModbusRtu, settings: LineSettings::default(), checksum: false }
}

fn dcon_at(address: u8) -> Target {
    Target { protocol: Protocol::Dcon, ..at(address) }
}

fn broken(reason: &str) -> Verdict {
    Verdict::Broken(reason.to_owned())
}

impl Played {
    fn frame(&mut self, target: Target, direction: Direction, bytes: &[u8], verdict: Verdict) -> Frame {
        self.frames += 1;
        Frame {
            at: Timestamp::UNIX_EPOCH + SignedDuration::from_millis(self.frames * 100),
            direction,
            bytes: bytes.to_vec(),
            protocol: target.protocol,
            settings: target.settings,
            address: (verdict != broken(UNASKED)).then_some(target.address),
            checksum: target.checksum,
            took: Duration::from_millis(20),
            first_byte: (direction == Direction::Received).then_some(Duration::from_millis(12)),
            echo: false,
            noise: false,
            verdict,
        }
    }

    fn sent(&mut self, target: Target) {
        let frame = self.frame(target, Direction::Sent, &[target.address, 3], Verdict::Request);
        self.diagnosis.take(&frame);
    }

    fn exchange(&mut self, target: Target, bytes: &[u8], verdict: Verdict) {
        self.exchange_with(target, bytes, verdict, |_| {});
    }

    fn exchange_with(&mut self, target: Target, bytes: &[u8], verdict: Verdict, change: impl Fn(&mut Frame)) {
        self.sent(target);
        let mut frame = self.frame(target, Direction::Received, bytes, verdict);
        change(&mut frame);
        self.diagnosis.take(&frame);
    }

    fn good(&mut self, target: Target, count: usize) {
        (0..count).for_each(|_| self.exchange(target, b"answer", Verdict::Answer));
    }

    fn silent(&mut self, target: Target) {
        self.exchange(target, &[], Verdict::Silent);
    }

    fn report(&self) -> Report {
        self.diagnosis.report(Timestamp::UNIX_EPOCH, "COM3", |_| None)
    }

    #[track_caller]
    fn found(&self, symptom: Symptom) -> Finding {
        let report = self.report();
        let all: Vec<_> = report.findings().map(|finding| finding.symptom).collect();
        let found = report.findings().find(|finding| finding.symptom == symptom);
        found.cloned().unwrap_or_else(|| panic!("{symptom:?} is not among {all:?}"))
    }

    fn symptoms(&self) -> Vec<Symptom> {
        self.report().findings().map(|finding| finding.symptom).collect()
    }
}

#[test]
fn a_healthy_line_has_no_findings() {
    let mut line = Played::default();
    line.good(at(1), 100);
    let report = line.report();
    assert!(!report.is_wrong() && line.symptoms().is_empty());
    assert_eq!(report.modules[0].answer_time.unwrap().median_ms, 12.0);
    assert_eq!(report.conclusion(), "Nothing is wrong.");
}

#[test]
fn a_scans_silence_is_no_sickness() {
    let mut line = Played::default();
    line.good(at(1), 20);
    (2..=247).for_each(|address| line.silent(at(address)));
    let report = line.report();
    assert!(line.symptoms().is_empty(), "{:?}", line.symptoms());
    assert_eq!((report.line.exchanges, report.line.failed, report.line.silent_addresses), (20, 0, 246));
    assert_eq!(report.modules.len(), 1);
    line.silent(dcon_at(1));
    assert_eq!(line.report().line.silent_addresses, 246, "address 1 answers in the other protocol");
}

#[test]
fn nothing_at_every_address() {
    let mut line = Played::default();
    (1..=33).for_each(|address| line.silent(at(address)));
    let finding = line.found(Symptom::SilentInOneProtocol);
    assert!(finding.next_step.contains("other protocol"), "{finding:?}");
    (1..=33).for_each(|address| line.silent(dcon_at(address)));
    let finding = line.found(Symptom::SilentLine);
    assert_eq!(finding.severity, Severity::Fault);
    assert!(finding.evidence.starts_with("66 questions to 33 addresses in"), "{finding:?}");
    assert!(finding.next_step.contains("swap D+ and D−"));
}

#[test]
fn nothing_at_one_address_that_was_asked_again() {
    let mut line = Played::default();
    line.good(at(1), 20);
    (0..3).for_each(|_| line.silent(at(2)));
    let finding = line.found(Symptom::SilentAddress);
    assert_eq!(finding.evidence, "address 2 (02h) was asked 3 times and never answered");
    assert!(finding.next_step.contains("160 to 191"));
    line.good(at(2), 1);
    assert!(line.symptoms().is_empty());
}

#[test]
fn garbage_where_nothing_was_ever_read() {
    let mut line = Played::default();
    line.exchange(at(5), b"\x80\xF0\x1C", broken("no DCON answer is in it"));
    let finding = line.found(Symptom::Garbage);
    assert_eq!((finding.severity, finding.module), (Severity::Fault, Some(at(5))));
    assert!(finding.next_step.contains("other speeds"));
    line.good(dcon_at(5), 1);
    assert!(line.symptoms().is_empty(), "it speaks the other protocol, which is known now");
}

#[test]
fn stray_bytes_around_good_answers() {
    let mut line = Played::default();
    line.good(at(1), 99);
    line.exchange_with(at(1), b"\0answer", Verdict::Answer, |frame| frame.noise = true);
    let finding = line.found(Symptom::Noise);
    assert_eq!(finding.severity, Severity::Warning);
    assert_eq!(finding.evidence, "1 of 100 answers had stray bytes around them");
}

#[test]
fn bytes_that_nobody_asked_for_are_noise_and_after_silence_a_late_answer() {
    let mut line = Played::default();
    line.good(at(1), 10);
    let stray = line.frame(at(1), Direction::Received, &[0xFF; 3], broken(UNASKED));
    line.diagnosis.take(&stray);
    assert!(line.found(Symptom::Noise).evidence.contains("(3 in all)"));
    line.silent(at(1));
    line.diagnosis.take(&stray);
    assert_eq!(line.found(Symptom::Late).severity, Severity::Warning);
}

#[test]
fn checks_that_fail_in_changing_ways_are_two_modules_or_noise() {
    let mut line = Played::default();
    line.good(at(1), 228);
    (0..12u8).for_each(|index| line.exchange(at(1), &[1, 3, index], broken("wrong CRC: 0101 was received")));
    let finding = line.found(Symptom::ChangingErrors);
    assert_eq!(finding.evidence, "12 of 240 exchanges had a wrong checksum or CRC");
    assert_eq!(finding.severity, Severity::Warning);
    assert!(finding.next_step.contains("consistency"));
}

#[test]
fn checks_that_fail_alike_are_a_matter_of_settings() {
    let mut line = Played::default();
    line.good(dcon_at(1), 1);
    (0..9).for_each(|_| line.exchange(dcon_at(1), b"!01PIR234\r", broken("wrong checksum: 34 was received")));
    assert_eq!(line.found(Symptom::SameErrors).severity, Severity::Fault);
}

#[test]
fn an_echo_is_only_told_and_a_collision_warned_of() {
    let mut line = Played::default();
    line.good(at(1), 50);
    line.exchange_with(at(1), b"echo", Verdict::Answer, |frame| frame.echo = true);
    assert_eq!(line.found(Symptom::Echo).severity, Severity::Note);
    assert!(!line.report().is_wrong());
    line.exchange(at(1), b"\x01\x02", broken("what came back differs from what was sent: two stations sent at once"));
    assert_eq!(line.found(Symptom::Collision).severity, Severity::Warning);
}

#[test]
fn some_answers_lost_suggest_a_longer_timeout() {
    let mut line = Played::default();
    for _ in 0..20 {
        line.good(at(1), 9);
        line.silent(at(1));
    }
    let finding = line.found(Symptom::Lost);
    assert_eq!(finding.evidence, "20 of 200 exchanges had no answer");
    let report = line.report();
    let module = &report.modules[0];
    assert_eq!((module.repeats, module.failures[&FailureKind::NoAnswer]), (19, 20));
    assert!(module.suggested_timeout.as_ref().unwrap().reason.contains("20 did not come"));
    assert_eq!(module.error_rate, Some(0.1));
}

#[test]
fn a_rare_loss_is_a_note() {
    let mut line = Played::default();
    line.good(at(1), 999);
    line.silent(at(1));
    assert_eq!(line.found(Symptom::Lost).severity, Severity::Note);
    assert!(!line.report().is_wrong());
}

#[test]
fn a_module_that_stays_silent_has_stopped() {
    let mut line = Played::default();
    line.good(at(1), 100);
    (0..5).for_each(|_| line.silent(at(1)));
    assert_eq!(line.found(Symptom::Stopped).evidence, "100 exchanges answered before, the last 5 did not");
    line.good(at(1), 1);
    assert!(!line.symptoms().contains(&Symptom::Stopped));
}

#[test]
fn refusals_name_the_likely_reason() {
    let mut line = Played::default();
    line.good(at(1), 1);
    line.exchange(at(1), &modbus::with_crc(&[1, 0x83, 2]), Verdict::Refusal);
    let finding = line.found(Symptom::Refused);
    assert_eq!((finding.evidence.as_str(), finding.severity), ("exception 2 came once", Severity::Note));
    assert!(finding.cause.contains("does not have this register"));
    let mut line = Played::default();
    line.exchange(dcon_at(1), b"?01\r", Verdict::Refusal);
    assert!(line.found(Symptom::Refused).cause.contains("INIT"));
}

#[test]
fn a_lone_exclamation_mark_is_a_tripped_watchdog() {
    let mut line = Played::default();
    line.exchange(dcon_at(1), b"!\r", Verdict::Refusal);
    let finding = line.found(Symptom::WatchdogTripped);
    assert_eq!(finding.severity, Severity::Warning);
    assert!(finding.next_step.contains("~AA1"));
}

#[test]
fn a_line_that_cannot_be_opened_tells_the_cure() {
    for (kind, symptom) in [
        (ProblemKind::PermissionDenied, Symptom::NoPermission),
        (ProblemKind::Busy { by: None }, Symptom::PortBusy),
        (ProblemKind::NoSuchPort { present: Vec::new(), hints: Vec::new() }, Symptom::PortVanished),
        (ProblemKind::NotASerialPort, Symptom::NotOpened),
    ] {
        let mut line = Played::default();
        line.diagnosis.note_problem(LineProblem { line: "COM3".to_owned(), kind });
        assert_eq!(line.found(symptom).severity, Severity::Fault);
    }
    if cfg!(target_os = "linux") {
        assert!(Symptom::NoPermission.next_step().contains("usermod -a -G dialout"));
        assert!(Symptom::PortVanished.next_step().contains("brltty"));
    }
}

#[test]
fn a_slow_adapter_is_told_with_how_to_set_it() {
    let mut line = Played::default();
    let timer = LatencyTimer { port: "/dev/ttyUSB0".to_owned(), milliseconds: Some(16) };
    line.diagnosis.note_adapter(Some(timer.clone()));
    assert!(line.found(Symptom::SlowAdapter).next_step.contains("1 ms"));
    line.diagnosis.note_adapter(Some(LatencyTimer { milliseconds: Some(1), ..timer }));
    assert!(line.symptoms().is_empty());
}

#[test]
fn a_line_lost_while_it_was_open_is_told_and_charged_to_no_module() {
    let mut line = Played::default();
    line.good(at(1), 5);
    line.exchange(at(1), &[], broken("the line was lost: it was unplugged"));
    assert_eq!(line.found(Symptom::PortVanished).severity, Severity::Fault);
    assert_eq!(line.report().modules[0].exchanges, 5);
}

#[test]
fn memory_stays_bounded_and_a_module_that_answers_finds_room() {
    let mut line = Played::default();
    for address in 0..=255 {
        for protocol in Protocol::SERIAL {
            line.exchange(Target { protocol, ..at(address) }, &[address], broken("garbage"));
        }
    }
    assert_eq!(line.diagnosis.stations().count(), MOST_STATIONS);
    let late = Target { checksum: true, ..dcon_at(7) };
    line.good(late, 3);
    assert_eq!(line.diagnosis.stations().count(), MOST_STATIONS);
    assert_eq!(line.diagnosis.station(&late).unwrap().answers, 3);
}

#[test]
fn the_report_is_text_and_json() {
    let mut line = Played::default();
    line.good(at(1), 40);
    line.silent(at(1));
    let report = line.diagnosis.report(Timestamp::UNIX_EPOCH, "COM3", |_| Some("PIR-234".to_owned()));
    let text = report.to_string();
    for part in [
        "Diagnosis of COM3",
        "PIR-234 at address 1 (01h), Modbus RTU 9600 N81",
        "41, 1 of them failed (2.4 %)",
        "median 12.0 ms",
        "\u{2588}\u{2588}",
        "Warning: Some answers do not come – 1 of 41 exchanges had no answer",
        "Next step: Use the suggested timeout",
        "0 faults and 1 warning need attention.",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let json = serde_json::to_value(&report).unwrap();
    let module = &json["modules"][0];
    assert_eq!((&module["address"], &module["failures"]["no_answer"]), (&1.into(), &1.into()));
    assert_eq!(module["findings"][0]["symptom"], "lost");
}

mod identical_reads {
    use super::*;

    fn judged(results: Vec<Result<Vec<u8>, Failure>>) -> Consistency {
        let mut test = ConsistencyTest::new(at(1), 20);
        results.iter().for_each(|result| test.answered(result));
        test.outcome()
    }

    fn garbled(bytes: &[u8]) -> Result<Vec<u8>, Failure> {
        Err(Failure::Garbled { reason: "wrong CRC: 0000 was received".to_owned(), bytes: bytes.to_vec() })
    }

    #[test]
    fn the_same_answer_each_time_is_fine() {
        let test = judged(vec![Ok(vec![1, 2]); 20]);
        assert_eq!((test.judgement, test.said.as_str()), (Judgement::Fine, "20 of 20 reads answered, all the same"));
    }

    #[test]
    fn different_answers_are_two_modules() {
        let answers = (0..20).map(|index| Ok(vec![index % 2])).collect();
        assert_eq!(judged(answers).judgement, Judgement::Doubled);
    }

    #[test]
    fn collisions_that_change_are_two_modules_and_a_few_are_noise() {
        let mixed = |every: u8| (0..20).map(|i| if i % every == 0 { garbled(&[i]) } else { Ok(vec![1]) }).collect();
        assert_eq!(judged(mixed(2)).judgement, Judgement::Doubled);
        let few = judged(mixed(10));
        assert_eq!((few.judgement, few.different_failures), (Judgement::Noise, 2));
    }

    #[test]
    fn silence_is_loss_or_absence() {
        let some = (0..20).map(|i| if i == 3 { Err(Failure::Silent) } else { Ok(vec![1]) }).collect();
        assert_eq!(judged(some).judgement, Judgement::Lossy);
        let mut test = ConsistencyTest::new(at(1), 50);
        (0..10).for_each(|_| test.answered(&Err(Failure::Silent)));
        assert!(test.is_done(), "nobody is asked fifty times in vain");
        assert_eq!(test.outcome().judgement, Judgement::NoAnswer);
    }

    #[test]
    fn a_dcon_answer_with_another_address_is_another_modules() {
        let mut test = ConsistencyTest::new(dcon_at(1), 5);
        test.answered(&Ok(b"!02PIR234".to_vec()));
        assert_eq!(test.outcome().failures[&FailureKind::WrongAddress], 1);
    }

    #[test]
    fn its_own_frames_are_told_from_those_of_polls() {
        let mut line = Played::default();
        let mut test = ConsistencyTest::new(dcon_at(1), 5);
        assert_eq!(test.request(), RawRequest::Dcon { text: "$01M".to_owned(), checksum: false });
        for (request, answer) in [(&b"$01M\r"[..], &b"!01PIR234\r"[..]), (b"#01\r", b">+025.00\r")] {
            test.take(&line.frame(dcon_at(1), Direction::Sent, request, Verdict::Request));
            test.take(&line.frame(dcon_at(1), Direction::Received, answer, Verdict::Answer));
        }
        assert_eq!(test.outcome().times.unwrap().count, 1);
    }

    #[test]
    fn the_number_of_reads_stays_within_reason() {
        assert_eq!(ConsistencyTest::new(at(1), 0).progress(), (0, 5));
        assert_eq!(ConsistencyTest::new(at(1), u32::MAX).progress(), (0, 1_000));
    }

    #[test]
    fn a_bad_test_is_a_finding_of_its_module() {
        let mut line = Played::default();
        line.good(at(1), 10);
        line.diagnosis.note_test(judged((0..20).map(|index| Ok(vec![index])).collect()));
        let finding = line.found(Symptom::DoubledAddress);
        assert!(finding.evidence.contains("20 different ones"), "{finding:?}");
    }
}
