//! The Configuration tab: edits by keyboard, a new address, the switches.

use dcon_bench::bench::ItemState;
use dcon_bench::sim::Pace;
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

/// A window that opens modules at this tab.
pub fn at_configuration(sim: &dcon_bench::sim::Sim) -> Window {
    let tab = "configuration".to_owned();
    window_with(sim, false, Settings { line: LineChoice::Simulated, tab, ..Settings::default() })
}

/// Waits until the module in view has told this item.
#[track_caller]
pub fn known(window: &mut Window, id: &str) {
    until(window, id, |window| {
        let module = window.state().bench().shown();
        module.is_some_and(|module| matches!(module.state(id), ItemState::Current(_)))
    });
    window.step();
}

/// Replaces what stands in a field, with the keyboard.
#[track_caller]
pub fn type_into(window: &mut Window, field: &str, text: &str) {
    window.get_by_role_and_label(Role::TextInput, field).focus();
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    window.get_by_role_and_label(Role::TextInput, field).type_text(text);
    window.step();
    window.step();
}

#[track_caller]
pub fn choose(window: &mut Window, list: &str, entry: &str) {
    click(window, Role::ComboBox, list);
    click(window, Role::Button, entry);
    window.step();
}

#[test]
fn a_response_delay_is_typed_and_written_with_enter() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "response_delay");
    type_into(&mut window, "Response delay", "12");
    assert!(shows(&window, "Response delay: not written, was 0 ms"));
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("0"));
    window.key_press(Key::Enter);
    until(&mut window, "it is written", |_| sim.setting(1, "response_delay").as_deref() == Some("12"));
    until(&mut window, "nothing is left to write", |window| {
        window.state().bench().shown().is_some_and(|module| module.edits.is_empty())
    });
}

#[test]
fn a_module_is_followed_to_its_new_address_in_list_and_tab() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "address");
    assert!(shows(&window, "Address = 01h"));
    type_into(&mut window, "Address", "0A5h");
    assert!(shows(&window, "Address = 165"));
    window.key_press(Key::Enter);
    until(&mut window, "the list", |window| {
        window.query_by_role_and_label(Role::ListItem, "PIR-234, address 165").is_some()
    });
    assert!(window.query_by_role_and_label(Role::ListItem, "PIR-234, address 1").is_none());
    assert_eq!(sim.setting(165, "address").as_deref(), Some("165"));
    assert_eq!(sim.setting(1, "address"), None);
    known(&mut window, "address");
    assert!(shows(&window, "Address = A5h"));
    let shown = window.state().bench().shown().unwrap();
    assert_eq!(shown.target.address, 165);
    assert!(shows(&window, "PIR-234 @165"));
}

#[test]
fn an_address_that_another_module_has_is_refused_and_says_so() {
    let sim = sim(&["pir-234@1:dcon:9600", "pir-130@5:dcon:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "address");
    type_into(&mut window, "Address", "0x05");
    window.key_press(Key::Enter);
    until(&mut window, "the reason", |window| shows(window, "another module answers at address 5 already"));
    assert_eq!(sim.setting(1, "address").as_deref(), Some("1"));
    assert_eq!(sim.setting(5, "address").as_deref(), Some("5"));
    assert!(window.query_by_role_and_label(Role::ListItem, "PIR-234, address 1").is_some());
}

#[test]
fn an_address_out_of_range_is_not_written() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "address");
    type_into(&mut window, "Address", "256");
    assert!(shows(&window, "Address: use 0 to 255"));
    window.key_press(Key::Enter);
    window.step();
    assert_eq!(sim.setting(1, "address").as_deref(), Some("1"));
}

#[test]
fn the_reset_status_is_read_with_its_button_only_and_cleared_by_that() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "response_delay");
    assert!(shows(&window, "Reset since last read –"));
    click(&mut window, Role::Button, "Read Reset since last read");
    until(&mut window, "yes", |window| shows(window, "Reset since last read yes"));
    click(&mut window, Role::Button, "Read Reset since last read");
    until(&mut window, "no", |window| shows(window, "Reset since last read no"));
}

#[test]
fn the_picture_tells_where_the_switches_stand_at_a_switch_address_and_elsewhere() {
    let sim = sim(&["pir-234@160:modbus_rtu:9600", "pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 160");
    known(&mut window, "pir4_enabled");
    known(&mut window, "do0_source");
    known(&mut window, "protocol");
    for spot in
        ["DIP 1 – Protocol: OFF", "DIP 3 – Address range: OFF", "Rotary switch: 0", "PIR DIP 4 – PIR sensor 4: ON"]
    {
        assert!(shows(&window, spot), "{spot}");
    }
    assert!(shows(&window, "DIP 2 is not told by the settings"));
    click(&mut window, Role::ListItem, "PIR-234, address 1");
    known(&mut window, "protocol");
    assert!(shows(&window, "DIP 2 – Configuration: ON") && shows(&window, "Rotary switch: not known"));
    assert!(shows(&window, "Address 1 cannot come from the switches, so DIP 2 is ON."));
}

#[test]
fn a_module_that_falls_silent_leaves_its_values_and_says_that_they_cannot_be_read() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "response_delay");
    sim.set_dead(1, true);
    type_into(&mut window, "Response delay", "12");
    window.key_press(Key::Enter);
    until(&mut window, "the reason", |window| {
        shows(window, "Response delay: response_delay: it is not known whether the value was taken")
    });
    click(&mut window, Role::Button, "Revert Response delay");
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("0"));
    click(&mut window, Role::Button, "Read Reset since last read");
    until(&mut window, "no answer", |window| shows(window, "Reset since last read: no answer"));
}
