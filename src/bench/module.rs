//! One module as the bench knows it.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

use crate::bus::{Target, Values};
use crate::module::{Definition, Identified, Value};
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
}

/// A module that was found.
#[derive(Debug, Clone)]
pub struct Module {
    pub target: Target,
    pub identified: Identified,
    pub presence: Presence,
    /// By item id.
    pub readings: BTreeMap<String, Reading>,
    pub trends: BTreeMap<String, Trend>,
    /// How often it is polled; `None` if it is not.
    pub interval: Option<Duration>,
}

impl Module {
    pub fn new(target: Target, identified: Identified) -> Self {
        Self {
            target,
            identified,
            presence: Presence::Found,
            readings: BTreeMap::new(),
            trends: BTreeMap::new(),
            interval: None,
        }
    }

    pub fn definition(&self) -> Option<&Arc<Definition>> {
        self.identified.definition.as_ref()
    }

    /// The model's name for people, or that it is unknown.
    pub fn label(&self) -> &str {
        self.definition().map_or("unknown", |definition| definition.label.as_str())
    }

    pub fn reading(&self, id: &str) -> Option<&Reading> {
        self.readings.get(id)
    }

    /// Takes in what a poll brought.
    pub(super) fn take(&mut self, at: Timestamp, values: Values) {
        let silent = values.iter().find_map(|(_, result)| match result {
            Err(failure) if !failure.shows_presence() && !matches!(failure, Failure::NotOffered(_)) => Some(failure),
            _ => None,
        });
        self.presence = match silent {
            Some(failure) => Presence::Silent { failure: failure.clone() },
            None => Presence::Answering,
        };
        for (id, result) in values {
            let trend = self.trends.entry(id.clone()).or_default();
            let reading = self.readings.entry(id).or_default();
            match result {
                Ok(value) => {
                    if let Some(number) = value.as_f64() {
                        trend.push(at.as_nanosecond() as f64 / 1e9, number);
                    }
                    *reading = Reading { value: Some(value), at: Some(at), problem: None };
                }
                Err(failure) => {
                    trend.mark_gap();
                    reading.problem = Some(failure);
                }
            }
        }
    }
}
