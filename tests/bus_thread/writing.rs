//! Writes and the module that moves.

use dcon_bench::bus::{BusCommand, BusEvent, Direction};
use dcon_bench::module::{Value, WriteError};

use crate::harness::*;

#[test]
fn a_write_changes_the_module_and_is_told_as_the_module_then_says() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let value = definition.item("pir_on_time").expect("an item").parse("66").expect("a value");
    let id = line.bus.next_id();
    let item = "pir_on_time".to_owned();
    line.bus.send(BusCommand::Write { id, target, definition, item, value: value.clone() }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert_eq!(result, Ok(value));
    assert_eq!(line.sim.setting(1, "pir_on_time").as_deref(), Some("66"));
}

/// Writes `pir_on_time` and returns what is told of it, and how many writes were sent.
fn write_on_time(line: &Line, text: &str) -> (Result<Value, WriteError>, u32) {
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let value = definition.item("pir_on_time").expect("an item").parse(text).expect("a value");
    let (id, item) = (line.bus.next_id(), "pir_on_time".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    let mut writes = 0;
    let result = line.until(|event| match event {
        BusEvent::Traffic(frame) => {
            writes += u32::from(frame.direction == Direction::Sent && frame.bytes.get(1) == Some(&6));
            None
        }
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    (result, writes)
}

/// A line whose only module has been identified and answers no more.
fn line_with_a_module_that_has_died() -> Line {
    let line = Line::open(&["pir-234@1"]);
    let (id, target) = (line.bus.next_id(), target("pir-234@1"));
    line.bus.send(BusCommand::Identify { id, target }).expect("room");
    line.until(|event| matches!(event, BusEvent::Identified { .. }).then_some(()));
    line.sim.set_dead(1, true);
    line
}

#[test]
fn a_write_that_stays_without_answer_is_sent_once_and_its_outcome_is_said_to_be_unknown() {
    let line = line_with_a_module_that_has_died();
    let before = line.sim.requests();
    let (result, writes) = write_on_time(&line, "66");
    let error = result.expect_err("nobody answered").to_string();
    assert!(error.contains("not known"), "{error}");
    assert_eq!(writes, 1);
    assert!(line.sim.requests() > before);
}

#[test]
fn a_write_that_is_kept_back_for_the_answer_to_one_before_is_said_not_to_be_written() {
    let line = line_with_a_module_that_has_died();
    write_on_time(&line, "66").0.expect_err("nobody answered");
    let (result, writes) = write_on_time(&line, "33");
    let error = result.expect_err("nobody answers").to_string();
    assert_eq!(
        (error.as_str(), writes),
        ("pir_on_time was not written: the module has not answered what it was asked before (no answer)", 0)
    );
}

#[test]
fn nothing_is_written_to_a_module_of_another_model() {
    let line = Line::open(&["pir-130@1"]);
    let (target, definition) = (target("pir-130@1"), line.definition("pir-234"));
    let value = definition.item("pir_on_time").expect("an item").parse("66").expect("a value");
    let before = line.sim.setting(1, "pir_on_time");
    let (id, item) = (line.bus.next_id(), "pir_on_time".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert!(result.expect_err("another model").to_string().contains("pir-130, not pir-234"));
    assert_eq!(line.sim.setting(1, "pir_on_time"), before);
}

#[test]
fn a_module_is_not_moved_to_an_address_where_another_answers() {
    let line = Line::open(&["pir-234@1", "pir-130@2"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let value = definition.item("address").expect("an item").parse("2").expect("a value");
    let (id, item) = (line.bus.next_id(), "address".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert!(result.expect_err("it is taken").to_string().contains("already"));
    assert_eq!(line.sim.setting(1, "address").as_deref(), Some("1"));
}
