use crate::bench::{Action, Bench, Module};
use crate::bus::{Bus, BusEvent, RequestId, Target};
use crate::module::{Catalogue, Identified, Value};
use crate::protocol::{LineSettings, Protocol};

fn with_module() -> (Bench, Target, std::sync::mpsc::Receiver<crate::bus::BusCommand>) {
    let catalogue = Catalogue::built_in().0;
    let definition = catalogue.get("pir-234");
    let (bus, commands, _) = Bus::detached();
    let mut bench = Bench::new(bus, catalogue.into(), &[]);
    let target =
        Target { address: 1, protocol: Protocol::ModbusRtu, settings: LineSettings::default(), checksum: false };
    let identified =
        Identified { definition, name: "PIR-234".to_owned(), firmware: String::new(), said: String::new() };
    bench.take(BusEvent::Found { id: RequestId(1), target, identified });
    (bench, target, commands)
}

fn module(bench: &Bench) -> &Module {
    &bench.modules()[0]
}

fn text<'a>(bench: &'a Bench, id: &str) -> Option<&'a str> {
    module(bench).edit(id).map(|edit| edit.text.as_str())
}

fn stage(bench: &mut Bench, target: Target, id: &str, text: &str) {
    bench.apply(Action::Stage(target, id.to_owned(), text.to_owned()));
}

#[test]
fn what_is_typed_into_one_field_is_one_step_and_a_choice_is_one_each() {
    let (mut bench, target, _commands) = with_module();
    for typed in ["6", "66", "660"] {
        stage(&mut bench, target, "response_delay", typed);
    }
    let label = module(&bench).item("response_delay").unwrap().label.clone();
    assert_eq!(module(&bench).undoable(), Some(label.as_str()));
    stage(&mut bench, target, "temperature_offset", "1.0");
    bench.apply(Action::Undo(target));
    assert_eq!((text(&bench, "temperature_offset"), text(&bench, "response_delay")), (None, Some("660")));
    bench.apply(Action::Undo(target));
    assert!(module(&bench).edits.is_empty() && module(&bench).undoable().is_none());
    bench.apply(Action::Redo(target));
    assert_eq!(text(&bench, "response_delay"), Some("660"));
    stage(&mut bench, target, "response_delay", "5");
    assert_eq!(module(&bench).redoable(), None);
    bench.apply(Action::Undo(target));
    assert_eq!(text(&bench, "response_delay"), Some("660"));
}

#[test]
fn reverting_all_is_a_step_that_can_be_undone() {
    let (mut bench, target, _commands) = with_module();
    stage(&mut bench, target, "response_delay", "5");
    stage(&mut bench, target, "temperature_offset", "1.0");
    bench.apply(Action::Revert(target, None));
    assert!(module(&bench).edits.is_empty());
    assert_eq!(module(&bench).undoable(), Some("revert all changes"));
    bench.apply(Action::Undo(target));
    assert_eq!(module(&bench).edits.len(), 2);
}

#[test]
fn what_was_written_is_no_step_and_what_is_being_written_stays() {
    let (mut bench, target, _commands) = with_module();
    stage(&mut bench, target, "temperature_offset", "1.0");
    stage(&mut bench, target, "response_delay", "5");
    bench.apply(Action::Write(target, vec!["response_delay".to_owned()]));
    assert_eq!(module(&bench).undoable(), None, "it is on its way");
    bench.apply(Action::Undo(target));
    assert_eq!(text(&bench, "response_delay"), Some("5"));
    let super::super::EditState::Writing(id) = module(&bench).edit("response_delay").unwrap().state else { panic!() };
    let value = module(&bench).edit("response_delay").unwrap().value.clone().unwrap();
    let at = jiff::Timestamp::UNIX_EPOCH;
    bench.take(BusEvent::Written { id, target, item: "response_delay".to_owned(), at, result: Ok(value.clone()) });
    bench.apply(Action::Undo(target));
    assert!(module(&bench).edits.is_empty(), "the step before it is undone");
    assert_eq!(module(&bench).known("response_delay"), Some(&value));
    assert!(matches!(value, Value::Number(_)));
}
