//! What comes back on DCON requests. The first byte chooses checksum and module; the rest is frames that end with a
//! carriage return.
#![no_main]

use std::sync::{Arc, OnceLock};

use dcon_bench::module::{Catalogue, Definition, ReadPlan, explain, identify};
use dcon_bench::protocol::{Protocol, dcon, hex, parse_addresses};
use dcon_bench_fuzz::answers::{Played, check_values};
use dcon_bench_fuzz::{sums, take_byte};
use libfuzzer_sys::fuzz_target;

fn catalogue() -> &'static Catalogue {
    static CATALOGUE: OnceLock<Catalogue> = OnceLock::new();
    CATALOGUE.get_or_init(|| Catalogue::built_in().0)
}

fuzz_target!(|data: &[u8]| {
    let mut rest = data;
    let choice = take_byte(&mut rest);
    frames(rest);
    texts(rest);
    let models = ["pir-130", "pir-234", "pir-230", "dl-302"];
    if let Some(definition) = catalogue().get(models[usize::from(choice >> 1 & 3)]) {
        module(&definition, choice & 1 == 1, rest);
    }
});

/// What is accepted is what was sent, and carries the right checksum where there has to be one.
fn frames(received: &[u8]) {
    let found = dcon::find_answer(received);
    if let Some(range) = found.clone() {
        let frame = &received[range.clone()];
        assert!(dcon::ANSWER_DELIMITERS.contains(&frame[0]));
        assert_eq!(received[range.end], dcon::CR);
        assert!(!frame.contains(&dcon::CR));
        assert!(!received[..range.start].iter().any(|byte| dcon::ANSWER_DELIMITERS.contains(byte)));
    }
    let frame = found.map_or(received, |range| &received[range]);
    for checksum in [false, true] {
        let Ok(answer) = dcon::decode(frame, checksum) else { continue };
        let text = answer.to_text();
        let sum = if checksum { sums::dcon(text.as_bytes()).to_vec() } else { Vec::new() };
        assert_eq!([text.as_bytes(), &sum].concat(), bare(frame));
        assert_eq!(dcon::encode(&text, checksum), [bare(frame), b"\r"].concat());
        assert_eq!(dcon::decode(&dcon::encode(&text, checksum), checksum), Ok(answer));
    }
}

/// Without the line ends around it.
fn bare(frame: &[u8]) -> &[u8] {
    let is_text = |byte: &u8| !matches!(byte, b'\r' | b'\n');
    let start = frame.iter().position(is_text).unwrap_or(frame.len());
    let end = frame.iter().rposition(is_text).map_or(start, |last| last + 1);
    &frame[start..end]
}

fn texts(bytes: &[u8]) {
    assert_eq!(hex::parse(&hex::spaced(bytes)).as_deref(), Ok(bytes));
    assert!(hex::escaped(bytes).bytes().all(|byte| (b' '..=b'~').contains(&byte)));
    let text = String::from_utf8_lossy(bytes);
    if let Ok(parsed) = hex::parse(&text) {
        assert_eq!(hex::parse(&hex::spaced(&parsed)), Ok(parsed));
    }
    if let Ok(mut addresses) = parse_addresses(&text) {
        let count = addresses.len();
        addresses.sort_unstable();
        addresses.dedup();
        assert_eq!(addresses.len(), count, "an address is there twice");
    }
}

/// Whatever a module says, its values are of their items' kinds, and what it said can be explained.
fn module(definition: &Arc<Definition>, checksum: bool, answers: &[u8]) {
    let mut played = Played::new(answers, checksum);
    match identify(catalogue(), Protocol::Dcon, 1, &mut played) {
        Ok(_) => {}
        Err(failure) => assert!(!failure.shows_presence(), "{failure} is an answer"),
    }
    let mut played = Played::new(answers, checksum);
    let ids = definition.readable_ids(Protocol::Dcon, &[]);
    let read = ReadPlan::new(definition, Protocol::Dcon, ids).run(1, &mut played);
    check_values(definition, &read);
    assert!(played.brought_something() || read.iter().all(|answer| answer.result.is_err()));
    for (request, frame) in &played.frames {
        for known in [None, Some(definition.as_ref())] {
            assert!(!explain(known, Protocol::Dcon, checksum, request, None).summary.is_empty());
            assert!(!explain(known, Protocol::Dcon, checksum, request, Some(frame)).summary.is_empty());
            // Typed by a person, or heard in the middle of a conversation.
            assert!(!explain(known, Protocol::Dcon, checksum, frame, None).summary.is_empty());
            assert!(!explain(known, Protocol::Dcon, checksum, &[], Some(frame)).summary.is_empty());
        }
    }
}
