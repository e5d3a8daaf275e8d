//! One exchange on a half-duplex line: request out, verified answer back, and the line left quiet.
//!
//! The contract: an answer is returned only if it is whole, carries the right checksum or CRC and comes from the module
//! that was asked. Whatever else arrives is dropped, and after any failure with bytes on the line nothing is sent until
//! the line has been quiet, so that a late answer cannot be taken for the next one.

mod debts;
mod quiet;
mod shape;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::judge::{self, Content, Expected, Verdict};
use super::line::{Line, LineLost};
use super::name::asks_for_name;
use super::tap::{self, Clock, Exchange, Frame, Tap};
use crate::protocol::{Failure, LineSettings, dcon};
use shape::want_equally_much;

pub(super) use debts::Debts;
pub use shape::Shape;

/// Quiet that ends a disturbance, unless 3.5 characters last longer; covers the 16 ms of common USB adapters.
pub const SETTLE: Duration = Duration::from_millis(20);
/// Allowed between two bytes of one answer beyond the characters' own time; covers the latency of USB adapters.
const BYTE_GAP: Duration = Duration::from_millis(30);
/// Quiet that is waited for while answers come more than once; longer than modules differ in their response delays
/// (0 to 30 ms, PIR-234 manual 5.24) and adapters in their latency.
const WARY_QUIET: Duration = Duration::from_millis(60);
/// Fewer bytes are not a spoiled answer: the answer itself may still come.
const LEAST_ANSWER: usize = 4;
/// More than any answer of any module; a line that babbles on is not listened to for ever.
const MOST_BYTES: usize = 1024;
/// Characters of the longest Modbus frame.
const LONGEST_ANSWER: usize = 256;
/// A babbling line is given up on after so long.
const MOST_SETTLING: Duration = Duration::from_millis(300);

impl From<LineLost> for Failure {
    fn from(lost: LineLost) -> Self {
        Self::LineLost(lost.reason)
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
    /// Answers that may still come.
    debts: Debts,
    /// The last question that was answered.
    answered: Option<(Shape, Vec<u8>)>,
    /// Questions whose answer could be a second one to the question before, and which nothing has cleared up yet.
    doubtful: Vec<Shape>,
    /// Questions of which it has shown that their answers were out of step.
    spoiled: Vec<Shape>,
    /// Until when answers that come twice are expected.
    wary_until: Option<Instant>,
    hurry: Arc<AtomicBool>,
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
        let mut debts = Debts::default();
        debts.configure(settings);
        Ok(Self {
            line,
            settings,
            clock,
            tap,
            last_activity: now,
            disturbed: false,
            echoes: false,
            debts,
            answered: None,
            doubtful: Vec::new(),
            spoiled: Vec::new(),
            wary_until: None,
            hurry: Arc::default(),
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

    /// Answers that may still come although the line is given up.
    pub(in crate::bus) fn into_debts(self) -> Debts {
        self.debts
    }

    /// What was owed on this line before it was lost.
    pub(in crate::bus) fn keep_debts(&mut self, debts: Debts) {
        self.debts = debts;
        self.debts.configure(self.settings);
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
        self.debts.configure(settings);
        // Adapters lose what follows a change of speed too closely.
        let settled = self.line.now() + SETTLE;
        self.line.wait_until(settled);
        self.line.purge()?;
        // What came meanwhile was not heard.
        self.spoil_doubtful();
        Ok(true)
    }

    /// Questions whose answers may still come and could be taken for that to `shape`.
    pub fn owed(&self, shape: Shape) -> Vec<Shape> {
        self.debts.shapes(shape, self.line.now())
    }

    /// Whoever was asked with `shape` has shown that no answer to it was taken for another's.
    pub fn clear_up(&mut self, shape: Shape) {
        self.doubtful.retain(|doubtful| !doubtful.asks_whom(shape));
    }

    /// Waits for late answers end while `hurry` is set.
    pub fn hurry_by(&mut self, hurry: Arc<AtomicBool>) {
        self.line.hurry_by(hurry.clone());
        self.hurry = hurry;
    }

    /// What is not certain of the answers of the module that is asked with `shape`.
    pub fn doubts(&self, shape: Shape) -> Doubts {
        if self.spoiled.iter().any(|spoiled| spoiled.asks_whom(shape)) {
            return Doubts::Spoiled;
        }
        Doubts::Open(self.doubtful.iter().copied().filter(|doubtful| doubtful.asks_whom(shape)).collect())
    }

    /// Nothing is made of the answers that could belong to other questions.
    pub fn forget_doubts(&mut self, shape: Shape) {
        self.doubtful.retain(|doubtful| !doubtful.asks_whom(shape));
        self.spoiled.retain(|spoiled| !spoiled.asks_whom(shape));
    }

    /// Sends `request` and returns the verified answer, without echo and noise. `window` runs from the request's last
    /// bit to the answer's first byte. Waits until no answer to an earlier question can be taken for this one's.
    ///
    /// # Errors
    /// What came instead of an answer; [`Failure::NotSent`] if the wait before was cut short.
    pub fn exchange(&mut self, request: &[u8], expected: &Expected, window: Duration) -> Result<Vec<u8>, Failure> {
        let shape = Shape::of_request(request, expected);
        while let Some(until) = shape.and_then(|shape| self.debts.until(shape, request, self.line.now())) {
            self.wait_for_late(until, expected).map_err(Failure::kept_back)?;
        }
        let expected = self.passing_over_known_answers(shape, request, expected);
        self.speak_and_note(request, &expected, window).map(|(answer, _)| answer)
    }

    /// An answer that is known beforehand, and still owed to another question, is not the one to `request`.
    fn passing_over_known_answers(&self, shape: Option<Shape>, request: &[u8], expected: &Expected) -> Expected {
        let mut expected = expected.clone();
        if let (Expected::Dcon { content: content @ Content::Any, .. }, Some(shape)) = (&mut expected, shape)
            && !asks_for_name(request)
        {
            let known = self.debts.known_answers(shape, self.line.now());
            *content = if known.is_empty() { Content::Any } else { Content::NoneOf(known) };
        }
        expected
    }

    /// As [`Self::exchange`], but for a question whose answer can be told from all others: no other answer is waited for. True if
    /// other bytes came with it that may be an answer too.
    pub fn probe(&mut self, request: &[u8], expected: &Expected, window: Duration) -> Result<(Vec<u8>, bool), Failure> {
        // While the same question is under way, one more would only keep the module busy for longer.
        if let Some(until) = self.debts.under_way(request, window, self.line.now()) {
            self.wait_for_late(until, expected)?;
        }
        self.speak_and_note(request, expected, window)
    }

    fn speak_and_note(
        &mut self,
        request: &[u8],
        expected: &Expected,
        window: Duration,
    ) -> Result<(Vec<u8>, bool), Failure> {
        let Spoken { outcome, others, surplus, after_quiet, .. } = self.speak(request, expected, window);
        let now = self.line.now();
        if let Some(shape) = Shape::of_request(request, expected) {
            if let Ok(answer) = &outcome
                && self.debts.claim(shape, answer, now)
            {
                return Err(self.refuse(shape, request, expected, answer));
            }
            match &outcome {
                Ok(answer) => {
                    self.debts.answered(shape, request, expected, answer, now);
                    self.note_answer(shape, request, answer, surplus, after_quiet);
                }
                Err(failure) if leaves_answer_open(failure, shape, request, expected) => {
                    self.debts.note(shape, request, expected, now);
                }
                Err(_) => {}
            }
            if let Err(Failure::Garbled { bytes, .. } | Failure::Collision { bytes }) = &outcome {
                self.debts.seen(bytes, now);
            }
        }
        Ok((outcome?, others))
    }

    /// The answer is another module's, late; that to `request` may still come.
    fn refuse(&mut self, shape: Shape, request: &[u8], expected: &Expected, answer: &[u8]) -> Failure {
        let now = self.line.now();
        self.debts.seen(&[answer, b"\r"].concat(), now);
        self.debts.note(shape, request, expected, now);
        self.disturbed = true;
        let reason = "the answer is that of another module, which was asked before".to_owned();
        Failure::Garbled { reason, bytes: answer.to_vec() }
    }

    /// An answer that could as well be a second one to the question before is remembered as doubtful; one that cannot be
    /// mistaken and comes alone shows that those before it were in step.
    fn note_answer(&mut self, shape: Shape, request: &[u8], answer: &[u8], surplus: bool, after_quiet: bool) {
        if !surplus {
            self.doubtful.retain(|doubtful| !doubtful.asks_whom(shape) || doubtful.could_answer(shape));
        }
        let doubtful = self.answered.as_ref().is_some_and(|(before, asked)| {
            let alike = want_equally_much(asked, request) || shape.is_exception(answer);
            before.could_answer(shape) && asked != request && alike
        });
        // After so long a quiet no second answer was still to come.
        if doubtful && !after_quiet && !self.doubtful.contains(&shape) {
            self.doubtful.push(shape);
        }
        if surplus {
            self.spoil_doubtful();
        }
        self.answered = Some((shape, request.to_vec()));
    }

    /// An answer too many was on the line: it may be the right one to a question that has taken another's.
    fn spoil_doubtful(&mut self) {
        for shape in self.doubtful.drain(..) {
            if !self.spoiled.contains(&shape) {
                self.spoiled.push(shape);
            }
        }
    }

    /// One request and what came back on it.
    fn speak(&mut self, request: &[u8], expected: &Expected, window: Duration) -> Spoken {
        let mut spoken = Spoken {
            outcome: Err(Failure::Silent),
            sent: self.line.now(),
            first_byte: None,
            noise: false,
            others: false,
            surplus: false,
            after_quiet: false,
        };
        if let Err(lost) = self.speak_into(&mut spoken, request, expected, window) {
            spoken.outcome = Err(lost.into());
        }
        spoken
    }

    fn speak_into(
        &mut self,
        spoken: &mut Spoken,
        request: &[u8],
        expected: &Expected,
        window: Duration,
    ) -> Result<(), LineLost> {
        self.ended = None;
        self.clock.follow(self.line.now(), self.line.wall());
        // Nothing is dropped unseen: it could be what shows that an answer was taken for another.
        self.become_quiet(request, expected)?;
        let started = self.line.now();
        spoken.after_quiet = started.saturating_duration_since(self.last_activity) >= WARY_QUIET;
        self.line.send(request)?;
        let (protocol, checksum) = expected.language();
        let address = Shape::of_request(request, expected).and_then(Shape::address);
        let exchange = Exchange { protocol, settings: self.settings, address, checksum };
        let wire_time = self.settings.wire_time(request.len());
        (self.tap)(exchange.request(self.clock.stamp(started), request.to_vec(), wire_time));
        // A port that blocks takes the bytes later.
        spoken.sent = (started + wire_time).max(self.line.now());
        self.last_activity = spoken.sent;
        if matches!(expected, Expected::Nothing { .. }) {
            self.line.wait_until(spoken.sent);
            self.ended = Some(spoken.sent);
            spoken.outcome = Ok(Vec::new());
            return if self.echoes { self.take_off_echo(request, expected, exchange, spoken) } else { Ok(()) };
        }
        let mut received = Vec::new();
        spoken.outcome = self.listen(request, expected, window, spoken, &mut received);
        self.tell_answer(exchange, request, received, spoken);
        self.disturbed |= spoken.noise || spoken.outcome.as_ref().is_err_and(|failure| *failure != Failure::Silent);
        if spoken.surplus {
            self.become_wary();
            self.spoil_doubtful();
        }
        Ok(())
    }

    fn tell_answer(&mut self, exchange: Exchange, request: &[u8], received: Vec<u8>, spoken: &Spoken) {
        let verdict = exchange.verdict(spoken.outcome.as_deref());
        let nothing_came = verdict == tap::Verdict::Silent || received.is_empty();
        let ended = if nothing_came { self.line.now() } else { self.last_activity };
        self.ended = Some(ended);
        let took = ended.saturating_duration_since(spoken.sent);
        let echo = self.echoes && received.starts_with(request);
        let frame = exchange.answer(self.clock.stamp(ended), received, took, verdict);
        (self.tap)(Frame { first_byte: spoken.first_byte, echo, noise: spoken.noise, ..frame });
    }

    fn listen(
        &mut self,
        request: &[u8],
        expected: &Expected,
        window: Duration,
        spoken: &mut Spoken,
        received: &mut Vec<u8>,
    ) -> Result<Vec<u8>, Failure> {
        let mut first_deadline = spoken.sent + window;
        let give_up = first_deadline + self.settings.wire_time(LONGEST_ANSWER) + MOST_SETTLING;
        let mut deadline = first_deadline;
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
            let since_sent = self.last_activity.saturating_duration_since(spoken.sent);
            match verdict {
                Verdict::Answer { bytes, echo, noise, surplus } => {
                    self.learn_echo(request, expected, echo, surplus);
                    let heard = received.get(if echo { request.len() } else { 0 }..).unwrap_or_default();
                    (spoken.noise, spoken.others) = (noise, surplus);
                    spoken.surplus = surplus && !self.were_owed(expected, heard, &bytes);
                    self.answer_time = Some(*spoken.first_byte.get_or_insert(since_sent));
                    return Ok(bytes);
                }
                Verdict::Failed(failure) => {
                    spoken.noise = failure.is_garbage() && spoken.first_byte.is_none();
                    return Err(failure);
                }
                Verdict::NothingYet => deadline = first_deadline,
                Verdict::PassedOver => {
                    spoken.first_byte = None;
                    first_deadline = self.last_activity + window;
                    deadline = first_deadline;
                }
                Verdict::More => {
                    spoken.first_byte.get_or_insert(since_sent);
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

    /// Whether what was passed over before `answer` is owed to earlier questions, and nothing else came with it.
    fn were_owed(&mut self, expected: &Expected, heard: &[u8], answer: &[u8]) -> bool {
        let ends_with = [answer, &[dcon::CR]].concat();
        let heard = heard.strip_suffix(b"\n").unwrap_or(heard);
        let before = heard.strip_suffix(ends_with.as_slice());
        expected.is_choosy() && before.is_some_and(|before| self.debts.seen(before, self.line.now()))
    }

    /// An adapter echoes all or nothing. An answer that may look like its request tells neither, and one among other bytes does
    /// not tell that there is no echo: a stray byte may stand in front of it.
    fn learn_echo(&mut self, request: &[u8], expected: &Expected, echo: bool, surplus: bool) {
        if echo || (judge::shows_echo(request, expected) && !surplus) {
            self.echoes = echo;
        }
    }
}

/// Whether the answers of a module belong to the questions on which they were taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Doubts {
    /// These could be out of step; none if the list is empty.
    Open(Vec<Shape>),
    /// Some were.
    Spoiled,
}

/// One request, and what became of it.
struct Spoken {
    outcome: Result<Vec<u8>, Failure>,
    /// When its last bit had left.
    sent: Instant,
    /// From then to the first byte that may belong to an answer.
    first_byte: Option<Duration>,
    noise: bool,
    /// Other bytes came with the answer that may be one too.
    others: bool,
    /// They are not what is owed to earlier questions.
    surplus: bool,
    /// The line had been quiet for so long that no second answer to an earlier question was still to come.
    after_quiet: bool,
}

/// Whether the answer may still come: what has come does not look like the one that was asked for.
fn leaves_answer_open(failure: &Failure, shape: Shape, request: &[u8], expected: &Expected) -> bool {
    match failure {
        Failure::Silent | Failure::LineLost(_) => true,
        // Only an echo that was damaged has come.
        Failure::Collision { .. } => true,
        // What has come may be what was passed over.
        Failure::Cut { .. } | Failure::Garbled { .. } if expected.is_choosy() => true,
        Failure::Cut { bytes } | Failure::Garbled { bytes, .. } => {
            let come = bytes.iter().filter(|byte| !judge::is_noise(**byte)).count() >= LEAST_ANSWER;
            !come || !shape.begins_an_answer_in(request, bytes)
        }
        _ => false,
    }
}

#[cfg(test)]
mod exhaustive;
#[cfg(test)]
mod tests;
