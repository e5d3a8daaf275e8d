use std::time::Duration;

use dcon_bench::sim::Pace;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

/// What the only module's reading was taken at.
fn taken(window: &Window, item: &str) -> Option<jiff::Timestamp> {
    window.state().bench().modules()[0].reading(item)?.at
}

#[test]
fn only_the_readings_that_are_ticked_are_polled() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "both are read", |window| {
        taken(window, "humidity").is_some() && taken(window, "pir1").is_some()
    });
    window.key_press_modifiers(Modifiers::COMMAND, Key::D);
    window.step();
    click(&mut window, Role::Button, "Poll plan…");
    let all = window.state().bench().modules()[0].poll_questions();
    click(&mut window, Role::Button, "What of PIR-234 @1");
    click(&mut window, Role::CheckBox, "Relative humidity");
    let module = &window.state().bench().modules()[0];
    assert!(!module.polled_items().contains(&"humidity") && module.polled_items().contains(&"temperature_c"));
    assert!(module.poll_questions() >= all, "the range has a hole now");
    let (humidity, temperature) = (taken(&window, "humidity"), taken(&window, "temperature_c"));
    until(&mut window, "others go on", |window| taken(window, "temperature_c") > temperature);
    let later = taken(&window, "temperature_c");
    until(&mut window, "and on", |window| taken(window, "temperature_c") > later);
    assert!(taken(&window, "humidity").unwrap() <= humidity.unwrap() + Duration::from_secs(2));
}

#[test]
fn a_module_is_polled_and_paused_in_the_plan() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    click(&mut window, Role::Button, "Scan");
    until(&mut window, "the scan ends", scan_ended);
    click(&mut window, Role::Button, "Poll plan…");
    click(&mut window, Role::CheckBox, "Poll PIR-234 @1");
    assert_eq!(window.state().bench().modules()[0].interval, Some(Duration::from_secs(1)));
    click(&mut window, Role::CheckBox, "Poll PIR-234 @1");
    assert_eq!(window.state().bench().modules()[0].interval, None);
    click(&mut window, Role::Button, "Close");
    assert!(window.query_by_label("Poll PIR-234 @1").is_none());
}
