//! A module that no definition fits: what it said, and how to make it known.

use eframe::egui::{RichText, TextEdit, Ui};

use crate::bench::{Action, Module};
use crate::ui::app::Pass;
use crate::ui::dialogs::Dialogs;
use crate::ui::{theme, widgets, words};

pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, dialogs: &mut Dialogs) {
    ui.vertical(|ui| {
        ui.set_max_width(theme::TEXT_WIDTH);
        introduce(ui, module, pass, dialogs);
    });
}

fn introduce(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, dialogs: &mut Dialogs) {
    let palette = theme::palette(ui);
    ui.label(RichText::new("Unknown module").heading().color(palette.text));
    let address = words::address(module.target.address);
    widgets::quiet(ui, &format!("Address {address}  ·  {}", words::spoken(&module.target)));
    ui.add_space(theme::GAP);
    if !module.identified.name.is_empty() {
        said(ui, "Name", &module.identified.name);
    }
    said(ui, "Said", &module.identified.said);
    ui.add_space(theme::GAP);
    let known: Vec<&str> = pass.bench.catalogue().iter().map(|definition| definition.label.as_str()).collect();
    ui.label(format!(
        "It answers, but none of the known models ({}) introduces itself in this way. A definition file tells what a \
         model has and how it says its name.",
        known.join(", ")
    ));
    ui.add_space(theme::GAP);
    ui.horizontal(|ui| {
        let add = ui.button("Add definition file…");
        if add.on_hover_text("Chooses a file that tells what the model has; it is checked, and kept").clicked() {
            dialogs.ask_for_definition(ui.ctx());
        }
        let remove = ui.button("Remove from the list");
        if remove.on_hover_text("It comes back with the next scan that finds it").clicked() {
            pass.actions.push(Action::Remove(module.target));
        }
    });
}

/// What the module said, as it said it, to be copied.
fn said(ui: &mut Ui, title: &str, text: &str) {
    ui.horizontal_top(|ui| {
        widgets::fixed_coloured(ui, theme::ROW_NAME, eframe::egui::Align::Min, title, theme::palette(ui).quiet);
        let mut shown = if text.is_empty() { "nothing" } else { text };
        let field = TextEdit::multiline(&mut shown).desired_rows(1).desired_width(f32::INFINITY);
        let response = ui.add(field.font(eframe::egui::TextStyle::Monospace));
        widgets::tell(&response, eframe::egui::Role::MultilineTextInput, title, text);
    });
}
