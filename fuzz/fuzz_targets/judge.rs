//! What the bus accepts of bytes that come when they like. The first byte chooses speed and language, the second the
//! request; the rest is steps of the line (`src/line.rs`). Three conversations follow each other on the same line.
#![no_main]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::transaction::Wire;
use dcon_bench::bus::{Direction, Frame, Patience, RawRequest, Target};
use dcon_bench::module::Ask;
use dcon_bench::protocol::{AnswerFrom, BaudRate, DataFormat, LineSettings, Protocol, Query, Reply};
use dcon_bench_fuzz::line::Scripted;
use dcon_bench_fuzz::{sums, take_byte};
use libfuzzer_sys::fuzz_target;

const WINDOW: Duration = Duration::from_millis(200);
/// Until a babbling line is given up on, before a request and after it, and what the clock's steps add.
const MOST_BABBLE: Duration = Duration::from_millis(2_500);
/// Longer than a late answer is waited for.
const LATE: Duration = Duration::from_millis(2_500);
const ADDRESS: u8 = 0x0A;

const REQUESTS: [&[u8]; 8] = [
    &[ADDRESS, 3, 1, 0xE0, 0, 4],
    &[ADDRESS, 1, 0, 0, 0, 9],
    &[ADDRESS, 4, 0, 0, 0, 5],
    &[ADDRESS, 6, 2, 0, 0, 10],
    &[ADDRESS, 0x46, 0],
    &[ADDRESS, 0x46, 5, 0],
    &[ADDRESS, 0x46, 7],
    &[ADDRESS, 0x41, 1, 2],
];

type Heard = Arc<Mutex<Vec<Frame>>>;

fuzz_target!(|data: &[u8]| {
    let mut rest = data;
    let (choice, which) = (take_byte(&mut rest), take_byte(&mut rest));
    let (dcon, checksum) = (choice & 1 == 1, choice & 2 == 2);
    let settings =
        LineSettings { baud_rate: BaudRate::ALL[usize::from(choice >> 2 & 7)], data_format: DataFormat::N81 };
    let heard = Heard::default();
    let tap = heard.clone();
    let line = Scripted::new(rest, dcon, checksum);
    let tap = Box::new(move |frame| tap.lock().expect("one thread").push(frame));
    let mut wire = Wire::new(Box::new(line), settings, tap).expect("a line that is there");
    wire.expect_echoes(choice & 0x80 != 0);
    let mut dialogue = Dialogue::on_wire(wire).expect("a runtime");
    let body = REQUESTS[usize::from(which & 7)];
    for _ in 0..3 {
        let request = match dcon {
            true => RawRequest::Dcon { text: "$0AM".to_owned(), checksum },
            false => RawRequest::Modbus { bytes: body.to_vec() },
        };
        let before = dialogue.now();
        let outcome = dialogue.raw(&request, WINDOW);
        let most = MOST_BABBLE + LATE + WINDOW + settings.wire_time(256 + 3 * 16);
        assert!(dialogue.now() - before < most, "{:?} for one exchange", dialogue.now() - before);
        if let Ok(answer) = outcome {
            accepted(&answer, dcon, checksum, body, &heard);
        }
        let protocol = if dcon { Protocol::Dcon } else { Protocol::ModbusRtu };
        questions(&mut dialogue, Target { address: ADDRESS, protocol, settings, checksum }, &heard);
    }
});

/// It was on the line as it stands, and says whose it is.
fn accepted(answer: &[u8], dcon: bool, checksum: bool, request: &[u8], heard: &Heard) {
    assert!(received(answer, heard), "nobody sent {answer:02X?}");
    if dcon {
        let mut answer = answer;
        while let Some(rest) = answer.strip_suffix(b"\n") {
            answer = rest;
        }
        assert!(matches!(answer[0], b'!' | b'>' | b'?'));
        assert!(answer.iter().all(|byte| (b' '..=b'~').contains(byte)));
        if checksum {
            let (text, sum) = answer.split_at(answer.len() - 2);
            assert_eq!(sums::dcon(text), sum);
        }
        return;
    }
    let (body, sum) = answer.split_at(answer.len() - 2);
    assert_eq!(sums::crc(body), sum);
    assert_eq!((body[0], body[1] & 0x7F), (request[0], request[1]));
}

/// Through the whole way up: a reply is what the last frame holds, of the length that was asked for.
fn questions(dialogue: &mut Dialogue, target: Target, heard: &Heard) {
    let patience = Patience { after_garbage: 1, ..Patience::scan(WINDOW) };
    let query = match target.protocol {
        Protocol::Dcon => {
            Query::Dcon { text: "$0AM".to_owned(), from: AnswerFrom::Addresses(vec![ADDRESS]), write: false }
        }
        _ => Query::ReadHoldingRegisters { first: 480, count: 4 },
    };
    match dialogue.with(target, patience).ask(&query) {
        Ok(Reply::Text(text)) => {
            assert!(target.protocol == Protocol::Dcon);
            assert!(text == "!" || text.get(1..3).is_some_and(|from| from.eq_ignore_ascii_case("0A")), "{text}");
            let sum = if target.checksum { sums::dcon(text.as_bytes()).to_vec() } else { Vec::new() };
            assert!(received(&[text.as_bytes(), &sum].concat(), heard), "nobody sent {text}");
        }
        Ok(Reply::Words(words)) => {
            let data: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
            let frame = sums::with_crc(&[&[ADDRESS, 3, 8], data.as_slice()].concat());
            assert!(words.len() == 4 && received(&frame, heard), "nobody sent {words:02X?}");
        }
        Ok(other) => panic!("{other:?} is no answer to {query:?}"),
        Err(_) => {}
    }
}

/// Whether the last frame that came has these bytes in a row.
fn received(bytes: &[u8], heard: &Heard) -> bool {
    let heard = heard.lock().expect("one thread");
    let last = heard.iter().rev().find(|frame| frame.direction == Direction::Received);
    last.is_some_and(|frame| frame.bytes.windows(bytes.len().max(1)).any(|part| part == bytes))
}
