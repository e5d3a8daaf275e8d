use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use dcon_bench::record::{
    Archive, Destination, History, Micros, ModuleId, ModuleInfo, Record, Recorder, Recording, RecordingStatus, Sample,
    SeriesId, SeriesInfo, SeriesKind,
};

pub const SECOND: Micros = 1_000_000;
/// In the autumn of 2026.
pub const START: Micros = 1_790_000_000 * SECOND;

/// One module with so many readings.
pub fn described(series: u32) -> Vec<Record> {
    let (line, label, model) = ("COM3".to_owned(), "PIR-234".to_owned(), "pir-234".to_owned());
    let (protocol, baud_rate) = ("dcon".to_owned(), Some(9600));
    let module = ModuleInfo { line, address: 1, label, model, protocol, baud_rate, ..ModuleInfo::default() };
    let series = (0..series).map(|n| {
        let (item, label, unit) = (format!("reading_{n}"), format!("Reading {n}"), "°C".to_owned());
        let kind = SeriesKind::Number { decimals: 2 };
        Record::Series(SeriesId(n), SeriesInfo { module: ModuleId(0), item, label, unit, kind })
    });
    std::iter::once(Record::Module(ModuleId(0), module)).chain(series).collect()
}

/// The number of a reading made by [`described`].
pub fn number(info: &SeriesInfo) -> usize {
    info.item.strip_prefix("reading_").unwrap().parse().unwrap()
}

pub fn record(series: u32, at: Micros, value: i64) -> Record {
    Record::Sample(SeriesId(series), Sample { at, value, gap: false })
}

/// A recorder that can be waited for.
pub struct Watched {
    pub recorder: Recorder,
    woken: Receiver<()>,
}

impl Watched {
    pub fn start(destination: Destination) -> Self {
        Self::with(|wake| Recorder::start(destination, wake))
    }

    pub fn with(start: impl FnOnce(Box<dyn Fn() + Send>) -> std::io::Result<Recorder>) -> Self {
        let (wake, woken) = channel();
        let recorder = start(Box::new(move || {
            let _ = wake.send(());
        }))
        .unwrap();
        Self { recorder, woken }
    }

    /// Waits for what the status is to be; a minute is never needed.
    pub fn wait(&self, is_so: impl Fn(&RecordingStatus) -> bool) -> RecordingStatus {
        let begun = Instant::now();
        loop {
            let status = self.recorder.status();
            if is_so(&status) {
                return status;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "nothing happens: {status:?}");
            // The wake call comes once a second at most.
            let _ = self.woken.recv_timeout(Duration::from_millis(20));
        }
    }
}

pub fn file(path: &Path) -> Destination {
    Destination::File(path.to_owned())
}

/// All samples of all readings, by their numbers.
pub fn read(path: &Path) -> Vec<Vec<Sample>> {
    let mut recording = Recording::open(path).unwrap();
    let history = recording.load().unwrap();
    samples(&mut recording, &history)
}

pub fn samples(archive: &mut dyn Archive, history: &History) -> Vec<Vec<Sample>> {
    let mut all = vec![Vec::new(); history.series().len()];
    for (id, series) in history.series() {
        let samples = archive.samples(id, Micros::MIN, Micros::MAX).unwrap();
        assert_eq!(series.trend.len(), samples.len() as u64);
        assert_eq!(series.trend.last_sample().map(|last| last.at), samples.last().map(|last| last.at));
        all[number(&series.info)] = samples;
    }
    all
}

pub fn values(samples: &[Sample]) -> Vec<i64> {
    samples.iter().map(|sample| sample.value).collect()
}
