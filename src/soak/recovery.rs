//! How long it takes after a fault's end until everything is as it was: from the line, and from every module.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use super::truth::Judgement;
use super::watch::Watch;
use crate::bench::{Bench, Module};
use crate::bus::Target;

/// A recovery under way.
pub struct Recovery {
    since: Instant,
    missing: BTreeSet<Target>,
    /// Until the first module was heard.
    pub line: Option<Duration>,
    /// Until the last was, and which one that is.
    pub all: Option<(Duration, Target)>,
}

impl Recovery {
    /// All of these are to be heard again.
    pub fn new(since: Instant, targets: &[Target]) -> Self {
        Self { since, missing: targets.iter().copied().collect(), line: None, all: None }
    }

    /// Modules that were not heard again yet.
    pub fn missing(&self) -> impl Iterator<Item = &Target> {
        self.missing.iter()
    }

    pub fn look(&mut self, bench: &Bench, watch: &Watch, now: Instant) {
        let Self { since, missing, line, all } = self;
        let elapsed = now.saturating_duration_since(*since);
        for module in bench.modules().iter().filter(|module| module.interval.is_some()) {
            if line.is_none() && any_since(module, watch, *since, now) {
                *line = Some(elapsed);
            }
            if missing.contains(&module.target) && is_current(module, watch, *since, now) {
                missing.remove(&module.target);
                *all = missing.is_empty().then_some((elapsed, module.target));
            }
        }
    }
}

fn any_since(module: &Module, watch: &Watch, since: Instant, now: Instant) -> bool {
    module.readings.values().filter_map(|reading| reading.at).any(|at| is_since(at, watch, since, now))
}

fn is_since(at: jiff::Timestamp, watch: &Watch, since: Instant, now: Instant) -> bool {
    watch.measured(at, now).is_some_and(|measured| measured >= since)
}

/// Everything that is polled was measured after `since` and is what the module has now.
fn is_current(module: &Module, watch: &Watch, since: Instant, now: Instant) -> bool {
    let polled = module.polled_items();
    !polled.is_empty()
        && polled.into_iter().all(|id| {
            let Some(reading) = module.reading(id) else { return false };
            let (Some(value), Some(at), None) = (&reading.value, reading.at, &reading.problem) else { return false };
            let judgement = watch.truth.is_now(module.target.address, id, &value.to_string());
            is_since(at, watch, since, now) && judgement != Judgement::Outdated
        })
}
