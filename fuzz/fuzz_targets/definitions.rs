//! Definition files. What is refused is said with file, line and reason; what loads can be used.
#![no_main]

use std::sync::{Arc, OnceLock};

use dcon_bench::bench::console::{Direction, ReferenceField, reference, register_table, search};
use dcon_bench::module::{Answer, Catalogue, Definition, Fields, ReadPlan, check_write, danger, explain, write_item};
use dcon_bench::protocol::Protocol;
use dcon_bench_fuzz::answers::{Played, check_values};
use libfuzzer_sys::fuzz_target;

const FILE: &str = "fuzz.toml";

/// What a file may be based on.
fn base() -> &'static (String, String) {
    static BASE: OnceLock<(String, String)> = OnceLock::new();
    BASE.get_or_init(|| ("tm-1.toml".to_owned(), include_str!("../../tests/vectors/tm-1.toml").to_owned()))
}

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let own = (FILE.to_owned(), text.to_owned());
    let texts = if text.contains("based_on") { vec![base().clone(), own] } else { vec![own] };
    let count = texts.len();
    let (catalogue, errors) = Catalogue::from_texts(texts);
    let lines = text.split('\n').count();
    for error in &errors {
        assert!(!error.reason.trim().is_empty() && !error.file.is_empty());
        assert!(error.file != FILE || error.line.is_none_or(|line| (1..=lines).contains(&line)), "{error}");
    }
    assert!(catalogue.iter().count() > 0 || !errors.is_empty());
    assert!(catalogue.iter().count() <= count);
    for definition in catalogue.iter() {
        use_it(definition);
    }
});

fn use_it(definition: &Arc<Definition>) {
    for protocol in Protocol::ALL {
        let options: Vec<String> = definition.optional.iter().map(|part| part.id.clone()).collect();
        let ids = definition.readable_ids(protocol, &options);
        let mut plan = ReadPlan::new(definition, protocol, ids.iter().copied());
        assert!(plan.questions(1) <= ids.len());
        for answers in [b"".as_slice(), b"!01+25.00\r!0100\r?01\r>01FF\r!01PIR130\r", &[0x55; 400]] {
            let mut played = Played::new(answers, false);
            let read = plan.run(1, &mut played);
            assert_eq!(read.len(), ids.len());
            check_values(definition, &read);
            panel(definition, &read);
        }
        for item in definition.items_over(protocol) {
            let value =
                item.factory.clone().or_else(|| ["1", "0", "true"].iter().find_map(|text| item.parse(text).ok()));
            let Some(value) = value else { continue };
            let _ = check_write(definition, protocol, item, &value);
            let mut played = Played::new(&[0; 40], false);
            let _ = write_item(definition, protocol, 1, item, &value, &mut played);
            let writes = played.exchanges.iter().filter(|(query, _)| query.is_write()).count();
            assert!(writes <= item.accesses.len(), "{} was written {writes} times", item.id);
        }
        for entry in register_table(definition, protocol) {
            let _ = entry.wire();
        }
    }
    commands(definition);
}

/// The switches as they stand by what was read.
fn panel(definition: &Definition, read: &[Answer]) {
    let known = |id: &str| read.iter().find(|answer| answer.id == id)?.result.as_ref().ok().cloned();
    for address in [None, Some(1)] {
        let _ = definition.switches(address, &known);
    }
}

/// The reference's own commands are understood when they are seen on the line.
fn commands(definition: &Definition) {
    let entries = reference(definition);
    let _ = search(&entries, "temperature $01M");
    for entry in &entries {
        for direction in [Direction::Read, Direction::Write] {
            let filled = |field: &ReferenceField| Some((field.name.clone(), field.default.as_ref()?.text(1)));
            let fields: Fields = entry.fields_to_fill(direction).filter_map(filled).collect();
            let Ok(text) = entry.fill(direction, 1, &fields) else { continue };
            if entry.function.is_some() {
                continue;
            }
            let frame = [text.as_bytes(), b"\r"].concat();
            for answer in [None, Some(b"!01+12.50\r".as_slice()), Some(b"?01\r"), Some(b"!\r")] {
                assert!(!explain(Some(definition), Protocol::Dcon, false, &frame, answer).summary.is_empty());
            }
            let _ = danger(Some(definition), Protocol::Dcon, false, &frame);
        }
    }
    for function in [1u8, 2, 3, 4, 5, 6, 15, 16, 0x46, 0x83] {
        let frame = dcon_bench_fuzz::sums::with_crc(&[1, function, 0, 0, 0, 2, 4, 0, 1, 0, 1]);
        for answer in [None, Some(frame.as_slice())] {
            assert!(!explain(Some(definition), Protocol::ModbusRtu, false, &frame, answer).summary.is_empty());
        }
    }
}
