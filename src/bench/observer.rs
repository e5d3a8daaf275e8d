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
pub(super) const LIMITS: [&str; 2] = ["alarm_limit", "alarm_mode"];
/// A sample that comes so much later than its interval has a gap before it, polls were missed: half an interval, this at
/// least, and not only as late as on a line that is always too slow for its polls.
const LATE_AT_LEAST: Duration = Duration::from_secs(2);
const TIMES_THE_LAST_STEP: u32 = 3;

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
    /// From the sample before.
    step: Duration,
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
        let step = before.map_or(Duration::ZERO, |seen| seen.step);
        let passed = before.map_or(Duration::ZERO, |seen| since(seen.at, at));
        let missed = item.live && interval.is_some_and(|interval| is_missed(passed, interval, step));
        if missed {
            history.mark_gap(series);
        }
        history.push(series, micros_of(at), raw);
        if item.live && interval.is_none() {
            // Nobody knows what it was until it is asked for again.
            history.mark_gap(series);
        }
        let on = value.as_bool();
        self.series.insert(item.id.clone(), Seen { series, at, on, step: passed });
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

fn since(before: Timestamp, at: Timestamp) -> Duration {
    Duration::try_from(at.duration_since(before)).unwrap_or_default()
}

fn is_missed(passed: Duration, interval: Duration, step: Duration) -> bool {
    let late = interval.saturating_add((interval / 2).max(LATE_AT_LEAST));
    passed > late.max(step.saturating_mul(TIMES_THE_LAST_STEP))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::module::{Catalogue, Definition};
    use crate::record::timestamp;

    const POLLED: Option<Duration> = Some(Duration::from_secs(1));

    fn definition() -> Arc<Definition> {
        Catalogue::built_in().0.get("pir-234").unwrap()
    }

    fn observer(history: &mut History) -> Observer {
        Observer::new(history, ModuleInfo { label: "PIR-234".into(), address: 1, ..ModuleInfo::default() })
    }

    /// Takes in a value at so many seconds.
    fn take(observer: &mut Observer, history: &mut History, id: &str, second: i64, value: Value) -> Option<Entry> {
        let definition = definition();
        let at = timestamp(second * 1_000_000);
        observer.value(history, definition.item(id).unwrap(), at, &value, POLLED)
    }

    fn number(raw: i64) -> Value {
        Value::Number(Fixed::new(raw, 2))
    }

    fn samples(history: &History, observer: &Observer, item: &str) -> Vec<(i64, i64, bool)> {
        let trend = &history.get(observer.series(item).unwrap()).unwrap().trend;
        let columns = trend.blocks().iter().filter_map(|block| block.samples.as_ref());
        columns.flat_map(|columns| columns.iter()).map(|s| (s.at / 1_000_000, s.value, s.gap)).collect()
    }

    #[test]
    fn polls_that_were_missed_leave_a_gap_and_slow_ones_do_not() {
        let mut history = History::default();
        let mut observer = observer(&mut history);
        for second in [10, 11, 13, 20] {
            take(&mut observer, &mut history, "temperature_c", second, number(second * 100));
        }
        let expected = [(10, 1_000, false), (11, 1_100, false), (13, 1_300, false), (20, 2_000, true)];
        assert_eq!(samples(&history, &observer, "temperature_c"), expected);
    }

    #[test]
    fn a_line_that_is_too_slow_for_its_polls_has_no_gaps_but_one_that_stood_still_has() {
        let mut history = History::default();
        let mut observer = observer(&mut history);
        for second in [0, 3, 7, 12, 17, 22, 60] {
            take(&mut observer, &mut history, "temperature_c", second, number(1));
        }
        let gaps: Vec<bool> = samples(&history, &observer, "temperature_c").iter().map(|sample| sample.2).collect();
        assert_eq!(gaps, [false, false, false, false, false, false, true]);
    }

    #[test]
    fn an_answer_that_failed_leaves_a_gap_in_its_own_line_only() {
        let mut history = History::default();
        let mut observer = observer(&mut history);
        for id in ["temperature_c", "humidity"] {
            take(&mut observer, &mut history, id, 1, number(1));
        }
        observer.missing(&mut history, "humidity");
        for id in ["temperature_c", "humidity"] {
            take(&mut observer, &mut history, id, 2, number(2));
        }
        assert_eq!(samples(&history, &observer, "temperature_c"), [(1, 1, false), (2, 2, false)]);
        assert_eq!(samples(&history, &observer, "humidity"), [(1, 1, false), (2, 2, true)]);
    }

    #[test]
    fn a_switch_that_changes_is_an_event_and_the_first_look_is_none() {
        let mut history = History::default();
        let mut observer = observer(&mut history);
        let words: Vec<Option<String>> = [false, true, true, false]
            .into_iter()
            .zip(1..)
            .map(|(on, second)| {
                take(&mut observer, &mut history, "pir1", second, Value::Bool(on)).map(|entry| entry.text)
            })
            .collect();
        let label = definition().item("pir1").unwrap().label.clone();
        assert_eq!(words, [None, Some(format!("{label}: motion")), None, Some(format!("{label}: quiet"))]);
    }

    #[test]
    fn settings_and_texts_have_no_series_but_limits_do() {
        let mut history = History::default();
        let mut observer = observer(&mut history);
        take(&mut observer, &mut history, "name", 1, Value::Text("PIR234".into()));
        take(&mut observer, &mut history, "pir_on_time", 1, Value::Choice("33".into()));
        take(&mut observer, &mut history, "alarm_limit", 1, number(6_500));
        take(&mut observer, &mut history, "alarm_mode", 1, Value::Choice("latched".into()));
        let items: Vec<&str> = history.series().map(|(_, series)| series.info.item.as_str()).collect();
        assert_eq!(items, ["alarm_limit", "alarm_mode"]);
        let mode = history.get(observer.series("alarm_mode").unwrap()).unwrap();
        assert_eq!(mode.info.text(mode.trend.last_sample().unwrap().value), "latched");
    }

    #[test]
    fn a_module_found_again_goes_on_after_a_gap() {
        let mut history = History::default();
        let mut before = observer(&mut history);
        take(&mut before, &mut history, "humidity", 1, number(1));
        let mut after = observer(&mut history);
        take(&mut after, &mut history, "humidity", 2, number(2));
        assert_eq!(samples(&history, &after, "humidity"), [(1, 1, false), (2, 2, true)]);
    }

    #[test]
    fn being_lost_is_told_once_and_so_is_the_return() {
        let mut observer = observer(&mut History::default());
        let at = timestamp(0);
        let silent = Failure::Silent;
        let kinds: Vec<_> = [None, Some(&silent), Some(&silent), None, None]
            .into_iter()
            .map(|silence| observer.presence(at, silence).map(|entry| entry.kind))
            .collect();
        assert_eq!(kinds, [None, Some(EventKind::Lost), None, Some(EventKind::Found), None]);
    }
}
