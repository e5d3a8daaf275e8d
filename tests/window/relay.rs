//! PIR / Relay: zones, relays and their settings.

use dcon_bench::bench::Action;
use dcon_bench::sim::{Pace, Sim};
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

const MODBUS: &str = "pir-234@1:modbus_rtu:9600";
const DCON: &str = "pir-234@1:dcon:9600";

/// The module at its tab PIR / Relay, with nobody in front of it.
fn at_the_relays(spec: &str, module: &str) -> (Sim, Window) {
    let sim = sim(&[spec], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, module);
    click(&mut window, Role::Tab, "PIR / Relay");
    (sim, window)
}

fn set(window: &mut Window, id: &str, value: &str) {
    let target = window.state().bench().shown().unwrap().target;
    window.state_mut().apply(Action::Set(target, id.to_owned(), value.to_owned()));
}

fn holds(sim: &Sim, id: &str, value: &str) -> bool {
    sim.setting(1, id).as_deref() == Some(value)
}

fn is_disabled(window: &Window, role: Role, label: &str) -> bool {
    window.get_by_role_and_label(role, label).accesskit_node().is_disabled()
}

/// Clicks the relay and waits until the module and then the window say that it is switched.
#[track_caller]
fn switch_to(sim: &Sim, window: &mut Window, relay: &str, id: &str, on: bool) {
    click(window, Role::Switch, relay);
    until(window, "the module has switched", |_| holds(sim, id, &on.to_string()));
    let word = if on { "ON" } else { "OFF" };
    until(window, "the switch shows it", |window| {
        let switch = window.get_by_role_and_label(Role::Switch, relay);
        switch.value().as_deref() == Some(word) && !is_disabled(window, Role::Switch, relay)
    });
}

#[test]
fn a_relay_that_follows_the_sensors_says_so_and_is_switched_once_commands_may() {
    for spec in [MODBUS, DCON] {
        let (sim, mut window) = at_the_relays(spec, "PIR-234, address 1");
        until(&mut window, "the reason", |window| shows(window, "DO0: Follows PIR: commands are refused"));
        assert!(is_disabled(&window, Role::Switch, "DO0"), "{spec}");
        click(&mut window, Role::Button, "Let commands switch DO0");
        until(&mut window, "the way out", |window| shows(window, "DO0: Follows commands"));
        assert!(holds(&sim, "do0_source", "command") && holds(&sim, "do1_source", "pir"), "{spec}");
        set(&mut window, "do0", "false");
        until(&mut window, "it is off", |window| {
            let written = window.state().bench().shown().unwrap().edits.is_empty();
            written && window.get_by_role_and_label(Role::Switch, "DO0").value().as_deref() == Some("OFF")
        });
        switch_to(&sim, &mut window, "DO0", "do0", true);
        switch_to(&sim, &mut window, "DO0", "do0", false);
        assert!(window.state().bench().shown().unwrap().edits.is_empty());
    }
}

#[test]
fn a_relay_that_does_not_answer_says_that_it_was_not_switched() {
    let (sim, mut window) = at_the_relays(DCON, "PIR-234, address 1");
    set(&mut window, "do1_source", "command");
    until(&mut window, "it follows commands", |window| shows(window, "DO1: Follows commands"));
    let before = sim.setting(1, "do1");
    sim.set_dead(1, true);
    click(&mut window, Role::Switch, "DO1");
    until(&mut window, "the refusal", |window| shows(window, "DO1: Not switched:"));
    assert_eq!(sim.setting(1, "do1"), before);
    click(&mut window, Role::Button, "Dismiss DO1");
    assert!(window.state().bench().shown().unwrap().edits.is_empty());
}

#[test]
fn zones_light_where_there_is_motion() {
    let (sim, mut window) = at_the_relays(MODBUS, "PIR-234, address 1");
    sim.set_motion(1, 0, false);
    until(&mut window, "all are quiet", |window| {
        (1..=4).all(|zone| shows(window, &format!("PIR {zone}: Detects no motion.")))
    });
    sim.set_motion(1, 2, true);
    until(&mut window, "one lights", |window| shows(window, "PIR 2: Detects motion."));
    assert!(shows(&window, "PIR 1: Detects no motion."));
    assert!(shows(&window, "PIR 2 motion"));
    until(&mut window, "it is counted", |window| shows(window, "PIR sensor 2 in the last hour: motion once"));
}

#[test]
fn over_dcon_only_any_sensor_is_told() {
    let (sim, mut window) = at_the_relays(DCON, "PIR-234, address 1");
    sim.set_motion(1, 0, false);
    until(&mut window, "quiet", |window| shows(window, "any sensor: quiet"));
    sim.set_motion(1, 3, true);
    until(&mut window, "motion", |window| shows(window, "any sensor: motion"));
    assert!(shows(&window, "PIR 3: Not known."));
}

#[test]
fn a_click_on_a_zone_is_written_with_the_other_changes() {
    for spec in [MODBUS, DCON] {
        let (sim, mut window) = at_the_relays(spec, "PIR-234, address 1");
        sim.set_motion(1, 0, false);
        let zone = if spec == DCON { "PIR 3: Not known." } else { "PIR 3: Detects no motion." };
        until(&mut window, "the enables", |window| {
            window.state().bench().shown().unwrap().known("pir3_enabled").is_some()
        });
        click(&mut window, Role::Button, zone);
        assert!(holds(&sim, "pir3_enabled", "true"));
        click(&mut window, Role::Button, "Write 1");
        until(&mut window, "it is written", |_| holds(&sim, "pir3_enabled", "false"));
        until(&mut window, "the zone is off", |window| shows(window, "PIR 3: Disabled"));
        assert!(holds(&sim, "pir2_enabled", "true"));
    }
}

#[test]
fn the_on_time_is_chosen_in_seconds_and_minutes() {
    let (sim, mut window) = at_the_relays(MODBUS, "PIR-234, address 1");
    until(&mut window, "the time", |window| {
        let combo = window.get_by_role_and_label(Role::ComboBox, "PIR output ON time");
        combo.value().as_deref() == Some("6 s")
    });
    window.get_by_role_and_label(Role::ComboBox, "PIR output ON time").scroll_to_me();
    window.step();
    window.step();
    click(&mut window, Role::ComboBox, "PIR output ON time");
    click(&mut window, Role::Button, "131 s (2 min 11 s)");
    assert!(holds(&sim, "pir_on_time", "6"));
    click(&mut window, Role::Button, "Write 1");
    until(&mut window, "it is written", |_| holds(&sim, "pir_on_time", "131"));
}

#[test]
fn a_tripped_watchdog_holds_the_relay_until_it_is_cleared() {
    for spec in [MODBUS, DCON] {
        let (sim, mut window) = at_the_relays(spec, "PIR-234, address 1");
        set(&mut window, "do0_source", "command");
        until(&mut window, "it follows commands", |window| shows(window, "DO0: Follows commands"));
        set(&mut window, "do0", "false");
        set(&mut window, "wdt_timeout", "0.5");
        set(&mut window, "wdt_enabled", "true");
        until(&mut window, "both are written", |window| window.state().bench().shown().unwrap().edits.is_empty());
        sim.advance(std::time::Duration::from_secs(2));
        until(&mut window, "the reason", |window| shows(window, "the host watchdog has tripped"));
        assert!(is_disabled(&window, Role::Switch, "DO0"));
        click(&mut window, Role::Button, "Clear host watchdog");
        until(&mut window, "it is free", |window| shows(window, "DO0: Follows commands"));
        assert!(holds(&sim, "wdt_tripped", "false"), "{spec}");
        switch_to(&sim, &mut window, "DO0", "do0", true);
    }
}

#[test]
fn a_low_active_state_is_said_to_invert() {
    let (sim, mut window) = at_the_relays(DCON, "PIR-234, address 1");
    set(&mut window, "output_active_state", "low");
    until(&mut window, "it is written", |_| holds(&sim, "output_active_state", "low"));
    until(&mut window, "it is said", |window| shows(window, "(inverted)"));
}

#[test]
fn a_pir_130_has_one_zone_and_a_relay_that_motion_switches() {
    let (sim, mut window) = at_the_relays("pir-130@1:dcon:9600", "PIR-130, address 1");
    sim.set_motion(1, 0, false);
    until(&mut window, "quiet", |window| shows(window, "PIR: Detects no motion."));
    sim.set_motion(1, 0, true);
    until(&mut window, "motion", |window| shows(window, "PIR: Detects motion."));
    until(&mut window, "how it is switched", |window| shows(window, "Read only: motion switches it on for 6 s"));
    assert!(is_disabled(&window, Role::Switch, "Relay output"));
    until(&mut window, "the relay", |window| {
        window.get_by_role_and_label(Role::Switch, "Relay output").value().as_deref() == Some("ON")
    });
    for label in ["Sensitivity", "Lux level", "PIR active delay", "Buzzer on PIR"] {
        assert!(shows(&window, label), "{label}");
    }
    assert!(window.query_by_role_and_label(Role::Switch, "DO0").is_none());
    until(&mut window, "the sensitivity", |window| {
        window
            .query_by_role_and_label(Role::Slider, "Sensitivity slider")
            .is_some_and(|slider| !slider.accesskit_node().is_disabled())
    });
    set(&mut window, "sensitivity", "7");
    until(&mut window, "it is written", |_| holds(&sim, "sensitivity", "7"));
}
