//! The high temperature alarm: its state, what it watches for, and what ends it.

use eframe::egui::{Align, Ui};

use super::super::series::Series;
use super::super::{form, readings, temperature};
use super::latches;
use crate::bench::Module;
use crate::module::{Item, Value};
use crate::ui::app::Pass;
use crate::ui::theme;
use crate::ui::widgets;

pub const HEADING: &str = "High temperature alarm";
const CLEAR: &str = "clear_alarm";

pub fn is_setting(item: &Item) -> bool {
    item.id.starts_with("alarm_")
}

pub fn is_action(id: &str) -> bool {
    id == CLEAR
}

/// The alarm in one line, and at its end what resets all latches.
pub fn show(ui: &mut Ui, module: &Module, switches: &[&Series<'_>], pass: &mut Pass<'_>) {
    ui.horizontal_wrapped(|ui| {
        for switch in switches {
            readings::lamp_cell(ui, theme::LAMP_CELL.into(), module, switch, pass.bench.now());
        }
        if let Some(text) = watches_for(module, pass) {
            let colour = theme::palette(ui).quiet;
            widgets::fixed_coloured(ui, theme::ALARM_PHRASE, Align::Min, &text, colour).on_hover_text(text);
        }
        form::action(ui, module, pass, CLEAR);
        latches::reset_all(ui, module, pass);
    });
}

/// `Momentary, above 65.00 °C`, with the limit also in the chosen unit.
fn watches_for(module: &Module, pass: &Pass<'_>) -> Option<String> {
    let known = |id: &str| {
        let item = module.item(id).filter(|item| module.has(item))?;
        Some((item, module.known(id)?))
    };
    let (mode, value) = known("alarm_mode")?;
    let word = mode.bare_text(value);
    if *value == Value::Choice("disabled".to_owned()) {
        return Some("Alarm disabled".to_owned());
    }
    let Some((limit, value)) = known("alarm_limit") else { return Some(word) };
    let chosen = pass.settings.temperature.symbol();
    let in_chosen = value.as_f64().filter(|_| limit.unit != chosen);
    let in_chosen = in_chosen.and_then(|value| temperature::converted(value, &limit.unit, chosen));
    let also = in_chosen.map(|value| format!(" ({value:.2} {chosen})")).unwrap_or_default();
    Some(format!("{word}, above {}{also}", limit.text(value)))
}
