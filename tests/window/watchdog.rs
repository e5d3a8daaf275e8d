//! Host WDT: the host watchdog, Host OK, and the indicator in the header.

use std::time::Duration;

use dcon_bench::bench::Action;
use dcon_bench::sim::{Pace, Sim};
use eframe::egui;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

const MODBUS: &str = "pir-234@1:modbus_rtu:9600";
const DCON: &str = "pir-234@1:dcon:9600";

/// The module at its tab Host WDT, with a timeout of 25.5 s.
fn at_the_watchdog(spec: &str) -> (Sim, Window) {
    let sim = sim(&[spec], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Host WDT");
    set(&mut window, "wdt_timeout", "25.5");
    until(&mut window, "the timeout", |window| {
        window.state().bench().shown().unwrap().edits.is_empty() && holds(&sim, "wdt_timeout", "25.5")
    });
    (sim, window)
}

fn set(window: &mut Window, id: &str, value: &str) {
    let target = window.state().bench().shown().unwrap().target;
    window.state_mut().apply(Action::Set(target, id.to_owned(), value.to_owned()));
}

fn holds(sim: &Sim, id: &str, value: &str) -> bool {
    sim.setting(1, id).as_deref() == Some(value)
}

fn type_period(window: &mut Window, text: &str) {
    window.get_by_role_and_label(Role::TextInput, "Host OK period").focus();
    window.step();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Host OK period").type_text(text);
    window.step();
    window.step();
}

fn sent(window: &Window) -> Option<u64> {
    window.state().bench().shown().unwrap().host_ok.as_ref().map(|host_ok| host_ok.sent)
}

/// Sends Host OK every 0.1 s and enables the watchdog.
fn keep_quiet(sim: &Sim, window: &mut Window) {
    type_period(window, "0.1");
    click(window, Role::Button, "Start Host OK");
    until(window, "the first", |window| sent(window) >= Some(1));
    set(window, "wdt_enabled", "true");
    until(window, "it is enabled", |window| {
        holds(sim, "wdt_enabled", "true") && window.state().bench().shown().unwrap().watchdog_counts()
    });
}

#[test]
fn enabling_asks_while_nothing_sends_host_ok() {
    for spec in [MODBUS, DCON] {
        let (sim, mut window) = at_the_watchdog(spec);
        until(&mut window, "the setting", |window| {
            window.state().bench().shown().unwrap().known("wdt_enabled").is_some()
        });
        let target = window.state().bench().shown().unwrap().target;
        window.state_mut().apply(Action::Stage(target, "wdt_enabled".to_owned(), "true".to_owned()));
        click(&mut window, Role::Button, "Write 1");
        until(&mut window, "the question", |window| shows(window, "In 25.5 s the relays go to their safe values"));
        click(&mut window, Role::Button, "Cancel");
        assert!(holds(&sim, "wdt_enabled", "false"), "{spec}");
        click(&mut window, Role::Button, "Write 1");
        click(&mut window, Role::Button, "Enable watchdog");
        until(&mut window, "it is enabled", |_| holds(&sim, "wdt_enabled", "true"));
        until(&mut window, "the header", |window| shows(window, "Watchdog 25.5 s, no Host OK from here"));
    }
}

#[test]
fn host_ok_keeps_the_watchdog_quiet_and_stopping_it_asks() {
    let (sim, mut window) = at_the_watchdog(DCON);
    keep_quiet(&sim, &mut window);
    until(&mut window, "the time that is left", |window| shows(window, "trips in "));
    for _ in 0..5 {
        let before = sent(&window);
        sim.advance(Duration::from_secs(15));
        until(&mut window, "Host OK after that time", |window| sent(window) > before.map(|sent| sent + 1));
    }
    assert!(holds(&sim, "wdt_tripped", "false"), "75 s have passed");

    click(&mut window, Role::Button, "Stop sending");
    assert!(shows(&window, "25.5 s after the last Host OK its host watchdog trips"));
    click(&mut window, Role::Button, "Cancel");
    assert!(sent(&window).is_some());
    click(&mut window, Role::Button, "Stop sending");
    click(&mut window, Role::Button, "Stop Host OK now");
    assert_eq!(sent(&window), None);
    sim.advance(Duration::from_secs(30));
    until(&mut window, "the trip", |window| shows(window, "Tripped"));
    assert!(holds(&sim, "wdt_tripped", "true"));
    until(&mut window, "that it is disabled now", |window| !window.state().bench().shown().unwrap().watchdog_counts());
    sim.unplug();
    until(&mut window, "the loss", |window| window.state().bench().line().is_lost());
    window.step();
    let clear = window.get_by_role_and_label(Role::Button, "Clear tripped watchdog");
    assert!(clear.accesskit_node().is_disabled());
    clear.hover();
    until(&mut window, "the reason", |window| {
        window.query_by_label("The line is lost: plug the adapter in again").is_some()
    });
    sim.plug();
    until(&mut window, "the return", |window| window.state().bench().line().is_open());
    click(&mut window, Role::Button, "Clear tripped watchdog");
    until(&mut window, "it is cleared", |window| holds(&sim, "wdt_tripped", "false") && shows(window, "Not tripped"));
}

#[test]
fn a_period_longer_than_the_timeout_is_refused_with_the_reason() {
    let (_sim, mut window) = at_the_watchdog(DCON);
    assert_eq!(
        window.get_by_role_and_label(Role::TextInput, "Host OK period").value().as_deref(),
        Some("8.5"),
        "a third of the timeout"
    );
    for (text, reason) in [
        ("25.6", "Too late: the watchdog trips after 25.5 s – use 25.5 s or less"),
        ("soon", "\"soon\" is not a period"),
    ] {
        type_period(&mut window, text);
        assert!(shows(&window, reason), "{text}");
        let button = window.get_by_role_and_label(Role::Button, "Start Host OK");
        assert!(button.accesskit_node().is_disabled(), "{text}");
    }
    type_period(&mut window, "25.5");
    click(&mut window, Role::Button, "Start Host OK");
    assert!(sent(&window).is_some());
}

#[test]
fn the_indicator_is_seen_on_every_tab_and_stops_host_ok() {
    let (sim, mut window) = at_the_watchdog(DCON);
    keep_quiet(&sim, &mut window);
    for tab in ["AI", "Commands", "PIR / Relay"] {
        click(&mut window, Role::Tab, tab);
        assert!(shows(&window, "Watchdog 25.5 s, Host OK every 0.1 s"), "{tab}");
    }
    click(&mut window, Role::Button, "Stop Host OK");
    assert!(sent(&window).is_some(), "it asks first");
    click(&mut window, Role::Button, "Stop Host OK now");
    assert_eq!(sent(&window), None);
}

#[test]
fn host_ok_once_is_a_broadcast() {
    let (sim, mut window) = at_the_watchdog(DCON);
    assert!(shows(&window, "a broadcast that every module of the line hears"));
    let before = sim.requests();
    click(&mut window, Role::Button, "Send Host OK");
    until(&mut window, "it is sent", |window| {
        let journal = &window.state().bench().shown().unwrap().journal;
        sim.requests() > before && journal.iter().any(|entry| entry.text.contains("Send Host OK"))
    });
}

#[test]
fn over_modbus_host_ok_is_not_offered_and_that_is_explained() {
    let (_sim, mut window) = at_the_watchdog(MODBUS);
    window.step();
    assert!(shows(&window, "the manual documents no Host OK over Modbus"));
    assert!(window.query_by_label("Start Host OK").is_none());
    assert!(shows(&window, "Host watchdog timeout count"));
}

#[test]
fn f5_and_the_button_read_the_tab_again() {
    let (_sim, mut window) = at_the_watchdog(DCON);
    let read_at =
        |window: &Window| window.state().bench().shown().unwrap().reading("do0_safe").and_then(|read| read.at);
    until(&mut window, "the first read", |window| read_at(window).is_some());
    let first = read_at(&window);
    click(&mut window, Role::Button, "Read again");
    until(&mut window, "the second read", |window| read_at(window) > first);
    let second = read_at(&window);
    window.key_press(egui::Key::F5);
    until(&mut window, "the third read", |window| read_at(window) > second);
}
