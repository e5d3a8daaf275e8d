//! The time that is left until the watchdog trips.

use std::time::Duration;

use eframe::egui::{Align, Color32, Ui};
use jiff::Timestamp;

use super::{has_tripped, questions};
use crate::bench::Module;
use crate::ui::theme;
use crate::ui::widgets;

/// How often the time is written anew while it runs.
const EVERY: Duration = Duration::from_millis(100);

/// When the watchdog trips, which is still known after Host OK was stopped.
#[derive(Default)]
pub struct Countdown {
    trips_at: Option<Timestamp>,
}

impl Countdown {
    /// A bar and words; the room is always kept.
    pub fn show(&mut self, ui: &mut Ui, module: &Module, now: Timestamp) {
        let palette = theme::palette(ui);
        if let Some(at) = module.trips_at() {
            self.trips_at = Some(at);
        } else if !module.watchdog_counts() || has_tripped(module) {
            self.trips_at = None;
        }
        let timeout = module.watchdog_timeout().unwrap_or_default();
        let left = self.trips_at.map(|at| Duration::try_from(at.duration_since(now)).unwrap_or_default());
        // A simulated line may be ahead of the clock.
        let left = left.map(|left| left.min(timeout)).filter(|_| module.watchdog_counts() && !has_tripped(module));
        let part = match left {
            Some(left) if !timeout.is_zero() => left.as_secs_f32() / timeout.as_secs_f32(),
            _ => 0.0,
        };
        ui.horizontal(|ui| {
            widgets::progress(ui, part, "Time until the watchdog trips").on_hover_text(TRIPS);
            let (text, colour): (String, Color32) = match left {
                Some(left) if !left.is_zero() => (format!("trips in {:.1} s", left.as_secs_f64()), palette.text),
                Some(_) => ("the time is over: waiting for what the module says".to_owned(), palette.warning),
                None => (standing(module), palette.quiet),
            };
            let width = ui.available_width().min(2.0 * theme::COUNTDOWN_TEXT);
            widgets::fixed_coloured(ui, width, Align::Min, &text, colour).on_hover_text(TRIPS);
        });
        if left.is_some_and(|left| !left.is_zero()) {
            ui.ctx().request_repaint_after(EVERY);
        }
    }
}

const TRIPS: &str =
    "Without a Host OK for this long the watchdog trips, and the module sets its outputs to their safe values";

/// What is to be said while no time runs.
fn standing(module: &Module) -> String {
    if has_tripped(module) {
        return "has tripped".to_owned();
    }
    match module.known("wdt_enabled").and_then(crate::module::Value::as_bool) {
        None => "not known whether the watchdog is enabled".to_owned(),
        Some(false) => "the watchdog is not enabled".to_owned(),
        Some(true) => {
            let after = module.watchdog_timeout().map_or_else(|| "its timeout".to_owned(), questions::seconds);
            format!("enabled: trips {after} after the last Host OK that it heard, none is sent from here")
        }
    }
}
