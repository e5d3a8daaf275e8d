//! The table of all modules, and the commands of the menu and the keys.

use dcon_bench::bench::{Action, Presence};
use dcon_bench::bus::Target;
use dcon_bench::sim::{Pace, Sim};
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, OutputCommand};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

const PIR_234: &str = "PIR-234, address 1";
const PIR_130: &str = "PIR-130, address 160";

fn three() -> Sim {
    sim(&["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:dcon:9600", "unknown@161:modbus_rtu:9600"], Pace::Skip)
}

/// What the table says of a module in a column.
fn cell(window: &Window, module: &str, column: &str) -> Option<String> {
    let start = format!("{module}, {column}: ");
    let nodes = window.query_all_by_label_contains(&start);
    nodes.filter_map(|node| node.value()).find_map(|text| text.strip_prefix(&start).map(str::to_owned))
}

fn is(window: &Window, module: &str, column: &str, text: &str) -> bool {
    cell(window, module, column).as_deref() == Some(text)
}

#[track_caller]
fn scanned(sim: &Sim) -> Window {
    let mut window = window(sim);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    window.step();
    window
}

fn target(window: &Window, address: u8) -> Target {
    let modules = window.state().bench().modules();
    modules.iter().find(|module| module.target.address == address).unwrap().target
}

#[test]
fn the_table_shows_what_the_modules_have() {
    let sim = three();
    let mut window = scanned(&sim);
    sim.set_temperature(1, 21.5);
    sim.set_humidity(1, 40.25);
    sim.set_motion(1, 0, true);
    sim.set_motion(160, 0, false);
    assert!(shows(&window, "Nothing is polled"));
    assert!(is(&window, PIR_234, "State", "found"));
    assert!(is(&window, PIR_234, "Temperature", "–"));
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::L);
    until(&mut window, "the reason why nothing is polled", |window| shows(window, "No line is open: scan"));
    press(&mut window, Modifiers::COMMAND, Key::R);
    until(&mut window, "the scan ends", scan_ended);
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "temperature", |window| is(window, PIR_234, "Temperature", "21.50 °C"));
    until(&mut window, "humidity", |window| is(window, PIR_234, "Relative humidity", "40.25 %"));
    until(&mut window, "motion", |window| is(window, PIR_234, "Motion", "motion"));
    until(&mut window, "no motion", |window| is(window, PIR_130, "Motion", "quiet"));
    // Both outputs follow the sensors.
    until(&mut window, "outputs", |window| is(window, PIR_234, "Outputs", "on, on"));
    assert_eq!([sim.setting(1, "do0"), sim.setting(1, "do1")], [Some("true".to_owned()), Some("true".to_owned())]);
    assert!(!shows(&window, "Nothing is polled"));
    for (module, column, text) in [
        (PIR_234, "State", "answering"),
        (PIR_234, "Model", "PIR-234"),
        (PIR_234, "Address", "1 (01h)"),
        (PIR_234, "Protocol", "Modbus RTU 9600 N81"),
        (PIR_234, "Alarm", "none"),
        (PIR_234, "Watchdog", "no"),
        (PIR_234, "Interval", "1 s"),
        (PIR_130, "Address", "160 (A0h)"),
        (PIR_130, "Relative humidity", "–"),
        (PIR_130, "Watchdog", "–"),
        ("unknown, address 161", "State", "unknown"),
        ("unknown, address 161", "Interval", "–"),
    ] {
        assert_eq!(cell(&window, module, column).as_deref(), Some(text), "{module} {column}");
    }
    assert!(cell(&window, PIR_234, "Answered").unwrap().ends_with('s'));
}

#[test]
fn temperatures_stand_in_the_chosen_unit() {
    let sim = three();
    let mut window = scanned(&sim);
    sim.set_temperature(1, 20.0);
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "Celsius", |window| is(window, PIR_234, "Temperature", "20.00 °C"));
    click(&mut window, Role::Button, "Menu");
    click(&mut window, Role::RadioButton, "°F");
    until(&mut window, "Fahrenheit", |window| is(window, PIR_234, "Temperature", "68.00 °F"));
}

#[test]
fn columns_that_no_module_fills_are_left_out() {
    let mut window = scanned(&sim(&["pir-130@0xA0:dcon:9600"], Pace::Skip));
    until(&mut window, "the row", |window| is(window, PIR_130, "State", "found"));
    assert!(cell(&window, PIR_130, "Motion").is_some());
    assert!(cell(&window, PIR_130, "Relative humidity").is_none());
    assert!(cell(&window, PIR_130, "Watchdog").is_none());
}

#[test]
fn a_silent_module_is_marked_and_counted_and_keeps_its_values() {
    let sim = three();
    let mut window = scanned(&sim);
    sim.set_temperature(1, 21.5);
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "temperature", |window| is(window, PIR_234, "Temperature", "21.50 °C"));
    assert!(shows(&window, "3 modules") && shows(&window, "none silent"));
    sim.set_dead(1, true);
    until(&mut window, "it is marked", |window| is(window, PIR_234, "State", "silent"));
    assert!(is(&window, PIR_234, "Temperature", "21.50 °C"));
    assert!(shows(&window, "1 silent"));
    assert!(is(&window, PIR_130, "State", "answering"));
    sim.set_dead(1, false);
    until(&mut window, "it answers", |window| is(window, PIR_234, "State", "answering"));
    assert!(shows(&window, "none silent"));
}

#[test]
fn an_alarm_is_shown_and_counted() {
    let sim = three();
    let mut window = scanned(&sim);
    let target = target(&window, 1);
    sim.set_temperature(1, 80.0);
    for (id, text) in [("alarm_limit", "50"), ("alarm_mode", "momentary")] {
        window.state_mut().apply(Action::Set(target, id.to_owned(), text.to_owned()));
    }
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "the alarm", |window| is(window, PIR_234, "Alarm", "alarm"));
    assert!(shows(&window, "1 in alarm"));
    sim.set_temperature(1, 20.0);
    until(&mut window, "its end", |window| is(window, PIR_234, "Alarm", "none"));
    assert!(shows(&window, "none in alarm"));
}

#[test]
fn a_click_on_a_line_opens_the_module() {
    let mut window = scanned(&three());
    click(&mut window, Role::Row, PIR_130);
    until(&mut window, "its tab", |window| {
        window.query_by_role_and_label(Role::Button, "PIR-130 @160").is_some() && shows(window, "Pause polling")
    });
    assert_eq!(window.state().bench().shown().unwrap().target.address, 160);
    assert!(window.query_by_role_and_label(Role::Row, PIR_130).is_none(), "the dashboard is behind it");
}

#[test]
fn enter_on_a_line_opens_the_module() {
    let mut window = scanned(&three());
    window.get_by_role_and_label(Role::Row, PIR_234).focus();
    window.step();
    press(&mut window, Modifiers::NONE, Key::Enter);
    until(&mut window, "its tab", |window| window.query_by_role_and_label(Role::Button, "PIR-234 @1").is_some());
}

#[test]
fn a_right_click_pauses_the_polling_and_removes_the_module() {
    let mut window = scanned(&three());
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "it is polled", |window| is(window, PIR_234, "State", "answering"));
    window.get_by_role_and_label(Role::Row, PIR_234).click_secondary();
    window.step();
    click(&mut window, Role::Button, "Pause polling");
    until(&mut window, "it pauses", |window| is(window, PIR_234, "State", "paused"));
    assert!(is(&window, PIR_234, "Interval", "–"));
    window.get_by_role_and_label(Role::Row, PIR_130).click_secondary();
    window.step();
    click(&mut window, Role::Button, "Remove from the list");
    until(&mut window, "it is gone", |window| cell(window, PIR_130, "State").is_none());
    assert_eq!(window.state().bench().modules().len(), 2);
}

#[test]
fn all_known_modules_are_polled_and_paused_together() {
    let mut window = scanned(&three());
    let polled = |window: &Window| -> Vec<bool> {
        window.state().bench().modules().iter().map(|module| module.interval.is_some()).collect()
    };
    let known = |window: &Window| -> Vec<bool> {
        window.state().bench().modules().iter().map(|module| module.definition().is_some()).collect()
    };
    assert_eq!(polled(&window), [false; 3]);
    press(&mut window, Modifiers::COMMAND, Key::P);
    assert_eq!(polled(&window), known(&window));
    until(&mut window, "both answer", |window| {
        let modules = window.state().bench().modules();
        modules.iter().filter(|module| module.presence == Presence::Answering).count() == 2
    });
    click(&mut window, Role::Button, "Pause all");
    assert_eq!(polled(&window), [false; 3]);
}

#[test]
fn a_click_on_a_heading_sorts_and_what_is_not_known_stands_last() {
    let sim =
        sim(&["pir-234@1:modbus_rtu:9600", "pir-234@160:modbus_rtu:9600", "pir-234@161:modbus_rtu:9600"], Pace::Skip);
    let mut window = scanned(&sim);
    sim.set_temperature(1, 20.0);
    sim.set_temperature(160, 30.0);
    sim.set_dead(161, true);
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "both values", |window| {
        is(window, PIR_234, "Temperature", "20.00 °C") && is(window, "PIR-234, address 160", "Temperature", "30.00 °C")
    });
    let order = |window: &Window| -> Vec<u8> {
        let mut rows: Vec<(i32, u8)> = [1, 160, 161]
            .map(|address: u8| {
                let name = format!("PIR-234, address {address}");
                let row = window.get_by_role_and_label(Role::Row, &name);
                (row.rect().top() as i32, address)
            })
            .into();
        rows.sort_unstable();
        rows.into_iter().map(|(_, address)| address).collect()
    };
    click(&mut window, Role::Button, "Sort by Temperature");
    assert_eq!(order(&window), [1, 160, 161]);
    click(&mut window, Role::Button, "Sort by Temperature");
    assert_eq!(order(&window), [160, 1, 161]);
    click(&mut window, Role::Button, "Sort by Temperature");
    assert_eq!(order(&window), [1, 160, 161]);
}

#[test]
fn the_table_is_copied_as_text() {
    let sim = three();
    let mut window = scanned(&sim);
    sim.set_temperature(1, 21.5);
    click(&mut window, Role::Button, "Poll all");
    until(&mut window, "temperature", |window| is(window, PIR_234, "Temperature", "21.50 °C"));
    window.get_by_role_and_label(Role::Button, "Copy table").click();
    window.step();
    let commands = &window.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let text = copied.expect("a text is copied");
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split('\t').collect()).collect();
    assert_eq!(lines.len(), 4);
    assert_eq!(lines[0][..5], ["State", "Model", "Address", "Protocol", "Temperature"]);
    let module = lines.iter().find(|line| line[2] == "1 (01h)").unwrap();
    assert_eq!((module[1], module[4]), ("PIR-234", "21.50 °C"));
    assert!(lines.iter().all(|line| line.len() == lines[0].len()));
}

#[test]
fn after_a_quick_scan_it_is_said_what_a_full_scan_finds() {
    let window = scanned(&three());
    assert!(shows(&window, "A full scan also finds other speeds, formats and addresses"));
}

#[test]
fn the_keys_scan_stop_and_close_the_line() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Real);
    let mut window = window(&sim);
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::R);
    until(&mut window, "the full scan runs", |window| window.state().bench().is_scanning());
    press(&mut window, Modifiers::COMMAND, Key::R);
    press(&mut window, Modifiers::COMMAND, Key::Period);
    until(&mut window, "it is stopped", scan_ended);
    assert!(shows(&window, "Stopped after"));
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::L);
    until(&mut window, "the line is closed", |window| shows(window, "No line open"));
}

#[test]
fn f5_reads_the_tab_again() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, PIR_234);
    click(&mut window, Role::Tab, "Configuration");
    let read_at =
        |window: &Window| window.state().bench().shown().and_then(|module| module.reading("response_delay")?.at);
    until(&mut window, "it is read", |window| read_at(window).is_some());
    let first = read_at(&window);
    press(&mut window, Modifiers::NONE, Key::F5);
    until(&mut window, "it is read again", |window| read_at(window) > first);
}

#[test]
fn keys_turn_the_pages_of_a_module() {
    let mut window = window(&three());
    open(&mut window, PIR_234);
    let page = |window: &Window| window.state().settings().tab.clone();
    click(&mut window, Role::Tab, "AI");
    press(&mut window, Modifiers::CTRL, Key::PageDown);
    assert_eq!(page(&window), "pir");
    press(&mut window, Modifiers::CTRL, Key::PageUp);
    press(&mut window, Modifiers::CTRL, Key::PageUp);
    assert_eq!(page(&window), "configuration");
    press(&mut window, Modifiers::CTRL, Key::PageUp);
    assert_eq!(page(&window), "summary", "before the first comes the last");
}

#[test]
fn ctrl_enter_writes_all_changes_and_the_menu_reverts_them() {
    let sim = three();
    let mut window = window(&sim);
    open(&mut window, PIR_234);
    let target = target(&window, 1);
    let stage = |window: &mut Window, text: &str| {
        window.state_mut().apply(Action::Stage(target, "response_delay".to_owned(), text.to_owned()));
        window.step();
    };
    stage(&mut window, "7");
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    until(&mut window, "it is written", |_| sim.setting(1, "response_delay").as_deref() == Some("7"));
    until(&mut window, "nothing waits", |window| window.state().bench().shown().unwrap().edits.is_empty());
    stage(&mut window, "9");
    click(&mut window, Role::Button, "Menu");
    click(&mut window, Role::MenuItem, "Revert all changes");
    until(&mut window, "it is reverted", |window| window.state().bench().shown().unwrap().edits.is_empty());
    stage(&mut window, "11");
    click(&mut window, Role::Button, "Menu");
    click(&mut window, Role::MenuItem, "Write all changes");
    until(&mut window, "it is written", |_| sim.setting(1, "response_delay").as_deref() == Some("11"));
}

#[test]
fn a_command_that_cannot_be_done_says_why_and_does_nothing() {
    let mut window = window(&three());
    click(&mut window, Role::Button, "Menu");
    let disabled =
        |window: &Window, text: &str| window.get_by_role_and_label(Role::MenuItem, text).accesskit_node().is_disabled();
    for text in ["Stop the scan", "Close line", "Write all changes", "Read again", "Close tab"] {
        assert!(disabled(&window, text), "{text}");
    }
    assert!(!disabled(&window, "Quick scan"));
    window.get_by_role_and_label(Role::MenuItem, "Stop the scan").hover();
    until(&mut window, "the reason", |window| shows(window, "No scan is running"));
}

#[test]
fn ctrl_w_in_a_text_field_closes_the_tab_and_changes_no_value() {
    let sim = three();
    let mut window = window(&sim);
    open(&mut window, PIR_234);
    let tab = |window: &Window| window.query_by_role_and_label(Role::Button, "PIR-234 @1").is_some();
    click(&mut window, Role::Tab, "Configuration");
    until(&mut window, "the field", |window| {
        window.query_by_role_and_label(Role::TextInput, "Response delay").is_some()
    });
    window.get_by_role_and_label(Role::TextInput, "Response delay").focus();
    window.step();
    window.step();
    assert!(tab(&window));
    press(&mut window, Modifiers::COMMAND, Key::W);
    until(&mut window, "it is closed", |window| !tab(window));
    let module = window.state().bench().modules().first().unwrap();
    assert!(module.edits.is_empty());
}

#[test]
fn the_menu_shows_what_is_typed() {
    let mut window = window(&three());
    let event = |key, modifiers| Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
    window.input_mut().events.push(event(Key::T, Modifiers::COMMAND));
    window.step();
    window.step();
    assert!(window.query_by_role_and_label(Role::Button, "Traffic").is_some());
    press(&mut window, Modifiers::COMMAND, Key::D);
    assert!(shows(&window, "Nothing searched yet"));
}
