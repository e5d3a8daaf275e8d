//! Who the module is, and how often it is polled.

use std::time::Duration;

use eframe::egui::{self, Align, RichText, Ui};

use crate::bench::{Action, DEFAULT_INTERVAL, LineState, Module, Presence};
use crate::protocol::Failure;
use crate::ui::app::Pass;
use crate::ui::settings::TemperatureUnit;
use crate::ui::widgets::{self, Glyph};
use crate::ui::{theme, words};

/// Poll intervals to choose from, in milliseconds; 0 is as fast as the line allows.
const INTERVALS: [u64; 8] = [0, 200, 500, 1_000, 2_000, 5_000, 10_000, 60_000];

/// The interval that polling resumes with.
pub struct Polling {
    interval: Duration,
}

impl Default for Polling {
    fn default() -> Self {
        Self { interval: DEFAULT_INTERVAL }
    }
}

pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, polling: &mut Polling) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(module.label()).heading().color(theme::palette(ui).text));
        presence(ui, module, pass.bench.line());
        widgets::at_right(ui, |ui| unit_toggle(ui, &mut pass.settings.temperature));
    });
    ui.horizontal(|ui| {
        let controls = theme::INTERVAL_WIDTH + theme::POLLING_WIDTH + 2.0 * theme::GAP;
        let width = (ui.available_width() - controls).max(0.0);
        let palette = theme::palette(ui);
        let response = widgets::fixed_coloured(ui, width, Align::Min, &facts(module), palette.quiet);
        response.on_hover_text(facts(module));
        widgets::at_right(ui, |ui| {
            let closed = matches!(pass.bench.line(), LineState::Closed);
            pause_button(ui, module, closed, pass.actions, polling);
            interval_selector(ui, module, pass.actions, polling);
        });
    });
}

fn facts(module: &Module) -> String {
    let identified = &module.identified;
    let firmware = match identified.firmware.is_empty() {
        true => String::new(),
        false => format!(" firmware {}", identified.firmware),
    };
    let address = words::address(module.target.address);
    format!("{}{firmware}  ·  address {address}  ·  {}", identified.name, words::spoken(&module.target))
}

fn presence(ui: &mut Ui, module: &Module, line: &LineState) {
    let palette = theme::palette(ui);
    let (glyph, colour, word) = match &module.presence {
        _ if matches!(line, LineState::Closed) => (Glyph::Ring, palette.quiet, "line closed".to_owned()),
        Presence::Silent { failure: Failure::LineLost(_) } => (Glyph::Cross, palette.error, "line lost".to_owned()),
        Presence::Silent { failure } => (Glyph::Cross, palette.error, failure.to_string()),
        Presence::Answering if module.interval.is_none() => (Glyph::Ring, palette.quiet, "polling paused".to_owned()),
        Presence::Answering => (Glyph::Disc, palette.ok, "answering".to_owned()),
        Presence::Found => (Glyph::Ring, palette.quiet, "waiting for its first answer".to_owned()),
    };
    widgets::glyph(ui, glyph, colour);
    ui.label(RichText::new(word).color(colour));
}

fn unit_toggle(ui: &mut Ui, unit: &mut TemperatureUnit) {
    ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
    for choice in TemperatureUnit::ALL.into_iter().rev() {
        if widgets::chip(ui, *unit == choice, choice.symbol(), choice.symbol()) {
            *unit = choice;
        }
    }
}

fn interval_selector(ui: &mut Ui, module: &Module, actions: &mut Vec<Action>, polling: &mut Polling) {
    if let Some(interval) = module.interval {
        polling.interval = interval;
    }
    let text = match polling.interval {
        Duration::ZERO => words::interval(Duration::ZERO),
        interval => format!("every {}", words::interval(interval)),
    };
    let combo = widgets::combo("interval", theme::INTERVAL_WIDTH, &text);
    let response = combo.show_ui(ui, |ui| {
        for choice in INTERVALS.map(Duration::from_millis) {
            if ui.selectable_label(polling.interval == choice, words::interval(choice)).clicked() {
                polling.interval = choice;
                actions.push(Action::SetInterval(module.target, choice));
            }
        }
    });
    widgets::name_combo(&response.response, "Poll interval", &text);
}

fn pause_button(ui: &mut Ui, module: &Module, closed: bool, actions: &mut Vec<Action>, polling: &Polling) {
    let (text, action) = match module.interval {
        Some(_) => ("Pause polling", Action::StopPolling(module.target)),
        None => ("Resume polling", Action::SetInterval(module.target, polling.interval)),
    };
    let button = egui::Button::new(text).min_size(egui::vec2(theme::POLLING_WIDTH, theme::CONTROL_HEIGHT));
    let response = ui.add_enabled(!closed, button).on_disabled_hover_text("No line is open: scan to open it again");
    if response.clicked() {
        actions.push(action);
    }
}
