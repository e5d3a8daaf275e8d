//! Actions that are carried out again and again, such as Host OK.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::message::RequestId;
use super::target::Target;
use crate::module::Definition;

/// The line has to be left to others too.
const SHORTEST_PERIOD: Duration = Duration::from_millis(50);
const LONGEST_PERIOD: Duration = Duration::from_secs(24 * 60 * 60);

/// One action that is repeated.
#[derive(Debug, Clone)]
pub struct Repeat {
    pub id: RequestId,
    pub target: Target,
    pub definition: Arc<Definition>,
    pub action: String,
    period: Duration,
    due: Instant,
}

impl Repeat {
    /// Due at once, then after each period, which is kept within 50 ms and a day.
    pub fn new(id: RequestId, target: Target, definition: Arc<Definition>, action: String, period: Duration) -> Self {
        Self {
            id,
            target,
            definition,
            action,
            period: period.clamp(SHORTEST_PERIOD, LONGEST_PERIOD),
            due: Instant::now(),
        }
    }
}

/// All repetitions of a line.
#[derive(Default)]
pub struct Repeats {
    all: Vec<Repeat>,
}

impl Repeats {
    pub fn add(&mut self, repeat: Repeat) {
        self.remove(&repeat.target, &repeat.action);
        self.all.push(repeat);
    }

    pub fn remove(&mut self, target: &Target, action: &str) {
        self.all.retain(|repeat| repeat.target != *target || repeat.action != action);
    }

    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// The module `from` is now `to`.
    pub fn follow(&mut self, from: &Target, to: Target) {
        for repeat in self.all.iter_mut().filter(|repeat| repeat.target == *from) {
            repeat.target = to;
        }
    }

    pub fn next_due(&self) -> Option<Instant> {
        self.all.iter().map(|repeat| repeat.due).min()
    }

    /// The most overdue action, if any is due. What was missed is not caught up.
    pub fn take_due(&mut self, now: Instant) -> Option<Repeat> {
        let repeat = self.all.iter_mut().filter(|repeat| repeat.due <= now).min_by_key(|repeat| repeat.due)?;
        let next = repeat.due + repeat.period;
        repeat.due = if next > now { next } else { now + repeat.period };
        Some(repeat.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::module::Catalogue;
    use crate::protocol::{LineSettings, Protocol};

    fn repeat(period: u64) -> Repeat {
        let target =
            Target { address: 1, protocol: Protocol::Dcon, settings: LineSettings::default(), checksum: false };
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        Repeat::new(RequestId(1), target, definition, "host_ok".to_owned(), Duration::from_millis(period))
    }

    #[test]
    fn an_action_is_due_at_once_and_then_once_in_each_period() {
        let mut repeats = Repeats::default();
        repeats.add(repeat(100));
        let start = repeats.next_due().unwrap();
        assert!(repeats.take_due(start).is_some());
        assert!(repeats.take_due(start + Duration::from_millis(99)).is_none());
        assert!(repeats.take_due(start + Duration::from_millis(100)).is_some());
    }

    #[test]
    fn missed_times_are_not_caught_up() {
        let mut repeats = Repeats::default();
        repeats.add(repeat(100));
        let late = repeats.next_due().unwrap() + Duration::from_secs(5);
        assert!(repeats.take_due(late).is_some());
        assert!(repeats.take_due(late + Duration::from_millis(99)).is_none());
    }

    #[test]
    fn a_new_period_replaces_the_old_one() {
        let mut repeats = Repeats::default();
        repeats.add(repeat(100));
        repeats.add(repeat(200));
        let start = repeats.next_due().unwrap();
        assert!(repeats.take_due(start).is_some());
        assert!(repeats.take_due(start).is_none());
    }
}
