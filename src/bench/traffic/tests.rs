use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use proptest::prelude::*;

use super::*;
use crate::bus::{Frame, Verdict};
use crate::module::Catalogue;
use crate::protocol::{LineSettings, Protocol, hex, modbus};

fn frame(at_ms: i64, bytes: &[u8], protocol: Protocol, took_ms: u64, verdict: Verdict) -> Frame {
    let start: Timestamp = "2024-05-06T07:08:09Z".parse().unwrap();
    Frame {
        at: start + SignedDuration::from_millis(at_ms),
        direction: if verdict == Verdict::Request { Direction::Sent } else { Direction::Received },
        bytes: bytes.to_vec(),
        protocol,
        settings: LineSettings::default(),
        address: Some(1),
        checksum: false,
        took: Duration::from_millis(took_ms),
        first_byte: None,
        echo: false,
        noise: false,
        verdict,
    }
}

/// Two exchanges that went well and two that did not.
fn exchanges() -> Vec<Frame> {
    let request = modbus::with_crc(&[1, 4, 0, 0, 0, 1]);
    let answer = modbus::with_crc(&[1, 4, 2, 0x0B, 0xB8]);
    vec![
        frame(0, &request, Protocol::ModbusRtu, 8, Verdict::Request),
        frame(28, &answer, Protocol::ModbusRtu, 20, Verdict::Answer),
        frame(100, b"$01M\r", Protocol::Dcon, 5, Verdict::Request),
        frame(115, b"!01PIR234\r", Protocol::Dcon, 10, Verdict::Answer),
        frame(200, b"@01HI+086.00\r", Protocol::Dcon, 13, Verdict::Request),
        frame(223, b"?01\r", Protocol::Dcon, 10, Verdict::Refusal),
        frame(300, &request, Protocol::ModbusRtu, 8, Verdict::Request),
        frame(368, &[], Protocol::ModbusRtu, 60, Verdict::Silent),
        frame(400, &request, Protocol::ModbusRtu, 8, Verdict::Request),
        frame(428, &[1, 4, 2, 0, 0, 1, 1], Protocol::ModbusRtu, 20, Verdict::Broken("wrong CRC: 0101".to_owned())),
    ]
}

fn log_of(frames: impl IntoIterator<Item = Frame>) -> TrafficLog {
    let mut log = TrafficLog::default();
    frames.into_iter().for_each(|frame| log.push(frame));
    log
}

/// What frames mean to a PIR-234.
fn meaning(frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>) -> String {
    let definition = Catalogue::built_in().0.get("pir-234").unwrap();
    explain_frame(frame, request, Some(&definition)).summary
}

fn shown(log: &TrafficLog, filter: FrameFilter) -> Vec<u64> {
    let mut view = FilteredTraffic::new(filter);
    assert!(view.advance(log, &meaning, usize::MAX));
    view.seqs().collect()
}

fn text(text: &str) -> FrameFilter {
    FrameFilter { text: text.to_owned(), ..FrameFilter::default() }
}

#[test]
fn what_is_pushed_is_got_back_whole_and_in_order() {
    let frames = exchanges();
    let log = log_of(frames.clone());
    assert_eq!((log.len(), log.first_seq(), log.next_seq()), (10, 0, 10));
    for (seq, frame) in (0..).zip(&frames) {
        let kept = log.get(seq).unwrap();
        assert_eq!((kept.seq, kept.at, kept.bytes), (seq, frame.at, frame.bytes.as_slice()));
        assert_eq!((kept.protocol, kept.settings, kept.address), (frame.protocol, frame.settings, frame.address));
        assert_eq!((kept.took, kept.direction, kept.checksum), (frame.took, frame.direction, frame.checksum));
    }
    assert_eq!(log.get(9).unwrap().outcome, Outcome::Broken("wrong CRC: 0101"));
    assert_eq!(log.get(7).unwrap().outcome.trouble(), "no answer");
    assert_eq!(log.get(10), None);
}

#[test]
fn the_oldest_frames_are_forgotten_and_numbers_go_on() {
    let mut log = TrafficLog::bounded(100, 1 << 20);
    for index in 0..250u8 {
        log.push(frame(i64::from(index), &[index], Protocol::Dcon, 1, Verdict::Request));
    }
    assert_eq!((log.len(), log.first_seq(), log.next_seq()), (100, 150, 250));
    assert_eq!(log.get(149), None);
    assert!(log.iter().map(|frame| frame.bytes[0]).eq(150..250));
    log.clear();
    assert_eq!((log.len(), log.first_seq(), log.next_seq()), (0, 250, 250));
    log.push(frame(0, b"x", Protocol::Dcon, 1, Verdict::Request));
    assert_eq!(log.get(250).unwrap().bytes, b"x");
}

#[test]
fn bytes_are_bounded_too() {
    let mut log = TrafficLog::bounded(1_000_000, 1 << 20);
    for index in 0..5_000u32 {
        let bytes = [&index.to_be_bytes()[..], &[7; 996]].concat();
        log.push(frame(0, &bytes, Protocol::ModbusRtu, 1, Verdict::Answer));
    }
    assert!(log.footprint() < (1 << 20) + 500_000, "{}", log.footprint());
    assert!(log.len() > 700, "{}", log.len());
    for frame in log.iter() {
        assert_eq!(frame.bytes[..4], u32::try_from(frame.seq).unwrap().to_be_bytes());
    }
    let mut tiny = TrafficLog::bounded(10, 0);
    for _ in 0..20 {
        tiny.push(frame(0, &[1; 60_000], Protocol::Dcon, 1, Verdict::Request));
    }
    assert!(tiny.len() >= 4 && tiny.footprint() < 400_000, "{} {}", tiny.len(), tiny.footprint());
}

#[test]
fn a_million_frames_take_less_than_ninety_megabytes() {
    let mut log = TrafficLog::default();
    let (request, answer) = ([1; 8], [2; 60]);
    for index in 0..600_000 {
        log.push(frame(index, &request, Protocol::ModbusRtu, 8, Verdict::Request));
        log.push(frame(index, &answer, Protocol::ModbusRtu, 20, Verdict::Answer));
    }
    assert_eq!(log.len(), 1_000_000);
    assert_eq!(log.first_seq(), 200_000);
    assert!(log.footprint() < 90_000_000, "{}", log.footprint());
}

#[test]
fn an_answer_finds_its_request_and_only_its_own() {
    let log = log_of(exchanges());
    assert_eq!(log.request_of(7).map(|request| request.seq), Some(6));
    assert_eq!(log.request_of(6), None);
    let mut without_a_request = exchanges();
    without_a_request.remove(6);
    assert_eq!(log_of(without_a_request).request_of(6), None);
    // The answer to the first and the request of the last did not reach the log.
    let frames = exchanges();
    let log = log_of([frames[0].clone(), frames[9].clone()]);
    assert_eq!(log.request_of(1), None);
}

#[test]
fn each_part_of_a_filter_takes_away_what_does_not_fit() {
    let log = log_of(exchanges());
    assert_eq!(shown(&log, FrameFilter::default()).len(), 10);
    let dcon = FrameFilter { module: Some((1, Protocol::Dcon)), ..FrameFilter::default() };
    assert_eq!(shown(&log, dcon.clone()), [2, 3, 4, 5]);
    assert_eq!(shown(&log, FrameFilter { direction: Some(Direction::Received), ..dcon.clone() }), [3, 5]);
    assert_eq!(shown(&log, FrameFilter { only_errors: true, ..FrameFilter::default() }), [5, 7, 9]);
    assert_eq!(shown(&log, FrameFilter { only_errors: true, ..dcon }), [5]);
    let nobody = FrameFilter { module: Some((2, Protocol::Dcon)), ..FrameFilter::default() };
    assert_eq!(shown(&log, nobody), [0; 0]);
}

#[test]
fn text_is_found_in_bytes_in_dcon_text_in_trouble_and_in_meaning_whatever_the_case() {
    let log = log_of(exchanges());
    assert_eq!(shown(&log, text("0b b8")), [1]);
    assert_eq!(shown(&log, text("0BB8")), [1]);
    assert_eq!(shown(&log, text("pir234")), [3]);
    assert_eq!(shown(&log, text("NO ANSWER")), [7]);
    assert_eq!(shown(&log, text("Temperature_C 30")), [1]);
    assert_eq!(shown(&log, text("alarm limit")), [4]);
    assert_eq!(shown(&log, text("  ")).len(), 10);
}

#[test]
fn a_view_that_is_not_advanced_stands_still_while_the_log_goes_on() {
    let mut log = log_of(exchanges());
    let mut view = FilteredTraffic::new(FrameFilter::default());
    assert!(view.advance(&log, &meaning, usize::MAX));
    exchanges().into_iter().for_each(|frame| log.push(frame));
    assert_eq!((view.len(), view.seq(9), log.len()), (10, Some(9), 20));
    assert!(!view.advance(&log, &meaning, 3));
    assert_eq!(view.len(), 13);
    assert!(view.advance(&log, &meaning, 100));
    assert_eq!(view.len(), 20);
    assert_eq!(view.row_of(15), 15);
}

#[test]
fn another_filter_begins_at_the_oldest_frame_and_the_same_one_goes_on() {
    let log = log_of(exchanges());
    let mut view = FilteredTraffic::new(text("pir234"));
    view.advance(&log, &meaning, usize::MAX);
    view.set_filter(text("pir234"));
    assert_eq!(view.len(), 1);
    view.set_filter(FrameFilter { only_errors: true, ..FrameFilter::default() });
    assert!(view.is_empty());
    assert!(view.advance(&log, &meaning, usize::MAX));
    assert_eq!(view.seqs().collect::<Vec<_>>(), [5, 7, 9]);
}

proptest! {
    #[test]
    fn a_filter_worked_on_in_steps_shows_what_it_shows_at_once(
        steps in prop::collection::vec((0usize..30, 0usize..40), 1..30),
        only_errors: bool,
        searched in prop_oneof![Just(""), Just("01"), Just("temperature"), Just("?01")],
    ) {
        let filter = FrameFilter { only_errors, ..text(searched) };
        let frames = exchanges();
        let mut source = frames.iter().cycle();
        let mut log = TrafficLog::bounded(60, 1 << 20);
        let mut view = FilteredTraffic::new(filter.clone());
        for (pushed, budget) in steps {
            source.by_ref().take(pushed).for_each(|frame| log.push(frame.clone()));
            view.advance(&log, &|frame, _| hex::spaced(frame.bytes), budget);
        }
        while !view.advance(&log, &|frame, _| hex::spaced(frame.bytes), 7) {}
        let mut fresh = FilteredTraffic::new(filter);
        fresh.advance(&log, &|frame, _| hex::spaced(frame.bytes), usize::MAX);
        prop_assert_eq!(view.seqs().collect::<Vec<_>>(), fresh.seqs().collect::<Vec<_>>());
    }

    #[test]
    fn whatever_is_pushed_the_last_frames_are_there_in_order(
        lengths in prop::collection::vec(0usize..70_000, 1..60),
        most in 1usize..40,
    ) {
        let mut log = TrafficLog::bounded(most, 600_000);
        for length in &lengths {
            log.push(frame(0, &vec![*length as u8; *length], Protocol::Dcon, 1, Verdict::Broken("ä".repeat(300))));
        }
        prop_assert!(log.len() <= most && !log.is_empty());
        prop_assert_eq!(log.next_seq(), lengths.len() as u64);
        for (kept, length) in log.iter().zip(&lengths[log.first_seq() as usize..]) {
            prop_assert_eq!(kept.bytes, vec![*length as u8; (*length).min(65_535)]);
            prop_assert!(kept.outcome.trouble().starts_with("ää"));
        }
        prop_assert_eq!(log.iter().count(), log.len());
    }
}

#[test]
fn the_log_reads_back_from_csv() {
    let log = log_of(exchanges());
    let mut file = Vec::new();
    assert_eq!(write_csv(&log, 0..99, &meaning, &mut file).unwrap(), 10);
    let mut reader = csv::Reader::from_reader(file.as_slice());
    let columns: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let cell = |row: usize, column: &str| rows[row][columns.iter().position(|name| name == column).unwrap()].to_owned();
    assert_eq!(rows.len(), 10);
    assert_eq!(cell(1, "time"), "2024-05-06T07:08:09.028000Z");
    assert_eq!((cell(1, "direction"), cell(0, "direction")), ("received".into(), "sent".into()));
    assert_eq!((cell(1, "baud_rate"), cell(1, "data_format")), ("9600".into(), "n81".into()));
    assert_eq!((cell(1, "took_ms"), cell(1, "protocol")), ("20.0".into(), "modbus_rtu".into()));
    assert_eq!(cell(1, "meaning"), "temperature_c 30.00 °C");
    assert_eq!((cell(3, "text"), cell(3, "bytes")), ("!01PIR234\\r".into(), "21 30 31 50 49 52 32 33 34 0D".into()));
    assert_eq!(
        (cell(7, "verdict"), cell(7, "error"), cell(7, "bytes")),
        ("silent".into(), "no answer".into(), "".into())
    );
    assert_eq!((cell(9, "verdict"), cell(9, "error")), ("broken".into(), "wrong CRC: 0101".into()));
    let mut empty = Vec::new();
    write_csv(&log, [], &meaning, &mut empty).unwrap();
    assert_eq!(String::from_utf8(empty).unwrap().trim_end(), columns.join(","));
}

#[test]
fn the_log_reads_back_from_json_lines() {
    let mut frames = exchanges();
    frames.push(Frame { address: None, ..frame(500, &[0, 1], Protocol::ModbusTcp, 1, Verdict::Answer) });
    let log = log_of(frames);
    let mut file = Vec::new();
    assert_eq!(write_json_lines(&log, [1, 3, 10, 4711], &meaning, &mut file).unwrap(), 3);
    let lines = String::from_utf8(file).unwrap();
    let rows: Vec<serde_json::Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(rows.len(), 3);
    assert_eq!(rows[0]["time"], "2024-05-06T07:08:09.028000Z");
    assert_eq!((&rows[0]["address"], &rows[0]["took_ms"]), (&serde_json::json!(1), &serde_json::json!(20.0)));
    assert_eq!(rows[1]["text"], "!01PIR234\\r");
    assert_eq!((&rows[2]["address"], &rows[2]["baud_rate"]), (&serde_json::Value::Null, &serde_json::Value::Null));
    assert_eq!(rows[2]["protocol"], "modbus_tcp");
}
