//! Requests of one module: reads, polls, writes, actions, raw frames.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::super::dialogue::Speaker;
use super::super::message::{BusCommand, BusEvent, ItemSet, RequestId};
use super::super::repeat::Repeat;
use super::super::target::{Patience, Target};
use super::super::watch::{Poll, Watch, plan_of};
use super::Worker;
use crate::module::{
    Ask as _, Definition, Identified, ReadPlan, ReadRun, Value, WriteError, identify, moves_to, present_options,
    run_action, write_item,
};
use crate::protocol::Failure;

/// A read or poll under way, one question at a time.
pub struct Reading {
    id: RequestId,
    target: Target,
    plan: ReadPlan,
    run: ReadRun,
    /// Plan and run when it was last certain which answer belonged to which question: what has come since is forgotten
    /// where it is not.
    certain: (ReadPlan, ReadRun),
    since: Instant,
    patience: Patience,
    /// What is learned goes back to the watch, and what comes is told in parts.
    poll: bool,
    /// The module has answered.
    heard: bool,
    /// When it fell silent, if it has not answered since.
    silent_since: Option<Instant>,
    /// How often it went back to what is certain since that was made so; then every answer is made certain by itself.
    went_back: u8,
    careful: bool,
}

/// On a slow line a reading takes seconds: what it has brought is made certain earlier, so that less is lost where an answer
/// too many comes, and a recording has it in time.
const CERTAIN_AFTER: Duration = Duration::from_millis(300);

/// A module that falls silent in the middle of a reading does not hold up the others for longer: answers that are late hold
/// back those behind them, but not for so long.
const GONE_AFTER: Duration = Duration::from_secs(5);

impl Reading {
    /// Forgets what has come since it was last certain whose the answers were.
    fn forget_uncertain(&mut self) {
        (self.plan, self.run) = self.certain.clone();
        self.careful = true;
    }
}

/// What a module said to a write, unless it is not certain that it was said to this one.
fn made_certain<T>(outcome: Result<T, WriteError>, id: &str, speaker: &mut Speaker<'_>) -> Result<T, WriteError> {
    if !matches!(outcome, Ok(_) | Err(WriteError::Differs { .. } | WriteError::Refused { .. })) {
        return outcome;
    }
    match (speaker.certain(), outcome) {
        (Ok(()), outcome) => outcome,
        (Err(failure), Err(WriteError::Refused { .. })) => {
            let read_back = "nothing: it is not certain what was refused".to_owned();
            Err(WriteError::Unknown { id: id.to_owned(), failure, read_back })
        }
        (Err(failure), _) => Err(WriteError::NotVerified { id: id.to_owned(), failure }),
    }
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
            BusCommand::Know(catalogue) => self.catalogue = catalogue,
            BusCommand::Identify { id, target } => {
                let result = self.identify(target);
                self.tell(BusEvent::Identified { id, target, result });
            }
            BusCommand::Read { id, target, definition, items } => {
                let plan = self.plan(target, &definition, &items);
                self.begin_reading(id, target, plan, self.patience(), false);
            }
            BusCommand::Watch { id, target, definition, items, interval } => {
                let parts = self.parts_without_asking(target, &definition);
                let now = self.line_time();
                self.watches.add(Watch::new(id, target, definition, items, parts.as_deref()), interval, now);
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
            BusCommand::Raw { id, request, settings } => self.raw(id, &request, settings),
            BusCommand::Tune(tuning) => self.tuning = tuning,
            BusCommand::PauseScan(_)
            | BusCommand::CancelScan
            | BusCommand::Unwatch { .. }
            | BusCommand::StopRepeating { .. } => self.take(command),
        }
    }

    fn act(&mut self, id: RequestId, target: Target, definition: &Arc<Definition>, action: String) {
        let result = self.change(target, definition, &action, |speaker| {
            let known = definition.action(&action).ok_or_else(|| not_offered(&action, target))?;
            let outcome = run_action(known, target.protocol, target.address, speaker);
            made_certain(outcome, &action, speaker)
        });
        let at = self.timestamp();
        self.tell(BusEvent::Acted { id, target, action, at, result });
    }

    /// Carries out the repeated action whose time has come. False if there is none.
    pub(super) fn repeat(&mut self) -> bool {
        if self.dialogue().is_err() {
            return false;
        }
        let Some(due) = self.repeats.take_due(Instant::now()) else { return false };
        self.act(due.id, due.target, &due.definition, due.action);
        true
    }

    pub(super) fn stop_repeating(&mut self, target: &Target, action: &str) {
        self.repeats.remove(target, action);
        self.queue.forget_repeats(target, action);
    }

    fn identify(&mut self, target: Target) -> Result<Identified, Failure> {
        let (catalogue, patience) = (self.catalogue.clone(), self.patience());
        let result = self.dialogue().and_then(|dialogue| {
            let mut speaker = dialogue.with(target, patience);
            let identified = identify(&catalogue, target.protocol, target.address, &mut speaker)?;
            dialogue.verify(&target, patience)?;
            Ok(identified)
        });
        self.note_loss(result.as_ref().err().cloned());
        if let Ok(identified) = &result {
            self.note_identity(target, identified);
        }
        result
    }

    /// Who answers at `target` from now on. Who was known there before has gone, with its optional parts.
    pub(super) fn note_identity(&mut self, target: Target, identified: &Identified) {
        let now = self.line_time();
        self.watches.heard(&target, now);
        let known = (target, identified.model().to_owned());
        if !self.identified.contains(&known) {
            self.identified.retain(|(at, _)| *at != target);
            self.options.remove(&target);
            // A damaged name is that of no model.
            if identified.definition.is_some()
                && let Ok(dialogue) = self.dialogue()
            {
                dialogue.believe_name(&target);
            }
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
            let outcome = write_item(definition, target.protocol, target.address, known, value, speaker);
            // Who has moved is not there any more to be asked.
            if moves_to(known, value).is_some() { outcome } else { made_certain(outcome, item, speaker) }
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
        let patience = self.patience();
        if let Ok(dialogue) = self.dialogue() {
            dialogue.learn_name_anew(&from, &to, patience);
        }
    }

    /// Lets `change` write to a module that has said that it is of this model since the line was opened.
    fn change<T>(
        &mut self,
        target: Target,
        definition: &Definition,
        id: &str,
        change: impl FnOnce(&mut Speaker<'_>) -> Result<T, WriteError>,
    ) -> Result<T, WriteError> {
        self.secure_reading(&target);
        if !self.identified.contains(&(target, definition.id.clone())) {
            let unread = |failure| WriteError::ReadFirst { id: id.to_owned(), failure };
            let found = self.identify(target).map_err(unread)?;
            if found.model() != definition.id {
                let (expected, found) = (definition.id.clone(), found.model().to_owned());
                return Err(WriteError::OtherModule { id: id.to_owned(), expected, found });
            }
        }
        let patience = self.patience();
        let result = match self.dialogue() {
            Ok(dialogue) => change(&mut dialogue.with(target, patience)),
            Err(failure) => Err(WriteError::ReadFirst { id: id.to_owned(), failure }),
        };
        let lost = result.as_ref().err().and_then(WriteError::failure).cloned();
        self.note_loss(lost);
        result
    }

    /// What to read of `target`; asks once which optional parts it has.
    fn plan(&mut self, target: Target, definition: &Arc<Definition>, items: &ItemSet) -> ReadPlan {
        let parts = match items {
            ItemSet::Named(_) => None,
            _ => self.parts_of(target, definition, self.patience()),
        };
        plan_of(definition, &target, items, &parts.unwrap_or_default())
    }

    /// Which optional parts a module has. `None` if it does not say.
    fn parts_of(&mut self, target: Target, definition: &Definition, patience: Patience) -> Option<Vec<String>> {
        if let Some(known) = self.options.get(&target) {
            return Some(known.clone());
        }
        let asked = self.dialogue().and_then(|dialogue| {
            let mut speaker = dialogue.with(target, patience);
            let present = present_options(definition, target.protocol, &mut speaker)?;
            // They are believed for as long as the line is open.
            speaker.certain().map(|()| present)
        });
        match asked {
            Ok(present) => {
                self.options.insert(target, present.clone());
                self.tell(BusEvent::Parts { target, present: present.clone() });
                Some(present)
            }
            Err(failure) => {
                self.note_loss(Some(failure));
                None
            }
        }
    }

    /// The same without a question to the module; `None` if it would take one.
    fn parts_without_asking(&mut self, target: Target, definition: &Definition) -> Option<Vec<String>> {
        let nothing_to_ask = definition.optional.is_empty() || !target.protocol.is_modbus();
        if nothing_to_ask || self.options.contains_key(&target) {
            self.parts_of(target, definition, self.patience())
        } else {
            None
        }
    }

    /// Asks a watched module that answers for its optional parts, if they are not known yet.
    fn complete_watch(&mut self, target: Target) {
        if let Some(definition) = self.watches.wants_parts(&target)
            && let Some(parts) = self.parts_of(target, &definition, self.patience())
        {
            self.watches.has_parts(&target, &parts);
        }
    }

    fn begin_reading(&mut self, id: RequestId, target: Target, mut plan: ReadPlan, patience: Patience, poll: bool) {
        if let Err(failure) = self.dialogue() {
            let at = self.timestamp();
            let values = plan.all_failed(&failure, at);
            return self.tell(BusEvent::Read { id, target, at, values });
        }
        let (run, since) = (plan.begin(target.address), self.line_time());
        let certain = (plan.clone(), run.clone());
        self.reading = Some(Reading {
            id,
            target,
            plan,
            run,
            certain,
            since,
            patience,
            poll,
            heard: false,
            silent_since: None,
            went_back: 0,
            careful: false,
        });
    }

    /// Asks the next question of the read under way, and tells its result when it was the last.
    pub(super) fn read_on(&mut self) {
        let Some(mut reading) = self.reading.take() else { return };
        let Reading { target, plan, run, patience, .. } = &mut reading;
        let (at, asked_at) = (self.timestamp(), self.line_time());
        let mut more = match self.dialogue() {
            Ok(dialogue) => plan.step(run, target.address, &mut dialogue.with(*target, *patience)),
            Err(failure) => {
                run.fail(&failure, at);
                false
            }
        };
        reading.heard |= reading.run.is_answered();
        if more && self.is_silent_for_long(&mut reading, asked_at) {
            reading.run.fail(&Failure::Silent, self.timestamp());
            more = false;
        }
        let uncertain_for = self.line_time().saturating_duration_since(reading.since);
        if more && !reading.careful && uncertain_for < CERTAIN_AFTER {
            self.reading = Some(reading);
            return;
        }
        match (self.verify(&reading), more) {
            (Err(failure), _) => self.go_back(reading, failure),
            (Ok(()), true) => {
                self.note_certain(&mut reading);
                self.reading = Some(reading);
            }
            (Ok(()), false) => self.end_reading(reading),
        }
    }

    /// Whether the module has been silent for as long as one that is gone; its last question was asked at `asked_at`.
    fn is_silent_for_long(&mut self, reading: &mut Reading, asked_at: Instant) -> bool {
        if !reading.run.is_silent() {
            reading.silent_since = None;
            return false;
        }
        let since = *reading.silent_since.get_or_insert(asked_at);
        self.line_time().saturating_duration_since(since) >= GONE_AFTER
    }

    /// Nothing is told before it is certain which answer belongs to which question.
    fn verify(&mut self, reading: &Reading) -> Result<(), Failure> {
        match self.dialogue() {
            Ok(dialogue) if reading.run.is_answered() => dialogue.verify(&reading.target, reading.patience),
            _ => Ok(()),
        }
    }

    /// Before something else is asked of the module of the reading under way: what has come so far is made certain, or forgotten,
    /// as doubts are not told apart by who has them.
    fn secure_reading(&mut self, target: &Target) {
        let Some(mut reading) = self.reading.take_if(|reading| reading.target == *target) else { return };
        match self.verify(&reading) {
            Ok(()) => self.note_certain(&mut reading),
            Err(_) => reading.forget_uncertain(),
        }
        self.reading = Some(reading);
    }

    /// Asks again what has come since it was last certain whose the answers were, or does without it.
    fn go_back(&mut self, mut reading: Reading, failure: Failure) {
        reading.forget_uncertain();
        if failure.is_garbage() && reading.went_back < reading.patience.after_garbage {
            reading.went_back = reading.went_back.saturating_add(1);
            self.reading = Some(reading);
        } else {
            reading.run.fail(&failure, self.timestamp());
            self.end_reading(reading);
        }
    }

    fn note_certain(&mut self, reading: &mut Reading) {
        let Reading { id, target, plan, run, certain, since, poll, went_back, .. } = reading;
        (*certain, *since, *went_back) = ((plan.clone(), run.clone()), self.line_time(), 0);
        let values = if *poll { plan.so_far(run) } else { Vec::new() };
        if !values.is_empty() {
            self.tell(BusEvent::Reading { id: *id, target: *target, values });
        }
    }

    /// Tells what the reading has brought.
    fn end_reading(&mut self, reading: Reading) {
        let Reading { id, target, plan, run, poll, heard, .. } = reading;
        let (at, now) = (self.timestamp(), self.line_time());
        let values = plan.finish(run, at);
        let lost = values.iter().find_map(|answer| match &answer.result {
            Err(failure @ Failure::LineLost(_)) => Some(failure.clone()),
            _ => None,
        });
        match (poll, lost) {
            // A line that is lost tells nothing of the module.
            (_, Some(lost)) => self.note_loss(Some(lost)),
            (true, None) => self.watches.polled(id, &target, plan, heard, now),
            (false, None) if heard => self.watches.heard(&target, now),
            (false, None) => {}
        }
        self.tell(BusEvent::Read { id, target, at, values });
        if poll && heard {
            self.complete_watch(target);
        }
    }

    /// Begins to poll the module whose turn it is. False if none is due.
    pub(super) fn poll(&mut self) -> bool {
        if self.dialogue().is_err() {
            return false;
        }
        let now = self.line_time();
        let Some(Poll { id, target, plan, was_silent }) = self.watches.take_due(now) else { return false };
        let patience = if was_silent { self.patience().probing() } else { self.patience() };
        if was_silent && let Some(failure) = self.dialogue().and_then(|line| line.greet(&target, patience.window)).err()
        {
            self.stayed_silent(id, target, plan, failure);
            return true;
        }
        self.begin_reading(id, target, plan, patience, true);
        true
    }

    fn stayed_silent(&mut self, id: RequestId, target: Target, plan: ReadPlan, failure: Failure) {
        let (at, now) = (self.timestamp(), self.line_time());
        let values = plan.all_failed(&failure, at);
        match failure {
            failure @ Failure::LineLost(_) => self.note_loss(Some(failure)),
            _ => self.watches.polled(id, &target, plan, false, now),
        }
        self.tell(BusEvent::Read { id, target, at, values });
    }

    /// The line is to be closed, or another one to be opened: what is only read of this one is not waited for.
    pub(super) fn abandon_reads(&mut self) {
        self.reading = None;
        self.queue.forget_reads();
    }

    pub(super) fn unwatch(&mut self, target: &Target) {
        self.watches.remove(target);
        self.queue.forget_watches(target);
    }
}
