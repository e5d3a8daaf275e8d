//! One module as the bench knows it.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

use super::console::Console;
use super::edits::Edit;
use super::host_ok::HostOk;
use super::journal::{EntryKind, Journal};
use super::switch_kind::SwitchKind;
use crate::bus::{Answer, RequestId, Target, Values};
use crate::module::{Definition, Identified, Item, Value};
use crate::protocol::Failure;
use crate::record::Trend;

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
    pub trends: BTreeMap<String, Trend>,
    /// How often it is polled; `None` if it is not.
    pub interval: Option<Duration>,
    /// Changes that are not written yet, by item id.
    pub edits: BTreeMap<String, Edit>,
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
            trends: BTreeMap::new(),
            interval: None,
            edits: BTreeMap::new(),
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

    /// Takes in what a poll or read brought, which ended `at`.
    pub(super) fn take(&mut self, id: RequestId, at: Timestamp, values: Values) {
        self.reads.retain(|(read, _)| *read != id);
        let silent = values.iter().find_map(|answer| match &answer.result {
            Err(failure) if !failure.shows_presence() && !matches!(failure, Failure::NotOffered(_)) => {
                Some((answer.at, failure.clone()))
            }
            _ => None,
        });
        match silent {
            Some((at, failure)) => self.note_presence(at, Some(failure)),
            None => self.note_presence(values.iter().map(|answer| answer.at).min().unwrap_or(at), None),
        }
        for Answer { id, at, result } in values {
            match result {
                Ok(value) => self.take_value(at, id, value),
                Err(failure) => {
                    self.trends.entry(id.clone()).or_default().mark_gap();
                    self.readings.entry(id).or_default().problem = Some(failure);
                }
            }
        }
    }

    pub(super) fn take_value(&mut self, at: Timestamp, id: String, value: Value) {
        let trend = self.trends.entry(id.clone()).or_default();
        if let Some(number) = value.as_f64() {
            trend.push(at.as_nanosecond() as f64 / 1e9, number);
        }
        self.note_switch(at, &id, &value);
        self.readings.insert(id, Reading { value: Some(value), at: Some(at), problem: None, written: false });
    }

    fn note_presence(&mut self, at: Timestamp, silent: Option<Failure>) {
        let was_silent = matches!(self.presence, Presence::Silent { .. });
        match &silent {
            Some(failure) if !was_silent => self.journal.add(at, EntryKind::Lost, format!("Lost: {failure}")),
            None if was_silent => self.journal.add(at, EntryKind::Found, "Answers again".to_owned()),
            _ => {}
        }
        self.presence = silent.map_or(Presence::Answering, |failure| Presence::Silent { failure });
    }

    /// A live switch that changed is an event.
    fn note_switch(&mut self, at: Timestamp, id: &str, value: &Value) {
        let before = self.known(id).and_then(Value::as_bool);
        let (Some(before), Some(now)) = (before, value.as_bool()) else { return };
        let Some(item) = self.item(id).filter(|item| item.live) else { return };
        if before != now {
            let kind = SwitchKind::of(id);
            let text = format!("{}: {}", item.label, kind.word(now));
            self.journal.add(at, kind.entry_kind(), text);
        }
    }
}
