//! What comes back over Modbus, the PIR-130's own function 0x46 among it. The first byte chooses a request, a module and
//! a protocol; the rest is an answer to that request, and the answers of a module that is identified and read.
#![no_main]

use std::sync::{Arc, OnceLock};

use dcon_bench::module::{Catalogue, Definition, ReadPlan, explain, identify, present_options};
use dcon_bench::protocol::modbus::{self, AnswerLength};
use dcon_bench::protocol::{Protocol, Query};
use dcon_bench_fuzz::answers::{Played, check_values};
use dcon_bench_fuzz::{sums, take_byte};
use libfuzzer_sys::fuzz_target;

const REQUESTS: [&[u8]; 16] = [
    &[1, 0x46, 0],
    &[1, 0x46, 4, 2, 0, 0, 0],
    &[1, 0x46, 5, 0],
    &[1, 0x46, 6, 0, 6, 0, 0, 0, 1, 0],
    &[1, 0x46, 0x20],
    &[1, 0x46, 7],
    &[1, 1, 0, 0, 0, 9],
    &[1, 2, 0, 32, 0, 5],
    &[1, 3, 1, 0xE0, 0, 4],
    &[1, 4, 0, 0, 0, 5],
    &[1, 5, 0, 0, 0xFF, 0],
    &[1, 6, 2, 0, 0, 10],
    &[1, 15, 0, 0, 0, 3, 1, 5],
    &[1, 16, 0, 0, 0, 1, 2, 0, 7],
    &[0xA0, 0x41, 1, 2],
    &[1],
];

fn catalogue() -> &'static Catalogue {
    static CATALOGUE: OnceLock<Catalogue> = OnceLock::new();
    CATALOGUE.get_or_init(|| Catalogue::built_in().0)
}

fuzz_target!(|data: &[u8]| {
    let mut rest = data;
    let choice = take_byte(&mut rest);
    let request = sums::with_crc(REQUESTS[usize::from(choice & 15)]);
    assert_eq!(modbus::with_crc(REQUESTS[usize::from(choice & 15)]), request);
    for answer in [rest.to_vec(), sums::with_crc(rest)] {
        frame(&request, &answer);
    }
    let model = if choice & 16 == 0 { "pir-130" } else { "pir-234" };
    let protocol = if choice & 32 == 0 { Protocol::ModbusRtu } else { Protocol::ModbusTcp };
    if let Some(definition) = catalogue().get(model) {
        module(&definition, protocol, rest);
    }
    for known in [None, catalogue().get(model).as_deref()] {
        for bytes in [rest.to_vec(), sums::with_crc(rest)] {
            assert!(!explain(known, protocol, false, &bytes, None).summary.is_empty());
            assert!(!explain(known, protocol, false, &request, Some(&bytes)).summary.is_empty());
            assert!(!explain(known, protocol, false, &[], Some(&bytes)).summary.is_empty());
        }
    }
});

/// Nothing is accepted that is cut, damaged, from elsewhere or of another shape; its length is known early and stays.
fn frame(request: &[u8], answer: &[u8]) {
    let length = modbus::answer_length(request, answer);
    for end in 2..answer.len() {
        let early = modbus::answer_length(request, &answer[..end]);
        assert!(early == AnswerLength::NotYetKnown || early == length, "{early:?}, then {length:?}");
    }
    if modbus::check_answer(request, answer).is_err() {
        return;
    }
    let (body, sum) = answer.split_at(answer.len() - 2);
    assert_eq!(sums::crc(body), sum);
    assert_eq!((body[0], body[1] & 0x7F), (request[0], request[1] & 0x7F));
    assert!(!matches!(length, AnswerLength::Bytes(expected) if expected != answer.len()));
    assert!(!matches!(length, AnswerLength::Mismatch | AnswerLength::NotYetKnown));
    if matches!(body[1], 1..=4) {
        assert_eq!(usize::from(body[2]) + 5, answer.len());
    }
    if !answer.is_empty() {
        let mut damaged = answer.to_vec();
        damaged[answer.len() / 2] ^= 0x10;
        assert!(modbus::check_answer(request, &damaged).is_err());
    }
}

/// Whatever a module says, its values are of their items' kinds, and only reads were asked.
fn module(definition: &Arc<Definition>, protocol: Protocol, answers: &[u8]) {
    let mut played = Played::new(answers, false);
    if let Err(failure) = identify(catalogue(), protocol, 1, &mut played) {
        assert!(!failure.shows_presence(), "{failure} is an answer");
    }
    assert!(!played.exchanges.iter().any(|(query, _)| query.is_write()));
    let mut played = Played::new(answers, false);
    let options = present_options(definition, protocol, &mut played).unwrap_or_default();
    let ids = definition.readable_ids(protocol, &options);
    let read = ReadPlan::new(definition, protocol, ids).run(1, &mut played);
    check_values(definition, &read);
    assert!(!played.exchanges.iter().any(|(query, _)| query.is_write()));
    let bits_or_words = |query: &Query| !matches!(query, Query::Dcon { .. });
    assert!(played.exchanges.iter().all(|(query, _)| bits_or_words(query)));
    assert!(played.brought_something() || read.iter().all(|answer| answer.result.is_err()));
}
