//! Summary: everything about the module on one page.

use eframe::egui::Ui;

use crate::bench::Module;
use crate::ui::app::Pass;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Summary {}

impl Summary {
    pub fn show(&mut self, _ui: &mut Ui, _module: &Module, _pass: &mut Pass<'_>) {}
}
