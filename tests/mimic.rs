//! Modules made from definition files: the example that comes with the program, a small file of a user, and the PIR
//! definitions, each as a simulated module that a program talks to.

mod common;

use std::sync::Arc;
use std::time::Duration;

use common::{ask, exchange};
use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::transaction::Wire;
use dcon_bench::bus::{Patience, Target};
use dcon_bench::mimic::{Mimic, MimicSpec};
use dcon_bench::module::{
    Applies, Catalogue, Definition, Fixed, Identified, Item, Kind, Value, WriteError, check_write, identify, load_file,
    read_items, run_action, write_item,
};
use dcon_bench::protocol::{Failure, LineSettings, Protocol, modbus};
use dcon_bench::sim::{Guest, ModuleSpec, Pace, Sim};
use proptest::prelude::*;

/// A small definition as a user might write one.
const SMALL: &str = include_str!("vectors/tm-1.toml");

struct Bench {
    sim: Sim,
    dialogue: Dialogue,
    catalogue: Catalogue,
    definition: Arc<Definition>,
    target: Target,
}

impl Bench {
    /// A line with nothing but this module, whose definition is in the catalogue.
    fn open(catalogue: Catalogue, spec: &str) -> Self {
        let spec: MimicSpec = spec.parse().unwrap();
        let definition = spec.definition(&catalogue, &[]).unwrap();
        let sim = Sim::new(&[], Pace::Skip);
        sim.join(Box::new(Mimic::new(definition.clone(), spec.placing)));
        let place = spec.placing;
        let wire = Wire::new(Box::new(sim.line()), place.settings, Box::new(|_| {})).unwrap();
        let dialogue = Dialogue::on_wire(wire).unwrap();
        let target = Target {
            address: place.address,
            protocol: place.protocol,
            settings: place.settings,
            checksum: place.checksum,
        };
        Self { sim, dialogue, catalogue, definition, target }
    }

    fn built_in(spec: &str) -> Self {
        Self::open(Catalogue::built_in().0, spec)
    }

    fn small(spec: &str) -> Self {
        let (catalogue, errors) = Catalogue::from_texts(vec![("tm-1.toml".to_owned(), SMALL.to_owned())]);
        assert_eq!(errors, []);
        Self::open(catalogue, spec)
    }

    fn identify(&mut self) -> Result<Identified, Failure> {
        let Target { protocol, address, .. } = self.target;
        identify(&self.catalogue, protocol, address, &mut self.dialogue.with(self.target, Patience::CONVERSATION))
    }

    fn items(&self) -> Vec<Item> {
        self.definition.items_over(self.target.protocol).cloned().collect()
    }

    fn read(&mut self, id: &str) -> Value {
        let Target { protocol, address, .. } = self.target;
        let mut speaker = self.dialogue.with(self.target, Patience::CONVERSATION);
        let answer = read_items(&self.definition, protocol, address, [id], &mut speaker).pop().unwrap();
        answer.result.unwrap_or_else(|failure| panic!("{id} over {}: {failure}", self.target))
    }

    fn write(&mut self, id: &str, text: &str) -> Result<Value, WriteError> {
        let Target { protocol, address, .. } = self.target;
        let item = self.definition.item(id).unwrap().clone();
        let value = item.parse(text).unwrap_or_else(|error| panic!("{error}"));
        let mut speaker = self.dialogue.with(self.target, Patience::CONVERSATION);
        write_item(&self.definition, protocol, address, &item, &value, &mut speaker)
    }

    /// What the module holds, whatever the wire says.
    fn holds(&self, id: &str) -> String {
        self.sim.setting(self.target.address, id).unwrap_or_else(|| panic!("{id}"))
    }
}

/// Values worth trying that the protocol can carry: all of a list, the ends and a third of a range.
fn samples(definition: &Definition, item: &Item, protocol: Protocol) -> Vec<String> {
    let texts: Vec<String> = match &item.kind {
        Kind::Bool => vec!["true".into(), "false".into()],
        Kind::Choice(choices) => choices.iter().map(|choice| choice.word.clone()).collect(),
        Kind::Number { min, max, .. } => {
            let third = Fixed::new((min.raw + max.raw) / 3, min.decimals);
            vec![min.to_string(), third.to_string(), max.to_string()]
        }
        Kind::Text { .. } => vec!["bench".into()],
        Kind::Ipv4 => vec!["10.1.2.3".into()],
    };
    let carried = |text: &String| check_write(definition, protocol, item, &item.parse(text).unwrap()).is_ok();
    texts.into_iter().filter(carried).collect()
}

/// Everything is read, is a value in range, and everything writable takes its values and gives them back.
fn every_item_is_read_and_written(open: impl Fn(&str) -> Bench, spec: &str) {
    let mut bench = open(spec);
    assert_eq!(bench.identify().unwrap().model(), bench.definition.id, "{spec}");
    let (mut read, mut written) = (0, 0);
    for item in bench.items() {
        let value = bench.read(&item.id);
        if !item.read_only {
            assert!(item.parse(&value.to_string()).is_ok(), "{spec}: {} = {value}", item.id);
        }
        if let (Kind::Number { min, max, .. }, Value::Number(number)) = (&item.kind, &value) {
            assert!((min.raw..=max.raw).contains(&number.raw), "{spec}: {} = {value}", item.id);
        }
        read += 1;
    }
    for item in bench.items().iter().filter(|item| !item.read_only && item.id != "address") {
        let mut bench = open(spec);
        bench.sim.set_init(bench.target.address, true);
        let samples = samples(&bench.definition, item, bench.target.protocol);
        assert!(!samples.is_empty(), "{spec}: {}", item.id);
        for text in samples {
            let found = bench.write(&item.id, &text).unwrap_or_else(|error| panic!("{spec}: {error}"));
            assert_eq!(found.to_string(), text, "{spec}: {}", item.id);
            assert_eq!(bench.holds(&item.id), text, "{spec}: {}", item.id);
            written += 1;
        }
    }
    assert!(read > 2 && written > 2, "{spec}");
}

#[test]
fn every_item_of_the_example_is_read_and_written_over_both_protocols() {
    for spec in ["dl-302@0x21:dcon:9600", "dl-302@5:dcon:19200:checksum", "dl-302@33:modbus_rtu:9600:e81"] {
        every_item_is_read_and_written(Bench::built_in, spec);
    }
}

#[test]
fn every_item_of_the_pir_definitions_is_read_and_written() {
    for spec in ["pir-234@1:dcon", "pir-234@1:modbus_rtu", "pir-130@1:dcon", "pir-130@1:modbus_rtu", "pir-230@1:dcon"] {
        every_item_is_read_and_written(Bench::built_in, spec);
    }
}

#[test]
fn every_item_of_a_users_file_is_read_and_written() {
    for spec in ["tm-1@7:dcon", "tm-1@7:dcon:checksum", "tm-1@7:modbus_rtu:115200"] {
        every_item_is_read_and_written(Bench::small, spec);
    }
}

#[test]
fn the_example_reads_like_a_room() {
    for spec in ["dl-302@2:dcon", "dl-302@2:modbus_rtu"] {
        let mut bench = Bench::built_in(spec);
        let mut seen = std::collections::HashSet::new();
        for _ in 0..20 {
            let celsius = bench.read("temperature_c").as_f64().unwrap();
            let fahrenheit = bench.read("temperature_f").as_f64().unwrap();
            assert!((18.0..26.0).contains(&celsius), "{celsius}");
            assert!((celsius * 1.8 + 32.0 - fahrenheit).abs() < 0.1, "{celsius} {fahrenheit}");
            assert!((30.0..60.0).contains(&bench.read("humidity").as_f64().unwrap()));
            assert!((400.0..900.0).contains(&bench.read("co2").as_f64().unwrap()));
            seen.insert(celsius.to_string());
            bench.sim.advance(Duration::from_secs(11));
        }
        assert!(seen.len() > 10, "{seen:?}");
    }
}

#[test]
fn a_live_contact_opens_and_closes_by_itself() {
    let mut bench = Bench::small("tm-1@7");
    let mut closed = 0;
    for _ in 0..200 {
        closed += u32::from(bench.read("contact") == Value::Bool(true));
        bench.sim.advance(Duration::from_secs(10));
    }
    assert!((5..60).contains(&closed), "{closed}");
}

#[test]
fn a_test_can_say_what_the_module_shows() {
    let mut bench = Bench::built_in("dl-302@2:dcon");
    assert!(bench.sim.set_value(2, "co2", "1234"));
    bench.sim.advance(Duration::from_secs(500));
    assert_eq!(bench.read("co2").to_string(), "1234");
    assert!(!bench.sim.set_value(2, "co2", "10000"), "beyond the range");
    assert!(!bench.sim.set_value(2, "no_such", "1"));
    assert!(!bench.sim.set_value(3, "co2", "1"), "nobody is there");
}

#[test]
fn settings_of_init_mode_are_refused_without_it_and_in_force_after_a_power_cycle() {
    for spec in ["dl-302@2:dcon", "dl-302@2:modbus_rtu"] {
        let mut bench = Bench::built_in(spec);
        let refused = bench.write("baud_rate", "19200").unwrap_err().to_string();
        assert!(refused.contains("INIT"), "{refused}");
        assert_eq!(bench.holds("baud_rate"), "9600");
        bench.sim.set_init(2, true);
        assert!(bench.write("baud_rate", "19200").is_ok());
        assert!(bench.identify().is_ok(), "still at the old speed");
        bench.sim.power_cycle(2);
        assert_eq!(bench.identify().map(|_| ()), Err(Failure::Silent));
        bench.target.settings = LineSettings { baud_rate: "19200".parse().unwrap(), ..bench.target.settings };
        assert_eq!(bench.identify().unwrap().model(), "dl-302");
    }
}

#[test]
fn a_new_address_is_in_force_at_once() {
    for spec in ["dl-302@2:dcon:checksum", "dl-302@2:modbus_rtu"] {
        let mut bench = Bench::built_in(spec);
        assert_eq!(bench.write("address", "0x2A").unwrap().to_string(), "42", "{spec}");
        assert_eq!(bench.identify().map(|_| ()), Err(Failure::Silent), "{spec}");
        bench.target.address = 0x2A;
        assert_eq!(bench.identify().unwrap().model(), "dl-302", "{spec}");
    }
}

#[test]
fn actions_are_done() {
    let mut bench = Bench::built_in("dl-302@2:dcon");
    let action = bench.definition.action("clear_high_latch").unwrap().clone();
    let mut speaker = bench.dialogue.with(bench.target, Patience::CONVERSATION);
    assert_eq!(run_action(&action, Protocol::Dcon, 2, &mut speaker), Ok(()));
    let mut bench = Bench::built_in("pir-234@2");
    for action in bench.definition.actions.clone().iter().filter(|action| action.is_offered(Protocol::ModbusRtu)) {
        let mut speaker = bench.dialogue.with(bench.target, Patience::CONVERSATION);
        assert_eq!(run_action(action, Protocol::ModbusRtu, 2, &mut speaker), Ok(()), "{}", action.id);
    }
}

#[test]
fn the_reset_status_is_told_once() {
    let mut bench = Bench::built_in("dl-302@2:dcon");
    assert_eq!([bench.read("reset_status"), bench.read("reset_status")], [Value::Bool(true), Value::Bool(false)]);
    bench.sim.power_cycle(2);
    assert_eq!(bench.read("reset_status"), Value::Bool(true));
}

fn example(words: &str) -> Sim {
    let spec: MimicSpec = format!("dl-302@1:{words}").parse().unwrap();
    let definition = spec.definition(&Catalogue::built_in().0, &[]).unwrap();
    let sim = Sim::new(&[], Pace::Skip);
    sim.join(Box::new(Mimic::new(definition, spec.placing)));
    sim
}

#[test]
fn dcon_refuses_wrong_values_and_is_silent_to_what_it_does_not_know() {
    let sim = example("dcon");
    let mut line = sim.line();
    for (command, answer) in [
        ("$01M", "!01DL302"),
        ("$012", "!01000600"),
        ("$01I", "!011"),
        ("@01DO01", "!01"),
        ("@01DI", "!0100100"),
        ("@01HO+001.25", "!01"),
        ("@01HO", "!01+001.25"),
        ("@01HO+100.01", "?01"),
        ("@01BAFC", "?01"),
        ("%0101000700", "?01"),
        ("%0101000B00", "?01"),
        ("@01EAMC0", "!01"),
        ("@01RAC0", "!011"),
        ("~**", ""),
        ("$02M", ""),
        ("$01Z", ""),
        ("@01BAXY", ""),
        ("@01HO1", ""),
        ("$0", ""),
        ("", ""),
    ] {
        assert_eq!(ask(&mut line, command), answer, "{command}");
    }
    assert_eq!(sim.setting(1, "humidity_offset").as_deref(), Some("1.25"));
    assert_eq!(sim.setting(1, "baud_rate").as_deref(), Some("9600"));
}

#[test]
fn with_checksum_only_the_right_sum_is_heard() {
    let mut line = example("dcon:checksum").line();
    assert_eq!(ask(&mut line, "$01MD2"), "!01DL302A7");
    assert_eq!(ask(&mut line, "$01MD3"), "");
    assert_eq!(ask(&mut line, "$01M"), "");
}

#[test]
fn modbus_says_what_it_does_not_have_and_what_is_out_of_range() {
    let sim = example("modbus_rtu");
    let mut line = sim.line();
    let mut said = |pdu: &[u8]| {
        let answer = exchange(&mut line, &modbus::with_crc(&[&[1], pdu].concat()));
        assert!(answer.is_empty() || modbus::with_crc(&answer[..answer.len() - 2]) == answer);
        answer.get(1..answer.len().saturating_sub(2)).unwrap_or_default().to_vec()
    };
    for (asked, answer) in [
        (&[3, 0x01, 0xE0, 0, 4][..], &[3, 8, 1, 0, 0, 0, 3, 2, 0x44, 0x4C][..]),
        (&[3, 0x01, 0xE4, 0, 2], &[3, 4, 0, 1, 0, 6]),
        (&[3, 0, 6, 0, 1], &[0x83, 2]),
        (&[3, 0, 5, 0, 2], &[0x83, 2]),
        (&[3, 0, 0, 0, 0], &[0x83, 3]),
        (&[3, 0, 0], &[0x83, 3]),
        (&[3, 0xFF, 0xFF, 0, 1], &[0x83, 2]),
        (&[1, 1, 0, 0, 1], &[1, 1, 1]),
        (&[2, 1, 0, 0, 1], &[2, 1, 1]),
        (&[5, 1, 0, 0, 0], &[0x85, 3]),
        (&[5, 1, 0, 0x12, 0x34], &[0x85, 3]),
        (&[6, 0, 0, 0, 1], &[0x86, 2]),
        (&[6, 0x01, 0xE7, 0, 31], &[0x86, 3]),
        (&[6, 0x01, 0xE7, 0, 30], &[6, 0x01, 0xE7, 0, 30]),
        (&[16, 0x01, 0xC1, 0, 2, 4, 0xFF, 0x83, 0, 125], &[16, 0x01, 0xC1, 0, 2]),
        (&[16, 0x01, 0xC1, 0, 2, 4, 0, 1, 0x7F, 0xFF], &[0x90, 3]),
        (&[16, 0x01, 0xC1, 0, 2, 3, 0, 1, 0], &[0x90, 3]),
        (&[0x0F, 1, 0, 0, 1, 1, 1], &[0x0F, 1, 0, 0, 1]),
        (&[0x46, 0], &[0xC6, 1]),
        (&[8, 0, 0], &[0x88, 1]),
    ] {
        assert_eq!(said(asked), answer, "{asked:02X?}");
    }
    assert_eq!(sim.setting(1, "humidity_offset").as_deref(), Some("-1.25"), "the refused write changed nothing");
    assert_eq!(sim.setting(1, "temperature_offset").as_deref(), Some("1.25"));
    assert!(exchange(&mut sim.line(), &[1, 3, 0, 0, 0, 1, 0, 0]).is_empty(), "a wrong CRC is not heard");
    assert!(exchange(&mut sim.line(), &modbus::with_crc(&[0, 6, 0x01, 0xE7, 0, 7])).is_empty());
    assert_eq!(sim.setting(1, "response_delay").as_deref(), Some("7"), "a broadcast is obeyed");
}

#[test]
fn input_registers_are_read_by_function_4_only() {
    let bench = Bench::small("tm-1@1");
    let mut line = bench.sim.line();
    assert_eq!(exchange(&mut line, &modbus::with_crc(&[1, 3, 0, 0, 0, 1])).get(1..3), Some(&[0x83, 2][..]));
    assert_eq!(exchange(&mut line, &modbus::with_crc(&[1, 4, 0, 0, 0, 1])).get(1..3), Some(&[4, 2][..]));
}

#[test]
fn guests_share_the_line_with_the_modules_of_the_simulator() {
    let specs: Vec<ModuleSpec> = ["pir-234@1", "pir-130@2:dcon"].iter().map(|spec| spec.parse().unwrap()).collect();
    let sim = Sim::new(&specs, Pace::Skip);
    let (catalogue, _) = Catalogue::built_in();
    let spec: MimicSpec = "dl-302@3:dcon".parse().unwrap();
    sim.join(Box::new(Mimic::new(spec.definition(&catalogue, &[]).unwrap(), spec.placing)));
    let mut line = sim.line();
    assert_eq!(ask(&mut line, "$02M"), "!02PIR130");
    assert_eq!(ask(&mut line, "$03M"), "!03DL302");
    assert_eq!(sim.setting(1, "name").as_deref(), Some("PIR234"));
    assert!(!sim.set_value(1, "name", "x"), "only guests");
    sim.set_dead(3, true);
    assert_eq!(ask(&mut line, "$03M"), "");
}

#[test]
fn the_example_loads_from_a_users_folder_too() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("dl-302.toml");
    std::fs::write(&path, include_str!("../assets/modules/dl-302.toml")).unwrap();
    let (catalogue, errors) = Catalogue::with_folder(folder.path());
    assert_eq!(errors, []);
    assert_eq!(catalogue.get("dl-302"), Catalogue::built_in().0.get("dl-302"));
    assert_eq!(load_file(&path).ok(), catalogue.get("dl-302"));
    std::fs::write(&path, SMALL.replace("[-40, 120]", "[120, -40]")).unwrap();
    let error = load_file(&path).unwrap_err();
    assert!(error.line.is_some() && error.reason.contains("range"), "{error}");
}

#[test]
fn what_needs_init_says_so_in_the_example() {
    let definition = Catalogue::built_in().0.get("dl-302").unwrap();
    let init: Vec<&str> =
        definition.items.iter().filter(|item| item.applies == Applies::Init).map(|item| item.id.as_str()).collect();
    assert_eq!(init, ["baud_rate", "data_format", "checksum", "protocol"]);
    assert!(definition.items.iter().all(|item| !item.source.is_empty()));
}

fn any_mimic() -> impl Strategy<Value = Mimic> {
    let models = prop::sample::select(vec!["dl-302", "pir-130", "pir-234"]);
    let places = prop::sample::select(vec!["1:dcon", "1:dcon:checksum:init", "1:modbus_rtu", "1:modbus_rtu:init"]);
    (models, places).prop_map(|(model, place)| {
        let spec: MimicSpec = format!("{model}@{place}").parse().unwrap();
        Mimic::new(spec.definition(&Catalogue::built_in().0, &[]).unwrap(), spec.placing)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn no_frame_makes_a_module_panic(
        mut mimic in any_mimic(),
        frames in prop::collection::vec(any::<Vec<u8>>(), 1..8),
        pdus in prop::collection::vec((prop::sample::select(vec![1u8, 2, 3, 4, 5, 6, 15, 16, 0x46]), any::<[u8; 6]>(), any::<Vec<u8>>()), 1..20),
        texts in prop::collection::vec("[$#%@~][0]1[0-9A-Z+.()-]{0,12}", 1..20),
        with_sum: bool,
        seconds: u64,
    ) {
        mimic.live(Duration::from_secs(seconds));
        for frame in frames {
            mimic.hear(&frame);
        }
        for (function, head, rest) in pdus {
            mimic.hear(&modbus::with_crc(&[&[1, function], head.as_slice(), rest.as_slice()].concat()));
            mimic.hear(&modbus::with_crc(&[&[1, function, 0x01], &head[..1], &[0], &head[1..2]].concat()));
        }
        for text in texts {
            mimic.hear(&dcon_bench::protocol::dcon::encode(&text, with_sum));
        }
        mimic.power_cycle();
        prop_assert!(mimic.value("name").is_some());
    }
}
