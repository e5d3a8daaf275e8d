//! The host watchdog in the header of every tab: that it counts, what keeps it quiet, and that it has tripped.

use eframe::egui::{Align, Color32, Role, Sense, Ui, WidgetInfo, vec2};

use super::watchdog;
use crate::bench::{Action, HOST_OK, Module};
use crate::module::Value;
use crate::ui::app::Pass;
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

/// What the header has to know of the watchdog, whichever tab is shown.
pub const ITEMS: [&str; 2] = ["wdt_enabled", "wdt_timeout"];

/// What the indicator remembers between frames.
#[derive(Default)]
pub struct Indicator {
    tripped: Option<bool>,
}

/// The room that it takes in the header: none for a module without a watchdog.
pub fn width(module: &Module) -> f32 {
    let sends = module.definition().and_then(|definition| definition.action(HOST_OK));
    let sends = sends.is_some_and(|action| action.is_offered(module.target.protocol));
    if sends || watchdog::exists(module) { theme::INDICATOR } else { 0.0 }
}

/// Whether there is something to say of the watchdog.
pub fn speaks(module: &Module) -> bool {
    watchdog::has_tripped(module) || module.host_ok.is_some() || module.watchdog_counts()
}

/// Fills its room from the right.
pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let width = width(module).min(ui.available_width());
    if width <= 0.0 {
        return;
    }
    let (room, _) = ui.allocate_exact_size(vec2(width, theme::CONTROL_HEIGHT), Sense::hover());
    let layout = eframe::egui::Layout::right_to_left(Align::Center);
    let mut ui = ui.new_child(eframe::egui::UiBuilder::new().max_rect(room).layout(layout));
    ui.spacing_mut().item_spacing.x = theme::GAP;
    contents(&mut ui, module, pass);
}

impl Indicator {
    /// A trip changes more than it says: whether the watchdog is still enabled is read again.
    pub fn look_after_a_trip(&mut self, module: &Module, pass: &mut Pass<'_>) {
        let Some(now) = module.known("wdt_tripped").and_then(Value::as_bool) else { return };
        if self.tripped.replace(now).is_some_and(|before| before != now) {
            let there = |id: &&str| module.item(id).is_some_and(|item| module.has(item));
            let ids = ["wdt_enabled", "wdt_timeout_count"].into_iter().filter(there).map(str::to_owned);
            pass.actions.push(Action::Read(module.target, ids.collect()));
        }
    }
}

fn contents(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    if watchdog::has_tripped(module) {
        let known = module.definition().and_then(|definition| definition.action("clear_watchdog"));
        if known.is_some_and(|action| action.is_offered(module.target.protocol)) {
            let help = "Clears the watchdog, so that the relays can be switched again";
            let busy = module.is_acting("clear_watchdog").then_some("It is being carried out");
            let barred = pass.bench.line().obstacle().or(busy);
            if button(ui, "Clear", "Clear tripped watchdog", help, barred) {
                pass.actions.push(Action::Act(module.target, "clear_watchdog".to_owned()));
            }
        }
        return said(ui, Glyph::Triangle, palette.alarm, "Watchdog tripped");
    }
    let timeout = module.watchdog_timeout().map(watchdog::seconds).unwrap_or_default();
    let counting = format!("Watchdog {timeout}");
    match (&module.host_ok, module.watchdog_counts()) {
        (None, false) => {}
        (None, true) => {
            let text = format!("{}, no Host OK from here", counting.trim_end());
            said(ui, Glyph::Outline, palette.warning, &text);
        }
        (Some(host_ok), counts) => {
            if button(ui, "Stop", "Stop Host OK", "Stops sending Host OK", None) {
                watchdog::stop(module, pass);
            }
            let sent = watchdog::period_words(host_ok);
            let text = if counts { format!("{}, {sent}", counting.trim_end()) } else { sent };
            match &host_ok.problem {
                Some(problem) => said(ui, Glyph::Cross, palette.error, &format!("Host OK not sent: {problem}")),
                None => said(ui, Glyph::Disc, palette.ok, &text),
            }
        }
    }
}

fn button(ui: &mut Ui, text: &str, name: &str, help: &str, barred: Option<&str>) -> bool {
    let enabled = barred.is_none();
    let response = ui.add_enabled(enabled, eframe::egui::Button::new(text)).on_hover_text(help);
    let response = response.on_disabled_hover_text(barred.unwrap_or_default());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    response.clicked()
}

/// From the right: the words, then their mark.
fn said(ui: &mut Ui, glyph: Glyph, colour: Color32, text: &str) {
    let galley = widgets::cut(ui, text, theme::body(), colour, theme::INDICATOR_TEXT);
    widgets::fixed_coloured(ui, galley.size().x.ceil() + theme::HAIRLINE, Align::Max, text, colour).on_hover_text(text);
    widgets::glyph(ui, glyph, colour);
}
