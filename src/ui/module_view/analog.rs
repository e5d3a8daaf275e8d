//! AI: measured values with their latches, offsets and the high temperature alarm.

use eframe::egui::Ui;

use super::generic;
use super::live_plot::LivePlot;
use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Analog {
    plot: LivePlot,
}

impl Analog {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        generic::show(ui, "ai", module, pass, &mut self.plot);
    }
}
