//! The steps of the guided change and what is known at each of them.

use super::super::Severity;
use super::super::module::Module;
use crate::bus::{RequestId, Target};
use crate::module::Value;
use crate::protocol::{LineSettings, Protocol};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum InitStep {
    /// The user sets DIP 4 ON and switches the power off and on.
    SwitchOn,
    FindInInit,
    Writing,
    /// The user sets DIP 4 OFF and switches the power off and on.
    SwitchOff,
    FindAgain,
    Done,
}

/// What becomes of one setting.
#[derive(Debug, Clone, PartialEq)]
pub struct InitChange {
    pub id: String,
    /// What the module said before; `None` if that is not known.
    pub was: Option<Value>,
    pub value: Value,
    /// `None` until it was written; the reason if it was refused.
    pub outcome: Option<Result<(), String>>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct InitProcedure {
    /// Under which the module is listed at present.
    pub module: Target,
    /// How the module was reached before.
    pub before: Target,
    /// How it is to be reached afterwards.
    pub after: Target,
    /// Where it was found last.
    pub found: Option<Target>,
    pub changes: Vec<InitChange>,
    pub step: InitStep,
    /// How often it was looked for in this step.
    pub attempts: u32,
    /// What stands in the way: a lost line, a stranger at the place that was asked.
    pub problem: Option<String>,
    model: String,
    /// The question that is under way.
    waiting: Option<RequestId>,
    /// The user has said that switch and power were turned.
    begun: bool,
    /// The user has left while a setting was being written.
    left: bool,
}

impl InitProcedure {
    /// For the edits of `module` that need INIT mode; `None` without any.
    pub(super) fn new(module: &Module) -> Option<Self> {
        let changes: Vec<InitChange> =
            module.edited_for_init().into_iter().filter_map(|id| InitChange::of(module, id)).collect();
        if changes.is_empty() {
            return None;
        }
        let there_already = module.known("init_mode") == Some(&Value::Bool(true));
        Some(Self {
            module: module.target,
            before: module.target,
            after: reached_after(module.target, changes.iter()),
            found: None,
            changes,
            step: if there_already { InitStep::FindInInit } else { InitStep::SwitchOn },
            attempts: 0,
            problem: None,
            model: module.identified.model().to_owned(),
            waiting: None,
            begun: there_already,
            left: false,
        })
    }

    /// Where the module may answer in this step, the likeliest first.
    pub fn places(&self) -> Vec<Target> {
        let init = Target { address: 0, protocol: Protocol::Dcon, settings: LineSettings::default(), checksum: false };
        let mut likely = vec![self.before, init];
        if self.step >= InitStep::SwitchOff {
            // With DIP 2 OFF, DIP 1 says the protocol, whatever is stored.
            let kept = reached_after(self.before, self.changes.iter().filter(|change| change.id != "protocol"));
            likely = vec![self.after, self.before, kept];
            if self.after.protocol == Protocol::Dcon {
                likely.push(Target { checksum: !self.after.checksum, ..self.after });
            }
        }
        let mut places = Vec::new();
        for place in likely {
            if !places.contains(&place) {
                places.push(place);
            }
        }
        places
    }

    /// The place that is asked at present, where the module is looked for.
    pub fn asked_now(&self) -> Option<Target> {
        let places = self.places();
        let index = usize::try_from(self.attempts).ok()?.checked_rem(places.len())?;
        places.get(index).copied().filter(|_| self.is_looking())
    }

    pub fn is_looking(&self) -> bool {
        matches!(self.step, InitStep::FindInInit | InitStep::FindAgain)
    }

    /// Whether the module was found with the settings that were wanted.
    pub fn is_as_wanted(&self) -> bool {
        self.step == InitStep::Done && self.found == Some(self.after)
    }

    /// Settings that were refused, with the reason.
    pub fn refused(&self) -> impl Iterator<Item = (&str, &str)> {
        self.changes.iter().filter_map(|change| match &change.outcome {
            Some(Err(reason)) => Some((change.id.as_str(), reason.as_str())),
            _ => None,
        })
    }

    /// Settings that stand in the module.
    fn taken(&self) -> impl Iterator<Item = &InitChange> {
        self.changes.iter().filter(|change| matches!(change.outcome, Some(Ok(()))))
    }

    pub(super) fn model(&self) -> &str {
        &self.model
    }

    /// Whether this is the question under way.
    pub(super) fn awaits(&self, id: RequestId) -> bool {
        self.waiting == Some(id)
    }

    pub(super) fn await_answer(&mut self, id: RequestId) {
        self.waiting = Some(id);
    }

    /// The question under way is answered.
    pub(super) fn take_answer(&mut self) {
        self.waiting = None;
    }

    pub(super) fn is_writing(&self) -> bool {
        self.step == InitStep::Writing && self.waiting.is_some()
    }

    pub(super) fn leave(&mut self) {
        self.left = true;
    }

    /// Whether the user has left; the last write is awaited.
    pub fn is_left(&self) -> bool {
        self.left
    }

    pub(super) fn look(&mut self, step: InitStep) {
        self.step = step;
        self.attempts = 0;
        self.problem = None;
        self.begun = true;
    }

    /// To the step in which the user turns switch and power; an answer that comes later is not waited for.
    pub(super) fn go_back(&mut self, problem: Option<String>) {
        self.step = if self.step == InitStep::FindAgain { InitStep::SwitchOff } else { InitStep::SwitchOn };
        self.problem = problem;
        self.waiting = None;
    }

    /// What was taken in an earlier round is not written again.
    pub(super) fn begin_writing(&mut self) {
        self.step = InitStep::Writing;
        let refused = self.changes.iter_mut().filter(|change| matches!(change.outcome, Some(Err(_))));
        refused.for_each(|change| change.outcome = None);
    }

    pub(super) fn next_change(&self) -> Option<&InitChange> {
        self.changes.iter().find(|change| change.outcome.is_none())
    }

    pub(super) fn note_outcome(&mut self, item: &str, outcome: Result<(), String>) {
        if let Some(change) = self.changes.iter_mut().find(|change| change.id == item) {
            change.outcome = Some(outcome);
        }
    }

    pub(super) fn end_writing(&mut self) {
        self.step = if self.refused().next().is_none() { InitStep::SwitchOff } else { InitStep::SwitchOn };
    }

    /// The module got another address while the procedure was under way.
    pub(crate) fn follow(&mut self, from: Target, to: Target) {
        if self.module == from {
            self.module = to;
        }
        if self.before == from && self.step <= InitStep::SwitchOff {
            self.before = to;
            self.after.address = to.address;
        }
    }

    /// What has to be known after leaving before the end.
    pub(super) fn farewell(&self) -> Option<(Severity, String)> {
        let taken = self.taken().count();
        if self.step == InitStep::Done || !self.begun {
            return None;
        }
        if taken == 0 {
            let text = "INIT mode was left, nothing was written – switch INIT mode off and switch the power off and on";
            return Some((Severity::Info, text.to_owned()));
        }
        let settings = if taken == 1 { "1 setting is".to_owned() } else { format!("{taken} settings are") };
        let place = reached_after(self.before, self.taken());
        let text = format!(
            "INIT mode was left, {settings} written – switch INIT mode off, switch the power off and on, and scan: the \
             module is at {place} then"
        );
        Some((Severity::Warning, text))
    }
}

/// How a module is reached once these settings are in force.
fn reached_after<'a>(before: Target, changes: impl Iterator<Item = &'a InitChange>) -> Target {
    let mut after = before;
    for InitChange { id, value, .. } in changes {
        match (id.as_str(), value) {
            ("baud_rate", Value::Choice(word)) => {
                after.settings.baud_rate = word.parse().unwrap_or(after.settings.baud_rate);
            }
            ("data_format", Value::Choice(word)) => {
                after.settings.data_format = word.parse().unwrap_or(after.settings.data_format);
            }
            ("checksum", Value::Bool(on)) => after.checksum = *on,
            ("protocol", Value::Choice(word)) => {
                let protocol = Protocol::SERIAL.into_iter().find(|protocol| protocol.word() == word);
                after.protocol = protocol.unwrap_or(after.protocol);
            }
            _ => {}
        }
    }
    if after.protocol.is_modbus() {
        after.checksum = false;
    }
    after
}
