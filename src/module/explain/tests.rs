use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::module::{Catalogue, ItemKind, Template};
use crate::protocol::{dcon, hex, modbus};

fn definition(id: &str) -> Arc<Definition> {
    Catalogue::built_in().0.get(id).expect("a built-in definition")
}

/// What a DCON exchange means to a module of this model: request and answer, without carriage return.
fn dcon_meaning(id: &str, command: &str, answer: &str) -> (String, String) {
    let definition = definition(id);
    let (command, answer) = (format!("{command}\r"), format!("{answer}\r"));
    let asked = explain(Some(&definition), Protocol::Dcon, false, command.as_bytes(), None);
    let said = explain(Some(&definition), Protocol::Dcon, false, command.as_bytes(), Some(answer.as_bytes()));
    (asked.summary, said.summary)
}

fn rtu_meaning(definition: Option<&Definition>, request: &str, answer: &str) -> (String, String) {
    let (request, answer) = (hex::parse(request).unwrap(), hex::parse(answer).unwrap());
    let asked = explain(definition, Protocol::ModbusRtu, false, &request, None);
    let said = explain(definition, Protocol::ModbusRtu, false, &request, Some(&answer));
    (asked.summary, said.summary)
}

fn row(explanation: &Explanation, name: &str) -> (String, String) {
    let field = explanation.fields.iter().find(|field| field.name == name);
    let field = field.unwrap_or_else(|| panic!("no field {name} in {explanation:?}"));
    (field.raw.clone(), field.meaning.clone())
}

#[test]
fn dcon_examples_of_the_pir_234_manual_are_explained() {
    let read_configuration = "Read address, baud rate, data format and checksum";
    let examples = [
        ("$012", "!01400600", read_configuration, "baud_rate 9600 bps, data_format n81, checksum false"),
        ("$012", "!0101400600", read_configuration, "address 1, baud_rate 9600 bps, data_format n81, checksum false"),
        (
            "%0102400A40",
            "!02",
            "Set address, baud rate, data format and checksum: address 2, baud_rate 115200 bps, data_format n81, checksum true",
            "Confirmed: Set address, baud rate, data format and checksum",
        ),
        (
            "#01",
            ">+030.00+086.00+050.00",
            "Read all analog inputs",
            "temperature_c 30.00 °C, temperature_f 86.00 °F, humidity 50.00 %",
        ),
        ("#010", ">-004.25", "Read the temperature in °C", "temperature_c -4.25 °C"),
        ("$01M", "!01PIR234E", "Read the name of the module", "name PIR234E"),
        (
            "@01DI",
            "!0100100",
            "Read alarm mode, outputs and PIR status",
            "alarm_mode disabled, do0 true, do1 false, pir false",
        ),
        ("@01DO03", "!01", "Set the outputs: do0 true, do1 true", "Confirmed: Set the outputs"),
        ("$01LC7C00A", "!01", "Set the PIR output ON time: pir_on_time 393 s", "Confirmed: Set the PIR output ON time"),
        ("@01EAL", "!01", "Alarm mode: alarm_mode latched", "Confirmed: Alarm mode"),
        (
            "@01HI+086.00",
            "?01",
            "Set the high temperature alarm limit: alarm_limit 86.00 °C",
            "Refused: the module understood the command and did not carry it out",
        ),
        (
            "~0131FF",
            "!",
            "Set the host watchdog's enable state and timeout: wdt_enabled true, wdt_timeout 25.5 s",
            "Ignored: the host watchdog of the module has tripped",
        ),
        ("$01XY", "!01ABC", "Unknown command $01XY", "Answer !01ABC"),
        ("$01M", "!", "Read the name of the module", "Ignored: the host watchdog of the module has tripped"),
        ("$012", "!0140", read_configuration, "An answer of no known shape: !0140"),
    ];
    for (command, answer, asked, said) in examples {
        assert_eq!(dcon_meaning("pir-234", command, answer), (asked.to_owned(), said.to_owned()), "{command}");
    }
}

#[test]
fn dcon_examples_of_the_pir_130_manual_are_explained() {
    let examples = [
        ("$026", "!010000", "Read the relay output", "relay true"),
        (
            "@02DI",
            ">0200101",
            "Read alarm mode, relay output and PIR status",
            "alarm_mode disabled, relay true, pir false",
        ),
        ("$02LC6C0", "!0201", "Read the luminance level", "lux_level 100 lux"),
        ("$02LC6C0", ">020", "Read the luminance level", "lux_level disabled"),
        ("@02CHC0", "!02", "Clear alarm", "Confirmed: Clear alarm"),
        ("~02RD1E", "!02", "Set the response delay: response_delay 30 ms", "Confirmed: Set the response delay"),
    ];
    for (command, answer, asked, said) in examples {
        assert_eq!(dcon_meaning("pir-130", command, answer), (asked.to_owned(), said.to_owned()), "{command}");
    }
}

#[test]
fn published_modbus_exchanges_are_explained() {
    let (pir_130, pir_234) = (definition("pir-130"), definition("pir-234"));
    let examples: [(Option<&Definition>, &str, &str, &str, &str); 7] = [
        (
            Some(&pir_234),
            "01 04 00 00 00 05 30 09",
            "01 04 0A 0B B8 21 98 13 88 06 40 0F 28 CE 8C",
            "Read registers 1-5 (wire 0-4): temperature_c, temperature_f, humidity, dew_point_c, dew_point_f",
            "temperature_c 30.00 °C, temperature_f 86.00 °F, humidity 50.00 %, dew_point_c 16.00 °C, dew_point_f 38.80 °F",
        ),
        (
            None,
            "01 04 00 00 00 05 30 09",
            "01 84 02 C2 C1",
            "Read registers 1-5 (wire 0-4)",
            "Exception 2: illegal data address: the module has no such register or coil",
        ),
        (Some(&pir_234), "01 01 00 00 00 02 BD CB", "", "Read coils 1-2 (wire 0-1): do0, do1", "No answer"),
        (
            Some(&pir_130),
            "01 05 00 00 FF 00 8C 3A",
            "01 05 00 00 FF 00 8C 3A",
            "Write coil 1 (wire 0): relay true",
            "Confirmed: coil 1 (wire 0): relay true",
        ),
        (
            None,
            "01 06 02 00 00 0A 08 75",
            "01 06 02 00 00 0A 08 75",
            "Write register 513 (wire 512) 0x000A",
            "Confirmed: register 513 (wire 512) 0x000A",
        ),
        (
            Some(&pir_130),
            "01 46 00 12 60",
            "01 46 00 54 20 26 00 0E FC",
            "Read the name of the module (function 0x46, sub-function 00)",
            "name 54 20 26 00",
        ),
        (
            Some(&pir_130),
            "01 46 20 13 B8",
            "01 C6 02 F2 61",
            "Read the firmware version (function 0x46, sub-function 20h)",
            "Exception 2: illegal data address: the module has no such register or coil",
        ),
    ];
    for (definition, request, answer, asked, said) in examples {
        assert_eq!(rtu_meaning(definition, request, answer), (asked.to_owned(), said.to_owned()), "{request}");
    }
}

#[test]
fn the_stored_settings_of_function_46_are_named() {
    let definition = definition("pir-130");
    let request = hex::spaced(&modbus::with_crc(&[1, 0x46, 5, 0]));
    let (asked, said) = rtu_meaning(Some(&definition), &request, "01 46 05 00 06 00 00 00 01 00 00 E8 43");
    assert!(asked.starts_with("Read baud rate and protocol"), "{asked}");
    assert_eq!(said, "baud_rate 9600 bps, protocol modbus_rtu");
}

#[test]
fn the_parts_of_a_frame_stand_in_their_order_with_their_raw_text() {
    let definition = definition("pir-234");
    let answer = Some(&b"!01400600AC\r"[..]);
    let explained = explain(Some(&definition), Protocol::Dcon, true, b"$012B7\r", answer);
    let names: Vec<_> = explained.fields.iter().map(|field| field.name.as_str()).collect();
    assert_eq!(names, ["delimiter", "AA", "TT", "CC", "FF", "checksum"]);
    assert_eq!(row(&explained, "CC"), ("06".into(), "baud_rate 9600 bps, data_format n81".into()));
    assert_eq!(row(&explained, "checksum"), ("AC".into(), "right".into()));
}

#[test]
fn several_items_of_one_register_stand_in_one_row() {
    let definition = definition("pir-234");
    let request = modbus::with_crc(&[1, 3, 1, 0xE4, 0, 3]);
    let asked = explain(Some(&definition), Protocol::ModbusRtu, false, &request, None);
    assert_eq!(row(&asked, "register 486 (wire 485)").1, "baud_rate, data_format");
    let answer = modbus::with_crc(&[1, 3, 6, 0, 1, 0, 6, 0, 1]);
    let said = explain(Some(&definition), Protocol::ModbusRtu, false, &request, Some(&answer));
    let place = row(&said, "register 486 (wire 485)");
    assert_eq!(place, ("0x0006".into(), "baud_rate 9600 bps, data_format n81".into()));
    assert_eq!(row(&said, "register 487 (wire 486)"), ("0x0001".into(), String::new()));
}

#[test]
fn a_frame_over_tcp_is_explained_with_its_header() {
    let definition = definition("pir-234");
    let request = hex::parse("00 07 00 00 00 06 01 04 00 00 00 01").unwrap();
    let answer = hex::parse("00 07 00 00 00 05 01 04 02 F6 3C").unwrap();
    let said = explain(Some(&definition), Protocol::ModbusTcp, false, &request, Some(&answer));
    assert_eq!(said.summary, "temperature_c -25.00 °C");
    assert_eq!(row(&said, "transaction"), ("00 07".into(), "7".into()));
    let short = explain(Some(&definition), Protocol::ModbusTcp, false, &request, Some(&answer[..10]));
    assert!(short.summary.contains("wrong length"), "{}", short.summary);
}

#[test]
fn what_is_broken_is_said_to_be_broken() {
    let request = modbus::with_crc(&[1, 3, 0, 0, 0, 1]);
    let mut answer = modbus::with_crc(&[1, 3, 2, 0, 7]);
    answer[4] = 8;
    let said = explain(None, Protocol::ModbusRtu, false, &request, Some(&answer));
    assert!(said.summary.contains("wrong CRC"), "{}", said.summary);
    assert!(row(&said, "CRC").1.starts_with("wrong"), "{said:?}");
    let said = explain(None, Protocol::Dcon, true, b"$01MD2\r", Some(b"!01PIR2344C\r"));
    assert!(said.summary.starts_with("Wrong checksum: 4C was received"), "{}", said.summary);
}

#[test]
fn echo_and_stray_bytes_around_an_answer_are_looked_past() {
    let definition = definition("pir-234");
    let echoed = explain(Some(&definition), Protocol::Dcon, false, b"$01M\r", Some(b"$01M\r\x00!01PIR234\r\xFF"));
    assert_eq!(echoed.summary, "name PIR234");
    let request = modbus::with_crc(&[1, 4, 0, 0, 0, 1]);
    let noisy = [&request[..], &[0], &modbus::with_crc(&[1, 4, 2, 0, 100]), &[0xFF]].concat();
    let said = explain(Some(&definition), Protocol::ModbusRtu, false, &request, Some(&noisy));
    assert_eq!(said.summary, "temperature_c 1.00 °C");
    let alone = explain(Some(&definition), Protocol::ModbusRtu, false, &request, Some(&request));
    assert_eq!(alone.summary, "No answer, only the echo");
}

/// A text with the shape of `template`, its fields filled with what they may hold.
fn sample(command: &crate::module::Command, template: &Template) -> String {
    let mut fields = std::collections::BTreeMap::new();
    for name in template.field_names() {
        let text = match command.fields.get(name) {
            Some(crate::module::Field::Decimal) => "+001.00".to_owned(),
            Some(crate::module::Field::Text) => "M".repeat(template.width(name).unwrap_or(4)),
            _ => "0".repeat(template.width(name).unwrap_or(2)),
        };
        fields.insert(name.to_owned(), text);
    }
    template.fill(1, &fields).expect("a filled template")
}

fn danger_of(definition: &Definition, command: &crate::module::Command, template: &Template) -> Option<Danger> {
    let text = sample(command, template);
    match command.function {
        None => danger(Some(definition), Protocol::Dcon, true, &dcon::encode(&text, true)),
        Some(function) => {
            let bytes = [&[1, function][..], &hex::parse(&text).unwrap()].concat();
            danger(Some(definition), Protocol::ModbusRtu, false, &modbus::with_crc(&bytes))
        }
    }
}

#[test]
fn every_write_of_the_built_in_definitions_is_told_to_change_the_module_and_no_read_is() {
    let (mut reads, mut writes) = (0, 0);
    for id in ["pir-130", "pir-230", "pir-234"] {
        let definition = definition(id);
        for command in &definition.commands {
            if let Some(read) = &command.read {
                reads += 1;
                assert_eq!(danger_of(&definition, command, read), None, "{id} {}", read.source());
            }
            if let Some(write) = &command.write {
                writes += 1;
                let danger = danger_of(&definition, command, write);
                match danger {
                    Some(Danger::Broadcast { .. }) => assert_eq!(write.source(), "~**"),
                    Some(Danger::Writes { .. }) => {}
                    other => panic!("{id} {}: {other:?}", write.source()),
                }
            }
        }
    }
    assert!(reads > 60 && writes > 40, "{reads} reads, {writes} writes");
}

#[test]
fn every_register_and_coil_that_can_be_written_is_named_before_it_is_written() {
    let definition = definition("pir-234");
    let rtu = |bytes: &[u8]| danger(Some(&definition), Protocol::ModbusRtu, false, &modbus::with_crc(bytes));
    let words = |danger: Option<Danger>| danger.map(|danger| danger.to_string()).unwrap_or_default();
    assert_eq!(
        words(rtu(&[1, 6, 1, 0xE5, 0, 6])),
        "Changes the module: Baud rate, Data format, register 486 (wire 485)"
    );
    assert_eq!(words(rtu(&[1, 5, 1, 0x30, 0xFF, 0])), "Changes the module: Clear alarm, coil 305 (wire 304)");
    assert_eq!(words(rtu(&[1, 6, 0, 0xFF, 0, 0])), "Changes the module: register 256 (wire 255)");
    assert_eq!(rtu(&[1, 3, 0, 0, 0, 1]), None);
    for item in definition.items.iter().filter(|item| !item.read_only && item.item_kind == ItemKind::Parameter) {
        for access in &item.accesses {
            let crate::module::Access::Modbus(access) = access else { continue };
            let crate::module::ModbusPlace::Holding { first, count: 1 } = access.place else { continue };
            let [high, low] = (first - 1).to_be_bytes();
            let protocol = if access.over_rtu { Protocol::ModbusRtu } else { Protocol::ModbusTcp };
            let frame = match protocol {
                Protocol::ModbusTcp => vec![0, 1, 0, 0, 0, 6, 1, 6, high, low, 0, 0],
                _ => modbus::with_crc(&[1, 6, high, low, 0, 0]),
            };
            let danger = danger(Some(&definition), protocol, false, &frame);
            let words = danger.map(|danger| danger.to_string()).unwrap_or_default();
            assert!(words.contains(&item.label), "{}: {words}", item.id);
        }
    }
}

#[test]
fn broadcasts_and_what_nobody_knows_are_told_apart() {
    let definition = definition("pir-234");
    let dcon = |definition: Option<&Definition>, text: &str| {
        danger(definition, Protocol::Dcon, false, text.as_bytes()).map(|danger| danger.to_string()).unwrap_or_default()
    };
    assert_eq!(dcon(Some(&definition), "~**\r"), "Heard by every module on the line: Send Host OK");
    assert_eq!(dcon(None, "#**"), "Heard by every module on the line");
    assert!(dcon(Some(&definition), "$01XY").starts_with("May change the module"));
    assert!(dcon(None, "$01LC3C00000").starts_with("May change the module"));
    assert_eq!(dcon(None, "$01M"), "");
    let to_all = modbus::with_crc(&[0, 6, 1, 0xE5, 0, 6]);
    let danger = danger(Some(&definition), Protocol::ModbusRtu, false, &to_all);
    assert!(matches!(&danger, Some(Danger::Broadcast { what }) if what.contains("baud_rate 9600 bps")), "{danger:?}");
}

#[test]
fn requests_are_explained_with_their_danger_and_answers_without() {
    let definition = definition("pir-130");
    let asked = explain(Some(&definition), Protocol::Dcon, false, b"$02LC3C00BB8\r", None);
    assert!(matches!(asked.danger, Some(Danger::Writes { .. })), "{asked:?}");
    let said = explain(Some(&definition), Protocol::Dcon, false, b"$02LC3C00BB8\r", Some(b"!02\r"));
    assert_eq!(said.danger, None);
}

fn near_frames() -> impl Strategy<Value = Vec<u8>> {
    let text = "[$#%@~!>?][0-9A-F*]{0,2}[0-9A-Z+.-]{0,12}\r?".prop_map(String::into_bytes);
    let rtu = (0u8..3, prop_oneof![0u8..0x12, Just(0x46), any::<u8>()], prop::collection::vec(any::<u8>(), 0..24))
        .prop_map(|(unit, function, data)| modbus::with_crc(&[vec![unit, function], data].concat()));
    prop_oneof![any::<Vec<u8>>(), text, rtu]
}

proptest! {
    #[test]
    fn no_bytes_make_the_explanation_panic(
        request in near_frames(),
        answer in prop::option::of(near_frames()),
        checksum: bool,
        known in prop::option::of(prop_oneof![Just("pir-130"), Just("pir-234")]),
    ) {
        let catalogue = Catalogue::built_in().0;
        let definition = known.and_then(|id| catalogue.get(id));
        for protocol in Protocol::ALL {
            let explained = explain(definition.as_deref(), protocol, checksum, &request, answer.as_deref());
            prop_assert!(!explained.summary.is_empty());
            let _ = danger(definition.as_deref(), protocol, checksum, &request);
        }
    }
}
