//! The line and its modules, to choose from.

use std::slice;

use eframe::egui::{Align, Response, Role, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use super::mark;
use crate::bus::Target;
use crate::diagnosis::{ModuleReport, Report, Severity, Times};
use crate::ui::tables::{Sheet, copied};
use crate::ui::{theme, widgets, words};

const HEADER: [&str; 7] = ["Place", "Line", "Exchanges", "Failed", "Median (ms)", "99 % (ms)", "Worst finding"];

pub fn show(ui: &mut Ui, report: &Report, chosen: &mut Option<Target>) {
    let rows: Vec<Row> =
        std::iter::once(Row::of_line(report)).chain(report.modules.iter().map(Row::of_module)).collect();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for row in &rows {
            let response = row.show(ui, *chosen == row.place);
            copied(&response, |part| sheet(part.of(slice::from_ref(row), rows.as_slice())));
            if response.clicked() {
                *chosen = row.place;
            }
        }
    });
}

fn sheet(rows: &[Row]) -> Sheet {
    let mut sheet = Sheet::new(HEADER);
    rows.iter().for_each(|row| sheet.push(row.cells()));
    sheet
}

/// How much fails; an address that never answered has no rate.
pub fn words_of_share(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", share * 100.0))
}

struct Row {
    /// `None` is the line.
    place: Option<Target>,
    title: String,
    below: String,
    exchanges: u64,
    failed: Option<String>,
    times: Option<Times>,
    worst: Option<Severity>,
}

impl Row {
    fn of_line(report: &Report) -> Self {
        let line = &report.line;
        Self {
            place: None,
            title: "Line".to_owned(),
            below: line.name.clone(),
            exchanges: line.exchanges,
            failed: None,
            times: line.answer_time,
            worst: line.findings.iter().map(|finding| finding.severity).max(),
        }
    }

    fn of_module(module: &ModuleReport) -> Self {
        Self {
            place: Some(module.target),
            title: module.title(),
            below: words::spoken(&module.target),
            exchanges: module.exchanges,
            failed: Some(words_of_share(module.error_rate)),
            times: module.answer_time,
            worst: module.worst(),
        }
    }

    fn state(&self) -> &'static str {
        self.worst.map_or("nothing found", Severity::word)
    }

    fn cells(&self) -> [String; HEADER.len()] {
        let time = |of: fn(&Times) -> f64| self.times.as_ref().map(|times| format!("{:.1}", of(times)));
        let [median, late] = [time(|times| times.median_ms), time(|times| times.p99_ms)].map(Option::unwrap_or_default);
        let failed = self.failed.clone().unwrap_or_default();
        let exchanges = self.exchanges.to_string();
        [self.title.clone(), self.below.clone(), exchanges, failed, median, late, self.state().to_owned()]
    }

    fn show(&self, ui: &mut Ui, shown: bool) -> Response {
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
        let name = format!("Diagnosis of {}, {}", self.title, self.state());
        response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, shown, &name));
        let errors =
            self.failed.as_ref().map_or_else(String::new, |failed| format!("\n{failed} of the exchanges failed"));
        response.on_hover_text(format!("{}\n{}{errors}", self.title, self.below))
    }
}
