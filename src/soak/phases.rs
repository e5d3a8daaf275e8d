//! Which faults strike when: every kind in turn, in an order that the seed decides, then mixtures of several and single
//! ones again, for as long as the run goes.

use std::collections::VecDeque;
use std::time::Duration;

use super::limits::EVERY_FAULT_IN;
use crate::sim::{Fault, FaultKind, Faults, Strength};

/// Phases of the first round: every kind, and two mixtures.
const FIRST_ROUND: u32 = 19;
/// Long enough for four polls of each module and their failures.
const SHORTEST: Duration = Duration::from_secs(6);
/// No fault shows more when it lasts longer; more phases show more.
const LONGEST: Duration = Duration::from_secs(12);
/// The part of a phase in which its faults are on, in hundredths; the rest is for the recovery.
const FAULTY: u32 = 57;
/// Of a phase that has to be short because those before it took longer to recover.
const SHORTEST_FAULT: Duration = Duration::from_secs(3);
/// Faults at a time in a mixture.
const MIXED: std::ops::RangeInclusive<usize> = 2..=4;
/// After the first round every so many phases one is a mixture.
const MIXTURE_EVERY: u64 = 2;
/// How often a fault is this many times as strong as by default.
const STRONGER: [f64; 3] = [1.0, 3.0, 6.0];
const JUMPS: [i64; 4] = [3_600, -3_600, 45, -45];

/// Some faults, and how long they last.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    pub faults: Faults,
    /// Such as `late` or `echo + noise`.
    pub name: String,
    /// How long its faults are on.
    pub faulty: Duration,
    /// Of quiet after that, at least.
    pub quiet: Duration,
}

/// The phases of a run.
pub struct Phases {
    random: fastrand::Rng,
    /// What a fault that concerns a module or a speed can strike.
    places: Vec<(u8, crate::protocol::BaudRate)>,
    duration: Duration,
    length: Duration,
    waiting: VecDeque<Vec<FaultKind>>,
    given: u64,
    /// Phases of the first round that have not been given.
    first_round: u32,
}

impl Phases {
    /// Phases for a run of this duration on a line with modules at these addresses and speeds.
    pub fn new(duration: Duration, seed: u64, places: Vec<(u8, crate::protocol::BaudRate)>) -> Self {
        let length = duration.checked_div(FIRST_ROUND).unwrap_or_default().clamp(SHORTEST, LONGEST);
        let mut random = fastrand::Rng::with_seed(seed);
        let mut kinds = FaultKind::ALL;
        random.shuffle(&mut kinds);
        let waiting = kinds.into_iter().map(|kind| vec![kind]).collect();
        let first_round = u32::try_from(kinds.len()).unwrap_or(FIRST_ROUND);
        Self { random, places, duration, length, waiting, given: 0, first_round }
    }

    /// The phase that begins when so much of the run is over; `None` at its end. A run of two minutes goes on until every
    /// fault was there.
    pub fn next(&mut self, elapsed: Duration) -> Option<Phase> {
        let left = self.duration.saturating_sub(elapsed);
        let owes = self.duration >= EVERY_FAULT_IN && self.first_round > 0;
        if left < self.length / 2 && !owes {
            return None;
        }
        let kinds = self.kinds();
        let mut faults = Faults::default();
        for &kind in &kinds {
            let strength = self.strength(kind);
            // Every strength is one that the fault admits.
            let _ = faults.set(Fault { kind, strength });
        }
        self.given = self.given.saturating_add(1);
        let share = if owes { left.checked_div(self.first_round).unwrap_or_default() } else { self.length };
        self.first_round = self.first_round.saturating_sub(1);
        let length = self.length.min(share.max(SHORTEST_FAULT));
        let faulty = (length * FAULTY / 100).max(SHORTEST_FAULT);
        let words: Vec<&str> = kinds.iter().map(|kind| kind.word()).collect();
        Some(Phase { faults, name: words.join(" + "), faulty, quiet: length.saturating_sub(faulty) })
    }

    fn kinds(&mut self) -> Vec<FaultKind> {
        if let Some(kinds) = self.waiting.pop_front() {
            return kinds;
        }
        if self.given.is_multiple_of(MIXTURE_EVERY) {
            let count = self.random.usize(MIXED);
            return self.random.choose_multiple(FaultKind::ALL, count);
        }
        self.random.choice(FaultKind::ALL).into_iter().collect()
    }

    fn strength(&mut self, kind: FaultKind) -> Strength {
        match kind.default_strength() {
            Strength::On => Strength::On,
            Strength::Rate(rate) => {
                let times = self.random.choice(STRONGER).unwrap_or(1.0);
                Strength::Rate((rate * times).min(1.0))
            }
            Strength::Address(address) => Strength::Address(self.place().map_or(address, |(address, _)| address)),
            Strength::Speed(speed) => Strength::Speed(self.place().map_or(speed, |(_, speed)| speed)),
            Strength::Seconds(seconds) => Strength::Seconds(self.random.choice(JUMPS).unwrap_or(seconds)),
        }
    }

    fn place(&mut self) -> Option<(u8, crate::protocol::BaudRate)> {
        let index = self.random.usize(0..self.places.len().max(1));
        self.places.get(index).copied()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::protocol::BaudRate;

    fn phases(seconds: u64, seed: u64) -> Phases {
        Phases::new(Duration::from_secs(seconds), seed, vec![(7, BaudRate::B9600)])
    }

    /// The phases of a run in which each takes as long as it is planned to.
    fn all(seconds: u64, seed: u64) -> Vec<Phase> {
        let mut phases = phases(seconds, seed);
        let mut elapsed = Duration::ZERO;
        let next = || {
            let phase = phases.next(elapsed)?;
            elapsed += phase.faulty + phase.quiet;
            Some(phase)
        };
        std::iter::from_fn(next).collect()
    }

    fn kinds(phases: &[Phase]) -> BTreeSet<FaultKind> {
        phases.iter().flat_map(|phase| phase.faults.iter().map(|fault| fault.kind)).collect()
    }

    #[test]
    fn two_minutes_are_enough_for_every_fault_and_some_mixtures() {
        let phases = all(120, 1);
        let (single, mixed): (Vec<_>, Vec<_>) = phases.iter().partition(|phase| phase.faults.iter().count() == 1);
        assert!(single.len() >= 17 && !mixed.is_empty(), "{} and {}", single.len(), mixed.len());
        assert_eq!(kinds(&phases).len(), 17);
        let time: Duration = phases.iter().map(|phase| phase.faulty + phase.quiet).sum();
        assert!((110..=125).contains(&time.as_secs()), "{time:?}");
    }

    #[test]
    fn phases_that_take_longer_shorten_those_after_them_but_leave_none_out() {
        let mut phases = phases(120, 5);
        let (mut elapsed, mut given) = (Duration::ZERO, Vec::new());
        while let Some(phase) = phases.next(elapsed) {
            assert!(phase.faulty >= SHORTEST_FAULT);
            elapsed += phase.faulty + phase.quiet + Duration::from_secs(10);
            given.push(phase);
        }
        assert_eq!(kinds(&given).len(), 17);
    }

    #[test]
    fn a_short_run_has_what_there_is_time_for() {
        assert_eq!(all(10, 1).len(), 2);
    }

    #[test]
    fn an_hour_has_hundreds_of_phases_half_of_which_are_mixtures_in_the_end() {
        let phases = all(3_600, 1);
        let mixtures = phases.iter().filter(|phase| phase.faults.iter().count() > 1).count();
        assert!(phases.len() >= 290 && mixtures >= 120, "{} and {mixtures}", phases.len());
    }

    #[test]
    fn the_seed_decides_the_order() {
        let names = |seed| all(120, seed).into_iter().map(|phase| phase.name).collect::<Vec<_>>();
        assert_eq!(names(3), names(3));
        assert_ne!(names(3), names(4));
    }
}
