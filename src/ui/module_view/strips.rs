//! Switches over time: a strip for each, filled while it is on.

use eframe::egui::{Painter, Rect, Stroke, Ui, pos2};

use super::legend;
use super::scene::Scene;
use super::series::Series;
use super::time_axis::TimeView;
use crate::ui::settings::Settings;
use crate::ui::theme::{self, Palette};

/// The narrowest visible stretch.
const LEAST_WIDTH: f32 = 1.0;

/// Draws one strip, its name in `name` and its trace in `rect`.
pub fn show(ui: &mut Ui, (name, rect): (Rect, Rect), series: &Series<'_>, settings: &mut Settings, scene: &Scene<'_>) {
    let palette = theme::palette(ui);
    legend::entry(ui, name, series, settings, scene);
    if settings.hidden.contains(series.stem) {
        return;
    }
    draw(ui.painter(), rect, series, &scene.view, palette);
}

/// Draws the trace of a switch into `rect`.
pub fn draw(painter: &Painter, rect: Rect, series: &Series<'_>, view: &TimeView, palette: &Palette) {
    let painter = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    for stretch in series.trend.map(|trend| trend.lines(view.from, view.to, view.buckets())).unwrap_or_default() {
        trace(&painter, rect, &runs(&stretch), series, view, palette);
    }
}

/// A time during which the switch stood still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    pub from: f64,
    pub to: f64,
    pub on: bool,
}

/// Joins samples that are alike; each holds until the next.
pub fn runs(stretch: &[[f64; 2]]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for [at, value] in stretch {
        let on = *value >= 0.5;
        if let Some(last) = runs.last_mut() {
            last.to = *at;
        }
        if runs.last().is_none_or(|last| last.on != on) {
            runs.push(Run { from: *at, to: *at, on });
        }
    }
    runs
}

fn trace(painter: &Painter, rect: Rect, runs: &[Run], series: &Series<'_>, view: &TimeView, palette: &Palette) {
    let colour = series.colour(palette);
    let inside = rect.shrink2(eframe::egui::vec2(0.0, theme::STRIP_INSET));
    for run in runs {
        let left = view.x(run.from);
        let right = view.x(run.to).max(left + LEAST_WIDTH);
        if run.on {
            painter.rect_filled(Rect::from_x_y_ranges(left..=right, inside.y_range()), 0.0, colour);
        } else {
            let y = inside.bottom() - theme::HAIRLINE / 2.0;
            painter.line_segment([pos2(left, y), pos2(right, y)], Stroke::new(theme::HAIRLINE, colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_samples_are_one_run_that_lasts_until_the_next() {
        let samples = [[1.0, 0.0], [2.0, 0.0], [3.0, 1.0], [4.0, 1.0], [5.0, 0.0]];
        let expected = [
            Run { from: 1.0, to: 3.0, on: false },
            Run { from: 3.0, to: 5.0, on: true },
            Run { from: 5.0, to: 5.0, on: false },
        ];
        assert_eq!(runs(&samples), expected);
        assert_eq!(runs(&[]), []);
    }
}
