//! A tab as its definition alone makes it: readings in large digits, their history, settings, actions.

use eframe::egui::Ui;

use super::live_plot::LivePlot;
use super::series::series_of;
use super::{form, readings, tabs};
use crate::bench::Module;
use crate::module::Item;
use crate::ui::app::Pass;
use crate::ui::theme;

pub fn show(ui: &mut Ui, tab: &str, module: &Module, pass: &mut Pass<'_>, plot: &mut LivePlot) {
    let series: Vec<_> = series_of(pass.bench.history(), module, pass.settings.temperature)
        .into_iter()
        .filter(|series| series.item.tab == tab)
        .collect();
    if !series.is_empty() {
        readings::show(ui, module, &series, pass.bench.now());
        ui.add_space(theme::GAP);
        plot.show(ui, module, &series, pass.settings, pass.bench.now(), theme::PLOT_HEIGHT);
    }
    let settings = |item: &&&Item| !item.live;
    let ids: Vec<&str> = tabs::items(module, tab).iter().filter(settings).map(|item| item.id.as_str()).collect();
    if !ids.is_empty() {
        form::heading(ui, "Settings");
        form::rows(ui, module, pass, ids);
    }
    actions(ui, tab, module, pass);
}

/// The actions of a tab, side by side.
pub fn actions(ui: &mut Ui, tab: &str, module: &Module, pass: &mut Pass<'_>) {
    actions_but(ui, tab, module, pass, |_| false);
}

/// Those that do not stand elsewhere in the tab already.
pub fn actions_but(ui: &mut Ui, tab: &str, module: &Module, pass: &mut Pass<'_>, elsewhere: impl Fn(&str) -> bool) {
    let all = tabs::actions(module, tab).into_iter().map(|action| action.id.as_str());
    let ids: Vec<&str> = all.filter(|id| !elsewhere(id)).collect();
    if ids.is_empty() {
        return;
    }
    ui.add_space(theme::GAP);
    ui.horizontal_wrapped(|ui| {
        for id in ids {
            form::action(ui, module, pass, id);
        }
    });
}
