//! What is read again and again.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::message::{ItemSet, RequestId};
use super::schedule::Schedule;
use super::target::Target;
use crate::module::{Definition, ReadPlan};

/// Polls after which a module that answers, but not to the question for its optional parts, is asked for them again.
const ASK_PARTS_AGAIN_AFTER: u16 = 60;

/// One module that is watched.
pub struct Watch {
    id: RequestId,
    target: Target,
    definition: Arc<Definition>,
    items: ItemSet,
    plan: ReadPlan,
    /// Polls to go until it is asked for its optional parts; `None` once they are known.
    parts_in: Option<u16>,
}

impl Watch {
    /// `parts` is `None` if it is not known yet which optional parts the module has: it is polled without them until it
    /// has told.
    pub fn new(
        id: RequestId,
        target: Target,
        definition: Arc<Definition>,
        items: ItemSet,
        parts: Option<&[String]>,
    ) -> Self {
        let plan = plan_of(&definition, &target, &items, parts.unwrap_or_default());
        let parts_in = if parts.is_none() && !matches!(items, ItemSet::Named(_)) { Some(0) } else { None };
        Self { id, target, definition, items, plan, parts_in }
    }
}

/// What to read of a module with these optional parts.
pub fn plan_of(definition: &Arc<Definition>, target: &Target, items: &ItemSet, parts: &[String]) -> ReadPlan {
    let protocol = target.protocol;
    match items {
        ItemSet::Named(ids) => ReadPlan::new(definition, protocol, ids.iter().map(String::as_str)),
        ItemSet::All => ReadPlan::new(definition, protocol, definition.readable_ids(protocol, parts)),
        ItemSet::Live => ReadPlan::new(definition, protocol, definition.live_ids(protocol, parts)),
    }
}

/// A poll that is due.
pub struct Poll {
    pub id: RequestId,
    pub target: Target,
    pub plan: ReadPlan,
    /// It did not answer the poll before.
    pub was_silent: bool,
}

/// All watches of a line; each module has one at most. Times are the line's.
#[derive(Default)]
pub struct Watches {
    all: Vec<Watch>,
    schedule: Schedule<Target>,
}

impl Watches {
    /// Due at once, then after each interval.
    pub fn add(&mut self, watch: Watch, interval: Duration, now: Instant) {
        self.remove(&watch.target);
        self.schedule.add(watch.target, interval, now);
        self.all.push(watch);
    }

    pub fn remove(&mut self, target: &Target) {
        self.schedule.remove(*target);
        self.all.retain(|watch| watch.target != *target);
    }

    /// The module `from` is now `to`, where nobody answered before.
    pub fn follow(&mut self, from: &Target, to: Target) {
        if self.watch(from).is_none() {
            return;
        }
        self.remove(&to);
        self.schedule.rename(*from, to);
        if let Some(watch) = self.watch(from) {
            watch.target = to;
        }
    }

    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// When the next poll is due.
    pub fn next_due(&self) -> Option<Instant> {
        self.schedule.next_due()
    }

    /// The poll whose turn it is, if any is due.
    pub fn take_due(&mut self, now: Instant) -> Option<Poll> {
        let target = self.schedule.take_due(now)?;
        let was_silent = self.schedule.is_silent(target);
        let watch = self.watch(&target)?;
        Some(Poll { id: watch.id, target, plan: watch.plan.clone(), was_silent })
    }

    /// A poll is over. `plan` is what it has learned about how to read the module.
    pub fn polled(&mut self, id: RequestId, target: &Target, plan: ReadPlan, answered: bool, now: Instant) {
        let Some(watch) = self.watch(target).filter(|watch| watch.id == id) else { return };
        if let Some(polls) = &mut watch.parts_in {
            *polls = if answered { polls.saturating_sub(1) } else { 0 };
        }
        let idle = plan.is_idle();
        watch.plan = plan;
        if answered {
            self.schedule.heard(*target, now);
        } else if !idle {
            self.schedule.stayed_silent(*target, now);
        }
        if idle {
            self.schedule.refuses_all(*target);
        }
    }

    /// The module has answered to another question than a poll.
    pub fn heard(&mut self, target: &Target, now: Instant) {
        self.schedule.heard(*target, now);
    }

    /// The line is there again: all are due.
    pub fn begin_anew(&mut self, now: Instant) {
        self.schedule.begin_anew(now);
    }

    /// The definition of a module that is now to be asked for its optional parts.
    pub fn wants_parts(&mut self, target: &Target) -> Option<Arc<Definition>> {
        let watch = self.watch(target).filter(|watch| watch.parts_in == Some(0))?;
        watch.parts_in = Some(ASK_PARTS_AGAIN_AFTER);
        Some(watch.definition.clone())
    }

    /// The module has these optional parts, which are polled too from now on.
    pub fn has_parts(&mut self, target: &Target, parts: &[String]) {
        let Some(watch) = self.watch(target) else { return };
        watch.parts_in = None;
        let complete = plan_of(&watch.definition, target, &watch.items, parts);
        watch.plan.complete(complete);
    }

    fn watch(&mut self, target: &Target) -> Option<&mut Watch> {
        self.all.iter_mut().find(|watch| watch.target == *target)
    }
}
