//! Every byte sent and received, with its time.

use std::time::{Duration, Instant};

use jiff::{SignedDuration, Timestamp};

use crate::protocol::{Failure, LineSettings, Protocol, dcon};

/// The reason that stands with bytes that belong to no request.
pub const UNASKED: &str = "bytes that belong to no request";

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
    /// Received: from the end of the request to the first byte that is neither echo nor noise. `None` if there was none.
    pub first_byte: Option<Duration>,
    /// Received: the request's echo stands before the answer.
    pub echo: bool,
    /// Received: stray bytes stand around the answer.
    pub noise: bool,
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

    /// What came while nobody was asked, or when the answer had come already.
    pub fn unasked(self, at: Timestamp, bytes: Vec<u8>) -> Frame {
        let nobodys = Self { address: None, ..self };
        nobodys.answer(at, bytes, Duration::ZERO, Verdict::Broken(UNASKED.to_owned()))
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
        Frame {
            at,
            direction,
            bytes,
            protocol,
            settings,
            address,
            checksum,
            took,
            first_byte: None,
            echo: false,
            noise: false,
            verdict,
        }
    }
}

/// The system's clock can be ahead of the line's by so much before the line's is put forward: more than the two drift
/// apart in days. The line's clock stands still while the computer sleeps.
const MOST_BEHIND: SignedDuration = SignedDuration::from_secs(2);

/// Turns the line's clock into UTC without ever going back, even if the system's clock is set while it runs.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    wall: Timestamp,
    line: Instant,
}

impl Clock {
    /// The line's clock shows `line` while the system's shows `wall`.
    pub fn starting(line: Instant, wall: Timestamp) -> Self {
        Self { wall, line }
    }

    /// Stamps nothing earlier than `floor` from now on, `line` being the line's time now.
    pub fn not_before(&mut self, floor: Timestamp, line: Instant) {
        if self.stamp(line) < floor {
            *self = Self { wall: floor, line };
        }
    }

    /// Moves forward to the system's clock if that is far ahead, because the computer slept or its clock was set. It
    /// never moves back: after a system's clock was put back, and on a simulated line that runs ahead, it goes on.
    pub fn follow(&mut self, line: Instant, wall: Timestamp) {
        if wall.duration_since(self.stamp(line)) > MOST_BEHIND {
            *self = Self { wall, line };
        }
    }

    pub fn stamp(&self, instant: Instant) -> Timestamp {
        let elapsed = instant.saturating_duration_since(self.line);
        let elapsed = SignedDuration::try_from(elapsed).unwrap_or(SignedDuration::MAX);
        self.wall.saturating_add(elapsed).unwrap_or(self.wall)
    }
}

/// Where frames go.
pub type Tap = Box<dyn FnMut(Frame) + Send>;

#[cfg(test)]
mod tests {
    use super::*;

    const WALL: Timestamp = Timestamp::constant(1_772_443_800, 0);

    fn clock() -> (Clock, Instant) {
        let line = Instant::now();
        (Clock::starting(line, WALL), line)
    }

    fn seconds(seconds: i64) -> SignedDuration {
        SignedDuration::from_secs(seconds)
    }

    #[test]
    fn a_clock_that_was_put_back_does_not_take_the_line_along() {
        let (mut clock, line) = clock();
        let later = line + Duration::from_secs(10);
        clock.follow(later, WALL - seconds(3_600));
        assert_eq!(clock.stamp(later), WALL + seconds(10));
    }

    #[test]
    fn after_a_sleep_the_line_shows_the_time_of_day() {
        let (mut clock, line) = clock();
        let awake = line + Duration::from_secs(10);
        clock.follow(awake, WALL + seconds(7_200));
        assert_eq!(clock.stamp(awake), WALL + seconds(7_200));
        assert_eq!(clock.stamp(awake + Duration::from_secs(1)), WALL + seconds(7_201));
        assert_eq!(clock.stamp(line), WALL + seconds(7_200), "what is stamped afterwards is never earlier");
    }

    #[test]
    fn small_differences_between_the_clocks_move_nothing() {
        let (mut clock, line) = clock();
        let later = line + Duration::from_secs(10);
        clock.follow(later, WALL + seconds(12));
        assert_eq!(clock.stamp(later), WALL + seconds(10));
    }

    #[test]
    fn a_simulated_line_that_runs_ahead_is_left_alone() {
        let (mut clock, line) = clock();
        let ahead = line + Duration::from_secs(86_400);
        clock.follow(ahead, WALL + seconds(1));
        assert_eq!(clock.stamp(ahead), WALL + seconds(86_400));
    }

    #[test]
    fn a_line_opened_later_begins_no_earlier_than_the_one_before_ended() {
        let (mut clock, line) = clock();
        clock.not_before(WALL + seconds(3_600), line);
        assert_eq!(clock.stamp(line), WALL + seconds(3_600));
        assert_eq!(clock.stamp(line + Duration::from_secs(5)), WALL + seconds(3_605));
        clock.not_before(WALL, line);
        assert_eq!(clock.stamp(line), WALL + seconds(3_600));
    }
}
