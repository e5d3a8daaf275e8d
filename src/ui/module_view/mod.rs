//! One module: who it is, its tabs, and the changes that wait to be written.

mod analog;
mod commands;
mod configuration;
mod edits_bar;
mod form;
mod generic;
mod identity;
mod legend;
mod live_plot;
mod log;
mod number_plot;
mod pir;
mod readings;
mod scene;
mod series;
mod strips;
mod summary;
mod tabs;
mod time_axis;
mod unknown;
mod watchdog;

use std::collections::BTreeSet;

use eframe::egui::{ScrollArea, Ui};

pub use series::{Freshness, Series, series_of};

use super::app::Pass;
use super::dialogs::Dialogs;
use super::theme;
use crate::bench::{Action, Module};
use analog::Analog;
use commands::Commands;
use configuration::Configuration;
use identity::Polling;
use live_plot::LivePlot;
use log::Log;
use pir::PirRelay;
use summary::Summary;
use tabs::Tab;
use watchdog::Watchdog;

/// What the view of a module remembers between frames.
#[derive(Default)]
pub struct ModuleView {
    /// The tab that is shown, and what the module was asked for since it came into view.
    shown: Option<Tab>,
    asked: BTreeSet<String>,
    polling: Polling,
    plot: LivePlot,
    configuration: Configuration,
    analog: Analog,
    pir: PirRelay,
    watchdog: Watchdog,
    commands: Commands,
    log: Log,
    summary: Summary,
}

impl ModuleView {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, dialogs: &mut Dialogs) {
        if module.definition().is_none() {
            return unknown::show(ui, module, pass, dialogs);
        }
        identity::show(ui, module, pass, &mut self.polling);
        ui.add_space(theme::UNIT);
        let tab = tabs::show(ui, module, pass.settings);
        self.read_what_it_shows(&tab, module, pass.actions);
        ui.add_space(theme::GAP);
        let room = ui.available_height() - edits_bar::HEIGHT - theme::UNIT;
        ui.scope(|ui| {
            ui.set_height(room);
            self.contents(ui, &tab, module, pass);
        });
        edits_bar::show(ui, module, pass);
    }

    fn contents(&mut self, ui: &mut Ui, tab: &Tab, module: &Module, pass: &mut Pass<'_>) {
        ui.push_id(tab.key(), |ui| match tab {
            Tab::Of(id) => scrolled(ui, |ui| match id.as_str() {
                "configuration" => self.configuration.show(ui, module, pass),
                "ai" => self.analog.show(ui, module, pass),
                "pir" => self.pir.show(ui, module, pass),
                "wdt" => self.watchdog.show(ui, module, pass),
                other => generic::show(ui, other, module, pass, &mut self.plot),
            }),
            Tab::Commands => self.commands.show(ui, module, pass),
            Tab::Log => self.log.show(ui, module, pass),
            Tab::Summary => self.summary.show(ui, module, pass),
        });
    }

    /// A tab that comes into view asks for what it shows, except for what is polled anyway.
    fn read_what_it_shows(&mut self, tab: &Tab, module: &Module, actions: &mut Vec<Action>) {
        if self.shown.as_ref() != Some(tab) {
            self.shown = Some(tab.clone());
            self.asked.clear();
        }
        let mut ids = tabs::to_read(module, tab);
        ids.extend(configuration::also_read(module, tab));
        ids.retain(|id| self.asked.insert(id.clone()));
        if !ids.is_empty() {
            actions.push(Action::Read(module.target, ids));
        }
    }
}

fn scrolled(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().auto_shrink(false).show(ui, contents);
}
