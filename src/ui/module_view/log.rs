//! Log: what happened to the module, and what was said to it.

use eframe::egui::Ui;

use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Log {}

impl Log {
    pub fn show(&mut self, _ui: &mut Ui, _module: &Module, _pass: &mut Pass<'_>) {}
}
