//! The names at the left of the plots: mark, name and, while the pointer is on the plot, the value at its time.
//! A click hides or shows the series.

use eframe::egui::{Align, Color32, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::scene::Scene;
use super::series::Series;
use crate::ui::settings::Settings;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets;

/// Draws the entry of a series into `rect` and lets a click switch it.
pub fn entry(ui: &mut Ui, rect: Rect, series: &Series<'_>, settings: &mut Settings, scene: &Scene<'_>) {
    let palette = theme::palette(ui);
    let hidden = settings.hidden.contains(series.stem);
    let response = ui.interact(rect, ui.scope_id().with(("legend", series.stem)), Sense::click());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let inside = rect.shrink2(vec2(theme::UNIT, 0.0));
    mark(ui, inside, series, hidden, palette);
    let text = inside.with_min_x(inside.left() + theme::GLYPH + theme::UNIT);
    let value = scene.value(series);
    let place = widgets::line_in(ui, text, Align::Max, &value, theme::small(), palette.text);
    let name = text.with_max_x(place.left() - if value.is_empty() { 0.0 } else { theme::UNIT });
    let colour = if hidden { palette.line } else { palette.quiet };
    widgets::line_in(ui, name, Align::Min, series.label, theme::small(), shade(colour, hidden, palette));
    let name = format!("Show {}", series.label);
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, !hidden, &name));
    let explanation = if hidden { "Hidden – click to show it" } else { "Click to hide it in the plot" };
    let response = response.on_hover_text(format!("{}\n{explanation}", series.label));
    if response.clicked() {
        if hidden {
            settings.hidden.remove(series.stem);
        } else {
            settings.hidden.insert(series.stem.to_owned());
        }
    }
}

fn shade(colour: Color32, hidden: bool, palette: &Palette) -> Color32 {
    if hidden { palette.old } else { colour }
}

/// A stroke in the colour of the series, hollow when it is hidden.
fn mark(ui: &Ui, rect: Rect, series: &Series<'_>, hidden: bool, palette: &Palette) {
    let centre = pos2(rect.left() + theme::GLYPH / 2.0, rect.center().y);
    let swatch = Rect::from_center_size(centre, theme::SWATCH.into());
    let rounding = theme::SWATCH[1] / 2.0;
    if hidden {
        let stroke = eframe::egui::Stroke::new(theme::HAIRLINE, palette.old);
        ui.painter().rect_stroke(swatch, rounding, stroke, eframe::egui::StrokeKind::Inside);
    } else {
        ui.painter().rect_filled(swatch, rounding, series.colour(palette));
    }
}
