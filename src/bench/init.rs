//! The guided change of settings that a module takes in INIT mode only: DIP 4 on, power off and on, write, DIP 4 off,
//! power off and on, and find it again with its new settings.
//!
//! ```text
//! SwitchOn - user has done it -> FindInInit - answers -> Writing - all taken -> SwitchOff - user -> FindAgain -> Done
//! ```
//!
//! The manuals do not tell where a module answers in INIT mode; sister modules answer at address 00, 9600 N81, DCON.
//! So it is looked for at its present settings and there, in turn, until it answers.

use super::{Bench, Module, Severity};
use crate::bus::{BusCommand, RequestId, Target};
use crate::module::{Identified, Value, WriteError};
use crate::protocol::{Failure, LineSettings, Protocol};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    pub value: Value,
    /// `None` until it was written.
    pub outcome: Option<Result<(), String>>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct InitProcedure {
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
    model: String,
    /// The question that is under way.
    waiting: Option<RequestId>,
}

impl InitProcedure {
    /// Where the module may answer in this step, the likeliest first.
    fn places(&self) -> Vec<Target> {
        let init = Target { address: 0, protocol: Protocol::Dcon, settings: LineSettings::default(), checksum: false };
        let mut places = match self.step {
            InitStep::FindAgain => vec![self.after, self.before],
            _ => vec![self.before, init],
        };
        if self.step == InitStep::FindAgain && self.after.protocol == Protocol::Dcon {
            places.push(Target { checksum: !self.after.checksum, ..self.after });
        }
        places.dedup();
        places
    }

    fn next_place(&self) -> Option<Target> {
        let places = self.places();
        let index = usize::try_from(self.attempts).ok()?.checked_rem(places.len())?;
        places.get(index).copied()
    }

    pub fn is_looking(&self) -> bool {
        matches!(self.step, InitStep::FindInInit | InitStep::FindAgain)
    }

    /// Settings that were refused, with the reason.
    pub fn refused(&self) -> impl Iterator<Item = (&str, &str)> {
        self.changes.iter().filter_map(|change| match &change.outcome {
            Some(Err(reason)) => Some((change.id.as_str(), reason.as_str())),
            _ => None,
        })
    }
}

/// How a module is reached once these settings are in force.
fn reached_after(before: Target, changes: &[InitChange]) -> Target {
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

impl Bench {
    pub(super) fn begin_init(&mut self, target: Target) {
        let Some(module) = self.module(&target) else { return };
        let changes: Vec<InitChange> = module
            .edited_for_init()
            .into_iter()
            .filter_map(|id| Some((id, module.edit(id)?.value.clone().ok()?)))
            .map(|(id, value)| InitChange { id: id.to_owned(), value, outcome: None })
            .collect();
        if changes.is_empty() {
            return;
        }
        self.init = Some(InitProcedure {
            before: target,
            after: reached_after(target, &changes),
            found: None,
            changes,
            step: InitStep::SwitchOn,
            attempts: 0,
            model: module.identified.model().to_owned(),
            waiting: None,
        });
    }

    /// The user has turned the switch and the power, or wants to look once more.
    pub(super) fn continue_init(&mut self) {
        let Some(init) = self.init.as_mut() else { return };
        init.step = match init.step {
            InitStep::SwitchOn => InitStep::FindInInit,
            InitStep::SwitchOff => InitStep::FindAgain,
            InitStep::Done => {
                self.init = None;
                return;
            }
            InitStep::FindInInit | InitStep::Writing | InitStep::FindAgain => return,
        };
        init.attempts = 0;
        self.look_for_init();
    }

    fn look_for_init(&mut self) {
        let id = self.bus.next_id();
        let Some(init) = self.init.as_mut() else { return };
        let Some(target) = init.next_place() else { return };
        init.waiting = Some(id);
        self.send(BusCommand::Identify { id, target });
    }

    /// What the module said at the place that was asked.
    pub(super) fn identified(&mut self, id: RequestId, target: Target, result: Result<Identified, Failure>) {
        let Some(init) = self.init.as_mut().filter(|init| init.waiting == Some(id) && init.is_looking()) else {
            return;
        };
        init.waiting = None;
        match result {
            Ok(identified) if identified.model() == init.model => {
                init.found = Some(target);
                if init.step == InitStep::FindInInit { self.write_in_init(target) } else { self.end_init(target) }
            }
            Err(Failure::LineLost(_)) => {
                init.step = if init.step == InitStep::FindInInit { InitStep::SwitchOn } else { InitStep::SwitchOff };
            }
            _ => {
                init.attempts = init.attempts.saturating_add(1);
                self.look_for_init();
            }
        }
    }

    fn write_in_init(&mut self, target: Target) {
        let Some(init) = self.init.as_mut() else { return };
        init.step = InitStep::Writing;
        init.changes.iter_mut().for_each(|change| change.outcome = None);
        self.write_next_in_init(target);
    }

    /// One after the other, so that each result can be told from the others.
    fn write_next_in_init(&mut self, target: Target) {
        let id = self.bus.next_id();
        let Some(init) = self.init.as_mut() else { return };
        let next = init.changes.iter().find(|change| change.outcome.is_none()).cloned();
        let before = init.before;
        let Some(change) = next else {
            let refused = init.refused().count();
            init.step = if refused == 0 { InitStep::SwitchOff } else { InitStep::SwitchOn };
            return;
        };
        init.waiting = Some(id);
        let Some(definition) = self.module(&before).and_then(Module::definition).cloned() else { return };
        self.send(BusCommand::Write { id, target, definition, item: change.id, value: change.value });
    }

    /// Notes how a write of the procedure ended and goes on with the next.
    pub(super) fn init_written(&mut self, id: RequestId, item: &str, result: &Result<Value, WriteError>) {
        let Some(init) = self.init.as_mut().filter(|init| init.waiting == Some(id)) else { return };
        init.waiting = None;
        if let Some(change) = init.changes.iter_mut().find(|change| change.id == item) {
            change.outcome = Some(result.as_ref().map(|_| ()).map_err(ToString::to_string));
        }
        let (before, found, taken) = (init.before, init.found.unwrap_or(init.before), result.is_ok());
        if let Some(module) = self.module_mut(&before).filter(|_| taken) {
            module.edits.remove(item);
        }
        self.write_next_in_init(found);
    }

    /// The module answers again: it is followed to where it is now.
    fn end_init(&mut self, target: Target) {
        let Some(init) = self.init.as_mut() else { return };
        init.step = InitStep::Done;
        let (before, expected) = (init.before, init.after);
        if target != before {
            let interval = self.module(&before).and_then(|module| module.interval);
            self.send(BusCommand::Unwatch { target: before });
            self.follow(before, target);
            if let Some(interval) = interval {
                self.watch(target, interval);
            }
        }
        let configuration = self.module(&target).map(|module| module.configuration_ids()).unwrap_or_default();
        self.read(target, configuration);
        let text = match target == expected {
            true => format!("The module answers again: {target}"),
            false => {
                format!("The module answers, but at {target}, not at {expected} – DIP 2 OFF lets the switches rule")
            }
        };
        self.notify(if target == expected { Severity::Info } else { Severity::Warning }, text);
    }
}

impl Module {
    /// Items of the configuration that were read before.
    fn configuration_ids(&self) -> Vec<String> {
        self.readings
            .keys()
            .filter(|id| self.item(id).is_some_and(|item| item.tab == "configuration"))
            .cloned()
            .collect()
    }
}
