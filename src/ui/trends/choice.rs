//! Which series are shown and where: which plot, which of its axes. Kept in the settings by the module's place and the
//! item's name, so that it is the same after the next start.

use super::curve::Curve;
use crate::bench::SwitchKind;
use crate::record::{History, SeriesId};
use crate::ui::settings::TemperatureUnit;

/// Curves and strips that are shown without being asked for.
const CURVES_AT_FIRST: usize = 8;
const STRIPS_AT_FIRST: usize = 8;
/// Numbers that are shown without being asked for, the most wanted first.
const WANTED: [&str; 2] = ["temperature", "humidity"];

/// Where a number is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    Left,
    Right,
}

/// A series that is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    pub id: SeriesId,
    /// Counted from the top; means nothing for strips.
    pub plot: usize,
    pub side: Side,
    /// Its place among the colours of numbers.
    pub colour: usize,
    /// It stands in the legend and is not drawn.
    pub hidden: bool,
}

/// Where a series is moved to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Move {
    Above,
    Below,
    NewPlot,
    ToPlot(usize),
    To(Side),
}

#[derive(Debug, Default)]
pub struct Choice {
    shown: Vec<Shown>,
    /// Series of the history that were looked at already.
    known: usize,
    /// The user has chosen; nothing is added any more.
    own: bool,
    changed: bool,
}

impl Choice {
    pub fn shown(&self) -> &[Shown] {
        &self.shown
    }

    pub fn get(&self, id: SeriesId) -> Option<&Shown> {
        self.shown.iter().find(|shown| shown.id == id)
    }

    pub fn get_mut(&mut self, id: SeriesId) -> Option<&mut Shown> {
        self.shown.iter_mut().find(|shown| shown.id == id)
    }

    /// How many plots there are.
    pub fn plots(&self, history: &History) -> usize {
        let numbers = self.shown.iter().filter(|shown| is_number(history, shown.id));
        numbers.map(|shown| shown.plot.saturating_add(1)).max().unwrap_or_default()
    }

    /// Takes in series that are new, as `kept` says or as is sensible at first.
    pub fn keep_up(&mut self, history: &History, unit: TemperatureUnit, kept: &[String]) {
        let count = history.series().len();
        if count == self.known {
            return;
        }
        if count < self.known {
            // Another history.
            *self = Self::default();
        }
        let from = std::mem::replace(&mut self.known, count);
        let added = self.take_kept(history, from, kept);
        if added {
            self.own = true;
        }
        if !self.own {
            self.shown.clear();
            self.at_first(history, unit);
        }
        self.close_gaps(history);
    }

    fn take_kept(&mut self, history: &History, from: usize, kept: &[String]) -> bool {
        if kept.is_empty() {
            return false;
        }
        let mut found = Vec::new();
        for (id, _) in history.series().skip(from) {
            let Some(curve) = Curve::of(history, id) else { continue };
            let name = kept_name(&curve);
            let entry = kept.iter().enumerate().find_map(|(order, text)| {
                let (place, side, of) = parse(text)?;
                (of == name).then_some((order, place, side))
            });
            if let Some((order, plot, side)) = entry {
                found.push((order, id, plot, side));
            }
        }
        if !self.own && !found.is_empty() {
            self.shown.clear();
        }
        found.sort_unstable_by_key(|(order, ..)| *order);
        let any = !found.is_empty();
        for (_, id, plot, side) in found {
            if self.get(id).is_none() {
                let colour = self.free_colour(history, id);
                self.shown.push(Shown { id, plot, side, colour, hidden: false });
            }
        }
        any
    }

    fn at_first(&mut self, history: &History, unit: TemperatureUnit) {
        let curves: Vec<Curve<'_>> = Curve::all(history, unit).collect();
        for wanted in WANTED {
            for curve in curves.iter().filter(|curve| curve.is_number() && curve.stem() == wanted) {
                if self.shown.len() < CURVES_AT_FIRST {
                    self.show(history, curve.id);
                }
            }
        }
        let mut modules: Vec<_> = curves.iter().map(|curve| curve.info.module).collect();
        modules.sort_unstable();
        modules.dedup();
        let modules = modules.len().max(1);
        let each = (STRIPS_AT_FIRST / modules).max(1);
        for (module, _) in history.modules() {
            let mut switches: Vec<(SwitchKind, SeriesId)> = curves
                .iter()
                .filter(|curve| curve.info.module == module)
                .filter_map(|curve| Some((curve.switch()?, curve.id)))
                .filter(|(kind, _)| matches!(kind, SwitchKind::Motion | SwitchKind::Output | SwitchKind::Alarm))
                .collect();
            switches.sort_by_key(|(kind, _)| *kind);
            switches.iter().take(each).for_each(|(_, id)| self.show(history, *id));
        }
    }

    /// Shows a series in the first plot that has its unit, else in a new one.
    fn show(&mut self, history: &History, id: SeriesId) {
        if self.get(id).is_some() {
            return;
        }
        let unit = |id: SeriesId| history.get(id).map(|series| series.info.unit.as_str());
        let same = self.shown.iter().find(|shown| is_number(history, shown.id) && unit(shown.id) == unit(id));
        let (plot, side) = match same {
            Some(same) => (same.plot, same.side),
            None => (self.plots(history), Side::Left),
        };
        let colour = self.free_colour(history, id);
        self.shown.push(Shown { id, plot, side, colour, hidden: false });
    }

    /// The colour that the module's own tabs give it, if no other has it.
    fn free_colour(&self, history: &History, id: SeriesId) -> usize {
        let Some(curve) = Curve::of(history, id).filter(Curve::is_number) else { return 0 };
        let mut stems: Vec<&str> = Vec::new();
        for (_, series) in history.series().filter(|(_, series)| series.info.module == curve.info.module) {
            let other = series.info.item.strip_suffix("_c").or_else(|| series.info.item.strip_suffix("_f"));
            let stem = other.unwrap_or(&series.info.item);
            if matches!(series.info.kind, crate::record::SeriesKind::Number { .. }) && !stems.contains(&stem) {
                stems.push(stem);
            }
        }
        let own = stems.iter().position(|stem| *stem == curve.stem()).unwrap_or_default();
        let taken = |colour: usize| {
            self.shown.iter().any(|shown| shown.colour == colour && is_number(history, shown.id) && shown.id != id)
        };
        if !taken(own) {
            return own;
        }
        (0..=self.shown.len()).find(|colour| !taken(*colour)).unwrap_or_default()
    }

    /// Shows a series or no longer does.
    pub fn toggle(&mut self, history: &History, id: SeriesId) {
        (self.own, self.changed) = (true, true);
        match self.get(id) {
            Some(_) => self.shown.retain(|shown| shown.id != id),
            None => self.show(history, id),
        }
        self.close_gaps(history);
    }

    /// Shows all of these, or none if all are shown.
    pub fn toggle_all(&mut self, history: &History, ids: &[SeriesId]) {
        (self.own, self.changed) = (true, true);
        if ids.iter().all(|id| self.get(*id).is_some()) {
            self.shown.retain(|shown| !ids.contains(&shown.id));
        } else {
            ids.iter().for_each(|id| self.show(history, *id));
        }
        self.close_gaps(history);
    }

    pub fn apply(&mut self, history: &History, id: SeriesId, moved: Move) {
        let plots = self.plots(history);
        let Some(plot) = self.get(id).map(|shown| shown.plot) else { return };
        let to = match moved {
            Move::Above => plot.saturating_sub(1),
            Move::Below => plot.saturating_add(1).min(plots.saturating_sub(1)),
            Move::NewPlot => plots,
            Move::ToPlot(to) => to.min(plots),
            Move::To(_) => plot,
        };
        let side = match moved {
            Move::To(side) => side,
            _ if to == plot => return,
            _ => self.side_in(history, id, to),
        };
        if let Some(shown) = self.get_mut(id) {
            (shown.plot, shown.side) = (to, side);
        }
        (self.own, self.changed) = (true, true);
        self.close_gaps(history);
    }

    /// The axis of its unit, else the one that is free, else the right one.
    fn side_in(&self, history: &History, id: SeriesId, plot: usize) -> Side {
        let unit = |id: SeriesId| history.get(id).map(|series| series.info.unit.as_str());
        let others: Vec<&Shown> = self
            .shown
            .iter()
            .filter(|shown| shown.plot == plot && shown.id != id && is_number(history, shown.id))
            .collect();
        if let Some(same) = others.iter().find(|shown| unit(shown.id) == unit(id)) {
            return same.side;
        }
        if others.iter().any(|shown| shown.side == Side::Left) { Side::Right } else { Side::Left }
    }

    /// Plots without a series are no plots.
    fn close_gaps(&mut self, history: &History) {
        let numbers = self.shown.iter().filter(|shown| is_number(history, shown.id));
        let mut used: Vec<usize> = numbers.map(|shown| shown.plot).collect();
        used.sort_unstable();
        used.dedup();
        for shown in &mut self.shown {
            shown.plot = used.partition_point(|plot| *plot < shown.plot);
        }
    }

    /// Whether the user has chosen otherwise since this was last asked.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// As it is kept in the settings. What is kept of modules that are not here stays.
    pub fn to_keep(&self, history: &History, kept: &[String]) -> Vec<String> {
        let here: Vec<String> = history.modules().map(|(_, info)| place(info)).collect();
        let is_here = |text: &String| {
            parse(text)
                .and_then(|(_, _, of)| of.split_once(' '))
                .is_none_or(|(_, of)| here.iter().any(|here| here == of))
        };
        let mine = self.shown.iter().filter_map(|shown| {
            let curve = Curve::of(history, shown.id)?;
            let side = if shown.side == Side::Left { "left" } else { "right" };
            Some(format!("{} {side} {}", shown.plot, kept_name(&curve)))
        });
        mine.chain(kept.iter().filter(|text| !is_here(text)).cloned()).collect()
    }
}

fn is_number(history: &History, id: SeriesId) -> bool {
    Curve::of(history, id).is_some_and(|curve| curve.is_number())
}

/// `temperature_c modbus_rtu@1 COM3`.
fn kept_name(curve: &Curve<'_>) -> String {
    format!("{} {}", curve.info.item, place(curve.module))
}

fn place(info: &crate::record::ModuleInfo) -> String {
    format!("{}@{} {}", info.protocol, info.address, info.line)
}

/// `0 left temperature_c modbus_rtu@1 COM3`: plot, axis, item, module.
fn parse(text: &str) -> Option<(usize, Side, &str)> {
    let (plot, rest) = text.split_once(' ')?;
    let (side, name) = rest.split_once(' ')?;
    let side = match side {
        "left" => Side::Left,
        "right" => Side::Right,
        _ => return None,
    };
    Some((plot.parse().ok().filter(|plot| *plot < 64)?, side, name))
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;
    use crate::record::SeriesKind;

    const NUMBER: SeriesKind = SeriesKind::Number { decimals: 2 };

    fn two_modules() -> History {
        let mut history = History::default();
        for address in [1, 2] {
            for item in ["humidity", "temperature_c", "dew_point_c"] {
                testing::series(&mut history, address, item, NUMBER);
            }
            testing::series(&mut history, address, "pir", SeriesKind::Switch);
            testing::series(&mut history, address, "wdt_tripped", SeriesKind::Switch);
        }
        history
    }

    fn names(choice: &Choice, history: &History) -> Vec<String> {
        let name = |shown: &Shown| Curve::of(history, shown.id).unwrap().name();
        choice.shown().iter().map(name).collect()
    }

    fn first(history: &History) -> Choice {
        let mut choice = Choice::default();
        choice.keep_up(history, TemperatureUnit::Celsius, &[]);
        choice
    }

    #[test]
    fn at_first_temperatures_humidities_and_motion_are_shown_one_plot_for_each_unit() {
        let history = two_modules();
        let choice = first(&history);
        let expected = ["temperature_c @1", "temperature_c @2", "humidity @1", "humidity @2", "pir @1", "pir @2"]
            .map(str::to_owned);
        assert_eq!(names(&choice, &history), expected);
        let plots: Vec<usize> = choice.shown().iter().take(4).map(|shown| shown.plot).collect();
        assert_eq!(plots, [0, 0, 1, 1]);
        let mut colours: Vec<usize> = choice.shown().iter().take(4).map(|shown| shown.colour).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), 4, "no two curves have the same colour");
    }

    #[test]
    fn a_series_moves_between_plots_and_axes_and_empty_plots_vanish() {
        let history = two_modules();
        let mut choice = first(&history);
        let [temperature, humidity, other] = [0, 2, 3].map(|index| choice.shown()[index].id);
        choice.apply(&history, humidity, Move::Above);
        let place = |choice: &Choice, id| choice.get(id).map(|shown| (shown.plot, shown.side)).unwrap();
        assert_eq!(place(&choice, humidity), (0, Side::Right));
        choice.apply(&history, other, Move::Above);
        assert_eq!(place(&choice, other), (0, Side::Right));
        assert_eq!(choice.plots(&history), 1);
        choice.apply(&history, temperature, Move::NewPlot);
        assert_eq!(place(&choice, temperature), (1, Side::Left));
        choice.apply(&history, temperature, Move::To(Side::Right));
        assert_eq!(place(&choice, temperature), (1, Side::Right));
    }

    #[test]
    fn what_was_chosen_is_found_again_and_what_is_kept_of_other_modules_stays() {
        let history = two_modules();
        let mut choice = first(&history);
        assert!(!choice.take_changed());
        let id = choice.shown()[1].id;
        choice.toggle(&history, id);
        choice.apply(&history, choice.shown()[1].id, Move::Above);
        let elsewhere = "3 left humidity dcon@7 COM9".to_owned();
        assert!(choice.take_changed());
        let kept = choice.to_keep(&history, std::slice::from_ref(&elsewhere));
        assert_eq!(kept[0], "0 left temperature_c modbus_rtu@1 COM3");
        assert_eq!(kept.last(), Some(&elsewhere));
        let mut again = Choice::default();
        again.keep_up(&history, TemperatureUnit::Celsius, &kept);
        assert_eq!(names(&again, &history), names(&choice, &history));
        assert_eq!(again.shown()[1].side, Side::Right);
        let mut defaults = Choice::default();
        defaults.keep_up(&history, TemperatureUnit::Celsius, &[elsewhere, "nonsense".to_owned()]);
        assert_eq!(names(&defaults, &history), names(&first(&history), &history));
    }
}
