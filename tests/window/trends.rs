//! The trends: what is shown, how time is moved, and that figures are those of the simulated modules.

use std::time::Duration;

use dcon_bench::bench::Action;
use dcon_bench::record::EventKind;
use dcon_bench::sim::{Pace, Sim};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::accesskit::{Role, Toggled};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

const MODULE: &str = "PIR-234, address 1";

fn one() -> Sim {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    sim.set_temperature(1, 21.5);
    sim.set_humidity(1, 40.0);
    sim.set_motion(1, 0, false);
    sim
}

/// Polls the module and opens the trends.
#[track_caller]
fn trends(window: &mut Window, samples: u64) {
    open(window, MODULE);
    click(window, Role::Button, "Trends");
    until(window, "samples", |window| count(window, "temperature_c") >= samples);
}

fn count(window: &Window, item: &str) -> u64 {
    let history = window.state().bench().history();
    let module = history.modules().next().map(|(id, _)| id);
    let id = module.and_then(|module| history.series_of(module, item));
    id.and_then(|id| history.get(id)).map_or(0, |series| series.trend.len())
}

fn is_ticked(window: &Window, name: &str) -> Option<bool> {
    let node = window.query_by_role_and_label(Role::CheckBox, name)?;
    Some(node.accesskit_node().toggled() == Some(Toggled::True))
}

fn plots(window: &Window) -> eframe::egui::Rect {
    window.get_by_role_and_label(Role::Canvas, "Plots").rect()
}

/// A place in the plots, as parts of their width and height.
fn at(window: &Window, across: f32, down: f32) -> Pos2 {
    plots(window).lerp_inside(eframe::egui::vec2(across, down))
}

fn move_to(window: &mut Window, place: Pos2) {
    window.event(Event::PointerMoved(place));
    window.step();
    window.step();
}

fn button(window: &mut Window, place: Pos2, button: PointerButton, pressed: bool) {
    window.event(Event::PointerButton { pos: place, button, pressed, modifiers: Modifiers::NONE });
    window.step();
}

fn drag(window: &mut Window, from: Pos2, to: Pos2, with: PointerButton) {
    move_to(window, from);
    button(window, from, with, true);
    move_to(window, from + (to - from) / 2.0);
    move_to(window, to);
    button(window, to, with, false);
    window.step();
}

/// The row of this series in the table of values.
fn row(window: &Window, name: &str) -> Option<String> {
    let start = format!("{name}: ");
    window
        .query_all_by_role(Role::Row)
        .filter_map(|node| node.accesskit_node().label())
        .find(|text| text.starts_with(&start))
}

#[test]
fn before_anything_is_measured_it_says_what_to_do() {
    let sim = one();
    let mut window = window(&sim);
    click(&mut window, Role::Button, "Trends");
    assert!(shows(&window, "Nothing was measured yet") && shows(&window, "Scan a line first"));
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    click(&mut window, Role::Button, "Poll all modules");
    until(&mut window, "plots", |window| window.query_by_role_and_label(Role::Canvas, "Plots").is_some());
}

#[test]
fn temperature_humidity_and_motion_are_shown_at_first_and_others_can_be_chosen() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 3);
    assert_eq!(is_ticked(&window, "Temperature of PIR-234@1"), Some(true));
    assert_eq!(is_ticked(&window, "Relative humidity of PIR-234@1"), Some(true));
    assert_eq!(is_ticked(&window, "PIR of PIR-234@1"), Some(true));
    assert_eq!(is_ticked(&window, "Dew point of PIR-234@1"), Some(false));
    assert_eq!(is_ticked(&window, "Show Dew point"), None);
    click(&mut window, Role::CheckBox, "Dew point of PIR-234@1");
    assert_eq!(is_ticked(&window, "Show Dew point"), Some(true));
    let kept = &window.state().settings().trend_series;
    assert!(kept.iter().any(|entry| entry.starts_with("0 left dew_point_c modbus_rtu@1")), "{kept:?}");
    click(&mut window, Role::CheckBox, "Relative humidity of PIR-234@1");
    assert_eq!(is_ticked(&window, "Show Relative humidity"), None);
    click(&mut window, Role::CheckBox, "All temperatures");
    assert_eq!(is_ticked(&window, "Temperature of PIR-234@1"), Some(false));
}

#[test]
fn what_was_chosen_is_shown_after_the_next_start() {
    let sim = one();
    let kept = vec!["0 left dew_point_c modbus_rtu@1 Simulated line".to_owned()];
    let settings = Settings { line: LineChoice::Simulated, trend_series: kept, ..Settings::default() };
    let mut window = window_with(&sim, false, settings);
    trends(&mut window, 1);
    assert_eq!(is_ticked(&window, "Dew point of PIR-234@1"), Some(true));
    assert_eq!(is_ticked(&window, "Temperature of PIR-234@1"), Some(false));
}

#[test]
fn a_series_is_found_by_its_name_and_hidden_by_a_click_on_it() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 1);
    let field = window.get_by_role_and_label(Role::TextInput, "Search series");
    field.focus();
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Search series").type_text("dew");
    window.step();
    window.step();
    assert_eq!(is_ticked(&window, "Dew point of PIR-234@1"), Some(false));
    assert_eq!(is_ticked(&window, "Temperature of PIR-234@1"), None);
    click(&mut window, Role::CheckBox, "Show Temperature");
    assert_eq!(is_ticked(&window, "Show Temperature"), Some(false));
    click(&mut window, Role::CheckBox, "List of series");
    assert!(window.query_by_role_and_label(Role::TextInput, "Search series").is_none());
}

#[test]
fn it_follows_until_it_is_paused_or_moved_and_goes_back_to_what_was_in_view() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 5);
    click(&mut window, Role::Button, "Pause");
    click(&mut window, Role::Button, "Follow");
    let (from, to) = (at(&window, 0.5, 0.5), at(&window, 0.8, 0.5));
    drag(&mut window, from, to, PointerButton::Primary);
    assert!(window.query_by_role_and_label(Role::Button, "Follow").is_some(), "dragging ends the following");
    click(&mut window, Role::Button, "Back");
    assert!(window.query_by_role_and_label(Role::Button, "Pause").is_some(), "and Back takes it up again");
    let (from, to) = (at(&window, 0.6, 0.5), at(&window, 0.7, 0.6));
    drag(&mut window, from, to, PointerButton::Secondary);
    let span = window.get_by_role_and_label(Role::ComboBox, "Time in view").value();
    assert_eq!(span.as_deref(), Some("30 s"), "a tenth of five minutes");
    move_to(&mut window, to);
    press(&mut window, Modifiers::NONE, Key::Backspace);
    let span = window.get_by_role_and_label(Role::ComboBox, "Time in view").value();
    assert_eq!(span.as_deref(), Some("5 min"));
}

#[test]
fn figures_between_the_cursors_are_those_of_what_the_module_was() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 3);
    let target = window.state().bench().shown().unwrap().target;
    sim.set_temperature(1, 23.0);
    sim.set_motion(1, 1, true);
    let before = count(&window, "temperature_c");
    until(&mut window, "samples of the change", |window| count(window, "temperature_c") > before + 2);
    sim.set_motion(1, 1, false);
    let before = count(&window, "temperature_c");
    until(&mut window, "samples afterwards", |window| count(window, "temperature_c") > before + 2);
    window.state_mut().apply(Action::StopPolling(target));
    window.step();
    click(&mut window, Role::Button, "All");
    click(&mut window, Role::CheckBox, "Table of values");
    until(&mut window, "figures", |window| row(window, "Temperature").is_some());
    for (key, across) in [(Key::A, 0.08), (Key::B, 0.998)] {
        let place = at(&window, across, 0.3);
        move_to(&mut window, place);
        press(&mut window, Modifiers::NONE, key);
    }
    assert!(shows(&window, "Figures between A and B"));
    let temperature = row(&window, "Temperature").unwrap();
    for part in ["A 21.50", "B 23.00", "B − A 1.50", "Lowest 21.50", "Highest 23.00"] {
        assert!(temperature.contains(part), "{part} in {temperature}");
    }
    let motion = row(&window, "PIR sensor 1").unwrap();
    assert!(motion.contains("Times on 1") && motion.contains("A quiet"), "{motion}");
    click(&mut window, Role::Button, "Clear cursors");
    assert!(shows(&window, "Figures of the time in view"));
}

#[test]
fn in_a_gap_there_is_no_value() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 5);
    let target = window.state().bench().shown().unwrap().target;
    window.state_mut().apply(Action::StopPolling(target));
    sim.advance(Duration::from_secs(60));
    window.state_mut().apply(Action::SetInterval(target, Duration::from_secs(1)));
    let before = count(&window, "temperature_c");
    until(&mut window, "samples after the gap", |window| count(window, "temperature_c") > before + 2);
    window.state_mut().apply(Action::StopPolling(target));
    window.step();
    click(&mut window, Role::Button, "All");
    click(&mut window, Role::CheckBox, "Table of values");
    let place = at(&window, 0.5, 0.3);
    move_to(&mut window, place);
    let in_gap = row(&window, "Temperature").unwrap();
    assert!(in_gap.contains("Pointer –"), "{in_gap}");
    let place = at(&window, 0.999, 0.3);
    move_to(&mut window, place);
    let after = row(&window, "Temperature").unwrap();
    assert!(after.contains("Pointer 21.50"), "{after}");
}

#[test]
fn the_limit_of_the_alarm_is_drawn_while_the_alarm_is_switched_on() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 3);
    let target = window.state().bench().shown().unwrap().target;
    let settings = || ["alarm_mode".to_owned(), "alarm_limit".to_owned()].to_vec();
    window.state_mut().apply(Action::Read(target, settings()));
    until(&mut window, "the settings", |window| count(window, "alarm_limit") > 0);
    assert!(!shows(&window, "High alarm limit 65.00 °C"), "it is disabled");
    for (item, text) in [("alarm_limit", "24"), ("alarm_mode", "momentary")] {
        window.state_mut().apply(Action::Set(target, item.to_owned(), text.to_owned()));
    }
    until(&mut window, "the line", |window| window.query_by_label("High alarm limit 24.00 °C").is_some());
}

#[test]
fn times_are_local_or_utc_as_chosen() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 1);
    assert!(!window.state().settings().utc);
    click(&mut window, Role::CheckBox, "Times in UTC");
    assert!(window.state().settings().utc);
    assert_eq!(is_ticked(&window, "Local times"), Some(false));
    click(&mut window, Role::CheckBox, "Local times");
    assert!(!window.state().settings().utc);
}

#[test]
fn a_note_is_written_at_the_pointer_and_marked() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 3);
    let place = at(&window, 0.9, 0.3);
    move_to(&mut window, place);
    press(&mut window, Modifiers::NONE, Key::M);
    until(&mut window, "the field", |window| window.query_by_role_and_label(Role::TextInput, "Note").is_some());
    window.get_by_role_and_label(Role::TextInput, "Note").type_text("door opened");
    window.step();
    click(&mut window, Role::Button, "Add note");
    until(&mut window, "the mark", |window| {
        window.query_by_role_and_label(Role::Button, "Note: door opened").is_some()
    });
    let events = window.state().bench().history().events();
    let note = events.iter().find(|event| event.kind == EventKind::Note).unwrap();
    assert!(note.at < window.state().bench().now() && note.text == "door opened");
}

#[test]
fn a_series_moves_to_another_plot_by_its_menu() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 3);
    window.get_by_role_and_label(Role::CheckBox, "Show Relative humidity").click_secondary();
    window.step();
    click(&mut window, Role::Button, "Move to the plot above");
    let kept = &window.state().settings().trend_series;
    assert!(kept.iter().any(|entry| entry.starts_with("0 right humidity")), "{kept:?}");
    let axes = window.query_all_by_role(Role::Slider).filter_map(|node| node.accesskit_node().label());
    assert_eq!(axes.collect::<Vec<_>>(), ["Axis °C", "Axis %"]);
}

#[test]
fn the_picture_is_saved_as_svg_with_its_words() {
    let folder = tempfile::tempdir().unwrap();
    let sim = one();
    let mut window = crate::traffic::window_with_field(&sim);
    trends(&mut window, 3);
    click(&mut window, Role::Button, "Picture");
    click(&mut window, Role::Button, "Save picture as SVG…");
    until(&mut window, "the field", |window| window.query_by_role_and_label(Role::TextInput, "Path").is_some());
    window.step();
    let path = folder.path().join("plots.svg");
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Path").type_text(path.to_str().unwrap());
    window.step();
    click(&mut window, Role::Button, "Save");
    until(&mut window, "it is written", |_| path.exists());
    let text = std::fs::read_to_string(&path).unwrap();
    for part in ["<svg", ">Temperature</text>", ">°C</text>", ">PIR</text>"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn while_it_is_paused_nothing_is_drawn_again_and_again() {
    let sim = one();
    let mut window = window(&sim);
    trends(&mut window, 3);
    let target = window.state().bench().shown().unwrap().target;
    window.state_mut().apply(Action::StopPolling(target));
    click(&mut window, Role::Button, "Pause");
    move_to(&mut window, pos2(2.0, 2.0));
    window.run();
}
