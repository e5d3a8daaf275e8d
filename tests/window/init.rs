//! The guided change in INIT mode.

use dcon_bench::bench::{InitStep, ItemState};
use dcon_bench::protocol::Protocol;
use dcon_bench::sim::{Pace, Sim};
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::configuration::{at_configuration, choose, known};
use crate::harness::*;

const DONE: &str = "Done – look for the module";
const SIMULATED: &str = "Do this on the simulated module";

#[track_caller]
fn step(window: &mut Window, step: InitStep) {
    until(window, "the step", |window| window.state().bench().init().is_some_and(|init| init.step == step));
    window.step();
}

/// The guide for DCON at 19200 bps with checksum.
fn guide(sim: &Sim) -> Window {
    let mut window = at_configuration(sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "checksum");
    known(&mut window, "baud_rate");
    choose(&mut window, "Baud rate", "19200");
    click(&mut window, Role::CheckBox, "Checksum");
    assert!(shows(&window, "2 changes are written in INIT mode only"));
    click(&mut window, Role::Button, "Change in INIT mode…");
    step(&mut window, InitStep::SwitchOn);
    window
}

#[test]
fn the_guide_ends_with_the_module_found_at_its_new_settings_and_its_tab_open() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = guide(&sim);
    assert!(shows(&window, "Step 1, now: Set DIP 4 ON"));
    assert!(shows(&window, "Baud rate: from 9600 bps to 19200 bps, not written yet"));
    assert!(shows(&window, "DIP 4 – INIT: ON"));
    click(&mut window, Role::Button, SIMULATED);
    click(&mut window, Role::Button, DONE);
    step(&mut window, InitStep::SwitchOff);
    assert!(shows(&window, "Baud rate: from 9600 bps to 19200 bps, taken"));
    assert!(shows(&window, "Checksum: from off to on, taken"));
    assert_eq!(sim.setting(1, "baud_rate").as_deref(), Some("19200"));
    click(&mut window, Role::Button, SIMULATED);
    click(&mut window, Role::Button, DONE);
    step(&mut window, InitStep::Done);
    assert!(shows(&window, "The module answers with its new settings"));
    click(&mut window, Role::Button, "Finish");
    assert!(window.state().bench().init().is_none());
    let module = window.state().bench().shown().unwrap();
    let target = module.target;
    assert_eq!((target.protocol, target.settings.baud_rate.bps(), target.checksum), (Protocol::Dcon, 19_200, true));
    assert!(module.edits.is_empty() && module.interval.is_some());
    assert_eq!(window.state().bench().modules().len(), 1);
    known(&mut window, "init_mode");
    assert!(shows(&window, "DCON 19200 N81 checksum") && shows(&window, "Communication"));
}

#[test]
fn a_protocol_is_changed_with_the_guide() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "protocol");
    choose(&mut window, "Protocol", "DCON");
    click(&mut window, Role::Button, "Write Protocol");
    step(&mut window, InitStep::SwitchOn);
    for next in [InitStep::SwitchOff, InitStep::Done] {
        click(&mut window, Role::Button, SIMULATED);
        click(&mut window, Role::Button, DONE);
        step(&mut window, next);
    }
    let module = window.state().bench().shown().unwrap();
    assert_eq!(module.target.protocol, Protocol::Dcon);
    click(&mut window, Role::Button, "Finish");
    known(&mut window, "checksum");
}

#[test]
fn a_refusal_while_dip_4_is_off_shows_the_reason_and_leads_back() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = guide(&sim);
    click(&mut window, Role::Button, DONE);
    until(&mut window, "the refusal", |window| shows(window, "Not everything was taken. Check that DIP 4 is ON"));
    assert!(shows(&window, "baud_rate was refused") && shows(&window, "only in INIT mode"));
    assert!(shows(&window, "Baud rate, Checksum: was refused"));
    assert!(shows(&window, "Step 1, now"));
    assert_eq!(sim.setting(1, "baud_rate").as_deref(), Some("9600"));
    click(&mut window, Role::Button, SIMULATED);
    click(&mut window, Role::Button, DONE);
    step(&mut window, InitStep::SwitchOff);
    assert_eq!(sim.setting(1, "checksum").as_deref(), Some("true"));
}

#[test]
fn leaving_the_guide_keeps_the_changes() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = guide(&sim);
    click(&mut window, Role::Button, "Leave");
    assert!(window.state().bench().init().is_none());
    let module = window.state().bench().shown().unwrap();
    assert_eq!(module.state("baud_rate"), ItemState::Edited);
    assert!(window.query_by_role_and_label(Role::Button, "Change in INIT mode…").is_some());
}

#[test]
fn a_silent_module_is_looked_for_until_the_user_goes_back() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = guide(&sim);
    sim.set_dead(1, true);
    click(&mut window, Role::Button, DONE);
    until(&mut window, "what to check", |window| shows(window, "Still looking – check DIP 4 (ON)"));
    click(&mut window, Role::Button, "Back");
    step(&mut window, InitStep::SwitchOn);
    sim.set_dead(1, false);
    click(&mut window, Role::Button, SIMULATED);
    click(&mut window, Role::Button, DONE);
    step(&mut window, InitStep::SwitchOff);
}

#[test]
fn a_lost_line_is_said_in_the_guide() {
    let sim = sim(&["pir-234@1:dcon:9600"], Pace::Skip);
    let mut window = guide(&sim);
    sim.unplug();
    until(&mut window, "the loss", |window| shows(window, "Simulated line is gone"));
    step(&mut window, InitStep::SwitchOn);
    sim.plug();
    until(&mut window, "the return", |window| window.state().bench().line().is_open());
    click(&mut window, Role::Button, SIMULATED);
    click(&mut window, Role::Button, DONE);
    step(&mut window, InitStep::SwitchOff);
}
