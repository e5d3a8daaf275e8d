//! Polls, and what becomes of them when the adapter is pulled.

use dcon_bench::bus::{BusCommand, BusEvent, Direction, ItemSet, Target};
use jiff::{SignedDuration, Timestamp};
use std::time::Duration;

use crate::harness::*;

/// Questions of one poll of a PIR-234 over Modbus RTU: outputs, PIR sensors, three single coils, readings.
const RTU_QUESTIONS: u64 = 6;
/// Asked once of each PIR-234 over Modbus: whether it has Wi-Fi, and something else, which shows that the answer was its own.
const PARTS: u64 = 2;

/// What a poll came to.
struct Polled {
    address: u8,
    at: Timestamp,
    answered: bool,
}

fn watch(line: &Line, target: Target, interval: Duration) {
    let (id, definition) = (line.bus.next_id(), line.definition("pir-234"));
    line.bus.send(BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval }).expect("room");
}

fn poll(event: &BusEvent) -> Option<Polled> {
    let BusEvent::Read { target, at, values, .. } = event else { return None };
    let answered = values.iter().any(|answer| answer.result.is_ok());
    Some(Polled { address: target.address, at: *at, answered })
}

/// The polls until `enough`.
fn polls(line: &Line, polls: &mut Vec<Polled>, enough: impl Fn(&[Polled]) -> bool) {
    line.until(|event| {
        polls.push(poll(event)?);
        enough(polls).then_some(())
    });
}

/// Lets all be, and takes in the polls that were under way. Requests on the line in all, without that of this.
fn unwatch(line: &Line, targets: &[Target], seen: &mut Vec<Polled>) -> u64 {
    for &target in targets {
        line.bus.send(BusCommand::Unwatch { target }).expect("room");
    }
    let (fence, definition) = (line.bus.next_id(), line.definition("pir-234"));
    let items = ItemSet::Named(vec!["humidity".to_owned()]);
    line.bus.send(BusCommand::Read { id: fence, target: targets[0], definition, items }).expect("room");
    line.until(|event| match event {
        BusEvent::Read { id, .. } if *id == fence => Some(()),
        event => {
            seen.extend(poll(event));
            None
        }
    });
    line.sim.requests() - 1
}

fn count(polls: &[Polled], wanted: impl Fn(&Polled) -> bool) -> u64 {
    polls.iter().filter(|poll| wanted(poll)).count() as u64
}

#[test]
fn a_watched_module_is_read_again_and_again_until_it_is_let_go() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let id = line.bus.next_id();
    let interval = Duration::from_millis(1);
    line.bus.send(BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval }).expect("room");
    line.sim.set_temperature(1, 24.99);
    let mut readings = 0;
    line.until(|event| match event {
        BusEvent::Read { values, .. } => {
            readings += 1;
            let warm = values.iter().any(|answer| {
                answer.id == "temperature_c" && answer.result.as_ref().is_ok_and(|v| v.to_string() == "24.99")
            });
            (readings > 5 && warm).then_some(())
        }
        _ => None,
    });
    line.bus.send(BusCommand::Unwatch { target }).expect("room");
    let temperature = line.read(target, &line.definition("pir-234"), "temperature_c");
    assert_eq!(temperature.expect("a value").to_string(), "24.99");
    let after = line.sim.requests();
    line.read(target, &line.definition("pir-234"), "humidity").expect("a value");
    // One more makes certain that the second answer was not the first once again.
    assert_eq!(line.sim.requests(), after + 2, "nothing but what was asked for is sent");
}

#[test]
fn a_watch_follows_its_module_to_a_new_address() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let (id, interval) = (line.bus.next_id(), Duration::from_millis(1));
    let items = ItemSet::Live;
    let watch = BusCommand::Watch { id, target, definition: definition.clone(), items, interval };
    line.bus.send(watch).expect("room");
    line.until(|event| matches!(event, BusEvent::Read { .. }).then_some(()));
    let value = definition.item("address").expect("an item").parse("9").expect("a value");
    let (id, item) = (line.bus.next_id(), "address".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    line.until(|event| match event {
        BusEvent::Read { target, values, .. } if target.address == 9 => {
            values.iter().all(|answer| answer.result.is_ok()).then_some(())
        }
        _ => None,
    });
}

#[test]
fn what_a_slow_poll_has_brought_is_told_before_it_ends() {
    let line = Line::open(&["pir-234@1:modbus_rtu:1200"]);
    watch(&line, target("pir-234@1:modbus_rtu:1200"), Duration::from_secs(10));
    let (mut early, mut whole) = (Vec::new(), Vec::new());
    line.until(|event| match event {
        BusEvent::Reading { values, .. } => {
            early.extend(values.iter().cloned());
            None
        }
        BusEvent::Read { values, .. } => {
            whole = values.clone();
            Some(())
        }
        _ => None,
    });
    assert!(!early.is_empty() && early.iter().all(|answer| answer.result.is_ok()));
    let (first, last) = (early.iter().map(|answer| answer.at).min(), whole.iter().map(|answer| answer.at).max());
    assert!(last.unwrap().duration_since(first.unwrap()) > SignedDuration::from_millis(500), "1200 bps are slow");
    for answer in early {
        let again = whole.iter().find(|other| other.id == answer.id).expect("the poll tells it again");
        assert_eq!((again.at, &again.result), (answer.at, &answer.result));
    }
}

#[test]
fn an_unused_line_shows_no_transactions_a_second() {
    let line = Line::open(&["pir-234@1"]);
    line.read(target("pir-234@1"), &line.definition("pir-234"), "humidity").expect("a value");
    let rate = |event: &BusEvent| match event {
        BusEvent::Statistics(statistics) => Some(statistics.transactions_per_second),
        _ => None,
    };
    assert!(line.until(rate) > 0.0);
    line.until(|event| rate(event).filter(|rate| *rate == 0.0));
}

#[test]
fn a_pulled_adapter_is_told_and_polling_goes_on_when_it_returns() {
    let line = Line::open(&["pir-234@1"]);
    watch(&line, target("pir-234@1"), Duration::from_millis(5));
    line.until(|event| matches!(event, BusEvent::Read { .. }).then_some(()));
    line.sim.unplug();
    line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
    line.sim.plug();
    line.until(|event| matches!(event, BusEvent::LineRestored { .. }).then_some(()));
    line.until(|event| match event {
        BusEvent::Read { values, .. } => values.iter().all(|answer| answer.result.is_ok()).then_some(()),
        _ => None,
    });
}

#[test]
fn on_a_line_that_returns_a_module_is_polled_at_once_whatever_its_interval() {
    let line = Line::open(&["pir-234@1"]);
    watch(&line, target("pir-234@1"), Duration::from_secs(3_600));
    line.until(|event| matches!(event, BusEvent::Read { .. }).then_some(()));
    line.sim.unplug();
    line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
    line.sim.plug();
    line.until(|event| matches!(event, BusEvent::LineRestored { .. }).then_some(()));
    let mut seen = Vec::new();
    polls(&line, &mut seen, |seen| seen.iter().any(|poll| poll.answered));
}

#[test]
fn each_value_has_the_time_at_which_its_own_answer_had_arrived() {
    let line = Line::open(&["pir-234@1"]);
    let (id, definition) = (line.bus.next_id(), line.definition("pir-234"));
    let read = BusCommand::Read { id, target: target("pir-234@1"), definition, items: ItemSet::Live };
    line.bus.send(read).expect("room");
    let mut arrived = Vec::new();
    let (end, values) = line.until(|event| match event {
        BusEvent::Traffic(frame) if frame.direction == Direction::Received => {
            arrived.push(frame.at);
            None
        }
        BusEvent::Read { at, values, .. } => Some((*at, values.clone())),
        _ => None,
    });
    assert!(values.iter().all(|answer| arrived.contains(&answer.at) && answer.at <= end));
    let at = |id: &str| values.iter().find(|answer| answer.id == id).expect("a value").at;
    assert_eq!(at("pir1"), at("pir4"), "one answer");
    assert_ne!(at("pir1"), at("temperature_c"), "two answers");
}

#[test]
fn a_dead_module_is_probed_ever_more_rarely_with_one_question_and_is_back_when_it_answers() {
    let line = Line::open(&["pir-234@1", "pir-234@2", "pir-234@3", "pir-234@4"]);
    let targets = ["pir-234@1", "pir-234@2", "pir-234@3", "pir-234@4"].map(target);
    line.sim.set_dead(3, true);
    targets.iter().for_each(|target| watch(&line, *target, Duration::ZERO));
    let mut seen = Vec::new();
    let is_probe = |poll: &Polled| poll.address == 3;
    polls(&line, &mut seen, |seen| count(seen, is_probe) >= 6);

    let probes: Vec<usize> = (0..seen.len()).filter(|&index| is_probe(&seen[index])).collect();
    for (silences, pair) in (1..).zip(probes.windows(2)) {
        // One window of 200 ms and more, doubled after each probe.
        let least = SignedDuration::from_millis(200) * (1 << silences);
        let rest = seen[pair[1]].at.duration_since(seen[pair[0]].at);
        assert!(rest >= least, "{rest} after {silences}");
        let between = &seen[pair[0] + 1..pair[1]];
        assert!([1, 2, 4].iter().all(|address| between.iter().any(|poll| poll.address == *address)));
        assert!(between.iter().all(|poll| poll.answered));
    }

    line.sim.set_dead(3, false);
    polls(&line, &mut seen, |seen| seen.last().is_some_and(|poll| poll.address == 3 && poll.answered));
    let back = seen.len();
    polls(&line, &mut seen, |seen| seen.len() == back + 40);
    assert_eq!(count(&seen[back..], is_probe), 10, "it takes its turn again");

    let requests = unwatch(&line, &targets, &mut seen);
    let answered = count(&seen, |poll| poll.answered);
    let silent = count(&seen, |poll| !poll.answered);
    // The first time it is asked three times: it was not known to be silent.
    assert_eq!(requests, answered * RTU_QUESTIONS + silent + 2 + 4 * PARTS, "one question for each probe");
}

#[test]
fn a_dead_module_of_another_speed_costs_one_question_a_probe_too() {
    let line = Line::open(&["pir-234@1", "pir-234@3:modbus_rtu:19200"]);
    let targets = ["pir-234@1", "pir-234@3:modbus_rtu:19200"].map(target);
    line.sim.set_dead(3, true);
    targets.iter().for_each(|target| watch(&line, *target, Duration::ZERO));
    let mut seen = Vec::new();
    polls(&line, &mut seen, |seen| count(seen, |poll| !poll.answered) >= 4);
    let requests = unwatch(&line, &targets, &mut seen);
    let answered = count(&seen, |poll| poll.answered);
    let silent = count(&seen, |poll| !poll.answered);
    // The first time it is asked four times: it was not known to be silent, and the change of speed may have been at fault.
    assert_eq!(requests, answered * RTU_QUESTIONS + silent + 3 + PARTS);
}

/// What is sent for one poll of the live items of a PIR-234.
fn questions(spec: &str) -> Vec<Vec<u8>> {
    let line = Line::open(&[spec]);
    let target = target(spec);
    watch(&line, target, Duration::from_secs(3_600));
    // After this one it is known which parts it has.
    line.until(|event| matches!(event, BusEvent::Parts { .. }).then_some(()));
    line.bus.send(BusCommand::Unwatch { target }).expect("room");
    let (id, definition) = (line.bus.next_id(), line.definition("pir-234"));
    line.bus.send(BusCommand::Read { id, target, definition, items: ItemSet::Live }).expect("room");
    let mut sent = Vec::new();
    line.until(|event| match event {
        BusEvent::Traffic(frame) if frame.direction == Direction::Sent => {
            sent.push(frame.bytes.clone());
            None
        }
        BusEvent::Read { id: of, values, .. } if *of == id => {
            assert!(values.iter().all(|answer| answer.result.is_ok()), "{values:?}");
            Some(())
        }
        BusEvent::Read { .. } => {
            sent.clear();
            None
        }
        _ => None,
    });
    sent
}

#[test]
fn neighbouring_registers_and_coils_are_one_question_each() {
    let sent = questions("pir-234@1:modbus_rtu");
    // Function, first, count: DO0 and DO1; PIR and its sensors; watchdog, buzzer, alarm; five readings.
    let asked: Vec<(u8, u16, u16)> = sent
        .iter()
        .map(|frame| (frame[1], u16::from_be_bytes([frame[2], frame[3]]), u16::from_be_bytes([frame[4], frame[5]])))
        .collect();
    assert_eq!(asked, [(1, 0, 2), (1, 32, 5), (1, 269, 1), (1, 273, 1), (1, 304, 1), (3, 0, 5)]);
    assert_eq!(asked.len() as u64, RTU_QUESTIONS);
}

#[test]
fn over_dcon_one_command_brings_the_channels_that_it_has_and_each_other_channel_takes_one() {
    let sent = questions("pir-234@1:dcon");
    let asked: Vec<_> = sent.iter().map(|frame| String::from_utf8_lossy(frame)).collect();
    // As in its manual's example, #AA brings three channels; the dew points are asked for by themselves.
    assert_eq!(asked, ["@01DI\r", "@01RAO\r", "~010\r", "#01\r", "#013\r", "#014\r"]);
}

#[test]
fn a_silent_module_is_asked_at_its_own_speed_and_heard_again() {
    let specs = ["pir-234@1:dcon:9600", "pir-234@2:dcon:115200"];
    let line = Line::open(&specs);
    let targets = specs.map(target);
    for target in targets {
        // Once it has answered it is known by its name.
        line.read(target, &line.definition("pir-234"), "name").expect("a name");
        watch(&line, target, Duration::from_millis(500));
    }
    line.sim.set_dead(2, true);
    let mut polled = Vec::new();
    let mut silent_questions = 0;
    line.until(|event| {
        if let BusEvent::Traffic(frame) = event
            && frame.address == Some(2)
        {
            assert_eq!(frame.settings, targets[1].settings, "{frame:?}");
            silent_questions += u32::from(frame.direction == Direction::Sent);
        }
        polled.extend(poll(event));
        (count(&polled, |poll| poll.address == 2 && !poll.answered) >= 5).then_some(())
    });
    assert!(silent_questions >= 5);
    line.sim.set_dead(2, false);
    line.until(|event| poll(event).filter(|poll| poll.address == 2 && poll.answered).map(|_| ()));
}
