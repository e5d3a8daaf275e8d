//! The AI tab: readings, latches, offsets, the high temperature alarm.

use dcon_bench::bench::{ItemState, Module};
use dcon_bench::sim::{Pace, Sim};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;

use crate::harness::*;

const MODULE: &str = "PIR-234, address 1";

/// A PIR-234 in view at this temperature, with what the tab shows read.
#[track_caller]
fn opened(protocol: &str, celsius: f64) -> (Sim, Window) {
    let sim = sim(&[&format!("pir-234@1:{protocol}:9600")], Pace::Skip);
    sim.set_temperature(1, celsius);
    let mut window = window(&sim);
    open(&mut window, MODULE);
    until(&mut window, "all was read", |window| {
        let read = |id| shown(window).known(id).is_some() && !shown(window).is_being_read(id);
        ["temperature_offset", "humidity_offset", "alarm_mode", "alarm_limit", "temperature_f_low"]
            .iter()
            .all(|id| read(id))
    });
    let text = format!("{celsius:.2} °C");
    until(&mut window, &text, |window| reading(window, "Temperature").as_ref() == Some(&text));
    (sim, window)
}

fn shown(window: &Window) -> &Module {
    window.state().bench().shown().unwrap()
}

/// Replaces what stands in a field.
#[track_caller]
fn enter(window: &mut Window, label: &str, text: &str) {
    until(window, label, |window| window.query_by_role_and_label(Role::TextInput, label).is_some());
    window.get_by_role_and_label(Role::TextInput, label).focus();
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    window.get_by_role_and_label(Role::TextInput, label).type_text(text);
    window.step();
    window.step();
}

fn field(window: &Window, label: &str) -> String {
    window.get_by_role_and_label(Role::TextInput, label).value().unwrap_or_default()
}

#[track_caller]
fn until_set(window: &mut Window, sim: &Sim, address: u8, id: &str, value: &str) {
    until(window, &format!("{id} = {value}"), |_| sim.setting(address, id).as_deref() == Some(value));
}

#[test]
fn an_offset_is_typed_and_written_with_enter() {
    for protocol in ["modbus_rtu", "dcon"] {
        let (sim, mut window) = opened(protocol, 21.0);
        enter(&mut window, "Temperature offset", "-1.5");
        assert!(shows(&window, "not written, was 0.00 °C"), "{protocol}");
        press(&mut window, Modifiers::NONE, Key::Enter);
        until_set(&mut window, &sim, 1, "temperature_offset", "-1.50");
        until(&mut window, "it counts", |window| reading(window, "Temperature").as_deref() == Some("19.50 °C"));
        enter(&mut window, "Humidity offset", "2.25");
        press(&mut window, Modifiers::NONE, Key::Enter);
        until_set(&mut window, &sim, 1, "humidity_offset", "2.25");
        until(&mut window, "nothing is left to write", |window| shown(window).edits.is_empty());
    }
}

#[test]
fn a_reference_gives_the_new_offset_in_celsius() {
    let (sim, mut window) = opened("modbus_rtu", 24.99);
    enter(&mut window, "Temperature offset", "0.2");
    press(&mut window, Modifiers::NONE, Key::Enter);
    until(&mut window, "the offset counts", |window| reading(window, "Temperature").as_deref() == Some("25.19 °C"));
    enter(&mut window, "Reference for Temperature offset", "25.3");
    until(&mut window, "the sum", |window| shows(window, "0.20 + (25.30 − 25.19) = 0.31 °C"));
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(field(&window, "Temperature offset"), "0.31");
    assert_eq!(sim.setting(1, "temperature_offset").unwrap(), "0.20", "it is staged, not written");
    click(&mut window, Role::Button, "Write Temperature offset");
    until_set(&mut window, &sim, 1, "temperature_offset", "0.31");
    until(&mut window, "both agree", |window| shows(window, "0.31 + (25.30 − 25.30) = 0.31 °C"));
}

#[test]
fn a_reference_in_fahrenheit_gives_the_same_offset_in_celsius() {
    let (sim, mut window) = opened("dcon", 24.99);
    click(&mut window, Role::CheckBox, "°F");
    enter(&mut window, "Reference for Temperature offset", "75");
    until(&mut window, "the sum", |window| shows(window, "= 23.89 °C; 0.00 + (23.89 − 24.99) = -1.10 °C"));
    click(&mut window, Role::Button, "Use for Temperature offset");
    assert_eq!(field(&window, "Temperature offset"), "-1.10");
    click(&mut window, Role::Button, "Write Temperature offset");
    until_set(&mut window, &sim, 1, "temperature_offset", "-1.10");
}

#[test]
fn a_reference_out_of_reach_is_limited_to_the_range_and_says_so() {
    let (sim, mut window) = opened("modbus_rtu", 20.0);
    sim.set_humidity(1, 40.0);
    until(&mut window, "the humidity", |window| reading(window, "Relative humidity").as_deref() == Some("40.00 %"));
    enter(&mut window, "Reference for Humidity offset", "150");
    until(&mut window, "the limit", |window| shows(window, "0.00 + (150.00 − 40.00) = 110.00 %, limited to 100.00"));
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(field(&window, "Humidity offset"), "100.00");
}

#[test]
fn a_reading_that_is_old_or_a_reference_that_is_no_number_gives_no_offset() {
    let (sim, mut window) = opened("modbus_rtu", 20.0);
    enter(&mut window, "Reference for Temperature offset", "25,x");
    assert!(shows(&window, "not a number"));
    sim.set_dead(1, true);
    enter(&mut window, "Reference for Temperature offset", "25");
    until(&mut window, "the refusal", |window| shows(window, "the reading is "));
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert!(shown(&window).edits.is_empty());
    enter(&mut window, "Reference for Temperature offset", "26");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(field(&window, "Reference for Temperature offset"), "");
}

#[test]
fn a_limit_out_of_range_is_not_sent_and_escape_takes_it_back() {
    let (sim, mut window) = opened("modbus_rtu", 20.0);
    enter(&mut window, "High alarm limit", "1000");
    assert!(shows(&window, "use 0.00 to 999.99 °C"));
    press(&mut window, Modifiers::NONE, Key::Enter);
    let before = sim.requests();
    until(&mut window, "more polls", |_| sim.requests() > before + 3);
    assert_eq!(sim.setting(1, "alarm_limit").as_deref(), Some("65.00"));
    enter(&mut window, "High alarm limit", "70");
    assert_eq!(shown(&window).edits.len(), 1);
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(shown(&window).edits.is_empty());
    assert_eq!(field(&window, "High alarm limit"), "65.00");
}

#[test]
fn latches_follow_and_are_reset_by_channel_and_all_together() {
    for protocol in ["modbus_rtu", "dcon"] {
        let (sim, mut window) = opened(protocol, 10.0);
        for celsius in [40.0, 20.0] {
            sim.set_temperature(1, celsius);
            let text = format!("{celsius:.2} °C");
            until(&mut window, &text, |window| reading(window, "Temperature").as_ref() == Some(&text));
        }
        // They are not polled, but read again after some seconds.
        until(&mut window, "the peak", |window| window.query_by_label("Temperature, high latch: 40.00 °C").is_some());
        assert!(window.query_by_label("Temperature, low latch: 10.00 °C").is_some(), "{protocol}");
        click(&mut window, Role::Button, "Reset latches of Temperature");
        click(&mut window, Role::MenuItem, "Reset high latch 40.00 °C");
        until(&mut window, "reset", |window| window.query_by_label("Temperature, high latch: 20.00 °C").is_some());
        assert!(window.query_by_label("Temperature, low latch: 10.00 °C").is_some(), "{protocol}");
        click(&mut window, Role::CheckBox, "°F");
        until(&mut window, "also in the other unit", |window| {
            window.query_by_label("Temperature, high latch (°F): 68.00 °F").is_some()
        });
        assert!(window.query_by_label("Temperature, low latch (°F): 50.00 °F").is_some(), "{protocol}");
        click(&mut window, Role::Button, "Reset all latches");
        click(&mut window, Role::MenuItem, "Reset both");
        until(&mut window, "all reset", |window| {
            window.query_by_label("Temperature, low latch (°F): 68.00 °F").is_some()
        });
    }
}

#[test]
fn a_latched_alarm_is_raised_shown_and_cleared() {
    let (sim, mut window) = opened("modbus_rtu", 20.0);
    assert!(!shows(&window, "High alarm limit 65.00 °C"), "a limit far off that is not in force is not drawn");
    raise_and_clear(&mut window, &sim, 1);
    assert!(shows(&window, "Latched, above 30.00 °C"));
    assert!(window.query_by_label("High alarm limit 30.00 °C").is_some(), "the line stands in the plot");
    click(&mut window, Role::CheckBox, "°F");
    until(&mut window, "the line in °F", |window| window.query_by_label("High alarm limit 86.00 °F").is_some());
    assert!(shows(&window, "Latched, above 30.00 °C (86.00 °F)"));
}

#[test]
fn a_pir_130_without_temperature_has_its_alarm_and_no_empty_plot() {
    let sim = sim(&["pir-130@160:dcon:9600"], Pace::Skip);
    let mut window = window(&sim);
    sim.set_temperature(160, 20.0);
    open(&mut window, "PIR-130, address 160");
    raise_and_clear(&mut window, &sim, 160);
    assert!(window.query_by_label("Plot").is_none());
    assert!(window.query_by_label("Offsets").is_none());
    assert!(!shows(&window, "latch"));
}

#[test]
fn a_pir_130_with_a_temperature_shows_it_with_the_limit() {
    let sim = sim(&["pir-130@160:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    sim.set_temperature(160, 20.0);
    open(&mut window, "PIR-130, address 160");
    until(&mut window, "its temperature", |window| reading(window, "Temperature").as_deref() == Some("20.00 °C"));
    raise_and_clear(&mut window, &sim, 160);
    until(&mut window, "the line", |window| window.query_by_label("High alarm limit 30.00 °C").is_some());
}

/// Sets a latched alarm at 30 °C, lets it become warm and cool again, and clears it.
#[track_caller]
fn raise_and_clear(window: &mut Window, sim: &Sim, address: u8) {
    // High enough for what is clicked to be in view.
    window.set_size(vec2(1280.0, 1200.0));
    until(window, "the limit was read", |window| shown(window).known("alarm_limit").is_some());
    enter(window, "High alarm limit", "30");
    press(window, Modifiers::NONE, Key::Enter);
    until_set(window, sim, address, "alarm_limit", "30.00");
    click(window, Role::ComboBox, "Alarm mode");
    click(window, Role::Button, "Latched");
    click(window, Role::Button, "Write Alarm mode");
    until_set(window, sim, address, "alarm_mode", "latched");
    until(window, "no alarm yet", |window| reading(window, "High alarm").as_deref() == Some("none"));
    sim.set_temperature(address, 30.5);
    until(window, "the alarm", |window| reading(window, "High alarm").as_deref() == Some("alarm"));
    sim.set_temperature(address, 25.0);
    until(window, "it is cooler", |_| sim.setting(address, "temperature_c").as_deref() == Some("25.00"));
    click(window, Role::Button, "Clear alarm");
    until(window, "no alarm", |window| reading(window, "High alarm").as_deref() == Some("none"));
    assert_eq!(sim.setting(address, "alarm_active").as_deref(), Some("false"));
}

#[test]
fn a_module_that_falls_silent_refuses_the_write_and_the_edit_stays() {
    for protocol in ["modbus_rtu", "dcon"] {
        let (sim, mut window) = opened(protocol, 20.0);
        enter(&mut window, "Temperature offset", "1.5");
        sim.set_dead(1, true);
        press(&mut window, Modifiers::NONE, Key::Enter);
        until(
            &mut window,
            "the refusal",
            |window| matches!(shown(window).state("temperature_offset"), ItemState::Refused(reason) if reason.contains("no answer")),
        );
        window.step();
        assert!(shows(&window, "no answer"), "{protocol}");
        assert_eq!(field(&window, "Temperature offset"), "1.5");
        assert_eq!(sim.setting(1, "temperature_offset").as_deref(), Some("0.00"));
        sim.set_dead(1, false);
        until(&mut window, "it answers", |window| reading(window, "Temperature").as_deref() == Some("20.00 °C"));
        click(&mut window, Role::Button, "Retry Temperature offset");
        until_set(&mut window, &sim, 1, "temperature_offset", "1.50");
    }
}

#[test]
fn digits_latches_and_plot_are_in_a_small_window_and_nothing_is_painted_over() {
    let (_sim, mut window) = opened("modbus_rtu", 20.0);
    for size in [vec2(1024.0, 676.0), vec2(1280.0, 800.0), vec2(2560.0, 1440.0)] {
        window.set_size(size);
        (0..3).for_each(|_| window.step());
        let plot = window.get_by_label("Plot").rect();
        let settings = window.get_by_label("Offsets").rect();
        let latches = window.get_by_label_contains("Dew point, low latch").rect();
        assert!(latches.bottom() <= plot.top(), "{size}");
        assert!(plot.bottom() <= settings.top(), "{size}: {plot} {settings}");
        assert!(plot.bottom() <= size.y - 60.0, "{size}: {plot}");
    }
    let settings = window.get_by_role_and_label(Role::TextInput, "High alarm limit").rect();
    assert!(settings.bottom() < 1440.0, "in a large window the plot leaves room for the settings");
}
