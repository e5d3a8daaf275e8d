//! How long answers took, and how many failed when.

use eframe::egui::{Align2, Rect, Role, Sense, Stroke, Ui, pos2, vec2};

use super::details::highest;
use crate::diagnosis::{Bar, SLOT_SECONDS, Slot, Times};
use crate::ui::{theme, widgets};

/// Seconds that the errors are shown over.
const SPAN: i64 = 3_600;
/// Slots drawn as one bar.
const JOINED: i64 = 6;

/// Bars of answers by time, with the median and the 99th percentile marked.
pub fn histogram(ui: &mut Ui, bars: &[Bar], times: Option<&Times>) {
    let told = match times {
        Some(times) => format!("{} answers, median {:.1} ms", times.count, times.median_ms),
        None => "no answers yet".to_owned(),
    };
    let (plot, axis) = area(ui, &format!("Answer times: {told}"));
    let (Some(first), Some(last), Some(times)) = (bars.first(), bars.last(), times) else {
        return empty(ui, plot, "No answers yet");
    };
    let palette = theme::palette(ui);
    let most = highest(bars).max(1) as f32;
    let width = (plot.width() / bars.len().max(1) as f32).min(theme::BAR_MOST);
    let x = |index: usize| plot.left() + index as f32 * width;
    for (index, bar) in bars.iter().enumerate() {
        let height = (plot.height() - theme::LEGEND_ROW) * bar.count as f32 / most;
        // What is there at all can be seen.
        let height = if bar.count > 0 { height.max(theme::OUTLINE) } else { 0.0 };
        let [left, right] = [x(index) + theme::HAIRLINE, x(index.saturating_add(1)) - theme::HAIRLINE];
        let rect = Rect::from_min_max(pos2(left, plot.bottom() - height), pos2(right, plot.bottom()));
        ui.painter().rect_filled(rect, 0.0, palette.accent);
    }
    // Bars are as wide as each other, and the time in them grows evenly enough.
    let place = |ms: f64| {
        let index = bars.iter().position(|bar| ms <= bar.to_ms).unwrap_or(bars.len().saturating_sub(1));
        let inside =
            bars.get(index).map_or(0.0, |bar| (ms - bar.from_ms) / (bar.to_ms - bar.from_ms).max(f64::EPSILON));
        x(index) + width * inside.clamp(0.0, 1.0) as f32
    };
    let right = x(bars.len());
    mark(ui, plot, place(times.median_ms), "median", Align2::LEFT_TOP);
    if place(times.p99_ms) > place(times.median_ms) + theme::MARK_DISTANCE {
        mark(ui, plot, place(times.p99_ms), "99 %", Align2::LEFT_TOP);
    }
    let label = |x: f32, anchor: Align2, ms: f64| {
        ui.painter().text(pos2(x, axis.top()), anchor, format!("{} ms", short(ms)), theme::small(), palette.quiet);
    };
    label(plot.left(), Align2::LEFT_TOP, first.from_ms);
    label(right.max(plot.left() + theme::MARK_DISTANCE * 2.0), Align2::RIGHT_TOP, last.to_ms);
}

/// The part of failed exchanges over the last hour, in minutes; where nothing was asked there is a gap.
pub fn rates(ui: &mut Ui, slots: &[Slot]) {
    let (asked, failed) = slots.iter().fold((0u64, 0u64), |(asked, failed), slot| {
        (asked.saturating_add(slot.exchanges.into()), failed.saturating_add(slot.failed.into()))
    });
    let (plot, axis) = area(ui, &format!("Failed exchanges: {failed} of {asked} in the last hour"));
    let Some(newest) = slots.last() else { return empty(ui, plot, "Nothing asked yet") };
    let palette = theme::palette(ui);
    let minute = SLOT_SECONDS.saturating_mul(JOINED);
    let minutes = slots.chunk_by(|one, other| one.second.div_euclid(minute) == other.second.div_euclid(minute));
    let bars: Vec<(i64, f64)> = minutes
        .filter_map(|group| {
            let (asked, failed) = group.iter().fold((0.0, 0.0), |(asked, failed), slot| {
                (asked + f64::from(slot.exchanges), failed + f64::from(slot.failed))
            });
            Some((group.first()?.second.div_euclid(minute), failed / f64::max(asked, 1.0)))
        })
        .collect();
    let top = scale(bars.iter().map(|(_, share)| *share).fold(0.0, f64::max));
    let count = SPAN.div_euclid(minute);
    let width = plot.width() / count as f32;
    let end = newest.second.div_euclid(minute);
    let room = plot.height() - theme::LEGEND_ROW;
    for (at, share) in bars {
        let place = count.saturating_sub(end.saturating_sub(at)).saturating_sub(1);
        if place < 0 {
            continue;
        }
        let left = plot.left() + place as f32 * width;
        // A thin line says that something was asked, and nothing failed.
        let height = (room * (share / top) as f32).max(theme::HAIRLINE);
        let colour = if share > 0.0 { palette.error } else { palette.ok };
        let low = pos2(left, plot.bottom() - height);
        ui.painter().rect_filled(
            Rect::from_min_max(low, pos2(left + (width - 1.0).max(1.0), plot.bottom())),
            0.0,
            colour,
        );
    }
    let grid = Stroke::new(theme::HAIRLINE, palette.grid);
    ui.painter().hline(plot.x_range(), plot.bottom() - room, grid);
    let text = |at, anchor, text: &str| {
        ui.painter().text(at, anchor, text, theme::small(), palette.quiet);
    };
    text(plot.left_top(), Align2::LEFT_TOP, &format!("{} %", short(top * 100.0)));
    text(axis.left_top(), Align2::LEFT_TOP, "1 hour ago");
    text(axis.right_top(), Align2::RIGHT_TOP, "last asked");
}

/// The top of the scale: a round share that holds the highest.
fn scale(highest: f64) -> f64 {
    [0.01, 0.02, 0.05, 0.1, 0.2, 0.5].into_iter().find(|top| highest <= *top).unwrap_or(1.0)
}

/// Few digits, as many as tell it from its neighbours.
fn short(value: f64) -> String {
    if value >= 10.0 || value.fract() == 0.0 { format!("{value:.0}") } else { format!("{value:.1}") }
}

/// Room for bars with their ground line, and for what is written below.
fn area(ui: &mut Ui, told: &str) -> (Rect, Rect) {
    let size = vec2(ui.available_width(), theme::CHART_HEIGHT + theme::TIME_AXIS);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    widgets::describe(&response, Role::Image, told);
    response.on_hover_text(told);
    let (plot, axis) = rect.split_top_bottom_at_y(rect.top() + theme::CHART_HEIGHT);
    let palette = theme::palette(ui);
    ui.painter().hline(plot.x_range(), plot.bottom(), Stroke::new(theme::HAIRLINE, palette.line));
    (plot, axis.translate(vec2(0.0, theme::UNIT / 2.0)))
}

fn empty(ui: &Ui, plot: Rect, text: &str) {
    ui.painter().text(plot.center(), Align2::CENTER_CENTER, text, theme::body(), theme::palette(ui).old);
}

fn mark(ui: &Ui, plot: Rect, x: f32, text: &str, anchor: Align2) {
    let palette = theme::palette(ui);
    ui.painter().vline(x, plot.y_range(), Stroke::new(theme::HAIRLINE, palette.text));
    ui.painter().text(pos2(x + theme::UNIT, plot.top()), anchor, text, theme::small(), palette.quiet);
}
