//! Answers that may still come, so that none of them is taken for that of a later question.
//!
//! A module answers in the order in which it was asked. So a debt is paid when a later question that cannot be mistaken
//! is answered, when the missing answer is seen after all, or when [`LATEST`] has passed.

use std::time::{Duration, Instant};

use super::shape::{Shape, asks_for_name};
use crate::bus::judge::{self, Expected, Verdict};

/// An answer does not come later than this after the end of its request, be it through a busy adapter, a hub, a virtual
/// machine or a converter on a network.
pub const LATEST: Duration = Duration::from_secs(2);
/// A line on which more is owed is in no state to be spoken to anyway.
const MOST: usize = 32;

/// A question whose answer has not come.
#[derive(Debug, Clone)]
struct Debt {
    shape: Shape,
    request: Vec<u8>,
    expected: Expected,
    until: Instant,
}

/// All answers that may still come.
#[derive(Debug, Default)]
pub struct Debts {
    all: Vec<Debt>,
}

impl Debts {
    /// `request` was sent until `sent` and has no answer.
    pub fn note(&mut self, shape: Shape, request: &[u8], expected: &Expected, sent: Instant) {
        self.all.retain(|debt| debt.until > sent && (debt.shape, debt.request.as_slice()) != (shape, request));
        if self.all.len() >= MOST {
            self.all.remove(0);
        }
        let until = sent.checked_add(LATEST).unwrap_or(sent);
        self.all.push(Debt { shape, request: request.to_vec(), expected: expected.clone(), until });
    }

    /// A question that cannot be mistaken was answered: everything that was asked of this module before is over.
    pub fn paid_up_to(&mut self, shape: Shape) {
        self.all.retain(|debt| !debt.shape.asks_whom(shape));
    }

    /// Bytes that nobody asked for at this moment may be what is owed.
    pub fn seen(&mut self, bytes: &[u8]) {
        self.all.retain(|debt| {
            let verdict = judge::so_far(&debt.request, &debt.expected, bytes, false);
            !matches!(verdict, Verdict::Answer { .. })
        });
    }

    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// What is owed that could be taken for the answer to `shape`.
    fn against(&self, shape: Shape, now: Instant) -> impl Iterator<Item = &Debt> {
        self.all.iter().filter(move |debt| debt.until > now && debt.shape.could_answer(shape))
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
}
