//! What simulated modules do as time passes, settings change and the power goes.

mod common;

use std::time::Duration;

use dcon_bench::bus::line::Line;
use dcon_bench::sim::{Pace, Sim, SimLine};

use common::{ask, exchange};

fn world(specs: &[&str]) -> (Sim, SimLine) {
    let specs: Vec<_> = specs.iter().map(|spec| spec.parse().unwrap()).collect();
    let sim = Sim::new(&specs, Pace::Skip);
    let line = sim.line();
    (sim, line)
}

fn with_crc(content: &[u8]) -> Vec<u8> {
    let mut crc = 0xFFFF_u16;
    for byte in content {
        crc ^= u16::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xA001 } else { crc >> 1 };
        }
    }
    [content, &crc.to_le_bytes()].concat()
}

/// A Modbus exchange without the checks; an empty answer is silence.
fn modbus(line: &mut SimLine, request: &[u8]) -> Vec<u8> {
    let answer = exchange(line, &with_crc(request));
    let content = answer.get(..answer.len().saturating_sub(2)).unwrap_or_default().to_vec();
    assert!(answer.is_empty() || answer == with_crc(&content), "{answer:02X?}");
    content
}

fn write_register(line: &mut SimLine, unit: u8, number: u16, value: u16) -> Vec<u8> {
    modbus(line, &[&[unit, 6], (number - 1).to_be_bytes().as_slice(), &value.to_be_bytes()].concat())
}

fn write_coil(line: &mut SimLine, unit: u8, number: u16, on: bool) -> Vec<u8> {
    modbus(line, &[&[unit, 5], (number - 1).to_be_bytes().as_slice(), &[if on { 0xFF } else { 0 }, 0]].concat())
}

/// One register by function 3: the value or the exception.
fn register(line: &mut SimLine, unit: u8, number: u16) -> Result<u16, u8> {
    match modbus(line, &[&[unit, 3], (number - 1).to_be_bytes().as_slice(), &[0, 1]].concat())[..] {
        [_, 3, 2, high, low] => Ok(u16::from_be_bytes([high, low])),
        [_, 0x83, exception] => Err(exception),
        ref other => panic!("{other:02X?}"),
    }
}

/// One coil by function 1: the value or the exception.
fn coil(line: &mut SimLine, unit: u8, number: u16) -> Result<bool, u8> {
    match modbus(line, &[&[unit, 1], (number - 1).to_be_bytes().as_slice(), &[0, 1]].concat())[..] {
        [_, 1, 1, bits] => Ok(bits == 1),
        [_, 0x81, exception] => Err(exception),
        ref other => panic!("{other:02X?}"),
    }
}

#[track_caller]
fn expect(sim: &Sim, address: u8, settings: &[(&str, &str)]) {
    for (name, value) in settings {
        assert_eq!(sim.setting(address, name).as_deref(), Some(*value), "{name}");
    }
}

fn seconds(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

#[test]
fn the_relay_holds_for_the_on_time_after_the_last_motion() {
    let (sim, mut line) = world(&["pir-234@1:dcon"]);
    sim.set_motion(1, 3, true);
    assert_eq!(ask(&mut line, "$01LC7C007"), "!01");
    expect(&sim, 1, &[("pir_on_time", "66"), ("pir", "true"), ("pir3", "true"), ("pir1", "false"), ("do0", "true")]);
    sim.advance(seconds(300));
    expect(&sim, 1, &[("do0", "true"), ("do1", "true")]);
    sim.set_motion(1, 3, false);
    sim.advance(seconds(65));
    expect(&sim, 1, &[("pir", "false"), ("do0", "true")]);
    sim.advance(seconds(2));
    expect(&sim, 1, &[("do0", "false"), ("do1", "false")]);
}

#[test]
fn a_disabled_sensor_sees_nothing() {
    let (sim, mut line) = world(&["pir-234@1:dcon"]);
    sim.set_motion(1, 2, true);
    assert_eq!(ask(&mut line, "$0150D"), "!01");
    expect(&sim, 1, &[("pir2_enabled", "false"), ("pir1_enabled", "true"), ("pir2", "false"), ("pir", "false")]);
    assert_eq!(ask(&mut line, "$0150F"), "!01");
    expect(&sim, 1, &[("pir2", "true"), ("pir", "true")]);
}

#[test]
fn after_power_on_sensors_are_blind_for_the_off_time() {
    let (sim, _line) = world(&["pir-234@1:dcon"]);
    sim.set_motion(1, 1, true);
    expect(&sim, 1, &[("pir_off_time_on_start", "6"), ("pir", "true")]);
    sim.power_cycle(1);
    expect(&sim, 1, &[("pir", "false"), ("do0", "false")]);
    sim.advance(seconds(7));
    expect(&sim, 1, &[("pir", "true"), ("do0", "true")]);
}

#[test]
fn an_output_can_follow_the_temperature_alarm() {
    let (sim, mut line) = world(&["pir-234@1:dcon"]);
    sim.set_motion(1, 0, false);
    sim.set_temperature(1, 20.0);
    for command in ["@01HI+030.00", "@01EAL", "$01LC9C012"] {
        assert_eq!(ask(&mut line, command), "!01");
    }
    expect(&sim, 1, &[("do0_source", "pir"), ("do1_source", "temperature"), ("alarm_mode", "latched")]);
    sim.set_temperature(1, 31.0);
    expect(&sim, 1, &[("do0", "false"), ("do1", "true"), ("alarm_active", "true")]);
    assert_eq!(ask(&mut line, "@01RAO"), "!010100");
    sim.set_temperature(1, 20.0);
    assert_eq!(ask(&mut line, "@01DI"), "!0120200");
    assert_eq!(ask(&mut line, "@01CHC0"), "!01");
    expect(&sim, 1, &[("do1", "false"), ("alarm_active", "false")]);
}

#[test]
fn a_linked_output_may_be_named_with_its_present_state() {
    let (sim, mut line) = world(&["pir-234@1:dcon"]);
    sim.set_motion(1, 1, true);
    // DO0 by command, DO1 by the PIR.
    assert_eq!(ask(&mut line, "$01LC9C008"), "!01");
    for (command, answer, first) in [
        ("@01DO02", "!01", "false"),
        ("@01DO03", "!01", "true"),
        ("@01DO00", "?01", "true"),
        ("@01DO01", "?01", "true"),
    ] {
        assert_eq!(ask(&mut line, command), answer, "{command}");
        expect(&sim, 1, &[("do0", first), ("do1", "true")]);
    }
}

#[test]
fn the_host_watchdog_trips_and_holds_the_safe_values_until_cleared() {
    let (sim, mut line) = world(&["pir-234@1:dcon"]);
    for command in ["$01LC9C000", "~0150102", "@01DO01", "~01310A"] {
        assert_eq!(ask(&mut line, command), "!01", "{command}");
    }
    expect(&sim, 1, &[("wdt_enabled", "true"), ("wdt_timeout", "1.0"), ("do0", "true"), ("do1", "false")]);
    for _ in 0..5 {
        sim.advance(Duration::from_millis(500));
        assert_eq!(ask(&mut line, "~**"), "");
    }
    expect(&sim, 1, &[("wdt_tripped", "false")]);
    sim.advance(seconds(2));
    expect(&sim, 1, &[("wdt_tripped", "true"), ("wdt_timeout_count", "1"), ("do0", "false"), ("do1", "true")]);
    assert_eq!(ask(&mut line, "~010"), "!0104");
    assert_eq!(ask(&mut line, "@01DO01"), "!");
    sim.power_cycle(1);
    expect(&sim, 1, &[("wdt_tripped", "true"), ("do0", "false"), ("do1", "true")]);
    assert_eq!(ask(&mut line, "~011"), "!01");
    assert_eq!(ask(&mut line, "@01DO01"), "!01");
    expect(&sim, 1, &[("wdt_tripped", "false"), ("do0", "true"), ("do1", "false")]);
}

#[test]
fn the_lone_exclamation_mark_has_a_checksum_where_there_are_checksums() {
    let (sim, mut line) = world(&["pir-234@1:dcon:checksum"]);
    let with_sum = |text: &str| {
        let sum = text.bytes().fold(0_u8, u8::wrapping_add);
        format!("{text}{sum:02X}")
    };
    assert_eq!(ask(&mut line, &with_sum("~013101")), with_sum("!01"));
    sim.advance(seconds(1));
    assert_eq!(ask(&mut line, &with_sum("@01DO01")), "!21");
}

#[test]
fn over_modbus_any_frame_for_the_module_feeds_the_watchdog() {
    let (sim, mut line) = world(&["pir-234@1", "pir-234@2"]);
    write_register(&mut line, 1, 521, 0);
    write_register(&mut line, 1, 489, 10);
    write_coil(&mut line, 1, 261, true);
    for _ in 0..4 {
        sim.advance(Duration::from_millis(300));
        assert_eq!(coil(&mut line, 1, 270), Ok(false));
    }
    for _ in 0..4 {
        sim.advance(Duration::from_millis(300));
        assert_eq!(coil(&mut line, 2, 270), Ok(false));
    }
    assert_eq!(coil(&mut line, 1, 270), Ok(true));
    assert_eq!(write_coil(&mut line, 1, 1, true), [1, 0x85, 4]);
    assert_eq!(register(&mut line, 1, 492), Ok(1));
    assert_eq!(write_register(&mut line, 1, 492, 1), [1, 0x86, 3]);
    write_register(&mut line, 1, 492, 0);
    assert_eq!(register(&mut line, 1, 492), Ok(0));
    write_coil(&mut line, 1, 270, true);
    assert_eq!(write_coil(&mut line, 1, 1, true)[1], 5);
    expect(&sim, 1, &[("do0", "true"), ("wdt_tripped", "false")]);
}

#[test]
fn power_on_values_come_with_the_power() {
    let (sim, mut line) = world(&["pir-234@1"]);
    for (number, on) in [(161, true), (162, false)] {
        write_coil(&mut line, 1, number, on);
    }
    for number in [521, 522] {
        write_register(&mut line, 1, number, 0);
    }
    write_coil(&mut line, 1, 1, false);
    write_coil(&mut line, 1, 2, true);
    expect(&sim, 1, &[("do0", "false"), ("do1", "true")]);
    sim.power_cycle(1);
    expect(&sim, 1, &[("do0", "true"), ("do1", "false"), ("reset_status", "true"), ("do0_power_on", "true")]);
}

#[test]
fn what_init_mode_stores_rules_after_a_power_cycle() {
    let (sim, mut line) = world(&["pir-130@1"]);
    assert_eq!(write_register(&mut line, 1, 486, 0x8A), [1, 0x86, 3]);
    assert_eq!(write_coil(&mut line, 1, 257, false), [1, 0x85, 3]);
    assert_eq!(write_register(&mut line, 1, 486, 0x06)[1], 6, "what is stored already is no change");
    sim.set_init(1, true);
    assert_eq!(write_register(&mut line, 1, 486, 0x0B), [1, 0x86, 3]);
    assert_eq!(write_register(&mut line, 1, 486, 0x8A)[1], 6);
    assert_eq!(write_coil(&mut line, 1, 257, false)[1], 5);
    expect(&sim, 1, &[("baud_rate", "115200"), ("data_format", "e81"), ("protocol", "dcon")]);
    assert_eq!(register(&mut line, 1, 486), Ok(0x8A), "still at 9600 and in Modbus");
    sim.power_cycle(1);
    assert_eq!(modbus(&mut line, &[1, 3, 1, 0xE5, 0, 1]), Vec::<u8>::new());
    let settings = dcon_bench::protocol::LineSettings {
        baud_rate: "115200".parse().unwrap(),
        data_format: "e81".parse().unwrap(),
    };
    line.configure(settings).unwrap();
    assert_eq!(ask(&mut line, "$012"), "!01408A00");
}

#[test]
fn function_46_accepts_or_refuses_speed_and_protocol_each_on_its_own() {
    let (sim, mut line) = world(&["pir-130@1"]);
    assert_eq!(modbus(&mut line, &[1, 0x46, 6, 0, 6, 0, 0, 0, 1, 0, 0]), [1, 0x46, 6, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(modbus(&mut line, &[1, 0x46, 6, 0, 7, 0, 0, 0, 1, 0, 0]), [1, 0x46, 6, 0, 1, 0, 0, 0, 0, 0, 0]);
    sim.set_init(1, true);
    assert_eq!(modbus(&mut line, &[1, 0x46, 6, 0, 7, 0, 0, 0, 2, 0, 0]), [1, 0x46, 6, 0, 0, 0, 0, 0, 1, 0, 0]);
    assert_eq!(modbus(&mut line, &[1, 0x46, 5, 0]), [1, 0x46, 5, 0, 7, 0, 0, 0, 1, 0, 0]);
    assert_eq!(modbus(&mut line, &[1, 0x46, 4, 248, 0, 0, 0]), [1, 0x46, 4, 1, 0, 0, 0]);
    assert_eq!(modbus(&mut line, &[1, 0x46, 4, 9]), [1, 0xC6, 3]);
}

#[test]
fn the_modbus_answer_to_a_new_address_comes_from_the_old_one() {
    let (sim, mut line) = world(&["pir-234@1"]);
    assert_eq!(write_register(&mut line, 1, 485, 7), [1, 6, 1, 0xE4, 0, 7]);
    assert_eq!(register(&mut line, 7, 485), Ok(7));
    assert_eq!(modbus(&mut line, &[1, 3, 0, 0, 0, 1]), Vec::<u8>::new());
    assert_eq!(write_register(&mut line, 7, 485, 248), [7, 0x86, 3]);
    expect(&sim, 7, &[("address", "7")]);
    assert_eq!(sim.setting(1, "address"), None);
}

#[test]
fn with_hardware_configuration_the_switches_rule_address_and_protocol() {
    let (sim, mut line) = world(&["pir-234@A3h:dcon:hardware:init"]);
    assert_eq!(ask(&mut line, "%A301400600"), "!A3");
    assert_eq!(ask(&mut line, "$A3P1"), "!A3");
    sim.power_cycle(0xA3);
    assert_eq!(ask(&mut line, "$A3P"), "!A311");
    expect(&sim, 0xA3, &[("address", "163"), ("protocol", "modbus_rtu")]);
}

#[test]
fn numbers_that_are_not_in_the_tables_are_illegal_addresses() {
    let (_sim, mut line) = world(&["pir-234@1", "pir-130@2", "unknown@3"]);
    for number in [6, 225, 272, 487, 491, 514, 517, 519, 550, 556, 642, 65535] {
        assert_eq!(register(&mut line, 1, number), Err(2), "PIR-234 register {number}");
    }
    for number in [1, 272, 450, 487, 489, 490, 515, 518, 521, 577] {
        assert_eq!(register(&mut line, 2, number), Err(2), "PIR-130 register {number}");
    }
    for number in [3, 32, 38, 227, 234, 280, 281, 385, 417] {
        assert_eq!(coil(&mut line, 1, number), Err(2), "PIR-234 coil {number}");
    }
    for number in [2, 33, 129, 261, 270, 278] {
        assert_eq!(coil(&mut line, 2, number), Err(2), "PIR-130 coil {number}");
    }
    assert_eq!(register(&mut line, 3, 483), Err(2));
    // Spans that touch an undefined register.
    assert_eq!(modbus(&mut line, &[1, 4, 0, 0, 0, 6]), [1, 0x84, 2]);
    assert_eq!(modbus(&mut line, &[1, 4, 0xFF, 0xFF, 0, 1]), [1, 0x84, 2]);
    // Read only.
    assert_eq!(write_register(&mut line, 1, 481, 1), [1, 0x86, 2]);
    assert_eq!(write_coil(&mut line, 1, 33, true), [1, 0x85, 2]);
    assert_eq!(write_coil(&mut line, 2, 1, true), [2, 0x85, 2]);
}

#[test]
fn bad_counts_values_and_functions_have_their_exceptions() {
    let (_sim, mut line) = world(&["pir-234@1"]);
    for (request, exception) in [
        (&[1, 3, 0, 0, 0, 0][..], [1, 0x83, 3]),
        (&[1, 3, 0, 0, 0, 126], [1, 0x83, 3]),
        (&[1, 1, 0, 0, 0x07, 0xD1], [1, 0x81, 3]),
        (&[1, 3, 0, 0, 0], [1, 0x83, 3]),
        (&[1, 3, 0, 0, 0, 1, 0], [1, 0x83, 3]),
        (&[1, 5, 0, 0, 0x12, 0x34], [1, 0x85, 3]),
        (&[1, 6, 2, 0, 0, 16], [1, 0x86, 3]),
        (&[1, 15, 0, 0, 0, 2, 2, 3, 0], [1, 0x8F, 3]),
        (&[1, 16, 2, 0, 0, 1, 2, 0], [1, 0x90, 3]),
        (&[1, 16, 2, 0, 0, 0, 0], [1, 0x90, 3]),
        (&[1, 7], [1, 0x87, 1]),
        (&[1, 23, 0], [1, 0x97, 1]),
        (&[1, 0x46, 0x20], [1, 0xC6, 1]),
        (&[1, 0xFF], [1, 0xFF, 1]),
    ] {
        assert_eq!(modbus(&mut line, request), exception, "{request:02X?}");
    }
}

#[test]
fn several_registers_and_coils_are_written_together_or_not_at_all() {
    let (sim, mut line) = world(&["pir-234@1"]);
    assert_eq!(modbus(&mut line, &[1, 16, 2, 8, 0, 2, 4, 0, 0, 0, 2]), [1, 16, 2, 8, 0, 2]);
    expect(&sim, 1, &[("do0_source", "command"), ("do1_source", "temperature")]);
    assert_eq!(modbus(&mut line, &[1, 16, 2, 8, 0, 2, 4, 0, 1, 0, 3]), [1, 0x90, 3]);
    expect(&sim, 1, &[("do0_source", "command")]);
    assert_eq!(modbus(&mut line, &[1, 15, 0, 128, 0, 2, 1, 0b11]), [1, 15, 0, 128, 0, 2]);
    expect(&sim, 1, &[("do0_safe", "true"), ("do1_safe", "true")]);
    assert_eq!(modbus(&mut line, &[1, 2, 0, 128, 0, 2]), [1, 2, 1, 0b11]);
    assert_eq!(modbus(&mut line, &[1, 15, 0, 0, 0, 2, 1, 0b01]), [1, 0x8F, 3], "DO1 follows the temperature");
    expect(&sim, 1, &[("do0", "false")]);
}

#[test]
fn a_broadcast_is_obeyed_by_all_and_answered_by_none() {
    let (sim, mut line) = world(&["pir-234@1", "pir-130@2"]);
    assert_eq!(write_register(&mut line, 0, 513, 0x0A), Vec::<u8>::new());
    assert_eq!(modbus(&mut line, &[0, 3, 2, 0, 0, 1]), Vec::<u8>::new());
    for address in [1, 2] {
        expect(&sim, address, &[("pir_on_time", "393")]);
    }
}

#[test]
fn offsets_are_signed_and_shift_what_is_measured() {
    let (sim, mut line) = world(&["pir-234@1"]);
    sim.set_temperature(1, 20.0);
    assert_eq!(write_register(&mut line, 1, 451, (-150_i16).cast_unsigned())[1], 6);
    assert_eq!(write_register(&mut line, 1, 450, 125)[1], 6);
    expect(&sim, 1, &[("temperature_offset", "-1.50"), ("humidity_offset", "1.25"), ("temperature_c", "18.50")]);
    assert_eq!(register(&mut line, 1, 1), Ok(1850));
    assert_eq!(register(&mut line, 1, 2), Ok(6530));
    assert_eq!(write_register(&mut line, 1, 451, 10_001), [1, 0x86, 3]);
}

#[test]
fn extremes_are_latched_and_cleared_by_channel() {
    let (sim, mut line) = world(&["pir-234@1"]);
    for celsius in [20.0, 80.0, -30.0, 20.0] {
        sim.set_temperature(1, celsius);
    }
    assert_eq!(register(&mut line, 1, 577), Ok(8000));
    assert_eq!(register(&mut line, 1, 545), Ok((-3000_i16).cast_unsigned()));
    assert_eq!(write_coil(&mut line, 1, 385, true)[1], 5);
    assert_eq!(register(&mut line, 1, 577), Ok(2000));
    assert_eq!(register(&mut line, 1, 578), Ok(17600));
    assert_eq!(write_coil(&mut line, 1, 280, true)[1], 5);
    assert_eq!(register(&mut line, 1, 578), Ok(6800));
    assert_eq!(write_coil(&mut line, 1, 281, true)[1], 5);
    expect(&sim, 1, &[("temperature_c_low", "20.00"), ("temperature_f_high", "68.00")]);
}

#[test]
fn the_buzzer_follows_the_pir_and_can_be_silenced_until_the_next_visit() {
    let (sim, mut line) = world(&["pir-234@1"]);
    sim.set_motion(1, 1, true);
    assert_eq!(coil(&mut line, 1, 274), Ok(false));
    write_coil(&mut line, 1, 278, true);
    assert_eq!(coil(&mut line, 1, 274), Ok(true));
    write_coil(&mut line, 1, 274, false);
    assert_eq!(coil(&mut line, 1, 274), Ok(false));
    sim.set_motion(1, 1, false);
    sim.set_motion(1, 1, true);
    assert_eq!(coil(&mut line, 1, 274), Ok(true));
}

#[test]
fn the_reset_status_is_read_once_over_modbus_too() {
    let (sim, mut line) = world(&["pir-130@1"]);
    assert_eq!(coil(&mut line, 1, 273), Ok(true));
    assert_eq!(coil(&mut line, 1, 273), Ok(false));
    sim.power_cycle(1);
    assert_eq!(coil(&mut line, 1, 273), Ok(true));
}

#[test]
fn only_the_wireless_pir_234_has_wifi_registers() {
    let (sim, mut line) = world(&["pir-234-wf@1"]);
    assert_eq!(register(&mut line, 1, 711), Ok(502));
    assert_eq!(write_register(&mut line, 1, 710, 3)[1], 6);
    expect(&sim, 1, &[("wifi_710", "11")]);
    assert_eq!(write_register(&mut line, 1, 715, 1)[1], 6);
    expect(&sim, 1, &[("wifi_710", "3"), ("name", "PIR234")]);
    assert_eq!(write_register(&mut line, 1, 720, 1), [1, 0x86, 2]);
}

#[test]
fn a_stranger_tells_its_name_over_dcon_and_refuses_over_modbus() {
    let (_sim, mut line) = world(&["unknown@17", "unknown@18:dcon"]);
    assert_eq!(modbus(&mut line, &[17, 3, 1, 0xE2, 0, 2]), [17, 0x83, 2]);
    assert_eq!(ask(&mut line, "$12M"), "!127065");
    assert_eq!(ask(&mut line, "@12DI"), "");
}

#[test]
fn years_pass_in_a_moment() {
    let (sim, mut line) = world(&["pir-234@1", "pir-130@2"]);
    for _ in 0..3 {
        sim.advance(Duration::MAX);
    }
    assert_eq!(register(&mut line, 1, 484), Ok(0x5049));
}

#[test]
fn no_bytes_make_a_module_stumble() {
    let (sim, mut line) =
        world(&["pir-234@1", "pir-130@2", "pir-234@1:dcon", "pir-130@2:dcon", "pir-234@1:dcon:checksum"]);
    let mut state = 1_u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let alphabet = b"$#%@~!0123456789ABCDEFLCMPRDIOTHSXa+-.\xff";
    let mut spoilt = 0;
    for round in 0..20_000_u32 {
        let length = usize::from(random() % 16);
        let mut frame: Vec<u8> = match round % 3 {
            0 => (0..length).map(|_| random()).collect(),
            1 => with_crc(
                &[&[1 + random() % 2, random() % 24], &(0..length).map(|_| random() % 8).collect::<Vec<_>>()[..]]
                    .concat(),
            ),
            _ => [b"$#%@~"[usize::from(random()) % 5]]
                .into_iter()
                .chain(*b"01")
                .chain((0..length).map(|_| alphabet[usize::from(random()) % alphabet.len()]))
                .collect(),
        };
        if round % 3 == 2 {
            frame.push(b'\r');
        }
        spoilt += usize::from(exchange(&mut line, &frame).is_empty());
    }
    assert_eq!(sim.requests(), 20_000);
    assert!(spoilt < 20_000);
}
