//! Switches over time: a strip for each, filled while it is on.

use eframe::egui::{Painter, Rect, Stroke, Ui, pos2};

use super::legend;
use super::scene::Scene;
use super::series::Series;
use super::time_axis::TimeView;
use crate::ui::plot::{Run, runs};
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

fn trace(painter: &Painter, rect: Rect, runs: &[Run], series: &Series<'_>, view: &TimeView, palette: &Palette) {
    let colour = series.colour(palette);
    let inside = rect.shrink2(eframe::egui::vec2(0.0, theme::STRIP_INSET));
    for run in runs {
        let left = view.x(run.from);
        let right = view.x(run.to).max(left + LEAST_WIDTH);
        if run.is_on() {
            painter.rect_filled(Rect::from_x_y_ranges(left..=right, inside.y_range()), 0.0, colour);
        } else {
            let y = inside.bottom() - theme::HAIRLINE / 2.0;
            painter.line_segment([pos2(left, y), pos2(right, y)], Stroke::new(theme::HAIRLINE, colour));
        }
    }
}
