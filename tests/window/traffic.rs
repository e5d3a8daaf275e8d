//! The traffic view: every frame of the line, decoded, filtered, copied and exported.

use std::sync::Arc;
use std::time::Duration;

use dcon_bench::bench::Bench;
use dcon_bench::bus::{Bus, BusEvent, Direction, Frame, LineAddress, Verdict};
use dcon_bench::module::Catalogue;
use dcon_bench::protocol::{LineSettings, Protocol, modbus};
use dcon_bench::sim::{Pace, Sim};
use dcon_bench::ui::{App, Settings, Start};
use eframe::egui::OutputCommand;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use jiff::{SignedDuration, Timestamp};

use crate::harness::*;

/// A window that asks for paths in a field.
pub fn window_with_field(sim: &Sim) -> Window {
    let start = start(sim, false, simulated());
    window_of(move |ctx| App::new(ctx, bench(ctx), start).without_system_dialogs())
}

/// A window whose bus is played by the test, with these frames in its log.
fn played(frames: Vec<Frame>) -> (Window, std::sync::mpsc::SyncSender<BusEvent>) {
    let (bus, _commands, events) = Bus::detached();
    let mut bench = Bench::new(bus, Arc::new(Catalogue::built_in().0), &[]);
    frames.into_iter().for_each(|frame| bench.take(BusEvent::Traffic(frame)));
    let start = Start { simulated: LineAddress::demo(), demo: false, settings: Settings::default() };
    let window = window_of(move |ctx| App::new(ctx, bench, start).without_system_dialogs());
    (window, events)
}

fn frame(index: i64, bytes: &[u8], protocol: Protocol, verdict: Verdict) -> Frame {
    let start: Timestamp = "2026-03-02T09:30:00Z".parse().unwrap();
    Frame {
        at: start + SignedDuration::from_millis(index * 20),
        direction: if verdict == Verdict::Request { Direction::Sent } else { Direction::Received },
        bytes: bytes.to_vec(),
        protocol,
        settings: LineSettings::default(),
        address: Some(1),
        checksum: false,
        took: Duration::from_millis(if verdict == Verdict::Request { 8 } else { 12 }),
        first_byte: None,
        echo: false,
        noise: false,
        verdict,
    }
}

pub fn rows(window: &Window) -> Vec<String> {
    window.query_all_by_role(Role::Row).filter_map(|node| node.accesskit_node().label()).collect()
}

pub fn has_row(window: &Window, parts: &[&str]) -> bool {
    rows(window).iter().any(|row| parts.iter().all(|part| row.contains(part)))
}

pub fn search(window: &mut Window, text: &str) {
    window.get_by_role_and_label(Role::TextInput, "Search").focus();
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Search").type_text(text);
    window.step();
    window.step();
}

/// Writes the file through the field for paths, and waits for the notice.
pub fn save_to(window: &mut Window, entry: &str, path: &std::path::Path) {
    click(window, Role::Button, "Export");
    click(window, Role::Button, entry);
    save_to_from(window, path);
}

/// Writes the path into the field that has been asked for, and waits until the file is there.
pub fn save_to_from(window: &mut Window, path: &std::path::Path) {
    until(window, "the field", |window| window.query_by_role_and_label(Role::TextInput, "Path").is_some());
    window.step();
    window.key_press_modifiers(eframe::egui::Modifiers::COMMAND, eframe::egui::Key::A);
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Path").type_text(path.to_str().unwrap());
    window.step();
    click(window, Role::Button, "Save");
    until(window, "it is written", |window| {
        window.state().bench().notices().any(|notice| notice.text.contains(&format!("written to {}", path.display())))
    });
}

#[test]
fn a_poll_is_decoded_and_silence_is_marked() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Button, "Traffic");
    until(&mut window, "a decoded answer", |window| has_row(window, &["Received", "temperature_c", "OK"]));
    sim.set_dead(1, true);
    until(&mut window, "the silence", |window| has_row(window, &["Received", "No answer"]));
    click(&mut window, Role::CheckBox, "Only errors");
    until(&mut window, "only errors", |window| {
        let rows = rows(window);
        !rows.is_empty() && rows.iter().all(|row| row.contains("No answer"))
    });
}

#[test]
fn a_click_shows_the_fields_of_a_frame_and_copy_copies_it() {
    let request = modbus::with_crc(&[1, 4, 1, 0xE5, 0, 1]);
    let broken = frame(1, &[1, 4, 2, 0, 0, 1, 1], Protocol::ModbusRtu, Verdict::Broken("wrong CRC: 0101".to_owned()));
    let dcon = [
        frame(2, b"$01M\r", Protocol::Dcon, Verdict::Request),
        frame(3, b"!01PIR234\r", Protocol::Dcon, Verdict::Answer),
    ];
    let first = frame(0, &request, Protocol::ModbusRtu, Verdict::Request);
    let (mut window, _events) = played([vec![first, broken], dcon.to_vec()].concat());
    click(&mut window, Role::Button, "Traffic");
    assert!(has_row(&window, &["Sent", "01 04 01 E5 00 01"]));
    assert!(has_row(&window, &["Received", "wrong CRC: 0101", "Broken"]));
    assert!(has_row(&window, &["Received", "!01PIR234", "OK"]));
    assert!(shows(&window, "Click a frame to see its fields"));
    let answer = |window: &Window| rows(window).into_iter().find(|row| row.contains("!01PIR234")).unwrap();
    let label = answer(&window);
    window.get_by_role_and_label(Role::Row, &label).click_accesskit();
    window.step();
    window.step();
    assert!(shows(&window, "Request") && shows(&window, "Answer"));
    assert!(shows(&window, "24 30 31 4D 0D"), "its request's bytes");
    click(&mut window, Role::Button, "Copy");
    window.get_by_role_and_label(Role::Button, "Chosen rows").click_accesskit();
    window.step();
    let mut copied = String::new();
    for _ in 0..3 {
        for command in &window.output().platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                copied.clone_from(text);
            }
        }
        window.step();
    }
    assert!(
        copied.contains("!01PIR234\\r") && copied.lines().count() == 2 && copied.starts_with("Time (UTC)\tDirection"),
        "{copied:?}"
    );
}

#[test]
fn a_search_finds_bytes_text_and_trouble() {
    let request = modbus::with_crc(&[1, 4, 1, 0xE5, 0, 1]);
    let frames = vec![
        frame(0, &request, Protocol::ModbusRtu, Verdict::Request),
        frame(1, &[], Protocol::ModbusRtu, Verdict::Silent),
        frame(2, b"$01M\r", Protocol::Dcon, Verdict::Request),
    ];
    let (mut window, _events) = played(frames);
    click(&mut window, Role::Button, "Traffic");
    search(&mut window, "01E5");
    assert!(has_row(&window, &["01 E5"]) && rows(&window).len() == 1, "{:?}", rows(&window));
    assert!(shows(&window, "1 of 3 frames"));
    click(&mut window, Role::Button, "Clear filter");
    search(&mut window, "$01m");
    assert!(has_row(&window, &["$01M"]) && rows(&window).len() == 1, "{:?}", rows(&window));
}

#[test]
fn two_hundred_thousand_frames_lay_out_what_is_in_view_and_pause_holds() {
    let pair = |index: i64| {
        let request = modbus::with_crc(&[1, 4, 0, 0, 0, 1]);
        let answer = modbus::with_crc(&[1, 4, 2, 0x0B, 0xB8]);
        let request = frame(2 * index, &request, Protocol::ModbusRtu, Verdict::Request);
        [request, frame(2 * index + 1, &answer, Protocol::ModbusRtu, Verdict::Answer)]
    };
    let (mut window, events) = played((0..100_000).flat_map(pair).collect());
    click(&mut window, Role::Button, "Traffic");
    until(&mut window, "the end is in view", |window| rows(window).last().is_some_and(|row| row.contains(":39.980")));
    window.step();
    assert!((10..60).contains(&rows(&window).len()), "{}", rows(&window).len());
    let newest = rows(&window).last().cloned().unwrap();
    assert!(shows(&window, "200 000 frames"));
    click(&mut window, Role::CheckBox, "Pause");
    for frame in (100_000..100_050).flat_map(pair) {
        events.send(BusEvent::Traffic(frame)).unwrap();
    }
    until(&mut window, "it counts on", |window| shows(window, "200 000 of 200 100 frames"));
    assert_eq!(rows(&window).last(), Some(&newest));
    click(&mut window, Role::CheckBox, "Follow");
    until(&mut window, "it goes on", |window| shows(window, "200 100 frames"));
    window.step();
    assert_ne!(rows(&window).last(), Some(&newest));
    click(&mut window, Role::Button, "Clear");
    until(&mut window, "it is empty", |window| shows(window, "No traffic yet"));
}

#[test]
fn exported_frames_can_be_read_by_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window_with_field(&sim);
    open(&mut window, "PIR-234, address 1");
    click(&mut window, Role::Button, "Traffic");
    until(&mut window, "a decoded answer", |window| has_row(window, &["Received", "temperature_c"]));
    let path = folder.path().join("frames.csv");
    save_to(&mut window, "Frames as CSV…", &path);
    let mut reader = csv::Reader::from_path(&path).unwrap();
    assert_eq!(reader.headers().unwrap().iter().next(), Some("time"));
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert!(records.iter().any(|record| record.iter().any(|field| field.contains("temperature_c"))));
    let path = folder.path().join("frames.jsonl");
    save_to(&mut window, "Frames as JSON Lines…", &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.lines().count() >= records.len());
    for line in text.lines() {
        let row: serde_json::Value = serde_json::from_str(line).unwrap();
        assert!(row["time"].is_string() && row["verdict"].is_string());
    }
    for (item, name) in [("Frames as pcapng (Wireshark)…", "frames.pcapng"), ("Frames as text…", "frames.txt")] {
        let path = folder.path().join(name);
        save_to(&mut window, item, &path);
        let frames = dcon_bench::capture::read_file(&path).unwrap().collect::<Result<Vec<_>, _>>().unwrap();
        assert!(frames.len() >= records.len(), "{name}: {} of {}", frames.len(), records.len());
    }
}
