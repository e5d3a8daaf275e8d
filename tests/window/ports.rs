//! The ports that the system tells of, at its own time.

use std::sync::Mutex;
use std::sync::mpsc::{Sender, channel};

use dcon_bench::bus::{LineAddress, PortInfo, UsbIdentity};
use dcon_bench::protocol::LineSettings;
use dcon_bench::ui::{App, LineChoice, Settings, Start};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;

use crate::harness::*;

fn adapter(name: &str) -> PortInfo {
    let usb = UsbIdentity { vendor: 0x0403, product: 0x6001, serial: Some("A1".to_owned()), interface: None };
    PortInfo { name: name.to_owned(), description: "FT232".to_owned(), problem: None, usb: Some(usb) }
}

/// A window that learns which ports there are when they are sent.
fn window_told(settings: Settings) -> (Window, Sender<Vec<PortInfo>>) {
    let (tell, told) = channel();
    let told = Mutex::new(told);
    let list = move || told.lock().unwrap().recv().unwrap_or_default();
    let window = Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |creation| {
        let ctx = creation.egui_ctx.clone();
        let start = Start { simulated: LineAddress::demo(), demo: false, settings };
        App::new(&ctx, bench(&ctx).with_ports(list), start)
    });
    (window, tell)
}

fn knows(window: &Window, names: &[&str]) -> bool {
    let bench = window.state().bench();
    !bench.is_looking_for_ports() && bench.ports().iter().map(|port| port.name.as_str()).eq(names.iter().copied())
}

#[test]
fn the_window_is_drawn_while_the_system_takes_its_time_and_shows_the_ports_when_they_are_told() {
    let (mut window, tell) = window_told(Settings::default());
    window.step();
    assert!(shows(&window, "Looking for serial ports"));
    tell.send(Vec::new()).unwrap();
    until(&mut window, "there is none", |window| shows(window, "There is no serial port"));
    click(&mut window, Role::Button, "Look again");
    assert!(shows(&window, "There is no serial port"), "what was known stays until more is known");
    tell.send(vec![adapter("/dev/ttyUSB7")]).unwrap();
    until(&mut window, "the port", |window| knows(window, &["/dev/ttyUSB7"]));
    window.step();
    assert!(!shows(&window, "There is no serial port"));
}

#[test]
fn an_adapter_that_was_plugged_in_again_is_connected_under_its_new_name_with_one_key() {
    let mut settings = Settings { line: LineChoice::Simulated, ..Settings::default() };
    let line = |port: &str| LineAddress::Serial { port: port.to_owned() };
    settings.note_line(&LineAddress::tcp("127.0.0.1:1").unwrap(), LineSettings::default(), &[]);
    settings.note_line(&line("/dev/no-such-3"), LineSettings::default(), &[adapter("/dev/no-such-3")]);
    let (mut window, tell) = window_told(settings);
    tell.send(Vec::new()).unwrap();
    until(&mut window, "none is there", |window| knows(window, &[]));
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.step();
    window.step();
    assert_eq!(
        window.state().settings().line,
        LineChoice::Simulated,
        "nothing is chosen before it is known what is there"
    );
    tell.send(vec![adapter("/dev/no-such-7")]).unwrap();
    until(&mut window, "it is chosen", |window| {
        window.state().settings().line == LineChoice::Port("/dev/no-such-7".to_owned())
    });
    until(&mut window, "it is opened", |window| shows(window, "There is no port /dev/no-such-7"));
}

#[test]
fn where_no_recent_adapter_is_there_that_is_told_with_what_to_do() {
    let mut settings = Settings { line: LineChoice::Simulated, ..Settings::default() };
    let line = LineAddress::Serial { port: "/dev/no-such-3".to_owned() };
    settings.note_line(&line, LineSettings::default(), &[adapter("/dev/no-such-3")]);
    let (mut window, tell) = window_told(settings);
    tell.send(vec![adapter("/dev/no-such-3")]).unwrap();
    until(&mut window, "it is there", |window| knows(window, &["/dev/no-such-3"]));
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.step();
    tell.send(Vec::new()).unwrap();
    until(&mut window, "it is told", |window| shows(window, "None of the recent lines is there – plug the adapter in"));
    assert_eq!(window.state().settings().line, LineChoice::Simulated);
}
