//! Raw frames.

use dcon_bench::bus::{BusCommand, BusEvent, RawRequest};
use dcon_bench::protocol::{Failure, LineSettings};

use crate::harness::*;
use crate::network::{by_net_id, over_tcp};

pub fn raw_modbus(line: &Line, bytes: &[u8]) -> Result<Vec<u8>, Failure> {
    let (id, request) = (line.bus.next_id(), RawRequest::Modbus { bytes: bytes.to_vec() });
    line.bus.send(BusCommand::Raw { id, request, settings: LineSettings::default() }).expect("room");
    line.until(|event| match event {
        BusEvent::RawAnswer { id: answered, result } if *answered == id => Some(result.clone()),
        _ => None,
    })
}

#[test]
pub fn raw_modbus_bytes_pass_over_tcp_and_refusals_come_back_as_their_bytes() {
    let (line, _server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    assert_eq!(raw_modbus(&line, &[1, 3, 0x01, 0xE2, 0, 2]), Ok(vec![1, 3, 4, 0x02, 0x34, 0x50, 0x49]));
    assert_eq!(raw_modbus(&line, &[1, 6, 0x02, 0x00, 0, 8]), Ok(vec![1, 6, 0x02, 0x00, 0, 8]));
    assert_eq!(line.sim.setting(1, "pir_on_time").as_deref(), Some("131"));
    assert_eq!(raw_modbus(&line, &[1, 3, 0xFF, 0x00, 0, 1]), Ok(vec![1, 0x83, 2]));
    assert_eq!(raw_modbus(&line, &[1, 0x41, 7]), Ok(vec![1, 0xC1, 1]), "a function that nobody knows");
    assert!(matches!(raw_modbus(&line, &[1, 0x83, 2]), Err(Failure::NotOffered(_))));
    assert!(matches!(raw_modbus(&line, &[1]), Err(Failure::NotOffered(_))));
    assert!(line.read(by_net_id(1), &line.definition("pir-234"), "humidity").is_ok(), "the line is still good");
}

#[test]
fn a_raw_dcon_command_over_tcp_is_refused_with_the_reason() {
    let (line, _server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    assert!(matches!(raw_dcon(&line, "$01M", false), Err(Failure::NotOffered(reason)) if reason.contains("serial")));
}

pub fn raw_dcon(line: &Line, text: &str, checksum: bool) -> Result<Vec<u8>, Failure> {
    let (id, request) = (line.bus.next_id(), RawRequest::Dcon { text: text.into(), checksum });
    line.bus.send(BusCommand::Raw { id, request, settings: LineSettings::default() }).expect("room");
    line.until(|event| match event {
        BusEvent::RawAnswer { id: answered, result } if *answered == id => Some(result.clone()),
        _ => None,
    })
}

#[test]
fn raw_refusals_and_wrong_checksums_on_a_serial_line_are_visible_as_bytes() {
    let line = Line::open(&["pir-234@2:dcon", "pir-234@3:modbus_rtu"]);
    assert_eq!(raw_dcon(&line, "@02DO0F", false), Ok(b"?02".to_vec()));
    let exception = raw_modbus(&line, &[3, 3, 0xFF, 0, 0, 1]).expect("an answer");
    assert_eq!(exception[..3], [3, 0x83, 2]);
    let line = Line::open(&["pir-234@2:dcon:checksum"]);
    assert_eq!(raw_dcon(&line, "$02M", true), Ok(b"!02PIR23407".to_vec()));
    assert_eq!(raw_dcon(&line, "$02MD3", false), Ok(b"!02PIR23407".to_vec()), "a checksum typed by hand");
    let line = Line::open(&["pir-234@2:dcon"]);
    // With its checksum $025BB, the question for the reset status is another command to a module that expects none.
    let answer = raw_dcon(&line, "$025", true);
    let Err(Failure::Garbled { reason, bytes }) = answer else { panic!("a checksum was missing: {answer:?}") };
    assert!(reason.contains("wrong checksum") && bytes.get(1..3) == Some(b"02"), "{reason} {bytes:?}");
}
