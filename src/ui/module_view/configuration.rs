//! Configuration: identity, communication, the picture of the switches, and what needs INIT mode.

use eframe::egui::Ui;

use super::generic;
use super::live_plot::LivePlot;
use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Configuration {
    plot: LivePlot,
}

impl Configuration {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        generic::show(ui, "configuration", module, pass, &mut self.plot);
    }
}
