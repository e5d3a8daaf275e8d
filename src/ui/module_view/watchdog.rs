//! Host WDT: the host watchdog and the Host OK that keeps it quiet.

use eframe::egui::Ui;

use super::generic;
use super::live_plot::LivePlot;
use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Watchdog {
    plot: LivePlot,
}

impl Watchdog {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        generic::show(ui, "wdt", module, pass, &mut self.plot);
    }
}
