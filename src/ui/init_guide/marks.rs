//! What the guide paints: the numbers of the steps, and the arrow from an old value to the new one.

use eframe::egui::{Align, Align2, Color32, Role, Sense, Shape, Stroke, Ui, Vec2, vec2};

use crate::ui::{theme, widgets};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepMark {
    Past,
    Present,
    Ahead,
}

/// A step with its number: ticked off, filled, or an outline.
pub fn step(ui: &mut Ui, number: u8, mark: StepMark, text: &str) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(theme::GUIDE_NUMBER), Sense::hover());
    let (centre, radius) = (rect.center(), theme::GUIDE_NUMBER / 2.0 - theme::OUTLINE);
    let painter = ui.painter();
    let (colour, word) = match mark {
        StepMark::Past => (palette.quiet, "done"),
        StepMark::Present => (palette.text, "now"),
        StepMark::Ahead => (palette.quiet, "later"),
    };
    match mark {
        StepMark::Past => {
            painter.circle_stroke(centre, radius, Stroke::new(theme::OUTLINE, palette.ok));
            let tick = [vec2(-0.45, 0.05), vec2(-0.1, 0.4), vec2(0.5, -0.35)].map(|at| centre + at * radius);
            painter.add(Shape::line(tick.to_vec(), Stroke::new(theme::OUTLINE, palette.ok)));
        }
        StepMark::Present => {
            painter.circle_filled(centre, radius, palette.accent);
            painter.text(centre, Align2::CENTER_CENTER, number, theme::small(), palette.ground);
        }
        StepMark::Ahead => {
            painter.circle_stroke(centre, radius, Stroke::new(theme::HAIRLINE, palette.quiet));
            painter.text(centre, Align2::CENTER_CENTER, number, theme::small(), palette.quiet);
        }
    }
    let width = ui.available_width();
    let response = widgets::fixed_coloured(ui, width, Align::Min, text, colour);
    widgets::describe(&response, Role::Label, &format!("Step {number}, {word}: {text}"));
}

/// From the old value to the new one; egui's fonts have no such character.
pub fn arrow(ui: &mut Ui, colour: Color32) {
    let size = vec2(theme::GUIDE_ARROW, theme::CONTROL_HEIGHT);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let half = theme::CARET / 2.0;
    let (from, to) = (rect.left_center(), rect.right_center());
    ui.painter().line_segment([from, to - vec2(half, 0.0)], Stroke::new(theme::OUTLINE, colour));
    let head = vec![to, to + vec2(-theme::CARET, -half), to + vec2(-theme::CARET, half)];
    ui.painter().add(Shape::convex_polygon(head, colour, Stroke::NONE));
}
