//! The guided change of settings that a module takes in INIT mode only: DIP 4 on, power off and on, write, DIP 4 off,
//! power off and on, and find it again with its new settings.
//!
//! ```text
//! SwitchOn - user has done it -> FindInInit - answers -> Writing - all taken -> SwitchOff - user -> FindAgain -> Done
//! ```
//!
//! A refusal leads back to `SwitchOn`, a lost line to the step before, and a module that says that it is in INIT mode
//! already begins at `FindInInit`. The manuals do not tell where a module answers in INIT mode; sister modules answer
//! at address 00, 9600 N81, DCON. So it is looked for at its present settings and there, in turn, until it answers.

mod procedure;
#[cfg(test)]
mod tests;

pub use procedure::{InitChange, InitProcedure, InitStep};

use super::edits::EditState;
use super::host_ok::HOST_OK;
use super::journal::EntryKind;
use super::{Bench, Module, Severity};
use crate::bus::{BusCommand, RequestId, Target};
use crate::module::{Identified, Value, WriteError};
use crate::protocol::Failure;

impl Bench {
    pub(super) fn begin_init(&mut self, target: Target) {
        if self.init.as_ref().is_some_and(InitProcedure::is_left) {
            let text = "The last setting of the change before is still being written – begin again in a moment";
            return self.notify(Severity::Info, text.to_owned());
        }
        if self.init.as_ref().is_some_and(|init| init.is_writing() || init.is_looking()) {
            return;
        }
        let Some(procedure) = self.module(&target).and_then(InitProcedure::new) else { return };
        let there_already = procedure.step == InitStep::FindInInit;
        self.init = Some(procedure);
        if there_already {
            self.look_for_init();
        }
    }

    /// The user has turned the switch and the power, or wants to look once more.
    pub(super) fn continue_init(&mut self) {
        let Some(init) = self.init.as_mut() else { return };
        match init.step {
            InitStep::SwitchOn => init.look(InitStep::FindInInit),
            InitStep::SwitchOff => init.look(InitStep::FindAgain),
            InitStep::Done if !init.is_as_wanted() => init.look(InitStep::FindAgain),
            InitStep::Done => {
                self.init = None;
                return;
            }
            InitStep::FindInInit | InitStep::Writing | InitStep::FindAgain => return,
        }
        self.look_for_init();
    }

    /// The user gives up looking, and turns switch and power once more.
    pub(super) fn back_in_init(&mut self) {
        if let Some(init) = self.init.as_mut().filter(|init| init.is_looking()) {
            init.go_back(None);
        }
    }

    /// The write under way is awaited first: what becomes of its setting has to be known.
    pub(super) fn leave_init(&mut self) {
        let Some(init) = self.init.as_mut() else { return };
        if init.is_writing() { init.leave() } else { self.end_left_init() }
    }

    pub(super) fn end_left_init(&mut self) {
        if let Some((severity, text)) = self.init.take().and_then(|init| init.farewell()) {
            self.notify(severity, text);
        }
    }

    fn look_for_init(&mut self) {
        let Some(target) = self.init.as_ref().and_then(InitProcedure::asked_now) else { return };
        let id = self.bus.next_id();
        let sent = self.try_send(BusCommand::Identify { id, target });
        if let Some(init) = self.init.as_mut() {
            if sent { init.await_answer(id) } else { init.go_back(Some("the line takes no requests".to_owned())) }
        }
    }

    /// What the module said at the place that was asked.
    pub(super) fn identified(&mut self, id: RequestId, target: Target, result: Result<Identified, Failure>) {
        let Some(init) = self.init.as_mut().filter(|init| init.is_looking() && init.awaits(id)) else { return };
        init.take_answer();
        match result {
            Ok(identified) if identified.model() == init.model() => {
                init.found = Some(target);
                init.problem = None;
                match init.step {
                    InitStep::FindInInit => self.write_in_init(target),
                    _ => self.end_init(target, identified),
                }
            }
            Err(Failure::LineLost(reason)) => init.go_back(Some(format!("The line was lost: {reason}"))),
            other => {
                if let Ok(stranger) = other {
                    init.problem = Some(format!("Another module ({}) answers at {target}", stranger.model()));
                }
                init.attempts = init.attempts.saturating_add(1);
                self.look_for_init();
            }
        }
    }

    fn write_in_init(&mut self, target: Target) {
        if let Some(init) = self.init.as_mut() {
            init.begin_writing();
            self.write_next_in_init(target);
        }
    }

    /// One after the other, so that each result can be told from the others.
    fn write_next_in_init(&mut self, target: Target) {
        let Some(init) = self.init.as_mut() else { return };
        let listed = init.module;
        let Some(InitChange { id: item, value, .. }) = init.next_change().cloned() else { return init.end_writing() };
        let Some(definition) = self.module(&listed).and_then(Module::definition).cloned() else {
            self.init = None;
            return;
        };
        let id = self.bus.next_id();
        let sent = self.try_send(BusCommand::Write { id, target, definition, item: item.clone(), value });
        let Some(init) = self.init.as_mut() else { return };
        if !sent {
            return init.go_back(Some("the line takes no requests".to_owned()));
        }
        init.await_answer(id);
        if let Some(edit) = self.module_mut(&listed).and_then(|module| module.edits.get_mut(&item)) {
            edit.state = EditState::Writing(id);
        }
    }

    /// Whose setting the procedure writes with this request; it may be written at another place than the module has.
    pub(super) fn written_in_init(&self, id: RequestId) -> Option<Target> {
        self.init.as_ref().filter(|init| init.awaits(id)).map(|init| init.module)
    }

    /// Notes how a write of the procedure ended and goes on with the next.
    pub(super) fn init_written(&mut self, id: RequestId, item: &str, result: Result<(), WriteError>) {
        let Some(init) = self.init.as_mut().filter(|init| init.awaits(id)) else { return };
        init.take_answer();
        let lost = match result.as_ref().err().and_then(WriteError::failure) {
            Some(Failure::LineLost(reason)) => Some(format!("The line was lost: {reason}")),
            _ => None,
        };
        if lost.is_none() {
            init.note_outcome(item, result.map_err(|error| error.to_string()));
        }
        let target = init.found.unwrap_or(init.module);
        if init.is_left() {
            self.end_left_init();
        } else if lost.is_some() {
            init.go_back(lost);
        } else {
            self.write_next_in_init(target);
        }
    }

    /// The module answers again: it is followed to where it is now.
    fn end_init(&mut self, target: Target, identified: Identified) {
        let at = self.now();
        let Some(init) = self.init.as_mut() else { return };
        init.step = InitStep::Done;
        let (listed, expected) = (init.module, init.after);
        self.move_module(listed, target);
        if let Some(module) = self.module_mut(&target) {
            module.identified = identified;
            module.journal.add(at, EntryKind::Found, format!("Found after INIT mode at {target}"));
        }
        let configuration = self.module(&target).map(Module::configuration_ids).unwrap_or_default();
        self.read(target, configuration);
        if target == expected {
            self.notify(Severity::Info, format!("The module answers again: {target}"));
        } else {
            let text = format!(
                "The module answers, but at {target}, not at {expected} – its switches may rule (hardware configuration)"
            );
            self.notify(Severity::Warning, text);
        }
    }

    /// What is done again and again for the module goes on at its new place.
    fn move_module(&mut self, from: Target, to: Target) {
        if from == to {
            return;
        }
        let Some(module) = self.module(&from) else { return };
        let host_ok_is_offered = module
            .definition()
            .and_then(|definition| definition.action(HOST_OK))
            .is_some_and(|action| action.is_offered(to.protocol));
        let (interval, host_ok) = (module.interval, module.host_ok.as_ref().map(|host_ok| host_ok.period));
        self.send(BusCommand::Unwatch { target: from });
        if host_ok.is_some() {
            self.stop_host_ok(from);
        }
        self.follow(from, to);
        if let Some(interval) = interval {
            self.watch(to, interval);
        }
        if let Some(period) = host_ok.filter(|_| host_ok_is_offered) {
            self.start_host_ok(to, period);
        }
    }
}

impl InitChange {
    fn of(module: &Module, id: &str) -> Option<Self> {
        let value: Value = module.edit(id)?.value.clone().ok()?;
        Some(Self { id: id.to_owned(), was: module.known(id).cloned(), value, outcome: None })
    }
}

impl Module {
    /// What the configuration can be read from here, but for what changes by being read.
    fn configuration_ids(&self) -> Vec<String> {
        let items = self.definition().into_iter().flat_map(|definition| &definition.items);
        items
            .filter(|item| item.tab == "configuration" && !item.on_request && self.has(item))
            .map(|item| item.id.clone())
            .collect()
    }
}
