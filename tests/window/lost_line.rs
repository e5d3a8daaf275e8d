//! An adapter that is pulled and comes back: what was known stays, greyed, and everything goes on by itself.

use dcon_bench::bench::{Action, Bench, LineState, Severity};
use dcon_bench::bus::{Bus, BusEvent, LineAddress, RequestId};
use dcon_bench::module::Catalogue;
use dcon_bench::protocol::LineSettings;
use dcon_bench::sim::{FaultKind, Faults, Pace};
use dcon_bench::ui::{App, LineChoice, RecentLine, Settings, Start};
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use jiff::Timestamp;

use crate::harness::*;

const MODULE: &str = "PIR-234, address 1";

fn is_lost(window: &Window) -> bool {
    window.state().bench().line().is_lost()
}

fn is_disabled(window: &Window, role: Role, label: &str) -> bool {
    window.query_by_role_and_label(role, label).is_some_and(|node| node.accesskit_node().is_disabled())
}

fn told(bench: &Bench, text: &str) -> bool {
    bench.notices().any(|notice| notice.text == text)
}

/// The module is open and says 21.5 °C.
fn shown(sim: &dcon_bench::sim::Sim) -> Window {
    let mut window = window(sim);
    sim.set_temperature(1, 21.5);
    open(&mut window, MODULE);
    until(&mut window, "a value", |window| reading(window, "Temperature").as_deref() == Some("21.50 °C"));
    window
}

#[test]
fn the_last_values_stay_as_old_ones_at_once_and_are_fresh_after_the_return() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:modbus_rtu:9600"], Pace::Skip);
    let mut window = shown(&sim);
    sim.unplug();
    until(&mut window, "the loss", is_lost);
    window.step();
    let temperature = reading(&window, "Temperature").unwrap();
    assert!(temperature.starts_with("21.50 °C, ") && temperature.ends_with(" old"), "{temperature}");
    assert!(shows(&window, "Simulated line lost"));
    assert!(shows(&window, "line lost"));
    sim.set_temperature(1, -7.25);
    sim.plug();
    until(&mut window, "it goes on", |window| reading(window, "Temperature").as_deref() == Some("-7.25 °C"));
    assert!(!shows(&window, "line lost"));
    assert!(told(window.state().bench(), "Simulated line is there again"));
}

#[test]
fn a_module_that_was_not_polled_is_lost_too_and_is_not_called_silent_afterwards() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = shown(&sim);
    click(&mut window, Role::Button, "Pause polling");
    sim.unplug();
    until(&mut window, "the loss", is_lost);
    until(&mut window, "it is said", |window| shows(window, "line lost"));
    assert!(reading(&window, "Temperature").unwrap().ends_with(" old"));
    sim.set_temperature(1, 3.0);
    sim.plug();
    until(&mut window, "the return", |window| window.state().bench().line().is_open());
    until(&mut window, "what was lost is read once", |window| {
        reading(window, "Temperature").is_some_and(|text| text.starts_with("3.00 °C"))
    });
    assert!(!shows(&window, "line lost"));
}

#[test]
fn what_needs_the_line_is_disabled_while_it_is_lost_and_polling_is_not() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = shown(&sim);
    let target = window.state().bench().modules()[0].target;
    until(&mut window, "the offset is read", |window| {
        window.state().bench().module(&target).unwrap().known("temperature_offset").is_some()
    });
    window.state_mut().apply(Action::Stage(target, "temperature_offset".to_owned(), "1.5".to_owned()));
    sim.unplug();
    until(&mut window, "the loss", is_lost);
    window.step();
    let reset = ["Reset latches of Temperature", "Reset all latches"];
    for label in ["Scan", "Read again", "Write 1", "Clear alarm"].into_iter().chain(reset) {
        assert!(is_disabled(&window, Role::Button, label), "{label}");
    }
    for label in ["Close line", "Pause polling", "Revert all"] {
        assert!(!is_disabled(&window, Role::Button, label), "{label}");
    }
    sim.plug();
    until(&mut window, "the return", |window| window.state().bench().line().is_open());
    click(&mut window, Role::Button, "Write 1");
    until(&mut window, "it is written", |window| window.state().bench().module(&target).unwrap().edits.is_empty());
    assert_eq!(sim.setting(1, "temperature_offset").as_deref(), Some("1.50"));
}

#[test]
fn the_trend_has_a_gap_where_the_line_was_lost() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = shown(&sim);
    let gaps = |window: &Window| {
        let bench = window.state().bench();
        let trend = bench.modules()[0].trend(bench.history(), "temperature_c").unwrap();
        let columns = trend.blocks().iter().filter_map(|block| block.samples.as_ref());
        columns.flat_map(|columns| columns.iter()).filter(|sample| sample.gap).count()
    };
    let before = gaps(&window);
    sim.unplug();
    until(&mut window, "the loss", is_lost);
    sim.plug();
    until(&mut window, "fresh again", |window| reading(window, "Temperature").as_deref() == Some("21.50 °C"));
    assert!(gaps(&window) > before);
}

/// A window whose bus is played by the test, on an open port.
fn on_port(name: &str) -> (Window, impl Fn(&mut Window, BusEvent)) {
    let (bus, commands, _events) = Bus::detached();
    let settings = Settings { line: LineChoice::Port(name.to_owned()), ..Settings::default() };
    let mut window = window_of(move |ctx| {
        let (catalogue, _) = Catalogue::built_in();
        // What is said and what is over does not hang on the clock, which may stand or go back.
        let bench = Bench::new(bus, catalogue.into(), &[]).with_clock(|| Timestamp::UNIX_EPOCH);
        App::new(ctx, bench, Start { simulated: LineAddress::demo(), demo: false, settings })
    });
    let line = LineAddress::Serial { port: name.to_owned() };
    window.state_mut().apply(Action::Connect { line, settings: LineSettings::default() });
    window.state_mut().take(BusEvent::Opened { id: RequestId(1), line: name.to_owned() });
    until(&mut window, "the ports are known", |window| !window.state().bench().is_looking_for_ports());
    let tell = move |window: &mut Window, event| {
        let _held_open = &commands;
        window.state_mut().take(event);
        window.step();
        window.step();
    };
    (window, tell)
}

#[test]
fn an_adapter_that_returns_under_another_name_is_the_line_from_then_on() {
    let (mut window, tell) = on_port("/dev/ttyUSB0");
    assert!(matches!(window.state().bench().line(), LineState::Open { .. }));
    tell(&mut window, BusEvent::LineLost { reason: "it was unplugged".to_owned() });
    assert!(shows(&window, "/dev/ttyUSB0 lost"));
    let line = LineAddress::Serial { port: "/dev/ttyUSB1".to_owned() };
    tell(&mut window, BusEvent::LineRestored { line });
    assert!(shows(&window, "/dev/ttyUSB1 open"));
    assert!(told(window.state().bench(), "/dev/ttyUSB0 is there again as /dev/ttyUSB1"));
    assert_eq!(window.state().settings().line, LineChoice::Port("/dev/ttyUSB1".to_owned()));
    until(&mut window, "it is remembered", |window| {
        let names = window.state().settings().recent_ports.iter().map(RecentLine::name);
        names.eq(["/dev/ttyUSB1", "/dev/ttyUSB0"])
    });
}

fn dismissals(window: &Window) -> Vec<String> {
    let buttons = window.query_all_by_role(Role::Button).filter_map(|node| node.accesskit_node().label());
    buttons.filter(|label| label.starts_with("Dismiss")).collect()
}

#[test]
fn the_banner_of_a_loss_goes_with_the_return_and_several_losses_are_one() {
    let (mut window, tell) = on_port("/dev/ttyUSB0");
    let line = LineAddress::Serial { port: "/dev/ttyUSB0".to_owned() };
    for _ in 0..3 {
        tell(&mut window, BusEvent::LineLost { reason: "it was unplugged".to_owned() });
        assert!(shows(&window, "plug the adapter in again"));
        assert_eq!(dismissals(&window), ["Dismiss"]);
        tell(&mut window, BusEvent::LineRestored { line: line.clone() });
        assert!(!shows(&window, "plug the adapter in again"));
        assert_eq!(dismissals(&window), [""; 0]);
    }
    let losses = window.state().bench().notices().filter(|notice| notice.text.contains("is gone"));
    assert_eq!(losses.count(), 3);
}

#[test]
fn the_status_bar_does_not_repeat_the_banner() {
    let (mut window, tell) = on_port("/dev/ttyUSB0");
    tell(&mut window, BusEvent::LineLost { reason: "it was unplugged".to_owned() });
    assert_eq!(window.query_all_by_label_contains("plug the adapter in again, it is taken up").count(), 1);
}

#[test]
fn an_error_of_another_kind_stays_in_the_banner_after_the_return() {
    let (mut window, tell) = on_port("/dev/ttyUSB0");
    window.state_mut().apply(Action::Notify(Severity::Error, "The disk is full".to_owned()));
    tell(&mut window, BusEvent::LineLost { reason: "it was unplugged".to_owned() });
    assert_eq!(dismissals(&window), ["Dismiss 2"]);
    let line = LineAddress::Serial { port: "/dev/ttyUSB0".to_owned() };
    tell(&mut window, BusEvent::LineRestored { line });
    assert!(shows(&window, "The disk is full"));
    assert_eq!(dismissals(&window), ["Dismiss"]);
}

#[test]
fn a_line_closed_while_it_was_lost_is_not_said_to_come_back() {
    let (mut window, tell) = on_port("/dev/ttyUSB0");
    tell(&mut window, BusEvent::LineLost { reason: "it was unplugged".to_owned() });
    window.state_mut().apply(Action::Disconnect);
    tell(&mut window, BusEvent::Closed { id: RequestId(2) });
    assert!(shows(&window, "No line open"));
    assert_eq!(dismissals(&window), [""; 0]);
}

#[test]
fn a_port_that_takes_no_bytes_is_not_to_be_plugged_in_but_freed() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = shown(&sim);
    let mut faults = sim.faults();
    faults.switch_on(FaultKind::BlockedWrite);
    sim.set_faults(faults);
    until(&mut window, "the advice", |window| shows(window, "switch flow control off, unplug and replug the adapter"));
    assert!(!shows(&window, "plug the adapter in again"));
    sim.set_faults(Faults::default());
    until(&mut window, "the return", |window| window.state().bench().line().is_open());
    window.step();
    assert_eq!(dismissals(&window), [""; 0]);
}
