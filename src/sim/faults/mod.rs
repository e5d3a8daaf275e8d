//! What goes wrong between the modules and the reader: the place to add bit flips, losses and the like.

mod kind;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::time::Duration;

use super::world::Answer;
pub use kind::{Fault, FaultError, FaultKind, Strength};

/// The faults of a simulated line; none at first.
#[derive(Debug, Clone, PartialEq)]
pub struct Faults {
    strengths: BTreeMap<FaultKind, Strength>,
    /// By how much late answers are late, each by another time in this range.
    pub late_by: RangeInclusive<Duration>,
}

/// How often each fault has struck since the line began.
pub type Injected = BTreeMap<FaultKind, u64>;

impl Default for Faults {
    fn default() -> Self {
        let late_by = Duration::from_millis(250)..=Duration::from_millis(1_500);
        Self { strengths: BTreeMap::new(), late_by }
    }
}

impl Faults {
    /// How strong a fault is; `None` if it is off.
    pub fn get(&self, kind: FaultKind) -> Option<Strength> {
        self.strengths.get(&kind).copied()
    }

    pub fn is_on(&self, kind: FaultKind) -> bool {
        self.strengths.contains_key(&kind)
    }

    /// # Errors
    /// If the fault cannot be so strong.
    pub fn set(&mut self, fault: Fault) -> Result<(), FaultError> {
        self.strengths.insert(fault.kind, fault.kind.admits(fault.strength)?);
        Ok(())
    }

    /// Switches it on as strong as it is by default.
    pub fn switch_on(&mut self, kind: FaultKind) {
        self.strengths.insert(kind, kind.default_strength());
    }

    pub fn switch_off(&mut self, kind: FaultKind) {
        self.strengths.remove(&kind);
    }

    /// Those that are on.
    pub fn iter(&self) -> impl Iterator<Item = Fault> {
        self.strengths.iter().map(|(&kind, &strength)| Fault { kind, strength })
    }
}

/// What a line does to bytes at this moment.
#[derive(Debug, Clone, Default)]
pub(super) struct Present {
    pub faults: Faults,
    pub injected: Injected,
    /// The adapter hears itself: every sent byte comes back first.
    pub echo: bool,
    /// The adapter is gone.
    pub unplugged: bool,
    /// Stray bytes before and after each answer, as on a line without bias or termination.
    pub noise_before: Vec<u8>,
    pub noise_after: Vec<u8>,
}

impl Present {
    /// What the reader gets of the answers to one request.
    pub fn on_the_wire(&self, answers: Vec<Answer>) -> Vec<Answer> {
        collide(answers).into_iter().map(|answer| self.with_noise(answer)).collect()
    }

    fn with_noise(&self, answer: Answer) -> Answer {
        let bytes = [self.noise_before.as_slice(), &answer.bytes, &self.noise_after].concat();
        Answer { bytes, ..answer }
    }
}

/// Modules that answer at once spoil each other's bytes; a driven 0 wins here, on a real line it is a matter of
/// strength.
fn collide(mut answers: Vec<Answer>) -> Vec<Answer> {
    answers.sort_by_key(|answer| answer.delay);
    let mut on_the_wire: Vec<Answer> = Vec::new();
    for answer in answers {
        match on_the_wire.last_mut().filter(|first| first.delay == answer.delay) {
            Some(first) => overlay(&mut first.bytes, &answer.bytes),
            None => on_the_wire.push(answer),
        }
    }
    on_the_wire
}

fn overlay(bytes: &mut Vec<u8>, other: &[u8]) {
    for (byte, other) in bytes.iter_mut().zip(other) {
        *byte &= other;
    }
    bytes.extend(other.iter().skip(bytes.len()));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(milliseconds: u64, bytes: &[u8]) -> Answer {
        Answer { delay: Duration::from_millis(milliseconds), bytes: bytes.to_vec() }
    }

    #[test]
    fn answers_at_the_same_time_spoil_each_other() {
        let heard = Present::default().on_the_wire(vec![answer(5, b"!01AB"), answer(9, b"!"), answer(5, b"!01B")]);
        assert_eq!(heard, [answer(5, b"!01@B"), answer(9, b"!")]);
    }

    #[test]
    fn noise_surrounds_an_answer() {
        let faults = Present { noise_before: vec![0], noise_after: vec![0xFF, 0xFF], ..Present::default() };
        assert_eq!(faults.on_the_wire(vec![answer(5, b"!")]), [answer(5, &[0, b'!', 0xFF, 0xFF])]);
    }
}
