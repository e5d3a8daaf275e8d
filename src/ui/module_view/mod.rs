//! One module: who it is, its tabs, and the changes that wait to be written.

mod analog;
mod commands;
mod configuration;
mod edits_bar;
mod explanation;
mod form;
mod generic;
mod identity;
mod indicator;
mod item_sheet;
mod legend;
mod limit_line;
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
pub mod temperature;
mod time_axis;
mod unknown;
mod watchdog;

use std::collections::BTreeSet;

use eframe::egui::{Align, Layout, ScrollArea, Ui, vec2};

pub use edits_bar::WRITE_ALL;
pub use series::{Family, Freshness, Series, series_of};

use super::app::Pass;
use super::dialogs::Dialogs;
use super::settings::Settings;
use super::theme;
use crate::bench::{Action, DEFAULT_INTERVAL, LineState, Module, Presence};
use crate::bus::RequestId;
use analog::Analog;
use commands::Commands;
use configuration::Configuration;
use identity::Header;
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
    shown: Option<(RequestId, Tab)>,
    asked: BTreeSet<String>,
    header: Header,
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
        if ui.available_height() >= theme::MODULE_LOW {
            return self.known(ui, module, pass);
        }
        ScrollArea::vertical().id_salt("low").auto_shrink(false).show(ui, |ui| {
            let size = vec2(ui.available_width(), theme::MODULE_LOW);
            ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| self.known(ui, module, pass));
        });
    }

    /// A module of a known model.
    fn known(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let asks = self.shown.as_ref().map(|(_, tab)| tabs::to_read(module, tab)).unwrap_or_default();
        identity::show(ui, module, pass, &mut self.header, asks);
        ui.add_space(theme::UNIT);
        let tab = tabs::show(ui, module, pass.settings);
        self.read_what_it_shows(&tab, module, pass);
        ui.add_space(theme::GAP);
        let room = (ui.available_height() - edits_bar::HEIGHT - theme::UNIT).max(0.0);
        ui.scope(|ui| {
            ui.set_height(room);
            if ui.available_width() >= theme::MODULE_LEAST {
                return self.contents(ui, &tab, module, pass);
            }
            // Who it is and what waits to be written stays in view.
            ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
                ui.set_width(theme::MODULE_LEAST);
                self.contents(ui, &tab, module, pass);
            });
        });
        edits_bar::show(ui, module, pass);
    }

    /// Asks again for what the tab shows when it is drawn next.
    pub fn read_again(&mut self) {
        self.asked.clear();
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
    fn read_what_it_shows(&mut self, tab: &Tab, module: &Module, pass: &mut Pass<'_>) {
        if matches!(pass.bench.line(), LineState::Closed) {
            return;
        }
        let shown = Some((module.found_by, tab.clone()));
        if self.shown != shown {
            // A module that is open is polled, also when it was opened before it was found.
            let is_new = self.shown.as_ref().is_none_or(|(found_by, _)| *found_by != module.found_by);
            if is_new && module.interval.is_none() && module.presence == Presence::Found {
                pass.actions.push(Action::SetInterval(module.target, DEFAULT_INTERVAL));
            }
            self.shown = shown;
            self.asked.clear();
        }
        let mut ids = tabs::to_read(module, tab);
        ids.extend(self.header_items(module));
        ids.extend(configuration::also_read(module, tab));
        ids.retain(|id| self.asked.insert(id.clone()));
        if !ids.is_empty() {
            pass.actions.push(Action::Read(module.target, ids));
        }
    }
}

impl ModuleView {
    /// What the header shows on every tab, as far as it is not known yet.
    fn header_items(&self, module: &Module) -> impl Iterator<Item = String> {
        let wanted = |id: &&str| {
            let there = module.item(id).is_some_and(|item| module.has(item));
            there && module.known(id).is_none() && !self.asked.contains(*id)
        };
        indicator::ITEMS.into_iter().filter(wanted).map(str::to_owned).collect::<Vec<_>>().into_iter()
    }
}

/// Writes all changes of the module, after a question where one is due.
pub fn write_all(module: &Module, pass: &mut Pass<'_>) {
    let edited: Vec<String> = module.edited().into_iter().map(str::to_owned).collect();
    form::write(module, pass, &edited);
}

/// Shows the next tab of the module, or the one before; after the last comes the first.
pub fn turn_page(module: &Module, settings: &mut Settings, forward: bool) {
    let tabs = tabs::of(module);
    let shown = tabs::chosen(&tabs, settings);
    let Some(index) = tabs.iter().position(|tab| Some(tab) == shown) else { return };
    let step = if forward { 1 } else { tabs.len().saturating_sub(1) };
    let turned = tabs.iter().cycle().nth(index.saturating_add(step));
    if let Some(tab) = turned {
        tab.key().clone_into(&mut settings.tab);
    }
}

/// The key of the page that is in view; none of an unknown model.
pub fn page_in_view(module: &Module, settings: &Settings) -> Option<String> {
    tabs::chosen(&tabs::of(module), settings).map(|tab| tab.key().to_owned())
}

fn scrolled(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().auto_shrink(false).show(ui, contents);
}
