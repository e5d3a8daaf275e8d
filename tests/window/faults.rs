//! The panel that lets the simulated line go wrong.

use std::time::Duration;

use dcon_bench::bench::Action;
use dcon_bench::bus::Tuning;
use dcon_bench::sim::{FaultKind, Pace, Strength};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::accesskit::Role;
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
