//! The live values in large digits, and switches as lamps. A value that has grown old stays, greyed and with its
//! age; one that is not known is a dash.

use eframe::egui::{Align, Rect, Response, Role, Sense, Ui, Vec2, pos2, vec2};
use jiff::Timestamp;

use super::explanation::explanation;
use super::item_sheet;
use super::series::{Freshness, Series};
use crate::bench::Module;
use crate::protocol::Failure;
use crate::ui::theme::{self, Palette};
use crate::ui::{widgets, words};

/// Height of the large digits.
pub(super) const DIGITS_HEIGHT: f32 = theme::DIGITS + theme::GAP;

pub fn show(ui: &mut Ui, module: &Module, series: &[Series<'_>], now: Timestamp) {
    if series.iter().any(Series::is_number) {
        cells(ui, |ui| {
            for number in series.iter().filter(|series| series.is_number()) {
                number_cell(ui, module, number, now);
            }
        });
        ui.add_space(theme::UNIT);
    }
    let [least, height] = theme::LAMP_CELL;
    let columns = (ui.available_width() / least).floor().max(1.0);
    let size = vec2((ui.available_width() / columns).floor(), height);
    cells(ui, |ui| {
        for switch in series.iter().filter(|series| !series.is_number()) {
            lamp_cell(ui, size, module, switch, now);
        }
    });
}

/// Cells without room between them, as many in a row as fit.
pub(super) fn cells(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        contents(ui);
    });
}

fn number_cell(ui: &mut Ui, module: &Module, series: &Series<'_>, now: Timestamp) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(theme::READING.into(), Sense::hover());
    let freshness = series.freshness(module, now);
    digits(ui, rect, series, &freshness);
    let top = pos2(rect.left(), rect.top() + DIGITS_HEIGHT);
    let name = Rect::from_min_size(top, vec2(rect.width(), theme::LEGEND_ROW));
    named(ui, name, series, palette);
    let (note, colour) = note(series, &freshness, palette);
    let below = name.translate(vec2(0.0, theme::LEGEND_ROW)).with_max_y(rect.bottom());
    widgets::line_in(ui, beside_mark(below), Align::Min, &note, theme::small(), colour);
    tell(response, module, series, &freshness);
}

/// Paints the digits and their unit at the top of `rect`; the room at the right of the digits, where the unit stands.
pub(super) fn digits(ui: &Ui, rect: Rect, series: &Series<'_>, freshness: &Freshness) -> Rect {
    let palette = theme::palette(ui);
    let colour = if *freshness == Freshness::Fresh { palette.text } else { palette.old };
    let digits = Rect::from_min_size(rect.min, vec2(theme::READING_DIGITS, DIGITS_HEIGHT));
    let place = widgets::line_in(ui, digits, Align::Max, &value_text(series), theme::digits(), colour);
    // On the same baseline as the digits, whose descent is larger.
    let top = place.bottom() - theme::HEADING - 2.0 * theme::UNIT;
    let room = Rect::from_min_max(pos2(digits.right() + theme::UNIT, top), pos2(rect.right(), place.bottom()));
    widgets::line_in(ui, room, Align::Min, series.unit, theme::heading(), palette.quiet);
    room
}

/// Mark and name in one line, and what is to be said of a value that is not fresh.
pub(super) fn name_line(ui: &Ui, rect: Rect, series: &Series<'_>, freshness: &Freshness) {
    let palette = theme::palette(ui);
    let name = named(ui, rect, series, palette);
    let (note, colour) = note(series, freshness, palette);
    let rest = rect.with_min_x((name.right() + theme::GAP).min(rect.right()));
    widgets::line_in(ui, rest, Align::Min, &note, theme::small(), colour);
}

/// Room for the text of name and note, to the right of the mark.
pub(super) fn beside_mark(rect: Rect) -> Rect {
    rect.with_min_x(rect.left() + theme::SWATCH[0] + theme::UNIT)
}

fn named(ui: &Ui, rect: Rect, series: &Series<'_>, palette: &Palette) -> Rect {
    let [width, height] = theme::SWATCH;
    let swatch = Rect::from_center_size(pos2(rect.left() + width / 2.0, rect.center().y), vec2(width, height));
    ui.painter().rect_filled(swatch, height / 2.0, series.colour(palette));
    widgets::line_in(ui, beside_mark(rect), Align::Min, series.label, theme::body(), palette.quiet)
}

pub(super) fn lamp_cell(ui: &mut Ui, size: Vec2, module: &Module, series: &Series<'_>, now: Timestamp) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let freshness = series.freshness(module, now);
    let on = series.reading.and_then(|reading| reading.value.as_ref()).and_then(|value| value.as_bool());
    let fresh = freshness == Freshness::Fresh;
    let colour = match on {
        Some(true) if fresh => series.colour(palette),
        Some(false) if fresh => palette.quiet,
        _ => palette.old,
    };
    let centre = pos2(rect.left() + theme::LAMP / 2.0, rect.center().y);
    widgets::paint_glyph(ui.painter(), series.glyph(on), centre, theme::LAMP, colour);
    let text = rect.with_min_x(rect.left() + theme::LAMP + theme::GAP).with_max_x(rect.right() - theme::LAMP_GUTTER);
    let word = value_text(series);
    let colour = if fresh { palette.text } else { palette.old };
    let place = widgets::line_in(ui, text, Align::Max, &word, theme::body(), colour);
    let name = text.with_max_x(place.left() - theme::UNIT);
    widgets::line_in(ui, name, Align::Min, series.label, theme::body(), palette.quiet);
    tell(response, module, series, &freshness);
}

pub(super) fn value_text(series: &Series<'_>) -> String {
    let value = series.reading.and_then(|reading| reading.value.as_ref());
    value.map_or_else(|| words::UNKNOWN.to_owned(), |value| series.word(value))
}

/// The third line of a reading: nothing while it is fresh, else why not.
fn note(series: &Series<'_>, freshness: &Freshness, palette: &Palette) -> (String, eframe::egui::Color32) {
    match (freshness, series.problem()) {
        (Freshness::Fresh, _) => (String::new(), palette.quiet),
        // That the line is gone stands above, once for all.
        (Freshness::Old(age), None | Some(Failure::LineLost(_))) => (format!("{} old", words::age(*age)), palette.old),
        (Freshness::Old(age), Some(problem)) => {
            (format!("{} old – {}", words::age(*age), words::not_read(problem)), palette.error)
        }
        (Freshness::Unknown, Some(problem)) => (words::not_read(problem), palette.error),
        (Freshness::Unknown, None) => ("not read yet".to_owned(), palette.old),
    }
}

/// Name, value and state for the pointer and for assistive technology.
pub(super) fn tell(response: Response, module: &Module, series: &Series<'_>, freshness: &Freshness) {
    let value = value_text(series);
    let unit = if series.unit.is_empty() { String::new() } else { format!(" {}", series.unit) };
    let state = match freshness {
        Freshness::Fresh => String::new(),
        Freshness::Old(age) => format!(", {} old", words::age(*age)),
        Freshness::Unknown => ", not known".to_owned(),
    };
    let problem = series.problem().map(|problem| format!("\n{problem}")).unwrap_or_default();
    widgets::describe(&response, Role::Label, &format!("{} {value}{unit}{state}", series.label));
    item_sheet::copies(&response, module, series.item);
    let help = explanation(module, series.item);
    response.on_hover_text(format!("{} {value}{unit}{state}{problem}\n{help}", series.label));
}
