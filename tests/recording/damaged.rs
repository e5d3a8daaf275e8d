//! Files that are damaged: whatever stands in them, nothing panics, and what is read is in order.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use dcon_bench::record::{Archive, Micros, Recorder, Recording};
use proptest::prelude::*;

use crate::common::{SECOND, START, described, file, record};

/// A small recording with rows and blocks.
fn whole() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sqlite");
        let mut recorder = Recorder::start(file(&path), || {}).unwrap();
        recorder.put(described(3));
        recorder.put((0..9_000).map(|n| record(n as u32 % 3, START + n * SECOND, n % 70)).collect());
        recorder.put((9_000..9_300).map(|n| record(n as u32 % 3, START + n * SECOND, n % 70)).collect());
        recorder.finish().unwrap();
        fs::read(&path).unwrap()
    })
}

fn look_at_all(path: &Path) {
    let Ok(mut recording) = Recording::open(path) else { return };
    let Ok(mut history) = recording.load() else { return };
    let _ = recording.refresh(&mut history);
    for (id, series) in history.series() {
        let _ = series.trend.statistics(0.0, 4e9);
        let _ = series.trend.lines(0.0, 4e9, 100);
        if let Ok(samples) = recording.samples(id, Micros::MIN, Micros::MAX) {
            assert!(samples.is_sorted_by(|earlier, later| earlier.at < later.at));
        }
    }
    for (id, ..) in history.series().map(|(id, _)| (id,)).collect::<Vec<_>>() {
        if let Ok(samples) = recording.samples(id, Micros::MIN, Micros::MAX) {
            history.fill(id, &samples);
        }
    }
}

fn try_out(bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.sqlite");
    fs::write(&path, bytes).unwrap();
    look_at_all(&path);
    let mut recorder = Recorder::start(file(&path), || {}).unwrap();
    recorder.put(described(3));
    recorder.put(vec![record(0, START + 20_000 * SECOND, 1)]);
    // What cannot be written is told.
    let _ = recorder.finish();
    look_at_all(&path);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn flipped_bytes_do_no_harm(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..40)) {
        let mut bytes = whole().to_vec();
        for (place, byte) in flips {
            let place = place.index(bytes.len());
            bytes[place] ^= byte;
        }
        try_out(&bytes);
    }

    #[test]
    fn a_file_that_was_cut_does_no_harm(part in 0.0f64..1.0) {
        let bytes = whole();
        try_out(&bytes[..(bytes.len() as f64 * part) as usize]);
    }

    /// Rows that no sound writer makes, in a database that is sound.
    #[test]
    fn senseless_rows_are_left_out(
        column in prop::sample::select(vec![
            "spans SET first", "spans SET last", "spans SET count", "spans SET low", "spans SET high", "spans SET sum",
            "spans SET on_time", "spans SET observed", "spans SET block", "spans SET start", "spans SET series",
            "fresh SET at",
            "fresh SET value", "fresh SET series", "fresh SET gap", "series SET decimals", "series SET module",
            "series SET kind", "series SET words", "modules SET address", "modules SET label", "blocks SET data",
            "counters SET value",
        ]),
        value in prop::sample::select(vec![
            "-1", "0", "1", "9223372036854775807", "-9223372036854775808", "NULL", "'text'", "x'00ff80'", "1.5e300",
            "rowid + 7",
            "zeroblob(100000)", "1790000100000000",
        ]),
        which in prop::sample::select(vec!["", " WHERE rowid % 2 = 0"]),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("strange.sqlite");
        fs::write(&path, whole()).unwrap();
        let connection = rusqlite::Connection::open(&path).unwrap();
        let _ = connection.execute_batch("PRAGMA foreign_keys = OFF");
        let which = if column.starts_with("spans") || column.starts_with("counters") { "" } else { which };
        // Some are refused by the tables themselves.
        let _ = connection.execute_batch(&format!("UPDATE OR IGNORE {column} = {value}{which}"));
        drop(connection);
        look_at_all(&path);
        try_out(&fs::read(&path).unwrap());
    }
}
