//! The Log tab: what happened to a module, and what was said to it.

use dcon_bench::bench::{Action, EntryKind};
use dcon_bench::sim::Pace;
use eframe::egui::accesskit::Role;

use crate::harness::*;
use crate::traffic::{has_row, rows, save_to, search, window_with_field};

#[test]
fn what_happens_to_a_module_is_listed_and_can_be_filtered() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    sim.set_motion(1, 0, false);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Log");
    until(&mut window, "found", |window| has_row(window, &["Found", "Found at"]));
    until(&mut window, "it was polled", |window| {
        window.state().bench().shown().is_some_and(|module| module.known("temperature_c").is_some())
    });
    let target = window.state().bench().shown().unwrap().target;
    let actions = [
        Action::Read(target, vec!["temperature_offset".to_owned()]),
        Action::Set(target, "temperature_offset".to_owned(), "1.5".to_owned()),
    ];
    for action in actions {
        window.state_mut().apply(action);
    }
    until(&mut window, "written", |window| has_row(window, &["Written", "1.5"]));
    sim.set_motion(1, 1, true);
    until(&mut window, "motion", |window| has_row(window, &["Motion"]));
    sim.set_dead(1, true);
    until(&mut window, "lost", |window| has_row(window, &["Lost"]));
    click(&mut window, Role::CheckBox, "Written");
    assert!(!rows(&window).is_empty());
    assert!(rows(&window).iter().all(|row| row.contains("Written")), "{:?}", rows(&window));
    click(&mut window, Role::CheckBox, "Written");
    search(&mut window, "lost");
    assert!(!rows(&window).is_empty());
    assert!(rows(&window).iter().all(|row| row.contains("Lost")), "{:?}", rows(&window));
}

#[test]
fn a_refused_write_is_an_event() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Log");
    until(&mut window, "it was polled", |window| {
        window.state().bench().shown().is_some_and(|module| module.known("temperature_c").is_some())
    });
    let target = window.state().bench().shown().unwrap().target;
    sim.set_dead(1, true);
    window.state_mut().apply(Action::Set(target, "temperature_offset".to_owned(), "1.5".to_owned()));
    until(&mut window, "refused", |window| has_row(window, &["Refused"]));
    let module = window.state().bench().shown().unwrap();
    assert!(module.journal.iter().any(|entry| entry.kind == EntryKind::Refused));
}

#[test]
fn communication_is_decoded_and_of_this_module_only() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600", "pir-130@2:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Log");
    click(&mut window, Role::CheckBox, "Communication");
    until(&mut window, "a decoded answer", |window| has_row(window, &["Received", "temperature_c", "OK"]));
    assert!(rows(&window).iter().all(|row| !row.contains("Found")));
    click(&mut window, Role::CheckBox, "Both");
    until(&mut window, "frames and events", |window| has_row(window, &["Received"]));
    sim.set_dead(1, true);
    until(&mut window, "a silent frame and the event of it", |window| {
        has_row(window, &["Received", "No answer"]) && has_row(window, &["Lost:"])
    });
}

#[test]
fn exported_events_have_time_kind_and_text() {
    let folder = tempfile::tempdir().unwrap();
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window_with_field(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Log");
    until(&mut window, "found", |window| has_row(window, &["Found", "Found at"]));
    let path = folder.path().join("events.csv");
    save_to(&mut window, "Events as CSV…", &path);
    let mut reader = csv::Reader::from_path(&path).unwrap();
    assert_eq!(reader.headers().unwrap(), vec!["time", "kind", "text"]);
    let first = reader.records().next().unwrap().unwrap();
    assert!(first[0].ends_with('Z') && &first[1] == "found" && first[2].starts_with("Found at"), "{first:?}");
    let path = folder.path().join("events.jsonl");
    save_to(&mut window, "Events as JSON Lines…", &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let row: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    assert_eq!(row["kind"], "found");
}
