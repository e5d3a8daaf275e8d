//! Writes the seeds anew: `cargo run --example seeds`, in this folder.

use std::error::Error;
use std::fs;
use std::path::Path;

use dcon_bench::protocol::{dcon, hex};
use dcon_bench::record::{
    Destination, Event, EventKind, History, ModuleInfo, Recorder, SeriesInfo, SeriesKind, timestamp,
};
use dcon_bench_fuzz::sums;
use rusqlite::Connection;

type Outcome = Result<(), Box<dyn Error>>;

/// 2026-03-02 08:00 UTC.
const START: i64 = 1_772_438_400_000_000;

fn main() -> Outcome {
    dcon_answers()?;
    module_settings()?;
    judge()?;
    definitions()?;
    recordings()
}

fn put(target: &str, name: &str, bytes: &[u8]) -> Outcome {
    let folder = Path::new("seeds").join(target);
    fs::create_dir_all(&folder)?;
    Ok(fs::write(folder.join(name), bytes)?)
}

/// The manuals' examples, and conversations made of them.
fn dcon_answers() -> Outcome {
    let vectors = include_str!("../../tests/vectors/dcon-checksum.csv");
    let frames = vectors.lines().skip(1).filter_map(|row| row.split_once(',')).map(|(text, _)| text);
    for (number, text) in frames.filter(|text| text.starts_with(['!', '>', '?'])).enumerate() {
        put("dcon_answers", &format!("example-{number}"), &[b"0", dcon::encode(text, false).as_slice()].concat())?;
        put("dcon_answers", &format!("example-{number}-sum"), &[b"1", dcon::encode(text, true).as_slice()].concat())?;
    }
    let talk = ["!01PIR130", "!01A1.0", "!01400600", "!010BB8", ">011", "!0101", "!01+090.50", ">0100101", "?01", "!"];
    for (model, checksum) in [(0u8, false), (0, true), (1, false), (1, true), (2, false), (3, true)] {
        let frames: Vec<u8> = talk.iter().flat_map(|text| dcon::encode(text, checksum)).collect();
        let choice = b'0' + model * 2 + u8::from(checksum);
        put("dcon_answers", &format!("talk-{model}-{checksum}"), &[&[choice], frames.as_slice()].concat())?;
    }
    put("dcon_answers", "noise", b"0\x00\xFF$01M\r!01PIR234E\r\n>+030.00+086.00+050.00\r")
}

/// Published answers, each with the request it belongs to, and a module's whole conversation.
fn module_settings() -> Outcome {
    let vectors = include_str!("../../tests/vectors/modbus-rtu.csv");
    let answers = vectors.lines().skip(1).filter_map(|row| row.rsplit(',').next());
    for (number, answer) in answers.filter(|answer| !answer.is_empty()).enumerate() {
        let answer = hex::parse(answer)?;
        let request = match answer.as_slice() {
            [_, 0x46, 5, ..] => 2,
            [_, 0x46 | 0xC6, ..] => 0,
            [_, 5, ..] => 10,
            [_, 6, ..] => 11,
            _ => 9,
        };
        put("module_settings", &format!("example-{number}"), &[&[request], answer.as_slice()].concat())?;
    }
    let name = [4, 0x00, 0x01, 0x00, 0x00, 0x02, 0x34, 0x50, 0x49];
    let talk: Vec<u8> = (0..24u8).flat_map(|n| [2, 0, n, 0x0B, 0xB8, 0, 1]).collect();
    put("module_settings", "pir-130-refuses", &[&[0, 0xFE, 2, 5, 0, 0x54, 0x20, 0x26, 0], talk.as_slice()].concat())?;
    put("module_settings", "pir-234-rtu", &[&[0x18], name.as_slice(), talk.as_slice()].concat())?;
    put("module_settings", "pir-234-tcp", &[&[0x38], name.as_slice(), talk.as_slice()].concat())?;
    put("module_settings", "wrong-lengths", &[0x09, 0xFC, 3, 1, 2, 3, 4, 5, 6, 0xFD, 0xFF, 0xFE, 6])
}

/// One of each step, for both languages.
fn judge() -> Outcome {
    let steps: [(&str, &[u8]); 8] = [
        ("good", &[2, 0x80, 0xC0, 2, 0x80, 0xC0]),
        ("echo", &[0x84, 3, 0x80, 0xC0, 0x84, 0x80, 0xC0]),
        ("late", &[0xC0, 0x3F, 0x80, 0xC0, 0x80]),
        ("cut", &[1, 0x81, 4, 0xC0, 0x80]),
        ("flipped", &[1, 0x82, 30, 0x80, 0xC0]),
        ("elsewhere", &[1, 0x83, 2, 5, 0x80, 0xC0]),
        ("noise", &[0x42, 0x00, 0xFF, 0x80, 0x86, 40, 0xC0, 0x85, 3, 0x80]),
        ("refused", &[9, 0x87, 0xC0, 0x80, 0xC0, 0xFF]),
    ];
    for (name, steps) in steps {
        for (language, head) in [("rtu", [12, 0]), ("dcon", [13, 0]), ("dcon-sum", [31, 0]), ("settings", [28, 4])] {
            put("judge", &format!("{name}-{language}"), &[&head, steps].concat())?;
        }
    }
    let frame = sums::with_crc(&[10, 3, 8, 1, 0, 0, 0, 2, 0x34, 0x50, 0x49]);
    put("judge", "raw-frame", &[&[12, 0, 1, 0x40 + frame.len() as u8], frame.as_slice(), &[0xC0]].concat())
}

/// The definitions that come with the program, one based on another, and what is wrong in small.
fn definitions() -> Outcome {
    for name in ["pir-130", "pir-230", "pir-234", "dl-302"] {
        put("definitions", &format!("{name}.toml"), &fs::read(format!("../assets/modules/{name}.toml"))?)?;
    }
    put("definitions", "tm-1.toml", include_bytes!("../../tests/vectors/tm-1.toml"))?;
    put("definitions", "empty.toml", b"")?;
    put("definitions", "based.toml", b"id = \"tm-2\"\nlabel = \"TM-2\"\nbased_on = \"tm-1\"\n")
}

/// A module, a series of each kind, a block and what is not in one yet, in pages as small as there are.
fn recordings() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("tiny.sqlite");
    let mut recorder = Recorder::start(Destination::File(path.clone()), || {})?;
    recorder.put(small_history().take_news());
    recorder.finish()?;
    let connection = Connection::open(&path)?;
    connection.query_row("PRAGMA journal_mode = DELETE", [], |_| Ok(()))?;
    connection.execute_batch("PRAGMA page_size = 512; VACUUM")?;
    drop(connection);
    let file = fs::read(&path)?;
    put("recordings", "tiny.sqlite", &file)?;
    put("recordings", "cut.sqlite", &file[..file.len() / 2])?;
    put("recordings", "beginning.sqlite", &file[..100])?;
    put("recordings", "replaced", &replaced())
}

fn small_history() -> History {
    let mut history = History::default();
    history.begin_news();
    let module = history.module(ModuleInfo {
        line: "Simulated line".to_owned(),
        address: 1,
        protocol: "modbus_rtu".to_owned(),
        baud_rate: Some(9_600),
        data_format: Some("n81".to_owned()),
        checksum: false,
        model: "pir-234".to_owned(),
        label: "PIR-234".to_owned(),
        name: "PIR234E".to_owned(),
        firmware: "1.0".to_owned(),
    });
    let words = vec!["low".to_owned(), "high".to_owned()];
    let kinds = [SeriesKind::Number { decimals: 2 }, SeriesKind::Switch, SeriesKind::Choice { words }];
    for (item, kind) in ["temperature_c", "relay", "output_active_state"].into_iter().zip(kinds) {
        let long = item == "temperature_c";
        let (label, unit) = (item.to_owned(), if long { "°C" } else { "" }.to_owned());
        let id = history.series_for(SeriesInfo { module, item: item.to_owned(), label, unit, kind });
        for place in 0..if long { 700 } else { 8 } {
            history.push(id, START + place * 1_000_000, if long { 2_500 + place % 7 } else { place % 2 });
        }
        history.mark_gap(id);
        history.push(id, START + 900_000_000, 1);
    }
    let text = "answers again".to_owned();
    history.add_event(Event { at: timestamp(START), module: Some(module), kind: EventKind::Note, text, change: None });
    history
}

/// Three samples that fit what their span says.
fn replaced() -> Vec<u8> {
    let mut bytes = vec![b'r'];
    bytes.extend(3u16.to_le_bytes());
    bytes.extend(1_000_000i64.to_le_bytes());
    bytes.extend(2_000_000u32.to_le_bytes());
    bytes.push(0);
    bytes.extend(2_500i64.to_le_bytes());
    bytes.push(2);
    bytes.extend(9_000_000i64.to_le_bytes());
    bytes.extend(br#"["low","high"]          "#);
    // Twice a million microseconds in zigzag and the bit of the gap, then no change of pace.
    bytes.extend([0x80, 0x92, 0xF4, 0x01, 0x88, 0x27, 0x80, 0x92, 0xF4, 0x01, 2, 0, 2]);
    bytes
}
