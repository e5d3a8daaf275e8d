//! Captures read by Wireshark's command line.

use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use dcon_bench::bus::{Direction, Frame, Verdict};
use dcon_bench::capture::{CaptureWriter, Form};
use dcon_bench::protocol::{LineSettings, Protocol, modbus};
use jiff::{SignedDuration, Timestamp};

/// Fields of each packet, as tshark prints them; `None` where it is not installed, which must not be where readers are
/// required.
fn by_tshark(path: &Path, options: &[&str], fields: &[&str]) -> Option<Vec<Vec<String>>> {
    let mut command = Command::new("tshark");
    command.arg("-r").arg(path).args(options).args(["-T", "fields"]);
    for field in fields {
        command.args(["-e", field]);
    }
    let output = match command.output() {
        Ok(output) => output,
        Err(error) => {
            let required = std::env::var("DCON_BENCH_READERS").is_ok_and(|readers| readers == "required");
            assert!(!required, "tshark is required: {error}");
            return None;
        }
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.lines().map(|line| line.split('\t').map(str::to_owned).collect()).collect())
}

fn frame(number: i64, protocol: Protocol, bytes: &[u8], verdict: Verdict) -> Frame {
    let start: Timestamp = "2024-05-06T07:08:09.123456789Z".parse().unwrap();
    Frame {
        at: start + SignedDuration::from_millis(number * 10),
        direction: if verdict == Verdict::Request { Direction::Sent } else { Direction::Received },
        bytes: bytes.to_vec(),
        protocol,
        settings: LineSettings::default(),
        address: Some(1),
        checksum: false,
        took: Duration::from_millis(5),
        first_byte: None,
        echo: false,
        noise: false,
        verdict,
    }
}

fn write(path: &Path, frames: &[Frame]) {
    let mut writer = CaptureWriter::new(Form::Pcapng, File::create(path).unwrap(), "COM3").unwrap();
    frames.iter().for_each(|frame| writer.frame(frame).unwrap());
    writer.finish().unwrap();
}

/// Requests and answers of the functions that modules know, alternating, without CRC.
const EXCHANGES: [&[u8]; 16] = [
    &[1, 1, 0, 0, 0, 3],
    &[1, 1, 1, 5],
    &[1, 3, 0, 0, 0, 2],
    &[1, 3, 4, 0, 10, 1, 2],
    &[1, 4, 0, 0, 0, 1],
    &[1, 4, 2, 0x0B, 0xB8],
    &[1, 5, 0, 0, 0xFF, 0],
    &[1, 5, 0, 0, 0xFF, 0],
    &[1, 6, 0, 1, 0, 3],
    &[1, 6, 0, 1, 0, 3],
    &[1, 15, 0, 0, 0, 3, 1, 5],
    &[1, 15, 0, 0, 0, 3],
    &[1, 3, 0xFF, 0xFF, 0, 1],
    &[1, 0x83, 2],
    &[1, 0x46, 0],
    &[1, 0x46, 0, 0x50, 1, 0x23],
];

fn exchanges() -> Vec<Frame> {
    let verdict = |number: usize| if number.is_multiple_of(2) { Verdict::Request } else { Verdict::Answer };
    let bytes = EXCHANGES.into_iter().map(modbus::with_crc).enumerate();
    bytes.map(|(number, bytes)| frame(number as i64, Protocol::ModbusRtu, &bytes, verdict(number))).collect()
}

#[test]
fn wireshark_decodes_modbus_rtu_without_being_told_anything() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    write(&path, &exchanges());
    let fields = ["_ws.col.Protocol", "_ws.col.Info", "modbus.func_code", "frame.time_epoch", "frame.interface_name"];
    let Some(rows) = by_tshark(&path, &[], &fields) else { return };
    assert_eq!(rows.len(), EXCHANGES.len());
    for (number, (row, bytes)) in rows.iter().zip(EXCHANGES).enumerate() {
        assert_eq!((row[0].as_str(), row[4].as_str()), ("Modbus RTU", "COM3"));
        assert_eq!(row[2], (bytes[1] & 0x7F).to_string());
        assert_eq!(row[3], format!("1714979289.{:03}456789", 123 + number * 10));
        // These look the same in both directions.
        let expected = match (bytes[1], number % 2) {
            (5 | 6 | 0x46, _) => "unknown",
            (_, 0) => "Query",
            _ => "Response",
        };
        assert!(row[1].trim_start().starts_with(expected), "{row:?}");
    }
    assert!(rows[13][1].contains("Exception"), "{:?}", rows[13]);
}

#[test]
fn wireshark_tells_the_direction_of_all_functions_when_told_the_port() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    write(&path, &exchanges());
    let Some(rows) = by_tshark(&path, &["-o", "mbrtu.tcp.port:5020"], &["_ws.col.Info"]) else { return };
    for (number, row) in rows.iter().enumerate() {
        let expected = if number % 2 == 0 { "Query" } else { "Response" };
        assert!(row[0].trim_start().starts_with(expected), "{row:?}");
    }
}

#[test]
fn wireshark_shows_a_wrong_crc_and_what_stands_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    let request = modbus::with_crc(&[1, 4, 0, 0, 0, 1]);
    let wrong = Verdict::Broken("wrong CRC: FFFF was received".to_owned());
    let frames = [
        frame(0, Protocol::ModbusRtu, &request, Verdict::Request),
        frame(1, Protocol::ModbusRtu, &[1, 4, 2, 0x0B, 0xB8, 0xFF, 0xFF], wrong),
        frame(2, Protocol::ModbusRtu, &request, Verdict::Request),
        frame(3, Protocol::ModbusRtu, &[], Verdict::Silent),
    ];
    write(&path, &frames);
    let fields =
        ["mbrtu.crc16.status", "frame.packet_flags_crc_error", "frame.comment", "frame.packet_flags_direction"];
    let Some(rows) = by_tshark(&path, &["-o", "mbrtu.crc_verification:TRUE"], &fields) else { return };
    let column = |column: usize| rows.iter().map(|row| row[column].as_str()).collect::<Vec<_>>();
    assert_eq!(column(0), ["1", "0", "1", ""], "{rows:?}");
    assert_eq!(column(1), ["0", "1", "0", "0"], "{rows:?}");
    assert!(rows[1][2].contains("broken; Modbus RTU; 9600 N81; address 1;"), "{rows:?}");
    assert!(rows[1][2].ends_with("reason: wrong CRC: FFFF was received") && rows[3][2].starts_with("silent"));
    assert!(rows[0][3].ends_with('2') && rows[1][3].ends_with('1'), "{rows:?}");
}

#[test]
fn wireshark_decodes_an_answer_between_echo_and_stray_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    let (request, answer) = (modbus::with_crc(&[1, 4, 0, 0, 0, 1]), modbus::with_crc(&[1, 4, 2, 0x0B, 0xB8]));
    let bytes = [&request[..], &[0xFF], &answer, &[0, 0]].concat();
    let noisy = frame(1, Protocol::ModbusRtu, &bytes, Verdict::Answer);
    let sent = frame(0, Protocol::ModbusRtu, &request, Verdict::Request);
    write(&path, &[sent, Frame { echo: true, noise: true, ..noisy }]);
    let Some(rows) = by_tshark(&path, &["-o", "mbrtu.crc_verification:TRUE"], &["_ws.col.Info", "mbrtu.crc16.status"])
    else {
        return;
    };
    assert_eq!(rows.len(), 5, "the request, three pieces and the answer");
    assert!(rows[4][0].contains("Response") && rows[4][1] == "1", "{rows:?}");
}

#[test]
fn wireshark_decodes_modbus_tcp_and_shows_dcon_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    let frames = [
        frame(0, Protocol::ModbusTcp, &[0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 2], Verdict::Request),
        frame(1, Protocol::ModbusTcp, &[0, 1, 0, 0, 0, 7, 1, 3, 4, 0, 10, 1, 2], Verdict::Answer),
        frame(2, Protocol::Dcon, b"$01M\r", Verdict::Request),
        frame(3, Protocol::Dcon, b"!01PIR234\r", Verdict::Answer),
    ];
    write(&path, &frames);
    let Some(rows) = by_tshark(&path, &[], &["_ws.col.Protocol", "_ws.col.Info", "text"]) else { return };
    assert!(rows[0][0] == "Modbus/TCP" && rows[0][1].contains("Query"), "{rows:?}");
    assert!(rows[1][0] == "Modbus/TCP" && rows[1][1].contains("Response"), "{rows:?}");
    assert!(rows[2][0] == "DCON" && rows[2][2].contains("$01M"), "{rows:?}");
    assert!(rows[3][0] == "DCON" && rows[3][2].contains("!01PIR234"), "{rows:?}");
}
