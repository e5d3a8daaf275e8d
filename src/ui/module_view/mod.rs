//! The middle of the window: the module in view.

mod identity;
mod legend;
mod live_plot;
mod number_plot;
mod readings;
mod scene;
mod series;
mod strips;
mod time_axis;
mod unknown;

use eframe::egui::{ScrollArea, Ui};
use jiff::Timestamp;

pub use series::{Freshness, Series, series_of};

use super::app::Pass;
use super::dialogs::Dialogs;
use super::{empty, theme};
use crate::bench::Module;
use identity::Polling;
use live_plot::LivePlot;

/// The inner tabs of a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Tab {
    #[default]
    Live,
}

/// What the view of a module remembers between frames.
#[derive(Default)]
pub struct ModuleView {
    tab: Tab,
    polling: Polling,
    plot: LivePlot,
}

impl ModuleView {
    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>, dialogs: &mut Dialogs) {
        let bench = pass.bench;
        let Some(module) = bench.shown() else { return empty::show(ui, pass) };
        if module.definition().is_none() {
            return unknown::show(ui, module, pass, dialogs);
        }
        identity::show(ui, module, pass, &mut self.polling);
        ui.add_space(theme::GAP);
        match self.tab {
            Tab::Live => self.live(ui, module, pass),
        }
    }

    /// Large readings, and below them their history.
    fn live(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let series = series_of(module, pass.settings.temperature);
        let now = Timestamp::now();
        let room = ui.available_height();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let top = ui.cursor().top();
            readings::show(ui, module, &series, now);
            ui.add_space(theme::GAP);
            let used = ui.cursor().top() - top;
            self.plot.show(ui, module, &series, pass.settings, now, room - used);
        });
    }
}
