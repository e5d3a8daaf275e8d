//! A series as the trends show it: one name, one colour, one form wherever it stands.

use eframe::egui::{Align, Color32, Rect, Ui};

use crate::bench::SwitchKind;
use crate::record::{Around, History, ModuleInfo, Point, Series, SeriesId, SeriesInfo, SeriesKind, Statistics, Trend};
use crate::ui::plot::{Run, TimeView, runs};
use crate::ui::settings::TemperatureUnit;
use crate::ui::theme::{self, Palette};
use crate::ui::{widgets, words};

/// Settings that have series, of which the plots show what they mean: a limit.
const SETTINGS: [&str; 2] = ["alarm_limit", "alarm_mode"];

#[derive(Clone, Copy)]
pub struct Curve<'a> {
    pub id: SeriesId,
    pub info: &'a SeriesInfo,
    pub module: &'a ModuleInfo,
    pub trend: &'a Trend,
    /// There are several modules, so that the name says which.
    pub several: bool,
}

/// A value at a time, and what is known of the time around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    pub at: f64,
    pub value: f64,
}

impl<'a> Curve<'a> {
    pub fn of(history: &'a History, id: SeriesId) -> Option<Self> {
        Self::new(history, id, history.get(id)?)
    }

    fn new(history: &'a History, id: SeriesId, series: &'a Series) -> Option<Self> {
        let module = history.module_info(series.info.module)?;
        Some(Self { id, info: &series.info, module, trend: &series.trend, several: is_one_of_several(history, series) })
    }

    /// All that can be chosen: of a pair in both temperature units only the chosen one.
    pub fn all(history: &'a History, unit: TemperatureUnit) -> impl Iterator<Item = Self> {
        let curves = history.series().filter_map(|(id, series)| Self::new(history, id, series));
        curves.filter(move |curve| !is_twin(history, curve.info, unit))
    }

    /// Without its temperature unit.
    pub fn label(&self) -> &'a str {
        self.info.label.trim_end_matches("(°F)").trim_end_matches("(°C)").trim_end()
    }

    /// `Temperature`, or `Temperature @1` where there are several modules.
    pub fn name(&self) -> String {
        match self.several {
            true => format!("{} @{}", self.label(), self.module.address),
            false => self.label().to_owned(),
        }
    }

    /// Paints the name into `rect`; where there is too little room, the label gives way to the module's address.
    pub fn paint_name(&self, ui: &Ui, rect: Rect, colour: Color32) {
        let address = if self.several { format!("@{}", self.module.address) } else { String::new() };
        let galley = widgets::cut(ui, &address, theme::small(), colour, rect.width());
        let room = rect.with_max_x(rect.right() - galley.size().x - if self.several { theme::UNIT } else { 0.0 });
        let label = widgets::line_in(ui, room, Align::Min, self.label(), theme::small(), colour);
        let after = rect.with_min_x(label.right() + theme::UNIT);
        widgets::line_in(ui, after, Align::Min, &address, theme::small(), colour);
    }

    /// Everything that tells it apart, for a pointer that rests.
    pub fn full_name(&self) -> String {
        format!("{}: {}, {}, {}", self.module, self.label(), self.module.protocol, self.module.line)
    }

    pub fn is_number(&self) -> bool {
        matches!(self.info.kind, SeriesKind::Number { .. })
    }

    pub fn switch(&self) -> Option<SwitchKind> {
        matches!(self.info.kind, SeriesKind::Switch).then(|| SwitchKind::of(&self.info.item))
    }

    /// Numbers first, then switches by what they show, then settings.
    pub fn rank(&self) -> (bool, bool, Option<SwitchKind>) {
        (self.is_setting(), !self.is_number(), self.switch())
    }

    pub fn is_setting(&self) -> bool {
        SETTINGS.contains(&self.info.item.as_str())
    }

    /// Id without its temperature unit.
    pub fn stem(&self) -> &'a str {
        stem(&self.info.item)
    }

    /// One unit of the last decimal.
    pub fn resolution(&self) -> f64 {
        10f64.powi(-i32::from(self.info.kind.decimals()))
    }

    /// Numbers have the colour at their place; switches that of what they stand for.
    pub fn colour(&self, place: usize, palette: &Palette) -> Color32 {
        match (self.switch(), self.is_number()) {
            (Some(kind), _) => theme::switch_colour(palette, kind),
            (None, true) => theme::curve_colour(palette, place),
            (None, false) => palette.quiet,
        }
    }

    /// In words, without its unit.
    pub fn word(&self, value: f64) -> String {
        self.word_finer(value, 0)
    }

    /// With so many decimals more than the samples have.
    pub fn word_finer(&self, value: f64, more: usize) -> String {
        match &self.info.kind {
            SeriesKind::Number { decimals } => format!("{value:.places$}", places = usize::from(*decimals) + more),
            SeriesKind::Switch => SwitchKind::of(&self.info.item).word(value >= 0.5).to_owned(),
            SeriesKind::Choice { .. } => {
                let word = self.info.text(value.round() as i64);
                let mut letters = word.chars();
                letters
                    .next()
                    .map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
                    .replace('_', " ")
            }
        }
    }

    /// With its unit.
    pub fn text(&self, value: f64) -> String {
        format!("{} {}", self.word(value), self.info.unit).trim_end().to_owned()
    }

    /// What is drawn of it: lines of samples, one for each unbroken stretch. A setting holds until it is read as something
    /// else, whatever lies between, and still holds.
    pub fn lines(&self, view: &TimeView) -> Vec<Vec<Point>> {
        let lines = self.trend.lines(view.from, view.to, view.buckets());
        if !self.is_setting() {
            return lines;
        }
        let mut held: Vec<Point> = Vec::new();
        for [at, value] in lines.concat() {
            if let Some([_, before]) = held.last().copied().filter(|[_, before]| *before != value) {
                held.push([at, before]);
            }
            held.push([at, value]);
        }
        if let Some([at, value]) = held.last().copied().filter(|[at, _]| *at < view.to) {
            held.push([view.to.max(at), value]);
        }
        vec![held]
    }

    /// The stretches during which a state stood still.
    pub fn runs(&self, view: &TimeView) -> Vec<Run> {
        self.lines(view).iter().flat_map(|stretch| runs(stretch)).collect()
    }

    /// The value at a time: the last one until then. Nothing in a gap, unless a
    /// sample is no further away than `reach` seconds.
    pub fn value_at(&self, at: f64, reach: f64) -> Option<Value> {
        let Around { before, after, joined } = self.trend.around(at)?;
        let value = |[at, value]: Point| Value { at, value };
        let distance = |point: &Point| (point[0] - at).abs();
        let nearest = before.into_iter().chain(after).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if joined || before.is_some_and(|before| before[0] == at) {
            return before.map(value);
        }
        if self.is_setting() {
            return before.map(value);
        }
        nearest.filter(|nearest| distance(nearest) <= reach).map(value)
    }

    pub fn value_text(&self, value: Option<Value>) -> String {
        value.map_or_else(|| words::UNKNOWN.to_owned(), |value| self.word(value.value))
    }

    pub fn statistics(&self, from: f64, to: f64) -> Option<Statistics> {
        self.trend.statistics(from, to)
    }
}

fn is_one_of_several(history: &History, series: &Series) -> bool {
    history.series().any(|(_, other)| other.info.module != series.info.module)
}

fn stem(item: &str) -> &str {
    item.strip_suffix("_c").or_else(|| item.strip_suffix("_f")).unwrap_or(item)
}

fn is_twin(history: &History, info: &SeriesInfo, unit: TemperatureUnit) -> bool {
    let (unwanted, wanted) = match unit {
        TemperatureUnit::Celsius => ("_f", "_c"),
        TemperatureUnit::Fahrenheit => ("_c", "_f"),
    };
    let twin = info.item.strip_suffix(unwanted).map(|stem| format!("{stem}{wanted}"));
    twin.is_some_and(|twin| history.series_of(info.module, &twin).is_some())
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;

    #[test]
    fn the_value_at_a_time_is_none_in_a_gap() {
        let mut history = History::default();
        let id = testing::series(&mut history, 1, "temperature_c", SeriesKind::Number { decimals: 2 });
        for second in [10, 11, 12] {
            history.push(id, second * 1_000_000, 2_000 + second);
        }
        history.mark_gap(id);
        history.push(id, 60_000_000, 2_100);
        let curve = Curve::of(&history, id).unwrap();
        assert_eq!(curve.value_at(11.2, 0.0), Some(Value { at: 11.0, value: 20.11 }));
        assert_eq!(curve.value_at(30.0, 5.0), None);
        assert_eq!(curve.value_at(12.5, 1.0), Some(Value { at: 12.0, value: 20.12 }));
        assert_eq!(curve.value_text(curve.value_at(60.0, 0.0)), "21.00");
    }

    #[test]
    fn a_switch_is_what_it_was_until_it_changed() {
        let mut history = History::default();
        let id = testing::series(&mut history, 1, "pir", SeriesKind::Switch);
        for (second, value) in [(10, 0), (20, 1), (30, 0)] {
            history.push(id, second * 1_000_000, value);
        }
        let curve = Curve::of(&history, id).unwrap();
        let word = |at| curve.value_text(curve.value_at(at, 0.0));
        assert_eq!([word(19.9), word(29.9), word(30.0), word(31.0)], ["quiet", "motion", "quiet", words::UNKNOWN]);
    }

    #[test]
    fn the_name_says_which_module_where_there_are_several() {
        let mut history = History::default();
        let first = testing::series(&mut history, 1, "temperature_c", SeriesKind::Number { decimals: 2 });
        assert_eq!(Curve::of(&history, first).unwrap().name(), "temperature_c");
        testing::series(&mut history, 2, "temperature_c", SeriesKind::Number { decimals: 2 });
        assert_eq!(Curve::of(&history, first).unwrap().name(), "temperature_c @1");
    }

    #[test]
    fn of_a_pair_in_both_units_one_can_be_chosen() {
        let mut history = History::default();
        for item in ["temperature_c", "temperature_f", "humidity", "only_f"] {
            testing::series(&mut history, 1, item, SeriesKind::Number { decimals: 2 });
        }
        let items = |unit| -> Vec<&str> { Curve::all(&history, unit).map(|curve| curve.info.item.as_str()).collect() };
        assert_eq!(items(TemperatureUnit::Celsius), ["temperature_c", "humidity", "only_f"]);
        assert_eq!(items(TemperatureUnit::Fahrenheit), ["temperature_f", "humidity", "only_f"]);
    }
}
