//! Who was seen in the last hour: a strip for each zone, how often and for how long.

use eframe::egui::{Align, Rangef, Rect, Role, Sense, Stroke, Ui, vec2};
use jiff::Timestamp;
use std::time::Duration;

use super::face::zone_of;
use crate::bench::Module;
use crate::record::{Statistics, Trend};
use crate::ui::module_view::form;
use crate::ui::module_view::series::Series;
use crate::ui::module_view::strips;
use crate::ui::module_view::time_axis::{self, TimeView};
use crate::ui::theme::{self, Palette};
use crate::ui::{widgets, words};

/// In seconds.
const SPAN: f64 = 3_600.0;

/// How often there was motion, and for how many seconds in all.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Seen {
    times: u64,
    seconds: f64,
}

/// Nothing if no sensor tells of motion.
pub fn show(ui: &mut Ui, module: &Module, series: &[Series<'_>], now: Timestamp) {
    let zones: Vec<&Series<'_>> = series.iter().filter(|series| zone_of(&series.item.id).is_some()).collect();
    let whole = || series.iter().filter(|series| series.item.id == "pir").collect();
    let rows = if zones.is_empty() { whole() } else { zones };
    if rows.is_empty() {
        return;
    }
    let newest = rows.iter().filter_map(|series| series.trend?.last()).map(|sample| sample[0]);
    // A simulated line may be ahead of the clock.
    let to = newest.fold(words::seconds(now), f64::max);
    heading(ui, module, to - oldest(&rows, to));

    let palette = theme::palette(ui);
    let height = rows.len() as f32 * theme::STRIP + theme::TIME_AXIS;
    let (all, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let columns = Rangef::new(all.left() + theme::HISTORY_NAME, all.right() - theme::HISTORY_WORDS);
    let view = TimeView { from: to - SPAN, to, columns };
    grid(ui, all, &view, palette);
    for (index, series) in rows.iter().enumerate() {
        let top = all.top() + index as f32 * theme::STRIP;
        row(ui, all.with_min_y(top).with_max_y(top + theme::STRIP), series, &view, palette);
    }
    let axis = all.with_min_y(all.bottom() - theme::TIME_AXIS);
    time_axis::show(ui.painter(), Rect::from_x_y_ranges(columns, axis.y_range()), &view, palette);
}

/// How far back is known is a part of what the numbers mean.
fn heading(ui: &mut Ui, module: &Module, known: f64) {
    let known = Duration::try_from_secs_f64(known).unwrap_or_default();
    let text = match (known.as_secs_f64() < SPAN, module.interval) {
        (true, None) => "Motion in the last hour (polling is paused)".to_owned(),
        (true, Some(_)) => format!("Motion in the last hour (observed for {})", words::age(known)),
        (false, _) => "Motion in the last hour".to_owned(),
    };
    form::heading(ui, &text);
}

/// The first sample that counts.
fn oldest(rows: &[&Series<'_>], to: f64) -> f64 {
    let firsts = rows.iter().filter_map(|series| first(series.trend?, to - SPAN, to));
    firsts.fold(to, f64::min)
}

fn first(trend: &Trend, from: f64, to: f64) -> Option<f64> {
    trend.lines(from, to, 1).first()?.first().map(|sample| sample[0].max(from))
}

fn row(ui: &Ui, rect: Rect, series: &Series<'_>, view: &TimeView, palette: &Palette) {
    let words = match series.trend.map(|trend| seen(trend, view.from, view.to)) {
        Some(None) => words::UNKNOWN.to_owned(),
        seen => seen.flatten().unwrap_or_default().words(),
    };
    let [name, text] = [rect.with_max_x(view.columns.min - theme::GAP), rect.with_min_x(view.columns.max + theme::GAP)];
    widgets::line_in(ui, name, Align::Min, series.label, theme::small(), palette.quiet);
    strips::draw(ui.painter(), Rect::from_x_y_ranges(view.columns, rect.y_range()), series, view, palette);
    widgets::line_in(ui, text, Align::Min, &words, theme::small(), palette.text);
    let response = ui.interact(rect, ui.scope_id().with(("history", series.stem)), Sense::hover());
    widgets::describe(&response, Role::Label, &format!("{} in the last hour: {words}", series.label));
    response.on_hover_text(&series.item.help);
}

fn grid(ui: &Ui, all: Rect, view: &TimeView, palette: &Palette) {
    for tick in time_axis::ticks(view).0 {
        let rows = Rangef::new(all.top(), all.bottom() - theme::TIME_AXIS);
        ui.painter().vline(view.x(tick), rows, Stroke::new(theme::HAIRLINE, palette.grid));
    }
}

/// Nothing while some of the samples are on the disk only.
fn seen(trend: &Trend, from: f64, to: f64) -> Option<Seen> {
    let found = trend.statistics(from, to).or_else(|| (!trend.is_wanting()).then(Statistics::default))?;
    Some(Seen { times: found.times.saturating_add(u64::from(found.on_at_start)), seconds: found.on })
}

impl Seen {
    fn words(self) -> String {
        let span = words::span(Duration::try_from_secs_f64(self.seconds).unwrap_or_default());
        match self.times {
            0 => "no motion".to_owned(),
            1 => format!("motion once, {span}"),
            times => format!("motion {times} times, {span} in all"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visits_are_counted_and_their_time_is_added_up() {
        let mut trend = Trend::default();
        for (at, value) in [(0, 0), (10, 1), (15, 1), (30, 0), (50, 1), (90, 0)] {
            trend.push(at * 1_000_000, value);
        }
        assert_eq!(seen(&trend, 0.0, 100.0).unwrap().words(), "motion 2 times, 1 min 0 s in all");
        assert_eq!(seen(&Trend::default(), 0.0, 100.0).unwrap().words(), "no motion");
    }
}
