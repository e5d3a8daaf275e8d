//! Host WDT: the host watchdog and the Host OK that keeps it quiet.

mod countdown;
mod host_ok;
mod questions;

use eframe::egui::{RichText, Ui};

use super::{form, tabs};
use crate::bench::Module;
use crate::module::Value;
use crate::ui::app::Pass;
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};
use countdown::Countdown;
use host_ok::Period;

pub use host_ok::stop;
pub use questions::{before_writing, period_words, seconds};

/// Items with a place of their own on the tab.
const PLACED: [&str; 4] = ["wdt_enabled", "wdt_timeout", "wdt_timeout_count", "wdt_tripped"];

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Watchdog {
    period: Period,
    countdown: Countdown,
}

impl Watchdog {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        ui.set_max_width(ui.available_width().min(theme::TAB_WIDTH));
        if exists(module) {
            state(ui, module, pass);
            self.countdown.show(ui, module, pass.bench.now());
            self.period.show(ui, module, pass);
            form::heading(ui, "Watchdog");
            form::rows(ui, module, pass, ["wdt_enabled", "wdt_timeout", "wdt_timeout_count"]);
        }
        outputs(ui, module, pass);
    }
}

/// Whether the module tells of a host watchdog over its protocol.
pub fn exists(module: &Module) -> bool {
    ["wdt_enabled", "wdt_tripped"].into_iter().filter_map(|id| module.item(id)).any(|item| module.has(item))
}

/// Whether the module said that its watchdog has tripped.
pub fn has_tripped(module: &Module) -> bool {
    module.known("wdt_tripped").and_then(Value::as_bool).unwrap_or(false)
}

/// Whether it has tripped, and the way out.
fn state(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    let tripped = module.known("wdt_tripped").and_then(Value::as_bool);
    let (glyph, colour, text) = match tripped {
        Some(true) => (Glyph::Triangle, palette.alarm, "Tripped"),
        Some(false) => (Glyph::Outline, palette.quiet, "Not tripped"),
        None => (Glyph::Dashes, palette.old, "Not known whether it has tripped"),
    };
    ui.horizontal(|ui| {
        widgets::glyph(ui, glyph, colour);
        ui.label(RichText::new(text).heading().color(palette.text));
        if let Some(item) = module.item("wdt_tripped").filter(|item| module.has(item)) {
            widgets::at_right(ui, |ui| {
                form::action(ui, module, pass, "clear_watchdog");
                let width = ui.available_width();
                ui.allocate_ui(eframe::egui::vec2(width, theme::CONTROL_HEIGHT), |ui| {
                    ui.with_layout(eframe::egui::Layout::left_to_right(eframe::egui::Align::Center), |ui| {
                        form::state(ui, module, pass, item);
                    });
                });
            });
        }
    });
    let safe = questions::safe_values(module);
    let text = match tripped {
        Some(true) => format!(
            "The relays hold their safe values{safe}. Commands are refused and sensors switch nothing until the \
             watchdog is cleared."
        ),
        _ => format!(
            "At a trip the relays go to their safe values{safe}. Commands are refused and sensors switch nothing then, \
             until the watchdog is cleared."
        ),
    };
    widgets::quiet(ui, &text);
}

/// Safe values, whatever else stands on the tab, and its other actions.
fn outputs(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let items = tabs::items(module, "wdt");
    let others = items.iter().map(|item| item.id.as_str()).filter(|id| !PLACED.contains(id));
    let others: Vec<&str> = others.collect();
    if !others.is_empty() {
        form::heading(ui, "Values of the outputs at a trip");
        form::rows(ui, module, pass, others);
    }
    let placed = |id: &str| exists(module) && matches!(id, "clear_watchdog" | crate::bench::HOST_OK);
    let others: Vec<&str> =
        tabs::actions(module, "wdt").iter().map(|action| action.id.as_str()).filter(|id| !placed(id)).collect();
    if !others.is_empty() {
        ui.add_space(theme::GAP);
        ui.horizontal_wrapped(|ui| others.into_iter().for_each(|id| form::action(ui, module, pass, id)));
    }
}
