use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::*;
use crate::bench::Action;
use crate::bus::{Answer, Bus, BusCommand, BusEvent, LineAddress, RequestId, Target};
use crate::module::{Catalogue, Fixed, Identified, Value, WriteError};
use crate::protocol::{Failure, LineSettings, Protocol};
use crate::record::{Export, Format, Keeping, Rows, Source, micros_of, timestamp};

/// Far more than anything here takes; reaching it is a failure.
const LIMIT: Duration = Duration::from_secs(60);
const BREATH: Duration = Duration::from_millis(2);

const MODULE: Target = Target {
    address: 1,
    protocol: Protocol::ModbusRtu,
    settings: LineSettings {
        baud_rate: crate::protocol::BaudRate::B9600,
        data_format: crate::protocol::DataFormat::N81,
    },
    checksum: false,
};

fn start() -> Timestamp {
    Timestamp::from_second(1_772_443_800).unwrap()
}

fn second(number: i64) -> Timestamp {
    timestamp(micros_of(start()).saturating_add(number * 1_000_000))
}

/// A bench with one PIR-234, and the bus, which the test plays.
struct Play {
    bench: Bench,
    commands: Receiver<BusCommand>,
    /// Both ends of the bus have to live.
    _events: SyncSender<BusEvent>,
}

impl Play {
    fn new() -> Self {
        let (bus, commands, events) = Bus::detached();
        let mut bench = Bench::new(bus, Arc::new(Catalogue::built_in().0), &[]).with_clock(start);
        let line = LineAddress::Serial { port: "COM3".to_owned() };
        bench.apply(Action::Connect { line, settings: MODULE.settings });
        let opened = commands.try_iter().find_map(|command| match command {
            BusCommand::Open { id, .. } => Some(BusEvent::Opened { id, line: "COM3".to_owned() }),
            _ => None,
        });
        bench.take(opened.expect("a line is asked for"));
        let definition = Catalogue::built_in().0.get("pir-234");
        let identified =
            Identified { definition, name: "234".to_owned(), firmware: String::new(), said: String::new() };
        bench.take(BusEvent::Found { id: RequestId(1_000), target: MODULE, identified });
        Self { bench, commands, _events: events }
    }

    fn read(&mut self, at: i64, item: &str, result: Result<Value, Failure>) {
        let at = second(at);
        let values = vec![Answer { id: item.to_owned(), at, result }];
        self.bench.take(BusEvent::Read { id: RequestId(2_000), target: MODULE, at, values });
    }

    fn temperature(&mut self, at: i64) {
        self.read(at, "temperature_c", Ok(Value::Number(Fixed::new(2_000 + at % 1_000, 2))));
    }

    fn record_into(&mut self, folder: &TempDir) {
        let keeping = Keeping { file_size: 1_000_000_000, total_size: None, days: None };
        self.bench.apply(Action::Record(Destination::Folder { folder: folder.path().to_owned(), keeping }));
    }

    /// Drains until it is so.
    #[track_caller]
    fn until(&mut self, what: &str, is_so: impl Fn(&Bench) -> bool) {
        let begin = Instant::now();
        while !is_so(&self.bench) {
            assert!(begin.elapsed() < LIMIT, "not reached: {what}");
            self.bench.drain();
            std::thread::sleep(BREATH);
        }
    }

    fn kinds(&mut self) -> Vec<(EventKind, String)> {
        self.bench.drain();
        self.bench.history().events().iter().map(|event| (event.kind, event.text.clone())).collect()
    }
}

fn saved(folder: &TempDir) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|end| end == "sqlite")).collect();
    files.sort();
    files
}

#[test]
fn everything_that_happens_to_a_module_or_its_line_comes_into_the_history() {
    let mut play = Play::new();
    for (item, _) in [("pir1", "motion"), ("do0", "on"), ("alarm_active", "alarm"), ("wdt_tripped", "yes")] {
        play.read(1, item, Ok(Value::Bool(false)));
        play.read(2, item, Ok(Value::Bool(true)));
    }
    play.read(3, "temperature_c", Err(Failure::Silent));
    play.temperature(4);
    let (id, at) = (RequestId(3_000), second(5));
    let item = "temperature_offset".to_owned();
    let result = Ok(Value::Number(Fixed::new(15, 1)));
    play.bench.take(BusEvent::Written { id, target: MODULE, item: item.clone(), at, result });
    let failure = Failure::Exception { code: 3 };
    let result = Err(WriteError::Refused { id: item.clone(), failure, hint: "" });
    play.bench.take(BusEvent::Written { id, target: MODULE, item, at: second(6), result });
    let action = "clear_watchdog".to_owned();
    play.bench.take(BusEvent::Acted { id, target: MODULE, action, at: second(7), result: Ok(()) });
    play.bench.apply(Action::AddNote(second(8), "Filter cleaned".to_owned()));
    play.bench.take(BusEvent::LineLost { reason: "unplugged".to_owned() });
    play.bench.take(BusEvent::LineRestored { line: crate::bus::LineAddress::demo() });
    let kinds = play.kinds();
    let count = |kind: EventKind| kinds.iter().filter(|(known, _)| *known == kind).count();
    for kind in EventKind::ALL {
        assert!(count(kind) > 0, "{kind:?} is missing in {kinds:?}");
    }
    assert_eq!((count(EventKind::Found), count(EventKind::Lost)), (3, 2), "{kinds:?}");
    let written = play.bench.history().events().iter().find(|event| event.kind == EventKind::Written).unwrap();
    assert_eq!(written.change.as_ref().map(|change| change.item.as_str()), Some("temperature_offset"));
    assert!(
        play.bench
            .history()
            .events()
            .iter()
            .zip(play.bench.history().events().iter().skip(1))
            .all(|(a, b)| a.at <= b.at)
    );
    assert!(play.commands.try_iter().count() > 0);
}

#[test]
fn what_was_measured_before_a_recording_began_is_in_it_too() {
    let folder = tempfile::tempdir().unwrap();
    let mut play = Play::new();
    (0..10).for_each(|at| play.temperature(at));
    play.bench.drain();
    play.record_into(&folder);
    (10..20).for_each(|at| play.temperature(at));
    play.until("all is on the disk", |bench| bench.recording().is_some_and(|status| status.samples == 20));
    assert!(play.bench.end_recording().is_empty());
    let history = RecordingFile::open(&saved(&folder)[0]).unwrap().load().unwrap();
    assert_eq!(history.series().next().unwrap().1.trend.len(), 20);
    assert!(history.events().iter().any(|event| event.kind == EventKind::Found), "found before it began");
}

#[test]
fn between_two_recordings_nothing_is_lost_and_nothing_is_written_twice() {
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mut play = Play::new();
    play.record_into(&first);
    (0..5).for_each(|at| play.temperature(at));
    play.bench.apply(Action::StopRecording);
    assert!(play.bench.recording().is_none());
    (5..8).for_each(|at| play.temperature(at));
    play.bench.apply(Action::AddNote(start(), "Between".to_owned()));
    play.record_into(&second);
    (8..10).for_each(|at| play.temperature(at));
    assert!(play.bench.end_recording().is_empty());
    let load = |folder: &TempDir| RecordingFile::open(&saved(folder)[0]).unwrap().load().unwrap();
    let samples = |history: &History| history.series().next().unwrap().1.trend.len();
    assert_eq!((samples(&load(&first)), samples(&load(&second))), (5, 5));
    let notes = |history: &History| history.events().iter().filter(|event| event.text == "Between").count();
    assert_eq!((notes(&load(&first)), notes(&load(&second))), (0, 1));
}

#[test]
fn what_was_given_up_comes_back_when_it_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let mut play = Play::new();
    play.record_into(&folder);
    (0..2_000).for_each(|at| play.temperature(at));
    play.until("all is on the disk", |bench| bench.recording().is_some_and(|status| status.samples == 2_000));
    let id = play.bench.history().series().next().unwrap().0;
    let given_up = play.bench.history.trend_mut(id).unwrap().give_up(i64::MAX, u32::MAX);
    assert!(given_up >= 1_024);
    let mut csv = Vec::new();
    let source = Source::new(play.bench.history(), &[id], None, None, play.bench.archive(None));
    let zone = jiff::tz::TimeZone::UTC;
    Export::run(source, Format::Csv, Rows::PerTime, &zone, &mut csv, |_| std::ops::ControlFlow::Continue(())).unwrap();
    assert_eq!(csv.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).count(), 2_001, "an export has all");
    let (from, to) = (start().as_second() as f64, start().as_second() as f64 + 600.0);
    let lines = |bench: &Bench| -> usize {
        bench.history().get(id).unwrap().trend.lines(from, to, 10_000).iter().map(Vec::len).sum()
    };
    assert!(lines(&play.bench) < 100);
    play.until("they are back", |bench| lines(bench) >= 600);
}

#[test]
fn a_folder_that_cannot_be_written_is_said_and_what_is_measured_waits() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let mut play = Play::new();
    let keeping = Keeping { file_size: 1_000_000_000, total_size: None, days: None };
    play.bench.apply(Action::Record(Destination::Folder { folder: file.join("inside"), keeping }));
    (0..5).for_each(|at| play.temperature(at));
    play.until("it is said", |bench| bench.notices().any(|notice| notice.text.contains("waits in memory")));
    assert!(play.bench.recording().is_some_and(|status| status.waiting >= 5 && status.problem.is_some()));
    let problems = play.bench.end_recording();
    assert!(problems.len() == 1 && problems[0].contains("not written"), "{problems:?}");
}

#[test]
fn what_could_not_be_written_goes_into_the_next_recording() {
    let (bad, good) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let file = bad.path().join("file");
    std::fs::write(&file, "").unwrap();
    let mut play = Play::new();
    let keeping = Keeping { file_size: 1_000_000_000, total_size: None, days: None };
    play.bench.apply(Action::Record(Destination::Folder { folder: file.join("inside"), keeping }));
    (0..5).for_each(|at| play.temperature(at));
    play.bench.apply(Action::AddNote(start(), "Waits".to_owned()));
    play.until("it is said", |bench| bench.notices().any(|notice| notice.text.contains("waits in memory")));
    play.record_into(&good);
    (5..9).for_each(|at| play.temperature(at));
    assert!(play.bench.end_recording().is_empty());
    let history = RecordingFile::open(&saved(&good)[0]).unwrap().load().unwrap();
    assert_eq!(history.series().next().unwrap().1.trend.len(), 9);
    assert!(history.events().iter().any(|event| event.text == "Waits"));
}

#[test]
fn a_recording_is_opened_once_and_only_so_many_at_a_time() {
    let mut play = Play::new();
    for number in 0..=MOST_OPEN {
        let path = PathBuf::from(format!("{number}.sqlite"));
        play.bench.apply(Action::OpenRecording(path.clone()));
        play.bench.apply(Action::OpenRecording(path));
    }
    assert_eq!(play.bench.opened().count(), MOST_OPEN);
    assert!(play.bench.notices().any(|notice| notice.text.contains("close one of them first")));
    let id = play.bench.opened().next().unwrap().0;
    play.bench.apply(Action::CloseRecording(id));
    assert!(play.bench.opened_recording(id).is_none());
}
