//! The simulated modules answer the examples of both manuals.
//!
//! Where a manual prints an answer in two ways, or with an address that was not asked, the comment beside it says which
//! reading is taken.

mod common;

use std::time::Duration;

use dcon_bench::sim::{Pace, Sim, SimLine};

use common::{ask, exchange};

/// A world with one module.
fn world(spec: &str) -> (Sim, SimLine) {
    let sim = Sim::new(&[spec.parse().unwrap()], Pace::Skip);
    let line = sim.line();
    (sim, line)
}

/// Commands and answers in a row, to one module; an empty answer is silence.
#[track_caller]
fn conversation(spec: &str, examples: &[(&str, &str)]) {
    let (_sim, mut line) = world(spec);
    for (command, answer) in examples {
        assert_eq!(ask(&mut line, command), *answer, "{spec}: {command}");
    }
}

/// The same in both models.
#[track_caller]
fn conversation_with_both(rest: &str, examples: &[(&str, &str)]) {
    for model in ["pir-130", "pir-234"] {
        conversation(&format!("{model}@{rest}"), examples);
    }
}

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

#[track_caller]
fn modbus_conversation(spec: &str, examples: &[(&str, &str)]) {
    let (_sim, mut line) = world(spec);
    for (request, answer) in examples {
        assert_eq!(exchange(&mut line, &hex(request)), hex(answer), "{spec}: {request}");
    }
}

#[test]
fn the_address_changes_at_once_and_the_answer_carries_the_new_one() {
    // PIR-234 manual 5.2, PIR-130 manual 2.1.
    conversation_with_both("1:dcon", &[("%0102400600", "!02"), ("$012", ""), ("$022", "!02400600")]);
}

#[test]
fn the_speed_changes_in_init_mode_only() {
    // PIR-234 manual 5.2, PIR-130 manual 2.1.
    conversation_with_both("1:dcon", &[("%0101200A00", "?01"), ("$012", "!01400600")]);
    conversation("pir-130@1:dcon:init", &[("%0101200A00", "!01"), ("%0101200600", "!01"), ("$012", "!01400600")]);
    conversation("pir-234@1:dcon:init", &[("%0101200A00", "!01"), ("%0101000600", "!01"), ("$012", "!01000600")]);
}

#[test]
fn the_reset_status_is_one_only_at_the_first_read() {
    // PIR-234 manual 5.8, PIR-130 manual 2.3.
    conversation_with_both("1:dcon", &[("$015", "!011"), ("$015", "!010")]);
}

#[test]
fn names_and_firmware_are_told() {
    // PIR-130 manual 2.5 and 2.6.
    conversation("pir-130@2:dcon", &[("$02F", "!0201.00"), ("$02M", "!02PIR130")]);
    // PIR-234 manual 5.9 prints A1.0 and 5.20 prints PIR234E; here a newer firmware, and the name without its letter.
    conversation("pir-234@2:dcon", &[("$02F", "!02B2.8"), ("$02M", "!02PIR234")]);
}

#[test]
fn the_protocol_is_stored_in_init_mode_only_and_read_as_stored() {
    // PIR-234 manual 5.21 and 5.22, PIR-130 manual 2.7 and 2.8.
    conversation_with_both("1:dcon", &[("$01P1", "?01"), ("$01P", "!0110")]);
    conversation_with_both("1:dcon:init", &[("$01P1", "!01"), ("$01P", "!0111"), ("$01P0", "!01"), ("$01P", "!0110")]);
}

#[test]
fn the_response_delay_goes_up_to_30_ms() {
    // PIR-234 manual 5.23 and 5.24, PIR-130 manual 2.22 and 2.23.
    conversation_with_both("3:dcon", &[("~03RD1E", "!03"), ("~03RD", "!031E"), ("~03RD1F", "?03")]);
}

#[test]
fn the_active_state_of_the_output_is_00_or_02() {
    // PIR-234 manual 5.27 and 5.28, PIR-130 manual 2.20 and 2.21.
    conversation_with_both("2:dcon", &[("~02D02", "!02"), ("~02D", "!0202"), ("~02D07", "?02")]);
}

#[test]
fn the_high_alarm_is_enabled_limited_cleared_and_read() {
    // PIR-234 manual 5.29 to 5.36, PIR-130 manual 2.24 to 2.29; where the answer's address is not the asked one, the
    // asked one is taken.
    conversation_with_both(
        "1:dcon",
        &[
            ("@01EAM", "!01"),
            ("@01HI+086.00", "!01"),
            ("@01RH", "!01+086.00"),
            ("@01HI+1000.00", "?01"),
            ("@01RH", "!01+086.00"),
        ],
    );
    conversation_with_both(
        "3:dcon",
        &[
            ("@03HI+090.50", "!03"),
            ("@03RH", "!03+090.50"),
            ("@03RAO", "!030000"),
            ("@03CHC0", "!03"),
            ("@03DA", "!03"),
        ],
    );
}

#[test]
fn the_on_time_is_a_code_of_channel_zero() {
    // PIR-234 manual 5.14 and 5.15, PIR-130 manual 2.14 and 2.15, where the PIR-130 also prints >0100.
    conversation_with_both(
        "1:dcon",
        &[
            ("$01LC7C000", "!01"),
            ("$01LC8C0", "!0100"),
            ("$01LC7C100", "?01"),
            ("$01LC7C010", "?01"),
            ("$01LC7C00F", "!01"),
        ],
    );
    conversation_with_both("1:dcon", &[("$01LC8C0", "!0102"), ("$01LC8C1", "?01")]);
}

#[test]
fn the_pir_234_sets_its_active_delay_by_lc2_and_reads_it_by_lc3() {
    // PIR-234 manual 5.10 and 5.11.
    conversation(
        "pir-234@1:dcon",
        &[
            ("$01LC2C003E8", "!01"),
            ("$01LC3", "!0103E8"),
            ("$01LC2C00BB8", "!01"),
            ("$01LC3", "!010BB8"),
            ("$01LC2C00BB9", "?01"),
            ("$01LC4C0", ""),
        ],
    );
}

#[test]
fn the_pir_130_sets_its_active_delay_by_lc3_and_reads_it_by_lc4() {
    // PIR-130 manual 2.10 and 2.11.
    conversation(
        "pir-130@1:dcon",
        &[
            ("$01LC3C003E8", "!01"),
            ("$01LC4C0", "!0103E8"),
            ("$01LC3C00BB8", "!01"),
            ("$01LC4C0", "!010BB8"),
            ("$01LC3C00BB9", "?01"),
            ("$01LC2C00BB8", ""),
        ],
    );
}

#[test]
fn the_pir_130_has_lux_level_buzzer_and_sensitivity() {
    // PIR-130 manual 2.12, 2.13 and 2.16 to 2.19: answers are printed as >011, >0101, !011 and !0101.
    conversation(
        "pir-130@1:dcon",
        &[
            ("$01LC5C00", "!01"),
            ("$01LC5C05", "?01"),
            ("$01LC5C01", "!01"),
            ("$01LC6C0", "!0101"),
            ("$01LC5C004", "!01"),
            ("$01LC6C0", "!0104"),
            ("$01LC6C1", "?01"),
            ("$01LC9C01", "!01"),
            ("$01LCAC0", "!0101"),
            ("$01LC9C11", "?01"),
            ("$01LCAC1", "?01"),
            ("$01LCBC01", "!01"),
            ("$01LCCC0", "!0101"),
            ("$01LCBC11", "?01"),
            ("$01LCCC1", "?01"),
            ("$01LCBC00A", "?01"),
        ],
    );
}

#[test]
fn the_pir_130_shows_relay_and_sensor_without_and_with_its_address() {
    // PIR-130 manual 2.4, and 2.9 by its text: 00 is an active PIR.
    let (sim, mut line) = world("pir-130@2:dcon");
    sim.set_motion(2, 1, true);
    assert_eq!(ask(&mut line, "$026"), "!010100");
    assert_eq!(ask(&mut line, "@02DI"), ">0200100");
    sim.set_motion(2, 1, false);
    sim.advance(Duration::from_secs(7));
    assert_eq!(ask(&mut line, "$026"), "!000100");
    assert_eq!(ask(&mut line, "@02DI"), ">0200001");
}

#[test]
fn the_pir_234_measures_in_signed_decimals() {
    // PIR-234 manual 5.3 to 5.6.
    let (sim, mut line) = world("pir-234@1:dcon");
    sim.set_temperature(1, 30.0);
    sim.set_humidity(1, 50.0);
    for (command, answer) in [
        ("#01", ">+030.00+086.00+050.00"),
        ("#010", ">+030.00"),
        ("#011", ">+086.00"),
        ("#012", ">+050.00"),
        ("#013", ">+018.44"),
        ("#014", ">+065.19"),
        ("#015", ""),
    ] {
        assert_eq!(ask(&mut line, command), answer, "{command}");
    }
}

#[test]
fn the_pir_234_has_offsets_of_temperature_and_humidity() {
    // PIR-234 manual 5.33, 5.34, 5.37 and 5.38.
    conversation(
        "pir-234@1:dcon",
        &[
            ("@01HO+001.00", "!01"),
            ("@01HO", "!01+001.00"),
            ("@01TO+001.00", "!01"),
            ("@01TO", "!01+001.00"),
            ("@01TO-100.00", "!01"),
            ("@01TO-100.01", "?01"),
            ("@01HO+100.01", "?01"),
            ("@01TO", "!01-100.00"),
        ],
    );
}

#[test]
fn the_pir_234_links_outputs_and_buzzer_by_one_byte() {
    // PIR-234 manual 5.16 and 5.17.
    conversation(
        "pir-234@1:dcon",
        &[
            ("$01LC9C003", "!01"),
            ("$01LCAC0", "!0103"),
            ("$01LC9C103", "?01"),
            ("$01LC9C006", "?01"),
            ("$01LC9C020", "?01"),
            ("$01LC9C015", "!01"),
            ("$01LCAC0", "!0115"),
        ],
    );
}

#[test]
fn an_output_obeys_only_if_it_is_linked_to_nothing() {
    // PIR-234 manual 5.25 and 5.26.
    let (sim, mut line) = world("pir-234@1:dcon");
    sim.set_motion(1, 0, false);
    for (command, answer) in
        [("@01DO01", "?01"), ("$01LC9C000", "!01"), ("@01DO01", "!01"), ("@01DI", "!0100100"), ("@01DO04", "?01")]
    {
        assert_eq!(ask(&mut line, command), answer, "{command}");
    }
}

#[test]
fn the_pir_234_has_the_commands_of_the_overview() {
    // PIR-234 manual 5.1.
    conversation(
        "pir-234@1:dcon",
        &[
            ("$016", "!010F"),
            ("$0155", ""),
            ("$01505", "!01"),
            ("$016", "!0105"),
            ("$01510", "?01"),
            ("$01I", "!011"),
            ("~010", "!0100"),
            ("~013164", "!01"),
            ("~012", "!01164"),
            ("~010", "!0180"),
            ("~011", "!01"),
            ("~013264", "?01"),
            ("~013000", "!01"),
            ("~012", "!01000"),
            ("~01502", ""),
            ("~0150201", "!01"),
            ("~014", "!010201"),
            ("~0150401", "?01"),
            ("$01LCD1E", "!01"),
            ("$01LCE", "!011E"),
            ("$01LCD1F", "?01"),
            ("@01CH", "!01"),
            ("@01CL", "!01"),
            ("@01CH4", "!01"),
            ("@01CL0", "!01"),
            ("@01CH5", ""),
        ],
    );
    conversation("pir-234@1:dcon:init", &[("$01I", "!010")]);
}

#[test]
fn a_checksum_is_asked_for_and_given() {
    conversation(
        "pir-234@1:dcon:checksum",
        &[("$012B7", "!01400640B0"), ("$012B8", ""), ("$012b7", ""), ("$012", ""), ("$01MD2", "!01PIR23406")],
    );
    conversation("pir-130@2:dcon:checksum", &[("$02MD3", "!02PIR13002")]);
}

#[test]
fn there_is_no_answer_to_wrong_syntax_or_another_address() {
    // "There will be no response if the command syntax is incorrect, there is a communication error, or there is no
    // module with the specified address."
    conversation_with_both(
        "26:dcon",
        &[
            ("$1aM", ""),
            ("$1Am", ""),
            ("$1BM", ""),
            ("$1AMM", ""),
            ("&1AM", ""),
            ("1AM", ""),
            ("$1", ""),
            ("", ""),
            ("#**", ""),
            ("~**", ""),
        ],
    );
    conversation("pir-130@1:dcon", &[("#01", ""), ("~010", ""), ("@01DO01", ""), ("@01TO", ""), ("$01I", "")]);
}

#[test]
fn the_published_modbus_frames_are_understood() {
    modbus_conversation(
        "pir-234@1",
        &[
            // Firmware and name, 40481 to 40484.
            ("01 03 01 E0 00 04 44 03", "01 03 08 0B 28 00 00 02 34 50 49 C1 E6"),
            ("01 06 02 00 00 0A 08 75", "01 06 02 00 00 0A 08 75"),
            ("01 06 02 00 00 0A 08 76", ""),
            // Linked to the PIR, so the coil refuses.
            ("01 05 00 00 FF 00 8C 3A", "01 85 03 02 91"),
        ],
    );
}

#[test]
fn analogue_inputs_are_signed_hundredths_in_registers() {
    let (sim, mut line) = world("pir-234@1");
    sim.set_temperature(1, -12.5);
    sim.set_humidity(1, 50.0);
    let answer = exchange(&mut line, &hex("01 04 00 00 00 05 30 09"));
    assert_eq!(&answer[..9], hex("01 04 0A FB 1E 03 B6 13 88"), "{answer:02X?}");
}

#[test]
fn the_pir_130_tells_its_temperature_by_function_4_only() {
    let (sim, mut line) = world("pir-130@1");
    sim.set_temperature(1, 21.5);
    assert_eq!(exchange(&mut line, &hex("01 04 00 00 00 01 31 CA"))[..5], hex("01 04 02 08 66"));
    assert_eq!(exchange(&mut line, &hex("01 03 00 00 00 01 84 0A")), hex("01 83 02 C0 F1"));
}

#[test]
fn the_pir_130_has_function_46() {
    // PIR-130 manual 3.10, and a refused sub-function as published.
    modbus_conversation(
        "pir-130@1:init",
        &[
            ("01 46 00 12 60", "01 46 00 4C 43 01 01 22 72"),
            ("01 46 20 13 B8", "01 46 20 01 00 00 D2 05"),
            ("01 46 05 00 E3 5D", "01 46 05 00 06 00 00 00 01 00 00 E8 43"),
            ("01 46 09 D2 66", "01 C6 02 F2 61"),
            ("01 46 04 02 00 00 00 F5 1E", "01 46 04 00 00 00 00 F4 A6"),
        ],
    );
    modbus_conversation("pir-234@1", &[("01 46 00 12 60", "01 C6 01 B2 60")]);
}
