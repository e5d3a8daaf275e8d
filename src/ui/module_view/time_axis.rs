//! The span of time that plots and strips share, and its axis in local time.

use std::ops::RangeInclusive;

use eframe::egui::{Align2, Painter, Rangef, Rect, Stroke, pos2};
use jiff::{Timestamp, tz::TimeZone};

use crate::ui::theme::{self, Palette};
use crate::ui::{widgets, words};

/// Steps between two ticks, in seconds.
const STEPS: [f64; 18] = [
    1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1_800.0, 3_600.0, 7_200.0, 10_800.0, 21_600.0,
    43_200.0, 86_400.0,
];

/// From when to when is drawn, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeView {
    /// Seconds since 1970 UTC.
    pub from: f64,
    pub to: f64,
    pub columns: Rangef,
}

impl TimeView {
    pub fn span(&self) -> f64 {
        self.to - self.from
    }

    pub fn x(&self, seconds: f64) -> f32 {
        let part = (seconds - self.from) / self.span();
        self.columns.min + (part * f64::from(self.columns.span())) as f32
    }

    pub fn seconds(&self, x: f32) -> f64 {
        self.from + f64::from(x - self.columns.min) * self.seconds_per_point()
    }

    pub fn seconds_per_point(&self) -> f64 {
        self.span() / f64::from(self.columns.span().max(1.0))
    }

    /// How many points of a line are worth drawing.
    pub fn buckets(&self) -> usize {
        self.columns.span().max(1.0) as usize
    }

    /// Times of the ticks and the step between them; full minutes and hours are those of the local time.
    pub fn ticks(&self) -> (Vec<f64>, f64) {
        let least = f64::from(theme::TICK_DISTANCE[0]) * self.seconds_per_point();
        let step = STEPS.into_iter().find(|step| *step >= least).unwrap_or(86_400.0);
        let offset = local_offset(self.to);
        let local: RangeInclusive<f64> = self.from + offset..=self.to + offset;
        (widgets::multiples(&local, step).into_iter().map(|tick| tick - offset).collect(), step)
    }
}

/// Seconds by which local time is ahead of UTC.
fn local_offset(seconds: f64) -> f64 {
    let at = Timestamp::from_second(seconds as i64).unwrap_or_default();
    f64::from(TimeZone::system().to_offset(at).seconds())
}

/// Draws the axis: short ticks and local times.
pub fn show(painter: &Painter, rect: Rect, view: &TimeView, palette: &Palette) {
    let (ticks, step) = view.ticks();
    for tick in ticks {
        let x = view.x(tick);
        painter.vline(
            x,
            Rangef::new(rect.top(), rect.top() + theme::UNIT),
            Stroke::new(theme::HAIRLINE, palette.quiet),
        );
        let time = words::time_of_day(tick, 0);
        let text = if step >= 60.0 { time.get(..5).unwrap_or(&time) } else { &time };
        let half = theme::TICK_DISTANCE[0] / 4.0;
        if view.columns.shrink(half).contains(x) {
            painter.text(pos2(x, rect.bottom()), Align2::CENTER_BOTTOM, text, theme::small(), palette.quiet);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_lie_inside_and_not_too_close() {
        for span in [2.0, 60.0, 300.0, 3_600.0, 86_400.0] {
            let view = TimeView { from: 1.7e9, to: 1.7e9 + span, columns: Rangef::new(100.0, 700.0) };
            let (ticks, step) = view.ticks();
            assert!(ticks.iter().all(|tick| (view.from..=view.to).contains(tick)), "{span}");
            assert!(step / view.seconds_per_point() >= f64::from(theme::TICK_DISTANCE[0]) * 0.999, "{span}");
        }
    }

    #[test]
    fn a_place_and_its_time_belong_together() {
        let view = TimeView { from: 1.7e9, to: 1.7e9 + 60.0, columns: Rangef::new(100.0, 700.0) };
        assert!((view.seconds(view.x(1.7e9 + 12.5)) - (1.7e9 + 12.5)).abs() < 0.01);
    }
}
