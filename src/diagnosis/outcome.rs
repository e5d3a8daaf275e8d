//! What became of one exchange, in the few kinds that point to different causes.

use serde::Serialize;

use crate::bus::{Frame, UNASKED, Verdict};

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
}

impl FailureKind {
    pub const ALL: [Self; 7] = [
        Self::NoAnswer,
        Self::CutShort,
        Self::WrongCheck,
        Self::WrongAddress,
        Self::Collision,
        Self::StrayBytes,
        Self::Garbage,
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
        }
    }

    /// The place among [`Self::ALL`].
    pub(super) fn index(self) -> usize {
        Self::ALL.iter().position(|kind| *kind == self).unwrap_or_default()
    }

    /// What the reason of a broken answer means; the reasons are those of the judge and of the protocols.
    pub(super) fn of_reason(reason: &str) -> Self {
        let has = |words: &[&str]| words.iter().any(|word| reason.contains(word));
        if has(&["cut short", "too few", "bytes instead of", "too short"]) {
            Self::CutShort
        } else if has(&["wrong checksum", "wrong CRC"]) {
            Self::WrongCheck
        } else if has(&["from address"]) {
            Self::WrongAddress
        } else if has(&["differs from what was sent"]) {
            Self::Collision
        } else if has(&["only stray bytes"]) {
            Self::StrayBytes
        } else {
            Self::Garbage
        }
    }
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
            Verdict::Broken(reason) => Self::Failed(FailureKind::of_reason(reason)),
        })
    }
}

fn refusal(frame: &Frame) -> RefusalKind {
    if frame.protocol.is_modbus() {
        // Address, function, code and CRC stand at the end, whatever stands before them; over TCP without a CRC.
        let end = if frame.protocol == crate::protocol::Protocol::ModbusTcp { 1 } else { 3 };
        let code = frame.bytes.len().checked_sub(end).and_then(|at| frame.bytes.get(at));
        return RefusalKind::Exception(code.copied().unwrap_or_default());
    }
    if frame.bytes.contains(&b'?') { RefusalKind::Dcon } else { RefusalKind::Ignored }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reasons_of_judge_and_protocols_are_told_apart() {
        for (reason, kind) in [
            ("the answer was cut short", FailureKind::CutShort),
            ("the answer has 3 bytes, too few for a Modbus frame", FailureKind::CutShort),
            ("the answer is too short to carry a checksum", FailureKind::CutShort),
            ("wrong CRC: 0101 was received, CDFA is right", FailureKind::WrongCheck),
            ("wrong checksum: 00 was received, B7 is right", FailureKind::WrongCheck),
            ("the answer comes from address 2 instead of 1", FailureKind::WrongAddress),
            ("!02PIR130 does not come from address 01h", FailureKind::WrongAddress),
            ("what came back differs from what was sent: two stations sent at once", FailureKind::Collision),
            ("only stray bytes came back: line noise", FailureKind::StrayBytes),
            ("no DCON answer is in it", FailureKind::Garbage),
        ] {
            assert_eq!(FailureKind::of_reason(reason), kind, "{reason}");
        }
    }
}
