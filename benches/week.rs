//! A week of 32 modules at one poll a second: what it takes in memory and on the disk.
//!
//! `cargo bench --bench week`, some minutes; `DCON_BENCH_DAYS=1` makes it shorter. Values move as in a room: temperatures and
//! humidities by noise of some hundredths, motion now and then.

use std::time::{Duration, Instant};

use dcon_bench::record::{Destination, History, ModuleInfo, Recorder, SeriesId, SeriesInfo, SeriesKind, seconds};

const MODULES: u8 = 32;
const DAY: i64 = 86_400;
/// 2026-01-01, in seconds since 1970 UTC.
const START: i64 = 1_767_225_600;
/// The recording is given so much at a time, in seconds of the week.
const AT_ONCE: i64 = 60;

const NUMBERS: [(&str, &str, i64); 5] = [
    ("temperature_c", "°C", 2_250),
    ("temperature_f", "°F", 7_250),
    ("humidity", "%", 4_800),
    ("dew_point_c", "°C", 1_100),
    ("dew_point_f", "°F", 5_180),
];
const SWITCHES: [&str; 7] = ["pir1", "pir2", "pir3", "pir4", "do0", "do1", "alarm_active"];

fn main() {
    let days = std::env::var("DCON_BENCH_DAYS").ok().and_then(|days| days.parse().ok()).unwrap_or(7);
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let file = folder.path().join("week.sqlite");
    let before = resident();
    let mut history = History::default();
    let series = series(&mut history);
    let mut recorder = Recorder::start(Destination::File(file), || {}).expect("a thread");
    history.begin_news();
    let (begin, mut noise) = (Instant::now(), Noise(1));
    let mut highest = 0;
    for second in 0..days * DAY {
        measure(&mut history, &series, second, &mut noise);
        if second % AT_ONCE == 0 {
            recorder.put(history.take_news());
            wait_for_disk(&recorder);
            history.tidy(recorder.status().saved_until, true);
            highest = highest.max(resident());
        }
    }
    recorder.put(history.take_news());
    let after = resident();
    let status = recorder.finish().expect("the recording is written");
    let count: u64 = history.series().map(|(_, one)| one.trend.len()).sum();
    println!("{MODULES} modules, {} series, {days} days at 1 Hz: {count} samples", series.len());
    println!("memory: {} before, {} at the end, {} at most", mega(before), mega(after), mega(highest));
    println!("disk: {}, {:.2} bytes a sample", mega(status.bytes), status.bytes as f64 / count.max(1) as f64);
    println!(
        "recorded in {:.0} s, {:.0} samples/s",
        begin.elapsed().as_secs_f64(),
        count as f64 / begin.elapsed().as_secs_f64()
    );
    look(&history);
}

fn series(history: &mut History) -> Vec<(SeriesId, i64)> {
    let mut all = Vec::new();
    for address in 1..=MODULES {
        let module = history.module(ModuleInfo { address, label: "PIR-234".into(), ..ModuleInfo::default() });
        let info = |item: &str, unit: &str, kind| SeriesInfo {
            module,
            item: item.into(),
            label: item.into(),
            unit: unit.into(),
            kind,
        };
        for (item, unit, value) in NUMBERS {
            all.push((history.series_for(info(item, unit, SeriesKind::Number { decimals: 2 })), value));
        }
        for item in SWITCHES {
            all.push((history.series_for(info(item, "", SeriesKind::Switch)), 0));
        }
    }
    all
}

fn measure(history: &mut History, series: &[(SeriesId, i64)], second: i64, noise: &mut Noise) {
    let daily = ((second % DAY) as f64 / DAY as f64 * std::f64::consts::TAU).sin();
    for (place, (id, middle)) in series.iter().enumerate() {
        let random = noise.next();
        // Answers come in turn, a little early or late.
        let at = (START + second) * 1_000_000 + place as i64 * 2_000 + (random % 1_500) as i64;
        let value = match middle {
            0 => i64::from((second / 37 + place as i64) % 29 == 0),
            middle => middle + (daily * 200.0) as i64 + (random >> 20) as i64 % 7 - 3,
        };
        history.push(*id, at, value);
    }
}

/// A disk that is slower than the simulated week holds it up, as it would never hold up a real one.
fn wait_for_disk(recorder: &Recorder) {
    while recorder.status().waiting > 500_000 {
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn look(history: &History) {
    let Some([from, to]) = history.span() else { return };
    let begin = Instant::now();
    let points: usize = history
        .series()
        .take(16)
        .map(|(_, one)| one.trend.lines(seconds(from), seconds(to), 1_000).concat().len())
        .sum();
    println!("16 series of the whole time: {points} points in {:.2} ms", begin.elapsed().as_secs_f64() * 1e3);
}

/// Bytes of this process in memory; nothing is known of it but on Linux.
fn resident() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    let pages = pages.and_then(|text| text.split_whitespace().nth(1)?.parse::<u64>().ok());
    pages.unwrap_or_default() * 4_096
}

fn mega(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

/// Good enough for values (xorshift).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
}
