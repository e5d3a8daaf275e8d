//! The settings of sensors and outputs, in groups.

use eframe::egui::{Align, Slider, Ui};

use super::TAB;
use crate::bench::{Action, Edit, Module, SwitchKind};
use crate::module::{Item, Kind, Value};
use crate::ui::app::Pass;
use crate::ui::module_view::{form, generic, tabs};
use crate::ui::theme;
use crate::ui::widgets;

/// After the switches of the single sensors.
const SENSORS: [&str; 5] = ["pir_on_time", "pir_active_delay", "pir_off_time_on_start", "lux_level", "buzzer_on_pir"];
const SENSITIVITY: &str = "sensitivity";
const ACTIVE_STATE: &str = "output_active_state";

pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let items: Vec<&str> =
        tabs::items(module, TAB).iter().filter(|item| !item.live).map(|item| item.id.as_str()).collect();
    let is_zone = |id: &&str| id.strip_suffix("_enabled").is_some_and(|id| id.starts_with("pir"));
    let sensors: Vec<&str> = items.iter().copied().filter(is_zone).chain(SENSORS).collect();
    let outputs = of_outputs(module);
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).chain([ACTIVE_STATE]).collect();
    let there = |id: &&str| module.item(id).is_some_and(|item| module.has(item));

    if sensors.iter().chain([&SENSITIVITY]).any(there) {
        form::heading(ui, "Sensors");
        form::rows(ui, module, pass, sensors.iter().copied());
        sensitivity(ui, module, pass);
    }
    if outputs.iter().any(there) {
        form::heading(ui, "Outputs");
        form::rows(ui, module, pass, outputs.iter().copied());
        if there(&ACTIVE_STATE) {
            widgets::quiet(ui, "Output active state low inverts: a relay is active while its output is OFF.");
        }
    }
    let placed = |id: &&str| sensors.contains(id) || outputs.contains(id) || *id == SENSITIVITY;
    let others: Vec<&str> = items.into_iter().filter(|id| !placed(id)).collect();
    if !others.is_empty() {
        form::heading(ui, "Other settings");
        form::rows(ui, module, pass, others);
    }
    generic::actions(ui, TAB, module, pass);
}

/// Source, power-on and safe value of each output, output by output.
fn of_outputs(module: &Module) -> Vec<String> {
    let outputs = tabs::items(module, TAB);
    let outputs = outputs.into_iter().filter(|item| item.live && SwitchKind::of(&item.id) == SwitchKind::Output);
    outputs.flat_map(|item| ["_source", "_power_on", "_safe"].map(|suffix| format!("{}{suffix}", item.id))).collect()
}

/// The number with a slider beside it, because lower is more.
fn sensitivity(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let Some(item) = module.item(SENSITIVITY).filter(|item| module.has(item)) else { return };
    form::row(ui, module, pass, SENSITIVITY);
    if let (Kind::Number { min, max, .. }, false) = (&item.kind, item.read_only) {
        slider(ui, module, pass, item, min.raw..=max.raw);
    }
}

fn slider(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item, range: std::ops::RangeInclusive<i64>) {
    let wanted = match module.wanted(&item.id) {
        Some(Value::Number(number)) => Some(number.raw),
        _ => None,
    };
    let busy = module.edit(&item.id).is_some_and(Edit::is_being_written);
    let (min, max) = (*range.start(), *range.end());
    ui.horizontal(|ui| {
        widgets::fixed_coloured(ui, theme::FORM_LABEL, Align::Min, "", theme::palette(ui).quiet);
        widgets::quiet_small(ui, &format!("{min} sees most"));
        let mut value = wanted.unwrap_or(min);
        let response = ui.add_enabled(wanted.is_some() && !busy, Slider::new(&mut value, range).show_value(false));
        response.widget_info(|| eframe::egui::WidgetInfo::slider(true, value as f64, format!("{} slider", item.label)));
        let response = response.on_hover_text(&item.help);
        if response.changed() {
            pass.actions.push(Action::Stage(module.target, item.id.clone(), value.to_string()));
        }
        widgets::quiet_small(ui, &format!("{max} sees least"));
    });
}
