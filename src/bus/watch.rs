//! What is read again and again, and when it is due.

use std::time::{Duration, Instant};

use super::message::RequestId;
use super::target::Target;
use crate::module::ReadPlan;

const LONGEST_INTERVAL: Duration = Duration::from_secs(24 * 60 * 60);
/// A module that refuses everything is not asked as fast as the line allows.
const IDLE_INTERVAL: Duration = Duration::from_secs(1);

/// One module that is watched.
pub struct Watch {
    pub id: RequestId,
    pub target: Target,
    pub plan: ReadPlan,
    pub interval: Duration,
    due: Instant,
}

impl Watch {
    pub fn new(id: RequestId, target: Target, plan: ReadPlan, interval: Duration) -> Self {
        Self { id, target, plan, interval: interval.min(LONGEST_INTERVAL), due: Instant::now() }
    }

    /// Sets the time of the next poll. Missed polls are not caught up.
    fn schedule(&mut self, now: Instant) {
        let interval = if self.plan.is_idle() { self.interval.max(IDLE_INTERVAL) } else { self.interval };
        let next = self.due + interval;
        self.due = if next > now { next } else { now };
    }
}

/// All watches of a line; each module has one at most.
#[derive(Default)]
pub struct Watches {
    all: Vec<Watch>,
}

impl Watches {
    pub fn add(&mut self, watch: Watch) {
        self.remove(&watch.target);
        self.all.push(watch);
    }

    pub fn remove(&mut self, target: &Target) {
        self.all.retain(|watch| watch.target != *target);
    }

    /// The module `from` is now `to`.
    pub fn follow(&mut self, from: &Target, to: Target) {
        if let Some(watch) = self.all.iter_mut().find(|watch| watch.target == *from) {
            watch.target = to;
        }
    }

    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// Keeps what a poll learned about how to read the module.
    pub fn learned(&mut self, target: &Target, plan: ReadPlan) {
        if let Some(watch) = self.all.iter_mut().find(|watch| watch.target == *target) {
            watch.plan = plan;
        }
    }

    /// When the next poll is due.
    pub fn next_due(&self) -> Option<Instant> {
        self.all.iter().map(|watch| watch.due).min()
    }

    /// The watch that has been due for longest, with its next time set.
    pub fn take_due(&mut self, now: Instant) -> Option<&mut Watch> {
        let watch = self.all.iter_mut().filter(|watch| watch.due <= now).min_by_key(|watch| watch.due)?;
        watch.schedule(now);
        Some(watch)
    }
}
