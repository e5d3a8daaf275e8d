//! Recording in the window: it begins by itself, is stopped, opened again and taken away.

use std::path::{Path, PathBuf};

use dcon_bench::bench::Action;
use dcon_bench::sim::{Pace, Sim};
use dcon_bench::ui::{App, Settings};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use tempfile::TempDir;

use crate::events::{show_events, show_trends};
use crate::harness::*;
use crate::traffic::{has_row, rows};

const MODULE: &str = "pir-234@1:modbus_rtu:9600";

fn recording_window(sim: &Sim, folder: &TempDir, settings: Settings) -> Window {
    let (start, folder) = (start(sim, false, settings), folder.path().join("recordings"));
    window_of(move |ctx| App::new(ctx, bench(ctx), start).without_system_dialogs().recording_in(Some(folder)))
}

/// What the status bar says of the recording.
fn status(window: &Window) -> String {
    let node = window.query_by_role_and_label(Role::Button, "Recording");
    node.and_then(|node| node.accesskit_node().value()).unwrap_or_default()
}

/// Polls the module until something is on the disk; the file.
fn recorded(window: &mut Window) -> PathBuf {
    open(window, "PIR-234, address 1");
    until(window, "samples on the disk", |window| {
        window.state().bench().recording().is_some_and(|status| status.samples > 20)
    });
    window.state().bench().recording().and_then(|status| status.file.clone()).unwrap()
}

/// Writes into a field in place of what stands there.
fn write_into(window: &mut Window, field: &str, text: &str) {
    until(window, field, |window| window.query_by_role_and_label(Role::TextInput, field).is_some());
    window.get_by_role_and_label(Role::TextInput, field).focus();
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    window.get_by_role_and_label(Role::TextInput, field).type_text(text);
    window.step();
    window.step();
}

fn files(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter(|entry| entry.path().extension().is_some_and(|ending| ending == "sqlite")).count()
}

#[test]
fn recording_begins_with_the_first_poll_and_is_stopped_and_started_with_a_click() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    window.step();
    assert_eq!(status(&window), "not recording");
    let first = recorded(&mut window);
    assert!(first.starts_with(std::fs::canonicalize(folder.path()).unwrap().join("recordings")), "{first:?}");
    assert!(status(&window).starts_with("recording "), "{}", status(&window));
    click(&mut window, Role::Button, "Recording");
    // The popup finds its place in its second picture.
    (0..3).for_each(|_| window.step());
    click(&mut window, Role::MenuItem, "Stop recording");
    until(&mut window, "it is stopped", |window| status(window) == "not recording");
    assert!(window.state().bench().modules()[0].interval.is_some(), "polling goes on");
    (0..5).for_each(|_| window.step());
    assert_eq!(status(&window), "not recording", "it does not begin by itself again");
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    until(&mut window, "it goes on", |window| {
        window.state().bench().recording().is_some_and(|status| status.samples > 0)
    });
    assert_ne!(window.state().bench().recording().unwrap().file, Some(first));
    assert_eq!(files(&folder.path().join("recordings")), 2);
}

#[test]
fn nothing_is_recorded_by_itself_if_the_settings_say_so_or_the_window_was_not_told_where() {
    let folder = tempfile::tempdir().unwrap();
    let sim = sim(&[MODULE], Pace::Skip);
    let off = Settings { record: false, ..simulated() };
    for mut window in [recording_window(&sim, &folder, off), window(&sim)] {
        open(&mut window, "PIR-234, address 1");
        until(&mut window, "it is polled", |window| reading(window, "Temperature").is_some());
        assert!(window.state().bench().recording().is_none());
    }
    assert_eq!(files(&folder.path().join("recordings")), 0);
}

#[test]
fn the_folder_and_what_is_kept_are_set_in_a_dialog_and_hold_for_a_new_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    recorded(&mut window);
    click(&mut window, Role::Button, "Recording");
    click(&mut window, Role::MenuItem, "Recording settings…");
    until(&mut window, "what is removed", |window| shows(window, "take more than 10000 MB"));
    click(&mut window, Role::CheckBox, "Keep at most");
    assert!(shows(&window, "No recording is ever removed"));
    let other = folder.path().join("elsewhere");
    write_into(&mut window, "Folder", other.to_str().unwrap());
    click(&mut window, Role::Button, "Save");
    let settings = window.state().settings();
    assert_eq!(settings.recording_folder, other.to_str().unwrap());
    assert_eq!(settings.recording_total_megabytes, 0);
    until(&mut window, "a file there", |_| files(&other) == 1);
}

#[test]
fn a_recording_is_opened_by_its_path_and_closed_with_its_tab() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    let file = recorded(&mut window);
    press(&mut window, Modifiers::COMMAND, Key::O);
    write_into(&mut window, "Path", file.to_str().unwrap());
    click(&mut window, Role::Button, "Open");
    show_events(&mut window);
    until(&mut window, "its events", |window| has_row(window, &["PIR-234@1", "Found at"]));
    assert_eq!(window.state().bench().opened().count(), 1);
    let live = rows(&window).len();
    until(&mut window, "it grows while it is looked at", |window| {
        let history = window.state().bench().opened().next().and_then(|(_, viewer)| viewer.history());
        history.is_some_and(|history| history.series().len() > 5 && live > 0)
    });
    eframe::App::on_exit(window.state_mut(), None);
    let layout = window.state().settings().layout.clone().unwrap();
    assert!(!layout.contains("Recording"), "{layout}");
    press(&mut window, Modifiers::COMMAND, Key::W);
    assert_eq!(window.state().bench().opened().count(), 0);
}

#[test]
fn the_newest_recordings_are_a_click_away() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    let file = recorded(&mut window);
    let name = file.file_name().unwrap().to_str().unwrap().to_owned();
    click(&mut window, Role::Button, "Recording");
    click(&mut window, Role::MenuItem, &name);
    show_events(&mut window);
    until(&mut window, "its events", |window| has_row(window, &["Found at"]));
    assert!(window.state().bench().opened().any(|(_, viewer)| viewer.path().ends_with(&name)));
}

#[test]
fn nothing_in_the_menu_of_recordings_moves_when_the_newest_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    let name = recorded(&mut window).file_name().unwrap().to_str().unwrap().to_owned();
    click(&mut window, Role::Button, "Recording");
    // The popup finds its place in its second picture.
    window.step();
    let places = |window: &Window| {
        let entries = window.query_all_by_role(Role::MenuItem);
        entries.map(|entry| (entry.accesskit_node().label(), entry.rect())).collect::<Vec<_>>()
    };
    let before = places(&window);
    assert!(before.len() >= 4, "{before:?}");
    until(&mut window, "it is found", |window| window.query_by_role_and_label(Role::MenuItem, &name).is_some());
    for _ in 0..3 {
        let now = places(&window);
        assert!(before.iter().all(|entry| now.contains(entry)), "{before:?} became {now:?}");
        window.step();
    }
}

#[test]
fn what_is_no_recording_is_said_in_its_tab() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("letter.txt");
    std::fs::write(&path, "Dear engineer").unwrap();
    let mut window = recording_window(&sim(&[], Pace::Skip), &folder, simulated());
    window.state_mut().apply(Action::OpenRecording(path));
    until(&mut window, "the reason", |window| shows(window, "is not a recording of this program"));
}

#[test]
fn a_recording_that_is_dropped_onto_the_window_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    let file = recorded(&mut window);
    drop_files(&mut window, std::slice::from_ref(&file));
    show_events(&mut window);
    until(&mut window, "its events", |window| has_row(window, &["Found at"]));
    assert_eq!(window.state().bench().opened().next().map(|(_, viewer)| viewer.path().to_owned()), Some(file));
}

#[test]
fn without_a_folder_nothing_is_started_and_the_settings_are_offered() {
    let mut window = window(&sim(&[MODULE], Pace::Skip));
    open(&mut window, "PIR-234, address 1");
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    assert!(window.state().bench().recording().is_none());
    click(&mut window, Role::Button, "Menu");
    let entry = window.get_by_role_and_label(Role::MenuItem, "Start or stop recording");
    assert!(entry.accesskit_node().is_disabled());
}

#[test]
fn a_folder_that_cannot_be_written_is_said_in_the_status_bar() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let recording_folder = file.join("inside").display().to_string();
    let mut window =
        recording_window(&sim(&[MODULE], Pace::Skip), &folder, Settings { recording_folder, ..simulated() });
    open(&mut window, "PIR-234, address 1");
    until(&mut window, "it is said", |window| status(window).starts_with("not on disk"));
    assert!(told(&window, "waits in memory"));
}

#[test]
fn the_folder_of_recordings_is_shown_with_a_click() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    recorded(&mut window);
    click(&mut window, Role::Button, "Recording");
    click(&mut window, Role::MenuItem, "Open folder");
    let place = folder.path().join("recordings").display().to_string();
    until(&mut window, "the folder", |window| told(window, &format!("The folder is {place}")));
}

#[test]
fn readings_are_exported_from_the_trends_and_their_folder_is_offered() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    recorded(&mut window);
    show_trends(&mut window);
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    until(&mut window, "the dialog", |window| shows(window, "About "));
    window.get_by_label_contains("All (").click();
    window.step();
    click(&mut window, Role::RadioButton, "Everything");
    click(&mut window, Role::Button, "Save…");
    let path = folder.path().join("readings.csv");
    write_into(&mut window, "Path", path.to_str().unwrap());
    click(&mut window, Role::Button, "Save");
    until(&mut window, "it is written", |window| told(window, &format!("written to {}", path.display())));
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let headers = reader.headers().unwrap().clone();
    assert_eq!(&headers[0], "time");
    assert!(headers.iter().any(|name| name == "PIR-234@1 temperature_c [°C]"), "{headers:?}");
    assert!(reader.records().count() > 1);
    click(&mut window, Role::Button, "Open folder");
    until(&mut window, "the folder", |window| told(window, &format!("The folder is {}", folder.path().display())));
}

#[test]
fn an_opened_recording_is_exported_with_what_is_on_the_disk_only() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    let file = recorded(&mut window);
    window.state_mut().apply(Action::StopRecording);
    window.state_mut().apply(Action::OpenRecording(file));
    show_events(&mut window);
    until(&mut window, "its events", |window| has_row(window, &["Found at"]));
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    window.get_by_label_contains("All (").click();
    click(&mut window, Role::RadioButton, "JSON Lines");
    click(&mut window, Role::RadioButton, "One row for each sample");
    click(&mut window, Role::Button, "Save…");
    let path = folder.path().join("readings.jsonl");
    write_into(&mut window, "Path", path.to_str().unwrap());
    click(&mut window, Role::Button, "Save");
    until(&mut window, "it is written", |window| told(window, &format!("written to {}", path.display())));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.lines().count() > 20, "{text}");
    assert!(text.lines().all(|line| serde_json::from_str::<serde_json::Value>(line).is_ok()));
}

#[test]
fn a_wrong_time_is_said_before_anything_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = recording_window(&sim(&[MODULE], Pace::Skip), &folder, simulated());
    recorded(&mut window);
    show_trends(&mut window);
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    write_into(&mut window, "From", "yesterday");
    assert!(shows(&window, "\"yesterday\" is no time"));
    assert!(window.get_by_role_and_label(Role::Button, "Save…").accesskit_node().is_disabled());
}
