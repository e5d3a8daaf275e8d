//! Recordings read by another program.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use crate::common::{SECOND, START, Watched, described, file, read, record};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/recording/read.py");

/// What the script prints; `None` where there is no Python, which must not be where readers are required.
fn by_python(path: &Path) -> Option<String> {
    let output = match Command::new("python3").arg(SCRIPT).arg(path).output() {
        Ok(output) => output,
        Err(error) => {
            let required = std::env::var("DCON_BENCH_READERS").is_ok_and(|readers| readers == "required");
            assert!(!required, "python3 is required: {error}");
            return None;
        }
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap().replace("\r\n", "\n"))
}

fn as_csv(path: &Path) -> String {
    let mut all = String::from("line,module,item,time,value,gap\n");
    for (number, samples) in read(path).iter().enumerate() {
        for sample in samples {
            let gap = u8::from(sample.gap);
            let value = format!("{:.2}", sample.value as f64 / 100.0);
            writeln!(all, "COM3,PIR-234@1,reading_{number},{},{value},{gap}", sample.at).unwrap();
        }
    }
    all
}

#[test]
fn python_reads_the_same_samples_from_rows_and_blocks_while_it_grows_and_afterwards() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    for run in 0..2 {
        let mut watched = Watched::start(file(&path));
        watched.recorder.put(described(3));
        let value = |n: i64, series: i64| (n * 37 % 101 - 50) * (series + 1) * if n % 500 == 0 { 1_000_000 } else { 1 };
        let at = |n: i64| START + (run * 10_000 + n) * SECOND + n * n % 977;
        let mut count = 0;
        for portion in [0..2_900, 2_900..3_100] {
            let records =
                portion.flat_map(|n| (0..3).map(move |series| record(series, at(n), value(n, i64::from(series)))));
            let records: Vec<_> = records.collect();
            count += records.len() as u64;
            watched.recorder.put(records);
            watched.wait(|status| status.waiting == 0 && status.samples >= count);
        }
        match by_python(&path) {
            Some(text) => assert_eq!(text, as_csv(&path)),
            None => return,
        }
        watched.recorder.finish().unwrap();
    }
    assert_eq!(by_python(&path).unwrap(), as_csv(&path));
}
