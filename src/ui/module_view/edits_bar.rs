//! The bar beneath a module's tabs: how many changes wait, and what becomes of them. Its room is always kept.

use eframe::egui::{Button, KeyboardShortcut, Modifiers, RichText, Sense, Ui, vec2};

use super::form;
use crate::bench::{Action, Module};
use crate::ui::app::Pass;
use crate::ui::panes::Pane;
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

pub const HEIGHT: f32 = theme::CONTROL_HEIGHT + theme::UNIT;
/// Writes all changes of the module in view.
pub const WRITE_ALL: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, eframe::egui::Key::Enter);

pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    ui.add_space(theme::UNIT);
    if module.edits.is_empty() {
        ui.allocate_exact_size(vec2(ui.available_width(), theme::CONTROL_HEIGHT), Sense::hover());
        return;
    }
    let edited: Vec<String> = module.edited().into_iter().map(str::to_owned).collect();
    let count = edited.len();
    ui.horizontal(|ui| {
        widgets::glyph(ui, Glyph::Edited, palette.accent);
        let text = if count == 1 { "1 change not written".to_owned() } else { format!("{count} changes not written") };
        let labels: Vec<&str> =
            edited.iter().filter_map(|id| module.item(id)).map(|item| item.label.as_str()).collect();
        ui.label(RichText::new(text).color(palette.text)).on_hover_text(labels.join("\n"));
        let init = module.edited_for_init().len();
        if init > 0 {
            widgets::quiet(ui, &format!("{init} in INIT mode, step by step"));
        }
        widgets::at_right(ui, |ui| {
            let reason = module.unwritable().or_else(|| pass.bench.line().obstacle().map(str::to_owned));
            let shortcut = ui.ctx().format_shortcut(&WRITE_ALL);
            let means = format!("Writes the changes to the module and reads them back ({shortcut})");
            let button = ui.add_enabled(reason.is_none(), Button::new(format!("Write {count}")));
            let button = button.on_disabled_hover_text(reason.clone().unwrap_or_default()).on_hover_text(means);
            let asked = ui.memory(|memory| memory.top_modal_layer().is_some());
            let meant = reason.is_none() && !asked && pass.active == Pane::Module(module.target);
            let typed = meant && ui.input_mut(|input| input.consume_shortcut(&WRITE_ALL));
            if button.clicked() || typed {
                form::write(module, pass, &edited);
            }
            let revert = ui.button("Revert all");
            if revert.on_hover_text("Drops the changes; the module keeps what it has").clicked() {
                pass.actions.push(Action::Revert(module.target, None));
            }
        });
    });
}
