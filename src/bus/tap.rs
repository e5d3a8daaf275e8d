//! Every byte sent and received, with its time.

use std::time::{Duration, Instant};

use jiff::{SignedDuration, Timestamp};

use crate::protocol::{Failure, LineSettings, Protocol, dcon};

/// Which way bytes went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Sent,
    Received,
}

/// What became of the bytes, or of the request they were expected on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    Request,
    /// A whole, verified answer from the module that was asked, perhaps with its request's echo or stray bytes around it.
    Answer,
    /// The module said no: `?AA`, a lone `!`, an exception.
    Refusal,
    /// What came back cannot be used; the reason in words.
    Broken(String),
    /// Nothing came back. If there are bytes, they are the adapter's echo of the request.
    Silent,
}

/// Bytes that belong together: one request, or what came back on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// When the first byte was handed over, when the last byte had arrived, or when the wait for it was given up.
    pub at: Timestamp,
    pub direction: Direction,
    /// All that was on the line, echo and stray bytes included; empty if no answer came.
    pub bytes: Vec<u8>,
    pub protocol: Protocol,
    /// Speed and format on the wire at that time; without meaning over TCP.
    pub settings: LineSettings,
    /// The module spoken to. `None` for a broadcast and for bytes that belong to no request.
    pub address: Option<u8>,
    /// Whether DCON commands and answers carry a checksum.
    pub checksum: bool,
    /// Sent: how long the frame occupies the wire (nothing over TCP). Received: from the end of the request to the last
    /// byte, or to giving up.
    pub took: Duration,
    pub verdict: Verdict,
}

/// The part of a frame that an exchange's request and its answer have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exchange {
    pub protocol: Protocol,
    pub settings: LineSettings,
    pub address: Option<u8>,
    pub checksum: bool,
}

impl Exchange {
    pub fn request(self, at: Timestamp, bytes: Vec<u8>, took: Duration) -> Frame {
        self.frame(at, Direction::Sent, bytes, took, Verdict::Request)
    }

    pub fn answer(self, at: Timestamp, bytes: Vec<u8>, took: Duration, verdict: Verdict) -> Frame {
        self.frame(at, Direction::Received, bytes, took, verdict)
    }

    /// How the exchange ended.
    pub fn verdict(self, outcome: Result<&[u8], &Failure>) -> Verdict {
        match outcome {
            Ok(answer) if self.is_refusal(answer) => Verdict::Refusal,
            Ok(_) => Verdict::Answer,
            Err(Failure::Silent) => Verdict::Silent,
            Err(failure) if failure.is_refusal() => Verdict::Refusal,
            // The bytes stand in the frame.
            Err(Failure::Garbled { reason, .. }) => Verdict::Broken(reason.clone()),
            Err(Failure::Cut { .. }) => Verdict::Broken("the answer was cut short".to_owned()),
            Err(Failure::Collision { .. }) => {
                Verdict::Broken("what came back differs from what was sent: two stations sent at once".to_owned())
            }
            Err(failure) => Verdict::Broken(failure.to_string()),
        }
    }

    fn is_refusal(self, answer: &[u8]) -> bool {
        match self.protocol {
            Protocol::Dcon => {
                let said = dcon::decode(answer, self.checksum);
                matches!(said, Ok(dcon::Answer::Refused { .. } | dcon::Answer::Ignored))
            }
            Protocol::ModbusRtu | Protocol::ModbusTcp => answer.get(1).is_some_and(|code| code & 0x80 != 0),
        }
    }

    fn frame(self, at: Timestamp, direction: Direction, bytes: Vec<u8>, took: Duration, verdict: Verdict) -> Frame {
        let Self { protocol, settings, address, checksum } = self;
        Frame { at, direction, bytes, protocol, settings, address, checksum, took, verdict }
    }
}

/// Turns the line's clock into UTC without ever going back, even if the system's clock is set while it runs.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    wall: Timestamp,
    line: Instant,
}

impl Clock {
    /// The line's clock shows `line` now.
    pub fn starting(line: Instant) -> Self {
        Self { wall: Timestamp::now(), line }
    }

    pub fn stamp(&self, instant: Instant) -> Timestamp {
        let elapsed = instant.saturating_duration_since(self.line);
        let elapsed = SignedDuration::try_from(elapsed).unwrap_or(SignedDuration::MAX);
        self.wall.saturating_add(elapsed).unwrap_or(self.wall)
    }
}

/// Where frames go.
pub type Tap = Box<dyn FnMut(Frame) + Send>;
