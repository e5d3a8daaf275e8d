use std::fs;
use std::sync::mpsc::{Receiver, channel};

use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field;
use jiff::tz::Offset;
use proptest::prelude::*;

use super::*;
use crate::record::{
    Archive, Change, Event, EventKind, History, ModuleId, ModuleInfo, Sample, SeriesId, SeriesInfo, SeriesKind,
    micros_of,
};

const SECOND: Micros = 1_000_000;
/// 2 March 2026, 09:30 UTC.
const BEGIN: Micros = 1_772_443_800 * SECOND;

fn module(history: &mut History, address: u8, protocol: &str, line: &str) -> ModuleId {
    let (label, protocol, line) = ("PIR-234".to_owned(), protocol.to_owned(), line.to_owned());
    history.module(ModuleInfo { address, label, protocol, line, ..ModuleInfo::default() })
}

fn series(history: &mut History, module: ModuleId, item: &str, unit: &str, kind: SeriesKind) -> SeriesId {
    let (item, unit) = (item.to_owned(), unit.to_owned());
    history.series_for(SeriesInfo { module, label: item.clone(), item, unit, kind })
}

/// One module with a number, a switch and a choice; the second sample of the number is half a second late, and its
/// third comes after a gap.
fn history() -> History {
    let mut history = History::default();
    let one = module(&mut history, 1, "modbus_rtu", "COM3");
    let temperature = series(&mut history, one, "temperature_c", "°C", SeriesKind::Number { decimals: 2 });
    let motion = series(&mut history, one, "pir", "", SeriesKind::Switch);
    let words = vec!["command".to_owned(), "pir, \"all\"".to_owned()];
    let source = series(&mut history, one, "do0_source", "", SeriesKind::Choice { words });
    history.push(temperature, BEGIN, 2490);
    history.push(temperature, BEGIN + 3 * SECOND / 2, -5);
    history.mark_gap(temperature);
    history.push(temperature, BEGIN + 5 * SECOND, 2500);
    history.push(motion, BEGIN, 1);
    history.push(motion, BEGIN + SECOND, 0);
    history.push(source, BEGIN + SECOND, 1);
    history.push(source, BEGIN + 5 * SECOND, 7);
    history
}

fn ids(history: &History) -> Vec<SeriesId> {
    history.series().map(|(id, _)| id).collect()
}

fn whole(history: &History) -> Source {
    Source::new(history, &ids(history), None, None, None)
}

fn exported(source: Source, format: Format, rows: Rows) -> Vec<u8> {
    let (mut bytes, zone) = (Vec::new(), TimeZone::fixed(Offset::constant(2)));
    Export::run(source, format, rows, &zone, &mut bytes, |_| ControlFlow::Continue(())).unwrap();
    bytes
}

fn text(source: Source, format: Format, rows: Rows) -> String {
    String::from_utf8(exported(source, format, rows)).unwrap()
}

#[test]
fn csv_has_a_row_for_each_time_and_empty_cells_where_a_series_has_no_sample() {
    assert_eq!(
        text(whole(&history()), Format::Csv, Rows::PerTime),
        "time,PIR-234@1 temperature_c [°C],PIR-234@1 pir,PIR-234@1 do0_source\n\
         2026-03-02T11:30:00.000000+02:00,24.90,true,\n\
         2026-03-02T11:30:01.000000+02:00,,false,\"pir, \"\"all\"\"\"\n\
         2026-03-02T11:30:01.500000+02:00,-0.05,,\n\
         2026-03-02T11:30:05.000000+02:00,25.00,,7\n"
    );
}

#[test]
fn samples_that_come_soon_after_a_rows_time_may_share_it() {
    let rows = |width| text(whole(&history()), Format::Csv, Rows::Within(width)).lines().count() - 1;
    assert_eq!((rows(0), rows(SECOND - 1)), (4, 3));
    assert_eq!(
        text(whole(&history()), Format::Csv, Rows::Within(SECOND)),
        "time,PIR-234@1 temperature_c [°C],PIR-234@1 pir,PIR-234@1 do0_source\n\
         2026-03-02T11:30:00.000000+02:00,24.90,true,\n\
         2026-03-02T11:30:01.000000+02:00,-0.05,false,\"pir, \"\"all\"\"\"\n\
         2026-03-02T11:30:05.000000+02:00,25.00,,7\n",
        "nothing is lost: a second sample of a series begins a row"
    );
}

#[test]
fn csv_has_a_row_for_each_sample_that_says_where_samples_are_missing() {
    assert_eq!(
        text(whole(&history()), Format::Csv, Rows::PerSample),
        "time,module,series,value,unit,gap\n\
         2026-03-02T11:30:00.000000+02:00,PIR-234@1,temperature_c,24.90,°C,false\n\
         2026-03-02T11:30:00.000000+02:00,PIR-234@1,pir,true,,false\n\
         2026-03-02T11:30:01.000000+02:00,PIR-234@1,pir,false,,false\n\
         2026-03-02T11:30:01.000000+02:00,PIR-234@1,do0_source,\"pir, \"\"all\"\"\",,false\n\
         2026-03-02T11:30:01.500000+02:00,PIR-234@1,temperature_c,-0.05,°C,false\n\
         2026-03-02T11:30:05.000000+02:00,PIR-234@1,temperature_c,25.00,°C,true\n\
         2026-03-02T11:30:05.000000+02:00,PIR-234@1,do0_source,7,,false\n"
    );
}

#[test]
fn json_has_numbers_with_the_modules_own_digits_and_no_empty_cells() {
    let shown = text(whole(&history()), Format::JsonLines, Rows::PerTime);
    let first = shown.lines().next().unwrap();
    assert_eq!(
        first,
        "{\"time\":\"2026-03-02T11:30:00.000000+02:00\",\"PIR-234@1 temperature_c [°C]\":24.90,\"PIR-234@1 pir\":true}"
    );
    let last: serde_json::Value = serde_json::from_str(shown.lines().last().unwrap()).unwrap();
    assert_eq!((&last["PIR-234@1 do0_source"], last.get("PIR-234@1 pir")), (&serde_json::json!(7), None));
    let shown = text(whole(&history()), Format::JsonLines, Rows::PerSample);
    assert!(shown.contains(r#""series":"do0_source","value":"pir, \"all\"","gap":false}"#), "{shown}");
    assert!(shown.lines().all(|line| serde_json::from_str::<serde_json::Value>(line).is_ok()));
}

/// The rows that Parquet's own reader finds, as text.
fn parquet_rows(bytes: Vec<u8>) -> Vec<Vec<(String, Field)>> {
    let file = tempfile::tempfile().unwrap();
    (&file).write_all(&bytes).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader.metadata().file_metadata();
    let entries = metadata.key_value_metadata().unwrap();
    assert!(entries.iter().any(|entry| entry.key == "program" && entry.value.as_deref() == Some("dcon-bench")));
    let rows = reader.get_row_iter(None).unwrap();
    rows.map(|row| row.unwrap().into_columns()).collect()
}

#[test]
fn parquet_reads_back_with_its_types() {
    let rows = parquet_rows(exported(whole(&history()), Format::Parquet, Rows::PerTime));
    let fields: Vec<Vec<Field>> = rows.iter().map(|row| row.iter().map(|(_, field)| field.clone()).collect()).collect();
    assert_eq!(rows[0][1].0, "PIR-234@1 temperature_c [°C]");
    let (time, word) = (Field::TimestampMicros, |word: &str| Field::Str(word.to_owned()));
    assert_eq!(fields[0], [time(BEGIN), Field::Double(24.9), Field::Bool(true), Field::Null]);
    assert_eq!(fields[1], [time(BEGIN + SECOND), Field::Null, Field::Bool(false), word("pir, \"all\"")]);
    assert_eq!(fields[3], [time(BEGIN + 5 * SECOND), Field::Double(25.0), Field::Null, word("7")]);

    let rows = parquet_rows(exported(whole(&history()), Format::Parquet, Rows::PerSample));
    let names: Vec<&str> = rows[0].iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["time", "module", "series", "value", "word", "unit", "gap"]);
    assert_eq!((&rows[1][3].1, &rows[3][4].1), (&Field::Double(1.0), &word("pir, \"all\"")));
    assert_eq!(rows[5][6].1, Field::Bool(true));
}

#[test]
fn parquet_holds_more_rows_than_are_written_at_once() {
    let mut history = History::default();
    let one = module(&mut history, 1, "dcon", "COM3");
    let id = series(&mut history, one, "temperature_c", "°C", SeriesKind::Number { decimals: 2 });
    (0..70_000).for_each(|at| history.push(id, BEGIN + at * SECOND, at));
    let rows = parquet_rows(exported(whole(&history), Format::Parquet, Rows::PerTime));
    assert_eq!(rows.len(), 70_000);
    assert_eq!(rows[69_999][1].1, Field::Double(699.99));
}

#[test]
fn an_export_of_nothing_is_whole() {
    let history = history();
    let nothing = || Source::new(&history, &ids(&history), Some(BEGIN + 9 * SECOND), None, None);
    assert_eq!(text(nothing(), Format::Csv, Rows::PerTime).lines().count(), 1);
    assert!(exported(nothing(), Format::JsonLines, Rows::PerTime).is_empty());
    assert!(parquet_rows(exported(nothing(), Format::Parquet, Rows::PerTime)).is_empty());
    let no_series = Source::new(&history, &[], None, None, None);
    assert_eq!(text(no_series, Format::Csv, Rows::PerTime), "time\n");
}

#[test]
fn both_ends_of_a_range_are_included() {
    let history = history();
    let part = Source::new(&history, &ids(&history), Some(BEGIN + SECOND), Some(BEGIN + 3 * SECOND / 2), None);
    let times: Vec<String> =
        text(part, Format::Csv, Rows::PerTime).lines().skip(1).map(|line| line[17..26].to_owned()).collect();
    assert_eq!(times, ["01.000000", "01.500000"]);
}

#[test]
fn modules_that_look_alike_are_told_apart() {
    let mut history = History::default();
    module(&mut history, 1, "modbus_rtu", "COM3");
    module(&mut history, 1, "dcon", "COM3");
    module(&mut history, 1, "dcon", "COM4");
    module(&mut history, 2, "dcon", "COM4");
    let twin = history.module_info(ModuleId(3)).unwrap().clone();
    history.module(ModuleInfo { firmware: "B2.8".into(), ..twin });
    let names: Vec<String> = module_names(&history).into_values().collect();
    assert_eq!(
        names,
        [
            "PIR-234@1:modbus_rtu",
            "PIR-234@1:dcon:COM3",
            "PIR-234@1:dcon:COM4",
            "PIR-234@2:dcon:COM4#4",
            "PIR-234@2:dcon:COM4#5"
        ]
    );
}

/// A recording that has all samples of one series.
struct Shelf(Vec<Sample>);

impl Archive for Shelf {
    fn samples(&mut self, _series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
        Ok(self.0.iter().copied().filter(|sample| (from..=to).contains(&sample.at)).collect())
    }
}

#[test]
fn what_is_on_the_disk_only_is_fetched() {
    let mut history = History::default();
    let one = module(&mut history, 1, "dcon", "COM3");
    let id = series(&mut history, one, "temperature_c", "°C", SeriesKind::Number { decimals: 2 });
    (0..5_000).for_each(|at| history.push(id, BEGIN + at * SECOND, at % 7));
    let in_memory = text(whole(&history), Format::Csv, Rows::PerSample);
    let blocks = history.get(id).unwrap().trend.blocks();
    let samples: Vec<Sample> = blocks.iter().flat_map(|block| block.samples.as_ref().unwrap().iter()).collect();
    let trend = history.trend_mut(id).unwrap();
    let look = trend.looks();
    assert!(trend.give_up(Micros::MAX, look) > 4_000);
    let source = Source::new(&history, &[id], None, None, Some(Box::new(Shelf(samples))));
    assert_eq!(text(source, Format::Csv, Rows::PerSample), in_memory);

    let zone = TimeZone::UTC;
    let without =
        Export::run(whole(&history), Format::Csv, Rows::PerTime, &zone, Vec::new(), |_| ControlFlow::Continue(()));
    assert!(matches!(without, Err(ExportError::NoArchive)));
}

#[test]
fn samples_that_cannot_be_fetched_end_the_export_unless_they_are_not_wanted() {
    let mut history = History::default();
    let one = module(&mut history, 1, "dcon", "COM3");
    let id = series(&mut history, one, "temperature_c", "°C", SeriesKind::Number { decimals: 2 });
    (0..5_000).for_each(|at| history.push(id, BEGIN + at * SECOND, at % 7));
    let trend = history.trend_mut(id).unwrap();
    let look = trend.looks();
    trend.give_up(Micros::MAX, look);
    let ends: Vec<[Micros; 2]> = trend.blocks()[..4].iter().map(|block| [block.node.first, block.node.last]).collect();
    // Two stretches are gone, the second but for its beginning.
    let is_left = |at: &Micros| !(ends[1][0]..=ends[1][1]).contains(at) && !(ends[2][0] + 5..=ends[2][1]).contains(at);
    let left = (0..5_000).map(|n| BEGIN + n * SECOND).filter(is_left);
    let left: Vec<Sample> = left.map(|at| Sample { at, value: 1, gap: false }).collect();
    let run = |from: Option<Micros>| {
        let source = Source::new(&history, &[id], from, None, Some(Box::new(Shelf(left.clone()))));
        let go_on = |_| ControlFlow::Continue(());
        Export::run(source, Format::Csv, Rows::PerSample, &TimeZone::UTC, Vec::new(), go_on)
    };
    let error = run(None).unwrap_err();
    let [from, to] = [ends[1][0], ends[2][1]].map(crate::record::timestamp);
    assert!(error.to_string().contains(&format!("PIR-234@1 temperature_c [°C] from {from} to {to} cannot")), "{error}");
    let rest = run(Some(ends[3][0])).unwrap().rows;
    assert_eq!(rest, left.iter().filter(|sample| sample.at >= ends[3][0]).count() as u64);
}

#[test]
fn events_have_what_was_written() {
    let mut history = history();
    let at = crate::record::timestamp(BEGIN);
    let change = Change { item: "pir_on_time".into(), before: Some("6".into()), after: "33".into() };
    let event = |module, kind, text: &str, change| Event { at, module, kind, text: text.into(), change };
    history.add_event(event(Some(ModuleId(0)), EventKind::Written, "PIR on time: 6 -> 33 s", Some(change)));
    history.add_event(event(None, EventKind::Note, "door, open", None));
    let mut bytes = Vec::new();
    let rows = EventRows::new(&history, &[], None, Some(micros_of(at)));
    Export::run_events(rows, Format::Csv, &TimeZone::UTC, &mut bytes, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(
        String::from_utf8(bytes).unwrap(),
        "time,module,kind,text,item,before,after\n\
         2026-03-02T09:30:00.000000+00:00,PIR-234@1,written,PIR on time: 6 -> 33 s,pir_on_time,6,33\n\
         2026-03-02T09:30:00.000000+00:00,,note,\"door, open\",,,\n"
    );
}

#[test]
fn json_has_texts_as_they_are_and_only_choices_that_are_numbers_as_numbers() {
    let mut history = History::default();
    let one = module(&mut history, 1, "dcon", "COM3");
    let words = ["33", "0042", "+5", "-7", "off"].map(str::to_owned).into();
    let id = series(&mut history, one, "mode", "", SeriesKind::Choice { words });
    (0..5).for_each(|place| history.push(id, BEGIN + place * SECOND, place));
    let shown = text(whole(&history), Format::JsonLines, Rows::PerSample);
    let values: Vec<&str> =
        shown.lines().map(|line| line.split("\"value\":").nth(1).unwrap().split(',').next().unwrap()).collect();
    assert_eq!(values, ["33", "\"0042\"", "\"+5\"", "-7", "\"off\""]);

    let change = Change { item: "name".into(), before: Some("7".into()), after: "0042".into() };
    let (at, text) = (crate::record::timestamp(BEGIN), "12".to_owned());
    history.add_event(Event { at, module: None, kind: EventKind::Note, text, change: Some(change) });
    let (mut bytes, rows) = (Vec::new(), EventRows::new(&history, &[], None, None));
    Export::run_events(rows, Format::JsonLines, &TimeZone::UTC, &mut bytes, |_| ControlFlow::Continue(())).unwrap();
    let shown = String::from_utf8(bytes).unwrap();
    let end = r#""kind":"note","text":"12","item":"name","before":"7","after":"0042"}"#;
    assert!(shown.trim_end().ends_with(end), "{shown}");
}

/// A pipe whose other end is closed.
struct Closed;

impl Write for Closed {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::BrokenPipe.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Err(io::ErrorKind::BrokenPipe.into())
    }
}

#[test]
fn a_closed_pipe_is_known_as_such_in_every_format() {
    for format in Format::ALL {
        let run =
            Export::run(whole(&long()), format, Rows::PerTime, &TimeZone::UTC, Closed, |_| ControlFlow::Continue(()));
        match run {
            Err(ExportError::Write(error)) => assert_eq!(error.kind(), io::ErrorKind::BrokenPipe, "{format:?}"),
            other => panic!("{format:?}: {other:?}"),
        }
    }
}

/// A history long enough to be stopped in.
fn long() -> History {
    let mut history = History::default();
    let one = module(&mut history, 1, "dcon", "COM3");
    let id = series(&mut history, one, "temperature_c", "°C", SeriesKind::Number { decimals: 2 });
    (0..10_000).for_each(|at| history.push(id, BEGIN + at * SECOND, at));
    history
}

#[test]
fn progress_grows_to_the_end_and_can_stop_it() {
    let mut parts = Vec::new();
    let done = Export::run(whole(&long()), Format::Csv, Rows::PerTime, &TimeZone::UTC, Vec::new(), |progress| {
        parts.push(progress.part);
        ControlFlow::Continue(())
    });
    assert_eq!(done.unwrap(), Progress { rows: 10_000, part: 1.0 });
    assert!(parts.len() > 5 && parts.is_sorted() && parts.last() == Some(&1.0), "{parts:?}");
    let stopped =
        Export::run(whole(&long()), Format::Csv, Rows::PerTime, &TimeZone::UTC, Vec::new(), |_| ControlFlow::Break(()));
    assert!(matches!(stopped, Err(ExportError::Stopped)));
}

fn job(path: &Path, wake: impl Fn() + Send + 'static) -> (ExportJob, Receiver<()>) {
    let (tell, done) = channel();
    let wake = move || {
        let _ = &tell;
        wake();
    };
    let job =
        ExportJob::start(path.to_owned(), whole(&long()), Format::Csv, Rows::PerTime, TimeZone::UTC, wake).unwrap();
    (job, done)
}

#[test]
fn a_job_writes_a_whole_file_and_tells_how_far_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("export.csv");
    let (job, done) = job(&path, || {});
    done.recv().unwrap_err();
    assert_eq!(job.progress(), Progress { rows: 10_000, part: 1.0 });
    assert_eq!(job.outcome().unwrap().unwrap().rows, 10_000);
    assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 10_001);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_job_that_is_cancelled_leaves_the_old_file_and_no_part() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("export.csv");
    fs::write(&path, "old").unwrap();
    let (go_on, held) = channel::<()>();
    let (began, begins) = channel();
    // Held at the first progress until it is cancelled.
    let (job, done) = job(&path, move || {
        let _ = began.send(());
        let _ = held.recv();
    });
    begins.recv().unwrap();
    job.cancel();
    drop(go_on);
    done.recv().unwrap_err();
    assert!(matches!(job.outcome(), Some(Err(ExportError::Stopped))));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_place_that_cannot_be_written_is_told() {
    let (job, done) = job(Path::new("/no/such/folder/export.csv"), || {});
    done.recv().unwrap_err();
    assert!(matches!(job.outcome(), Some(Err(ExportError::Write(_)))));
}

/// Samples of up to four series: steps in time, and values.
fn courses() -> impl Strategy<Value = Vec<Vec<(Micros, i64)>>> {
    let course = proptest::collection::vec((1i64..3, -9i64..9), 0..1_200);
    proptest::collection::vec(course, 0..4)
}

proptest! {
    #[test]
    fn every_sample_is_in_the_row_of_its_time_whatever_the_series(courses in courses(), from in 0i64..900, wide in 0i64..2_000) {
        let mut history = History::default();
        let one = module(&mut history, 1, "dcon", "COM3");
        let (to, mut expected) = (from + wide, std::collections::BTreeMap::<Micros, Vec<String>>::new());
        for (place, course) in courses.iter().enumerate() {
            let id = series(&mut history, one, &place.to_string(), "", SeriesKind::Number { decimals: 0 });
            let mut at = 0;
            for (step, value) in course {
                at += step;
                history.push(id, at, *value);
                if (from..=to).contains(&at) {
                    let row = expected.entry(at).or_insert_with(|| vec![String::new(); courses.len()]);
                    row[place] = value.to_string();
                }
            }
        }
        let source = Source::new(&history, &ids(&history), Some(from), Some(to), None);
        let shown = text(source, Format::Csv, Rows::PerTime);
        let rows: Vec<&str> = shown.lines().skip(1).map(|line| line.split_once(',').map_or("", |(_, cells)| cells)).collect();
        let expected: Vec<String> = expected.into_values().map(|row| row.join(",")).collect();
        prop_assert_eq!(rows, expected);
    }
}
