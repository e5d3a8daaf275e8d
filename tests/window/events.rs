//! What happened to all modules, as the trends list it.

use dcon_bench::bench::Action;
use dcon_bench::record::EventKind;
use dcon_bench::sim::{Pace, Sim};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use jiff::{SignedDuration, Timestamp};

use crate::harness::*;
use crate::traffic::{has_row, rows, save_to, search, window_with_field};

const TWO: [&str; 2] = ["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:modbus_rtu:9600"];

/// Both modules are polled, and the trends are in view.
fn begin(window: &mut Window) {
    click(window, Role::Button, "Scan");
    until(window, "the scan ends", scan_ended);
    window.state_mut().apply(Action::PollAll(true));
    show_trends(window);
}

/// Brings the trends into view, with the list of events.
pub fn show_trends(window: &mut Window) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::G);
    window.step();
    show_events(window);
}

/// Opens the list of events of the trends in view, if it is not open.
pub fn show_events(window: &mut Window) {
    let is_listed = |window: &Window| window.query_by_role_and_label(Role::CheckBox, "Only the span in view").is_some();
    let list = |window: &Window| window.query_by_role_and_label(Role::CheckBox, "List of events").is_some();
    until(window, "the trends", |window| is_listed(window) || list(window));
    if !is_listed(window) {
        click(window, Role::CheckBox, "List of events");
    }
    until(window, "the trends", |window| {
        window.query_by_role_and_label(Role::CheckBox, "Only the span in view").is_some()
    });
}

fn all_contain(window: &Window, part: &str) -> bool {
    !rows(window).is_empty() && rows(window).iter().all(|row| row.contains(part))
}

fn two() -> Sim {
    let sim = sim(&TWO, Pace::Skip);
    sim.set_motion(1, 0, false);
    sim
}

#[test]
fn what_happens_to_any_module_is_listed_and_can_be_filtered() {
    let sim = two();
    let mut window = window(&sim);
    begin(&mut window);
    until(&mut window, "both found", |window| {
        has_row(window, &["PIR-234@1", "Found"]) && has_row(window, &["PIR-130@160", "Found"])
    });
    let polled = |window: &Window, item: &str| window.state().bench().modules()[0].known(item).is_some();
    until(&mut window, "it was polled", |window| polled(window, "temperature_c"));
    sim.set_motion(1, 1, true);
    until(&mut window, "motion", |window| has_row(window, &["PIR-234@1", "Motion"]));
    sim.set_dead(0xA0, true);
    until(&mut window, "lost", |window| has_row(window, &["PIR-130@160", "Lost"]));
    click(&mut window, Role::CheckBox, "Lost");
    window.step();
    assert!(all_contain(&window, "Lost"), "{:?}", rows(&window));
    click(&mut window, Role::CheckBox, "Lost");
    search(&mut window, "pir-234");
    window.step();
    assert!(all_contain(&window, "PIR-234@1"), "{:?}", rows(&window));
}

#[test]
fn the_list_is_narrowed_to_one_module() {
    let mut window = window(&two());
    begin(&mut window);
    until(&mut window, "both found", |window| has_row(window, &["PIR-130@160", "Found"]));
    click(&mut window, Role::ComboBox, "Events of");
    click(&mut window, Role::Button, "PIR-130@160");
    window.step();
    assert!(all_contain(&window, "PIR-130@160"), "{:?}", rows(&window));
}

#[test]
fn a_note_stands_at_its_time_and_outside_the_span_in_view_is_left_out_on_demand() {
    let mut window = window(&two());
    begin(&mut window);
    until(&mut window, "found", |window| has_row(window, &["Found"]));
    let long_ago = Timestamp::now() - SignedDuration::from_hours(30);
    window.state_mut().apply(Action::AddNote(long_ago, "Filter cleaned".to_owned()));
    until(&mut window, "the note", |window| has_row(window, &["Note", "Filter cleaned"]));
    assert!(rows(&window)[0].contains("Filter cleaned"), "{:?}", rows(&window));
    assert_eq!(window.state().bench().history().events().front().map(|event| event.kind), Some(EventKind::Note));
    click(&mut window, Role::CheckBox, "Only the span in view");
    window.step();
    assert!(!has_row(&window, &["Filter cleaned"]), "{:?}", rows(&window));
}

#[test]
fn times_are_local_or_utc_as_it_was_chosen() {
    let settings = Settings { line: LineChoice::Simulated, utc: true, ..Settings::default() };
    let mut window = window_with(&two(), false, settings);
    begin(&mut window);
    until(&mut window, "an event", |window| !rows(window).is_empty());
    assert!(shows(&window, "Time (UTC)") || rows(&window)[0].starts_with("20"), "{:?}", rows(&window));
    let at = window.state().bench().history().events()[0].at;
    assert!(rows(&window)[0].starts_with(&at.strftime("%Y-%m-%d %H:%M:%S").to_string()), "{:?}", rows(&window));
}

#[test]
fn exported_events_name_their_module() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with_field(&two());
    begin(&mut window);
    until(&mut window, "both found", |window| has_row(window, &["PIR-130@160", "Found"]));
    let path = folder.path().join("events.csv");
    save_to(&mut window, "Events as CSV…", &path);
    let mut reader = csv::Reader::from_path(&path).unwrap();
    assert_eq!(reader.headers().unwrap(), vec!["time", "module", "kind", "text", "item", "before", "after"]);
    let first = reader.records().next().unwrap().unwrap();
    assert!(first[0].parse::<Timestamp>().is_ok(), "{first:?}");
    assert_eq!((&first[1], &first[2]), ("PIR-234@1", "found"));
    let path = folder.path().join("events.jsonl");
    save_to(&mut window, "Events as JSON Lines…", &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let row: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    assert_eq!((&row["module"], &row["kind"]), (&"PIR-234@1".into(), &"found".into()));
}
