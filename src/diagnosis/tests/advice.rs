//! What is advised, and in which words.

use super::*;

#[test]
fn advice_for_a_network_speaks_of_hosts_and_cables_and_not_of_adapters() {
    let network = Target { protocol: Protocol::ModbusTcp, ..at(1) };
    let all_of = |line: &Played| {
        let report = line.report();
        let told: Vec<String> = report.findings().map(|finding| finding.cause.clone() + &finding.next_step).collect();
        assert!(!told.is_empty());
        for words in ["adapter", "nplug", "D+", "DIP", "brltty", "USB"] {
            assert!(!told.concat().contains(words), "{words} in {told:?}");
        }
        told.concat()
    };
    let mut line = Played::default();
    let kind = ProblemKind::NotReached("nothing listens at this port".to_owned());
    line.diagnosis.note_problem(LineProblem { line: "192.168.0.9:502".to_owned(), kind });
    assert!(all_of(&line).contains("the port number (502 unless it was changed), the cable"));
    let mut line = Played::default();
    (0..3).for_each(|_| line.silent(network));
    assert!(all_of(&line).contains("another NetID"));
    let mut line = Played::default();
    line.good(network, 20);
    line.exchange(network, &[], broken("the line was lost: the module closed the connection"));
    line.exchange(network, &[1], broken("the answer was cut short"));
    (0..3).for_each(|_| line.silent(network));
    assert!(all_of(&line).contains("network"));
}

#[test]
fn a_mistyped_port_is_told_with_those_that_are_there() {
    let mut line = Played::default();
    let kind = ProblemKind::NoSuchPort { present: vec!["COM1".to_owned(), "COM7".to_owned()], portless: Vec::new() };
    line.diagnosis.note_problem(LineProblem { line: "COM3".to_owned(), kind });
    let finding = line.found(Symptom::NoSuchPort);
    assert_eq!(finding.evidence, "there is no port COM3");
    assert!(finding.cause.contains("mistyped"), "{finding:?}");
    assert!(finding.next_step.ends_with("(`dcon-bench ports` lists them): at present COM1, COM7"), "{finding:?}");
}

#[test]
fn a_refused_question_that_was_sent_only_to_come_into_step_is_no_refusal() {
    let mut line = Played::default();
    line.good(at(1), 20);
    line.silent(at(1));
    let probe = modbus::with_crc(&[1, 1, 0, 0, 0, 1]);
    let frame = line.frame(at(1), Direction::Sent, &probe, Verdict::Request);
    line.diagnosis.take(&frame);
    let frame = line.frame(at(1), Direction::Received, &modbus::with_crc(&[1, 0x81, 2]), Verdict::Refusal);
    line.diagnosis.take(&frame);
    let report = line.report();
    assert_eq!((report.modules[0].refusals, report.modules[0].answers), (0, 21));
    assert!(!line.symptoms().contains(&Symptom::Refused), "{:?}", line.symptoms());
}

#[test]
fn the_conclusion_says_only_what_there_is() {
    let concluded = |faulty: u8, odd: u8| {
        let mut line = Played::default();
        for address in 1..=faulty {
            line.good(at(address), 10);
            (0..5).for_each(|_| line.silent(at(address)));
        }
        for address in 101..101 + odd {
            line.good(at(address), 99);
            line.exchange_with(at(address), b"\0answer", Verdict::Answer, |frame| frame.noise = true);
        }
        line.report().conclusion()
    };
    assert_eq!(concluded(1, 0), "1 fault needs attention.");
    assert_eq!(concluded(2, 0), "2 faults need attention.");
    assert_eq!(concluded(0, 1), "1 warning needs attention.");
    assert_eq!(concluded(1, 1), "1 fault and 1 warning need attention.");
}

#[test]
fn a_single_event_is_told_in_the_singular() {
    let mut line = Played::default();
    line.good(at(1), 20);
    line.exchange_with(at(1), b"\0answer", Verdict::Answer, |frame| frame.noise = true);
    line.silent(at(9));
    line.exchange(at(1), &[1, 3], broken("the answer was cut short"));
    let text = line.report().to_string();
    for part in
        ["stray bytes around 1 answer\n", "1 address never answered, and counts", "1 of 22 exchanges was cut short"]
    {
        assert!(text.contains(part), "{part}\n{text}");
    }
    line.unasked(at(1), &[0xFF]);
    let text = line.report().to_string();
    assert!(text.contains("stray bytes around 1 answer, 1 byte that nobody asked for"), "{text}");
}
