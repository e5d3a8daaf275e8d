//! Tabs side by side and in windows of their own, what is kept of them, and the questions before changes are lost.

use dcon_bench::bench::Action;
use dcon_bench::bus::Target;
use dcon_bench::sim::{Pace, Sim};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::App as _;
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, ViewportCommand, ViewportEvent, ViewportId, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

const FIRST: &str = "PIR-234, address 1";
const SECOND: &str = "PIR-234, address 160";
const FIRST_TAB: &str = "PIR-234 @1";
const SECOND_TAB: &str = "PIR-234 @160";

fn two() -> Sim {
    sim(&["pir-234@1:modbus_rtu:9600", "pir-234@160:modbus_rtu:9600"], Pace::Skip)
}

fn has_tab(window: &Window, name: &str) -> bool {
    window.query_by_role_and_label(Role::Button, name).is_some()
}

/// Headers of modules that can be seen.
fn modules_in_view(window: &Window) -> usize {
    window.query_all_by_role_and_label(Role::Button, "Pause polling").count()
}

fn target(window: &Window, address: u8) -> Target {
    let modules = window.state().bench().modules();
    modules.iter().find(|module| module.target.address == address).unwrap().target
}

fn stage(window: &mut Window, address: u8, text: &str) {
    let target = target(window, address);
    window.state_mut().apply(Action::Stage(target, "response_delay".to_owned(), text.to_owned()));
    window.step();
}

fn edits(window: &Window, address: u8) -> usize {
    window.state().bench().module(&target(window, address)).unwrap().edits.len()
}

/// A storage of which nothing is expected: the settings have a file of their own.
struct NoStorage;

impl eframe::Storage for NoStorage {
    fn get_string(&self, _key: &str) -> Option<String> {
        None
    }
    fn set_string(&mut self, _key: &str, _value: String) {}
    fn remove_string(&mut self, _key: &str) {}
    fn flush(&mut self) {}
}

/// The program closed and started again.
fn restarted(mut window: Window, sim: &Sim) -> Window {
    window.state_mut().save(&mut NoStorage);
    let settings = window.state().settings().clone();
    assert!(settings.layout.is_some());
    drop(window);
    window_with(sim, false, settings)
}

fn both_beside(sim: &Sim) -> Window {
    let mut window = window(sim);
    open(&mut window, FIRST);
    click(&mut window, Role::ListItem, SECOND);
    until(&mut window, "the second tab", |window| has_tab(window, SECOND_TAB));
    assert_eq!(modules_in_view(&window), 1);
    press(&mut window, Modifiers::COMMAND, Key::B);
    click(&mut window, Role::Button, FIRST_TAB);
    until(&mut window, "both are in view", |window| modules_in_view(window) == 2);
    window
}

#[test]
fn two_modules_side_by_side_both_show_what_they_measure() {
    let sim = two();
    let mut window = both_beside(&sim);
    let readings = |window: &Window, wanted: [&str; 2]| {
        wanted.iter().all(|wanted| {
            window.query_all_by_label_contains(wanted).any(|node| node.value().is_some_and(|text| text == *wanted))
        })
    };
    sim.set_temperature(1, 21.5);
    sim.set_temperature(160, 30.25);
    until(&mut window, "both", |window| readings(window, ["Temperature 21.50 °C", "Temperature 30.25 °C"]));
    sim.set_temperature(1, 22.0);
    sim.set_temperature(160, 31.0);
    until(&mut window, "both again", |window| readings(window, ["Temperature 22.00 °C", "Temperature 31.00 °C"]));
}

/// Whether a tab is in view: right of the list, left of what stands at the end of the tabs.
fn tab_in_view(window: &Window, name: &str) -> bool {
    let list = window.get_by_role_and_label(Role::ListItem, "PIR-234, address 160").rect();
    let end = window.get_by_role_and_label(Role::Button, "Own window").rect();
    let tab = window.query_by_role_and_label(Role::Button, name).map(|tab| tab.rect());
    tab.is_some_and(|tab| tab.left() >= list.right() && tab.right() <= end.left())
}

#[test]
fn the_tab_in_front_is_in_view_where_not_all_have_room() {
    let specs: Vec<String> = (160..170).map(|address| format!("pir-234@{address}:modbus_rtu:9600")).collect();
    let specs: Vec<&str> = specs.iter().map(String::as_str).collect();
    let mut window = window(&sim(&specs, Pace::Skip));
    open(&mut window, "PIR-234, address 160");
    for address in 161..170 {
        click(&mut window, Role::ListItem, &format!("PIR-234, address {address}"));
        let tab = format!("PIR-234 @{address}");
        until(&mut window, &tab, |window| tab_in_view(window, &tab));
    }
    assert!(!tab_in_view(&window, "PIR-234 @160"), "not all have room");
    click(&mut window, Role::ListItem, "PIR-234, address 160");
    until(&mut window, "the first one again", |window| tab_in_view(window, "PIR-234 @160"));
}

#[test]
fn a_tab_stands_beside_the_others_and_goes_back_among_them() {
    let mut window = both_beside(&two());
    let left = window.get_by_role_and_label(Role::Button, FIRST_TAB).rect();
    let right = window.get_by_role_and_label(Role::Button, SECOND_TAB).rect();
    assert!(right.left() > left.right() + 200.0, "{left} {right}");
    window.get_by_role_and_label(Role::Button, SECOND_TAB).click_secondary();
    window.step();
    click(&mut window, Role::Button, "Show among the other tabs");
    until(&mut window, "one is in view", |window| modules_in_view(window) == 1);
    window.get_by_role_and_label(Role::Button, SECOND_TAB).click_secondary();
    window.step();
    click(&mut window, Role::Button, "Show beside");
    until(&mut window, "it stands beside", |window| {
        window.get_by_role_and_label(Role::Button, SECOND_TAB).rect().left() > left.right() + 200.0
    });
}

#[test]
fn a_tab_dragged_to_the_side_stands_there() {
    let mut window = window(&two());
    open(&mut window, FIRST);
    let tab = window.get_by_role_and_label(Role::Button, FIRST_TAB).rect().center();
    let side = pos2(1270.0, 450.0);
    window.hover_at(tab);
    window.step();
    window.drag_at(tab);
    window.step();
    for place in [tab + vec2(20.0, 20.0), pos2(900.0, 400.0), side] {
        window.hover_at(place);
        window.step();
    }
    window.drop_at(side);
    window.step();
    until(&mut window, "the dashboard stands beside it", |window| {
        modules_in_view(window) == 1 && window.query_by_role_and_label(Role::Row, FIRST).is_some()
    });
    assert!(window.get_by_role_and_label(Role::Button, FIRST_TAB).rect().left() > tab.x + 100.0);
}

#[test]
fn the_keys_act_on_the_module_that_is_worked_in() {
    let sim = two();
    let mut window = both_beside(&sim);
    stage(&mut window, 1, "5");
    stage(&mut window, 160, "6");
    click(&mut window, Role::Button, SECOND_TAB);
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    until(&mut window, "the second is written", |_| sim.setting(160, "response_delay").as_deref() == Some("6"));
    assert_eq!(edits(&window, 1), 1, "the first waits");
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("0"));
}

#[test]
fn ctrl_tab_goes_through_all_tabs() {
    let mut window = window(&two());
    open(&mut window, FIRST);
    click(&mut window, Role::ListItem, SECOND);
    until(&mut window, "the second", |window| has_tab(window, SECOND_TAB));
    let dashboard = |window: &Window| window.query_by_role_and_label(Role::Row, FIRST).is_some();
    let edited = |window: &Window| shows(window, "1 change not written");
    stage(&mut window, 1, "5");
    assert!(!dashboard(&window) && !edited(&window));
    press(&mut window, Modifiers::CTRL, Key::Tab);
    until(&mut window, "after the last comes the first", dashboard);
    press(&mut window, Modifiers::CTRL, Key::Tab);
    until(&mut window, "the first module", edited);
    press(&mut window, Modifiers::CTRL | Modifiers::SHIFT, Key::Tab);
    until(&mut window, "the dashboard", dashboard);
}

#[test]
fn a_tab_in_a_window_of_its_own_comes_back() {
    let sim = two();
    let mut window = window(&sim);
    open(&mut window, FIRST);
    sim.set_temperature(1, 21.5);
    click(&mut window, Role::Button, "Own window");
    until(&mut window, "the window", |window| shows(window, "Back as a tab"));
    assert!(!has_tab(&window, FIRST_TAB));
    until(&mut window, "it is alive", |window| reading(window, "Temperature").as_deref() == Some("21.50 °C"));
    click(&mut window, Role::Button, "Back as a tab");
    until(&mut window, "the tab", |window| has_tab(window, FIRST_TAB));
    assert!(!shows(&window, "Back as a tab"));
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::N);
    until(&mut window, "the window again", |window| shows(window, "Back as a tab"));
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::N);
    until(&mut window, "the tab again", |window| has_tab(window, FIRST_TAB));
}

#[test]
fn the_dashboard_in_a_window_of_its_own_is_not_opened_twice() {
    let mut window = window(&two());
    click(&mut window, Role::Button, "Own window");
    until(&mut window, "the rest is empty", |window| shows(window, "All tabs are in windows of their own"));
    assert!(!has_tab(&window, "Dashboard"));
    let back = "Bring the dashboard back";
    window.get_by_role_and_label(Role::Button, back).click_accesskit();
    until(&mut window, "the tab", |window| has_tab(window, "Dashboard"));
}

#[test]
fn the_layout_survives_a_restart_and_waits_for_the_modules() {
    let sim = two();
    let mut window = both_beside(&sim);
    let right = window.get_by_role_and_label(Role::Button, SECOND_TAB).rect().left();
    window = restarted(window, &sim);
    let (first, second) = ("Module @1", "Module @160");
    assert!(has_tab(&window, first) && has_tab(&window, second));
    assert_eq!(window.query_all_by_label_contains("Not found on this line yet").count(), 2);
    let again = window.get_by_role_and_label(Role::Button, second).rect().left();
    assert!((again - right).abs() < 5.0, "{again} {right}");
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "they are found", scan_ended);
    until(&mut window, "they show", |window| has_tab(window, FIRST_TAB) && has_tab(window, SECOND_TAB));
    assert!(!shows(&window, "Not found on this line yet"));
}

#[test]
fn a_window_of_its_own_survives_a_restart() {
    let sim = two();
    let mut window = window(&sim);
    open(&mut window, FIRST);
    click(&mut window, Role::Button, "Own window");
    until(&mut window, "the window", |window| shows(window, "Back as a tab"));
    window = restarted(window, &sim);
    window.step();
    assert!(shows(&window, "Back as a tab") && shows(&window, "Not found on this line yet"));
    assert!(has_tab(&window, "Dashboard"));
}

#[test]
fn a_layout_that_cannot_be_read_is_the_first_one() {
    for layout in ["", "nonsense", "{}", r#"{"tree":{"root":null},"windows":[]}"#] {
        let settings = Settings { layout: Some(layout.to_owned()), line: LineChoice::Simulated, ..Settings::default() };
        let mut window = window_with(&two(), false, settings);
        window.step();
        assert!(has_tab(&window, "Dashboard"), "{layout}");
    }
}

#[test]
fn a_module_that_gets_another_address_keeps_its_tab() {
    let sim = two();
    let mut window = both_beside(&sim);
    let target = target(&window, 160);
    window.state_mut().apply(Action::Set(target, "address".to_owned(), "9".to_owned()));
    until(&mut window, "the tab follows", |window| has_tab(window, "PIR-234 @9"));
    assert!(!has_tab(&window, SECOND_TAB));
    assert_eq!(modules_in_view(&window), 2);
    sim.set_temperature(9, 33.0);
    until(&mut window, "it goes on", |window| shows(window, "Temperature 33.00 °C"));
}

#[test]
fn closing_a_tab_asks_about_changes_that_are_not_written() {
    let sim = two();
    let mut window = window(&sim);
    open(&mut window, FIRST);
    stage(&mut window, 1, "7");

    press(&mut window, Modifiers::COMMAND, Key::W);
    assert!(shows(&window, "Some changes are not written"));
    click(&mut window, Role::Button, "Cancel");
    assert!(has_tab(&window, FIRST_TAB) && edits(&window, 1) == 1);
    assert!(!shows(&window, "Some changes are not written"));

    press(&mut window, Modifiers::COMMAND, Key::W);
    click(&mut window, Role::Button, "Write 1 and stay");
    until(&mut window, "it is written", |_| sim.setting(1, "response_delay").as_deref() == Some("7"));
    assert!(has_tab(&window, FIRST_TAB));
    until(&mut window, "nothing waits", |window| edits(window, 1) == 0);

    stage(&mut window, 1, "8");
    press(&mut window, Modifiers::COMMAND, Key::W);
    click(&mut window, Role::Button, "Discard 1 and close the tab");
    until(&mut window, "it is closed", |window| !has_tab(window, FIRST_TAB));
    assert_eq!(edits(&window, 1), 0);
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("7"));
}

#[test]
fn closing_the_line_asks_about_changes_that_are_not_written() {
    let sim = two();
    let mut window = window(&sim);
    open(&mut window, FIRST);
    stage(&mut window, 1, "7");

    click(&mut window, Role::Button, "Close line");
    assert!(shows(&window, "Some changes are not written"));
    click(&mut window, Role::Button, "Cancel");
    assert!(window.state().bench().line().is_open() && edits(&window, 1) == 1);

    click(&mut window, Role::Button, "Close line");
    click(&mut window, Role::Button, "Write 1 and stay");
    until(&mut window, "it is written", |_| sim.setting(1, "response_delay").as_deref() == Some("7"));
    assert!(window.state().bench().line().is_open());
    until(&mut window, "nothing waits", |window| edits(window, 1) == 0);

    stage(&mut window, 1, "8");
    click(&mut window, Role::Button, "Close line");
    click(&mut window, Role::Button, "Discard 1 and close the line");
    until(&mut window, "it is closed", |window| shows(window, "No line open"));
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("7"));
}

/// The commands that the window gives the system in the frame in which it is asked to close.
fn close_window(window: &mut Window) -> Vec<ViewportCommand> {
    let input = window.input_mut();
    input.viewports.get_mut(&ViewportId::ROOT).unwrap().events.push(ViewportEvent::Close);
    window.step();
    window.output().viewport_output[&ViewportId::ROOT].commands.clone()
}

#[test]
fn quitting_asks_about_changes_that_are_not_written() {
    let sim = two();
    let mut window = window(&sim);
    assert!(!close_window(&mut window).contains(&ViewportCommand::CancelClose), "there is nothing to lose");
    open(&mut window, FIRST);
    stage(&mut window, 1, "7");

    assert!(close_window(&mut window).contains(&ViewportCommand::CancelClose));
    until(&mut window, "the question", |window| shows(window, "Some changes are not written"));
    click(&mut window, Role::Button, "Cancel");
    assert_eq!(edits(&window, 1), 1);

    assert!(close_window(&mut window).contains(&ViewportCommand::CancelClose));
    click(&mut window, Role::Button, "Write 1 and stay");
    until(&mut window, "it is written", |_| sim.setting(1, "response_delay").as_deref() == Some("7"));
    until(&mut window, "nothing waits", |window| edits(window, 1) == 0);

    stage(&mut window, 1, "8");
    assert!(close_window(&mut window).contains(&ViewportCommand::CancelClose));
    until(&mut window, "the question", |window| shows(window, "Discard 1 and quit"));
    window.get_by_role_and_label(Role::Button, "Discard 1 and quit").click();
    window.step();
    let commands = &window.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::Close));
    assert!(!close_window(&mut window).contains(&ViewportCommand::CancelClose), "it was agreed to");
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("7"));
}

#[test]
fn ctrl_q_quits() {
    let mut window = window(&two());
    let (key, modifiers) = (Key::Q, Modifiers::COMMAND);
    let event = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
    window.input_mut().events.push(event);
    window.step();
    assert!(window.output().viewport_output[&ViewportId::ROOT].commands.contains(&ViewportCommand::Close));
}

#[test]
fn a_restored_tab_asks_at_its_place_for_the_module_and_polls_it() {
    let far = "pir-234@7:modbus_rtu:9600";
    let sim = sim(&[far], Pace::Skip);
    let mut window = window(&sim);
    let target = dcon_bench::bus::Target {
        address: 7,
        protocol: dcon_bench::protocol::Protocol::ModbusRtu,
        settings: dcon_bench::protocol::LineSettings::default(),
        checksum: false,
    };
    // The quick scan does not ask at address 7.
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    assert!(window.state().bench().modules().is_empty());
    window.state_mut().apply(Action::Show(target));
    click(&mut window, Role::Button, "Ask there");
    until(&mut window, "it is polled", |window| reading(window, "Temperature").is_some());
    assert!(window.state().bench().module(&target).is_some_and(|module| module.interval.is_some()));
}
