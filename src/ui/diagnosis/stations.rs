//! The line and its modules, to choose from.

use eframe::egui::{Align, Role, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use super::mark;
use crate::bus::Target;
use crate::diagnosis::{Report, Severity};
use crate::ui::{theme, widgets, words};

pub fn show(ui: &mut Ui, report: &Report, chosen: &mut Option<Target>) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let worst = report.line.findings.iter().map(|finding| finding.severity).max();
        let line = Row { title: "Line".to_owned(), below: report.line.name.clone(), failed: None, worst };
        if line.show(ui, chosen.is_none()) {
            *chosen = None;
        }
        for module in &report.modules {
            let row = Row {
                title: module.title(),
                below: words::spoken(&module.target),
                failed: Some(words_of_share(module.error_rate)),
                worst: module.worst(),
            };
            if row.show(ui, *chosen == Some(module.target)) {
                *chosen = Some(module.target);
            }
        }
    });
}

/// How much fails; an address that never answered has no rate.
pub fn words_of_share(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", share * 100.0))
}

struct Row {
    title: String,
    below: String,
    failed: Option<String>,
    worst: Option<Severity>,
}

impl Row {
    /// True if it was chosen.
    fn show(&self, ui: &mut Ui, shown: bool) -> bool {
        let palette = theme::palette(ui);
        let size = vec2(ui.available_width(), theme::STATION_ROW);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        if shown {
            ui.painter().rect_filled(rect, theme::UNIT, palette.selection);
        } else if response.hovered() || response.has_focus() {
            ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
        }
        let inside = rect.shrink2(vec2(theme::GAP, theme::UNIT));
        let (glyph, colour) = mark(self.worst, palette);
        let text = inside.with_min_x(inside.left() + theme::GLYPH + theme::GAP);
        let (upper, lower) = text.split_top_bottom_at_fraction(0.5);
        let place = pos2(inside.left() + theme::GLYPH / 2.0, upper.center().y);
        widgets::paint_glyph(ui.painter(), glyph, place, theme::GLYPH, colour);
        let failed = self.failed.as_deref().unwrap_or_default();
        let right = widgets::line_in(ui, upper, Align::Max, failed, theme::small(), palette.quiet);
        let title = upper.with_max_x(right.left() - theme::UNIT);
        widgets::line_in(ui, title, Align::Min, &self.title, theme::body(), palette.text);
        widgets::line_in(ui, lower, Align::Min, &self.below, theme::small(), palette.quiet);
        let state = self.worst.map_or("nothing found", Severity::word);
        let name = format!("Diagnosis of {}, {state}", self.title);
        response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, shown, &name));
        let errors =
            self.failed.as_ref().map_or_else(String::new, |failed| format!("\n{failed} of the exchanges failed"));
        response.on_hover_text(format!("{}\n{}{errors}", self.title, self.below)).clicked()
    }
}
