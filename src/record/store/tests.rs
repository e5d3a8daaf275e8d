use std::collections::HashSet;
use std::path::Path;

use proptest::prelude::*;

use super::super::history::{History, Record};
use super::super::objects::{Change, Event, EventKind, ModuleId, ModuleInfo, SeriesInfo, SeriesKind, timestamp};
use super::super::trend::BLOCK;
use super::catalogue::Catalogue;
use super::file::RecordingFile;
use super::*;

const SECOND: Micros = 1_000_000;
const START: Micros = 1_790_000_000 * SECOND;

fn series(item: &str, kind: SeriesKind) -> SeriesInfo {
    SeriesInfo { module: ModuleId(0), item: item.into(), label: item.to_uppercase(), unit: "°C".into(), kind }
}

fn module(name: &str) -> ModuleInfo {
    let (line, label) = ("COM3".into(), "PIR-234".into());
    ModuleInfo { line, address: 7, label, name: name.into(), ..ModuleInfo::default() }
}

/// A module with a number, a switch and a choice.
fn catalogue() -> Catalogue {
    let mut catalogue = Catalogue::default();
    let words = vec!["none".to_owned(), "\"power\" on".to_owned()];
    let kinds = [SeriesKind::Number { decimals: 2 }, SeriesKind::Switch, SeriesKind::Choice { words }];
    catalogue.take(Record::Module(ModuleId(0), module("hall")));
    for ((id, kind), item) in (0..).zip(kinds).zip(["temperature_c", "motion", "reset"]) {
        catalogue.take(Record::Series(SeriesId(id), series(item, kind)));
    }
    catalogue
}

/// A file that is written and opened again as after a new start of the program, beside what is to be in it.
struct Played {
    file: Option<RecordingFile>,
    catalogue: Catalogue,
    begun: HashSet<SeriesId>,
    expected: [Vec<Sample>; 3],
}

impl Played {
    fn new(path: &Path) -> Self {
        let file = Some(RecordingFile::open(path).unwrap());
        Self { file, catalogue: catalogue(), begun: HashSet::new(), expected: Default::default() }
    }

    fn restart(&mut self, path: &Path) {
        self.file.take().unwrap().close();
        self.begun.clear();
        self.file = Some(RecordingFile::open(path).unwrap());
    }

    fn write(&mut self, samples: &[(SeriesId, Sample)]) {
        let begun = self.begun.clone();
        for (id, sample) in samples {
            let expected = &mut self.expected[id.0 as usize];
            let gap = sample.gap || (!expected.is_empty() && !self.begun.contains(id));
            self.begun.insert(*id);
            expected.push(Sample { gap, ..*sample });
        }
        self.file.as_mut().unwrap().write(&self.catalogue, &begun, &[], samples).unwrap();
    }
}

/// Everything of a history, with what is on the disk only.
fn all_of(recording: &mut Recording, history: &mut History) -> Vec<Vec<Sample>> {
    let ids: Vec<SeriesId> = history.series().map(|(id, _)| id).collect();
    let read = |id: &SeriesId| {
        let samples = recording.samples(*id, Micros::MIN, Micros::MAX).unwrap();
        history.fill(*id, &samples);
        let trend = &history.get(*id).unwrap().trend;
        assert_eq!(trend.resident() as u64, trend.len(), "every stretch finds its samples");
        let held = trend.blocks().iter().flat_map(|block| block.samples.iter().flat_map(|samples| samples.iter()));
        assert!(held.skip(1).eq(samples.iter().copied().skip(1)));
        samples
    };
    ids.iter().map(read).collect()
}

#[derive(Debug, Clone)]
enum Move {
    Write(Vec<(u32, Micros, i64, bool)>),
    Restart,
    Refresh,
}

fn moves() -> impl Strategy<Value = Vec<Move>> {
    let step = prop_oneof![40 => 1i64..3 * SECOND, 1 => 1i64..5_000 * SECOND];
    let value = prop_oneof![20 => -300i64..300, 1 => any::<i64>()];
    let sample = (0u32..3, step, value, prop::bool::weighted(0.02));
    let write = prop::collection::vec(sample, 0..6_000).prop_map(Move::Write);
    prop::collection::vec(prop_oneof![6 => write, 1 => Just(Move::Restart), 3 => Just(Move::Refresh)], 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn everything_that_was_written_is_read_through_rows_and_blocks_at_once_or_bit_by_bit(moves in moves()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sqlite");
        let mut played = Played::new(&path);
        let mut growing = Recording::open(&path).unwrap();
        let mut grown = growing.load().unwrap();
        let mut at = START;
        for step in moves {
            match step {
                Move::Restart => played.restart(&path),
                Move::Refresh => drop(growing.refresh(&mut grown).unwrap()),
                Move::Write(steps) => {
                    let sample = |(id, step, value, gap): (u32, Micros, i64, bool)| {
                        at += step;
                        (SeriesId(id), Sample { at, value, gap })
                    };
                    let samples: Vec<_> = steps.into_iter().map(sample).collect();
                    played.write(&samples);
                }
            }
        }
        growing.refresh(&mut grown).unwrap();
        let mut whole = Recording::open(&path).unwrap();
        let mut loaded = whole.load().unwrap();
        let described = loaded.series().len();
        prop_assert!(described == 3 || played.expected.iter().all(Vec::is_empty));
        for (recording, history) in [(&mut whole, &mut loaded), (&mut growing, &mut grown)] {
            let found = all_of(recording, history);
            prop_assert_eq!(&found[..], &played.expected[..described]);
        }
    }
}

#[test]
fn modules_series_and_events_come_back_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut file = RecordingFile::open(&path).unwrap();
    let events: Vec<Event> = EventKind::ALL
        .iter()
        .zip(0..)
        .map(|(kind, n)| Event {
            at: timestamp(START + n),
            module: (n % 3 > 0).then_some(ModuleId(0)),
            kind: *kind,
            text: format!("Event {n} of \u{1f600} \"kind\""),
            change: (n % 2 == 0).then(|| Change {
                item: "relay".into(),
                before: (n > 3).then(|| "off".to_owned()),
                after: "on".into(),
            }),
        })
        .collect();
    file.write(&catalogue(), &HashSet::new(), &events, &[]).unwrap();
    let mut recording = Recording::open(&path).unwrap();
    let mut history = recording.load().unwrap();
    assert_eq!(history.events().iter().cloned().collect::<Vec<_>>(), events);
    assert_eq!(history.module_info(ModuleId(0)), Some(&module("hall")));
    let words = vec!["none".to_owned(), "\"power\" on".to_owned()];
    let kinds: Vec<SeriesKind> = history.series().map(|(_, series)| series.info.kind.clone()).collect();
    assert_eq!(kinds, [SeriesKind::Number { decimals: 2 }, SeriesKind::Switch, SeriesKind::Choice { words }]);
    assert!(!recording.refresh(&mut history).unwrap());

    let mut renamed = catalogue();
    renamed.take(Record::Module(ModuleId(0), module("stairs")));
    file.write(&renamed, &HashSet::new(), &events[..1], &[]).unwrap();
    assert!(recording.refresh(&mut history).unwrap());
    assert_eq!(history.module_info(ModuleId(0)), Some(&module("stairs")));
    assert_eq!((history.modules().len(), history.events().len()), (1, events.len() + 1));
}

#[test]
fn the_views_say_it_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut played = Played::new(&path);
    let news = [(0, 2_499), (1, 1), (2, 1)];
    played.write(&news.map(|(id, value)| (SeriesId(id), Sample { at: START + 250_000, value, gap: false })));
    let change = Some(Change { item: "relay".into(), before: None, after: "on".into() });
    let (at, text) = (timestamp(START), "Relay written".to_owned());
    let event = Event { at, module: Some(ModuleId(0)), kind: EventKind::Written, text, change };
    played.file.as_mut().unwrap().write(&played.catalogue, &played.begun, &[event], &[]).unwrap();
    let connection = schema::open_to_read(&path).unwrap().0;
    let mut found = Vec::new();
    let sql = "SELECT time || ' ' || module || ' ' || item || ' ' || value FROM readings
        UNION ALL SELECT time || ' ' || module || ' ' || item || ' ' || after FROM settings_written";
    rows::rows(&connection, sql, [], |row| row.get::<_, String>(0), |text| found.push(text)).unwrap();
    let expected = [
        ".250Z PIR-234@7 temperature_c 24.99",
        ".250Z PIR-234@7 motion 1",
        ".250Z PIR-234@7 reset \"power\" on",
        ".000Z PIR-234@7 relay on",
    ];
    assert_eq!(found, expected.map(|text| format!("2026-09-21T14:13:20{text}")));
}

#[test]
fn another_module_of_the_same_kind_and_an_item_of_another_meaning_are_not_mixed_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let runs = [("hall", 2), ("hall", 2), ("stairs", 2), ("hall", 1)];
    for (run, (name, decimals)) in (0..).zip(runs) {
        let mut catalogue = Catalogue::default();
        catalogue.take(Record::Module(ModuleId(5), module(name)));
        let info = SeriesInfo { module: ModuleId(5), ..series("t", SeriesKind::Number { decimals }) };
        catalogue.take(Record::Series(SeriesId(9), info));
        let mut file = RecordingFile::open(&path).unwrap();
        let sample = Sample { at: START + run, value: run, gap: false };
        file.write(&catalogue, &HashSet::new(), &[], &[(SeriesId(9), sample)]).unwrap();
    }
    let mut recording = Recording::open(&path).unwrap();
    let mut history = recording.load().unwrap();
    let values: Vec<Vec<i64>> = all_of(&mut recording, &mut history)
        .iter()
        .map(|all| all.iter().map(|sample| sample.value).collect())
        .collect();
    assert_eq!(values, [vec![0, 1], vec![2], vec![3]]);
    let names: Vec<&str> = history.modules().map(|(_, info)| info.name.as_str()).collect();
    assert_eq!(names, ["hall", "stairs", "hall"]);
}

#[test]
fn samples_from_before_the_last_one_are_refused_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut played = Played::new(&path);
    let sample = |at| (SeriesId(0), Sample { at: START + at, value: at, gap: false });
    played.write(&[sample(10), sample(20)]);
    played.restart(&path);
    let outcome = played.file.as_mut().unwrap().write(
        &played.catalogue,
        &HashSet::new(),
        &[],
        &[sample(15), sample(20), sample(30), (SeriesId(77), sample(40).1)],
    );
    let outcome = outcome.unwrap();
    assert_eq!((outcome.earlier, outcome.strange, outcome.span), (2, 1, Some([START + 30, START + 30])));
}

#[test]
fn a_stretch_is_fetched_with_its_ends_and_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut played = Played::new(&path);
    let all: Vec<(SeriesId, Sample)> =
        (0..9_000).map(|n| (SeriesId(0), Sample { at: START + n * SECOND, value: n, gap: false })).collect();
    all.chunks(700).for_each(|part| played.write(part));
    let mut recording = Recording::open(&path).unwrap();
    recording.load().unwrap();
    let mut values = |from: i64, to: i64| -> Vec<i64> {
        let found = recording.samples(SeriesId(0), START + from * SECOND, START + to * SECOND).unwrap();
        found.iter().map(|sample| sample.value).collect()
    };
    for (from, to) in [(0, 0), (500, 530), (511, 512), (1_000, 8_999), (-5, 3), (8_998, 9_900)] {
        assert_eq!(values(from, to), (from.max(0)..=to.min(8_999)).collect::<Vec<_>>());
    }
    assert!(values(5, 4).is_empty() && values(-9, -1).is_empty() && values(9_000, 9_900).is_empty());
    assert!(recording.samples(SeriesId(44), Micros::MIN, Micros::MAX).unwrap().is_empty());
}

#[test]
fn fresh_rows_stay_few() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut played = Played::new(&path);
    let mut most = 0u16;
    for second in 0..6_000 {
        let at = START + second * SECOND;
        let news: Vec<_> = (0..3).map(|id| (SeriesId(id), Sample { at, value: second % 50, gap: false })).collect();
        played.write(&news);
        let count = "SELECT count(*) FROM fresh";
        let connection = schema::open_to_read(&path).unwrap().0;
        most = most.max(connection.query_row(count, [], |row| row.get::<_, u16>(0)).unwrap());
    }
    assert!((BLOCK * 15..=BLOCK * 16).contains(&usize::from(most)), "{most}");
}
