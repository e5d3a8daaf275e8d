//! Requests of one module: reads, polls, writes, actions, raw frames.

use std::sync::Arc;

use super::super::dialogue::Speaker;
use super::super::message::{BusCommand, BusEvent, ItemSet, RequestId};
use super::super::repeat::Repeat;
use super::super::target::{Patience, Target};
use super::super::watch::Watch;
use super::Worker;
use crate::module::{
    Definition, Identified, ReadPlan, ReadRun, Value, WriteError, identify, moves_to, present_options, run_action,
    write_item,
};
use crate::protocol::Failure;

/// A read or poll under way, one question at a time.
pub struct Reading {
    id: RequestId,
    target: Target,
    plan: ReadPlan,
    run: ReadRun,
    patience: Patience,
    /// What is learned goes back to the watch.
    poll: bool,
}

fn not_offered(id: &str, target: Target) -> WriteError {
    WriteError::NotOffered { id: id.to_owned(), protocol: target.protocol }
}

impl Worker {
    pub(super) fn carry_out(&mut self, command: BusCommand) {
        match command {
            BusCommand::Open { id, line, settings } => self.open(id, line, settings),
            BusCommand::Close { id } => self.close(id),
            BusCommand::Scan { id, plan } => self.begin_scan(id, plan),
            BusCommand::Identify { id, target } => {
                let result = self.identify(target);
                self.tell(BusEvent::Identified { id, target, result });
            }
            BusCommand::Read { id, target, definition, items } => {
                let plan = self.plan(target, &definition, &items);
                self.begin_reading(id, target, plan, Patience::CONVERSATION, false);
            }
            BusCommand::Watch { id, target, definition, items, interval } => {
                let plan = self.plan(target, &definition, &items);
                self.watches.add(Watch::new(id, target, plan, interval));
            }
            BusCommand::Write { id, target, definition, item, value } => {
                let result = self.write(target, &definition, &item, &value);
                let at = self.timestamp();
                self.tell(BusEvent::Written { id, target, item, at, result });
            }
            BusCommand::Act { id, target, definition, action } => self.act(id, target, &definition, action),
            BusCommand::Repeat { id, target, definition, action, period } => {
                self.repeats.add(Repeat::new(id, target, definition, action, period));
            }
            BusCommand::Raw { id, request, settings } => {
                let result = self.dialogue().and_then(|dialogue| {
                    dialogue.configure(settings)?;
                    dialogue.raw(&request, Patience::WRITE_WINDOW)
                });
                self.note_loss(result.as_ref().err().cloned());
                self.tell(BusEvent::RawAnswer { id, result });
            }
            BusCommand::PauseScan(_)
            | BusCommand::CancelScan
            | BusCommand::Unwatch { .. }
            | BusCommand::StopRepeating { .. } => self.take(command),
        }
    }

    fn act(&mut self, id: RequestId, target: Target, definition: &Arc<Definition>, action: String) {
        let result = self.change(target, definition, &action, |speaker| {
            let known = definition.action(&action).ok_or_else(|| not_offered(&action, target))?;
            run_action(known, target.protocol, target.address, speaker)
        });
        let at = self.timestamp();
        self.tell(BusEvent::Acted { id, target, action, at, result });
    }

    /// Carries out the repeated action whose time has come. False if there is none.
    pub(super) fn repeat(&mut self) -> bool {
        if self.dialogue().is_err() {
            return false;
        }
        let Some(due) = self.repeats.take_due(std::time::Instant::now()) else { return false };
        self.act(due.id, due.target, &due.definition, due.action);
        true
    }

    pub(super) fn stop_repeating(&mut self, target: &Target, action: &str) {
        self.repeats.remove(target, action);
        self.queue.forget_repeats(target, action);
    }

    fn identify(&mut self, target: Target) -> Result<Identified, Failure> {
        let catalogue = self.catalogue.clone();
        let result = self.dialogue().and_then(|dialogue| {
            let mut speaker = dialogue.with(target, Patience::CONVERSATION);
            identify(&catalogue, target.protocol, target.address, &mut speaker)
        });
        self.note_loss(result.as_ref().err().cloned());
        if let Ok(identified) = &result {
            self.note_identity(target, identified);
        }
        result
    }

    /// Who answers at `target` from now on. Who was known there before has gone, with its optional parts.
    pub(super) fn note_identity(&mut self, target: Target, identified: &Identified) {
        let known = (target, identified.model().to_owned());
        if !self.identified.contains(&known) {
            self.identified.retain(|(at, _)| *at != target);
            self.options.remove(&target);
        }
        if identified.definition.is_some() {
            self.identified.insert(known);
        }
    }

    fn write(
        &mut self,
        target: Target,
        definition: &Arc<Definition>,
        item: &str,
        value: &Value,
    ) -> Result<Value, WriteError> {
        let known = definition.item(item).ok_or_else(|| not_offered(item, target))?;
        let result = self.change(target, definition, item, |speaker| {
            write_item(definition, target.protocol, target.address, known, value, speaker)
        });
        if let (Ok(_), Some(address)) = (&result, moves_to(known, value)) {
            self.follow(target, Target { address, ..target }, &definition.id);
        }
        result
    }

    /// What is known of a module goes with it to its new address.
    fn follow(&mut self, from: Target, to: Target, model: &str) {
        self.watches.follow(&from, to);
        self.repeats.follow(&from, to);
        if let Some(options) = self.options.remove(&from) {
            self.options.insert(to, options);
        }
        self.identified.remove(&(from, model.to_owned()));
        self.identified.insert((to, model.to_owned()));
    }

    /// Lets `change` write to a module that has said that it is of this model since the line was opened.
    fn change<T>(
        &mut self,
        target: Target,
        definition: &Definition,
        id: &str,
        change: impl FnOnce(&mut Speaker<'_>) -> Result<T, WriteError>,
    ) -> Result<T, WriteError> {
        if !self.identified.contains(&(target, definition.id.clone())) {
            let unread = |failure| WriteError::ReadFirst { id: id.to_owned(), failure };
            let found = self.identify(target).map_err(unread)?;
            if found.model() != definition.id {
                let (expected, found) = (definition.id.clone(), found.model().to_owned());
                return Err(WriteError::OtherModule { id: id.to_owned(), expected, found });
            }
        }
        let result = match self.dialogue() {
            Ok(dialogue) => change(&mut dialogue.with(target, Patience::CONVERSATION)),
            Err(failure) => Err(WriteError::ReadFirst { id: id.to_owned(), failure }),
        };
        let lost = result.as_ref().err().and_then(WriteError::failure).cloned();
        self.note_loss(lost);
        result
    }

    /// What to read of `target`; asks once which optional parts it has.
    fn plan(&mut self, target: Target, definition: &Arc<Definition>, items: &ItemSet) -> ReadPlan {
        if let ItemSet::Named(ids) = items {
            return ReadPlan::new(definition, target.protocol, ids.iter().map(String::as_str));
        }
        let present = self.options_of(target, definition);
        let ids = match items {
            ItemSet::All => definition.readable_ids(target.protocol, &present),
            _ => definition.live_ids(target.protocol, &present),
        };
        ReadPlan::new(definition, target.protocol, ids)
    }

    fn options_of(&mut self, target: Target, definition: &Definition) -> Vec<String> {
        if let Some(known) = self.options.get(&target) {
            return known.clone();
        }
        let asked = self.dialogue().and_then(|dialogue| {
            present_options(definition, target.protocol, &mut dialogue.with(target, Patience::CONVERSATION))
        });
        match asked {
            Ok(present) => {
                self.options.insert(target, present.clone());
                self.tell(BusEvent::Parts { target, present: present.clone() });
                present
            }
            Err(failure) => {
                self.note_loss(Some(failure));
                Vec::new()
            }
        }
    }

    fn begin_reading(&mut self, id: RequestId, target: Target, mut plan: ReadPlan, patience: Patience, poll: bool) {
        if let Err(failure) = self.dialogue() {
            let at = self.timestamp();
            let values = plan.all_failed(&failure, at);
            return self.tell(BusEvent::Read { id, target, at, values });
        }
        let run = plan.begin(target.address);
        self.reading = Some(Reading { id, target, plan, run, patience, poll });
    }

    /// Asks the next question of the read under way, and tells its result when it was the last.
    pub(super) fn read_on(&mut self) {
        let Some(mut reading) = self.reading.take() else { return };
        let Reading { target, plan, run, patience, .. } = &mut reading;
        let at = self.timestamp();
        let more = match self.dialogue() {
            Ok(dialogue) => plan.step(run, target.address, &mut dialogue.with(*target, *patience)),
            Err(failure) => {
                run.fail(&failure, at);
                false
            }
        };
        if more {
            self.reading = Some(reading);
        } else {
            self.end_reading(reading);
        }
    }

    fn end_reading(&mut self, reading: Reading) {
        let Reading { id, target, plan, run, poll, .. } = reading;
        let at = self.timestamp();
        let values = plan.finish(run, at);
        let lost = values.iter().find_map(|answer| match &answer.result {
            Err(failure @ Failure::LineLost(_)) => Some(failure.clone()),
            _ => None,
        });
        if poll {
            self.watches.learned(&target, plan);
        }
        self.note_loss(lost);
        self.tell(BusEvent::Read { id, target, at, values });
    }

    /// Begins to poll the module whose turn it is. False if none is due.
    pub(super) fn poll(&mut self) -> bool {
        if self.dialogue().is_err() {
            return false;
        }
        let Some(watch) = self.watches.take_due(std::time::Instant::now()) else { return false };
        let (id, target, plan) = (watch.id, watch.target, watch.plan.clone());
        self.begin_reading(id, target, plan, Patience::POLL, true);
        true
    }

    pub(super) fn unwatch(&mut self, target: &Target) {
        self.watches.remove(target);
        self.queue.forget_watches(target);
    }
}
