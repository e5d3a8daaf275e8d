//! The names at the left of the plots: mark, name and, while the pointer is on the plots, the value at its time. A click
//! hides or shows the series; the menu and dragging move it.

use eframe::egui::{
    Align, Color32, LayerId, Order, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

use super::choice::{Move, Shown, Side};
use super::curve::Curve;
use super::scene::Scene;
use crate::record::SeriesId;
use crate::ui::{theme, widgets};

/// What the user asked for at an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    Hide(SeriesId),
    Remove(SeriesId),
    Move(SeriesId, Move),
    /// The entry was let go at this height of the screen.
    Dropped(SeriesId, i32),
}

/// Draws the entry of a series into `rect`; `plots` is how many plots there are.
pub fn entry(
    ui: &mut Ui,
    rect: Rect,
    (curve, shown): (&Curve<'_>, &Shown),
    plots: usize,
    scene: &Scene<'_>,
) -> Option<Wish> {
    let palette = theme::palette(ui);
    let response = ui.interact(rect, ui.scope_id().with(("legend", curve.id.0)), Sense::click_and_drag());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let inside = rect.shrink2(vec2(theme::UNIT, 0.0));
    mark(ui, inside, curve.colour(shown.colour, palette), shown.hidden);
    let text = inside.with_min_x(inside.left() + theme::GLYPH + theme::UNIT);
    let value = scene.pointer.map(|at| scene.value(curve, at)).map(|value| curve.value_text(value));
    let value = value.filter(|_| !shown.hidden).unwrap_or_default();
    let place = widgets::line_in(ui, text, Align::Max, &value, theme::small(), palette.text);
    let name = text.with_max_x(place.left() - if value.is_empty() { 0.0 } else { theme::UNIT });
    let colour = if shown.hidden { palette.old } else { palette.quiet };
    curve.paint_name(ui, name, colour);
    let label = format!("Show {}", curve.name());
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, !shown.hidden, &label));

    let mut wish = None;
    if response.dragged()
        && let Some(pointer) = response.interact_pointer_pos()
    {
        ghost(ui, pointer, rect, curve);
    }
    if response.drag_stopped()
        && let Some(pointer) = response.interact_pointer_pos()
        && curve.is_number()
    {
        wish = Some(Wish::Dropped(curve.id, pointer.y as i32));
    }
    response.context_menu(|ui| wish = menu(ui, curve, shown, plots).or(wish));
    if response.clicked() {
        wish = Some(Wish::Hide(curve.id));
    }
    let does =
        if shown.hidden { "Hidden – click to show it" } else { "Click to hide it; right click or drag to move it" };
    response.on_hover_text(format!("{}\n{does}", curve.full_name()));
    wish
}

/// What is dragged, beside the pointer and over everything.
fn ghost(ui: &Ui, pointer: Pos2, rect: Rect, curve: &Curve<'_>) {
    let palette = theme::palette(ui);
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Tooltip, ui.scope_id().with("dragged")));
    let galley = widgets::cut(ui, &curve.name(), theme::small(), palette.text, rect.width());
    let place = Rect::from_min_size(pointer + vec2(theme::GAP, theme::GAP), galley.size());
    painter.rect_filled(place.expand(theme::UNIT), theme::UNIT, palette.raised);
    painter.galley(place.min, galley, palette.text);
}

fn menu(ui: &mut Ui, curve: &Curve<'_>, shown: &Shown, plots: usize) -> Option<Wish> {
    let mut wish = None;
    let mut entry = |ui: &mut Ui, enabled: bool, text: &str, asked: Wish| {
        if ui.add_enabled(enabled, eframe::egui::Button::new(text)).clicked() {
            wish = Some(asked);
            ui.close();
        }
    };
    let moved = |to| Wish::Move(curve.id, to);
    if curve.is_number() {
        let (is_first, is_last) = (shown.plot == 0, shown.plot.saturating_add(1) >= plots);
        entry(ui, !is_first, "Move to the plot above", moved(Move::Above));
        entry(ui, !is_last, "Move to the plot below", moved(Move::Below));
        entry(ui, true, "Move to a new plot", moved(Move::NewPlot));
        entry(ui, shown.side != Side::Left, "Left axis", moved(Move::To(Side::Left)));
        entry(ui, shown.side != Side::Right, "Right axis", moved(Move::To(Side::Right)));
    }
    entry(ui, true, if shown.hidden { "Show" } else { "Hide" }, Wish::Hide(curve.id));
    entry(ui, true, "Remove", Wish::Remove(curve.id));
    wish
}

/// A stroke in the colour of the series, hollow when it is hidden.
pub fn mark(ui: &Ui, rect: Rect, colour: Color32, hollow: bool) {
    let centre = pos2(rect.left() + theme::GLYPH / 2.0, rect.center().y);
    let swatch = Rect::from_center_size(centre, theme::SWATCH.into());
    let rounding = theme::SWATCH[1] / 2.0;
    if hollow {
        let stroke = Stroke::new(theme::HAIRLINE, theme::palette(ui).old);
        ui.painter().rect_stroke(swatch, rounding, stroke, StrokeKind::Inside);
    } else {
        ui.painter().rect_filled(swatch, rounding, colour);
    }
}
