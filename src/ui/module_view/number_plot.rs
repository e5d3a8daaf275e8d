//! One plot for the numbers of one unit, on the shared span of time.

use eframe::egui::{Align2, Painter, Rangef, Rect, Sense, Stroke, Ui, UiBuilder, Vec2, pos2, vec2};
use egui_plot::{GridMark, Line, Plot, PlotPoints};

use super::legend;
use super::limit_line::{self, Limit};
use super::scene::Scene;
use super::series::Series;
use super::time_axis::{self, TimeView};
use crate::module::Kind;
use crate::ui::plot::Scale;
use crate::ui::settings::Settings;
use crate::ui::theme::{self, Palette};

/// The areas of one plot.
pub struct Areas {
    pub legend: Rect,
    pub labels: Rect,
    pub plot: Rect,
}

pub fn show(ui: &mut Ui, areas: &Areas, group: &[&Series<'_>], settings: &mut Settings, scene: &Scene<'_>) {
    let palette = theme::palette(ui);
    for (index, series) in group.iter().enumerate() {
        let top = areas.legend.top() + index as f32 * theme::LEGEND_ROW;
        let row = Rect::from_min_size(pos2(areas.legend.left(), top), vec2(areas.legend.width(), theme::LEGEND_ROW));
        legend::entry(ui, row, series, settings, scene);
    }
    let visible: Vec<&Series<'_>> =
        group.iter().copied().filter(|series| !settings.hidden.contains(series.stem)).collect();
    let limit = Limit::of(scene.module, &visible);
    let scale = scale(&visible, &scene.view, limit.as_ref(), areas.plot.height());
    labels(ui.painter(), areas, &scale, palette);
    let unit = group.first().map_or("", |series| series.unit);
    lines(ui, areas.plot, unit, &visible, &scene.view, &scale);
    marks(ui.painter(), areas.plot, &visible, scene, &scale, palette);
    if let Some(limit) = limit.filter(|_| !scale.empty) {
        limit_line::show(ui, areas.plot, &limit, scale.y(limit.value, areas.plot));
    }
    if scale.empty {
        let none_yet = visible.iter().all(|series| series.trend.is_none_or(|trend| trend.is_empty()));
        let text = match (visible.is_empty(), none_yet) {
            (true, _) => "Hidden",
            (false, true) => "No readings yet",
            (false, false) => "No readings in this time",
        };
        ui.painter().text(areas.plot.center(), Align2::CENTER_CENTER, text, theme::body(), palette.old);
    }
}

/// The range of what is seen, with the limit if it is near.
fn scale(visible: &[&Series<'_>], view: &TimeView, limit: Option<&Limit>, height: f32) -> Scale {
    let extremes = visible.iter().filter_map(|series| series.trend?.extremes(view.from, view.to));
    let extremes = extremes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let least = Scale::least(visible.iter().map(|series| resolution(series)).fold(0.0, f64::max));
    let reach = |range| limit.map_or(range, |limit| limit.taken_into(range, least));
    Scale::around(extremes.map(reach), least, height)
}

/// One unit of the last decimal.
fn resolution(series: &Series<'_>) -> f64 {
    match &series.item.kind {
        Kind::Number { min, .. } => 10f64.powi(-i32::from(min.decimals)),
        _ => 1.0,
    }
}

/// Numbers at the grid's lines; those at the very edge are left out, they would touch the neighbouring plot.
fn labels(painter: &Painter, areas: &Areas, scale: &Scale, palette: &Palette) {
    for tick in &scale.ticks {
        let y = scale.y(*tick, areas.plot);
        if areas.plot.y_range().shrink(theme::UNIT).contains(y) {
            let place = pos2(areas.labels.right() - theme::UNIT, y);
            painter.text(place, Align2::RIGHT_CENTER, scale.label(*tick), theme::small(), palette.quiet);
        }
    }
}

fn lines(ui: &mut Ui, rect: Rect, unit: &str, visible: &[&Series<'_>], view: &TimeView, scale: &Scale) {
    let palette = theme::palette(ui);
    let (time_ticks, time_step) = time_axis::ticks(view);
    let marks = |ticks: &[f64], step: f64| -> Vec<GridMark> {
        ticks.iter().map(|value| GridMark { value: *value, step_size: step }).collect()
    };
    let (across, upwards) = (marks(&time_ticks, time_step), marks(&scale.ticks, scale.step));
    let plot = Plot::new(("numbers", unit))
        .width(rect.width())
        .height(rect.height())
        .min_size(Vec2::ZERO)
        .show_axes(false)
        .show_x(false)
        .show_y(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .sense(Sense::hover())
        .grid_color(palette.grid)
        .grid_fade(0.0)
        .grid_spacing(Rangef::new(0.0, 1.0))
        .x_grid_spacer(move |_| across.clone())
        .y_grid_spacer(move |_| upwards.clone());
    let strokes: Vec<Line<'_>> = visible.iter().flat_map(|series| traces(series, view, palette)).collect();
    let (times, values) = (view.from..=view.to, scale.values.clone());
    // Not a scope: its room is allocated already, and what follows shall not move up to its end.
    plot.show(&mut ui.new_child(UiBuilder::new().max_rect(rect)), move |plot| {
        plot.set_plot_bounds_x(times);
        plot.set_plot_bounds_y(values);
        strokes.into_iter().for_each(|stroke| plot.line(stroke));
    });
}

/// The lines of a series, split where samples are missing.
fn traces<'a>(series: &Series<'_>, view: &TimeView, palette: &Palette) -> Vec<Line<'a>> {
    let stretches = series.trend.map(|trend| trend.lines(view.from, view.to, view.buckets())).unwrap_or_default();
    let line = |stretch: Vec<[f64; 2]>| {
        Line::new(series.label, PlotPoints::from(stretch))
            .stroke(Stroke::new(theme::TRACE, series.colour(palette)))
            .allow_hover(false)
    };
    stretches.into_iter().map(line).collect()
}

/// The samples at the pointer's time.
fn marks(painter: &Painter, rect: Rect, visible: &[&Series<'_>], scene: &Scene<'_>, scale: &Scale, palette: &Palette) {
    for series in visible {
        if let Some([at, value]) = scene.sample(series) {
            let place = pos2(scene.view.x(at), scale.y(value, rect));
            let edge = Stroke::new(theme::HAIRLINE, palette.ground);
            painter.circle(place, theme::SAMPLE_MARK, series.colour(palette), edge);
        }
    }
}
