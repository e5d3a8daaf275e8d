use std::time::Duration;

use jiff::Timestamp;
use proptest::prelude::*;

use super::*;
use crate::bus::{Direction, Verdict};
use crate::protocol::{BaudRate, DataFormat, LineSettings, Protocol, modbus};

const BOTH: [Form; 2] = [Form::Pcapng, Form::Text];

fn written(form: Form, frames: &[Frame]) -> Vec<u8> {
    let mut writer = CaptureWriter::new(form, Vec::new(), "COM3").unwrap();
    frames.iter().for_each(|frame| writer.frame(frame).unwrap());
    writer.finish().unwrap()
}

fn verdicts() -> impl Strategy<Value = Verdict> {
    prop_oneof![
        Just(Verdict::Request),
        Just(Verdict::Answer),
        Just(Verdict::Refusal),
        Just(Verdict::Silent),
        any::<String>().prop_map(Verdict::Broken),
        Just(Verdict::Broken("wrong CRC: 0101; reason: \\u{41}\r\n # echo; took 1 ms".to_owned())),
    ]
}

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..60),
        prop::collection::vec(any::<u8>(), 1..20).prop_map(|bytes| modbus::with_crc(&bytes)),
        Just(b"$01M;\r".to_vec()),
    ]
}

fn durations() -> impl Strategy<Value = Duration> {
    prop_oneof![
        Just(Duration::ZERO),
        any::<u32>().prop_map(|micros| Duration::from_micros(micros.into())),
        any::<Duration>()
    ]
}

prop_compose! {
    fn any_frame()(
        at in 0i128..=i128::from(u64::MAX),
        sent: bool,
        bytes in bytes(),
        protocol in prop::sample::select(Protocol::ALL.to_vec()),
        baud_rate in prop::sample::select(BaudRate::ALL.to_vec()),
        data_format in prop::sample::select(DataFormat::ALL.to_vec()),
        address: Option<u8>,
        (checksum, echo, noise) in any::<(bool, bool, bool)>(),
        took in durations(),
        first_byte in prop::option::of(durations()),
        verdict in verdicts(),
    ) -> Frame {
        Frame {
            at: Timestamp::from_nanosecond(at).unwrap(),
            direction: if sent { Direction::Sent } else { Direction::Received },
            bytes, protocol, settings: LineSettings { baud_rate, data_format },
            address, checksum, took, first_byte, echo, noise, verdict,
        }
    }
}

fn frame(at: &str, bytes: &[u8], verdict: Verdict) -> Frame {
    Frame {
        at: at.parse().unwrap(),
        direction: if verdict == Verdict::Request { Direction::Sent } else { Direction::Received },
        bytes: bytes.to_vec(),
        protocol: Protocol::ModbusRtu,
        settings: LineSettings::default(),
        address: Some(1),
        checksum: false,
        took: Duration::from_micros(12_345),
        first_byte: None,
        echo: false,
        noise: false,
        verdict,
    }
}

/// A request, and its answer with the echo before and stray bytes on both sides.
fn noisy() -> [Frame; 2] {
    let (request, answer) = (modbus::with_crc(&[1, 4, 0, 0, 0, 1]), modbus::with_crc(&[1, 4, 2, 0x0B, 0xB8]));
    let bytes = [&request[..], &[0xFF, 1, 0x90], &answer, &[0, 0]].concat();
    let sent = frame("2024-05-06T07:08:09Z", &request, Verdict::Request);
    let received = frame("2024-05-06T07:08:09.028Z", &bytes, Verdict::Answer);
    let first_byte = Some(Duration::from_nanos(5_210_001));
    [sent, Frame { echo: true, noise: true, first_byte, ..received }]
}

proptest! {
    #[test]
    fn frames_come_back_as_they_were(frames in prop::collection::vec(any_frame(), 0..12)) {
        for form in BOTH {
            let (read, error) = read_bytes(&written(form, &frames));
            prop_assert!(error.is_none(), "{:?}", error);
            prop_assert_eq!(&read, &frames);
        }
    }

    #[test]
    fn a_cut_file_gives_the_frames_before_the_cut(
        frames in prop::collection::vec(any_frame(), 1..8),
        cut in any::<prop::sample::Index>(),
    ) {
        for form in BOTH {
            let whole = written(form, &frames);
            let (read, error) = read_bytes(&whole[..cut.index(whole.len())]);
            prop_assert!(frames.starts_with(&read));
            // A cut between two frames is none, nor is one between the blocks that a file begins with.
            let (cut, kept) = (cut.index(whole.len()), written(form, &read).len());
            prop_assert!(error.is_some() || kept == cut || (read.is_empty() && cut < kept), "{} of {}", cut, kept);
        }
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes: Vec<u8>, magic: bool) {
        let beginning: &[u8] = if magic { &PCAPNG_BEGINNING } else { b"#" };
        let _ = read_bytes(&[beginning, &bytes].concat());
        let _ = read_bytes(&bytes);
    }

    #[test]
    fn no_change_to_a_capture_makes_the_reader_panic(
        frames in prop::collection::vec(any_frame(), 1..4),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        for form in BOTH {
            let mut file = written(form, &frames);
            for (place, byte) in &changes {
                let place = place.index(file.len());
                file[place] = *byte;
            }
            let (read, _) = read_bytes(&file);
            prop_assert!(read.len() <= 3 * frames.len());
        }
    }

    #[test]
    fn no_words_make_the_parser_panic(text: String, tail: String) {
        let _ = words::read(&text);
        let _ = words::read(&format!("broken; Modbus RTU; took {text} ms; first byte {tail}; reason: \\u{{{text}"));
    }
}

#[test]
fn a_frame_in_text_is_a_line_that_people_can_read() {
    let [_, answer] = noisy();
    let file = String::from_utf8(written(Form::Text, &[answer])).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let expected = format!(
        "# dcon-bench {version}: traffic of COM3, times in UTC\n2024-05-06T07:08:09.028000000Z  received  01 04 00 00 00 01 31 \
         CA FF 01 90 01 04 02 0B B8 BE 72 00 00  answer; Modbus RTU; 9600 N81; address 1; took 12.345 ms; first byte \
         5.210001 ms; echo; noise\n"
    );
    assert_eq!(file, expected);
}

#[test]
fn text_that_was_given_other_line_ends_and_remarks_reads_the_same() {
    let frames = noisy();
    let file = String::from_utf8(written(Form::Text, &frames)).unwrap();
    let edited = file.replace('\n', "\r\n\r\n# seen at the second floor\r\n");
    let (read, error) = read_bytes(edited.as_bytes());
    assert!(error.is_none(), "{error:?}");
    assert_eq!(read, frames);
}

#[test]
fn an_answer_is_a_packet_of_its_own_without_echo_and_stray_bytes() {
    let [request, answer] = noisy();
    let found = parts::of(&answer, &answer.bytes, &request.bytes);
    assert_eq!(found.echo, request.bytes);
    assert_eq!((found.before, found.after), (&[0xFF, 1, 0x90][..], &[0, 0][..]));
    assert_eq!(found.answer, modbus::with_crc(&[1, 4, 2, 0x0B, 0xB8]));
}

#[test]
fn a_frame_that_is_too_long_keeps_its_beginning() {
    let long = frame("2024-05-06T07:08:09Z", &vec![7; MOST_BYTES + 5], Verdict::Silent);
    for form in BOTH {
        let (read, error) = read_bytes(&written(form, std::slice::from_ref(&long)));
        assert!(error.is_none(), "{error:?}");
        assert_eq!(read[0].bytes, long.bytes[..MOST_BYTES]);
    }
}

#[test]
fn a_capture_without_frames_is_one() {
    for form in BOTH {
        assert!(matches!(read_bytes(&written(form, &[])), (frames, None) if frames.is_empty()));
    }
}

#[test]
fn what_is_no_capture_is_refused_with_what_it_is() {
    let refused = |bytes: &[u8]| read_bytes(bytes).1.unwrap().to_string();
    assert!(refused(b"").contains("no capture"));
    assert!(refused(b"time,value\n").contains("no capture"));
    assert!(refused(b"2024 was a good year\n").contains("no capture"));
    assert!(refused(b"2024 was").contains("ends in the middle"));
    assert!(refused(b"\xD4\xC3\xB2\xA1\x02\x00\x04\x00").contains("save it as pcapng"));
    let mut damaged = written(Form::Text, &noisy());
    damaged.extend(b"more\n");
    let (frames, error) = read_bytes(&damaged);
    assert_eq!(frames.len(), 2);
    assert!(error.unwrap().to_string().contains("line 4"));
}

#[test]
fn form_follows_the_ending() {
    let of = |name: &str| Form::of_path(Path::new(name));
    assert_eq!([of("a.pcapng"), of("A.PCAPNG")], [Some(Form::Pcapng); 2]);
    assert_eq!([of("a.txt"), of("b/a.log")], [Some(Form::Text); 2]);
    assert_eq!([of("a.pcap"), of("txt"), of("")], [None; 3]);
}
