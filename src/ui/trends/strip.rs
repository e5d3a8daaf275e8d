//! States over time: a strip for each, filled while a switch is on, or with the words of a choice.

use eframe::egui::{Align, Color32, Rect, Stroke, Ui, pos2, vec2};

use super::curve::Curve;
use super::scene::Scene;
use crate::ui::{theme, widgets};

/// The narrowest visible stretch.
const LEAST_WIDTH: f32 = 1.0;

pub fn show(ui: &Ui, rect: Rect, curve: &Curve<'_>, colour: Color32, scene: &Scene<'_>) {
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let inside = rect.shrink2(vec2(0.0, theme::STRIP_INSET));
    let is_switch = curve.switch().is_some();
    for run in curve.runs(&scene.view) {
        let left = scene.view.x(run.from).max(rect.left() - LEAST_WIDTH);
        let right = scene.view.x(run.to).min(rect.right() + LEAST_WIDTH).max(left + LEAST_WIDTH);
        let area = Rect::from_x_y_ranges(left..=right, inside.y_range());
        if is_switch && run.is_on() {
            painter.rect_filled(area, 0.0, colour);
        } else if is_switch {
            let y = inside.bottom() - theme::HAIRLINE / 2.0;
            painter.line_segment([pos2(left, y), pos2(right, y)], Stroke::new(theme::HAIRLINE, colour));
        } else {
            word(ui, &painter, area, rect, &curve.word(run.value), colour);
        }
    }
}

/// A box with the word in it, where there is room for that.
fn word(ui: &Ui, painter: &eframe::egui::Painter, area: Rect, strip: Rect, text: &str, colour: Color32) {
    let stroke = Stroke::new(theme::HAIRLINE, colour);
    painter.rect_stroke(area, 0.0, stroke, eframe::egui::StrokeKind::Inside);
    let room = Rect::from_x_y_ranges(area.x_range(), strip.y_range()).shrink2(vec2(theme::UNIT, 0.0));
    if room.width() > theme::GLYPH {
        widgets::line_in(ui, room, Align::Min, text, theme::small(), colour);
    }
}
