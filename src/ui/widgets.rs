//! Small things that several parts of the window draw. What a painted thing shows is also told to assistive
//! technology, through the same response that the tests look for.

use std::ops::RangeInclusive;
use std::sync::Arc;

use eframe::egui::{
    self, Align, Align2, Color32, FontId, Galley, Layout, Painter, Pos2, Rect, Response, RichText, Role, Sense, Shape,
    Stroke, Ui, Vec2, WidgetInfo, pos2, text::LayoutJob, vec2,
};

use super::theme::{self, Palette};
use crate::bench::SwitchKind;

/// A mark that says a state by its form; the colour only repeats it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Glyph {
    /// Present, active.
    Disc,
    /// Present, idle.
    Ring,
    /// Not known.
    Dashes,
    /// Closed contact.
    Square,
    /// Open contact.
    Frame,
    /// Alarm, warning.
    Triangle,
    /// No alarm.
    Outline,
    /// Lost, failed.
    Cross,
    /// Done.
    Tick,
    /// Changed, not written.
    Edited,
    /// Out of the window.
    Detach,
    /// To a module.
    Sent,
    /// From a module.
    Received,
}

impl Glyph {
    /// The form of a switch by what it stands for.
    pub fn of_switch(kind: SwitchKind, on: bool) -> Self {
        match (kind, on) {
            (SwitchKind::Alarm | SwitchKind::Watchdog, true) => Self::Triangle,
            (SwitchKind::Alarm | SwitchKind::Watchdog, false) => Self::Outline,
            (SwitchKind::Output, true) => Self::Square,
            (SwitchKind::Output, false) => Self::Frame,
            (SwitchKind::Motion | SwitchKind::Sound, true) => Self::Disc,
            (SwitchKind::Motion | SwitchKind::Sound, false) => Self::Ring,
        }
    }
}

/// Paints `glyph` into the square around `centre`.
pub fn paint_glyph(painter: &Painter, glyph: Glyph, centre: Pos2, size: f32, colour: Color32) {
    let radius = size / 2.0 - theme::OUTLINE / 2.0;
    let stroke = Stroke::new(theme::OUTLINE, colour);
    let square = Rect::from_center_size(centre, Vec2::splat(radius * 1.8));
    let corners = vec![
        pos2(centre.x, centre.y - radius),
        pos2(centre.x + radius, centre.y + radius * 0.8),
        pos2(centre.x - radius, centre.y + radius * 0.8),
    ];
    match glyph {
        Glyph::Disc => drop(painter.circle_filled(centre, radius, colour)),
        Glyph::Ring => drop(painter.circle_stroke(centre, radius, stroke)),
        Glyph::Dashes => {
            let half = vec2(radius, 0.0);
            painter.extend(Shape::dashed_line(&[centre - half, centre + half], stroke, radius * 0.8, radius * 0.4));
        }
        Glyph::Square => drop(painter.rect_filled(square, 1.0, colour)),
        Glyph::Frame => drop(painter.rect_stroke(square, 1.0, stroke, egui::StrokeKind::Inside)),
        Glyph::Triangle => drop(painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE))),
        Glyph::Outline => drop(painter.add(Shape::closed_line(corners, stroke))),
        Glyph::Tick => {
            let corner = centre + vec2(-radius * 0.2, radius * 0.7);
            painter.line_segment([centre + vec2(-radius * 0.9, 0.0), corner], stroke);
            painter.line_segment([corner, centre + vec2(radius * 0.9, -radius * 0.7)], stroke);
        }
        Glyph::Edited => {
            let tip = centre + vec2(-radius, radius) * 0.9;
            let end = centre + vec2(radius, -radius) * 0.8;
            painter.line_segment([tip, end], Stroke::new(theme::OUTLINE * 1.6, colour));
            painter.line_segment([tip, tip + vec2(radius * 0.9, 0.0)], stroke);
        }
        Glyph::Detach => {
            let lower = Rect::from_min_max(square.min + vec2(0.0, radius * 0.7), square.max - vec2(radius * 0.7, 0.0));
            painter.rect_stroke(lower, 1.0, stroke, egui::StrokeKind::Inside);
            let corner = square.right_top();
            painter.line_segment([square.center(), corner], stroke);
            painter.line_segment([corner, corner + vec2(-radius * 0.8, 0.0)], stroke);
            painter.line_segment([corner, corner + vec2(0.0, radius * 0.8)], stroke);
        }
        Glyph::Sent | Glyph::Received => {
            let ahead = if glyph == Glyph::Sent { radius } else { -radius };
            let (tip, tail) = (centre + vec2(ahead, 0.0), centre - vec2(ahead, 0.0));
            painter.line_segment([tail, tip], stroke);
            for side in [-0.6, 0.6] {
                painter.line_segment([tip, tip + vec2(-ahead * 0.7, radius * side)], stroke);
            }
        }
        Glyph::Cross => {
            let half = vec2(radius, radius) * 0.8;
            painter.line_segment([centre - half, centre + half], stroke);
            painter.line_segment([centre - vec2(half.x, -half.y), centre + vec2(half.x, -half.y)], stroke);
        }
    }
}

/// A glyph in a row of text.
pub fn glyph(ui: &mut Ui, glyph: Glyph, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(theme::GLYPH, theme::CONTROL_HEIGHT), Sense::hover());
    paint_glyph(ui.painter(), glyph, rect.center(), theme::GLYPH, colour);
    response
}

/// A button that is a mark; `name` is for those who cannot see it.
pub fn glyph_button(ui: &mut Ui, glyph: Glyph, name: &str, enabled: bool) -> Response {
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(theme::CONTROL_HEIGHT), sense);
    let visuals = *ui.style().interact(&response);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    }
    let palette = theme::palette(ui);
    let colour = if enabled { palette.text } else { palette.old };
    paint_glyph(ui.painter(), glyph, rect.center(), theme::GLYPH, colour);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    response
}

/// Text that fits into `width`, cut with an ellipsis where it does not.
pub fn cut(ui: &Ui, text: &str, font: FontId, colour: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, colour);
    job.wrap = egui::text::TextWrapping::truncate_at_width(width.max(0.0));
    ui.fonts_mut(|fonts| fonts.layout_job(job))
}

/// Paints one line of text into `rect`, centred vertically, at its left or right end.
pub fn line_in(ui: &Ui, rect: Rect, align: Align, text: &str, font: FontId, colour: Color32) -> Rect {
    let galley = cut(ui, text, font, colour, rect.width());
    let anchor = match align {
        Align::Max => Align2::RIGHT_CENTER,
        Align::Center => Align2::CENTER_CENTER,
        Align::Min => Align2::LEFT_CENTER,
    };
    let place = anchor.align_size_within_rect(galley.size(), rect);
    ui.painter().galley(place.min, galley, colour);
    place
}

/// Tells what a painted thing shows.
pub fn describe(response: &Response, role: Role, text: &str) {
    response.widget_info(|| WidgetInfo::labeled(role, true, text));
}

/// Tells what a painted thing is called, and what it shows.
pub fn tell(response: &Response, role: Role, name: &str, value: &str) {
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(value.to_owned()),
        ..WidgetInfo::labeled(role, response.enabled(), name)
    });
}

/// A box that shows the choice and opens the list of choices.
pub fn combo<'a>(id: &str, width: f32, chosen: &str) -> egui::ComboBox<'a> {
    egui::ComboBox::from_id_salt(id)
        .width(width)
        .truncate()
        .icon(|ui, rect, visuals, _| paint_caret(ui.painter(), rect.center(), false, visuals.text_color()))
        .selected_text(chosen.to_owned())
}

/// Gives a combo box its name; egui tells its value only.
pub fn name_combo(response: &Response, name: &str, value: &str) {
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(value.to_owned()),
        ..WidgetInfo::labeled(Role::ComboBox, response.enabled(), name)
    });
}

/// Gives a text field its name.
pub fn name_field(response: &Response, name: &str, value: &str) {
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(value.to_owned()),
        ..WidgetInfo::labeled(Role::TextInput, response.enabled(), name)
    });
}

/// Text in the quieter tone.
pub fn quiet(ui: &mut Ui, text: &str) -> Response {
    let colour = theme::palette(ui).quiet;
    ui.label(RichText::new(text).color(colour))
}

pub fn quiet_small(ui: &mut Ui, text: &str) -> Response {
    let colour = theme::palette(ui).quiet;
    ui.label(RichText::new(text).small().color(colour))
}

/// A heading inside a menu or form.
pub fn section(ui: &mut Ui, text: &str) {
    ui.add_space(theme::UNIT);
    quiet_small(ui, text);
}

/// Text at the left or right end of a room of fixed width, so that what follows does not move.
pub fn fixed(ui: &mut Ui, width: f32, align: Align, text: &str) -> Response {
    let colour = ui.visuals().text_color();
    fixed_coloured(ui, width, align, text, colour)
}

pub fn fixed_coloured(ui: &mut Ui, width: f32, align: Align, text: &str, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(width, theme::CONTROL_HEIGHT), Sense::hover());
    line_in(ui, rect, align, text, theme::body(), colour);
    describe(&response, Role::Label, text);
    response
}

/// What stands to the right of everything else in a row, or in a row of its own.
pub fn at_right(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let layout = Layout::right_to_left(Align::Center);
    if ui.layout().is_horizontal() {
        ui.with_layout(layout, contents);
    } else {
        ui.allocate_ui_with_layout(vec2(ui.available_width(), theme::CONTROL_HEIGHT), layout, contents);
    }
}

/// A button with a small triangle that opens a menu.
pub fn menu(ui: &mut Ui, text: &str, name: &str, contents: impl FnOnce(&mut Ui)) -> Response {
    let font = theme::body();
    let colour = ui.visuals().text_color();
    let galley = (!text.is_empty()).then(|| cut(ui, text, font, colour, f32::INFINITY));
    let text_width = galley.as_ref().map_or(0.0, |galley| galley.size().x + theme::UNIT);
    let size = vec2(2.0 * theme::GAP + text_width + theme::CARET, theme::CONTROL_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let visuals = *ui.style().interact(&response);
    ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    if let Some(galley) = galley {
        let left = rect.left_center() + vec2(theme::GAP, -galley.size().y / 2.0);
        ui.painter().galley(left, galley, visuals.text_color());
    }
    let caret = rect.right_center() - vec2(theme::GAP + theme::CARET / 2.0, 0.0);
    paint_caret(ui.painter(), caret, false, visuals.text_color());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, response.enabled(), name));
    egui::Popup::menu(&response).close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside).show(contents);
    response
}

/// A small triangle that points up or down.
pub fn paint_caret(painter: &Painter, centre: Pos2, up: bool, colour: Color32) {
    let half = theme::CARET / 2.0;
    let tip = if up { -half / 2.0 } else { half / 2.0 };
    let corners = vec![centre + vec2(-half, -tip), centre + vec2(half, -tip), centre + vec2(0.0, tip)];
    painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
}

/// A line of a menu: what it does, and below it what that means.
pub fn menu_entry(ui: &mut Ui, enabled: bool, title: &str, explanation: &str) -> Response {
    let palette = theme::palette(ui);
    let size = vec2(ui.available_width(), theme::CONTROL_HEIGHT + theme::LEGEND_ROW);
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    if enabled && (response.hovered() || response.has_focus()) {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised_hovered);
    }
    let inside = rect.shrink2(vec2(theme::GAP, theme::UNIT));
    let (upper, lower) = inside.split_top_bottom_at_fraction(0.5);
    let colour = if enabled { palette.text } else { palette.quiet };
    line_in(ui, upper, Align::Min, title, theme::body(), colour);
    line_in(ui, lower, Align::Min, explanation, theme::small(), palette.quiet);
    response.widget_info(|| WidgetInfo::labeled(Role::MenuItem, enabled, title));
    response
}

/// A choice of several that stand side by side, and what it means; true if it was switched.
pub fn chip(ui: &mut Ui, on: bool, text: &str, name: &str, means: &str) -> bool {
    let response = ui.add(egui::Button::selectable(on, text).frame_when_inactive(true));
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, response.enabled(), on, name));
    response.on_hover_text(means).clicked()
}

/// A bar that shows how far something is.
pub fn progress(ui: &mut Ui, part: f32, name: &str) -> Response {
    let palette = theme::palette(ui);
    let (room, response) = ui.allocate_exact_size(vec2(theme::PROGRESS_WIDTH, theme::CONTROL_HEIGHT), Sense::hover());
    let rect = Rect::from_center_size(room.center(), vec2(room.width(), theme::PROGRESS_HEIGHT));
    let rounding = theme::PROGRESS_HEIGHT / 2.0;
    ui.painter().rect_filled(rect, rounding, palette.raised);
    let filled = rect.with_max_x(rect.left() + rect.width() * part.clamp(0.0, 1.0));
    ui.painter().rect_filled(filled, rounding, palette.accent);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ProgressIndicator, true, name);
        info.value = Some(f64::from(part));
        info
    });
    response
}

/// The multiples of a round step in `range`, about `most` of them at the most, and the step.
pub fn round_steps(range: &RangeInclusive<f64>, most: f64) -> (Vec<f64>, f64) {
    let span = range.end() - range.start();
    if span <= 0.0 || !span.is_finite() || most < 1.0 {
        return (Vec::new(), 1.0);
    }
    let rough = span / most;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= rough * 0.999);
    let step = step.unwrap_or(rough);
    (multiples(range, step), step)
}

/// The multiples of `step` in `range`.
pub fn multiples(range: &RangeInclusive<f64>, step: f64) -> Vec<f64> {
    let (first, last) = ((range.start() / step).ceil() as i64, (range.end() / step).floor() as i64);
    (first..=last).map(|index| index as f64 * step).collect()
}

/// Paragraphs for a place where there is nothing to show: what is missing, and what to do.
pub fn empty_state(ui: &mut Ui, palette: &Palette, title: &str, lines: &[&str]) {
    ui.label(RichText::new(title).heading().color(palette.text));
    ui.add_space(theme::UNIT);
    for line in lines {
        ui.label(RichText::new(*line).color(palette.quiet));
    }
    ui.add_space(theme::GAP);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_not_more_than_asked_for() {
        assert_eq!(round_steps(&(0.0..=10.0), 5.0), (vec![0.0, 2.0, 4.0, 6.0, 8.0, 10.0], 2.0));
        assert_eq!(round_steps(&(-1.0..=1.0), 4.0).1, 0.5);
        assert_eq!(round_steps(&(3.0..=3.0), 4.0).0, Vec::<f64>::new());
    }
}
