//! Every frame of the line.

use eframe::egui::Ui;

use super::app::Pass;

/// What the traffic view remembers between frames.
#[derive(Default)]
pub struct TrafficView {}

impl TrafficView {
    pub fn show(&mut self, _ui: &mut Ui, _pass: &mut Pass<'_>) {}
}
