//! Lines of a form by keyboard, and what becomes of values when the line or the module changes.

use dcon_bench::bench::{Action, ItemState};
use dcon_bench::sim::Pace;
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

const RTU: &str = "pir-234@1:modbus_rtu:9600";

fn at(tab: &str, sim: &dcon_bench::sim::Sim) -> Window {
    let settings = Settings { line: LineChoice::Simulated, tab: tab.to_owned(), ..Settings::default() };
    let mut window = window_with(sim, false, settings);
    open(&mut window, "PIR-234, address 1");
    window
}

fn state_is(window: &Window, id: &str, wanted: fn(&ItemState<'_>) -> bool) -> bool {
    window.state().bench().shown().is_some_and(|module| wanted(&module.state(id)))
}

fn known(window: &mut Window, id: &'static str) {
    until(window, id, |window| state_is(window, id, |state| matches!(state, ItemState::Current(_))));
}

#[track_caller]
fn focus(window: &mut Window, role: Role, label: &str) {
    until(window, label, |window| window.query_by_role_and_label(role, label).is_some());
    window.get_by_role_and_label(role, label).focus();
    window.step();
}

#[test]
fn space_changes_a_checkbox_and_enter_writes_it() {
    let sim = sim(&[RTU], Pace::Skip);
    let mut window = at("pir", &sim);
    known(&mut window, "pir2_enabled");
    focus(&mut window, Role::CheckBox, "PIR sensor 2 enabled");
    window.key_press(Key::Space);
    window.step();
    window.step();
    assert!(state_is(&window, "pir2_enabled", |state| *state == ItemState::Edited));
    assert_eq!(sim.setting(1, "pir2_enabled").as_deref(), Some("true"), "not written yet");
    window.key_press(Key::Enter);
    until(&mut window, "it is written", |_| sim.setting(1, "pir2_enabled").as_deref() == Some("false"));
    known(&mut window, "pir2_enabled");
}

#[test]
fn all_changes_are_written_with_their_shortcut() {
    let sim = sim(&[RTU], Pace::Skip);
    let mut window = at("pir", &sim);
    known(&mut window, "pir2_enabled");
    let target = window.state().bench().shown().unwrap().target;
    for (id, value) in [("pir2_enabled", "false"), ("pir_active_delay", "250")] {
        window.state_mut().apply(Action::Stage(target, id.to_owned(), value.to_owned()));
    }
    window.step();
    focus(&mut window, Role::CheckBox, "PIR sensor 2 enabled");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    until(&mut window, "both are written", |_| {
        sim.setting(1, "pir2_enabled").as_deref() == Some("false")
            && sim.setting(1, "pir_active_delay").as_deref() == Some("250")
    });
}

#[test]
fn an_open_tab_is_read_again_on_a_line_that_was_opened_anew() {
    let sim = sim(&[RTU], Pace::Skip);
    let mut window = at("configuration", &sim);
    known(&mut window, "response_delay");
    window.state_mut().apply(Action::Disconnect);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the module is there again", |window| window.state().bench().modules().len() == 1);
    until(&mut window, "the scan ends", scan_ended);
    known_of_the_first(&mut window, "response_delay");
}

fn known_of_the_first(window: &mut Window, id: &'static str) {
    until(window, id, |window| {
        let module = window.state().bench().modules().first();
        module.is_some_and(|module| matches!(module.state(id), ItemState::Current(_)))
    });
}

#[test]
fn what_could_not_be_read_on_a_lost_line_is_read_when_it_returns() {
    let sim = sim(&[RTU], Pace::Skip);
    let mut window = at("ai", &sim);
    known(&mut window, "temperature_offset");
    sim.unplug();
    until(&mut window, "the loss", |window| shows(window, "Simulated line lost"));
    click(&mut window, Role::Tab, "Configuration");
    until(&mut window, "it cannot be read", |window| {
        state_is(window, "response_delay", |state| matches!(state, ItemState::Unreadable(_)))
    });
    sim.plug();
    until(&mut window, "the return", |window| shows(window, "Simulated line open"));
    known(&mut window, "response_delay");
}

#[test]
fn a_module_of_another_model_at_the_same_address_inherits_nothing() {
    use dcon_bench::bus::{BusEvent, RequestId};
    use dcon_bench::module::{Catalogue, Identified};

    let sim = sim(&[RTU], Pace::Skip);
    let mut window = at("configuration", &sim);
    known(&mut window, "response_delay");
    let target = window.state().bench().shown().unwrap().target;
    window.state_mut().apply(Action::Stage(target, "response_delay".to_owned(), "7".to_owned()));
    let definition = Catalogue::built_in().0.get("pir-130");
    let identified = Identified { definition, name: "PIR130".into(), firmware: String::new(), said: String::new() };
    window.state_mut().take(BusEvent::Found { id: RequestId(u64::MAX), target, identified });
    let module = window.state().bench().module(&target).unwrap();
    assert_eq!(module.label(), "PIR-130");
    assert!(module.edits.is_empty() && module.readings.is_empty() && module.interval.is_none());
}
