//! The window as a whole: line, scan, list, readings, plot, notices.

use dcon_bench::bench::{Action, LineState, Presence, ScanState, Severity};
use dcon_bench::module::Catalogue;
use dcon_bench::sim::{Pace, TcpServer};
use dcon_bench::ui::{LineChoice, RecentLine, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{self, vec2};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

#[test]
fn scan_then_click_then_see_the_readings_change_and_the_plot_fill() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    assert!(window.query_by_role_and_label(Role::ListItem, "PIR-130, address 160").is_some());
    sim.set_temperature(1, 21.5);
    until(&mut window, "the first value", |window| reading(window, "Temperature").as_deref() == Some("21.50 °C"));
    sim.set_temperature(1, -3.25);
    until(&mut window, "the next value", |window| reading(window, "Temperature").as_deref() == Some("-3.25 °C"));
    let shown = window.state().bench().shown().unwrap();
    let history = window.state().bench().history();
    assert!(shown.trend(history, "temperature_c").unwrap().len() >= 2);
    assert!(window.query_by_label("Plot").is_some());
}

#[test]
fn a_silent_module_keeps_its_values_and_says_so() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    sim.set_temperature(1, 21.5);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "a value", |window| {
        reading(window, "Temperature").is_some_and(|text| text.starts_with("21.50"))
    });
    sim.set_dead(1, true);
    let silent = |window: &Window| {
        let module = window.state().bench().shown();
        module.is_some_and(|module| matches!(module.presence, Presence::Silent { .. }))
    };
    until(&mut window, "it is silent", silent);
    until(&mut window, "the value is old", |window| {
        reading(window, "Temperature").is_some_and(|text| text.starts_with("21.50 °C, ") && text.ends_with(" old"))
    });
    assert!(shows(&window, "no answer"));
    sim.set_dead(1, false);
    until(&mut window, "it is fresh again", |window| reading(window, "Temperature").as_deref() == Some("21.50 °C"));
}

#[test]
fn a_value_that_was_never_read_is_a_dash() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    sim.set_dead(1, true);
    click(&mut window, Role::ListItem, "PIR-234, address 1");
    until(&mut window, "a dash", |window| reading(window, "Temperature").as_deref() == Some("– °C, not known"));
}

#[test]
fn a_port_that_cannot_be_opened_is_explained_until_acknowledged() {
    let line = LineChoice::Port("/dev/no-such-port".to_owned());
    let mut window = window_with(&sim(&[], Pace::Skip), false, Settings { line, ..Settings::default() });
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the sentence", |window| shows(window, "There is no port /dev/no-such-port"));
    assert!(matches!(window.state().bench().line(), LineState::Closed));
    assert!(shows(&window, "No line open"));
    click(&mut window, Role::Button, "Dismiss");
    assert!(window.query_by_label("Dismiss").is_none());
    assert!(shows(&window, "Notices"));
}

#[test]
fn a_newer_notice_moves_none_in_the_open_list_until_it_is_asked_for() {
    let mut window = window(&sim(&[], Pace::Skip));
    let notify = |window: &mut Window, text: &str| {
        window.state_mut().apply(Action::Notify(Severity::Info, text.to_owned()));
        (0..3).for_each(|_| window.step());
    };
    notify(&mut window, "the first");
    notify(&mut window, "the second");
    click(&mut window, Role::Button, "Notices");
    window.step();
    let place = |window: &Window| window.get_by_label("the first").rect();
    let before = place(&window);
    notify(&mut window, "the third");
    assert_eq!(place(&window), before);
    assert!(window.query_by_label("the third").is_none());
    click(&mut window, Role::Button, "Show 1 newer");
    assert!(window.query_by_label("the third").is_some());
}

#[test]
fn without_a_port_the_window_offers_the_simulated_line() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window_with(&sim, false, Settings::default());
    until(&mut window, "the ports are known", |window| !window.state().bench().is_looking_for_ports());
    if !window.state().bench().ports().is_empty() {
        return;
    }
    window.step();
    assert!(shows(&window, "There is no serial port"));
    click(&mut window, Role::Button, "Try the simulated line");
    until(&mut window, "the scan ends", scan_ended);
    assert_eq!(window.state().bench().modules().len(), 1);
}

#[test]
fn an_empty_line_says_what_to_check() {
    let mut window = window(&sim(&[], Pace::Skip));
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    window.step();
    for hint in ["No module answered", "D+ and D− swapped", "DIP 2 OFF"] {
        assert!(shows(&window, hint), "{hint}");
    }
    assert!(window.query_by_role_and_label(Role::Button, "Full scan").is_some());
}

#[test]
fn an_unknown_module_shows_what_it_said() {
    let sim = sim(&["unknown@160:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "unknown, address 160");
    assert!(shows(&window, "Unknown module"));
    let said = window.state().bench().shown().unwrap().identified.said.clone();
    assert!(!said.is_empty());
    let fields = window.query_all_by_role(Role::MultilineTextInput);
    assert!(fields.filter_map(|node| node.value()).any(|text| text == said));
    assert!(window.query_by_role_and_label(Role::Button, "Add definition file…").is_some());
}

#[test]
fn a_scan_can_be_paused_resumed_and_stopped_and_keeps_what_it_found() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Real));
    click(&mut window, Role::Button, "Scan options");
    click(&mut window, Role::MenuItem, "Full scan");
    until(&mut window, "the module is in the list", |window| {
        window.query_by_role_and_label(Role::ListItem, "PIR-234, address 1").is_some()
    });
    let paused = |window: &Window| match window.state().bench().scan() {
        Some(ScanState::Running { progress: Some(progress), .. }) => progress.paused,
        _ => false,
    };
    click(&mut window, Role::Button, "Pause");
    until(&mut window, "it pauses", paused);
    assert!(shows(&window, "paused"));
    click(&mut window, Role::Button, "Resume");
    until(&mut window, "it goes on", |window| !paused(window));
    click(&mut window, Role::Button, "Stop");
    until(&mut window, "it ends", scan_ended);
    window.step();
    assert!(shows(&window, "Stopped after"));
    assert_eq!(window.state().bench().modules().len(), 1);
}

#[test]
fn a_scan_of_ones_own_choice_asks_only_the_addresses_of_the_form() {
    let mut window = window(&sim(&["pir-234@7:modbus_rtu:9600"], Pace::Skip));
    click(&mut window, Role::Button, "Scan options");
    click(&mut window, Role::MenuItem, "Custom…");
    let field = window.get_by_role_and_label(Role::TextInput, "Addresses");
    field.focus();
    window.step();
    window.key_combination(&[egui::Key::Home]);
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Addresses").type_text("7,");
    window.step();
    window.step();
    assert!(shows(&window, "68 places to ask"));
    click(&mut window, Role::Button, "Start scan");
    until(&mut window, "the module", |window| {
        window.query_by_role_and_label(Role::ListItem, "PIR-234, address 7").is_some()
    });
}

#[test]
fn temperatures_change_their_unit_together() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    sim.set_temperature(1, 20.0);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "Celsius", |window| reading(window, "Temperature").as_deref() == Some("20.00 °C"));
    click(&mut window, Role::CheckBox, "°F");
    until(&mut window, "Fahrenheit", |window| reading(window, "Temperature").as_deref() == Some("68.00 °F"));
    assert!(reading(&window, "Dew point").unwrap().contains("°F"));
}

#[test]
fn polling_can_be_paused_and_resumed() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "a value", |window| {
        reading(window, "Temperature").is_some_and(|text| !text.contains("not known"))
    });
    click(&mut window, Role::Button, "Pause polling");
    assert_eq!(window.state().bench().shown().unwrap().interval, None);
    click(&mut window, Role::Button, "Resume polling");
    assert!(window.state().bench().shown().unwrap().interval.is_some());
}

#[test]
fn dragging_the_plot_releases_it_and_follow_takes_it_up_again() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "a value", |window| reading(window, "Temperature").is_some());
    let place = window.get_by_label("Plot").rect().center();
    window.hover_at(place);
    window.step();
    window.drag_at(place);
    window.step();
    window.hover_at(place + vec2(120.0, 0.0));
    window.step();
    window.drop_at(place + vec2(120.0, 0.0));
    window.step();
    click(&mut window, Role::Button, "Follow");
    assert!(window.query_by_role_and_label(Role::Button, "Hold plot").is_some());
}

#[test]
fn a_series_that_is_switched_off_stays_off() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::CheckBox, "Show Dew point");
    assert!(window.state().settings().hidden.contains("dew_point"));
    click(&mut window, Role::CheckBox, "Show Dew point");
    assert!(window.state().settings().hidden.is_empty());
}

#[test]
fn a_recent_host_is_chosen_with_a_click() {
    let recent_ports = vec!["/dev/no-such-port".into(), "tcp://bench.local:1502".into()];
    let settings = Settings { line: LineChoice::Simulated, recent_ports, ..Settings::default() };
    let mut window = window_with(&sim(&[], Pace::Skip), false, settings);
    click(&mut window, Role::ComboBox, "Line");
    assert!(shows(&window, "Recent"));
    click(&mut window, Role::Button, "Recent bench.local:1502");
    let settings = window.state().settings();
    assert_eq!((&settings.line, settings.host.as_str()), (&LineChoice::Tcp, "bench.local:1502"));
    click(&mut window, Role::ComboBox, "Line");
    click(&mut window, Role::Button, "Recent /dev/no-such-port");
    assert_eq!(window.state().settings().line, LineChoice::Port("/dev/no-such-port".to_owned()));
    click(&mut window, Role::ComboBox, "Line");
    click(&mut window, Role::Button, "Forget /dev/no-such-port");
    let names: Vec<&str> = window.state().settings().recent_ports.iter().map(RecentLine::name).collect();
    assert_eq!(names, ["bench.local:1502"]);
}

#[test]
fn a_recent_line_is_connected_again_with_one_key() {
    let sim = sim(&["pir-234@1"], Pace::Real);
    let server = TcpServer::bind(&sim, "127.0.0.1:0".parse().unwrap()).unwrap();
    let recent_ports = vec![format!("tcp://{}", server.address()).as_str().into()];
    let settings = Settings { line: LineChoice::Simulated, recent_ports, ..Settings::default() };
    let mut window = window_with(&sim, false, settings);
    assert!(shows(&window, &format!("Connect {}", server.address())));
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::L);
    until(&mut window, "the module is found", |window| window.state().bench().modules().len() == 1);
    assert_eq!(window.state().settings().line, LineChoice::Tcp);
}

#[test]
fn a_host_that_was_connected_is_remembered_and_one_that_was_not_is_not() {
    let sim = sim(&["pir-234@1"], Pace::Real);
    let server = TcpServer::bind(&sim, "127.0.0.1:0".parse().unwrap()).unwrap();
    let host = server.address().to_string();
    let settings = Settings { line: LineChoice::Tcp, host: host.clone(), ..Settings::default() };
    let mut window = window_with(&sim, false, settings);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "it is remembered", |window| {
        window.state().settings().recent_ports.iter().map(RecentLine::name).eq([host.as_str()])
    });

    let line = LineChoice::Port("/dev/no-such-port".to_owned());
    let mut window = window_with(&sim, false, Settings { line, ..Settings::default() });
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the sentence", |window| shows(window, "There is no port /dev/no-such-port"));
    assert!(window.state().settings().recent_ports.is_empty());
}

#[test]
fn the_demonstration_scans_the_simulated_line_at_once() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:dcon:9600"], Pace::Skip);
    let mut window = window_with(&sim, true, Settings::default());
    until(&mut window, "both modules", |window| window.state().bench().modules().len() == 2);
    assert!(shows(&window, "Simulated line open"));
}

#[test]
fn a_lost_line_is_said_and_taken_up_again() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "a value", |window| {
        reading(window, "Temperature").is_some_and(|text| !text.contains("not known"))
    });
    sim.unplug();
    until(&mut window, "the loss", |window| shows(window, "Simulated line lost"));
    sim.plug();
    until(&mut window, "the return", |window| shows(window, "Simulated line open"));
}

#[test]
fn a_window_at_rest_is_not_drawn_again_and_again() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    // Panics if every frame asks for another.
    window.run();
    window.state_mut().apply(Action::ClearNotices);
    window.run();
}

/// The characters that the window itself writes, and those that come from definitions.
#[test]
fn every_character_of_the_interface_has_its_glyph() {
    let mut characters: std::collections::BTreeSet<char> = sources().iter().flat_map(|text| text.chars()).collect();
    let (catalogue, _) = Catalogue::built_in();
    for definition in catalogue.iter() {
        for item in &definition.items {
            characters.extend(item.label.chars().chain(item.unit.chars()).chain(item.help.chars()));
        }
    }
    characters.retain(|character| !character.is_ascii());
    let ctx = egui::Context::default();
    ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
    let font = egui::FontId::proportional(13.0);
    let missing: Vec<char> =
        characters.into_iter().filter(|c| !ctx.fonts_mut(|fonts| fonts.has_glyph(&font, *c))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The code of the window and of what it shows, without comments.
fn sources() -> Vec<String> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders: Vec<_> =
        ["ui", "bench", "bus", "diagnosis", "module", "picture", "protocol"].map(|room| root.join(room)).into();
    let mut texts = Vec::new();
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                texts.push(without_comments_and_tests(&std::fs::read_to_string(path).unwrap()));
            }
        }
    }
    texts
}

fn without_comments_and_tests(text: &str) -> String {
    let code = text.lines().take_while(|line| !line.starts_with("#[cfg(test)]"));
    code.filter(|line| !line.trim_start().starts_with("//")).collect()
}
