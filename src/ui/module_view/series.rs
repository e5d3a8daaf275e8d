//! What is read again and again, as the list, the readings and the plot show it: one name, one colour, one order.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui::Color32;
use jiff::Timestamp;

use crate::bench::{Module, Reading, SwitchKind};
use crate::module::{Definition, Item, Kind, Value};
use crate::protocol::Failure;
use crate::record::{History, Trend};
use crate::ui::settings::TemperatureUnit;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets::Glyph;
use crate::ui::words;

/// A value is fresh for so many poll intervals.
const FRESH_INTERVALS: u32 = 3;
/// And for so long at least.
const FRESH_AT_LEAST: Duration = Duration::from_secs(3);

/// What a series shows, which rules its form and colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// A number, by its place among the numbers of the module.
    Number(usize),
    Switch(SwitchKind),
}

/// How much a value is worth.
#[derive(Debug, Clone, PartialEq)]
pub enum Freshness {
    Fresh,
    /// The value is this old.
    Old(Duration),
    /// There is no value yet.
    Unknown,
}

#[derive(Clone)]
pub struct Series<'a> {
    pub item: &'a Item,
    /// Id without its temperature unit: a series is the same in °C and °F.
    pub stem: &'a str,
    pub label: &'a str,
    pub unit: &'a str,
    pub family: Family,
    pub reading: Option<&'a Reading>,
    pub trend: Option<&'a Trend>,
}

/// The live items of a module in the chosen temperature unit: numbers first, then switches by what they show, else in
/// the order of the definition.
pub fn series_of<'a>(history: &'a History, module: &'a Module, unit: TemperatureUnit) -> Vec<Series<'a>> {
    let Some(definition) = module.definition() else { return Vec::new() };
    let items = definition.live_items(module.target.protocol);
    let shown = items.filter(|item| module.has(item) && is_chosen(definition, item, unit));
    let (numbers, switches): (Vec<&Item>, Vec<&Item>) =
        shown.partition(|item| matches!(item.kind, Kind::Number { .. }));
    let numbers = numbers.into_iter().enumerate().map(|(index, item)| (item, Family::Number(index)));
    let switches = switches.into_iter().map(|item| (item, Family::Switch(SwitchKind::of(&item.id))));
    let mut series: Vec<Series<'_>> =
        numbers.chain(switches).map(|(item, family)| Series::new(history, module, item, family)).collect();
    series.sort_by_key(|series| series.family);
    series
}

/// Of a pair in both temperature units only one is shown; what exists in one unit is shown in that.
fn is_chosen(definition: &Arc<Definition>, item: &Item, unit: TemperatureUnit) -> bool {
    let (unwanted, wanted) = match unit {
        TemperatureUnit::Celsius => ("_f", "_c"),
        TemperatureUnit::Fahrenheit => ("_c", "_f"),
    };
    let twin = item.id.strip_suffix(unwanted).map(|stem| format!("{stem}{wanted}"));
    twin.is_none_or(|twin| definition.item(&twin).is_none())
}

impl<'a> Series<'a> {
    fn new(history: &'a History, module: &'a Module, item: &'a Item, family: Family) -> Self {
        let stem = item.id.strip_suffix("_c").or_else(|| item.id.strip_suffix("_f")).unwrap_or(&item.id);
        let label = item.label.trim_end_matches("(°F)").trim_end_matches("(°C)").trim_end();
        let (reading, trend) = (module.reading(&item.id), module.trend(history, &item.id));
        Self { item, stem, label, unit: &item.unit, family, reading, trend }
    }

    pub fn is_number(&self) -> bool {
        matches!(self.family, Family::Number(_))
    }

    pub fn colour(&self, palette: &Palette) -> Color32 {
        match self.family {
            Family::Number(index) => {
                let all = palette.series;
                all.get(index % all.len()).copied().unwrap_or(palette.text)
            }
            Family::Switch(kind) => theme::switch_colour(palette, kind),
        }
    }

    /// The form of a switch; `None` is unknown.
    pub fn glyph(&self, on: Option<bool>) -> Glyph {
        match (self.family, on) {
            (_, None) => Glyph::Dashes,
            (Family::Switch(kind), Some(on)) => Glyph::of_switch(kind, on),
            (Family::Number(_), Some(on)) => {
                if on {
                    Glyph::Disc
                } else {
                    Glyph::Ring
                }
            }
        }
    }

    /// The value in words; numbers without their unit.
    pub fn word(&self, value: &Value) -> String {
        match (self.family, value.as_bool()) {
            (Family::Switch(kind), Some(on)) => kind.word(on).to_owned(),
            _ => self.item.bare_text(value),
        }
    }

    /// A sample of the trend in words.
    pub fn sample_word(&self, sample: f64) -> String {
        match &self.item.kind {
            Kind::Bool => self.word(&Value::Bool(sample >= 0.5)),
            Kind::Number { min, .. } => format!("{sample:.places$}", places = usize::from(min.decimals)),
            _ => sample.to_string(),
        }
    }

    pub fn problem(&self) -> Option<&'a Failure> {
        self.reading.and_then(|reading| reading.problem.as_ref())
    }

    pub fn freshness(&self, module: &Module, now: Timestamp) -> Freshness {
        let Some(at) = self.reading.filter(|reading| reading.value.is_some()).and_then(|reading| reading.at) else {
            return Freshness::Unknown;
        };
        let age = words::since(at, now);
        let interval = module.interval.unwrap_or_default();
        let limit = interval.saturating_mul(FRESH_INTERVALS).max(FRESH_AT_LEAST);
        if self.problem().is_some() || age > limit { Freshness::Old(age) } else { Freshness::Fresh }
    }
}
