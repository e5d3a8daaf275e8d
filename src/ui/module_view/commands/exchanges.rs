//! What was sent and what came back, newest first: each with its time, its answer, and what the answer means field by
//! field.

use std::collections::BTreeMap;

use eframe::egui::{self, Align, Color32, Label, Layout, Rect, RichText, Role, Sense, Ui, WidgetInfo, vec2};
use jiff::tz::TimeZone;

use super::{line_size, scrolled, sending};
use crate::bench::console::{Exchange, RawCommand};
use crate::bench::{Action, Module};
use crate::bus::RequestId;
use crate::module::ExplainedField;
use crate::protocol::hex;
use crate::ui::app::Pass;
use crate::ui::tables::{Part, Sheet, copied};
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

#[derive(Default)]
pub struct Exchanges {
    /// Which ones the user has opened or closed; the newest is open by itself.
    open: BTreeMap<RequestId, bool>,
    /// How high each was drawn last, so that those out of view need not be.
    heights: BTreeMap<RequestId, f32>,
}

impl Exchanges {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let log = module.console.log();
        self.head(ui, module, pass);
        let oldest = log.get(0).map(|exchange| exchange.id);
        self.open.retain(|id, _| oldest.is_some_and(|oldest| *id >= oldest));
        self.heights.retain(|id, _| oldest.is_some_and(|oldest| *id >= oldest));
        scrolled(ui, "exchanges", |ui| {
            if log.is_empty() {
                widgets::quiet(ui, "Nothing was sent yet. Commands and their answers stand here, the newest first.");
            }
            for (place, exchange) in log.iter().rev().enumerate() {
                self.place(ui, module, exchange, place == 0);
            }
        });
    }

    fn head(&self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let log = module.console.log();
        ui.horizontal(|ui| {
            ui.label(RichText::new("Exchanges").strong());
            if !log.is_empty() {
                widgets::quiet(ui, &log.len().to_string());
            }
            widgets::at_right(ui, |ui| {
                let any = !log.is_empty();
                let clear = ui.add_enabled(any, egui::Button::new("Clear").frame_when_inactive(false));
                if clear.on_hover_text("Forgets the exchanges with this module").clicked() {
                    pass.actions.push(Action::ClearExchanges(module.target));
                }
                let copy = ui.add_enabled(any, egui::Button::new("Copy all").frame_when_inactive(false));
                if copy.on_hover_text("All exchanges as text, with what they mean").clicked() {
                    let all: Vec<String> = log.iter().map(|exchange| as_text(module, exchange)).collect();
                    ui.ctx().copy_text(all.join("\n"));
                }
            });
        });
    }

    /// Draws an exchange, or keeps its room if it is out of view.
    fn place(&mut self, ui: &mut Ui, module: &Module, exchange: &Exchange, newest: bool) {
        let height = self.heights.get(&exchange.id).copied().unwrap_or(theme::EXCHANGE_HEIGHT);
        let size = vec2(ui.available_width(), height);
        if !ui.is_rect_visible(Rect::from_min_size(ui.cursor().min, size)) {
            ui.allocate_space(size);
            return;
        }
        let drawn = ui.scope(|ui| ui.push_id(exchange.id.0, |ui| self.exchange(ui, module, exchange, newest)));
        self.heights.insert(exchange.id, drawn.response.rect.height());
    }

    fn exchange(&mut self, ui: &mut Ui, module: &Module, exchange: &Exchange, newest: bool) {
        let palette = theme::palette(ui);
        let open = self.open.get(&exchange.id).copied().unwrap_or(newest);
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.horizontal(|ui| {
            let (rect, toggle) = ui.allocate_exact_size(vec2(theme::GLYPH, theme::CONTROL_HEIGHT), Sense::click());
            egui::collapsing_header::paint_default_icon(
                ui,
                if open { 1.0 } else { 0.0 },
                &toggle.clone().with_new_rect(Rect::from_center_size(rect.center(), egui::Vec2::splat(theme::CARET))),
            );
            let name = format!("Details of {}", exchange.sent);
            toggle.widget_info(|| WidgetInfo::selected(Role::Button, true, open, &name));
            if toggle.on_hover_text("The fields of the answer, one by one").clicked() {
                self.open.insert(exchange.id, !open);
            }
            let when = widgets::fixed_coloured(ui, theme::EXCHANGE_TIME, Align::Min, &time(exchange), palette.quiet);
            copied(&when, |part| match part {
                Part::Row => sheet(module, [exchange]),
                Part::Table => sheet(module, module.console.log().iter()),
            });
            ui.add(Label::new(RichText::new(exchange.sent.to_string()).monospace().color(palette.accent)).truncate());
            if let Some(line) = exchange.line {
                widgets::quiet_small(ui, &format!("line {line}"));
            }
            widgets::at_right(ui, |ui| {
                let copy = ui.add(egui::Button::new("Copy").small().frame_when_inactive(false));
                copy.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Copy {}", exchange.sent)));
                if copy.on_hover_text("This exchange as text, with what it means").clicked() {
                    ui.ctx().copy_text(as_text(module, exchange));
                }
                if let Some(took) = exchange.took {
                    widgets::quiet_small(ui, &format!("{:.1} ms", took.as_secs_f64() * 1e3))
                        .on_hover_text("From the first byte sent to the last of the answer");
                }
            });
        });
        self.answer(ui, module, exchange, open);
        ui.add_space(theme::UNIT);
        let (line, _) = ui.allocate_exact_size(vec2(line_size(ui).x, theme::HAIRLINE), Sense::hover());
        ui.painter().rect_filled(line, 0.0, palette.line);
        ui.add_space(theme::UNIT);
    }

    fn answer(&self, ui: &mut Ui, module: &Module, exchange: &Exchange, open: bool) {
        let palette = theme::palette(ui);
        match &exchange.result {
            None => indented(ui, |ui| drop(widgets::quiet(ui, "waiting for the answer"))),
            Some(Err(failure)) => marked(ui, Glyph::Cross, palette.error, &failure.to_string()),
            Some(Ok(_)) => {
                let text = exchange.answer_text().unwrap_or_default();
                let bytes = exchange.result.iter().flatten().flatten().copied().collect::<Vec<u8>>();
                indented(ui, |ui| {
                    ui.spacing_mut().item_spacing.x = theme::GAP_SECTION;
                    ui.add(Label::new(RichText::new(text).monospace().color(palette.text)).wrap());
                    if matches!(exchange.sent, RawCommand::Dcon { .. }) && !bytes.is_empty() && open {
                        let hex = RichText::new(hex::spaced(&bytes)).font(theme::small_mono()).color(palette.quiet);
                        ui.add(Label::new(hex).wrap());
                    }
                });
            }
        }
        if let Some(meaning) = sending::meaning_of_answer(module, exchange) {
            indented(ui, |ui| {
                ui.add(Label::new(RichText::new(&meaning.summary).color(palette.quiet)).wrap());
            });
            if open {
                meaning.fields.iter().for_each(|field| explained(ui, field));
            }
        }
        match &exchange.verdict {
            Some(Ok(())) => marked(ui, Glyph::Disc, palette.ok, "as expected"),
            Some(Err(reason)) => marked(ui, Glyph::Cross, palette.error, reason),
            None => {}
        }
    }
}

/// Behind the mark that opens it.
fn indented(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        ui.add_space(theme::GLYPH + theme::GAP);
        contents(ui);
    });
}

fn marked(ui: &mut Ui, glyph: Glyph, colour: Color32, text: &str) {
    indented(ui, |ui| {
        widgets::glyph(ui, glyph, colour);
        ui.add(Label::new(RichText::new(text).color(colour)).wrap());
    });
}

/// One field: its name, as it is in the frame, and what it means.
fn explained(ui: &mut Ui, field: &ExplainedField) {
    let palette = theme::palette(ui);
    let cell = |ui: &mut Ui, width: f32, text: RichText| {
        ui.allocate_ui_with_layout(vec2(width, theme::LEGEND_ROW), Layout::left_to_right(Align::Min), |ui| {
            ui.set_min_width(width);
            ui.set_max_width(width);
            ui.add(Label::new(text).truncate());
        });
    };
    ui.horizontal_top(|ui| {
        ui.add_space(theme::GLYPH + theme::GAP);
        cell(ui, theme::EXPLAINED_NAME, RichText::new(&field.name).small().color(palette.quiet));
        cell(ui, theme::EXPLAINED_RAW, RichText::new(&field.raw).font(theme::small_mono()).color(palette.text));
        ui.add(Label::new(RichText::new(&field.meaning).small().color(palette.text)).wrap());
    });
}

/// Local time with milliseconds.
fn time(exchange: &Exchange) -> String {
    exchange.at.to_zoned(TimeZone::system()).strftime("%H:%M:%S%.3f").to_string()
}

/// Exchanges as a table.
fn sheet<'a>(module: &Module, exchanges: impl IntoIterator<Item = &'a Exchange>) -> Sheet {
    let mut sheet = Sheet::new(["Time (UTC)", "Sent", "Answer", "Meaning", "Took (ms)"]);
    for exchange in exchanges {
        let meaning = sending::meaning_of_answer(module, exchange).map(|meaning| meaning.summary);
        let failure = exchange.result.iter().find_map(|result| result.as_ref().err()).map(ToString::to_string);
        let took = exchange.took.map(|took| format!("{:.1}", took.as_secs_f64() * 1e3));
        let [answer, meaning, took] =
            [failure.or_else(|| exchange.answer_text()), meaning, took].map(Option::unwrap_or_default);
        sheet.push([format!("{:.6}", exchange.at), exchange.sent.to_string(), answer, meaning, took]);
    }
    sheet
}

/// An exchange as lines of text.
fn as_text(module: &Module, exchange: &Exchange) -> String {
    let answer = exchange.answer_text().unwrap_or_else(|| "waiting for the answer".to_owned());
    let took = exchange.took.map(|took| format!("  ({:.1} ms)", took.as_secs_f64() * 1e3)).unwrap_or_default();
    let mut text = format!("{}  {}  {answer}{took}", time(exchange), exchange.sent);
    for field in sending::meaning_of_answer(module, exchange).iter().flat_map(|meaning| &meaning.fields) {
        text.push_str(&format!("\n    {}  {}  {}", field.name, field.raw, field.meaning));
    }
    text
}
