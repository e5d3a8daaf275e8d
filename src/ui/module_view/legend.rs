//! The names at the left of the plots: mark, name and, while the pointer is on the plot, the value at its time.
//! A click hides or shows the series.

use eframe::egui::{Align, Color32, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::series::Series;
use super::time_axis::TimeView;
use crate::bench::Module;
use crate::ui::settings::Settings;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets;

/// Draws the entry of a series into `rect` and lets a click switch it.
pub fn entry(ui: &mut Ui, rect: Rect, series: &Series<'_>, settings: &mut Settings, at_cursor: Option<&str>) {
    let palette = theme::palette(ui);
    let hidden = settings.hidden.contains(series.stem);
    let response = ui.interact(rect, ui.scope_id().with(("legend", series.stem)), Sense::click());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let inside = rect.shrink2(vec2(theme::UNIT, 0.0));
    mark(ui, inside, series, hidden, palette);
    let text = inside.with_min_x(inside.left() + theme::GLYPH + theme::UNIT);
    let value = at_cursor.unwrap_or_default();
    let place = widgets::line_in(ui, text, Align::Max, value, theme::small(), palette.text);
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

/// How far from the pointer a sample may lie, as a multiple of the poll interval and in points.
const REACH: (f64, f64) = (1.5, 6.0);
/// And in seconds at least.
const LEAST_REACH: f64 = 0.5;

/// The sample shown for the pointer's time; none in a gap.
pub fn sample_at(module: &Module, series: &Series<'_>, view: &TimeView, seconds: f64) -> Option<[f64; 2]> {
    let sample = series.trend?.nearest(seconds)?;
    let interval = module.interval.unwrap_or_default().as_secs_f64();
    let reach = (interval * REACH.0).max(view.seconds_per_point() * REACH.1).max(LEAST_REACH);
    ((sample[0] - seconds).abs() <= reach).then_some(sample)
}
