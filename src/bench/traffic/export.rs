//! The log as a file. Frames are written one by one, so that millions of them need no memory.

use std::io::{self, Write};

use serde::Serialize;

use super::log::{FrameRef, TrafficLog};
use crate::bus::Direction;
use crate::protocol::{Protocol, hex};

/// One line of the file; the fields are its columns.
#[derive(Debug, Serialize)]
struct Row {
    /// UTC, ISO 8601, in microseconds.
    time: String,
    direction: &'static str,
    address: Option<u8>,
    protocol: Protocol,
    /// Empty over TCP, as is the data format.
    baud_rate: Option<u32>,
    data_format: Option<&'static str>,
    took_ms: f64,
    verdict: &'static str,
    /// What is wrong; empty if nothing is.
    error: String,
    bytes: String,
    /// The characters of a DCON frame; empty for others.
    text: String,
    meaning: String,
}

impl Row {
    fn of(frame: &FrameRef<'_>, meaning: String) -> Self {
        let on_wire = frame.protocol != Protocol::ModbusTcp;
        Self {
            time: format!("{:.6}", frame.at),
            direction: if frame.direction == Direction::Sent { "sent" } else { "received" },
            address: frame.address,
            protocol: frame.protocol,
            baud_rate: on_wire.then_some(frame.settings.baud_rate.bps()),
            data_format: on_wire.then_some(frame.settings.data_format.word()),
            took_ms: frame.took.as_micros() as f64 / 1000.0,
            verdict: frame.outcome.word(),
            error: frame.outcome.trouble().to_owned(),
            bytes: hex::spaced(frame.bytes),
            text: if frame.protocol == Protocol::Dcon { hex::escaped(frame.bytes) } else { String::new() },
            meaning,
        }
    }
}

/// Tells what a frame means, given the request that it answers.
type Explain<'a> = &'a dyn Fn(&FrameRef<'_>, Option<&FrameRef<'_>>) -> String;

/// Writes the frames `seqs` as CSV with a line of column names, and returns how many were written. Frames that the log has
/// forgotten are passed over. `to` should be buffered.
///
/// # Errors
/// What `to` says.
pub fn write_csv(
    log: &TrafficLog,
    seqs: impl IntoIterator<Item = u64>,
    explain: Explain<'_>,
    mut to: impl Write,
) -> io::Result<u64> {
    let mut header = csv::Writer::from_writer(&mut to);
    header.write_record(COLUMNS)?;
    header.flush()?;
    drop(header);
    append_csv(log, seqs, explain, to)
}

/// As [`write_csv`], without the line of column names: for a file that is written in several steps.
///
/// # Errors
/// What `to` says.
pub fn append_csv(
    log: &TrafficLog,
    seqs: impl IntoIterator<Item = u64>,
    explain: Explain<'_>,
    to: impl Write,
) -> io::Result<u64> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(to);
    let count = each(log, seqs, explain, |row| Ok(writer.serialize(row)?))?;
    writer.flush()?;
    Ok(count)
}

/// Writes the frames `seqs` as one JSON object a line, and returns how many were written. What there is nothing to say of
/// is `null` or empty.
///
/// # Errors
/// What `to` says.
pub fn write_json_lines(
    log: &TrafficLog,
    seqs: impl IntoIterator<Item = u64>,
    explain: Explain<'_>,
    mut to: impl Write,
) -> io::Result<u64> {
    let count = each(log, seqs, explain, |row| {
        serde_json::to_writer(&mut to, row)?;
        to.write_all(b"\n")
    })?;
    to.flush()?;
    Ok(count)
}

/// Written also when no row follows.
const COLUMNS: [&str; 12] = [
    "time",
    "direction",
    "address",
    "protocol",
    "baud_rate",
    "data_format",
    "took_ms",
    "verdict",
    "error",
    "bytes",
    "text",
    "meaning",
];

fn each(
    log: &TrafficLog,
    seqs: impl IntoIterator<Item = u64>,
    explain: Explain<'_>,
    mut write: impl FnMut(&Row) -> io::Result<()>,
) -> io::Result<u64> {
    let mut count = 0u64;
    for seq in seqs {
        let Some(frame) = log.get(seq) else { continue };
        let meaning = explain(&frame, log.request_of(seq).as_ref());
        write(&Row::of(&frame, meaning))?;
        count = count.saturating_add(1);
    }
    Ok(count)
}
