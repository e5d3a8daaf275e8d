//! One exchange on a half-duplex line: request out, verified answer back, and the line left quiet.
//!
//! The contract: an answer is returned only if it is whole, carries the right checksum or CRC and comes from the module
//! that was asked. Whatever else arrives is dropped, and after any failure with bytes on the line nothing is sent until
//! the line has been quiet, so that a late answer cannot be taken for the next one.

use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::judge::{self, Expected, Verdict};
use super::line::{Line, LineLost};
use super::tap::{self, Clock, Exchange, Tap};
use crate::protocol::{AnswerFrom, Failure, LineSettings};

/// Quiet that ends a disturbance, unless 3.5 characters last longer; covers the 16 ms of common USB adapters.
pub const SETTLE: Duration = Duration::from_millis(20);
/// Allowed between two bytes of one answer beyond the characters' own time; covers the latency of USB adapters.
const BYTE_GAP: Duration = Duration::from_millis(30);
/// How long after a missed answer the same address is left alone, so that a late answer finds nobody waiting.
const LATE_GUARD: Duration = Duration::from_millis(100);
/// More than any answer of any module; a line that babbles on is not listened to for ever.
const MOST_BYTES: usize = 1024;
/// Characters of the longest Modbus frame.
const LONGEST_ANSWER: usize = 256;
/// A babbling line is given up on after so long.
const MOST_SETTLING: Duration = Duration::from_secs(1);

impl From<LineLost> for Failure {
    fn from(lost: LineLost) -> Self {
        Self::LineLost(lost.reason)
    }
}

/// Whose answer may still come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Missed {
    rtu: bool,
    /// `None` if the request did not tell whom it asked.
    address: Option<u8>,
}

impl Missed {
    fn of(expected: &Expected) -> Self {
        Self { rtu: matches!(expected, Expected::Rtu { .. }), address: expected.address() }
    }

    /// Whether an answer to this could be taken for one to `other`.
    fn resembles(self, other: Self) -> bool {
        self.rtu == other.rtu && (self.address == other.address || self.address.is_none() || other.address.is_none())
    }
}

/// The module that `request` speaks to; `None` for all of them.
fn spoken_to(request: &[u8], expected: &Expected) -> Option<u8> {
    match expected {
        Expected::Nothing { .. } => None,
        Expected::Dcon { from: AnswerFrom::Anyone, .. } => {
            let digits = request.get(1..3).and_then(|digits| std::str::from_utf8(digits).ok())?;
            u8::from_str_radix(digits, 16).ok()
        }
        expected => expected.address(),
    }
}

/// A line, and what has to be remembered of it between two exchanges.
pub struct Wire {
    line: Box<dyn Line>,
    settings: LineSettings,
    clock: Clock,
    tap: Tap,
    /// When the last byte was on the line, as far as known.
    last_activity: Instant,
    /// Something unexpected was on the line: let it settle before the next request.
    disturbed: bool,
    /// The adapter sends back what is sent.
    echoes: bool,
    /// Address of the last request that stayed without answer, and until when an answer may still come.
    missed: Option<(Missed, Instant)>,
    /// From the end of the last answered request to the first byte of its answer.
    answer_time: Option<Duration>,
    /// When the last exchange was over; `None` if the line failed before.
    ended: Option<Instant>,
}

impl Wire {
    pub fn new(mut line: Box<dyn Line>, settings: LineSettings, tap: Tap) -> Result<Self, LineLost> {
        line.configure(settings)?;
        let now = line.now();
        let clock = Clock::starting(now, line.wall());
        Ok(Self {
            line,
            settings,
            clock,
            tap,
            last_activity: now,
            disturbed: false,
            echoes: false,
            missed: None,
            answer_time: None,
            ended: None,
        })
    }

    pub fn settings(&self) -> LineSettings {
        self.settings
    }

    /// Whether the adapter was seen to echo.
    pub fn echoes(&self) -> bool {
        self.echoes
    }

    /// What the line was known for before it was opened anew.
    pub fn expect_echoes(&mut self, echoes: bool) {
        self.echoes = echoes;
    }

    pub fn clock(&self) -> Clock {
        self.clock
    }

    pub fn keep_clock(&mut self, clock: Clock) {
        self.clock = clock;
    }

    /// Stamps nothing earlier than `floor` from now on.
    pub fn not_before(&mut self, floor: Timestamp) {
        self.clock.not_before(floor, self.line.now());
    }

    /// Whether the port is still there.
    pub fn look(&mut self) -> Result<(), LineLost> {
        self.line.look()
    }

    pub fn answer_time(&self) -> Option<Duration> {
        self.answer_time
    }

    pub fn now(&self) -> Instant {
        self.line.now()
    }

    /// The time of now in UTC, by the line's clock.
    pub fn timestamp(&self) -> Timestamp {
        self.clock.stamp(self.line.now())
    }

    /// When the last byte of the last answer had arrived, or when the wait for it was given up.
    pub fn ended_at(&self) -> Timestamp {
        self.clock.stamp(self.ended.unwrap_or_else(|| self.line.now()))
    }

    /// Changes speed and format in place. True if they were others before.
    pub fn configure(&mut self, settings: LineSettings) -> Result<bool, LineLost> {
        if settings == self.settings {
            return Ok(false);
        }
        self.line.configure(settings)?;
        self.settings = settings;
        self.missed = None;
        // Adapters lose what follows a change of speed too closely.
        let settled = self.line.now() + SETTLE;
        self.line.wait_until(settled);
        self.line.purge()?;
        Ok(true)
    }

    /// Sends `request` and returns the verified answer, without echo and noise. `window` runs from the request's last
    /// bit to the answer's first byte.
    pub fn exchange(&mut self, request: &[u8], expected: &Expected, window: Duration) -> Result<Vec<u8>, Failure> {
        self.ended = None;
        self.clock.follow(self.line.now(), self.line.wall());
        self.become_quiet(expected)?;
        self.line.purge()?;
        let started = self.line.now();
        self.line.send(request)?;
        let (protocol, checksum) = expected.language();
        let address = spoken_to(request, expected);
        let exchange = Exchange { protocol, settings: self.settings, address, checksum };
        let wire_time = self.settings.wire_time(request.len());
        (self.tap)(exchange.request(self.clock.stamp(started), request.to_vec(), wire_time));
        let sent = started + wire_time;
        self.last_activity = sent;
        if matches!(expected, Expected::Nothing { .. }) {
            self.line.wait_until(sent);
            self.ended = Some(sent);
            return Ok(Vec::new());
        }
        let mut received = Vec::new();
        let outcome = self.listen(request, expected, sent, window, &mut received);
        let verdict = exchange.verdict(outcome.as_deref());
        let nothing_came = verdict == tap::Verdict::Silent || received.is_empty();
        let ended = if nothing_came { self.line.now() } else { self.last_activity };
        self.ended = Some(ended);
        let took = ended.saturating_duration_since(sent);
        (self.tap)(exchange.answer(self.clock.stamp(ended), received, took, verdict));
        self.remember(&outcome, Missed::of(expected));
        outcome
    }

    fn listen(
        &mut self,
        request: &[u8],
        expected: &Expected,
        sent: Instant,
        window: Duration,
        received: &mut Vec<u8>,
    ) -> Result<Vec<u8>, Failure> {
        let first_deadline = sent + window;
        let give_up = first_deadline + self.settings.wire_time(LONGEST_ANSWER) + MOST_SETTLING;
        let mut deadline = first_deadline;
        let mut first_byte = None;
        let mut buffer = [0; 256];
        loop {
            let count = self.line.receive(&mut buffer, deadline)?;
            let verdict = if count == 0 {
                judge::after_silence(request, expected, received, self.echoes)
            } else {
                self.last_activity = self.line.now();
                received.extend(buffer.iter().take(count));
                judge::so_far(request, expected, received, self.echoes)
            };
            match verdict {
                Verdict::Answer { bytes, echo, noise } => {
                    self.echoes |= echo;
                    self.disturbed |= noise;
                    let first = first_byte.unwrap_or(self.last_activity);
                    self.answer_time = Some(first.saturating_duration_since(sent));
                    return Ok(bytes);
                }
                Verdict::Failed(failure) => return Err(failure),
                Verdict::NothingYet => deadline = first_deadline,
                Verdict::More => {
                    first_byte.get_or_insert(self.last_activity);
                    // Bytes of others may come first, so the window stays open.
                    let next_byte = self.last_activity + BYTE_GAP + self.settings.wire_time(2);
                    deadline = next_byte.max(first_deadline);
                }
            }
            if received.len() > MOST_BYTES || self.last_activity > give_up {
                let reason = "the line does not stop sending".to_owned();
                return Err(Failure::Garbled { reason, bytes: received.iter().copied().take(64).collect() });
            }
        }
    }

    fn remember(&mut self, outcome: &Result<Vec<u8>, Failure>, asked: Missed) {
        match outcome {
            Ok(_) => self.missed = self.missed.filter(|(missed, _)| !missed.resembles(asked)),
            Err(Failure::Silent) => self.missed = Some((asked, self.line.now() + LATE_GUARD)),
            Err(_) => self.disturbed = true,
        }
    }

    /// Waits until a request may be sent without running into anything.
    fn become_quiet(&mut self, expected: &Expected) -> Result<(), LineLost> {
        if self.disturbed {
            self.settle(expected)?;
        }
        if let Some((missed, until)) = self.missed
            && missed.resembles(Missed::of(expected))
        {
            self.line.wait_until(until);
        }
        if matches!(expected, Expected::Rtu { .. }) {
            self.line.wait_until(self.last_activity + self.settings.frame_silence());
        }
        Ok(())
    }

    /// Drops everything until the line has been quiet for [`SETTLE`] or 3.5 characters.
    fn settle(&mut self, expected: &Expected) -> Result<(), LineLost> {
        let quiet = SETTLE.max(self.settings.frame_silence());
        let give_up = self.line.now() + MOST_SETTLING;
        let mut buffer = [0; 256];
        let mut dropped = Vec::new();
        loop {
            let deadline = self.last_activity + quiet;
            let count = self.line.receive(&mut buffer, deadline)?;
            if count == 0 {
                break;
            }
            self.last_activity = self.line.now();
            dropped.extend(buffer.iter().take(count));
            if self.last_activity > give_up {
                break;
            }
        }
        if !dropped.is_empty() {
            dropped.truncate(MOST_BYTES);
            let (protocol, checksum) = expected.language();
            let nobodys = Exchange { protocol, settings: self.settings, address: None, checksum };
            let verdict = tap::Verdict::Broken("bytes that belong to no request".to_owned());
            (self.tap)(nobodys.answer(self.clock.stamp(self.last_activity), dropped, Duration::ZERO, verdict));
        }
        self.disturbed = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::sync::{Arc, Mutex};

    use super::*;
    use crate::protocol::{AnswerFrom, Protocol, hex, modbus};

    const WINDOW: Duration = Duration::from_millis(60);
    const REQUEST: &[u8] = &[1, 3, 0, 0, 0, 1];

    /// A line that plays what the test wrote down: after each request, bytes at times counted from its sending.
    struct Scripted {
        now: Instant,
        answers: VecDeque<Vec<(u64, Vec<u8>)>>,
        incoming: VecDeque<(Instant, Vec<u8>)>,
        sent: Arc<Mutex<Vec<Instant>>>,
    }

    impl Line for Scripted {
        fn configure(&mut self, _: LineSettings) -> Result<(), LineLost> {
            Ok(())
        }

        fn send(&mut self, _: &[u8]) -> Result<(), LineLost> {
            self.sent.lock().unwrap().push(self.now);
            let answers = self.answers.pop_front().expect("no further request was expected");
            let at = |ms| self.now + Duration::from_millis(ms);
            self.incoming.extend(answers.into_iter().map(|(ms, bytes)| (at(ms), bytes)));
            self.incoming.make_contiguous().sort();
            Ok(())
        }

        fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
            match self.incoming.front() {
                Some((at, _)) if *at <= deadline => {
                    let (at, bytes) = self.incoming.pop_front().unwrap();
                    self.now = self.now.max(at);
                    buffer[..bytes.len()].copy_from_slice(&bytes);
                    Ok(bytes.len())
                }
                _ => {
                    self.now = self.now.max(deadline);
                    Ok(0)
                }
            }
        }

        fn purge(&mut self) -> Result<(), LineLost> {
            let now = self.now;
            self.incoming.retain(|(at, _)| *at > now);
            Ok(())
        }

        fn look(&mut self) -> Result<(), LineLost> {
            Ok(())
        }

        fn now(&self) -> Instant {
            self.now
        }

        fn wait_until(&mut self, instant: Instant) {
            self.now = self.now.max(instant);
        }
    }

    fn wire(answers: &[&[(u64, &[u8])]]) -> (Wire, Arc<Mutex<Vec<Instant>>>) {
        let sent = Arc::<Mutex<Vec<Instant>>>::default();
        let script = answers.iter().map(|answer| answer.iter().map(|(ms, bytes)| (*ms, bytes.to_vec())).collect());
        let line =
            Scripted { now: Instant::now(), answers: script.collect(), incoming: VecDeque::new(), sent: sent.clone() };
        (Wire::new(Box::new(line), LineSettings::default(), Box::new(|_| {})).unwrap(), sent)
    }

    fn ask(wire: &mut Wire) -> Result<Vec<u8>, Failure> {
        wire.exchange(&modbus::with_crc(REQUEST), &Expected::Rtu { address: 1 }, WINDOW)
    }

    fn answer(value: u8) -> Vec<u8> {
        modbus::with_crc(&[1, 3, 2, 0, value])
    }

    #[test]
    fn silence_costs_the_requests_wire_time_and_one_window_and_nothing_before_the_next_address() {
        let (mut wire, sent) = wire(&[&[], &[]]);
        assert_eq!(ask(&mut wire), Err(Failure::Silent));
        let other = modbus::with_crc(&[2, 3, 0, 0, 0, 1]);
        let _ = wire.exchange(&other, &Expected::Rtu { address: 2 }, WINDOW);
        let sent = sent.lock().unwrap();
        assert_eq!(sent[1] - sent[0], WINDOW + LineSettings::default().wire_time(8));
    }

    #[test]
    fn a_late_answer_is_not_taken_for_the_next_request_of_the_same_shape() {
        let (late, right) = (answer(1), answer(2));
        let (mut wire, _) = wire(&[&[(100, &late)], &[(20, &right)]]);
        assert_eq!(ask(&mut wire), Err(Failure::Silent));
        assert_eq!(ask(&mut wire), Ok(right));
    }

    #[test]
    fn an_answer_of_another_module_does_not_end_the_wait_for_a_late_one() {
        let neighbour = modbus::with_crc(&[2, 3, 2, 0, 9]);
        let (late, right) = (answer(1), answer(2));
        let (mut wire, _) = wire(&[&[(130, &late)], &[(20, &neighbour)], &[(30, &right)]]);
        assert_eq!(ask(&mut wire), Err(Failure::Silent));
        let other = modbus::with_crc(&[2, 3, 0, 0, 0, 1]);
        assert_eq!(wire.exchange(&other, &Expected::Rtu { address: 2 }, WINDOW), Ok(neighbour));
        assert_eq!(ask(&mut wire), Ok(right));
    }

    #[test]
    fn a_stray_byte_does_not_shorten_the_window() {
        let right = answer(6);
        let (mut wire, _) = wire(&[&[(9, &[0x40]), (62, &right)]]);
        assert_eq!(ask(&mut wire), Ok(right));
    }

    #[test]
    fn an_answer_in_two_pieces_is_whole_and_one_that_stops_is_cut() {
        let whole = answer(7);
        let (first, second) = whole.split_at(3);
        let (mut wire, _) = wire(&[&[(20, first), (45, second)], &[(20, first)]]);
        assert_eq!(ask(&mut wire), Ok(whole.clone()));
        assert_eq!(ask(&mut wire), Err(Failure::Cut { bytes: first.to_vec() }));
    }

    #[test]
    fn after_garbage_nothing_is_sent_until_the_line_is_quiet() {
        let garbage = [0x55; 7];
        let right = answer(3);
        let (mut wire, sent) = wire(&[&[(20, &garbage), (45, &garbage), (70, &garbage)], &[(20, &right)]]);
        assert!(ask(&mut wire).unwrap_err().is_garbage());
        assert_eq!(ask(&mut wire), Ok(right));
        let sent = sent.lock().unwrap();
        assert!(sent[1] - sent[0] >= Duration::from_millis(70) + SETTLE, "{:?}", sent[1] - sent[0]);
    }

    #[test]
    fn modbus_frames_are_kept_apart_by_three_and_a_half_characters() {
        let right = answer(4);
        let (mut wire, sent) = wire(&[&[(20, &right)], &[(20, &right)]]);
        ask(&mut wire).unwrap();
        ask(&mut wire).unwrap();
        let sent = sent.lock().unwrap();
        let gap = sent[1] - sent[0] - Duration::from_millis(20);
        assert_eq!(gap, LineSettings::default().frame_silence());
    }

    #[test]
    fn an_echoing_adapter_is_learned_from_reads_and_does_not_spoil_writes() {
        let (read, write) = (modbus::with_crc(REQUEST), modbus::with_crc(&[1, 6, 2, 0, 0, 10]));
        let right = answer(5);
        let echoed = [read.clone(), right.clone()].concat();
        let twice = write.repeat(2);
        let (mut wire, _) = wire(&[&[(20, &echoed)], &[(9, &twice[..8]), (20, &twice[8..])]]);
        assert_eq!(ask(&mut wire), Ok(right));
        assert!(wire.echoes());
        assert_eq!(wire.exchange(&write, &Expected::Rtu { address: 1 }, WINDOW), Ok(write.clone()));
    }

    #[test]
    fn a_broadcast_waits_for_no_answer() {
        let (mut wire, sent) = wire(&[&[], &[]]);
        let broadcast = Expected::Nothing { protocol: Protocol::Dcon, checksum: false };
        wire.exchange(b"~**\r", &broadcast, WINDOW).unwrap();
        wire.exchange(b"~**\r", &broadcast, WINDOW).unwrap();
        let sent = sent.lock().unwrap();
        assert_eq!(sent[1] - sent[0], LineSettings::default().wire_time(4));
    }

    #[test]
    fn an_answer_of_a_neighbour_is_passed_over_while_the_right_one_is_awaited() {
        let expected = Expected::Dcon { checksum: false, from: AnswerFrom::Addresses(vec![1]) };
        let (mut wire, _) = wire(&[&[(10, b"!02PIR130\r"), (40, b"!01PIR234\r")]]);
        let answer = wire.exchange(b"$01M\r", &expected, WINDOW).unwrap();
        assert_eq!(hex::escaped(&answer), "!01PIR234");
    }
}
