//! The wire as the transaction sees it: bytes out, bytes in, and the clock they are timed by.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use crate::protocol::LineSettings;

/// An operating system wakes a sleeper late; the end of a wait is watched instead, so that pauses of a millisecond or
/// two between frames do not grow by a tenth.
const WATCHED: Duration = Duration::from_micros(150);

/// Sleeps until `instant`, exactly to some microseconds where the system lets the thread run.
pub fn sleep_until(instant: Instant) {
    let asleep = instant.saturating_duration_since(Instant::now()).saturating_sub(WATCHED);
    if !asleep.is_zero() {
        std::thread::sleep(asleep);
    }
    while Instant::now() < instant {
        std::thread::yield_now();
    }
}

/// The line itself failed, not the module at its end: the port is gone and has to be opened again.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the line was lost: {reason}")]
pub struct LineLost {
    pub reason: String,
}

impl LineLost {
    pub fn new(reason: impl ToString) -> Self {
        Self { reason: reason.to_string() }
    }
}

/// A half-duplex serial line, real or simulated.
///
/// All times are of the line's own clock ([`Line::now`]), so that a simulated line can let time pass without waiting.
pub trait Line: Send {
    /// Changes speed and format in place; bytes received before are dropped.
    fn configure(&mut self, settings: LineSettings) -> Result<(), LineLost>;

    /// From now on nobody waits for a port that takes no bytes while `hurry` is set.
    fn hurry_by(&mut self, _hurry: Arc<AtomicBool>) {}

    /// Hands `bytes` over and returns without waiting for the last bit.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost>;

    /// Waits until `deadline` for at least one byte and returns how many were put into `buffer`; 0 when none came.
    /// A deadline that has passed still returns what has arrived already.
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost>;

    /// Drops what has arrived and was not received.
    fn purge(&mut self) -> Result<(), LineLost>;

    /// Whether the port is still there; cheap enough for once a second.
    fn look(&mut self) -> Result<(), LineLost>;

    /// The line's clock.
    fn now(&self) -> Instant;

    /// What the system's clock shows; unlike the line's it can jump.
    fn wall(&self) -> Timestamp {
        Timestamp::now()
    }

    /// Lets the time pass until `instant`; returns at once if it has passed.
    fn wait_until(&mut self, instant: Instant);
}
