//! When each of several modules is asked next, on a line that has time for one of them only.
//!
//! The contract: whoever has been due for longest is next, so that modules polled as fast as the line allows take
//! turns. Missed times are not caught up; a module keeps its rhythm. One that stays silent is probed ever more rarely
//! and is back at its interval as soon as it answers. Times are passed in, in order.

use std::time::{Duration, Instant};

const LONGEST_INTERVAL: Duration = Duration::from_secs(24 * 60 * 60);
/// A module that refuses everything is not asked as fast as the line allows.
const IDLE_INTERVAL: Duration = Duration::from_secs(1);
/// A silent module is probed at least so often, unless its own interval is longer.
const LONGEST_SILENCE: Duration = Duration::from_secs(10);
/// The same where no module answers, so that no probe holds up another.
const LONGEST_SILENCE_ALONE: Duration = Duration::from_secs(2);
/// A module that fell silent a shorter time ago is probed at its interval: a fault of the line passes, and then all are to be
/// back at once.
const SHORT_SILENCE: Duration = Duration::from_secs(10);
/// Such probes take one part in so many of the line at most, all silent modules together.
const SHARE_OF_PROBES: u32 = 2;
/// A probe is one question; the poll in which a module fell silent repeated it.
const COST_OF_PROBE: Duration = Duration::from_millis(250);
/// Modules that fell silent within so long of each other did so for the same reason: as the first are asked in vain, with
/// repeats, the last are asked so much later.
const SAME_REASON: Duration = SHORT_SILENCE;
/// A probe that fails at once must not be repeated at once.
const SHORTEST_COST: Duration = Duration::from_millis(50);

#[derive(Debug)]
struct Turn<K> {
    key: K,
    interval: Duration,
    due: Instant,
    /// When the poll under way began, or the last one; `None` before the first.
    began: Option<Instant>,
    /// Polls without answer in a row.
    silences: u32,
    /// When the first of them was over.
    silent_since: Option<Instant>,
}

impl<K> Turn<K> {
    /// How long one of so many silent modules is left alone at `now`, `cost` being what its last probe took.
    fn respite(&self, cost: Duration, longest: Duration, silent: u32, now: Instant) -> Duration {
        let since = self.silent_since.map_or(Duration::ZERO, |since| now.saturating_duration_since(since));
        if !self.interval.is_zero() && since < SHORT_SILENCE {
            let shared = cost.min(COST_OF_PROBE).saturating_mul(SHARE_OF_PROBES).saturating_mul(silent);
            return shared.min(longest).max(self.interval);
        }
        let base = if self.interval.is_zero() { cost.max(SHORTEST_COST) } else { self.interval };
        let doubled = base.saturating_mul(1u32.checked_shl(self.silences).unwrap_or(u32::MAX));
        doubled.min(longest).max(self.interval)
    }
}

/// The turns of all modules.
#[derive(Debug)]
pub struct Schedule<K> {
    turns: Vec<Turn<K>>,
}

impl<K> Default for Schedule<K> {
    fn default() -> Self {
        Self { turns: Vec::new() }
    }
}

impl<K: Copy + PartialEq> Schedule<K> {
    /// One more module, due at once. An interval of zero means as fast as the line allows.
    pub fn add(&mut self, key: K, interval: Duration, now: Instant) {
        self.remove(key);
        let interval = interval.min(LONGEST_INTERVAL);
        self.turns.push(Turn { key, interval, due: now, began: None, silences: 0, silent_since: None });
    }

    pub fn remove(&mut self, key: K) {
        self.turns.retain(|turn| turn.key != key);
    }

    pub fn rename(&mut self, from: K, to: K) {
        if let Some(turn) = self.turn(from) {
            turn.key = to;
        }
    }

    /// When the next poll is due.
    pub fn next_due(&self) -> Option<Instant> {
        self.turns.iter().map(|turn| turn.due).min()
    }

    /// The module that has been due for longest, if any is, and of several the one that was polled least recently. Its
    /// poll begins now.
    pub fn take_due(&mut self, now: Instant) -> Option<K> {
        let turn = self.turns.iter_mut().filter(|turn| turn.due <= now).min_by_key(|turn| (turn.due, turn.began))?;
        turn.began = Some(now);
        turn.due = next_in_rhythm(turn.due, turn.interval, now);
        Some(turn.key)
    }

    /// The module has answered, to a poll or to somebody else's question. If nobody did before, the line itself was at
    /// fault: all are due.
    pub fn heard(&mut self, key: K, now: Instant) {
        let nobody_answered = !self.anyone_answers();
        let Some(turn) = self.turn(key) else { return };
        turn.silences = 0;
        let silent_since = turn.silent_since.take();
        turn.due = if silent_since.is_some() { turn.due.min(now + turn.interval) } else { turn.due };
        let same_reason = |other: Option<Instant>| match (silent_since, other) {
            (Some(one), Some(other)) => one.max(other).duration_since(one.min(other)) <= SAME_REASON,
            _ => false,
        };
        for turn in self.turns.iter_mut().filter(|turn| turn.key != key) {
            if nobody_answered || same_reason(turn.silent_since) {
                turn.due = turn.due.min(now);
            }
        }
    }

    /// The poll of `key` brought nothing that shows that anybody is there.
    pub fn stayed_silent(&mut self, key: K, now: Instant) {
        let Some(turn) = self.turn(key) else { return };
        turn.silences = turn.silences.saturating_add(1);
        turn.silent_since.get_or_insert(now);
        let silent = self.turns.iter().filter(|turn| turn.silences > 0).count();
        let silent = u32::try_from(silent).unwrap_or(u32::MAX);
        let alone = !self.anyone_answers();
        let longest = if alone { LONGEST_SILENCE_ALONE } else { LONGEST_SILENCE };
        let Some(turn) = self.turn(key) else { return };
        let cost = turn.began.map(|began| now.saturating_duration_since(began));
        turn.due = now + turn.respite(cost.unwrap_or_default(), longest, silent, now);
        if alone {
            // Those that have long been silent are waited for no longer than this one.
            for turn in &mut self.turns {
                turn.due = turn.due.min(now + LONGEST_SILENCE_ALONE.max(turn.interval));
            }
        }
    }

    /// There is nothing that the module does not refuse: there is no need to hurry.
    pub fn refuses_all(&mut self, key: K) {
        if let Some(turn) = self.turn(key) {
            turn.due = turn.due.max(turn.began.map_or(turn.due, |began| began + IDLE_INTERVAL));
        }
    }

    /// Whether the last poll of `key` brought nothing.
    pub fn is_silent(&self, key: K) -> bool {
        self.turns.iter().any(|turn| turn.key == key && turn.silences > 0)
    }

    /// All are asked at once, as if they had never been asked before.
    pub fn begin_anew(&mut self, now: Instant) {
        for turn in &mut self.turns {
            (turn.due, turn.silences, turn.silent_since) = (now, 0, None);
        }
    }

    /// Whether any module is not known to be silent.
    fn anyone_answers(&self) -> bool {
        self.turns.iter().any(|turn| turn.silences == 0)
    }

    fn turn(&mut self, key: K) -> Option<&mut Turn<K>> {
        self.turns.iter_mut().find(|turn| turn.key == key)
    }
}

/// The first time after `now` that is a whole number of intervals after `due`; `now` if there is no interval.
fn next_in_rhythm(due: Instant, interval: Duration, now: Instant) -> Instant {
    let late = now.saturating_duration_since(due);
    let into = late.as_nanos().checked_rem(interval.as_nanos()).and_then(|rest| u64::try_from(rest).ok());
    into.map_or(now, |into| now + interval.saturating_sub(Duration::from_nanos(into)))
}

#[cfg(test)]
mod tests;
