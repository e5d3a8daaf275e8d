//! The trends: any series of any modules on one axis of time, live or of a recording, and what happened meanwhile.

mod events;
pub mod export;
mod source;

use eframe::egui::Ui;

use super::app::Pass;
use super::{theme, widgets};
use events::EventList;
pub use source::Source;

/// What a trend view remembers between frames.
#[derive(Default)]
pub struct TrendView {
    events: EventList,
    /// The user wants to export readings.
    export: bool,
}

impl TrendView {
    pub fn show(&mut self, ui: &mut Ui, source: &Source<'_>, pass: &mut Pass<'_>) {
        let view = source.span().unwrap_or_default();
        if std::mem::take(&mut self.export) {
            let view = source.span();
            export::ask(source, export::InPlots { view, ..Default::default() }, pass);
        }
        self.events.show(ui, source, view, pass);
    }
}

impl TrendView {
    /// Asks in the next frame what of the readings is to be exported.
    pub fn ask_to_export(&mut self) {
        self.export = true;
    }
}

/// In place of a recording that cannot be shown.
pub fn not_there(ui: &mut Ui, lines: &[String]) {
    let palette = theme::palette(ui);
    let (heading, rest) = lines.split_first().map_or(("", lines), |(heading, rest)| (heading.as_str(), rest));
    let rest: Vec<&str> = rest.iter().map(String::as_str).collect();
    widgets::empty_state(ui, palette, heading, &rest);
}
