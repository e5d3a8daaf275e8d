//! One module as the bench knows it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

use super::console::Console;
use super::edits::Edit;
use super::host_ok::HostOk;
use super::journal::{EntryKind, Journal};
use super::observer::{self, Observer};
use super::switch_kind::SwitchKind;
use super::undo::Undo;
use crate::bus::{Answer, RequestId, Target, Values};
use crate::module::{Definition, Identified, Item, ReadPlan, Value};
use crate::protocol::Failure;
use crate::record::{History, ModuleId, Trend};

/// Whether the module answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Presence {
    /// It answered the scan and was not asked since.
    Found,
    Answering,
    /// The last poll brought nothing.
    Silent {
        failure: Failure,
    },
}

/// A value with its age and state. A value that grows old stays; it is never replaced by nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    pub value: Option<Value>,
    /// When `value` was taken.
    pub at: Option<Timestamp>,
    /// Why the last attempt brought no value.
    pub problem: Option<Failure>,
    /// It was read back after it had been written.
    pub written: bool,
}

/// A module that was found.
#[derive(Debug, Clone)]
pub struct Module {
    pub target: Target,
    /// The scan that found it first: a module found on a line that was opened anew is another one.
    pub found_by: RequestId,
    pub identified: Identified,
    pub presence: Presence,
    /// By item id.
    pub readings: BTreeMap<String, Reading>,
    /// Where its samples go; `None` until it is a part of a history.
    pub(super) observer: Option<Observer>,
    /// How often it is polled; `None` if it is not.
    pub interval: Option<Duration>,
    /// How often it was polled last.
    pub last_interval: Option<Duration>,
    /// The live items that are polled; `None` is all of them.
    pub polled: Option<BTreeSet<String>>,
    /// Changes that are not written yet, by item id.
    pub edits: BTreeMap<String, Edit>,
    /// How these changes came about.
    pub(super) undo: Undo,
    /// What happened to it.
    pub journal: Journal,
    /// Host OK that is sent again and again on behalf of this module.
    pub host_ok: Option<HostOk>,
    /// What was sent to it as it was typed.
    pub console: Console,
    /// Optional parts that it has; `None` until it was asked.
    pub parts: Option<Vec<String>>,
    /// Reads under way, with what they ask for.
    pub(super) reads: Vec<(RequestId, Vec<String>)>,
    /// Actions under way, by id.
    pub(super) acting: BTreeMap<String, RequestId>,
}

impl Module {
    pub fn new(found_by: RequestId, target: Target, identified: Identified, at: Timestamp) -> Self {
        let mut journal = Journal::default();
        journal.add(at, EntryKind::Found, format!("Found at {target}"));
        Self {
            target,
            found_by,
            identified,
            presence: Presence::Found,
            readings: BTreeMap::new(),
            observer: None,
            interval: None,
            last_interval: None,
            polled: None,
            edits: BTreeMap::new(),
            undo: Undo::default(),
            journal,
            host_ok: None,
            console: Console::default(),
            parts: None,
            reads: Vec::new(),
            acting: BTreeMap::new(),
        }
    }

    pub fn definition(&self) -> Option<&Arc<Definition>> {
        self.identified.definition.as_ref()
    }

    pub fn item(&self, id: &str) -> Option<&Item> {
        self.definition().and_then(|definition| definition.item(id))
    }

    /// What asks for somebody to look: an alarm, or a watchdog that has tripped.
    pub fn attention(&self) -> Option<&'static str> {
        let live = self.definition().into_iter().flat_map(|definition| &definition.items).filter(|item| item.live);
        let on = live.filter(|item| self.known(&item.id).and_then(Value::as_bool) == Some(true));
        on.map(|item| SwitchKind::of(&item.id)).find_map(|kind| match kind {
            SwitchKind::Alarm => Some("in alarm"),
            SwitchKind::Watchdog => Some("watchdog tripped"),
            SwitchKind::Motion | SwitchKind::Output | SwitchKind::Sound => None,
        })
    }

    /// The model's name for people, or that it is unknown.
    pub fn label(&self) -> &str {
        self.definition().map_or("unknown", |definition| definition.label.as_str())
    }

    /// What a history calls it.
    pub fn history_id(&self) -> Option<ModuleId> {
        self.observer.as_ref().map(Observer::id)
    }

    /// The samples of an item, if it was read at least once.
    pub fn trend<'a>(&self, history: &'a History, id: &str) -> Option<&'a Trend> {
        let series = self.observer.as_ref()?.series(id)?;
        history.get(series).map(|series| &series.trend)
    }

    pub fn reading(&self, id: &str) -> Option<&Reading> {
        self.readings.get(id)
    }

    /// Whether the protocol offers the item and the module has it; what is not known yet does not count as there.
    pub fn has(&self, item: &Item) -> bool {
        let part = item.optional.as_ref();
        let there = |part: &String| {
            self.parts.as_ref().is_some_and(|parts| parts.contains(part)) || self.readings.contains_key(&item.id)
        };
        item.is_offered(self.target.protocol) && part.is_none_or(there)
    }

    /// The live items that a poll asks for, in the order of the definition.
    pub fn polled_items(&self) -> Vec<&str> {
        let Some(definition) = self.definition() else { return Vec::new() };
        let is_polled = |item: &&Item| self.polled.as_ref().is_none_or(|polled| polled.contains(&item.id));
        let items = definition.live_items(self.target.protocol).filter(|item| self.has(item)).filter(is_polled);
        items.map(|item| item.id.as_str()).collect()
    }

    /// How many requests a poll takes at first, before it is known what the module refuses.
    pub fn poll_questions(&self) -> usize {
        let Some(definition) = self.definition() else { return 0 };
        ReadPlan::new(definition, self.target.protocol, self.polled_items()).questions(self.target.address)
    }

    pub fn is_being_read(&self, id: &str) -> bool {
        self.reads.iter().any(|(_, ids)| ids.iter().any(|asked| asked == id))
    }

    pub fn is_acting(&self, action: &str) -> bool {
        self.acting.contains_key(action)
    }

    /// What was under way is not answered any more: the line was closed.
    pub(super) fn forget_requests(&mut self) {
        self.reads.clear();
        self.acting.clear();
        self.interval = None;
        self.host_ok = None;
        self.console.line_closed();
        for edit in self.edits.values_mut().filter(|edit| edit.is_being_written()) {
            edit.state = super::EditState::Refused("the line was closed before it was written".to_owned());
        }
    }

    /// Nothing is asked any more.
    pub(super) fn pause(&mut self, history: &mut History) {
        if let Some(observer) = &mut self.observer {
            observer.pause(history);
        }
    }

    /// It is a part of `history` from now on; `line` is what people call the line.
    pub(super) fn observe(&mut self, history: &mut History, line: &str) {
        let info = observer::module_info(line, &self.target, &self.identified);
        self.observer = Some(Observer::new(history, info));
    }

    /// It has moved, or says something else of itself.
    pub(super) fn describe(&self, history: &mut History, line: &str) {
        if let Some(observer) = &self.observer {
            history.change_module(observer.id(), observer::module_info(line, &self.target, &self.identified));
        }
    }

    /// Takes in what a poll or read brought, which ended `at`.
    pub(super) fn take(&mut self, history: &mut History, id: RequestId, at: Timestamp, values: Values) {
        self.reads.retain(|(read, _)| *read != id);
        match observer::silence(&values) {
            Some((at, failure)) => self.note_presence(at, Some(failure.clone())),
            None => self.note_presence(values.iter().map(|answer| answer.at).min().unwrap_or(at), None),
        }
        for Answer { id, at, result } in values {
            match result {
                Ok(value) => self.take_value(history, at, id, value),
                Err(_) if self.is_outdated(&id, at) => {}
                Err(failure) => {
                    if let Some(observer) = &mut self.observer {
                        observer.missing(history, &id);
                    }
                    self.readings.entry(id).or_default().problem = Some(failure);
                }
            }
        }
    }

    /// Takes in the values that a poll under way has brought.
    pub(super) fn take_so_far(&mut self, history: &mut History, values: Values) {
        for Answer { id, at, result } in values {
            if let Ok(value) = result {
                self.take_value(history, at, id, value);
            }
        }
    }

    pub(super) fn take_value(&mut self, history: &mut History, at: Timestamp, id: String, value: Value) {
        if self.is_outdated(&id, at) {
            return;
        }
        let definition = self.definition().cloned();
        let item = definition.as_ref().and_then(|definition| definition.item(&id));
        if let (Some(observer), Some(item)) = (&mut self.observer, item)
            && let Some(entry) = observer.value(history, item, at, &value, self.interval)
        {
            self.journal.push(entry);
        }
        self.readings.insert(id, Reading { value: Some(value), at: Some(at), problem: None, written: false });
    }

    /// A write between two questions of a poll brings something newer than what the poll tells when it ends.
    fn is_outdated(&self, id: &str, at: Timestamp) -> bool {
        self.reading(id).and_then(|reading| reading.at).is_some_and(|known| at < known)
    }

    fn note_presence(&mut self, at: Timestamp, silent: Option<Failure>) {
        if let Some(observer) = &mut self.observer
            && let Some(entry) = observer.presence(at, silent.as_ref())
        {
            self.journal.push(entry);
        }
        self.presence = silent.map_or(Presence::Answering, |failure| Presence::Silent { failure });
    }
}
