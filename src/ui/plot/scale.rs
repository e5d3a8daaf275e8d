//! The range of values that a plot shows.

use std::ops::RangeInclusive;

use eframe::egui::Rect;

use crate::ui::{theme, widgets};

/// The smallest range of values, in units of the last decimal: noise shall not look like an event.
const LEAST_RANGE: f64 = 100.0;
/// Room above and below the lines, as a part of their range.
const MARGIN: f64 = 0.16;
/// The ends of the range are multiples of this part of a step, so that they do not move with every sample.
const GRAIN: f64 = 0.5;
/// Decimals that labels have at most.
const MOST_PLACES: f64 = 6.0;

/// The range of values that is drawn, with the grid's lines and their distance.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// There is nothing to draw, so the range means nothing.
    pub empty: bool,
    pub values: RangeInclusive<f64>,
    pub ticks: Vec<f64>,
    pub step: f64,
}

impl Scale {
    /// The smallest range for values with this resolution.
    pub fn least(resolution: f64) -> f64 {
        (resolution * LEAST_RANGE).max(f64::EPSILON)
    }

    /// Some room above and below what is drawn, and never so fine that noise looks like an event. `height` in points.
    pub fn around(extremes: Option<(f64, f64)>, least: f64, height: f32) -> Self {
        let (low, high) = extremes.unwrap_or((0.0, 0.0));
        let (middle, half) = ((low + high) / 2.0, ((high - low) / 2.0 * (1.0 + MARGIN)).max(least / 2.0));
        let (_, step) = widgets::round_steps(&(middle - half..=middle + half), most(height));
        let grain = step * GRAIN;
        let values = ((middle - half) / grain).floor() * grain..=((middle + half) / grain).ceil() * grain;
        let ticks = if extremes.is_some() { widgets::multiples(&values, step) } else { Vec::new() };
        Self { empty: extremes.is_none(), values, ticks, step }
    }

    /// Exactly this range.
    pub fn fixed([low, high]: [f64; 2], height: f32) -> Self {
        let values = low..=high;
        let (ticks, step) = widgets::round_steps(&values, most(height));
        Self { empty: false, values, ticks, step }
    }

    /// Where a value lies, from 0 at the bottom to 1 at the top.
    pub fn part(&self, value: f64) -> f64 {
        (value - self.values.start()) / (self.values.end() - self.values.start())
    }

    /// Where a value lies on the screen.
    pub fn y(&self, value: f64, rect: Rect) -> f32 {
        rect.bottom() - (self.part(value) * f64::from(rect.height())) as f32
    }

    /// The value at a height of the screen.
    pub fn value(&self, y: f32, rect: Rect) -> f64 {
        let part = f64::from((rect.bottom() - y) / rect.height().max(1.0));
        self.values.start() + part * (self.values.end() - self.values.start())
    }

    /// What stands at a line of the grid.
    pub fn label(&self, tick: f64) -> String {
        let places = (-self.step.log10().floor()).clamp(0.0, MOST_PLACES) as usize;
        // Adding zero makes -0 positive.
        format!("{:.places$}", tick + 0.0)
    }
}

fn most(height: f32) -> f64 {
    f64::from(height / theme::TICK_DISTANCE[1]).max(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_and_its_value_belong_together() {
        let rect = Rect::from_min_max([0.0, 50.0].into(), [10.0, 250.0].into());
        for scale in [Scale::around(Some((20.0, 22.0)), 1.0, 200.0), Scale::fixed([-3.0, 7.5], 200.0)] {
            assert!((scale.value(scale.y(3.25, rect), rect) - 3.25).abs() < 1e-3);
        }
    }

    #[test]
    fn labels_have_the_decimals_of_the_step() {
        let scale = Scale::fixed([0.0, 0.1], 100.0);
        assert!(scale.ticks.len() >= 2);
        assert_eq!(scale.label(0.05), "0.05");
        assert_eq!(Scale::fixed([0.0, 100.0], 100.0).label(-0.0), "0");
    }
}
