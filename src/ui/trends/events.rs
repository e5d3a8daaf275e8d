//! What happened: a list that can be searched, linked with the plots.

use eframe::egui::Ui;

use super::Source;
use crate::ui::app::Pass;

/// What the list remembers between frames.
#[derive(Default)]
pub struct EventList {}

impl EventList {
    /// Shows the list; `view` is the span that the plots show. Returns the time that the user wants to see, in seconds since
    /// 1970 UTC.
    pub fn show(&mut self, _ui: &mut Ui, _source: &Source<'_>, _view: [f64; 2], _pass: &mut Pass<'_>) -> Option<f64> {
        None
    }
}
