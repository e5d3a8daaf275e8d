//! PIR / Relay: the sensor's face, the relays, and what switches them.

use eframe::egui::Ui;

use super::generic;
use super::live_plot::LivePlot;
use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct PirRelay {
    plot: LivePlot,
}

impl PirRelay {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        generic::show(ui, "pir", module, pass, &mut self.plot);
    }
}
