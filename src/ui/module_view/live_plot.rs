//! The history of the readings: plots of the numbers, one for each unit, and strips of the switches, all on one span
//! of time. It follows the present until it is dragged or held.

use eframe::egui::{Align, Align2, PointerButton, Rangef, Rect, Response, Sense, Stroke, Ui, Vec2, pos2, vec2};
use jiff::Timestamp;

use super::number_plot::{self, Areas};
use super::scene::Scene;
use super::series::Series;
use super::strips;
use super::time_axis::{self, TimeView};
use crate::bench::Module;
use crate::ui::settings::{SPANS, Settings};
use crate::ui::theme::{self, Palette};
use crate::ui::{widgets, words};

/// Spans to choose from, in seconds.
const SPAN: &str = "How much time the plot shows; the wheel over it changes that too";
const CHOICES: [(f64, &str); 4] = [(60.0, "1 min"), (300.0, "5 min"), (900.0, "15 min"), (3_600.0, "1 h")];
/// Zoom of a scroll by one point.
const ZOOM_PER_POINT: f64 = 0.004;
/// A selection narrower than this many points is a slip of the hand.
const LEAST_SELECTION: f32 = 6.0;

#[derive(Default)]
pub struct LivePlot {
    /// The right edge, in seconds since 1970; `None` while the present is followed.
    end: Option<f64>,
    /// Where a span began to be selected.
    selecting: Option<f32>,
}

/// The room of everything: rows from top to bottom, columns from left to right.
struct Layout {
    plots: Vec<Areas>,
    strips: Vec<(Rect, Rect)>,
    axis: Rect,
    /// All of it that has a time.
    timed: Rect,
}

impl LivePlot {
    /// Draws tools and plots, together as high as `room`; higher if they would become too small to read.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        module: &Module,
        series: &[Series<'_>],
        settings: &mut Settings,
        now: Timestamp,
        room: f32,
    ) {
        let latest = latest(series, now);
        let top = ui.cursor().top();
        self.tools(ui, settings, latest);
        let height = room - (ui.cursor().top() - top);
        let groups = groups(series);
        let switches: Vec<&Series<'_>> = series.iter().filter(|one| settings.strips && !one.is_number()).collect();
        let layout = layout(ui, &groups, switches.len(), height);

        let response = ui.interact(layout.timed, ui.scope_id().with("time"), Sense::click_and_drag());
        let to = self.end.unwrap_or(latest);
        let mut view = TimeView { from: to - settings.span, to, columns: layout.timed.x_range() };
        self.navigate(ui, &response, &mut view, settings);
        self.stay_within(&mut view, settings.span, first(series), latest);
        let cursor = response.hover_pos().map(|pointer| view.seconds(pointer.x));
        let scene = Scene { module, view, cursor };

        for (group, areas) in groups.iter().zip(&layout.plots) {
            number_plot::show(ui, areas, group, settings, &scene);
        }
        let palette = theme::palette(ui);
        strips_grid(ui, &layout, &view, palette);
        for (switch, places) in switches.iter().zip(&layout.strips) {
            strips::show(ui, *places, switch, settings, &scene);
        }
        time_axis::show(ui.painter(), layout.axis, &view, palette);
        self.selection(ui, &response, layout.timed, palette);
        if let Some(seconds) = cursor {
            cursor_line(ui, &layout, &view, seconds, palette);
        }
        widgets::tell(&response, eframe::egui::Role::Canvas, "Plot", &last_values(series));
    }

    fn tools(&mut self, ui: &mut Ui, settings: &mut Settings, latest: f64) {
        ui.horizontal(|ui| {
            widgets::quiet(ui, "Last").on_hover_text(SPAN);
            ui.scope(|ui| {
                ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
                for (span, name) in CHOICES {
                    if widgets::chip(ui, settings.span == span, name, &format!("Last {name}"), SPAN) {
                        settings.span = span;
                    }
                }
            });
            let (name, help) = match self.end {
                None => ("Hold plot", "The plot stands still; polling goes on"),
                Some(_) => ("Follow", "Back to the present (or double-click the plot)"),
            };
            let button = eframe::egui::Button::new(name).min_size(vec2(theme::BUTTON_WIDTH, theme::CONTROL_HEIGHT));
            let response = ui.add(button).on_hover_text(help);
            if response.clicked() {
                self.end = if self.end.is_none() { Some(latest) } else { None };
            }
            let strips = ui.checkbox(&mut settings.strips, "Switches");
            strips.on_hover_text("Motion, outputs and alarms as strips below the plot");
            let end = self.end.unwrap_or(latest);
            widgets::at_right(ui, |ui| {
                let (from, to) = (words::time_of_day(end - settings.span, 0), words::time_of_day(end, 0));
                widgets::fixed_coloured(
                    ui,
                    theme::LEGEND_WIDTH,
                    Align::Max,
                    &format!("{from} – {to}"),
                    theme::palette(ui).quiet,
                );
            });
        });
    }

    /// Dragging moves, scrolling zooms, dragging with the right button selects a span; a double click follows again.
    fn navigate(&mut self, ui: &Ui, response: &Response, view: &mut TimeView, settings: &mut Settings) {
        if response.dragged_by(PointerButton::Primary) {
            let moved = f64::from(response.drag_delta().x) * view.seconds_per_point();
            self.end = Some(view.to - moved);
        }
        if let Some(pointer) = response.hover_pos() {
            let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = (-f64::from(scroll) * ZOOM_PER_POINT).exp() / f64::from(pinch);
            if factor != 1.0 {
                self.zoom(view, view.seconds(pointer.x), factor, settings);
                // The scroll area around the plot shall not move as well.
                ui.input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
            }
        }
        self.select(response, view, settings);
        if response.double_clicked() {
            self.end = None;
        }
    }

    /// Neither before the first reading nor into the future. A plot that is held stays where it is, even if its
    /// readings do not fill it.
    fn stay_within(&mut self, view: &mut TimeView, span: f64, first: Option<f64>, latest: f64) {
        let earliest = first.map_or(view.to, |first| (first + span).min(view.to));
        self.end = self.end.map(|end| end.max(earliest).min(latest.max(earliest)));
        view.to = self.end.unwrap_or(latest);
        view.from = view.to - span;
    }

    /// While the present is followed it stays at the right edge, else the place under the pointer stays.
    fn zoom(&mut self, view: &TimeView, fixed: f64, factor: f64, settings: &mut Settings) {
        let span = (view.span() * factor).clamp(*SPANS.start(), *SPANS.end());
        if self.end.is_some() {
            let part = (view.to - fixed) / view.span();
            self.end = Some(fixed + part * span);
        }
        settings.span = span;
    }

    fn select(&mut self, response: &Response, view: &TimeView, settings: &mut Settings) {
        let pointer = response.interact_pointer_pos().map(|pointer| view.columns.clamp(pointer.x));
        if response.drag_started_by(PointerButton::Secondary) {
            self.selecting = pointer;
        }
        if response.drag_stopped_by(PointerButton::Secondary)
            && let (Some(start), Some(end)) = (self.selecting.take(), pointer)
            && (start - end).abs() >= LEAST_SELECTION
        {
            let (from, to) = (view.seconds(start.min(end)), view.seconds(start.max(end)));
            settings.span = (to - from).clamp(*SPANS.start(), *SPANS.end());
            self.end = Some(to);
        }
    }

    fn selection(&self, ui: &Ui, response: &Response, rect: Rect, palette: &Palette) {
        if let (Some(start), Some(pointer)) = (self.selecting, response.interact_pointer_pos()) {
            let end = rect.x_range().clamp(pointer.x);
            let chosen = Rect::from_x_y_ranges(start.min(end)..=start.max(end), rect.y_range());
            let stroke = Stroke::new(theme::HAIRLINE, palette.accent);
            ui.painter().rect(
                chosen,
                0.0,
                palette.accent.gamma_multiply(theme::SELECTION_FILL),
                stroke,
                eframe::egui::StrokeKind::Inside,
            );
        }
    }
}

/// The present, or the newest sample where a simulated line is ahead of it.
fn latest(series: &[Series<'_>], now: Timestamp) -> f64 {
    let newest = series.iter().filter_map(|one| one.trend?.last()).map(|sample| sample[0]);
    newest.fold(words::seconds(now), f64::max)
}

/// The oldest sample that is kept.
fn first(series: &[Series<'_>]) -> Option<f64> {
    series.iter().filter_map(|one| one.trend?.first()).reduce(f64::min)
}

/// Numbers by unit, in order of first appearance.
fn groups<'a, 'b>(series: &'b [Series<'a>]) -> Vec<Vec<&'b Series<'a>>> {
    let mut groups: Vec<Vec<&Series<'_>>> = Vec::new();
    for one in series.iter().filter(|one| one.is_number()) {
        match groups.iter_mut().find(|group| group.first().is_some_and(|first| first.unit == one.unit)) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    groups
}

fn layout(ui: &mut Ui, groups: &[Vec<&Series<'_>>], switches: usize, height: f32) -> Layout {
    let count = groups.len().max(1) as f32;
    let gaps = groups.len() as f32 * theme::GAP;
    let left = height - theme::TIME_AXIS - gaps - count * theme::PLOT_LEAST;
    let strip = (left / switches.max(1) as f32).clamp(theme::STRIP_LEAST, theme::STRIP).floor();
    let strips_height = switches as f32 * strip;
    let share = ((height - strips_height - theme::TIME_AXIS - gaps) / count).max(theme::PLOT_LEAST);
    let plots_height = if groups.is_empty() { 0.0 } else { share * count + gaps };
    let size = vec2(ui.available_width(), plots_height + strips_height + theme::TIME_AXIS);
    let (all, _) = ui.allocate_exact_size(size, Sense::hover());

    let names = Rangef::new(all.left(), all.left() + theme::LEGEND_WIDTH);
    let labels = Rangef::new(names.max, names.max + theme::Y_LABELS);
    let timed = Rangef::new(labels.max, all.right());
    let mut top = all.top();
    let mut row = |height: f32| {
        let rows = Rangef::new(top, top + height);
        top += height;
        [names, labels, timed].map(|columns| Rect::from_x_y_ranges(columns, rows))
    };
    let mut plots = Vec::new();
    for _ in groups {
        let [legend, labels, plot] = row(share);
        plots.push(Areas { legend, labels, plot });
        row(theme::GAP);
    }
    let strips = (0..switches).map(|_| row(strip)).map(|[name, _, trace]| (name, trace)).collect();
    let [_, _, axis] = row(theme::TIME_AXIS);
    Layout { plots, strips, axis, timed: Rect::from_x_y_ranges(timed, all.y_range()) }
}

/// The plots' vertical lines go on through the strips.
fn strips_grid(ui: &Ui, layout: &Layout, view: &TimeView, palette: &Palette) {
    let (Some((_, first)), Some((_, last))) = (layout.strips.first(), layout.strips.last()) else { return };
    let (ticks, _) = time_axis::ticks(view);
    for tick in ticks {
        let rows = Rangef::new(first.top(), last.bottom());
        ui.painter().vline(view.x(tick), rows, Stroke::new(theme::HAIRLINE, palette.grid));
    }
}

/// A line at the pointer's time, with the time at its foot.
fn cursor_line(ui: &Ui, layout: &Layout, view: &TimeView, seconds: f64, palette: &Palette) {
    let x = view.x(seconds);
    let rows = Rangef::new(layout.timed.top(), layout.axis.top());
    ui.painter().vline(x, rows, Stroke::new(theme::HAIRLINE, palette.quiet));
    let galley = widgets::cut(ui, &words::time_of_day(seconds, 1), theme::small(), palette.text, f32::INFINITY);
    let place = Align2::CENTER_BOTTOM.align_size_within_rect(
        galley.size(),
        Rect::from_center_size(pos2(x, layout.axis.center().y), vec2(galley.size().x, layout.axis.height())),
    );
    let left = place.left().clamp(layout.timed.left(), (layout.timed.right() - place.width()).max(layout.timed.left()));
    let place = Rect::from_min_size(pos2(left, place.top()), place.size());
    ui.painter().rect_filled(place.expand2(vec2(theme::UNIT, 0.0)), theme::UNIT, palette.raised);
    ui.painter().galley(place.min, galley, palette.text);
}

/// `Temperature 24.99 °C, Motion quiet`: what a plot shows at its end.
fn last_values(series: &[Series<'_>]) -> String {
    let value = |series: &Series<'_>| {
        let value = series.reading?.value.as_ref()?;
        Some(format!("{} {} {}", series.label, series.word(value), series.unit).trim_end().to_owned())
    };
    series.iter().filter_map(value).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(end: f64, span: f64) -> TimeView {
        TimeView { from: end - span, to: end, columns: Rangef::new(0.0, 600.0) }
    }

    #[test]
    fn zooming_keeps_the_place_under_the_pointer() {
        let mut plot = LivePlot { end: Some(1_000.0), selecting: None };
        let mut settings = Settings { span: 100.0, ..Settings::default() };
        plot.zoom(&view(1_000.0, 100.0), 925.0, 0.5, &mut settings);
        assert_eq!((settings.span, plot.end), (50.0, Some(962.5)));
    }

    #[test]
    fn a_plot_is_not_dragged_beyond_its_readings() {
        let dragged = |end: f64, first: f64, from: f64| {
            let mut plot = LivePlot { end: Some(end), selecting: None };
            let mut view = view(from, 100.0);
            plot.stay_within(&mut view, 100.0, Some(first), 1_000.0);
            assert_eq!(Some(view.to), plot.end);
            view.to
        };
        assert_eq!(dragged(-5_000.0, 600.0, 1_000.0), 700.0, "the first reading stands at the left edge");
        assert_eq!(dragged(5_000.0, 600.0, 900.0), 1_000.0, "there is no future");
        assert_eq!(dragged(800.0, 600.0, 900.0), 800.0);
        assert_eq!(dragged(990.0, 960.0, 990.0), 990.0, "held with few readings it stays");
        assert_eq!(dragged(900.0, 960.0, 990.0), 990.0);
    }

    #[test]
    fn zooming_while_following_goes_on_following() {
        let mut plot = LivePlot::default();
        let mut settings = Settings { span: 100.0, ..Settings::default() };
        plot.zoom(&view(1_000.0, 100.0), 925.0, 1e-9, &mut settings);
        assert_eq!((settings.span, plot.end), (2.0, None));
    }
}
