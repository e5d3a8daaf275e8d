//! Summary: everything on one page, compared with factory settings.

use dcon_bench::bench::Action;
use dcon_bench::sim::{Pace, Sim, TcpServer};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::OutputCommand;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::harness::*;

const PIR_234: &str = "pir-234@1:modbus_rtu:9600";

fn at_the_summary(spec: &str, module: &str) -> (Sim, Window) {
    let sim = sim(&[spec], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, module);
    click(&mut window, Role::Tab, "Summary");
    (sim, window)
}

/// What the row of this name says.
fn row(window: &Window, name: &str) -> Option<String> {
    let start = format!("{name}: ");
    let mut labels = window.query_all_by_label_contains(&start).filter_map(|node| node.value());
    // The facts above the table have names too.
    labels.rfind(|label| label.starts_with(&start))
}

#[track_caller]
fn until_row(window: &mut Window, name: &str, says: impl Fn(&str) -> bool) -> String {
    let last = std::cell::RefCell::new(None);
    until(window, name, |window| {
        last.replace(row(window, name));
        last.borrow().as_deref().is_some_and(&says)
    });
    last.into_inner().unwrap_or_default()
}

#[test]
fn every_value_of_the_module_is_on_the_page() {
    let (sim, mut window) = at_the_summary(PIR_234, "PIR-234, address 1");
    until_row(&mut window, "Address", |text| text.starts_with("Address: 1, factory 1, "));
    let module = window.state().bench().shown().unwrap();
    let known = |window: &Window, id: &str| window.state().bench().shown().unwrap().known(id).is_some();
    let ids: Vec<(String, String)> = module
        .definition()
        .unwrap()
        .items
        .iter()
        .filter(|item| module.has(item) && !item.on_request)
        .map(|item| (item.id.clone(), item.label.clone()))
        .collect();
    assert!(ids.len() > 30);
    until(&mut window, "all values", |window| ids.iter().all(|(id, _)| known(window, id)));
    window.step();
    for (id, label) in &ids {
        let text = row(&window, label).unwrap_or_else(|| panic!("no row {label}"));
        assert!(!text.contains(": –"), "{id}: {text}");
    }
    let limit = sim.setting(1, "alarm_limit").unwrap();
    let label = &ids.iter().find(|(id, _)| id == "alarm_limit").unwrap().1;
    assert!(row(&window, label).unwrap().contains(&limit));
    assert!(shows(&window, "PIR-234 Series User Manual"));
}

#[test]
fn what_was_changed_differs_from_factory_and_is_found_by_the_filter() {
    let (sim, mut window) = at_the_summary(PIR_234, "PIR-234, address 1");
    let label = window.state().bench().shown().unwrap().item("pir_on_time").unwrap().label.clone();
    let target = window.state().bench().shown().unwrap().target;
    until_row(&mut window, &label, |text| text.contains(": 6 s, factory 6, ") && text.ends_with(" ago"));
    assert!(!row(&window, &label).unwrap().contains("differs"));
    window.state_mut().apply(Action::Set(target, "pir_on_time".to_owned(), "33".to_owned()));
    until_row(&mut window, &label, |text| text.contains(": 33 s, factory 6, differs from factory"));
    assert_eq!(sim.setting(1, "pir_on_time").as_deref(), Some("33"));
    let of_factory = "Address";
    assert!(row(&window, of_factory).is_some());
    click(&mut window, Role::CheckBox, "Only what differs from factory");
    assert!(row(&window, &label).is_some());
    assert!(row(&window, of_factory).is_none());
    click(&mut window, Role::CheckBox, "Only what differs from factory");
    assert!(row(&window, of_factory).is_some());
}

#[test]
fn read_again_brings_what_the_module_holds_now() {
    let (sim, mut window) = at_the_summary(PIR_234, "PIR-234, address 1");
    sim.set_temperature(1, 21.5);
    until_row(&mut window, "Temperature", |text| text == "Temperature: 21.50 °C, polled");
    click(&mut window, Role::Button, "Pause polling");
    until_row(&mut window, "Temperature", |text| text.ends_with(" ago"));
    sim.set_temperature(1, 30.0);
    until(&mut window, "nothing is being read", |window| {
        !window.state().bench().shown().unwrap().is_being_read("address")
    });
    window.step();
    click(&mut window, Role::Button, "Read again");
    until_row(&mut window, "Temperature", |text| text.starts_with("Temperature: 30.00 °C, "));
}

#[test]
fn the_text_is_put_on_the_clipboard() {
    let (_sim, mut window) = at_the_summary(PIR_234, "PIR-234, address 1");
    until_row(&mut window, "Address", |text| text.starts_with("Address: 1, factory 1, "));
    window.get_by_role_and_label(Role::Button, "Copy as text").click();
    window.step();
    let commands = &window.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let text = copied.expect("a text on the clipboard");
    assert!(text.starts_with("PIR-234 at address 1 (01h)"), "{text}");
    assert!(text.lines().any(|line| line.starts_with("Configuration ") && line.ends_with(" Read")), "{text}");
    assert!(window.state().bench().notices().any(|notice| notice.text == "The summary was copied as text"));
}

#[test]
fn what_was_not_read_is_a_dash_with_its_reason() {
    let sim = sim(&[PIR_234], Pace::Skip);
    let mut window = window(&sim);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    sim.set_dead(1, true);
    click(&mut window, Role::ListItem, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Summary");
    let text = until_row(&mut window, "Address", |text| text.contains("no answer"));
    assert!(text.starts_with("Address: –, factory 1"), "{text}");
    sim.set_dead(1, false);
    until(&mut window, "nothing is being read", |window| {
        !window.state().bench().shown().unwrap().is_being_read("address")
    });
    window.step();
    click(&mut window, Role::Button, "Read again");
    until_row(&mut window, "Address", |text| text.starts_with("Address: 1,"));
}

#[test]
fn a_change_that_is_not_written_does_not_pass_for_the_modules_value() {
    let (_sim, mut window) = at_the_summary(PIR_234, "PIR-234, address 1");
    let label = window.state().bench().shown().unwrap().item("pir_on_time").unwrap().label.clone();
    let before = until_row(&mut window, &label, |text| text.contains("ago"));
    let target = window.state().bench().shown().unwrap().target;
    window.state_mut().apply(Action::Stage(target, "pir_on_time".to_owned(), "4194".to_owned()));
    let text = until_row(&mut window, &label, |text| text.contains("changed, not written"));
    assert!(!text.contains("4194"), "{text}");
    assert_eq!(text.split(',').next(), before.split(',').next());
}

#[test]
fn a_pir_130_over_dcon_has_its_settings_switches_and_sensor() {
    let (_sim, mut window) = at_the_summary("pir-130@0xA0:dcon:9600", "PIR-130, address 160");
    until_row(&mut window, "Address", |text| text.starts_with("Address: 160, factory 1, differs"));
    for picture in ["Switches", "Sensor"] {
        assert!(window.query_by_role_and_label(Role::Image, picture).is_some(), "{picture}");
    }
    for fact in ["Reached by: DCON 9600 N81", "Group PIR / Relay"] {
        assert!(shows(&window, fact), "{fact}");
    }
    assert!(!shows(&window, "Group Host WDT"));
}

#[test]
fn over_tcp_the_network_is_on_the_page_too() {
    let sim = sim(&["pir-234@1"], Pace::Real);
    let server = TcpServer::bind(&sim, "127.0.0.1:0".parse().unwrap()).unwrap();
    let settings = Settings { line: LineChoice::Tcp, host: server.address().to_string(), ..Settings::default() };
    let mut window = window_with(&sim, false, settings);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Summary");
    assert!(shows(&window, "Group Network") && shows(&window, "Reached by: Modbus TCP"));
    let label = window.state().bench().shown().unwrap().item("tcp_idle_timeout").unwrap().label.clone();
    until_row(&mut window, &label, |text| text.contains("ago"));
}
