//! The tab of commands: the line, its exchanges, the reference, raw Modbus and scripts.

use dcon_bench::bench::Module;
use dcon_bench::bench::console::Exchange;
use dcon_bench::sim::{Pace, Sim, TcpServer};
use dcon_bench::ui::{LineChoice, Settings};
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::harness::*;

const DCON: &str = "pir-234@1:dcon:9600";
const RTU: &str = "pir-234@1:modbus_rtu:9600";

fn begun(spec: &str) -> (Sim, Window) {
    let sim = sim(&[spec], Pace::Skip);
    let settings = Settings { line: LineChoice::Simulated, tab: "commands".to_owned(), ..Settings::default() };
    let mut window = window_with(&sim, false, settings);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "the tab", |window| shows(window, "Nothing was sent yet"));
    (sim, window)
}

fn module(window: &Window) -> &Module {
    window.state().bench().shown().unwrap()
}

fn last(window: &Window) -> Option<&Exchange> {
    module(window).console.log().iter().next_back()
}

fn answer(window: &Window) -> Option<String> {
    last(window)?.answer_text()
}

fn field_text(window: &Window, name: &str) -> String {
    window.get_by_role_and_label(Role::TextInput, name).value().unwrap_or_default()
}

fn type_into(window: &mut Window, role: Role, name: &str, text: &str) {
    let field = window.get_by_role_and_label(role, name);
    field.focus();
    window.step();
    window.key_combination_modifiers(eframe::egui::Modifiers::COMMAND, &[Key::A]);
    window.step();
    window.get_by_role_and_label(role, name).type_text(text);
    window.step();
    window.step();
}

fn enter(window: &mut Window, command: &str) {
    type_into(window, Role::TextInput, "Command", command);
    window.key_press(Key::Enter);
    window.step();
    window.step();
}

#[test]
fn a_command_is_sent_with_enter_and_its_answer_is_told_field_by_field() {
    let (_sim, mut window) = begun(DCON);
    type_into(&mut window, Role::TextInput, "Command", "$01M");
    assert!(shows(&window, "Reads:"), "what it does stands there before it is sent");
    assert!(shows(&window, "On the wire $01M\\r"));
    window.key_press(Key::Enter);
    until(&mut window, "the answer", |window| answer(window).as_deref() == Some("!01PIR234"));
    window.step();
    for shown in ["!01PIR234", "21 30 31 50", "valid answer", " ms"] {
        assert!(shows(&window, shown), "{shown}");
    }
    assert!(last(&window).unwrap().took.is_some());
    assert_eq!(window.state().settings().command_history, ["$01M"]);
}

#[test]
fn a_command_that_changes_the_module_is_asked_for_and_then_changes_it() {
    let (sim, mut window) = begun(DCON);
    let before = sim.setting(1, "response_delay");
    enter(&mut window, "~01RD05");
    assert!(shows(&window, "Changes the module"));
    assert!(last(&window).is_none(), "nothing is sent before it is confirmed");
    assert_eq!(sim.setting(1, "response_delay"), before);
    click(&mut window, Role::Button, "Send and change the module");
    until(&mut window, "the answer", |window| answer(window).as_deref() == Some("!01"));
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("5"));
}

#[test]
fn a_broadcast_is_marked_and_nobody_answers_it() {
    let (_sim, mut window) = begun(DCON);
    enter(&mut window, "~**");
    assert!(shows(&window, "Heard by every module"));
    assert!(last(&window).is_none());
    click(&mut window, Role::Button, "Send to every module");
    until(&mut window, "it is sent", |window| answer(window).is_some());
    assert_eq!(answer(&window).as_deref(), Some("sent to all, nobody answers"));
}

#[test]
fn an_unknown_command_is_asked_for_and_its_silence_is_told() {
    let (_sim, mut window) = begun(DCON);
    enter(&mut window, "$01QQQ");
    assert!(shows(&window, "May change the module"));
    click(&mut window, Role::Button, "Send what is not known");
    until(&mut window, "the silence", |window| answer(window).as_deref() == Some("no answer"));
    window.step();
    assert!(shows(&window, "no answer"));
}

#[test]
fn what_is_no_command_says_what_to_write_and_takes_the_better_line() {
    let (_sim, mut window) = begun(DCON);
    type_into(&mut window, Role::TextInput, "Command", "01M");
    assert!(shows(&window, "A DCON command begins with one of"));
    type_into(&mut window, Role::TextInput, "Command", "$01m");
    click(&mut window, Role::Button, "Use $01M");
    assert_eq!(field_text(&window, "Command"), "$01M");
}

#[test]
fn up_and_down_step_through_what_was_sent() {
    let (_sim, mut window) = begun(DCON);
    for command in ["$01M", "$01F"] {
        enter(&mut window, command);
        until(&mut window, command, |window| answer(window).is_some());
    }
    type_into(&mut window, Role::TextInput, "Command", "$012");
    for (key, expected) in [
        (Key::ArrowUp, "$01F"),
        (Key::ArrowUp, "$01M"),
        (Key::ArrowUp, "$01M"),
        (Key::ArrowDown, "$01F"),
        (Key::ArrowDown, "$012"),
    ] {
        window.key_press(key);
        window.step();
        window.step();
        assert_eq!(field_text(&window, "Command"), expected);
    }
}

#[test]
fn a_repeated_command_counts_until_it_is_stopped() {
    let (_sim, mut window) = begun(DCON);
    type_into(&mut window, Role::TextInput, "Command", "$01M");
    let command = dcon_bench::bench::console::RawCommand::parse("$01M", false).unwrap();
    let repeat =
        dcon_bench::bench::Action::RepeatRaw(module(&window).target, command, std::time::Duration::from_millis(10));
    window.state_mut().apply(repeat);
    until(&mut window, "three answers", |window| {
        module(window).console.repeating().is_some_and(|repeating| repeating.plan.answered >= 3)
    });
    click(&mut window, Role::Button, "Stop repeating");
    assert!(!module(&window).console.is_repeating());
    until(&mut window, "the last answer", |window| answer(window).is_some());
    let sent = module(&window).console.repeating().unwrap().plan.sent;
    assert!(shows(&window, &format!("{sent} sent, {sent} answered")));
    (0..20).for_each(|_| window.step());
    assert_eq!(module(&window).console.repeating().unwrap().plan.sent, sent, "nothing is sent any more");
    click(&mut window, Role::Button, "Repeat");
    until(&mut window, "it runs again", |window| module(window).console.is_repeating());
}

#[test]
fn closing_the_line_ends_what_repeats() {
    let (_sim, mut window) = begun(DCON);
    let target = module(&window).target;
    let command = dcon_bench::bench::console::RawCommand::parse("$01M", false).unwrap();
    let period = std::time::Duration::from_millis(10);
    window.state_mut().apply(dcon_bench::bench::Action::RepeatRaw(target, command, period));
    // The last one of all is never answered where a picture takes longer than the period.
    until(&mut window, "an answer", |window| {
        module(window).console.log().iter().any(|exchange| exchange.result.is_some())
    });
    window.state_mut().apply(dcon_bench::bench::Action::Disconnect);
    until(&mut window, "it ends", |window| !module(window).console.is_repeating());
    assert!(module(&window).console.log().iter().all(|exchange| exchange.result.is_some()));
    let sent = module(&window).console.log().len();
    enter(&mut window, "$01M");
    assert_eq!(module(&window).console.log().len(), sent, "nothing is sent on a closed line");
}

fn run(window: &mut Window, script: &str) {
    click(window, Role::CheckBox, "Script page");
    until(window, "the editor", |window| {
        window.query_by_role_and_label(Role::MultilineTextInput, "Script").is_some()
            || window.query_by_role_and_label(Role::TextInput, "Script").is_some()
    });
    let multiline = window.query_by_role_and_label(Role::MultilineTextInput, "Script").is_some();
    let role = if multiline { Role::MultilineTextInput } else { Role::TextInput };
    type_into(window, role, "Script", script);
    click(window, Role::Button, "Run");
}

#[test]
fn a_script_that_finds_what_it_expects_comes_to_its_end() {
    let (_sim, mut window) = begun(DCON);
    run(&mut window, "$01M\nexpect !01PIR*\nwait 20 ms\nrepeat 2\n$01F\nend");
    until(&mut window, "it is done", |window| shows(window, "Done: 5 steps, 1 answer as expected"));
    assert_eq!(module(&window).console.log().len(), 3);
    assert!(shows(&window, "as expected"));
    assert_eq!(window.state().settings().recent_scripts.len(), 1);
}

#[test]
fn a_script_that_finds_something_else_names_the_line() {
    let (_sim, mut window) = begun(DCON);
    run(&mut window, "$01M\nexpect !01XYZ\n$01F");
    until(&mut window, "it has failed", |window| shows(window, "Ended at line 2: !01XYZ was expected"));
    assert_eq!(module(&window).console.log().len(), 1, "what follows is not sent");
    assert!(shows(&window, "line 2: !01XYZ was expected"));
    assert!(!module(&window).console.is_running());
}

#[test]
fn a_script_that_changes_the_module_is_asked_for() {
    let (sim, mut window) = begun(DCON);
    run(&mut window, "~01RD05\nexpect !01");
    assert!(shows(&window, "Line 1, ~01RD05: Changes the module"));
    assert!(last(&window).is_none());
    click(&mut window, Role::Button, "Run the script");
    until(&mut window, "it is done", |window| shows(window, "Done: 2 steps"));
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("5"));
}

#[test]
fn the_form_of_modbus_names_a_register_and_reads_it() {
    let (sim, mut window) = begun(RTU);
    sim.set_temperature(1, 21.5);
    assert!(shows(&window, "register 1 = wire 0 (0000h): temperature_c"));
    click(&mut window, Role::Button, "Send the request");
    until(&mut window, "the answer", |window| answer(window).is_some());
    window.step();
    let bytes = last(&window).unwrap().result.clone().unwrap().unwrap();
    assert_eq!(bytes[..5], [1, 3, 2, 0x08, 0x66], "21.50 °C in hundredths");
    assert!(shows(&window, "temperature_c 21.50 °C"));
    type_into(&mut window, Role::TextInput, "Search the registers", "baud");
    click(&mut window, Role::ListItem, "register 486  (wire 485): baud_rate, data_format");
    assert_eq!(field_text(&window, "First"), "486");
    click(&mut window, Role::CheckBox, "wire, from 0");
    assert_eq!(field_text(&window, "First"), "485");
}

#[test]
fn the_reference_finds_a_command_and_its_form_sends_it() {
    let (sim, mut window) = begun(DCON);
    sim.set_temperature(1, 21.5);
    let title = "Read the high latched temperature in °C";
    type_into(&mut window, Role::TextInput, "Search the reference", "latch");
    click(&mut window, Role::ListItem, title);
    assert!(shows(&window, "@AARH0"));
    click(&mut window, Role::Button, "Put into the command line");
    assert_eq!(field_text(&window, "Command"), "@01RH0");
    click(&mut window, Role::Button, &format!("Send: {title}"));
    until(&mut window, "the answer", |window| answer(window).is_some_and(|answer| answer.starts_with("!01+")));
}

#[test]
fn a_module_reached_over_tcp_says_why_there_is_no_dcon() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let server = TcpServer::bind(&sim, "127.0.0.1:0".parse().unwrap()).unwrap();
    let settings = Settings {
        line: LineChoice::Tcp,
        host: server.address().to_string(),
        tab: "commands".to_owned(),
        ..Settings::default()
    };
    let mut window = window_with(&sim, false, settings);
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "the tab", |window| shows(window, "Nothing was sent yet"));
    enter(&mut window, "$01M");
    assert!(shows(&window, "DCON commands are for serial lines"));
    assert!(last(&window).is_none());
    enter(&mut window, "01 03 00 00 00 01");
    until(&mut window, "the answer", |window| answer(window).is_some_and(|answer| answer.starts_with("01 03 02")));
    window.step();
    assert!(shows(&window, "temperature_c"));
}
