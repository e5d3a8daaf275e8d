//! What a recording costs: how fast it is written, how large it is, and how long it takes to be looked at again.
//!
//! `cargo bench --bench recording` writes 100 million samples of 16 series (`DCON_BENCH_SAMPLES` says how many else)
//! through the recorder into a temporary folder, which takes about 400 MB, and opens them again.

use std::path::Path;
use std::time::{Duration, Instant};

use dcon_bench::record::{
    Archive, Destination, Micros, ModuleId, ModuleInfo, Record, Recorder, Recording, Sample, SeriesId, SeriesInfo,
    SeriesKind, seconds,
};

const SECOND: Micros = 1_000_000;
const START: Micros = 1_790_000_000 * SECOND;
const SERIES: u32 = 16;
/// Samples of each series that are handed over at once.
const PORTION: i64 = 1_000;
/// Samples that wait before the benchmark waits too.
const WAITING: u64 = 1_000_000;

/// Which series are there.
#[derive(Clone, Copy, PartialEq)]
enum Mix {
    Temperatures,
    Switches,
    Both,
}

impl Mix {
    fn is_switch(self, series: u32) -> bool {
        match self {
            Self::Temperatures => false,
            Self::Switches => true,
            Self::Both => series % 3 == 2,
        }
    }
}

/// Numbers without a pattern, the same in every run.
struct Noise(u64);

impl Noise {
    /// From -`most` to `most`.
    fn next(&mut self, most: i64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        i64::try_from(self.0 >> 33).unwrap_or(0) % (2 * most + 1) - most
    }
}

fn described(mix: Mix) -> Vec<Record> {
    let module = ModuleInfo { line: "COM3".into(), address: 1, label: "PIR-234".into(), ..ModuleInfo::default() };
    let series = (0..SERIES).map(|n| {
        let kind = if mix.is_switch(n) { SeriesKind::Switch } else { SeriesKind::Number { decimals: 2 } };
        let (item, label, unit) = (format!("reading_{n}"), format!("Reading {n}"), "°C".to_owned());
        Record::Series(SeriesId(n), SeriesInfo { module: ModuleId(0), item, label, unit, kind })
    });
    std::iter::once(Record::Module(ModuleId(0), module)).chain(series).collect()
}

/// One sample a second, answered within three milliseconds of its time: temperatures that drift and are noisy in the
/// last digit, and motion for a minute in about ten.
struct Plant {
    mix: Mix,
    noise: Noise,
    second: i64,
    values: Vec<i64>,
}

impl Plant {
    fn new(mix: Mix) -> Self {
        let values = (0..SERIES).map(|n| if mix.is_switch(n) { 0 } else { 2_000 + 10 * i64::from(n) }).collect();
        Self { mix, noise: Noise(0x9e37_79b9_7f4a_7c15), second: 0, values }
    }

    fn portion(&mut self) -> Vec<Record> {
        let Self { mix, noise, second, values } = self;
        let mut records = Vec::with_capacity(values.len() * usize::try_from(PORTION).unwrap_or(0));
        for _ in 0..PORTION {
            *second += 1;
            for (id, value) in (0..).zip(values.iter_mut()) {
                let shown = if mix.is_switch(id) {
                    let change = if *value == 0 { noise.next(300) == 0 } else { noise.next(30) == 0 };
                    *value = if change { 1 - *value } else { *value };
                    *value
                } else {
                    *value += i64::from(noise.next(20) == 0) * noise.next(1);
                    *value + noise.next(2)
                };
                let at = START + *second * SECOND + i64::from(id) * 20_000 + noise.next(1_500);
                records.push(Record::Sample(SeriesId(id), Sample { at, value: shown, gap: false }));
            }
        }
        records
    }
}

/// How long it took to write so many samples, and how many there are.
fn write(path: &Path, mix: Mix, samples: u64) -> (Duration, u64) {
    let mut recorder = Recorder::start(Destination::File(path.to_owned()), || {}).expect("a thread");
    recorder.put(described(mix));
    let mut plant = Plant::new(mix);
    let begun = Instant::now();
    let mut written = 0;
    while written < samples {
        let records = plant.portion();
        written += records.len() as u64;
        recorder.put(records);
        while recorder.status().waiting > WAITING {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    let status = recorder.finish().expect("a disk with room");
    assert_eq!((status.samples, status.lost), (written, 0));
    (begun.elapsed(), written)
}

fn row(what: &str, number: String) {
    println!("| {what} | {number} |");
}

fn milliseconds(since: Instant) -> String {
    format!("{:.1} ms", since.elapsed().as_secs_f64() * 1e3)
}

fn size_for(folder: &Path, what: &str, mix: Mix) {
    let path = folder.join("size.sqlite");
    let (_, written) = write(&path, mix, 1_000_000);
    let size = std::fs::metadata(&path).expect("a file").len();
    row(&format!("bytes a sample, {what}"), format!("{:.2}", size as f64 / written as f64));
    std::fs::remove_file(&path).expect("a file of ours");
}

fn look(path: &Path) {
    let opening = Instant::now();
    let mut recording = Recording::open(path).expect("a recording");
    let mut history = recording.load().expect("a sound recording");
    row("open and load", milliseconds(opening));
    let span = history.span().expect("samples").map(seconds);
    let drawing = Instant::now();
    let points: usize = history
        .series()
        .flat_map(|(_, series)| series.trend.lines(span[0], span[1], 1_500))
        .map(|line| line.len())
        .sum();
    row("first lines of 16 series over everything, 1500 columns", milliseconds(drawing));
    assert!(points > 16, "{points} points");
    let fetching = Instant::now();
    let middle = micros_between(span);
    let hour = recording.samples(SeriesId(3), middle, middle + 3_600 * SECOND).expect("samples");
    row(&format!("fetch an hour from the middle ({} samples)", hour.len()), milliseconds(fetching));
    let refreshing = Instant::now();
    assert!(!recording.refresh(&mut history).expect("a sound recording"));
    row("look whether it has grown", milliseconds(refreshing));
    let going_on = Instant::now();
    Recorder::start(Destination::File(path.to_owned()), || {})
        .and_then(|recorder| recorder.finish().map_err(std::io::Error::other))
        .expect("a recording that can be continued");
    row("continue it and end at once", milliseconds(going_on));
}

fn micros_between([from, to]: [f64; 2]) -> Micros {
    dcon_bench::record::micros((from + to) / 2.0)
}

fn main() {
    let samples = std::env::var("DCON_BENCH_SAMPLES").ok().and_then(|text| text.parse().ok()).unwrap_or(100_000_000);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("large.sqlite");
    println!("| | |\n|---|---|");
    size_for(folder.path(), "temperatures", Mix::Temperatures);
    size_for(folder.path(), "switches", Mix::Switches);
    let (took, written) = write(&path, Mix::Both, samples);
    let size = std::fs::metadata(&path).expect("a file").len();
    row("samples", written.to_string());
    row("samples a second through the recorder", format!("{:.0}", written as f64 / took.as_secs_f64()));
    row("megabytes on the disk", format!("{:.1}", size as f64 / 1e6));
    row("bytes a sample, mixed", format!("{:.2}", size as f64 / written as f64));
    look(&path);
}
