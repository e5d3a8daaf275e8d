//! The limits of the high temperature alarm, where temperatures are drawn.

use std::collections::BTreeMap;

use eframe::egui::{Rangef, Rect, Ui};

use super::curve::Curve;
use super::scene::Scene;
use crate::module::Value;
use crate::record::SeriesKind;
use crate::ui::module_view::temperature;
use crate::ui::plot::{self, Run, Scale};
use crate::ui::theme;

/// The reading that the limit belongs to, without its unit.
const LIMITED: &str = "temperature";
const LIMIT: &str = "alarm_limit";
const MODE: &str = "alarm_mode";
const DISABLED: &str = "disabled";
/// A limit this many ranges of the readings away is drawn to scale; beyond it would flatten them.
const REACH: f64 = 4.0;

/// A limit of one module, or of several that have the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Name and value, as `High alarm limit 65.00 °C`.
    pub text: String,
    /// In the unit of the plot; the value that holds now is the last.
    pub runs: Vec<Run>,
    modules: Vec<u8>,
}

impl Limit {
    pub fn last(&self) -> Option<f64> {
        self.runs.last().map(|run| run.value)
    }

    /// With the modules, where not all have the same.
    pub fn name(&self, several: bool) -> String {
        let modules: Vec<String> = self.modules.iter().map(|address| format!("@{address}")).collect();
        if several { format!("{} {}", self.text, modules.join(", ")) } else { self.text.clone() }
    }
}

/// The limits of the temperatures among these curves, those that are the same once.
pub fn of<'a>(scene: &Scene<'_>, curves: impl Iterator<Item = &'a Curve<'a>>) -> Vec<Limit> {
    let mut found: BTreeMap<String, Limit> = BTreeMap::new();
    for curve in curves.filter(|curve| curve.stem() == LIMITED) {
        let Some(limit) = of_curve(scene, curve) else { continue };
        match found.get_mut(&limit.text) {
            Some(same) if same.runs.len() == limit.runs.len() => same.modules.extend(limit.modules),
            _ => drop(found.insert(limit.text.clone(), limit)),
        }
    }
    found.into_values().collect()
}

fn of_curve(scene: &Scene<'_>, curve: &Curve<'_>) -> Option<Limit> {
    let of_module = |item| Curve::of(scene.history, scene.history.series_of(curve.info.module, item)?);
    if of_module(MODE).is_some_and(|mode| is_disabled(&mode)) {
        return None;
    }
    let (label, mut runs) = match of_module(LIMIT) {
        Some(limit) => (limit.label().to_owned(), told(scene, curve, &limit)),
        None => known(scene, curve)?,
    };
    let last = runs.last_mut()?;
    last.to = scene.view.to.max(last.to);
    let text = format!("{label} {}", curve.text(last.value));
    Some(Limit { text, runs, modules: vec![curve.module.address] })
}

fn is_disabled(mode: &Curve<'_>) -> bool {
    let SeriesKind::Choice { words } = &mode.info.kind else { return false };
    let last = mode.trend.last_sample().and_then(|last| usize::try_from(last.value).ok());
    last.and_then(|place| words.get(place)).is_some_and(|word| word == DISABLED)
}

/// In the unit of the plot, as far as it is known in the view.
fn told(scene: &Scene<'_>, curve: &Curve<'_>, limit: &Curve<'_>) -> Vec<Run> {
    let mut runs = limit.runs(&scene.view);
    runs.retain(|run| run.from <= scene.view.to);
    for run in &mut runs {
        run.value = temperature::converted(run.value, &limit.info.unit, &curve.info.unit).unwrap_or(run.value);
    }
    runs
}

/// What the module has said of it, before it became a part of the history.
fn known(scene: &Scene<'_>, curve: &Curve<'_>) -> Option<(String, Vec<Run>)> {
    let of = |module: &&crate::bench::Module| module.history_id() == Some(curve.info.module);
    let module = scene.bench?.modules().iter().find(of)?;
    let item = module.item(LIMIT).filter(|item| module.has(item))?;
    if module.known(MODE) == Some(&Value::Choice(DISABLED.to_owned())) {
        return None;
    }
    let value = temperature::converted(module.known(LIMIT)?.as_f64()?, &item.unit, &curve.info.unit)?;
    Some((item.label.clone(), vec![Run { from: scene.view.from, to: scene.view.to, value }]))
}

/// The range of values with the limits in it that are not too far away.
pub fn taken_into((low, high): (f64, f64), limits: &[Limit], least: f64) -> (f64, f64) {
    let near = |value: &f64| (value - high).max(low - value) <= (high - low).max(least) * REACH;
    let values = limits.iter().filter_map(Limit::last).filter(near);
    values.fold((low, high), |(low, high), value| (low.min(value), high.max(value)))
}

pub fn show(ui: &Ui, rect: Rect, limits: &[Limit], scale: &Scale, scene: &Scene<'_>, plot: usize) {
    let colour = theme::palette(ui).alarm;
    let several = limits.len() > 1;
    for (index, limit) in limits.iter().enumerate() {
        for run in &limit.runs {
            let columns = Rangef::new(scene.view.x(run.from), scene.view.x(run.to));
            plot::limit::dashed(ui, rect, columns, scale.y(run.value, rect), colour);
        }
        let Some(last) = limit.last() else { continue };
        let y = scale.y(last, rect);
        let beyond = plot::limit::beyond(y, rect);
        // Several that cannot be seen would only cover each other.
        if beyond.is_empty() || !several {
            let id = ui.scope_id().with(("limit", plot, limit.text.as_str(), index));
            plot::limit::name(ui, rect, y, &format!("{}{beyond}", limit.name(several)), colour, id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;
    use crate::record::History;
    use crate::ui::plot::{TimeView, Zone};

    fn limit(value: f64) -> Limit {
        Limit { text: String::new(), runs: vec![Run { from: 0.0, to: 1.0, value }], modules: vec![1] }
    }

    #[test]
    fn near_limits_are_in_the_range_and_far_ones_do_not_flatten_the_readings() {
        assert_eq!(taken_into((20.0, 22.0), &[limit(27.0), limit(65.0)], 1.0), (20.0, 27.0));
        assert_eq!(taken_into((20.0, 22.0), &[limit(65.0)], 1.0), (20.0, 22.0));
    }

    #[test]
    fn a_limit_holds_until_it_is_changed_and_is_named_once_for_all_that_have_it() {
        let mut history = History::default();
        let number = |decimals| SeriesKind::Number { decimals };
        let mut curves = Vec::new();
        for address in [1, 2] {
            curves.push(testing::series(&mut history, address, "temperature_c", number(2)));
            let limit = testing::series(&mut history, address, "alarm_limit", number(2));
            history.push(limit, 10_000_000, 3_000);
            history.mark_gap(limit);
            history.push(limit, 50_000_000, 3_500);
        }
        let view = TimeView { from: 20.0, to: 100.0, columns: Rangef::new(0.0, 600.0) };
        let scene = Scene { history: &history, bench: None, view, zone: Zone::Utc, pointer: None };
        let curves: Vec<Curve<'_>> = curves.into_iter().filter_map(|id| Curve::of(&history, id)).collect();
        let limits = of(&scene, curves.iter());
        let [limit] = limits.as_slice() else { panic!("{limits:?}") };
        assert_eq!(limit.text, "alarm_limit 35.00 °C");
        assert_eq!(limit.name(true), "alarm_limit 35.00 °C @1, @2");
        let expected = [Run { from: 10.0, to: 50.0, value: 30.0 }, Run { from: 50.0, to: 100.0, value: 35.0 }];
        assert_eq!(limit.runs, expected);
    }
}
