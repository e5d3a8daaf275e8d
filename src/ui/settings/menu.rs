//! The menu that changes how the window looks.

use eframe::egui;

use super::{Settings, TemperatureUnit, ThemeChoice, ZOOMS};
use crate::ui::widgets;

const ZOOM_STEP: f32 = 0.1;

/// The menu at the right end of the top row.
pub fn menu(ui: &mut egui::Ui, settings: &mut Settings) {
    widgets::menu(ui, "View", "View", |ui| {
        widgets::section(ui, "Theme");
        for (choice, name) in ThemeChoice::ALL {
            if ui.radio_value(&mut settings.theme, choice, name).changed() {
                ui.ctx().set_theme(choice.preference());
            }
        }
        widgets::section(ui, "Temperatures");
        for unit in TemperatureUnit::ALL {
            ui.radio_value(&mut settings.temperature, unit, unit.symbol());
        }
        widgets::section(ui, "Size");
        ui.horizontal(zoom_buttons);
    });
}

fn zoom_buttons(ui: &mut egui::Ui) {
    let zoom = ui.ctx().zoom_factor();
    let mut wanted = None;
    if ui.button("Smaller").on_hover_text("Ctrl and minus").clicked() {
        wanted = Some(zoom - ZOOM_STEP);
    }
    ui.label(format!("{:.0} %", zoom * 100.0));
    if ui.button("Larger").on_hover_text("Ctrl and plus").clicked() {
        wanted = Some(zoom + ZOOM_STEP);
    }
    if ui.button("Reset").on_hover_text("Ctrl and 0").clicked() {
        wanted = Some(1.0);
    }
    if let Some(wanted) = wanted {
        ui.ctx().set_zoom_factor(wanted.clamp(*ZOOMS.start(), *ZOOMS.end()));
    }
}
