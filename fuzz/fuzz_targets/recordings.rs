//! Recordings from elsewhere. Bytes that begin with `S` are the file itself; of all others the small recording of the
//! seeds gets its block, spans and words replaced (see `replace`), which goes deeper than damaged pages can.
#![no_main]

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::OnceLock;

use dcon_bench::record::{
    Archive, EventRows, Export, Format, History, Micros, Recording, Rows, SeriesId, Source, StoreError,
};
use dcon_bench_fuzz::{take_byte, take_bytes};
use jiff::tz::TimeZone;
use libfuzzer_sys::fuzz_target;
use rusqlite::{Connection, params};

const TINY: &[u8] = include_bytes!("../seeds/recordings/tiny.sqlite");
/// No file of the fuzzer's size can hold so much.
const MOST_EXPORTED: usize = 64 << 20;

/// One file for the whole run, in memory where there is such a folder.
fn path() -> &'static PathBuf {
    static FOLDER: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let make = || {
        let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder");
        let path = folder.path().join("fuzz.sqlite");
        (folder, path)
    };
    &FOLDER.get_or_init(make).1
}

fuzz_target!(|data: &[u8]| {
    let path = path();
    for ending in ["-wal", "-shm", "-journal"] {
        let _ = std::fs::remove_file(path.with_extension(format!("sqlite{ending}")));
    }
    let whole = data.first() == Some(&b'S');
    std::fs::write(path, if whole { data } else { TINY }).expect("a file");
    if !whole {
        replace(data).expect("the seed is a recording");
    }
    match read() {
        Ok(()) => {}
        Err(problem) => assert!(problem.to_string().contains("fuzz.sqlite"), "{problem} does not say of which file"),
    }
});

/// A byte without meaning, what the spans say (count, first time, width, start, value), what describes the series, a
/// fresh sample, and the block.
fn replace(data: &[u8]) -> rusqlite::Result<()> {
    let mut rest = data;
    take_byte(&mut rest);
    let mut number = |bytes: usize| {
        let mut all = [0; 8];
        let taken = take_bytes(&mut rest, bytes);
        all[..taken.len()].copy_from_slice(taken);
        i64::from_le_bytes(all)
    };
    let (count, first, width, start, value) = (number(2), number(8), number(4), number(1), number(8));
    let (decimals, at) = (number(1), number(8));
    let words = String::from_utf8_lossy(take_bytes(&mut rest, 24)).into_owned();
    let connection = Connection::open(path())?;
    connection.execute_batch("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN")?;
    connection.execute(
        "UPDATE spans SET count = ?1, first = ?2, last = ?3, start = ?4, low = min(low, ?5), sum = ?5, last_value = ?5",
        params![count, first, first.wrapping_add(width), start, value],
    )?;
    connection.execute("UPDATE series SET decimals = ?1 WHERE kind = 'number'", [decimals])?;
    connection.execute("UPDATE series SET words = ?1 WHERE kind = 'choice'", [&words])?;
    connection.execute("UPDATE fresh SET at = ?1, value = ?2 WHERE id = (SELECT max(id) FROM fresh)", [at, value])?;
    connection.execute("UPDATE blocks SET data = ?1", [rest])?;
    connection.execute_batch("COMMIT")
}

/// As the viewer does, then as `export` does.
fn read() -> Result<(), StoreError> {
    let mut recording = Recording::open(path())?;
    let mut history = recording.load()?;
    let ids: Vec<SeriesId> = history.series().map(|(id, _)| id).collect();
    for id in &ids {
        let samples = recording.samples(*id, Micros::MIN, Micros::MAX)?;
        assert!(samples.is_sorted_by(|earlier, later| earlier.at < later.at), "samples that go back");
        if let [first, .., last] = samples.as_slice() {
            let inner = recording.samples(*id, first.at + 1, last.at - 1)?;
            assert!(inner.iter().all(|sample| first.at < sample.at && sample.at < last.at));
        }
        draw(&history, *id);
        history.fill(*id, &samples);
        draw(&history, *id);
    }
    assert!(!recording.refresh(&mut history)?, "nobody wrote, and there is news");
    for event in history.events() {
        assert!(event.module.is_none_or(|module| history.module_info(module).is_some()));
    }
    export(&history, &ids);
    Ok(())
}

/// The plots over all, over its middle, and the statistics of both.
fn draw(history: &History, id: SeriesId) {
    let Some(series) = history.get(id) else { return };
    let trend = &series.trend;
    let (Some(first), Some(last)) = (trend.first(), trend.last()) else { return };
    let [last, _] = last;
    let quarter = (last - first) / 4.0;
    for (from, to) in [(first, last), (first + quarter, last - quarter), (f64::MIN, f64::MAX)] {
        let points: usize = trend.lines(from, to, 50).iter().map(Vec::len).sum();
        assert!(points <= 4_000, "{points} points for 50 columns");
        if let Some(statistics) = trend.statistics(from, to) {
            assert!(!format!("{statistics:?}").is_empty());
        }
        let _ = trend.around(from);
    }
    if let Some(point) = trend.last_sample() {
        assert!(!series.info.text(point.value).is_empty());
    }
}

/// What is counted and thrown away.
struct Sink(usize);

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len();
        assert!(self.0 < MOST_EXPORTED, "an export without end");
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn export(history: &History, ids: &[SeriesId]) {
    let go_on = |_| ControlFlow::Continue(());
    for (format, rows) in
        [(Format::Csv, Rows::PerTime), (Format::JsonLines, Rows::PerSample), (Format::Parquet, Rows::Within(500_000))]
    {
        let archive = Recording::open(path()).ok().map(|mut recording| {
            let _ = recording.load();
            Box::new(recording) as Box<dyn Archive>
        });
        let source = Source::new(history, ids, None, None, archive);
        if let Err(problem) = Export::run(source, format, rows, &TimeZone::UTC, Sink(0), go_on) {
            assert!(!problem.to_string().is_empty());
        }
    }
    let modules: Vec<_> = history.modules().map(|(id, _)| id).collect();
    let events = EventRows::new(history, &modules, None, None);
    if let Err(problem) = Export::run_events(events, Format::JsonLines, &TimeZone::UTC, Sink(0), go_on) {
        assert!(!problem.to_string().is_empty());
    }
}
