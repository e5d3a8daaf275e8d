//! The form of a command: its fields with choices, shared bits as parts, and what is wrong with what is typed.

use eframe::egui::{Align, Role, TextEdit, TextStyle, Ui, WidgetInfo};

use crate::bench::console::{Direction, FieldDefault, ReferenceEntry, ReferenceField};
use crate::module::Fields;
use crate::ui::theme;
use crate::ui::widgets;

/// The lines of the fields to fill in. `texts` holds what is typed.
pub fn show(ui: &mut Ui, entry: &ReferenceEntry, direction: Direction, address: u8, texts: &mut Fields) {
    for field in entry.fields_to_fill(direction) {
        ui.push_id(&field.name, |ui| {
            if is_address(field) || matches!(field.default, Some(FieldDefault::Constant(_))) {
                return fixed_field(ui, field, address, texts);
            }
            let text = texts.entry(field.name.clone()).or_default();
            show_field(ui, field, text);
        });
    }
}

fn is_address(field: &ReferenceField) -> bool {
    field.default == Some(FieldDefault::Address)
}

/// A field that has its text by itself; the address may be replaced.
fn fixed_field(ui: &mut Ui, field: &ReferenceField, address: u8, texts: &mut Fields) {
    let own = field.default.as_ref().map(|default| default.text(address)).unwrap_or_default();
    ui.horizontal(|ui| {
        name(ui, field);
        if is_address(field) {
            typed(ui, field, texts.entry(field.name.clone()).or_default(), &own);
        } else {
            let colour = theme::palette(ui).text;
            widgets::fixed_coloured(ui, theme::NUMBER_FIELD, Align::Min, &own, colour);
        }
        let (width, colour) = (ui.available_width(), theme::palette(ui).quiet);
        widgets::fixed_coloured(ui, width, Align::Min, &field.hint, colour).on_hover_text(&field.hint);
    });
}

fn show_field(ui: &mut Ui, field: &ReferenceField, text: &mut String) {
    let suggestion = field.default.as_ref().map(|default| default.text(0)).unwrap_or_default();
    ui.horizontal(|ui| {
        name(ui, field);
        typed(ui, field, text, &suggestion);
        if field.choices.is_empty() {
            let palette = theme::palette(ui);
            let wrong = field.check(text).err().filter(|_| !text.is_empty());
            let (colour, said) = match &wrong {
                Some(reason) => (palette.error, reason.as_str()),
                None => (palette.quiet, field.hint.as_str()),
            };
            let width = ui.available_width();
            widgets::fixed_coloured(ui, width, Align::Min, said, colour).on_hover_text(said);
        } else {
            choice(ui, field, text);
        }
    });
    for part in &field.parts {
        ui.horizontal(|ui| {
            let colour = theme::palette(ui).quiet;
            widgets::fixed_coloured(ui, theme::FIELD_NAME, Align::Min, &part.label, colour)
                .on_hover_text(&part.allowed);
            let whole = if text.is_empty() { "0".repeat(field.width.unwrap_or(1)) } else { text.clone() };
            let number = part.take(&whole).filter(|_| !text.is_empty());
            if part.choices.is_empty() {
                widgets::quiet(ui, &part.allowed).on_hover_text(&field.hint);
                return;
            }
            let chosen = part.choices.iter().find(|(code, _)| Some(*code) == number);
            let shown = chosen.map_or("choose", |(_, meaning)| meaning.as_str());
            let response = widgets::combo(&part.item, ui.available_width() - theme::GAP, shown).show_ui(ui, |ui| {
                for (code, meaning) in &part.choices {
                    if ui.selectable_label(Some(*code) == number, meaning).clicked()
                        && let Some(changed) = part.put(&whole, *code)
                    {
                        *text = changed;
                    }
                }
            });
            widgets::name_combo(&response.response, &part.label, shown);
            response.response.on_hover_text(&part.allowed);
        });
    }
}

fn choice(ui: &mut Ui, field: &ReferenceField, text: &mut String) {
    let chosen = field.choices.iter().find(|choice| choice.code.eq_ignore_ascii_case(text));
    let unknown = if text.is_empty() { "choose" } else { "no meaning known" };
    let shown = chosen.map_or(unknown, |choice| choice.meaning.as_str());
    let response = widgets::combo("choice", ui.available_width() - theme::GAP, shown).show_ui(ui, |ui| {
        for choice in &field.choices {
            let label = format!("{}  {}", choice.code, choice.meaning);
            if ui.selectable_label(choice.code.eq_ignore_ascii_case(text), label).clicked() {
                choice.code.clone_into(text);
            }
        }
    });
    let name = format!("Choice of {}", field.name);
    widgets::name_combo(&response.response, &name, shown);
    response.response.on_hover_text(&field.hint);
}

fn name(ui: &mut Ui, field: &ReferenceField) {
    let colour = theme::palette(ui).quiet;
    widgets::fixed_coloured(ui, theme::FIELD_NAME, Align::Min, &field.name, colour).on_hover_text(&field.hint);
}

fn typed(ui: &mut Ui, field: &ReferenceField, text: &mut String, suggestion: &str) {
    let wrong = !text.is_empty() && field.check(text).is_err();
    let palette = theme::palette(ui);
    let mut edit = TextEdit::singleline(text).font(TextStyle::Monospace).hint_text(suggestion);
    if wrong {
        edit = edit.text_color(palette.error);
    }
    let response = ui.add(edit.desired_width(theme::NUMBER_FIELD - theme::FIELD_MARGIN));
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(text.clone()),
        ..WidgetInfo::labeled(Role::TextInput, true, format!("Field {}", field.name))
    });
    response.on_hover_text(field.form());
}
