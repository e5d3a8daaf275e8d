//! Each row of the table of symptoms, from made frames.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};

use super::*;
use crate::bus::{NoPort, ProblemKind, UNASKED, Verdict, WithoutPort};
use crate::protocol::modbus;

mod advice;
mod earlier;
mod identical_reads;
mod unread;

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

fn request(address: u8) -> Vec<u8> {
    modbus::with_crc(&[address, 3, 0, 9, 0, 1])
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
        self.sent_as(target, &request(target.address));
    }

    fn sent_as(&mut self, target: Target, request: &[u8]) {
        let frame = self.frame(target, Direction::Sent, request, Verdict::Request);
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

    fn unasked(&mut self, target: Target, bytes: &[u8]) {
        let frame = self.frame(target, Direction::Received, bytes, broken(UNASKED));
        self.diagnosis.take(&frame);
    }

    fn silent(&mut self, target: Target) {
        self.exchange(target, &[], Verdict::Silent);
    }

    fn report(&self) -> Report {
        self.report_after(0)
    }

    /// So many minutes after the last frame.
    fn report_after(&self, minutes: i64) -> Report {
        let now = Timestamp::UNIX_EPOCH + SignedDuration::from_millis(self.frames * 100);
        self.diagnosis.report(now + SignedDuration::from_mins(minutes), "COM3", |_| None)
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
fn each_protocol_in_which_a_silent_address_was_asked_counts_its_first_question() {
    let mut line = Played::default();
    line.good(at(1), 20);
    for target in [at(2), dcon_at(2)] {
        (0..3).for_each(|_| line.silent(target));
    }
    assert_eq!(line.found(Symptom::SilentAddress).evidence, "address 2 (02h) was asked 6 times and never answered");
}

#[test]
fn an_address_that_answers_in_another_protocol_is_not_silent() {
    let mut line = Played::default();
    (0..3).for_each(|_| line.silent(dcon_at(1)));
    assert!(line.symptoms().contains(&Symptom::SilentAddress));
    line.good(at(1), 1);
    assert!(line.symptoms().is_empty(), "{:?}", line.symptoms());
    (0..3).for_each(|_| line.silent(dcon_at(1)));
    assert!(line.symptoms().is_empty(), "nor if it is asked again");
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
    line.unasked(at(1), &[0xFF; 3]);
    assert!(line.found(Symptom::Noise).evidence.contains("(3 in all)"));
    line.silent(at(1));
    line.unasked(at(1), &[0xFF; 3]);
    assert!(!line.symptoms().contains(&Symptom::Late), "00 and FF are no answer");
    line.silent(at(1));
    line.unasked(at(1), &modbus::with_crc(&[1, 3, 2, 0, 7]));
    let late = line.found(Symptom::Late);
    assert_eq!(late.severity, Severity::Warning);
    assert!(late.cause.contains("virtual machine") && late.next_step.contains("latency timer"), "{late:?}");
}

#[test]
fn answers_that_come_twice_are_no_noise() {
    let answer = modbus::with_crc(&[1, 3, 2, 0, 7]);
    let mut line = Played::default();
    for _ in 0..20 {
        line.exchange(at(1), &answer, Verdict::Answer);
        line.unasked(at(1), &answer);
    }
    assert_eq!(line.symptoms(), [Symptom::Twice]);
    let twice = line.found(Symptom::Twice);
    assert!(twice.evidence.starts_with("20 answers came a second time"), "{twice:?}");
    assert!(twice.cause.contains("repeater") && twice.next_step.contains("latency timer"), "{twice:?}");
    // Both copies in one piece.
    let mut line = Played::default();
    let both = answer.repeat(2);
    (0..20).for_each(|_| line.exchange_with(at(1), &both, Verdict::Answer, |frame| frame.noise = true));
    assert_eq!(line.symptoms(), [Symptom::Twice]);
}

#[test]
fn a_second_copy_in_two_pieces_is_one() {
    let answer = modbus::with_crc(&[1, 3, 2, 0, 7]);
    let begun = [&answer[..], &answer[..1]].concat();
    let mut line = Played::default();
    for _ in 0..20 {
        line.exchange_with(at(1), &begun, Verdict::Answer, |frame| frame.noise = true);
        line.unasked(at(1), &answer[1..]);
    }
    assert_eq!(line.symptoms(), [Symptom::Twice]);
}

#[test]
fn the_answer_to_a_write_that_comes_twice_is_not_taken_for_an_echo() {
    let write = modbus::with_crc(&[1, 6, 0, 9, 0, 7]);
    let both = write.repeat(2);
    let mut line = Played::default();
    for _ in 0..10 {
        for (bytes, behind) in [(&write, &write[..]), (&both, &[])] {
            line.sent_as(at(1), &write);
            let mut frame = line.frame(at(1), Direction::Received, bytes, Verdict::Answer);
            frame.noise = behind.is_empty();
            line.diagnosis.take(&frame);
            if !behind.is_empty() {
                line.unasked(at(1), behind);
            }
        }
    }
    assert_eq!(line.symptoms(), [Symptom::Twice]);
    assert!(line.found(Symptom::Twice).evidence.starts_with("20 answers"), "{:?}", line.found(Symptom::Twice));
}

#[test]
fn an_answer_in_front_of_its_requests_echo_is_late_and_no_noise() {
    let answer = modbus::with_crc(&[1, 3, 2, 0, 7]);
    let mut line = Played::default();
    let behind = [&answer[..], &request(1)].concat();
    for _ in 0..10 {
        line.exchange_with(at(1), &behind, Verdict::Answer, |frame| frame.noise = true);
        line.exchange(at(1), &answer, Verdict::Answer);
        line.unasked(at(1), &request(1));
    }
    assert_eq!(line.symptoms(), [Symptom::Late]);
    assert!(line.found(Symptom::Late).evidence.starts_with("20 answers"), "{:?}", line.found(Symptom::Late));
}

#[test]
fn another_whole_answer_beside_the_right_one_is_late() {
    let mut line = Played::default();
    let both = b"!02PIR130\r!01PIR234\r";
    line.good(dcon_at(1), 5);
    line.exchange_with(dcon_at(1), both, Verdict::Answer, |frame| frame.noise = true);
    assert_eq!(line.symptoms(), [Symptom::Late]);
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
fn some_answers_lost_suggest_no_longer_timeout_unless_they_came_late() {
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
    let ample = module.suggested_timeout.as_ref().unwrap();
    assert_eq!(ample.verdict(), "200 ms in use, which is ample; it could be lowered to 50 ms");
    assert_eq!(module.error_rate, Some(0.1));
    assert!(!finding.cause.contains("too short") && !finding.next_step.contains("timeout"), "{finding:?}");
    line.silent(at(1));
    line.unasked(at(1), &modbus::with_crc(&[1, 3, 2, 0, 7]));
    let finding = line.found(Symptom::Lost);
    assert!(finding.cause.contains("too short") && finding.next_step.contains("longer timeout"), "{finding:?}");
    let report = line.report();
    let longer = report.modules[0].suggested_timeout.as_ref().unwrap();
    assert_eq!(longer.verdict(), "200 ms in use, 400 ms suggested");
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
        (ProblemKind::NoSuchPort { present: Vec::new(), portless: Vec::new() }, Symptom::NoSuchPort),
        (ProblemKind::NotASerialPort, Symptom::NoSerialPort),
        (ProblemKind::NotReached("nothing listens at this port".to_owned()), Symptom::NotReached),
        (ProblemKind::Other("it is broken".to_owned()), Symptom::NotOpened),
    ] {
        let mut line = Played::default();
        line.diagnosis.note_problem(LineProblem { line: "COM3".to_owned(), kind });
        assert_eq!(line.found(symptom).severity, Severity::Fault);
    }
    if cfg!(target_os = "linux") {
        assert!(Symptom::NoPermission.next_step().contains("usermod -a -G dialout"));
    }
}

#[test]
fn an_adapter_without_a_port_is_told_as_the_bus_tells_it() {
    let adapter = |reason| WithoutPort { maker: "WCH", vendor: 0x1A86, product: 0x7523, reason };
    let (cause, step) = (adapter(NoPort::Brltty).happened(), NoPort::Brltty.next_step());
    if cfg!(target_os = "linux") {
        let likely = Symptom::PortVanished.next_step();
        assert!(
            likely.contains("if brltty is named there: `sudo apt remove brltty`") && likely.ends_with(&step),
            "{likely}"
        );
    }
    let missing = |portless| {
        let kind = ProblemKind::NoSuchPort { present: vec!["COM1".to_owned()], portless };
        LineProblem { line: "COM3".to_owned(), kind }
    };
    let mut line = Played::default();
    line.diagnosis.note_problem(missing(vec![adapter(NoPort::Brltty)]));
    let finding = line.found(Symptom::NoSuchPort);
    assert_eq!((finding.cause, finding.next_step), (cause, step));
    line.diagnosis.note_problem(missing(vec![adapter(NoPort::Taken)]));
    let finding = line.found(Symptom::NoSuchPort);
    assert!(finding.next_step.starts_with("End that program") && !finding.next_step.contains("brltty"), "{finding:?}");
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
        "Next step: Check terminals, power and the cable",
        "timeout 200 ms, a read is asked again at most 2 times",
        "200 ms in use, which is ample; it could be lowered to 50 ms: 99 of 100 answers began within 12.0 ms",
        "\n1 warning needs attention.",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let json = serde_json::to_value(&report).unwrap();
    let module = &json["modules"][0];
    assert_eq!((&module["address"], &module["failures"]["no_answer"]), (&1.into(), &1.into()));
    assert_eq!(module["findings"][0]["symptom"], "lost");
}
