//! The axis of the plots of a module, in local time.

use eframe::egui::{Align2, Painter, Rangef, Rect, Stroke, pos2};

pub use crate::ui::plot::TimeView;
use crate::ui::plot::Zone;
use crate::ui::theme::{self, Palette};
use crate::ui::words;

/// The finest step between two ticks, in seconds.
const FINEST: f64 = 1.0;

/// Times of the ticks and the step between them.
pub fn ticks(view: &TimeView) -> (Vec<f64>, f64) {
    view.ticks(Zone::Local, FINEST)
}

/// Draws the axis: short ticks and local times.
pub fn show(painter: &Painter, rect: Rect, view: &TimeView, palette: &Palette) {
    let (ticks, step) = ticks(view);
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
