//! Looks at the bench after each picture: which values were taken in, whether they are true, and what was noticed of the
//! faults.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::limits::MOST_DETAILS;
use super::line::is_checked;
use super::truth::{Judgement, Truth};
use super::twins::Twins;
use crate::bench::traffic::Outcome;
use crate::bench::{Bench, LineState};
use crate::bus::{Statistics, Target, UNASKED};
use crate::record::{Micros, micros_of, timestamp};
use crate::sim::Faults;

/// The line's clock as far as the answers tell it: it may be hours ahead of the system's after that was set.
#[derive(Debug, Clone, Default)]
struct LineClock {
    newest: Option<(Timestamp, Instant)>,
}

impl LineClock {
    fn note(&mut self, at: Timestamp, seen: Instant) {
        if self.now(seen).is_none_or(|now| at > now) {
            self.newest = Some((at, seen));
        }
    }

    fn now(&self, instant: Instant) -> Option<Timestamp> {
        let (at, seen) = self.newest?;
        at.checked_add(instant.saturating_duration_since(seen)).ok()
    }

    /// When that was, on the computer's steady clock.
    fn instant(&self, at: Timestamp, now: Instant) -> Option<Instant> {
        let ago = Duration::try_from(self.now(now)?.duration_since(at)).unwrap_or_default();
        now.checked_sub(ago)
    }
}

/// What came of values that the program took in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Values {
    pub accepted: u64,
    /// Never had by the module, although a wrong byte shows in its answers.
    pub wrong: u64,
    /// The same of modules in whose answers a wrong byte does not show.
    pub wrong_without_check: u64,
    /// Had by the module, but earlier.
    pub outdated: u64,
    /// Answered by the other module at the same address.
    pub of_twins: u64,
    /// Of items of which nobody knows what the module has.
    pub not_known: u64,
}

/// What passed the line, as the program told it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Noticed {
    pub lost: u64,
    pub restored: u64,
    pub with_noise: u64,
    pub with_echo: u64,
    pub unasked_bytes: u64,
    pub broken: u64,
    pub silent: u64,
    /// Frames that the log forgot before they were looked at.
    pub overlooked: u64,
}

/// All that is watched.
#[derive(Default)]
pub struct Watch {
    pub truth: Truth,
    pub twins: Twins,
    pub values: Values,
    pub noticed: Noticed,
    /// What is not as it must be, in words; the first ones.
    pub details: Vec<String>,
    /// Of all lines that were opened.
    pub statistics: Statistics,
    clock: LineClock,
    seen: BTreeMap<Target, BTreeMap<String, Timestamp>>,
    was_lost: bool,
    next_frame: u64,
}

impl Watch {
    /// Takes in what has changed since the last look. `phase` is what goes wrong at present.
    pub fn look(&mut self, bench: &Bench, phase: &str, now: Instant) {
        self.look_at_line(bench);
        self.look_at_traffic(bench);
        self.statistics = bench.statistics().clone();
        let fresh = self.fresh(bench);
        // The line's clock may have jumped between two of them.
        let before = self.clock.clone();
        for (_, _, at, _) in &fresh {
            self.clock.note(*at, now);
        }
        for (target, id, at, value) in fresh {
            let measured = [&self.clock, &before].map(|clock| clock.instant(at, now).unwrap_or(now));
            self.judge(&target, &id, at, &value, phase, measured);
        }
    }

    /// What goes wrong from now on.
    pub fn note_faults(&mut self, faults: &Faults, now: Instant) {
        let at = self.line_time(now);
        self.twins.note(faults, at);
    }

    /// When a value was measured, on the computer's steady clock.
    pub fn measured(&self, at: Timestamp, now: Instant) -> Option<Instant> {
        self.clock.instant(at, now)
    }

    /// Keeps in words what is not as it must be.
    pub fn tell(&mut self, text: String) {
        if self.details.len() < MOST_DETAILS {
            self.details.push(text);
        }
    }

    fn line_time(&self, now: Instant) -> Micros {
        self.clock.now(now).map(micros_of).unwrap_or_default()
    }

    /// Values that were not there at the last look.
    fn fresh(&mut self, bench: &Bench) -> Vec<(Target, String, Timestamp, String)> {
        let mut fresh = Vec::new();
        for module in bench.modules() {
            let seen = self.seen.entry(module.target).or_default();
            for (id, reading) in &module.readings {
                let (Some(value), Some(at)) = (&reading.value, reading.at) else { continue };
                if seen.get(id) != Some(&at) {
                    seen.insert(id.clone(), at);
                    fresh.push((module.target, id.clone(), at, value.to_string()));
                }
            }
        }
        fresh
    }

    fn judge(&mut self, target: &Target, id: &str, at: Timestamp, value: &str, phase: &str, measured: [Instant; 2]) {
        self.values.accepted = self.values.accepted.saturating_add(1);
        let [judgement, before] = measured.map(|measured| self.truth.judge(target.address, id, value, measured));
        let judgement = if before == Judgement::Right { before } else { judgement };
        let count = match judgement {
            Judgement::Right => return,
            Judgement::NotKnown => &mut self.values.not_known,
            _ if self.twins.shared(target.address, micros_of(at)) => &mut self.values.of_twins,
            Judgement::Outdated if is_checked(target) => &mut self.values.outdated,
            Judgement::Wrong if is_checked(target) => &mut self.values.wrong,
            Judgement::Outdated | Judgement::Wrong => &mut self.values.wrong_without_check,
        };
        *count = count.saturating_add(1);
        if judgement != Judgement::NotKnown && !self.twins.shared(target.address, micros_of(at)) {
            let word = if judgement == Judgement::Wrong { "never had" } else { "had no longer" };
            self.tell(format!("{target}: {id} = {value} at {at}, which the module {word} (during {phase})"));
        }
    }

    fn look_at_line(&mut self, bench: &Bench) {
        let lost = matches!(bench.line(), LineState::Lost { .. });
        match (std::mem::replace(&mut self.was_lost, lost), lost) {
            (false, true) => self.noticed.lost = self.noticed.lost.saturating_add(1),
            (true, false) => self.noticed.restored = self.noticed.restored.saturating_add(1),
            _ => {}
        }
    }

    fn look_at_traffic(&mut self, bench: &Bench) {
        let (log, noticed) = (bench.traffic(), &mut self.noticed);
        noticed.overlooked = noticed.overlooked.saturating_add(log.first_seq().saturating_sub(self.next_frame));
        for frame in (self.next_frame.max(log.first_seq())..log.next_seq()).filter_map(|seq| log.get(seq)) {
            let add = |count: &mut u64, more: u64| *count = count.saturating_add(more);
            add(&mut noticed.with_noise, frame.noise.into());
            add(&mut noticed.with_echo, frame.echo.into());
            match frame.outcome {
                Outcome::Broken(UNASKED) => add(&mut noticed.unasked_bytes, frame.bytes.len() as u64),
                Outcome::Broken(_) => add(&mut noticed.broken, 1),
                Outcome::Silent => add(&mut noticed.silent, 1),
                _ => {}
            }
        }
        self.next_frame = log.next_seq();
    }
}

/// Whether a sample of a recording may stand there.
pub fn judge_sample(truth: &Truth, twins: &Twins, address: u8, item: &str, value: &str, at: Micros) -> Judgement {
    match truth.ever(address, item, value) {
        Judgement::Wrong if twins.shared(address, at) => Judgement::Outdated,
        judgement => judgement,
    }
}

/// For details.
pub fn time(at: Micros) -> String {
    timestamp(at).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_of_the_line_is_known_from_its_newest_answer_even_hours_ahead() {
        let (mut clock, start) = (LineClock::default(), Instant::now());
        let hour = Duration::from_secs(3_600);
        let at = timestamp(1_000_000_000);
        clock.note(at, start);
        clock.note(at + hour, start + Duration::from_secs(1));
        let now = start + Duration::from_secs(2);
        let half = Duration::from_millis(500);
        assert_eq!(clock.instant(at + hour + half, now), Some(start + Duration::from_millis(1_500)));
    }
}
