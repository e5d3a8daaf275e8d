//! The shared axis of time: the times of day, beneath them the dates where days begin, and which clock it is.

use eframe::egui::{Align, Align2, Rangef, Rect, Stroke, Ui, pos2};

use crate::ui::plot::{DAY, MINUTE, TimeView, Zone};
use crate::ui::theme;
use crate::ui::widgets;

/// Words at the ticks, and dates from where they hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Words {
    pub times: Vec<(f64, String)>,
    pub dates: Vec<(f64, String)>,
    /// `UTC+01:00`.
    pub zone: String,
}

/// What stands at the axis.
pub fn words(view: &TimeView, zone: Zone) -> Words {
    let (ticks, step) = view.ticks(zone, 0.0);
    let time = |tick: f64| match step {
        ..0.01 => zone.clock(tick, 3),
        ..0.1 => zone.clock(tick, 2),
        ..1.0 => zone.clock(tick, 1),
        ..MINUTE => zone.clock(tick, 0),
        ..DAY => zone.text(tick, "%H:%M"),
        _ => zone.text(tick, if step > 300.0 * DAY { "%Y" } else { "%-d %b" }),
    };
    let times = ticks.iter().map(|tick| (*tick, time(*tick))).collect();
    let date = if step < DAY { "%a %-d %b %Y" } else { "%Y" };
    let changes = if step < DAY { view.midnights(zone) } else { Vec::new() };
    let starts = std::iter::once(view.from).chain(changes);
    let dates = starts.map(|start| (start, zone.text(start, date))).collect();
    Words { times, dates, zone: zone.name(view.to) }
}

/// Draws it into `rect`, as wide as the view's columns.
pub fn show(ui: &Ui, rect: Rect, view: &TimeView, words: &Words) {
    let palette = theme::palette(ui);
    let (upper, lower) = rect.split_top_bottom_at_fraction(0.5);
    let stroke = Stroke::new(theme::HAIRLINE, palette.quiet);
    let half = theme::TICK_DISTANCE[0] / 2.5;
    for (tick, text) in &words.times {
        let x = view.x(*tick);
        ui.painter().vline(x, Rangef::new(upper.top(), upper.top() + theme::UNIT), stroke);
        if view.columns.shrink(half / 2.0).contains(x) {
            let place = pos2(x, upper.bottom() + theme::HAIRLINE);
            ui.painter().text(place, Align2::CENTER_BOTTOM, text, theme::small(), palette.quiet);
        }
    }
    let zone = widgets::line_in(ui, lower, Align::Max, &words.zone, theme::small(), palette.quiet);
    // From the right, so that a date gives way to the one that follows it.
    let mut end = zone.left() - theme::GAP;
    for (start, text) in words.dates.iter().rev() {
        let left = view.x(*start).max(lower.left());
        let galley = widgets::cut(ui, text, theme::small(), palette.quiet, f32::INFINITY);
        if left + galley.size().x <= end {
            let top = lower.center().y - galley.size().y / 2.0;
            if *start > view.from {
                ui.painter().vline(left, lower.y_range(), Stroke::new(theme::HAIRLINE, palette.line));
            }
            ui.painter().galley(pos2(left + theme::UNIT, top), galley, palette.quiet);
        }
        end = end.min(left - theme::GAP);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utc(from: f64, span: f64) -> Words {
        let view = TimeView { from, to: from + span, columns: Rangef::new(0.0, 600.0) };
        words(&view, Zone::Utc)
    }

    /// 2 March 2026, 09:30 UTC.
    const MORNING: f64 = 1_772_443_800.0;

    #[test]
    fn times_are_as_fine_as_the_step() {
        let first = |span| utc(MORNING, span).times[1].1.clone();
        assert_eq!([first(0.1), first(1.0), first(60.0)], ["09:30:00.02", "09:30:00.2", "09:30:10"]);
        assert_eq!([first(3_600.0), first(30.0 * DAY), first(365.0 * DAY)], ["09:40", "16 Mar", "1 Jul"]);
    }

    #[test]
    fn the_date_stands_at_the_start_and_where_a_day_begins() {
        let words = utc(MORNING, DAY);
        assert_eq!(words.zone, "UTC");
        let dates: Vec<&str> = words.dates.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(dates, ["Mon 2 Mar 2026", "Tue 3 Mar 2026"]);
        assert_eq!(words.dates[1].0, (MORNING / DAY).ceil() * DAY);
    }
}
