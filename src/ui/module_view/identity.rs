//! The header of a module: who it is, whether it answers, its watchdog, and how often it is polled.

use std::time::Duration;

use eframe::egui::{self, Align, RichText, Ui};

use super::indicator::{self, Indicator};
use crate::bench::{Action, DEFAULT_INTERVAL, LineState, Module, Presence};
use crate::protocol::Failure;
use crate::ui::app::Pass;
use crate::ui::settings::TemperatureUnit;
use crate::ui::widgets::{self, Glyph};
use crate::ui::{interval, theme, words};

/// The interval that polling resumes with.
struct Polling {
    interval: Duration,
}

/// What the header remembers between frames.
#[derive(Default)]
pub struct Header {
    polling: Polling,
    indicator: Indicator,
}

impl Default for Polling {
    fn default() -> Self {
        Self { interval: DEFAULT_INTERVAL }
    }
}

/// `asks` are the items that the present tab reads when asked to read again.
pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, header: &mut Header, asks: Vec<String>) {
    header.indicator.look_after_a_trip(module, pass);
    // In a narrow pane, or with large text, the controls have a row of their own, and the watchdog has that of what the
    // module said while there is something to say of it.
    let beside = ui.available_width() >= theme::MODULE_LEAST;
    ui.horizontal(|ui| {
        let name = ui.label(RichText::new(module.label()).heading().color(theme::palette(ui).text));
        name.on_hover_text(facts(module, "firmware "));
        let others =
            if beside { indicator::width(module) } else { 0.0 } + theme::UNITS_WIDTH + theme::GLYPH + 3.0 * theme::GAP;
        let width = (ui.available_width() - others).max(0.0);
        presence(ui, module, pass.bench.line(), width);
        widgets::at_right(ui, |ui| {
            unit_toggle(ui, &mut pass.settings.temperature);
            ui.add_space(theme::GAP);
            if beside {
                indicator::show(ui, module, pass);
            }
        });
    });
    if beside {
        ui.horizontal(|ui| {
            let controls = theme::INTERVAL_WIDTH + theme::POLLING_WIDTH + theme::READ_WIDTH + 3.0 * theme::GAP;
            told(ui, module, (ui.available_width() - controls).max(0.0));
            widgets::at_right(ui, |ui| {
                pause_button(ui, module, pass, &header.polling);
                interval_selector(ui, module, pass.actions, &mut header.polling, theme::INTERVAL_WIDTH);
                read_again(ui, module, pass, asks);
            });
        });
    } else {
        if indicator::speaks(module) {
            ui.horizontal(|ui| widgets::at_right(ui, |ui| indicator::show(ui, module, pass)));
        } else {
            told(ui, module, ui.available_width());
        }
        ui.horizontal_wrapped(|ui| {
            let room = ui.available_width();
            read_again(ui, module, pass, asks);
            let [least, most] = [theme::BUTTON_WIDTH, theme::INTERVAL_WIDTH];
            let width = (room - theme::POLLING_WIDTH - theme::READ_WIDTH - 2.0 * theme::GAP).clamp(least, most);
            interval_selector(ui, module, pass.actions, &mut header.polling, width);
            pause_button(ui, module, pass, &header.polling);
        });
    }
}

/// What it said of itself, and how it is reached.
fn told(ui: &mut Ui, module: &Module, width: f32) {
    let quiet = theme::palette(ui).quiet;
    let response = widgets::fixed_coloured(ui, width, Align::Min, &facts(module, ""), quiet);
    response.on_hover_text(facts(module, "firmware "));
}

/// `before` comes before the firmware's version, where there is room for it.
fn facts(module: &Module, before: &str) -> String {
    let identified = &module.identified;
    let firmware = match identified.firmware.is_empty() {
        true => String::new(),
        false => format!(" {before}{}", identified.firmware),
    };
    let address = words::address(module.target.address);
    format!("{}{firmware}  ·  address {address}  ·  {}", identified.name, words::spoken(&module.target))
}

fn presence(ui: &mut Ui, module: &Module, line: &LineState, width: f32) {
    let palette = theme::palette(ui);
    let (glyph, colour, word) = match &module.presence {
        _ if matches!(line, LineState::Closed) => (Glyph::Ring, palette.quiet, "line closed".to_owned()),
        _ if line.is_lost() => (Glyph::Cross, palette.error, "line lost".to_owned()),
        Presence::Silent { failure: Failure::LineLost(_) } => (Glyph::Cross, palette.error, "line lost".to_owned()),
        Presence::Silent { failure } => (Glyph::Cross, palette.error, failure.to_string()),
        Presence::Answering if module.interval.is_none() => (Glyph::Ring, palette.quiet, "polling paused".to_owned()),
        Presence::Answering => (Glyph::Disc, palette.ok, "answering".to_owned()),
        Presence::Found => (Glyph::Ring, palette.quiet, "waiting for its first answer".to_owned()),
    };
    widgets::glyph(ui, glyph, colour);
    widgets::fixed_coloured(ui, width, Align::Min, &word, colour).on_hover_text(&word);
}

fn unit_toggle(ui: &mut Ui, unit: &mut TemperatureUnit) {
    ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
    for choice in TemperatureUnit::ALL.into_iter().rev() {
        if widgets::chip(ui, *unit == choice, choice.symbol(), choice.symbol(), choice.means()) {
            *unit = choice;
        }
    }
}

fn interval_selector(ui: &mut Ui, module: &Module, actions: &mut Vec<Action>, polling: &mut Polling, width: f32) {
    if let Some(interval) = module.interval {
        polling.interval = interval;
    }
    if let Some(interval) = interval::selector(ui, "interval", "Poll interval", width, polling.interval) {
        polling.interval = interval;
        actions.push(Action::SetInterval(module.target, interval));
    }
}

fn pause_button(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, polling: &Polling) {
    let (text, means, action) = match module.interval {
        Some(_) => ("Pause polling", "Asks it nothing by itself until resumed", Action::StopPolling(module.target)),
        None => {
            let action = Action::SetInterval(module.target, polling.interval);
            ("Resume polling", "Asks it again and again for its readings", action)
        }
    };
    let closed = matches!(pass.bench.line(), LineState::Closed);
    let button = egui::Button::new(text).min_size(egui::vec2(theme::POLLING_WIDTH, theme::CONTROL_HEIGHT));
    let response = ui.add_enabled(!closed, button).on_hover_text(means);
    if response.on_disabled_hover_text("No line is open: scan to open it again").clicked() {
        pass.actions.push(action);
    }
}

/// Reads what the present tab shows once more. F5 does the same, for the tab that is worked in.
fn read_again(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, asks: Vec<String>) {
    let obstacle = pass.bench.line().obstacle();
    let reason = obstacle.unwrap_or("Nothing on this tab is read on request");
    let enabled = obstacle.is_none() && !asks.is_empty();
    let button = egui::Button::new("Read again").min_size(egui::vec2(theme::READ_WIDTH, theme::CONTROL_HEIGHT));
    let response = ui.add_enabled(enabled, button);
    let response = response.on_hover_text("Reads what this tab shows once more (F5)").on_disabled_hover_text(reason);
    if response.clicked() {
        pass.actions.push(Action::Read(module.target, asks));
    }
}
