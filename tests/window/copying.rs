//! Tables are copied for a spreadsheet, wherever they stand.

use dcon_bench::sim::Pace;
use dcon_bench::ui::{RecentLine, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, OutputCommand, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;

use crate::configuration::{at_configuration, known, type_into};
use crate::harness::*;

/// What is copied within the next frames.
fn copied(window: &mut Window) -> Vec<Vec<String>> {
    for _ in 0..4 {
        for command in &window.output().platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                return text.lines().map(|line| line.split('\t').map(str::to_owned).collect()).collect();
            }
        }
        window.step();
    }
    panic!("nothing is copied");
}

fn middle(window: &Window, role: Role, label: &str) -> Pos2 {
    window.get_by_role_and_label(role, label).rect().center()
}

/// Opens the menu of what is at a place, and chooses.
fn choose(window: &mut Window, at: Pos2, entry: &str) {
    window.hover_at(at);
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        window.event(Event::PointerButton { pos: at, button, pressed, modifiers: Modifiers::NONE });
        window.step();
    }
    window.step();
    // A button of the same name may stand beneath.
    window.query_all_by_role_and_label(Role::Button, entry).last().unwrap().click();
    window.step();
}

#[test]
fn a_setting_and_all_settings_of_a_tab_are_copied_with_their_header() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "response_delay");
    type_into(&mut window, "Response delay", "12");
    let at = window.get_by_role_and_label(Role::TextInput, "Response delay").rect().left_center();
    // Its name stands to the left of the field.
    let at = Pos2::new(at.x - 60.0, at.y);
    choose(&mut window, at, "Copy row");
    let rows = copied(&mut window);
    assert_eq!(rows[0][..4], ["Name", "Value", "Unit", "Not written"]);
    assert_eq!((rows.len(), &rows[1][..5]), (2, &["Response delay", "0", "ms", "12", "0"].map(str::to_owned)[..]));
    choose(&mut window, at, "Copy table");
    let rows = copied(&mut window);
    assert!(rows.len() > 6 && rows.iter().all(|row| row.len() == rows[0].len()), "{rows:?}");
}

#[test]
fn a_module_of_the_list_is_copied_with_its_values() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    let at = middle(&window, Role::ListItem, "PIR-130, address 160");
    choose(&mut window, at, "Copy row");
    let rows = copied(&mut window);
    assert_eq!((rows.len(), rows[0][1].as_str(), rows[1][1].as_str()), (2, "Model", "PIR-130"));
    choose(&mut window, at, "Copy table");
    assert_eq!(copied(&mut window).len(), 3);
}

#[test]
fn the_row_under_the_pointer_is_copied_with_the_keys() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Tab, "Summary");
    known(&mut window, "response_delay");
    let row = window_row(&window, "Response delay: 0 ms");
    window.hover_at(row);
    window.step();
    window.event(Event::Copy);
    window.step();
    let rows = copied(&mut window);
    assert_eq!((rows.len(), rows[1][0].as_str()), (2, "Response delay"));
}

/// Every kind of table by what stands in one of its rows: with how it is reached, its first heading, and least rows.
#[test]
fn every_table_copies_the_row_that_is_clicked_or_all_of_it() {
    type Reach = fn(&mut Window);
    let diagnosis: Reach = |window| click(window, Role::Button, "Diagnosis");
    let reference: Reach = |window| {
        click(window, Role::Tab, "Commands");
        click(window, Role::CheckBox, "Reference page");
    };
    let modbus: Reach = |window| {
        click(window, Role::Tab, "Commands");
        click(window, Role::CheckBox, "Modbus page");
    };
    let help: Reach = |window| {
        press(window, Modifiers::NONE, Key::F1);
        click(window, Role::ListItem, "PIR-234: registers");
    };
    let plan: Reach = |window| {
        press(window, Modifiers::COMMAND, Key::D);
        click(window, Role::Button, "Poll plan…");
    };
    let lines: Reach = |window| click(window, Role::ComboBox, "Line");
    let tables: [(Reach, &str, &str, &str, usize); 7] = [
        (diagnosis, "modbus_rtu", "Diagnosis of PIR-234 @1", "Place", 2),
        (diagnosis, "modbus_rtu", "Never answered", "Count", 5),
        (reference, "dcon", "Read or set address, baud rate", "Command", 20),
        (modbus, "modbus_rtu", "coil 1  (wire 0)", "Kind", 20),
        (help, "modbus_rtu", "DO0", "Number", 20),
        (plan, "modbus_rtu", "PIR-234 @1", "Module", 1),
        (lines, "modbus_rtu", "Recent COM7", "Line", 2),
    ];
    for (reach, protocol, row, heading, least) in tables {
        for (entry, least) in [("Copy row", 1), ("Copy table", least)] {
            let recent_ports = ["COM3", "COM7"].map(RecentLine::from).into();
            let sim = sim(&[&format!("pir-234@1:{protocol}:9600")], Pace::Skip);
            let mut window = window_with(&sim, false, Settings { recent_ports, ..simulated() });
            open(&mut window, "PIR-234, address 1");
            reach(&mut window);
            until(&mut window, row, |window| shows(window, row));
            (0..3).for_each(|_| window.step());
            let at = window.query_all_by_label_contains(row).last().unwrap().rect().center();
            choose(&mut window, at, entry);
            let rows = copied(&mut window);
            assert_eq!(rows[0][0], heading, "{row}");
            assert!(rows.len() > least && (entry == "Copy table" || rows.len() == 2), "{row}: {rows:?}");
        }
    }
}

fn window_row(window: &Window, start: &str) -> Pos2 {
    let node = window.query_all_by_label_contains(start).next().expect("the row is shown");
    node.rect().center()
}

#[test]
fn steps_back_and_forth_by_keys_and_menu() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = at_configuration(&sim);
    open(&mut window, "PIR-234, address 1");
    known(&mut window, "response_delay");
    type_into(&mut window, "Response delay", "12");
    window.key_press(Key::Tab);
    window.step();
    window.step();
    let edit = |window: &Window| {
        let module = window.state().bench().shown().unwrap();
        module.edit("response_delay").map(|edit| edit.text.clone())
    };
    assert_eq!(edit(&window).as_deref(), Some("12"));
    let steps = [
        (Modifiers::COMMAND, Key::Z, None),
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::Z, Some("12")),
        (Modifiers::COMMAND, Key::Z, None),
        (Modifiers::COMMAND, Key::Y, Some("12")),
    ];
    // The Tab key went into the next field, which has steps of its own.
    window.key_press(Key::Escape);
    window.step();
    for (modifiers, key, expected) in steps {
        window.key_press_modifiers(modifiers, key);
        window.step();
        window.step();
        assert_eq!(edit(&window).as_deref(), expected, "{modifiers:?} {key:?}");
    }
    click(&mut window, Role::Button, "Menu");
    click(&mut window, Role::MenuItem, "Undo: Response delay");
    assert_eq!(edit(&window), None);
}
