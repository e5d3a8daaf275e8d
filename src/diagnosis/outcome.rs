//! What became of one exchange, in the few kinds that point to different causes.

use serde::Serialize;

use crate::bus::{Frame, UNASKED, Verdict};
use crate::protocol::Protocol;

#[cfg(test)]
mod tests;

/// How an exchange failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureKind {
    /// Nothing came back, or an echo only.
    NoAnswer,
    CutShort,
    /// A wrong checksum or CRC.
    WrongCheck,
    /// A right frame of another module.
    WrongAddress,
    /// Something else than what was sent came back on a line that echoes.
    Collision,
    /// Only 00 and FF.
    StrayBytes,
    /// Bytes that make no sense at all.
    Garbage,
    /// What is said of it is not known here: no cause is told from it.
    Other,
}

impl FailureKind {
    pub const ALL: [Self; 8] = [
        Self::NoAnswer,
        Self::CutShort,
        Self::WrongCheck,
        Self::WrongAddress,
        Self::Collision,
        Self::StrayBytes,
        Self::Garbage,
        Self::Other,
    ];

    /// For a person.
    pub fn label(self) -> &'static str {
        match self {
            Self::NoAnswer => "no answer",
            Self::CutShort => "cut short",
            Self::WrongCheck => "wrong checksum or CRC",
            Self::WrongAddress => "wrong address",
            Self::Collision => "collision",
            Self::StrayBytes => "only stray bytes",
            Self::Garbage => "not readable",
            Self::Other => "not usable",
        }
    }

    /// The place among [`Self::ALL`].
    pub(super) fn index(self) -> usize {
        Self::ALL.iter().position(|kind| *kind == self).unwrap_or_default()
    }

    /// What a broken answer of the module at `address` is, whose reason is one of the judge's or of the protocols'. Bytes
    /// in which the module does not even begin to speak Modbus have no wrong CRC: they are no frame.
    pub(super) fn of_broken(reason: &str, bytes: &[u8], protocol: Protocol, address: Option<u8>) -> Self {
        let kind = Self::of_reason(reason);
        let begins = |pair: &[u8]| matches!(pair, [from, function] if Some(*from) == address && function & 0x7F != 0);
        let is_frame = !protocol.is_modbus() || bytes.windows(2).any(begins);
        if kind == Self::WrongCheck && !is_frame { Self::Garbage } else { kind }
    }

    /// What the reason means. Each is known by its beginning or its whole form, so that no other is taken for it.
    fn of_reason(reason: &str) -> Self {
        if let Some((found, expected)) = lengths(reason) {
            return if found < expected { Self::CutShort } else { Self::Garbage };
        }
        let begins = |starts: &[&str]| starts.iter().any(|start| reason.starts_with(start));
        let too_few = reason.starts_with("the answer has ") && reason.ends_with("too few for a Modbus frame");
        if too_few || begins(&["the answer was cut short", "the answer is too short"]) {
            Self::CutShort
        } else if begins(&["wrong checksum: ", "wrong CRC: "]) {
            Self::WrongCheck
        } else if begins(&["the answer comes from address "]) || reason.contains(" does not come from address ") {
            Self::WrongAddress
        } else if begins(&["what came back differs from what was sent"]) {
            Self::Collision
        } else if begins(&["only stray bytes came back"]) {
            Self::StrayBytes
        } else if begins(&GARBAGE) {
            Self::Garbage
        } else {
            Self::Other
        }
    }
}

/// How the reasons begin of what cannot be an answer.
const GARBAGE: [&str; 7] = [
    "no DCON answer is in it",
    "the answer starts with 0x",
    "the answer contains 0x",
    "the answer is for function 0x",
    "the answer is empty",
    "unexpected bytes",
    "the line does not stop sending",
];

/// The two numbers of "the answer has 7 bytes instead of 9".
fn lengths(reason: &str) -> Option<(usize, usize)> {
    let (found, expected) = reason.strip_prefix("the answer has ")?.split_once(" bytes instead of ")?;
    Some((found.parse().ok()?, expected.parse().ok()?))
}

/// Why a module said no.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RefusalKind {
    /// `?AA`.
    Dcon,
    /// A lone `!`: the host watchdog has tripped.
    Ignored,
    /// A Modbus exception.
    Exception(u8),
}

/// What a received frame tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    Answer,
    Refusal(RefusalKind),
    Failed(FailureKind),
    /// Bytes that nobody asked for.
    Unasked,
    /// The adapter is gone: nothing is learned of the module.
    LineLost,
}

impl Outcome {
    /// `None` for a request.
    pub fn of(frame: &Frame) -> Option<Self> {
        Some(match &frame.verdict {
            Verdict::Request => return None,
            Verdict::Answer => Self::Answer,
            Verdict::Refusal => Self::Refusal(refusal(frame)),
            Verdict::Silent => Self::Failed(FailureKind::NoAnswer),
            Verdict::Broken(reason) if reason == UNASKED => Self::Unasked,
            Verdict::Broken(reason) if reason.starts_with("the line was lost") => Self::LineLost,
            Verdict::Broken(reason) => {
                Self::Failed(FailureKind::of_broken(reason, &frame.bytes, frame.protocol, frame.address))
            }
        })
    }
}

fn refusal(frame: &Frame) -> RefusalKind {
    if frame.protocol.is_modbus() {
        // Address, function, code and CRC stand at the end, whatever stands before them; over TCP without a CRC.
        let end = if frame.protocol == Protocol::ModbusTcp { 1 } else { 3 };
        let code = frame.bytes.len().checked_sub(end).and_then(|at| frame.bytes.get(at));
        return RefusalKind::Exception(code.copied().unwrap_or_default());
    }
    if frame.bytes.contains(&b'?') { RefusalKind::Dcon } else { RefusalKind::Ignored }
}
