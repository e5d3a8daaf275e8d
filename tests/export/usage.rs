//! What is refused, and how.

use std::path::Path;

use dcon_bench::record::{
    Destination, Event, EventKind, History, ModuleInfo, Recorder, SeriesInfo, SeriesKind, timestamp,
};
use tempfile::TempDir;

use crate::program::{bad, bench, good, text};

/// 2 March 2026, 09:30 UTC.
pub const BEGIN: i64 = 1_772_443_800_000_000;
pub const SECOND: i64 = 1_000_000;

/// A recording of two modules with so many samples each, one a second.
pub fn recording(folder: &Path, samples: i64) -> String {
    let mut history = History::default();
    history.begin_news();
    for address in [1, 2] {
        let (label, protocol, line) = ("PIR-234".to_owned(), "dcon".to_owned(), "COM3".to_owned());
        let module = history.module(ModuleInfo { address, label, protocol, line, ..ModuleInfo::default() });
        let (item, label, unit) = ("temperature_c".to_owned(), "Temperature".to_owned(), "°C".to_owned());
        let kind = SeriesKind::Number { decimals: 2 };
        let id = history.series_for(SeriesInfo { module, item, label, unit, kind });
        (0..samples).for_each(|place| history.push(id, BEGIN + place * SECOND, 2000 + place % 100));
    }
    let (at, text) = (timestamp(BEGIN), "The door is open".to_owned());
    history.add_event(Event { at, module: None, kind: EventKind::Note, text, change: None });
    let path = folder.join("hall.sqlite");
    let mut recorder = Recorder::start(Destination::File(path.clone()), || {}).unwrap();
    recorder.put(history.take_news());
    recorder.finish().unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn wrong_usage_ends_with_2() {
    for (words, expected) in [
        ("record --out f", "MODULE"),
        ("record 1", "--out"),
        ("record 1:dcon:dcon --out f", "repeats"),
        ("record 1:300 --out f", "9600"),
        ("record 0 --out f", "1 to 247"),
        ("record 1:checksum --out f", "DCON"),
        ("record 1 0x01 --out f", "given twice"),
        ("record 1 --address 1 --out f", "given twice"),
        ("record 1 --protocol dcon --out f", "--address"),
        ("record 1:modbus_tcp --out f", "serial line"),
        ("record 1 --out f --interval 5", "500ms, 1s"),
        ("record 1 --out f --duration 0", "use 1ms to"),
        ("record 1 --out /no/such/folder/f", "no folder /no/such/folder"),
        ("record 1 --out /", "is a folder"),
    ] {
        let args: Vec<&str> = words.split(' ').chain(["--port", "no-such-port"]).collect();
        let said = bad(2, &args);
        assert!(said.contains(expected), "{words}: {said}");
    }
    for (words, expected) in [
        ("export", "FILE"),
        ("export f --format xml", "csv, jsonl or parquet"),
        ("export f --rows column", "time or sample"),
        ("export f --from yesterday", "such as -1h"),
        ("export f --events --series pir", "--series"),
        ("export f --events --format parquet", "csv or jsonl"),
        ("export f --rows sample --within 1s", "--within"),
        ("export f --list --from 09:30", "--list"),
        ("export f --out /", "is a folder"),
        ("export f --out f.xlsx", "use one of csv, jsonl, parquet"),
        ("record --tcp localhost:1 1:dcon --out f", "DCON is not spoken"),
        ("record --tcp localhost:1 1:9600 --out f", "leave them out"),
    ] {
        let args: Vec<&str> = words.split(' ').collect();
        let said = bad(2, &args);
        assert!(said.contains(expected), "{words}: {said}");
    }
}

#[test]
fn what_is_no_recording_is_left_as_it_is() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("letter.txt");
    std::fs::write(&file, "Dear Ms Lopez").unwrap();
    let path = file.to_str().unwrap();
    assert!(bad(1, &["export", path]).contains(path));
    assert!(bad(1, &["record", "--demo", "1", "--out", path]).contains(path));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "Dear Ms Lopez");
    let absent = folder.path().join("absent.sqlite");
    assert!(bad(1, &["export", absent.to_str().unwrap()]).contains("absent.sqlite"));
    assert!(!absent.exists());
}

#[test]
fn a_part_of_the_time_and_of_the_series_is_taken_away() {
    let folder = TempDir::new().unwrap();
    let file = recording(folder.path(), 3_600);
    let rows = |words: &str| {
        let args: Vec<&str> = ["export", &file, "--utc"].into_iter().chain(words.split(' ')).collect();
        good(&args).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let all = rows("--format csv");
    assert_eq!(all.len(), 3_601);
    assert_eq!(all[0], "time,PIR-234@1 temperature_c [°C],PIR-234@2 temperature_c [°C]");
    assert_eq!(all[1], "2026-03-02T09:30:00.000000+00:00,20.00,20.00");
    for words in
        ["--from 10:00 --to 10:01", "--from 2026-03-02T10:00 --to -28m59s", "--from 2026-03-02T11:00+01 --to 10:01:00"]
    {
        let part = rows(words);
        assert_eq!((part.len(), &part[1], &part[61]), (62, &all[1_801], &all[1_861]), "{words}");
    }
    assert_eq!(rows("--to 2026-03-02").len(), 3_601);
    assert_eq!(rows("--series 2/temperature_c --to 09:30")[0], "time,PIR-234@2 temperature_c [°C]");
    assert_eq!(rows("--rows sample --to 09:30").len(), 3);
    assert_eq!(rows("--events")[1], "2026-03-02T09:30:00.000000+00:00,,note,The door is open,,,");
    let listed = rows("--list").join("\n");
    assert!(
        listed.contains("PIR-234@1/temperature_c  Temperature  °C  3600 samples  2026-03-02T09:30:00+00:00"),
        "{listed}"
    );

    let said = bad(2, &["export", &file, "--series", "temprature_c"]);
    assert!(said.contains("did you mean temperature_c?"), "{said}");
    let said = bad(2, &["export", &file, "--from", "10:00", "--to", "09:00"]);
    assert!(said.contains("--from is later than --to"), "{said}");
    let nothing = bench(&["export", &file, "--utc", "--from", "2026-04-01"]);
    assert_eq!((nothing.status.code(), text(&nothing.stdout).lines().count()), (Some(0), 1));
    assert!(text(&nothing.stderr).contains("from 2026-03-02T09:30:00+00:00 to 2026-03-02T10:29:59+00:00"));
}

#[test]
fn a_file_is_written_whole_in_the_format_of_its_ending() {
    let folder = TempDir::new().unwrap();
    let file = recording(folder.path(), 10);
    for (name, begin) in
        [("a.csv", &b"time,"[..]), ("a.jsonl", b"{\"time\":"), ("a.parquet", b"PAR1"), ("a.txt", b"time,")]
    {
        let out = folder.path().join(name);
        std::fs::write(&out, "old").unwrap();
        let out = out.to_str().unwrap();
        assert_eq!(good(&["export", &file, "--out", out]), format!("{out}: 10 rows\n"));
        assert!(std::fs::read(out).unwrap().starts_with(begin), "{name}");
    }
    let said = bad(2, &["export", &file, "--out", &file]);
    assert!(said.contains("recording itself"), "{said}");
    let parquet = bench(&["export", &file, "--format", "parquet"]);
    assert_eq!(parquet.stdout, std::fs::read(folder.path().join("a.parquet")).unwrap(), "a pipe takes it too");
}
