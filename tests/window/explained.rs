//! Whatever can be used says what it does when the pointer rests on it.

use dcon_bench::sim::Pace;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

/// What can be used.
const ROLES: [Role; 9] = [
    Role::Button,
    Role::CheckBox,
    Role::ColumnHeader,
    Role::ComboBox,
    Role::MenuItem,
    Role::RadioButton,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
];
/// What says all there is to say by its own text, the editor of scripts, over which nothing should lie, and marks of
/// events, which tell them on hover.
const PLAIN: [&str; 4] = ["Cancel", "Close", "Script", "Found: "];

/// What explains nothing.
fn unexplained(window: &Window) -> Vec<String> {
    let nodes = ROLES.into_iter().flat_map(|role| window.query_all_by_role(role).map(move |node| (role, node)));
    let silent = nodes.filter(|(_, node)| node.accesskit_node().description().is_none_or(|text| text.is_empty()));
    let named = silent.map(|(role, node)| (role, node.accesskit_node().label().unwrap_or_default()));
    let others = named.filter(|(_, name)| !PLAIN.iter().any(|plain| name.starts_with(plain)));
    others.map(|(role, name)| format!("{role:?} {name}")).collect()
}

#[test]
fn everything_that_can_be_used_explains_itself() {
    for protocol in ["modbus_rtu", "dcon"] {
        let mut window = window(&sim(&[&format!("pir-234@1:{protocol}:9600")], Pace::Skip));
        let check = |window: &mut Window, place: &str| {
            (0..4).for_each(|_| window.step());
            let found = unexplained(window);
            assert!(found.is_empty(), "{protocol}, {place}: {found:?}");
        };
        check(&mut window, "at the start");
        open(&mut window, "PIR-234, address 1");
        for tab in ["Configuration", "AI", "PIR / Relay", "Host WDT", "Commands", "Log", "Summary"] {
            click(&mut window, Role::Tab, tab);
            check(&mut window, tab);
        }
        click(&mut window, Role::Tab, "Commands");
        for page in ["Reference page", "Modbus page", "Script page"] {
            click(&mut window, Role::CheckBox, page);
            check(&mut window, page);
        }
        for pane in ["Traffic", "Trends", "Diagnosis"] {
            click(&mut window, Role::Button, pane);
            check(&mut window, pane);
        }
        press(&mut window, Modifiers::COMMAND, Key::D);
        check(&mut window, "Dashboard");
        window.key_press(Key::F1);
        check(&mut window, "Help");
        click(&mut window, Role::ComboBox, "Line");
        check(&mut window, "lines");
        press(&mut window, Modifiers::NONE, Key::Escape);
        click(&mut window, Role::Button, "Menu");
        check(&mut window, "menu");
        press(&mut window, Modifiers::NONE, Key::Escape);
    }
}
