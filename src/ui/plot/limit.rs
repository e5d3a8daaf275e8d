//! A limit in a plot: a dashed line with its name.

use eframe::egui::{Align2, Color32, Id, Rangef, Rect, Role, Sense, Shape, Stroke, Ui, pos2, vec2};

use crate::ui::{theme, widgets};

/// Where a limit lies, as its name says it where it cannot be seen.
pub fn beyond(y: f32, rect: Rect) -> &'static str {
    match rect.y_range().contains(y) {
        true => "",
        false if y < rect.top() => " is above",
        false => " is below",
    }
}

/// The line at height `y`, if that lies inside.
pub fn dashed(ui: &Ui, rect: Rect, columns: Rangef, y: f32, colour: Color32) {
    if rect.y_range().contains(y) {
        let line = [pos2(columns.min.max(rect.left()), y), pos2(columns.max.min(rect.right()), y)];
        let [dash, gap] = theme::DASH;
        let painter = ui.painter().with_clip_rect(rect);
        painter.extend(Shape::dashed_line(&line, Stroke::new(theme::OUTLINE, colour), dash, gap));
    }
}

/// Its name above the line, or below where there is no room; at the edge that it lies beyond.
pub fn name(ui: &Ui, rect: Rect, y: f32, text: &str, colour: Color32, id: Id) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(rect);
    let galley = widgets::cut(ui, text, theme::small(), colour, rect.width());
    let size = galley.size() + vec2(2.0 * theme::UNIT, 0.0);
    let top = if y - size.y >= rect.top() { y - size.y } else { y + theme::HAIRLINE };
    let top = top.clamp(rect.top(), (rect.bottom() - size.y).max(rect.top()));
    let place = Rect::from_min_size(pos2(rect.left(), top), size);
    painter.rect_filled(place, 0.0, palette.ground);
    painter.galley(Align2::CENTER_CENTER.align_size_within_rect(galley.size(), place).min, galley, colour);
    let response = ui.interact(place, id, Sense::hover());
    widgets::describe(&response, Role::Label, text);
}
