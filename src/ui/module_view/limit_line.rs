//! The limit of the high temperature alarm in the plot of temperatures.

use eframe::egui::{Rect, Ui};

use super::series::Series;
use super::temperature;
use crate::bench::Module;
use crate::module::Value;
use crate::ui::{plot, theme};

/// The reading that the limit belongs to, without its unit.
const LIMITED: &str = "temperature";
/// A limit this many ranges of the readings away is drawn to scale; beyond it would flatten them.
const REACH: f64 = 4.0;

pub struct Limit {
    /// In the unit of the plot.
    pub value: f64,
    /// Name and value, as `High alarm limit 65.00 °C`.
    text: String,
    /// The alarm is switched off.
    disabled: bool,
    /// It is known to be switched on.
    in_force: bool,
}

impl Limit {
    /// The limit of one of these series in their unit, if the module has told it.
    pub fn of(module: &Module, group: &[&Series<'_>]) -> Option<Self> {
        let series = group.iter().find(|series| series.stem == LIMITED)?;
        let item = module.item("alarm_limit").filter(|item| module.has(item))?;
        let known = module.known(&item.id)?.as_f64()?;
        let value = temperature::converted(known, &item.unit, series.unit)?;
        let mode = module.item("alarm_mode").filter(|mode| module.has(mode));
        let disabled = mode.is_some() && module.known("alarm_mode") == Some(&Value::Choice("disabled".to_owned()));
        let in_force = !disabled && (mode.is_none() || module.known("alarm_mode").is_some());
        let text = format!("{} {} {}", item.label, series.sample_word(value), series.unit);
        Some(Self { value, text, disabled, in_force })
    }

    /// The range of values with the limit in it, unless it is too far away or not in force.
    pub fn taken_into(&self, (low, high): (f64, f64), least: f64) -> (f64, f64) {
        let distance = (self.value - high).max(low - self.value);
        if !self.in_force || distance > (high - low).max(least) * REACH {
            return (low, high);
        }
        (low.min(self.value), high.max(self.value))
    }
}

/// A dashed line with its name at height `y`; where that lies outside, only the name at the edge that it lies beyond.
pub fn show(ui: &Ui, rect: Rect, limit: &Limit, y: f32) {
    let palette = theme::palette(ui);
    let colour = if limit.in_force { palette.alarm } else { palette.old };
    plot::limit::dashed(ui, rect, rect.x_range(), y, colour);
    let place = plot::limit::beyond(y, rect);
    if limit.disabled && !place.is_empty() {
        return;
    }
    let text = format!("{}{place}{}", limit.text, if limit.disabled { ", alarm disabled" } else { "" });
    plot::limit::name(ui, rect, y, &text, colour, ui.scope_id().with("limit"));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(value: f64, in_force: bool) -> Limit {
        Limit { value, text: String::new(), disabled: !in_force, in_force }
    }

    #[test]
    fn a_near_limit_is_in_the_range_and_a_far_one_does_not_flatten_the_readings() {
        assert_eq!(limit(27.0, true).taken_into((20.0, 22.0), 1.0), (20.0, 27.0));
        assert_eq!(limit(17.0, true).taken_into((20.0, 22.0), 1.0), (17.0, 22.0));
        assert_eq!(limit(65.0, true).taken_into((20.0, 22.0), 1.0), (20.0, 22.0));
        assert_eq!(limit(21.0, true).taken_into((20.0, 22.0), 1.0), (20.0, 22.0));
    }

    #[test]
    fn a_limit_that_is_not_in_force_changes_no_range() {
        assert_eq!(limit(23.0, false).taken_into((20.0, 22.0), 1.0), (20.0, 22.0));
    }
}
