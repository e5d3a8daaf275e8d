//! The program is killed while it records, again and again.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use dcon_bench::record::{Micros, Recorder, Sample, micros_of};
use jiff::Timestamp;

use crate::common::{described, file, read, record};

const SERIES: u32 = 16;
const KILLS: i64 = 20;
/// Values of a run begin at its number times this.
const RUN: i64 = 1_000_000;
const CHILD: &str = "DCON_BENCH_TEST_RECORDER";

fn now() -> Micros {
    micros_of(Timestamp::now())
}

/// Not a test by itself: the program that is killed. It says what it has handed over.
#[test]
fn child_records_until_it_is_killed() {
    let Ok(task) = std::env::var(CHILD) else { return };
    let (run, path) = task.split_once(' ').unwrap();
    let mut recorder = Recorder::start(file(Path::new(path)), || {}).unwrap();
    recorder.put(described(SERIES));
    let mut value = run.parse::<i64>().unwrap() * RUN;
    loop {
        let at = now();
        recorder.put((0..SERIES).map(|series| record(series, at, value)).collect());
        let mut out = std::io::stdout().lock();
        writeln!(out, "sample {at} {value}").and_then(|()| out.flush()).unwrap();
        drop(out);
        value += 1;
        std::thread::sleep(Duration::from_millis(8));
    }
}

/// What a child has handed over until it was killed, and when that was.
fn run_and_kill(path: &Path, run: i64, after: Duration) -> (Vec<(Micros, i64)>, Micros) {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "kill::child_records_until_it_is_killed", "--nocapture", "--test-threads=1"])
        .env(CHILD, format!("{run} {}", path.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let (tell_first, first) = channel();
    let listen = std::thread::spawn(move || {
        let mut put = Vec::new();
        for line in lines.map_while(Result::ok) {
            let mut words = line.split(' ').skip_while(|word| !word.ends_with("sample")).skip(1);
            if let (Some(Ok(at)), Some(Ok(value))) = (words.next().map(str::parse), words.next().map(str::parse)) {
                put.push((at, value));
                let _ = tell_first.send(());
            }
        }
        put
    });
    first.recv_timeout(Duration::from_secs(60)).unwrap();
    let until = Instant::now() + after;
    std::thread::sleep(until.saturating_duration_since(Instant::now()));
    child.kill().unwrap();
    let killed = now();
    child.wait().unwrap();
    (listen.join().unwrap(), killed)
}

/// Numbers without a pattern, the same in every run.
fn scattered(n: u64) -> u64 {
    (n + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 33
}

#[test]
fn whenever_it_is_killed_all_that_is_older_than_a_second_is_there_once_and_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("killed.sqlite");
    let mut runs = Vec::new();
    for run in 0..KILLS {
        let after = Duration::from_millis(50 + scattered(run as u64) % 1_400);
        runs.push(run_and_kill(&path, run, after));
        let all = read(&path);
        assert_eq!(all.len(), SERIES as usize);
        for samples in &all {
            check(samples, &runs);
        }
    }
    let blocks = "SELECT count(*) FROM spans";
    let connection = rusqlite::Connection::open(&path).unwrap();
    assert!(connection.query_row(blocks, [], |row| row.get::<_, i64>(0)).unwrap() > 0, "rows have become blocks");
    assert!(runs.iter().any(|(put, killed)| put.iter().any(|(at, _)| killed - at > 1_000_000)));
}

fn check(samples: &[Sample], runs: &[(Vec<(Micros, i64)>, Micros)]) {
    assert!(samples.is_sorted_by(|earlier, later| earlier.at < later.at && earlier.value < later.value));
    let mut rest = samples;
    for (run, (put, killed)) in (0..).zip(runs) {
        let count = rest.partition_point(|sample| sample.value < (run + 1) * RUN);
        let (found, later) = rest.split_at(count);
        rest = later;
        let safe = put.iter().filter(|(at, _)| *at <= killed - 1_000_000).count();
        assert!(found.len() >= safe, "run {run}: {} samples of {safe} that were safe", found.len());
        // The last may have been written before it could be said.
        assert!(found.len() <= put.len() + 1, "run {run}: {} samples of {}", found.len(), put.len());
        for (sample, (at, value)) in found.iter().zip(put) {
            assert_eq!((sample.at, sample.value), (*at, *value));
        }
        for (place, sample) in found.iter().enumerate() {
            assert_eq!(sample.value, run * RUN + place as i64);
            assert_eq!(sample.gap, place == 0 && run > 0 && samples[0].value < run * RUN);
        }
    }
    assert!(rest.is_empty());
}
