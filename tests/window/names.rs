//! What assistive technology is told: every control on every tab has a name, and a value where it has one.

use dcon_bench::bench::{Action, tab_label};
use dcon_bench::mimic::{Mimic, MimicSpec};
use dcon_bench::module::Catalogue;
use dcon_bench::sim::{Pace, Sim};
use eframe::egui::accesskit::{Action as Does, Role};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

/// Controls without a name, or without the value that they show, each with its place in points.
fn nameless(window: &Window) -> Vec<String> {
    let mut found = Vec::new();
    let mut waiting = vec![window.kittest_state().root()];
    while let Some(node) = waiting.pop() {
        waiting.extend(node.children());
        let is_control = matches!(
            node.role(),
            Role::Button
                | Role::CheckBox
                | Role::RadioButton
                | Role::ComboBox
                | Role::TextInput
                | Role::MultilineTextInput
                | Role::SpinButton
                | Role::Slider
                | Role::MenuItem
                | Role::ListItem
                | Role::Row
                | Role::Tab
                | Role::Link
                | Role::Image
                | Role::ProgressIndicator
        ) || (node.role() == Role::Unknown && node.data().supports_action(Does::Click));
        // Edges of columns are for the pointer only, and not drawn by this program.
        let is_edge = node.role() == Role::Unknown && node.bounding_box().is_some_and(|place| place.width() < 8.0);
        if !is_control || node.is_hidden() || is_edge {
            continue;
        }
        let name = node.label().unwrap_or_default();
        // A mark such as "×" is no name: it is not spoken.
        let has_name = name.chars().any(char::is_alphanumeric);
        let has_value = match node.role() {
            Role::ComboBox | Role::TextInput | Role::MultilineTextInput => node.value().is_some(),
            Role::SpinButton | Role::Slider | Role::ProgressIndicator => {
                node.numeric_value().is_some() || node.value().is_some()
            }
            _ => true,
        };
        if !has_name || !has_value {
            let place = node.bounding_box().map(|place| (place.x0 as i32, place.y0 as i32, place.x1 as i32));
            found.push(format!("{:?} \"{name}\" {:?} at {place:?}", node.role(), node.value()));
        }
    }
    found.sort();
    found
}

#[track_caller]
fn all_named(window: &mut Window, place: &str) {
    window.step();
    let nameless = nameless(window);
    assert!(nameless.is_empty(), "{place}:\n{}", nameless.join("\n"));
}

/// Opens a module at each of its tabs.
#[track_caller]
fn through_all_tabs(sim: &Sim, module: &str) {
    let mut window = window(sim);
    open(&mut window, module);
    until(&mut window, "its tabs", |window| window.query_by_role_and_label(Role::Tab, "Summary").is_some());
    let definition = window.state().bench().shown().unwrap().definition().unwrap().clone();
    let mut tabs: Vec<String> = vec!["Commands".to_owned(), "Log".to_owned(), "Summary".to_owned()];
    for item in &definition.items {
        let label = tab_label(&item.tab).to_owned();
        if !tabs.contains(&label) {
            tabs.push(label);
        }
    }
    for tab in tabs {
        if window.query_by_role_and_label(Role::Tab, &tab).is_none() {
            continue;
        }
        click(&mut window, Role::Tab, &tab);
        until(&mut window, "nothing is being read", |window| {
            let module = window.state().bench().shown().unwrap();
            !module.definition().unwrap().items.iter().any(|item| module.is_being_read(&item.id))
        });
        all_named(&mut window, &tab);
    }
    // What waits to be written has buttons of its own.
    let target = window.state().bench().shown().unwrap().target;
    click(&mut window, Role::Tab, "Configuration");
    for (id, text) in [("response_delay", "7"), ("address", "9"), ("address", "900")] {
        window.state_mut().apply(Action::Stage(target, id.to_owned(), text.to_owned()));
        all_named(&mut window, "with changes");
    }
}

#[test]
fn every_control_of_every_tab_of_a_pir_234_has_a_name() {
    through_all_tabs(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip), "PIR-234, address 1");
}

#[test]
fn every_control_of_every_tab_of_a_pir_130_has_a_name() {
    through_all_tabs(&sim(&["pir-130@0xA0:dcon:9600"], Pace::Skip), "PIR-130, address 160");
}

#[test]
fn every_control_of_every_tab_of_a_generic_module_has_a_name() {
    let spec: MimicSpec = "dl-302@1:modbus_rtu:9600".parse().unwrap();
    let definition = spec.definition(&Catalogue::built_in().0, &[]).unwrap();
    let sim = sim(&[], Pace::Skip);
    sim.join(Box::new(Mimic::new(definition, spec.placing)));
    through_all_tabs(&sim, "DL-302, address 1");
}

#[test]
fn every_control_of_the_other_tabs_has_a_name() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600", "unknown@160:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    all_named(&mut window, "before the first scan");
    open(&mut window, "PIR-234, address 1");
    for tab in ["Traffic", "Trends", "Diagnosis"] {
        click(&mut window, Role::Button, tab);
        all_named(&mut window, tab);
    }
    click(&mut window, Role::ListItem, "unknown, address 160");
    all_named(&mut window, "an unknown module");
    window.key_press_modifiers(eframe::egui::Modifiers::COMMAND, eframe::egui::Key::D);
    window.step();
    all_named(&mut window, "the dashboard");
}

#[test]
fn every_control_of_menus_and_forms_has_a_name() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    for menu in ["Menu", "Scan options"] {
        click(&mut window, Role::Button, menu);
        all_named(&mut window, menu);
        window.key_press(eframe::egui::Key::Escape);
        window.step();
    }
    click(&mut window, Role::ComboBox, "Line");
    all_named(&mut window, "the list of lines");
    window.key_press(eframe::egui::Key::Escape);
    window.step();
    click(&mut window, Role::Button, "Scan options");
    click(&mut window, Role::MenuItem, "Custom…");
    all_named(&mut window, "the form of a scan");
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Button, "Faults…");
    all_named(&mut window, "the faults");
    window.key_press(eframe::egui::Key::Escape);
    window.key_press_modifiers(eframe::egui::Modifiers::COMMAND, eframe::egui::Key::D);
    window.step();
    click(&mut window, Role::Button, "Poll plan…");
    all_named(&mut window, "the poll plan");
}
