//! Small windows, and large text, which leaves a window as little room: what stands in front of it can be read and left.

use dcon_bench::sim::Pace;
use dcon_bench::ui::App;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tempfile::TempDir;

use crate::harness::*;

/// A window of 1024 by 700 at 100, 150, 200 and 300 per cent.
const ROOMS: [Vec2; 4] = [vec2(1024.0, 700.0), vec2(683.0, 467.0), vec2(512.0, 350.0), vec2(341.0, 233.0)];

/// A window that records into `folder`.
fn window_of_size(size: Vec2, folder: &TempDir) -> Window {
    let folder = folder.path().to_owned();
    let start = start(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip), false, simulated());
    Harness::builder().with_size(size).build_eframe(move |creation| {
        let ctx = creation.egui_ctx.clone();
        App::new(&ctx, bench(&ctx), start).recording_in(Some(folder))
    })
}

/// Scrolls to a button, which then has to be within the window, and clicks it.
fn reach(window: &mut Window, role: Role, label: &str, size: Vec2) {
    until(window, label, |window| window.query_by_role_and_label(role, label).is_some());
    window.get_by_role_and_label(role, label).scroll_to_me();
    let inside = Rect::from_min_size(Default::default(), size);
    let what = format!("{label} within {size}");
    until(window, &what, |window| inside.contains_rect(window.get_by_role_and_label(role, label).rect()));
    click(window, role, label);
}

/// Opens something with an entry of a menu, and leaves it with its button.
fn open_and_leave(size: Vec2, [menu, entry, contents, leave]: [&str; 4]) {
    let folder = TempDir::new().unwrap();
    let mut window = window_of_size(size, &folder);
    reach(&mut window, Role::Button, menu, size);
    reach(&mut window, Role::MenuItem, entry, size);
    until(&mut window, entry, |window| shows(window, contents));
    reach(&mut window, Role::Button, leave, size);
    assert!(!shows(&window, contents), "{entry} at {size}");
}

#[test]
fn the_box_about_the_program_can_be_left_in_the_smallest_window() {
    for size in ROOMS {
        open_and_leave(size, ["Menu", "About and licences…", "Its licence", "Close"]);
    }
}

#[test]
fn a_form_can_be_left_in_half_of_a_small_window() {
    for size in &ROOMS[..3] {
        let told = "Record by itself when the first module is polled";
        open_and_leave(*size, ["Recording", "Recording settings…", told, "Cancel"]);
    }
}

#[test]
fn the_help_is_read_page_by_page_where_its_contents_have_no_room_beside() {
    let size = ROOMS[2];
    let folder = TempDir::new().unwrap();
    let mut window = window_of_size(size, &folder);
    press(&mut window, Modifiers::NONE, Key::F1);
    until(&mut window, "the page alone", |window| {
        shows(window, "Copy page") && window.query_by_role_and_label(Role::ListItem, "Troubleshooting").is_none()
    });
    click(&mut window, Role::Button, "Contents");
    reach(&mut window, Role::ListItem, "Troubleshooting", size);
    until(&mut window, "the page that was chosen", |window| shows(window, "›  Troubleshooting"));
    assert!(window.query_by_role_and_label(Role::ListItem, "Quick start").is_none());
}

#[test]
fn everything_can_be_opened_in_a_window_of_any_size() {
    for size in ROOMS {
        let folder = TempDir::new().unwrap();
        let mut window = window_of_size(size, &folder);
        press(&mut window, Modifiers::COMMAND, Key::R);
        until(&mut window, "the scan ends", scan_ended);
        let module = "PIR-234, address 1";
        reach(&mut window, Role::ListItem, module, size);
        let pages = window.query_all_by_role(Role::Tab).count();
        assert!(pages >= 7, "{pages} pages at {size}");
        for _ in 0..pages {
            press(&mut window, Modifiers::COMMAND, Key::PageDown);
            (0..3).for_each(|_| window.step());
        }
        let panes = [(Key::G, Modifiers::COMMAND), (Key::T, Modifiers::COMMAND), (Key::F1, Modifiers::NONE)];
        let diagnosis = (Key::D, Modifiers::COMMAND | Modifiers::SHIFT);
        for (key, modifiers) in panes.into_iter().chain([diagnosis]) {
            press(&mut window, modifiers, key);
            (0..3).for_each(|_| window.step());
        }
        let tabs = ["Trends", "Traffic", "Help", "Diagnosis"];
        assert!(tabs.iter().all(|tab| window.query_by_role_and_label(Role::Button, tab).is_some()), "at {size}");
    }
}
