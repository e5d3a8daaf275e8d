//! Where an answer of Modbus RTU stands among the bytes that came: after the request's echo, between stray bytes.

use crate::bus::{Direction, Frame, Verdict};
use crate::protocol::Protocol;
use crate::protocol::modbus::{self, AnswerLength};

/// The bytes of a frame, in order. All but `answer` are empty unless the frame says that there is more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Parts<'a> {
    pub echo: &'a [u8],
    pub before: &'a [u8],
    pub answer: &'a [u8],
    pub after: &'a [u8],
}

/// `request` is what was sent last; empty if that is not known.
pub(super) fn of<'a>(frame: &Frame, bytes: &'a [u8], request: &[u8]) -> Parts<'a> {
    let whole = Parts { echo: &[], before: &[], answer: bytes, after: &[] };
    let is_answer = frame.direction == Direction::Received && frame.protocol == Protocol::ModbusRtu;
    if !is_answer || request.is_empty() {
        return whole;
    }
    let (echo, rest) = match frame.echo.then(|| bytes.strip_prefix(request)).flatten() {
        Some(rest) => bytes.split_at_checked(bytes.len().saturating_sub(rest.len())).unwrap_or_default(),
        None => (&[][..], bytes),
    };
    if !frame.noise || !matches!(frame.verdict, Verdict::Answer | Verdict::Refusal) {
        return Parts { echo, answer: rest, ..whole };
    }
    let found = (0..rest.len()).find_map(|start| {
        let (before, from_here) = rest.split_at_checked(start)?;
        let (answer, after) = from_here.split_at_checked(length(request, from_here)?)?;
        is_right(answer).then_some(Parts { echo, before, answer, after })
    });
    found.unwrap_or(Parts { echo, answer: rest, ..whole })
}

/// How long the answer is that begins here, if one does.
fn length(request: &[u8], from_here: &[u8]) -> Option<usize> {
    match modbus::answer_length(request, from_here) {
        AnswerLength::Bytes(length) => Some(length),
        AnswerLength::UntilSilence => Some(from_here.len()),
        _ => None,
    }
}

/// Whether the last two bytes are the CRC of the others.
pub(super) fn is_right(frame: &[u8]) -> bool {
    frame.len() > 3 && modbus::crc(frame) == 0
}
