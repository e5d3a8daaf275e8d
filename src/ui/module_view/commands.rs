//! Commands: what is sent and answered as it is.

use eframe::egui::Ui;

use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Commands {}

impl Commands {
    pub fn show(&mut self, _ui: &mut Ui, _module: &Module, _pass: &mut Pass<'_>) {}
}
