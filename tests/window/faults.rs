//! The panel that lets the simulated line go wrong.

use std::time::Duration;

use dcon_bench::bench::{Action, Presence};
use dcon_bench::bus::Tuning;
use dcon_bench::sim::{FaultKind, Pace, Strength};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

fn show_panel(window: &mut Window) {
    click(window, Role::Button, "Faults…");
    until(window, "the panel", |window| window.query_by_role_and_label(Role::Button, "All off").is_some());
}

#[test]
fn a_fault_is_switched_on_and_off_at_once_and_the_status_bar_counts() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    assert!(window.query_by_role_and_label(Role::Button, "Faults…").is_none());
    open(&mut window, "PIR-234, address 1");
    show_panel(&mut window);
    for kind in FaultKind::ALL {
        assert!(window.query_by_role_and_label(Role::CheckBox, kind.label()).is_some(), "{kind:?}");
    }
    click(&mut window, Role::CheckBox, FaultKind::Late.label());
    assert_eq!(sim.faults().get(FaultKind::Late), Some(FaultKind::Late.default_strength()));
    assert!(shows(&window, "1 fault on"));
    click(&mut window, Role::CheckBox, FaultKind::Twin.label());
    window.step();
    assert!(shows(&window, "2 faults on"));
    click(&mut window, Role::CheckBox, FaultKind::Late.label());
    assert_eq!(sim.faults().iter().map(|fault| fault.kind).collect::<Vec<_>>(), [FaultKind::Twin]);
    click(&mut window, Role::Button, "All off");
    assert_eq!(sim.faults().iter().count(), 0);
    window.step();
    assert!(!shows(&window, "faults on"));
    click(&mut window, Role::Button, "Close faults");
    assert!(window.query_by_role_and_label(Role::Button, "All off").is_none());
}

#[test]
fn the_panel_leaves_the_rest_of_the_window_usable() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    show_panel(&mut window);
    click(&mut window, Role::Button, "Pause polling");
    assert_eq!(window.state().bench().modules()[0].interval, None);
    assert!(window.query_by_role_and_label(Role::Button, "All off").is_some());
}

#[test]
fn a_strength_that_was_chosen_is_used() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    let fault = "late=35%".parse().unwrap();
    let mut faults = window.state().bench().faults().unwrap();
    faults.set(fault).unwrap();
    window.state_mut().apply(Action::SetFaults(faults));
    assert_eq!(sim.faults().get(FaultKind::Late), Some(Strength::Rate(0.35)));
    show_panel(&mut window);
    let field = window.get_by_role_and_label(Role::SpinButton, "Strength of Late answers");
    let percent = field.accesskit_node().numeric_value().unwrap();
    assert!((percent - 35.0).abs() < 1e-9, "{percent}");
}

#[test]
fn a_line_that_a_fault_keeps_closed_can_be_mended_in_the_panel() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut faults = sim.faults();
    faults.switch_on(FaultKind::Twin);
    sim.set_faults(faults);
    sim.unplug();
    let mut window = window(&sim);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "it cannot be opened", |window| shows(window, "No line open"));
    click(&mut window, Role::Button, "1 fault on");
    click(&mut window, Role::CheckBox, FaultKind::Twin.label());
    assert_eq!(sim.faults().iter().count(), 0);
}

#[test]
fn a_line_that_was_unplugged_at_the_start_opens_by_itself_once_it_is_plugged_in() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut faults = sim.faults();
    faults.switch_on(FaultKind::Unplugged);
    sim.set_faults(faults);
    let mut window = window_with(&sim, true, Settings::default());
    until(&mut window, "it cannot be opened", |window| shows(window, "could not be opened"));
    show_panel(&mut window);
    click(&mut window, Role::CheckBox, FaultKind::Unplugged.label());
    until(&mut window, "it is searched", scan_ended);
    assert!(window.state().bench().line().is_open());
    assert_eq!(window.state().bench().modules().len(), 1);
    window.step();
    assert!(!shows(&window, "could not be opened"));
    assert!(window.query_by_role_and_label(Role::Button, "All off").is_some());
    // What the user closed stays closed, and the faults can be reached.
    click(&mut window, Role::Button, "Close line");
    until(&mut window, "it is closed", |window| shows(window, "No line open"));
    assert!(!shows(&window, "could not be opened"));
    click(&mut window, Role::CheckBox, FaultKind::Unplugged.label());
    click(&mut window, Role::CheckBox, FaultKind::Unplugged.label());
    (0..5).for_each(|_| window.step());
    assert!(shows(&window, "No line open"));
    click(&mut window, Role::Button, "Close faults");
    show_panel(&mut window);
}

#[test]
fn esc_closes_the_panel_unless_a_field_elsewhere_or_a_menu_is_to_hear_it() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    let is_open = |window: &Window| window.query_by_role_and_label(Role::Button, "All off").is_some();
    show_panel(&mut window);
    window.key_press(Key::Escape);
    until(&mut window, "it closes", |window| !is_open(window));
    show_panel(&mut window);
    click(&mut window, Role::Button, "Menu");
    window.key_press(Key::Escape);
    (0..3).for_each(|_| window.step());
    assert!(is_open(&window));
    window.key_press(Key::Escape);
    until(&mut window, "it closes", |window| !is_open(window));
}

#[test]
fn the_panel_opens_at_the_right_edge_below_the_top_bar() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    show_panel(&mut window);
    (0..3).for_each(|_| window.step());
    let close = window.get_by_role_and_label(Role::Button, "Close faults").rect();
    let menu = window.get_by_role_and_label(Role::Button, "Menu").rect();
    assert!(close.right() > 1220.0, "{close:?}");
    let first = window.get_by_role_and_label(Role::CheckBox, FaultKind::ALL[0].label()).rect();
    assert!(first.top() > menu.bottom() && first.left() > 800.0, "{first:?}");
}

#[test]
fn the_panel_is_moved_by_its_title_and_opens_again_where_it_was_left() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    show_panel(&mut window);
    (0..3).for_each(|_| window.step());
    let place = |window: &Window| window.get_by_label("Faults of the simulated line").rect().left_center();
    let (before, by) = (place(&window), vec2(-200.0, 20.0));
    let hold = before + vec2(10.0, 0.0);
    window.drag_at(hold);
    window.step();
    window.hover_at(hold + by / 2.0);
    window.step();
    window.hover_at(hold + by);
    window.step();
    window.drop_at(hold + by);
    (0..2).for_each(|_| window.step());
    let moved = place(&window);
    assert!((moved - before - by).length() < 2.0, "{before} to {moved}");
    window.key_press(Key::Escape);
    (0..2).for_each(|_| window.step());
    show_panel(&mut window);
    window.step();
    assert_eq!(place(&window), moved);
}

#[test]
fn answers_that_cannot_be_used_are_told_once_in_full() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "a value", |window| reading(window, "Temperature").is_some_and(|text| text.ends_with("°C")));
    let mut faults = sim.faults();
    faults.set("wrong_checksum=100%".parse().unwrap()).unwrap();
    sim.set_faults(faults);
    until(&mut window, "the list says it", |window| {
        let modules = window.state().bench().modules();
        modules.iter().any(|module| matches!(&module.presence, Presence::Silent { failure } if failure.is_garbage()))
    });
    window.step();
    let bench = window.state().bench();
    let Presence::Silent { failure } = &bench.modules()[0].presence else { panic!("it answers") };
    let failure = failure.to_string();
    assert_eq!(window.query_all_by_label_contains(&failure).count(), 1, "{failure}");
    assert!(!shows(&window, "silent"));
}

#[test]
fn timeout_and_repeats_stand_in_the_menu_and_are_in_force_from_the_start() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let settings = Settings { line: LineChoice::Simulated, timeout_ms: 450, repeats: 0, ..Settings::default() };
    let mut window = window_with(&sim, false, settings);
    let expected = Tuning { timeout: Duration::from_millis(450), repeats: 0 };
    assert_eq!(window.state().bench().tuning(), expected);
    click(&mut window, Role::Button, "Menu");
    for name in ["Timeout", "Repeats"] {
        assert!(window.query_by_role_and_label(Role::SpinButton, name).is_some(), "{name}");
    }
    window.state_mut().apply(Action::Tune(Tuning { timeout: Duration::ZERO, repeats: 99 }));
    assert_eq!(window.state().bench().tuning(), Tuning { timeout: Duration::from_millis(20), repeats: 5 });
}
