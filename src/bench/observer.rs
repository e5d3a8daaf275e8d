//! Puts what one module tells into a history: samples, gaps where none came, and what changed.

use std::collections::BTreeMap;
use std::time::Duration;

use jiff::Timestamp;

use super::journal::Entry;
use super::switch_kind::SwitchKind;
use crate::bus::{Answer, Target};
use crate::module::{Fixed, Identified, Item, Kind, Value};
use crate::protocol::{Failure, Protocol};
use crate::record::{EventKind, History, ModuleId, ModuleInfo, SeriesId, SeriesInfo, SeriesKind, micros_of};

/// Settings that are kept as series too, because plots draw them beside the readings.
const LIMITS: [&str; 2] = ["alarm_limit", "alarm_mode"];
/// Samples further apart than so many intervals, and than so long, have a gap between them: polls were missed.
const MISSED_INTERVALS: u32 = 3;
const MISSED_AT_LEAST: Duration = Duration::from_secs(2);

/// One module as a history knows it.
#[derive(Debug, Clone)]
pub struct Observer {
    id: ModuleId,
    series: BTreeMap<String, Seen>,
    silent: bool,
}

/// What was last seen of an item.
#[derive(Debug, Clone, Copy)]
struct Seen {
    series: SeriesId,
    at: Timestamp,
    on: Option<bool>,
}

/// How a recording describes a module.
pub fn module_info(line: &str, target: &Target, identified: &Identified) -> ModuleInfo {
    let serial = target.protocol != Protocol::ModbusTcp;
    let label = identified.definition.as_ref().map_or("unknown", |definition| definition.label.as_str());
    ModuleInfo {
        line: line.to_owned(),
        address: target.address,
        protocol: target.protocol.to_string(),
        baud_rate: serial.then(|| target.settings.baud_rate.bps()),
        data_format: serial.then(|| target.settings.data_format.to_string()),
        checksum: target.checksum,
        model: identified.model().to_owned(),
        label: label.to_owned(),
        name: identified.name.clone(),
        firmware: identified.firmware.clone(),
    }
}

impl Observer {
    /// A module that is known already goes on with its series, after a gap.
    pub fn new(history: &mut History, info: ModuleInfo) -> Self {
        let id = history.module(info);
        let known: Vec<SeriesId> =
            history.series().filter(|(_, series)| series.info.module == id).map(|(id, _)| id).collect();
        known.into_iter().for_each(|series| history.mark_gap(series));
        Self { id, series: BTreeMap::new(), silent: false }
    }

    pub fn id(&self) -> ModuleId {
        self.id
    }

    /// The series of an item, if it was read at least once.
    pub fn series(&self, item: &str) -> Option<SeriesId> {
        self.series.get(item).map(|seen| seen.series)
    }

    /// Takes in a value; what happened if a live switch changed. Texts and settings have no series. `interval` is how often
    /// the module is polled, `None` if the value was asked for once.
    pub fn value(
        &mut self,
        history: &mut History,
        item: &Item,
        at: Timestamp,
        value: &Value,
        interval: Option<Duration>,
    ) -> Option<Entry> {
        let kind = series_kind(item)?;
        let raw = raw(&kind, value)?;
        let before = self.series.get(&item.id).copied();
        let series = match before {
            Some(seen) => seen.series,
            None => history.series_for(SeriesInfo {
                module: self.id,
                item: item.id.clone(),
                label: item.label.clone(),
                unit: item.unit.clone(),
                kind,
            }),
        };
        if item.live && before.is_some_and(|seen| missed(seen.at, at, interval)) {
            history.mark_gap(series);
        }
        history.push(series, micros_of(at), raw);
        let on = value.as_bool();
        self.series.insert(item.id.clone(), Seen { series, at, on });
        let (before, now) = (before?.on?, on?);
        (item.live && before != now).then(|| {
            let kind = SwitchKind::of(&item.id);
            Entry::new(at, kind.entry_kind(), format!("{}: {}", item.label, kind.word(now)))
        })
    }

    /// No value came, so that its line has a gap.
    pub fn missing(&mut self, history: &mut History, item: &str) {
        if let Some(series) = self.series(item) {
            history.mark_gap(series);
        }
    }

    /// Nothing is asked any more.
    pub fn pause(&mut self, history: &mut History) {
        self.series.values().for_each(|seen| history.mark_gap(seen.series));
    }

    /// Whether the module answered at all; what happened if that changed.
    pub fn presence(&mut self, at: Timestamp, silent: Option<&Failure>) -> Option<Entry> {
        let was_silent = std::mem::replace(&mut self.silent, silent.is_some());
        match silent {
            Some(failure) if !was_silent => Some(Entry::new(at, EventKind::Lost, format!("Lost: {failure}"))),
            None if was_silent => Some(Entry::new(at, EventKind::Found, "Answers again".to_owned())),
            _ => None,
        }
    }
}

/// When and why the module did not show itself in a set of answers, if it did not.
pub fn silence(values: &[Answer]) -> Option<(Timestamp, &Failure)> {
    values.iter().find_map(|answer| match &answer.result {
        Err(failure) if !failure.shows_presence() && !matches!(failure, Failure::NotOffered(_)) => {
            Some((answer.at, failure))
        }
        _ => None,
    })
}

fn series_kind(item: &Item) -> Option<SeriesKind> {
    if item.secret || !(item.live || LIMITS.contains(&item.id.as_str())) {
        return None;
    }
    match &item.kind {
        Kind::Bool => Some(SeriesKind::Switch),
        Kind::Number { min, .. } => Some(SeriesKind::Number { decimals: min.decimals }),
        Kind::Choice(choices) => {
            Some(SeriesKind::Choice { words: choices.iter().map(|choice| choice.word.clone()).collect() })
        }
        Kind::Text { .. } | Kind::Ipv4 => None,
    }
}

/// The value as a series holds it.
fn raw(kind: &SeriesKind, value: &Value) -> Option<i64> {
    match (kind, value) {
        (SeriesKind::Switch, Value::Bool(on)) => Some(i64::from(*on)),
        (SeriesKind::Number { decimals }, Value::Number(number)) if number.decimals == *decimals => Some(number.raw),
        (SeriesKind::Number { decimals }, Value::Number(number)) => {
            Some(Fixed::from_f64(number.to_f64(), *decimals).raw)
        }
        (SeriesKind::Choice { words }, Value::Choice(word)) => {
            words.iter().position(|known| known == word).and_then(|place| i64::try_from(place).ok())
        }
        _ => None,
    }
}

fn missed(before: Timestamp, at: Timestamp, interval: Option<Duration>) -> bool {
    let Some(interval) = interval else { return false };
    let passed = Duration::try_from(at.duration_since(before)).unwrap_or_default();
    passed > interval.saturating_mul(MISSED_INTERVALS).max(interval.saturating_add(MISSED_AT_LEAST))
}
