//! Answers that may still come, so that none of them is taken for that of a later question.
//!
//! A module answers in the order in which it was asked. So a debt is paid when a later question that cannot be mistaken
//! is answered, a moment after the missing answer is seen after all, or when [`LATEST`] has passed. A known name that is
//! owed need not be waited for, as it is recognised wherever it comes.

use std::time::{Duration, Instant};

use super::shape::Shape;
use crate::bus::judge::{self, Content, Expected, Verdict};
use crate::bus::name::{asks_for_name, is_name};
use crate::protocol::{LineSettings, dcon};

/// An answer does not come later than this after it was given up, be it through a busy adapter, a hub, a virtual
/// machine or a converter on a network.
pub const LATEST: Duration = Duration::from_secs(2);
/// An answer that comes twice does so within this time: modules at one address differ by up to 30 ms in their response
/// delay (PIR-234 manual 5.24), to which the answer's own time and the adapter's latency are added.
const SECOND_COPY: Duration = Duration::from_millis(100);
/// A line on which more is owed is in no state to be spoken to anyway.
const MOST: usize = 64;

/// A question whose answer has not come.
#[derive(Debug, Clone)]
struct Debt {
    shape: Shape,
    request: Vec<u8>,
    expected: Expected,
    until: Instant,
    /// At another speed it cannot be read.
    settings: LineSettings,
    /// It has come, when it was too late; only a second copy may follow.
    paid: bool,
}

impl Debt {
    /// The answer, if it is known beforehand.
    fn known_answer(&self) -> Option<&Vec<u8>> {
        match &self.expected {
            Expected::Dcon { content: Content::Name(name), .. } => Some(name),
            _ => None,
        }
    }
}

/// A debt, and the answer to it among some bytes.
struct Payment {
    index: usize,
    answer: Vec<u8>,
    /// Where it ends in these bytes.
    ends: usize,
}

/// All answers that may still come, in the order of their questions.
#[derive(Debug, Default)]
pub struct Debts {
    all: Vec<Debt>,
    settings: LineSettings,
    /// The answer that was seen last, and when: once more within [`SECOND_COPY`] it is a copy and pays nothing.
    last: Option<(Vec<u8>, Instant)>,
}

impl Debts {
    /// `request` has no answer, which was waited for until `now`.
    pub fn note(&mut self, shape: Shape, request: &[u8], expected: &Expected, now: Instant) {
        self.all.retain(|debt| debt.until > now);
        if self.all.len() >= MOST {
            self.all.remove(0);
        }
        let until = now.checked_add(LATEST).unwrap_or(now);
        let (request, expected, settings) = (request.to_vec(), expected.clone(), self.settings);
        self.all.push(Debt { shape, request, expected, until, settings, paid: false });
    }

    /// `request` has this answer. If it could be that to an earlier question, it is to the first of these, and the last is
    /// still owed; a name is the answer only to a question for it.
    pub fn answered(&mut self, shape: Shape, request: &[u8], expected: &Expected, answer: &[u8], now: Instant) {
        self.all.retain(|debt| debt.until > now);
        self.last = Some((answer.to_vec(), now));
        let named = asks_for_name(request) && is_name(answer);
        let owed = |debt: &Debt| {
            let fits = debt.shape.could_answer(shape) && debt.expected.admits(answer);
            let fits = fits && (!named || asks_for_name(&debt.request));
            !debt.paid && debt.shape.asks_whom(shape) && fits
        };
        let first = self.all.iter().position(|debt| debt.settings.is_read_at(self.settings) && owed(debt));
        let Some(first) = first else { return self.paid_up_to(shape) };
        self.pay_up_to(first);
        self.note(shape, request, expected, now);
    }

    /// Bytes that nobody asked for at this moment may be what is owed; a second time it comes soon, if at all. True if they
    /// are nothing else.
    pub fn seen(&mut self, bytes: &[u8], now: Instant) -> bool {
        let means_nothing = |bytes: &[u8]| bytes.iter().all(|byte| judge::is_noise(*byte) || *byte == dcon::CR);
        let (mut rest, mut all_owed) = (bytes, true);
        while let Some(Payment { index, answer, ends }) = self.first_paid_by(rest) {
            let recent =
                |(last, at): &(Vec<u8>, Instant)| *last == answer && now.saturating_duration_since(*at) <= SECOND_COPY;
            let copy = self.last.as_ref().is_some_and(recent);
            if let Some(debt) = self.all.get_mut(index).filter(|_| !copy) {
                debt.paid = true;
                debt.until = debt.until.min(now.checked_add(SECOND_COPY).unwrap_or(now));
            }
            let before = rest.get(..ends.saturating_sub(answer.len())).unwrap_or_default();
            all_owed &= !copy && means_nothing(before);
            self.last = Some((answer, now));
            rest = rest.get(ends..).unwrap_or_default();
        }
        all_owed && means_nothing(rest)
    }

    /// Speed and format from now on.
    pub fn configure(&mut self, settings: LineSettings) {
        self.settings = settings;
    }

    /// Until when `request` itself, which was given up a moment ago, may still be answered within one more `window`.
    pub fn under_way(&self, request: &[u8], window: Duration, now: Instant) -> Option<Instant> {
        let mine = self.all.iter().filter(|debt| debt.request == request && !debt.paid);
        let ends = mine.filter_map(|debt| debt.until.checked_sub(LATEST)?.checked_add(window));
        ends.filter(|end| *end > now).max()
    }

    /// Until when `request` must not be sent; `None` if it may be at once.
    pub fn until(&self, shape: Shape, request: &[u8], now: Instant) -> Option<Instant> {
        let as_good = |debt: &&Debt| debt.request == request && asks_for_name(request);
        self.against(shape, now).filter(|debt| !as_good(debt)).map(|debt| debt.until).max()
    }

    /// The questions whose answers could be taken for that to `shape`.
    pub fn shapes(&self, shape: Shape, now: Instant) -> Vec<Shape> {
        let mut shapes: Vec<Shape> = Vec::new();
        for debt in self.against(shape, now) {
            if !shapes.contains(&debt.shape) {
                shapes.push(debt.shape);
            }
        }
        shapes
    }

    /// Whether `answer`, which was awaited without an address, begins with that of another module that owes one.
    pub fn claim(&self, shape: Shape, answer: &[u8], now: Instant) -> bool {
        self.open(shape, now).any(|debt| debt.shape.shows_another_than(shape) && debt.shape.stands_in_front_of(answer))
    }

    /// Known answers that may still come and could be taken for that to `shape`.
    pub fn known_answers(&self, shape: Shape, now: Instant) -> Vec<Vec<u8>> {
        let mut known: Vec<Vec<u8>> = self.open(shape, now).filter_map(Debt::known_answer).cloned().collect();
        known.dedup();
        known
    }

    /// What is owed that has to be waited for, lest it be taken for the answer to `shape`.
    fn against(&self, shape: Shape, now: Instant) -> impl Iterator<Item = &Debt> {
        let shows_itself = move |debt: &Debt| debt.shape.shows_another_than(shape) || debt.known_answer().is_some();
        self.open(shape, now).filter(move |debt| !shows_itself(debt))
    }

    /// What is owed and would be accepted as the answer to `shape`.
    fn open(&self, shape: Shape, now: Instant) -> impl Iterator<Item = &Debt> {
        self.all.iter().filter(move |debt| {
            debt.until > now && debt.settings.is_read_at(self.settings) && debt.shape.could_answer(shape)
        })
    }

    /// A question that cannot be mistaken was answered: everything that was asked of this module before is over.
    fn paid_up_to(&mut self, shape: Shape) {
        let settings = self.settings;
        self.all.retain(|debt| !debt.shape.asks_whom(shape) || !debt.settings.is_read_at(settings));
    }

    /// The debt at `last` is paid, and with it everything that was asked of the same module before.
    fn pay_up_to(&mut self, last: usize) {
        let Some(shape) = self.all.get(last).map(|debt| debt.shape) else { return };
        let (settings, mut index) = (self.settings, 0usize);
        self.all.retain(|debt| {
            let over = index <= last && debt.shape.asks_whom(shape) && debt.settings.is_read_at(settings);
            index = index.saturating_add(1);
            !over
        });
    }

    /// The oldest debt whose answer begins `bytes`, or stands in them after others' bytes, and where that answer ends.
    fn first_paid_by(&self, bytes: &[u8]) -> Option<Payment> {
        let mut found: Option<Payment> = None;
        for (index, debt) in self.all.iter().enumerate().filter(|(_, debt)| !debt.paid) {
            let Verdict::Answer { bytes: answer, .. } = judge::so_far(&debt.request, &debt.expected, bytes, false)
            else {
                continue;
            };
            let begins = bytes.windows(answer.len().max(1)).position(|window| window == answer);
            let ends = begins.unwrap_or_default().saturating_add(answer.len());
            // What stands first in the bytes was answered first.
            if found.as_ref().is_none_or(|first| ends < first.ends) {
                found = Some(Payment { index, answer, ends });
            }
        }
        found
    }
}
