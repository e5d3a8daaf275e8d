//! Many identical reads of one module: what a healthy module answers to them is always the same.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::time::Duration;

use serde::Serialize;

use super::histogram::{Histogram, Times, milliseconds};
use super::medium::Medium;
use super::outcome::{FailureKind, Outcome};
use super::station::{answer_time, fingerprint};
use super::surplus::{Heard, Surplus};
use crate::bus::{Direction, Frame, RawRequest, Target, Tuning};
use crate::protocol::{Failure, Protocol, dcon, modbus};

/// Reads unless told otherwise.
pub const DEFAULT_READS: u32 = 50;
pub const READS: RangeInclusive<u32> = 5..=1_000;
/// A module that was silent so often from the beginning is not asked further.
const SILENT_ENOUGH: u32 = 10;
/// What was seen only once may be a flipped bit that no checksum shows.
const NO_CHANCE: u32 = 2;
/// Broken answers in this part of the reads, each another one, may be two modules.
const COLLIDING: f64 = 0.3;

/// What the answers to identical reads say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judgement {
    Fine,
    /// More than one module answers at the address.
    Doubled,
    /// Broken answers that change each time: more than one module, or noise.
    DoubledOrNoise,
    /// Second copies of the answers come behind them.
    Twice,
    /// No answer can be used, and all are broken in the same way.
    SameErrors,
    /// Bytes come, and none make sense.
    Unreadable,
    Noise,
    /// Some answers came after the timeout.
    Late,
    /// Some reads had no answer.
    Lossy,
    NoAnswer,
    /// The line was lost meanwhile.
    Interrupted,
}

impl Judgement {
    pub fn label(self) -> &'static str {
        match self {
            Self::Fine => "consistent",
            Self::Doubled => "more than one module",
            Self::DoubledOrNoise => "two modules at one address, or noise",
            Self::Twice => "answers come twice",
            Self::SameErrors => "broken in the same way each time",
            Self::Unreadable => "not readable",
            Self::Noise => "noise",
            Self::Late => "answers come too late",
            Self::Lossy => "answers get lost",
            Self::NoAnswer => "no answer",
            Self::Interrupted => "interrupted",
        }
    }
}

/// How a test came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Consistency {
    pub target: Target,
    /// Reads that were done.
    pub reads: u32,
    /// Good answers.
    pub answers: u32,
    /// How many of these differ from each other; 1 is as it should be.
    pub different_answers: usize,
    /// Failed reads, by kind.
    pub failures: BTreeMap<FailureKind, u32>,
    /// How many broken answers differ from each other.
    pub different_failures: usize,
    /// Second copies that came behind answers, byte for byte.
    pub copies: u32,
    /// Other whole answers that came behind the first.
    pub second_answers: u32,
    /// Reads behind whose answers more bytes came that are no answer.
    pub followed: u32,
    /// Answers that came after the timeout; a test listens longer, so that their times are known.
    pub late: u32,
    /// Those of them that came while the test still listened.
    pub slow: u32,
    /// Answers with stray bytes around them.
    pub noisy: u32,
    /// Reads that would have brought nothing, each asked again as often as is set.
    pub lost_in_spite_of_repeats: u32,
    pub times: Option<Times>,
    pub judgement: Judgement,
    /// The same in a sentence.
    pub said: String,
}

/// A test under way: whoever drives it sends [`Self::request`] again and again until [`Self::is_done`], and hands over what
/// comes back.
#[derive(Debug, Clone)]
pub struct ConsistencyTest {
    target: Target,
    tuning: Tuning,
    wanted: u32,
    reads: u32,
    answers: BTreeMap<u64, u32>,
    failures: BTreeMap<FailureKind, u32>,
    forms: BTreeSet<u64>,
    copies: u32,
    second_answers: u32,
    followed: u32,
    late: u32,
    slow: u32,
    noisy: u32,
    /// Reads in a row that would have been asked again.
    failed_in_a_row: u8,
    lost_in_spite_of_repeats: u32,
    /// Reads that were not sent because somebody else was in a hurry.
    postponed: u32,
    times: Histogram,
    /// The last request, and what came on it.
    request: Vec<u8>,
    heard: Heard,
    is_silent: bool,
    /// What came on it came after the timeout.
    is_late: bool,
    /// The last frame that was sent is one of the test's.
    is_own: bool,
    lost: bool,
}

impl ConsistencyTest {
    /// A test of `target` as patient as `tuning` says.
    pub fn new(target: Target, reads: u32, tuning: Tuning) -> Self {
        let wanted = reads.clamp(*READS.start(), *READS.end());
        Self {
            target,
            tuning: tuning.within_limits(),
            wanted,
            reads: 0,
            answers: BTreeMap::new(),
            failures: BTreeMap::new(),
            forms: BTreeSet::new(),
            copies: 0,
            second_answers: 0,
            followed: 0,
            late: 0,
            slow: 0,
            noisy: 0,
            failed_in_a_row: 0,
            lost_in_spite_of_repeats: 0,
            postponed: 0,
            times: Histogram::default(),
            request: Vec::new(),
            heard: Heard::default(),
            is_silent: false,
            is_late: false,
            is_own: false,
            lost: false,
        }
    }

    pub fn target(&self) -> Target {
        self.target
    }

    /// Asks for what never changes: the module's name.
    pub fn request(&self) -> RawRequest {
        let Target { address, protocol, checksum, .. } = self.target;
        match protocol {
            Protocol::Dcon => RawRequest::Dcon { text: format!("${address:02X}M"), checksum },
            // Firmware and name: 40481 to 40484.
            Protocol::ModbusRtu | Protocol::ModbusTcp => RawRequest::Modbus { bytes: self.body() },
        }
    }

    fn body(&self) -> Vec<u8> {
        vec![self.target.address, 3, 1, 0xE0, 0, 4]
    }

    fn is_request(&self, frame: &Frame) -> bool {
        let Target { address, protocol, checksum, .. } = self.target;
        match protocol {
            Protocol::Dcon => frame.bytes == dcon::encode(&format!("${address:02X}M"), checksum),
            Protocol::ModbusRtu => frame.bytes == modbus::with_crc(&self.body()),
            Protocol::ModbusTcp => frame.bytes.ends_with(&self.body()),
        }
    }

    /// Takes in what passes the line; frames of others are passed over.
    pub fn take(&mut self, frame: &Frame) {
        if frame.direction == Direction::Sent {
            self.is_own = self.is_request(frame);
            self.request.clone_from(&frame.bytes);
            (self.heard, self.is_silent, self.is_late) = (Heard::default(), false, false);
            return;
        }
        if !self.is_own {
            return;
        }
        match Outcome::of(frame) {
            Some(Outcome::Unasked) => self.followed_by(frame),
            Some(Outcome::Answer | Outcome::Refusal(_)) => {
                let time = answer_time(frame);
                self.times.add(time);
                self.is_late = time > self.limit();
                self.heard = Heard::of(frame, Some(&self.request));
                self.count(Surplus::around(frame, Some(&self.request)));
            }
            Some(Outcome::Failed(FailureKind::NoAnswer)) => self.is_silent = true,
            _ => {}
        }
    }

    /// What takes longer is too late for the other commands.
    fn limit(&self) -> Duration {
        self.tuning.timeout.saturating_add(Medium::of(self.target.protocol).allowance())
    }

    /// What came behind a read is a second answer to it, or the first if it had been given up.
    fn followed_by(&mut self, frame: &Frame) {
        match self.heard.behind(frame) {
            what if self.is_silent && what.is_whole() => self.late = self.late.saturating_add(1),
            Surplus::Stray | Surplus::Piece => self.followed = self.followed.saturating_add(1),
            what => self.count(what),
        }
    }

    fn count(&mut self, what: Surplus) {
        let counter = match what {
            Surplus::Nothing => return,
            Surplus::Copy => &mut self.copies,
            Surplus::Other => &mut self.second_answers,
            Surplus::Piece | Surplus::Stray => &mut self.noisy,
        };
        *counter = counter.saturating_add(1);
    }

    /// Takes in how a request came out.
    pub fn answered(&mut self, result: &Result<Vec<u8>, Failure>) {
        // Nothing was sent: a wait for somebody's late answer was cut short.
        if matches!(result, Err(Failure::Garbled { bytes, .. }) if bytes.is_empty()) {
            self.postponed = self.postponed.saturating_add(1);
            return;
        }
        self.reads = self.reads.saturating_add(1);
        let is_late = std::mem::take(&mut self.is_late);
        self.slow = self.slow.saturating_add(u32::from(is_late));
        self.late = self.late.saturating_add(u32::from(is_late));
        self.count_repeats(is_late || result.as_ref().is_err_and(|failure| !failure.is_refusal()));
        match result {
            Ok(answer) if self.is_others(answer) => self.failed(FailureKind::WrongAddress, answer),
            Ok(answer) => {
                let count = self.answers.entry(fingerprint(answer)).or_default();
                *count = count.saturating_add(1);
            }
            Err(Failure::Silent) => self.failed(FailureKind::NoAnswer, &[]),
            Err(Failure::Cut { bytes }) => self.failed(FailureKind::CutShort, bytes),
            Err(Failure::Collision { bytes }) => self.failed(FailureKind::Collision, bytes),
            Err(Failure::Garbled { reason, bytes }) => {
                let Target { protocol, address, .. } = self.target;
                self.failed(FailureKind::of_broken(reason, bytes, protocol, Some(address)), bytes);
            }
            Err(Failure::LineLost(_) | Failure::NotOffered(_)) => self.lost = true,
            Err(refusal) => {
                let count = self.answers.entry(fingerprint(refusal.to_string().as_bytes())).or_default();
                *count = count.saturating_add(1);
            }
        }
    }

    /// Each failed read stands for one that is asked again, until one succeeds or all repeats are used up.
    fn count_repeats(&mut self, failed: bool) {
        self.failed_in_a_row = if failed { self.failed_in_a_row.saturating_add(1) } else { 0 };
        if self.failed_in_a_row > self.tuning.repeats {
            self.lost_in_spite_of_repeats = self.lost_in_spite_of_repeats.saturating_add(1);
            self.failed_in_a_row = 0;
        }
    }

    /// A DCON answer that carries another address; Modbus answers are checked before they get here.
    fn is_others(&self, answer: &[u8]) -> bool {
        let sender = answer.get(1..3).and_then(|digits| std::str::from_utf8(digits).ok());
        let sender = sender.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        self.target.protocol == Protocol::Dcon && sender.is_some_and(|sender| sender != self.target.address)
    }

    fn failed(&mut self, kind: FailureKind, bytes: &[u8]) {
        let count = self.failures.entry(kind).or_default();
        *count = count.saturating_add(1);
        if !bytes.is_empty() {
            self.forms.insert(fingerprint(bytes));
        }
    }

    pub fn is_done(&self) -> bool {
        let mute = self.reads >= SILENT_ENOUGH && self.silences() == self.reads;
        self.lost || mute || self.reads >= self.wanted || self.postponed >= self.wanted
    }

    /// How much of it is done, 0 to 1.
    pub fn part(&self) -> f32 {
        self.reads as f32 / self.wanted.max(1) as f32
    }

    /// Reads done, of how many.
    pub fn progress(&self) -> (u32, u32) {
        (self.reads, self.wanted)
    }

    fn silences(&self) -> u32 {
        self.failures.get(&FailureKind::NoAnswer).copied().unwrap_or_default()
    }

    fn broken(&self) -> u32 {
        self.failures.values().sum::<u32>().saturating_sub(self.silences())
    }

    /// How many answers of different content came, each more often than by chance.
    fn voices(&self) -> usize {
        self.answers.values().filter(|count| **count >= NO_CHANCE).count()
    }

    /// How it fails most often, silence left aside.
    fn main_failure(&self) -> Option<FailureKind> {
        let spoken = self.failures.iter().filter(|(kind, _)| **kind != FailureKind::NoAnswer);
        spoken.max_by_key(|(_, count)| **count).map(|(kind, _)| *kind)
    }

    fn judge(&self) -> Judgement {
        let broken = self.broken();
        let odd = self.answers.values().filter(|count| **count < NO_CHANCE).count();
        let collide = f64::from(broken) / f64::from(self.reads.max(1)) >= COLLIDING && self.forms.len() > 1;
        let beside = self.noisy > 0 || self.followed > 0 || self.copies > 0 || self.second_answers > 0;
        if self.lost {
            Judgement::Interrupted
        } else if self.silences() == self.reads && self.late == 0 {
            Judgement::NoAnswer
        } else if self.voices() > 1 || self.second_answers >= NO_CHANCE {
            Judgement::Doubled
        } else if self.copies >= NO_CHANCE && self.copies > self.late {
            Judgement::Twice
        } else if self.answers.is_empty() && broken > NO_CHANCE && self.forms.len() == 1 {
            Judgement::SameErrors
        } else if self.answers.is_empty() && self.main_failure() == Some(FailureKind::Garbage) {
            Judgement::Unreadable
        } else if collide || self.voices() == 0 && odd > 1 {
            Judgement::DoubledOrNoise
        } else if self.late > 0 && broken == 0 && self.answers.len() < 2 && self.noisy == 0 && self.followed == 0 {
            // What comes late looks like a second copy behind the next read's answer.
            Judgement::Late
        } else if broken > 0 || self.answers.len() > 1 || beside {
            Judgement::Noise
        } else if self.silences() > 0 {
            Judgement::Lossy
        } else {
            Judgement::Fine
        }
    }

    /// How it came out so far.
    pub fn outcome(&self) -> Consistency {
        let answers = self.answers.values().sum();
        Consistency {
            target: self.target,
            reads: self.reads,
            answers,
            different_answers: self.answers.len(),
            failures: self.failures.clone(),
            different_failures: self.forms.len(),
            copies: self.copies,
            second_answers: self.second_answers,
            followed: self.followed,
            late: self.late,
            slow: self.slow,
            noisy: self.noisy,
            lost_in_spite_of_repeats: self.lost_in_spite_of_repeats,
            times: self.times.times(),
            judgement: self.judge(),
            said: self.say(answers),
        }
    }

    fn say(&self, answers: u32) -> String {
        let different = match self.answers.len() {
            0 => String::new(),
            1 => ", all the same".to_owned(),
            count => format!(", {count} different ones"),
        };
        let mut parts = vec![format!("{answers} of {} reads answered{different}", self.reads)];
        parts.extend(self.failures.iter().map(|(kind, count)| format!("{count} {}", kind.label())));
        if self.forms.len() > 1 {
            parts.push(format!("broken in {} different ways", self.forms.len()));
        }
        for (count, what) in [
            (self.copies, "came twice"),
            (self.second_answers, "followed by another answer"),
            (self.followed, "followed by more bytes"),
            (self.noisy, "with stray bytes"),
        ] {
            if count > 0 {
                parts.push(format!("{count} {what}"));
            }
        }
        if self.late > 0 {
            parts.push(format!("{} came later than the timeout of {} ms", self.late, milliseconds(self.limit())));
        }
        if self.silences() > 0 || self.late > 0 || self.broken() > 0 {
            parts.push(self.say_repeats());
        }
        parts.join("; ")
    }

    fn say_repeats(&self) -> String {
        let again = match self.tuning.repeats {
            0 => "without asking again, as is set".to_owned(),
            1 => "asked again once, as is set".to_owned(),
            repeats => format!("asked again at most {repeats} times, as is set"),
        };
        match self.lost_in_spite_of_repeats {
            0 => format!("{again}, every read would have succeeded"),
            1 => format!("{again}, 1 read would have failed"),
            lost => format!("{again}, {lost} reads would have failed"),
        }
    }
}
