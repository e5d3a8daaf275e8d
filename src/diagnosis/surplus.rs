//! What bytes beside an answer are: whole answers that came twice or late, or the noise of the line.

use std::borrow::Cow;

use crate::bus::Frame;
use crate::protocol::{Protocol, dcon, modbus};

/// Bytes looked at for whole answers; those of one exchange are fewer.
const MOST_BYTES: usize = 512;
/// Address, function, one byte, CRC.
const SHORTEST_RTU: usize = 5;
/// The header of a Modbus TCP frame without its length's count: transaction, protocol, length.
const MBAP: usize = 6;

/// What is on the line beside the answer, or without one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Surplus {
    Nothing,
    /// The answer again, byte for byte.
    Copy,
    /// A whole answer, and another one.
    Other,
    /// Something else than 00 and FF, but no whole answer.
    Piece,
    /// Only 00 and FF.
    Stray,
}

impl Surplus {
    /// What stands around the answer in `frame`, whose request was `request`.
    pub fn around(frame: &Frame, request: Option<&[u8]>) -> Self {
        if !frame.noise {
            return Self::Nothing;
        }
        let (before, bytes) = without_echo(frame, request);
        let found = answers(&bytes, frame.protocol, frame.checksum);
        match found.split_first() {
            Some((first, [second, ..])) if first == second => Self::Copy,
            Some((_, [_, ..])) => Self::Other,
            // It was there before the request had left, so an earlier one was meant.
            Some((answer, [])) if before >= answer.len() => Self::Other,
            _ if !begun(frame, request).is_empty() => Self::Nothing,
            _ => Self::Stray,
        }
    }

    pub fn is_whole(self) -> bool {
        matches!(self, Self::Copy | Self::Other)
    }
}

/// The last answer, for what comes behind it.
#[derive(Debug, Clone, Default)]
pub(super) struct Heard {
    answer: Option<Vec<u8>>,
    /// How a second answer began that came with it.
    begun: Vec<u8>,
    /// The request, as long as its echo has not come.
    unechoed: Vec<u8>,
}

impl Heard {
    /// What was heard in a frame whose request was `request`.
    pub fn of(frame: &Frame, request: Option<&[u8]>) -> Self {
        let (_, bytes) = without_echo(frame, request);
        let answer = next(&bytes, frame.protocol, frame.checksum);
        let unechoed = request.filter(|request| bytes.len() == frame.bytes.len() && !is_its_own_answer(frame, request));
        Self {
            answer: answer.map(|(answer, _)| answer.to_vec()),
            begun: begun(frame, request),
            unechoed: unechoed.unwrap_or_default().to_vec(),
        }
    }

    /// What the bytes are that belong to no request and came behind the answer.
    pub fn behind(&mut self, frame: &Frame) -> Surplus {
        let request = std::mem::take(&mut self.unechoed);
        let bytes = [std::mem::take(&mut self.begun), frame.bytes.clone()].concat();
        let bytes = match position(&bytes, &request) {
            // The answer had come before its request was echoed, so an earlier one was meant.
            Some(_) if bytes.len() == request.len() => return Surplus::Other,
            Some(at) => cut_out(&bytes, at, request.len()),
            None => bytes,
        };
        match next(&bytes, frame.protocol, frame.checksum) {
            Some((first, _)) if self.answer.as_deref() == Some(first) => Surplus::Copy,
            Some(_) => Surplus::Other,
            None if bytes.iter().all(|byte| is_stray(*byte)) => Surplus::Stray,
            None => Surplus::Piece,
        }
    }
}

/// The beginning of a second answer behind the first, whose rest comes when nobody listens for it any more.
fn begun(frame: &Frame, request: Option<&[u8]>) -> Vec<u8> {
    let (_, bytes) = without_echo(frame, request);
    let Some((answer, behind)) = next(&bytes, frame.protocol, frame.checksum) else { return Vec::new() };
    let start = behind.iter().position(|byte| !is_stray(*byte)).unwrap_or(behind.len());
    let rest = behind.get(start..).unwrap_or_default();
    let begins = match frame.protocol {
        Protocol::Dcon => rest.first().is_some_and(|byte| dcon::ANSWER_DELIMITERS.contains(byte)),
        _ => !rest.is_empty() && rest.first() == answer.first(),
    };
    if begins && next(rest, frame.protocol, frame.checksum).is_none() { rest.to_vec() } else { Vec::new() }
}

/// What came without the echo of `request`, and how much of it stood before that.
fn without_echo<'a>(frame: &'a Frame, request: Option<&[u8]>) -> (usize, Cow<'a, [u8]>) {
    let bytes = frame.bytes.as_slice();
    let request = request.unwrap_or_default();
    match bytes.strip_prefix(request) {
        Some(rest) if frame.echo => (0, rest.into()),
        // Where a late answer comes first, the echo stands behind it.
        _ if frame.noise && !frame.echo && !is_its_own_answer(frame, request) => match position(bytes, request) {
            Some(at) => (at, cut_out(bytes, at, request.len()).into()),
            None => (0, bytes.into()),
        },
        _ => (0, bytes.into()),
    }
}

/// The answer to a Modbus write of one value, or to a loopback test, equals its request.
fn is_its_own_answer(frame: &Frame, request: &[u8]) -> bool {
    frame.protocol == Protocol::ModbusRtu && matches!(request.get(1), Some(0x05 | 0x06 | 0x08))
}

fn position(bytes: &[u8], part: &[u8]) -> Option<usize> {
    if part.is_empty() { None } else { bytes.windows(part.len()).position(|window| window == part) }
}

fn cut_out(bytes: &[u8], at: usize, length: usize) -> Vec<u8> {
    let (before, rest) = bytes.split_at_checked(at).unwrap_or((bytes, &[]));
    [before, rest.get(length..).unwrap_or_default()].concat()
}

/// The whole answers among `bytes`, with their checksum or CRC and without what ends them.
fn answers(bytes: &[u8], protocol: Protocol, checksum: bool) -> Vec<&[u8]> {
    let mut rest = bytes.get(..MOST_BYTES).unwrap_or(bytes);
    let mut found = Vec::new();
    while let Some((answer, behind)) = next(rest, protocol, checksum) {
        found.push(answer);
        rest = behind;
    }
    found
}

fn next(bytes: &[u8], protocol: Protocol, checksum: bool) -> Option<(&[u8], &[u8])> {
    match protocol {
        Protocol::Dcon => next_dcon(bytes, checksum),
        Protocol::ModbusRtu => next_rtu(bytes),
        Protocol::ModbusTcp => {
            let length = bytes.get(4..MBAP)?.iter().fold(0usize, |sum, byte| sum << 8 | usize::from(*byte));
            let right = bytes.get(2..4) == Some(&[0, 0]) && length > 2;
            right.then(|| bytes.split_at_checked(MBAP.saturating_add(length))).flatten()
        }
    }
}

fn next_dcon(bytes: &[u8], checksum: bool) -> Option<(&[u8], &[u8])> {
    let mut rest = bytes;
    loop {
        let range = dcon::find_answer(rest)?;
        let (answer, behind) = (rest.get(range.clone())?, rest.get(range.end.saturating_add(1)..)?);
        if dcon::decode(answer, checksum).is_ok() {
            return Some((answer, behind));
        }
        rest = behind;
    }
}

/// An answer begins behind what is only noise: no module has address 0 or 255.
fn next_rtu(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let start = bytes.iter().position(|byte| !is_stray(*byte))?;
    let bytes = bytes.get(start..)?;
    (SHORTEST_RTU..=bytes.len()).filter_map(|length| bytes.split_at_checked(length)).find(|(answer, _)| {
        let body = answer.split_at_checked(answer.len().saturating_sub(2));
        body.is_some_and(|(body, crc)| modbus::crc(body).to_le_bytes() == crc)
    })
}

/// As a line without bias or termination shows them, and the line feed that some modules send behind an answer.
fn is_stray(byte: u8) -> bool {
    matches!(byte, 0x00 | 0xFF | b'\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_answers_are_found_between_stray_bytes() {
        let (one, two) = (modbus::with_crc(&[1, 3, 2, 0, 7]), modbus::with_crc(&[2, 3, 2, 0, 9]));
        let both = [&[0, 0xFF][..], &one, &[0xFF], &two].concat();
        assert_eq!(answers(&both, Protocol::ModbusRtu, false), [&one[..], &two[..]]);
        assert_eq!(answers(b"!01A\r\n>02B\r!0", Protocol::Dcon, false), [&b"!01A"[..], b">02B"]);
        assert_eq!(answers(b"!01PIR2344C\r", Protocol::Dcon, true), Vec::<&[u8]>::new(), "a wrong checksum");
        let tcp = [0, 1, 0, 0, 0, 5, 1, 3, 2, 0, 7];
        assert_eq!(answers(&tcp.repeat(2), Protocol::ModbusTcp, false), [&tcp[..], &tcp[..]]);
        for protocol in [Protocol::Dcon, Protocol::ModbusRtu, Protocol::ModbusTcp] {
            assert_eq!(answers(&[0xFF; 700], protocol, false), Vec::<&[u8]>::new());
        }
    }
}
