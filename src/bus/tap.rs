//! Every byte sent and received, with its time.

use std::time::Instant;

use jiff::{SignedDuration, Timestamp};

/// Which way bytes went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Sent,
    Received,
}

/// Bytes that belong together: one request, or what came back on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// When the first byte was handed over, or when the last byte had arrived.
    pub at: Timestamp,
    pub direction: Direction,
    pub bytes: Vec<u8>,
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
