//! All modules that were found, in one table.

use eframe::egui::Ui;

use super::app::Pass;
use super::empty;

/// What the dashboard remembers between frames.
#[derive(Default)]
pub struct Dashboard {}

impl Dashboard {
    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>) {
        empty::show(ui, pass);
    }
}
