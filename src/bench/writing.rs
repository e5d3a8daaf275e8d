//! Reading on request, writing what was staged, and actions; and what came of them.

use jiff::Timestamp;

use super::edits::EditState;
use super::host_ok::HOST_OK;
use super::journal::{Entry, EntryKind};
use super::{Bench, LineState, Module, Severity};
use crate::bus::{BusCommand, ItemSet, RequestId, Target};
use crate::module::{Item, Value, WriteError, moves_to};
use crate::record::{Change, History};

impl Bench {
    /// Asks for these items, unless they are being asked for already.
    pub(super) fn read(&mut self, target: Target, mut ids: Vec<String>) {
        if matches!(self.line, LineState::Closed) {
            return;
        }
        let id = self.bus.next_id();
        let Some(module) = self.module_mut(&target) else { return };
        let Some(definition) = module.definition().cloned() else { return };
        ids.retain(|item| !module.is_being_read(item));
        if ids.is_empty() {
            return;
        }
        module.reads.push((id, ids.clone()));
        let sent = self.try_send(BusCommand::Read { id, target, definition, items: ItemSet::Named(ids) });
        if let (false, Some(module)) = (sent, self.module_mut(&target)) {
            module.reads.retain(|(read, _)| *read != id);
        }
    }

    /// Writes the staged values of these items, each once.
    pub(super) fn write(&mut self, target: Target, ids: &[String]) {
        let Some(module) = self.module(&target) else { return };
        let Some(definition) = module.definition().cloned() else { return };
        // In the order that `edited` gives: what moves the module comes last.
        let wanted: Vec<(String, Value)> = module
            .edited()
            .into_iter()
            .filter(|id| ids.iter().any(|wanted| wanted == id))
            .filter_map(|id| Some((id.to_owned(), module.edit(id)?)))
            .filter(|(_, edit)| !edit.is_being_written())
            .filter_map(|(id, edit)| Some((id, edit.value.clone().ok()?)))
            .collect();
        for (item, value) in wanted {
            let id = self.bus.next_id();
            let command = BusCommand::Write { id, target, definition: definition.clone(), item: item.clone(), value };
            let state = match self.try_send(command) {
                true => EditState::Writing(id),
                false => EditState::Refused("too many requests are waiting – try again".to_owned()),
            };
            if let Some(edit) = self.module_mut(&target).and_then(|module| module.edits.get_mut(&item)) {
                edit.state = state;
            }
        }
    }

    pub(super) fn act(&mut self, target: Target, action: String) {
        let id = self.bus.next_id();
        let Some(module) = self.module_mut(&target) else { return };
        let Some(definition) = module.definition().cloned() else { return };
        module.acting.insert(action.clone(), id);
        if !self.try_send(BusCommand::Act { id, target, definition, action: action.clone() })
            && let Some(module) = self.module_mut(&target)
        {
            module.acting.remove(&action);
        }
    }

    pub(super) fn written(
        &mut self,
        id: RequestId,
        target: Target,
        item: &str,
        at: Timestamp,
        result: Result<Value, WriteError>,
    ) {
        let in_init = self.written_in_init(id);
        let Some((module, history)) = self.module_and_history(&in_init.unwrap_or(target)) else { return };
        let moved = match (&result, module.item(item)) {
            (Ok(value), Some(known)) => moves_to(known, value),
            _ => None,
        };
        let outcome = result.as_ref().map(|_| ()).map_err(Clone::clone);
        let refusal = module.take_written(history, id, item, at, result);
        if in_init.is_some() {
            return self.init_written(id, item, outcome);
        }
        if let Some(address) = moved.filter(|address| *address != target.address) {
            self.follow(target, Target { address, ..target });
        }
        if let Some(reason) = refusal {
            let label = self.module(&target).map_or("Module", Module::label).to_owned();
            self.notify(Severity::Error, format!("{label} at address {}: {reason}", target.address));
        }
    }

    pub(super) fn acted(
        &mut self,
        id: RequestId,
        target: Target,
        action: &str,
        at: Timestamp,
        result: Result<(), WriteError>,
    ) {
        let Some(module) = self.module_mut(&target) else { return };
        if module.host_ok_sent(id, at, &result) {
            return;
        }
        module.acting.retain(|_, under_way| *under_way != id);
        let known = module.definition().and_then(|definition| definition.action(action)).cloned();
        let label = known.as_ref().map_or(action, |action| action.label.as_str());
        match result {
            Ok(()) => {
                module.journal.add(at, EntryKind::Done, label.to_owned());
                // What the action changed is seen by reading its tab again.
                let tab = known.filter(|_| action != HOST_OK).map(|action| action.tab);
                let again = tab.map(|tab| module.read_before(&tab)).unwrap_or_default();
                self.read(target, again);
            }
            Err(error) => {
                module.journal.add(at, EntryKind::Refused, format!("{label}: {error}"));
                let module = module.label().to_owned();
                self.notify(Severity::Error, format!("{module} at address {}: {label}: {error}", target.address));
            }
        }
    }

    /// The module at `from` is at `to` from now on; who was listed there has gone.
    pub(super) fn follow(&mut self, from: Target, to: Target) {
        if from == to {
            return;
        }
        self.modules.retain(|module| module.target != to);
        let unanswered = self.module_mut(&from).map(|module| module.move_to(to)).unwrap_or_default();
        if let Some(init) = self.init.as_mut() {
            init.follow(from, to);
        }
        if self.shown == Some(from) {
            self.shown = Some(to);
        }
        self.moves.push((from, to));
        self.describe(to);
        self.read(to, unanswered);
    }
}

impl Module {
    /// It is reached at `to` from now on; what was asked at the place before, and is not answered there any more.
    fn move_to(&mut self, to: Target) -> Vec<String> {
        self.target = to;
        self.acting.clear();
        for edit in self.edits.values_mut().filter(|edit| edit.is_being_written()) {
            edit.state = EditState::Refused("the module moved to another address meanwhile – try again".to_owned());
        }
        let asked = std::mem::take(&mut self.reads).into_iter().flat_map(|(_, ids)| ids);
        asked.filter(|id| self.item(id).is_some_and(|item| self.has(item))).collect()
    }

    /// Items of a tab that were read before and are not polled.
    fn read_before(&self, tab: &str) -> Vec<String> {
        let of_tab = |item: &&Item| item.tab == tab && self.readings.contains_key(&item.id);
        let items = self.definition().into_iter().flat_map(|definition| &definition.items).filter(of_tab);
        items.map(|item| item.id.clone()).collect()
    }

    /// Takes in how a write ended; the reason if the value does not stand in the module.
    fn take_written(
        &mut self,
        history: &mut History,
        id: RequestId,
        item: &str,
        at: Timestamp,
        result: Result<Value, WriteError>,
    ) -> Option<String> {
        let label = self.item(item).map_or(item, |item| item.label.as_str()).to_owned();
        let text = |value: &Value| self.item(item).map_or_else(|| value.to_string(), |item| item.text(value));
        let before = self.known(item).cloned();
        let of_this = self.edits.get(item).is_some_and(|edit| edit.state == EditState::Writing(id));
        match result {
            Ok(value) => {
                let known = before.as_ref().map_or_else(|| "not known".to_owned(), text);
                let entry = Entry::new(at, EntryKind::Written, format!("{label}: {known} to {}", text(&value)));
                let secret = self.item(item).is_some_and(|item| item.secret);
                let change = (!secret).then(|| Change {
                    item: item.to_owned(),
                    before: before.as_ref().map(ToString::to_string),
                    after: value.to_string(),
                });
                self.journal.push(Entry { change, ..entry });
                self.take_value(history, at, item.to_owned(), value);
                if let Some(reading) = self.readings.get_mut(item) {
                    reading.written = true;
                }
                if of_this {
                    self.edits.remove(item);
                    self.forget_steps_of(item);
                }
                None
            }
            Err(error) => {
                self.journal.add(at, EntryKind::Refused, format!("{error}"));
                if let WriteError::Differs { found, .. } = &error {
                    self.take_value(history, at, item.to_owned(), found.clone());
                }
                if let Some(edit) = self.edits.get_mut(item).filter(|_| of_this) {
                    edit.state = EditState::Refused(error.to_string());
                }
                Some(error.to_string())
            }
        }
    }
}
