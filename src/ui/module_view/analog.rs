//! AI: measured values with their latches, the high temperature alarm, their history, offsets.
//!
//! In the order of what an engineer looks for: digits, alarm, plot, settings. The plot takes the room that the window
//! has left; in a low window the settings are scrolled to.

mod alarm;
mod calibration;
mod channels;
mod latches;

use eframe::egui::Ui;

use super::live_plot::LivePlot;
use super::series::{Series, series_of};
use super::{form, generic, tabs};
use crate::bench::{Bench, Module};
use crate::module::Item;
use crate::ui::app::Pass;
use crate::ui::settings::TemperatureUnit;
use crate::ui::theme;
use calibration::Calibration;
use latches::{Extreme, Refresh};

/// The tab in definitions.
const TAB: &str = "ai";

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Analog {
    plot: LivePlot,
    latches: Refresh,
    calibration: Calibration,
    /// Height of the settings when they were drawn last.
    settings_height: Option<f32>,
}

impl Analog {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let series = of_tab(pass.bench, module, pass.settings.temperature);
        let twins = of_tab(pass.bench, module, other(pass.settings.temperature));
        let (numbers, switches): (Vec<&Series<'_>>, Vec<&Series<'_>>) = series.iter().partition(|one| one.is_number());
        let room = ui.available_height();
        let top = ui.cursor().top();

        if !numbers.is_empty() {
            let latches = numbers.iter().flat_map(|one| Extreme::ALL.map(|extreme| extreme.item(module, &one.item.id)));
            self.latches.run(module, latches.flatten().map(|item| item.id.clone()).collect(), pass);
            channels::show(ui, module, &numbers, &twins, pass);
        }
        alarm::show(ui, module, &switches, pass);
        if !numbers.is_empty() {
            ui.add_space(theme::GAP);
            let left = room - (ui.cursor().top() - top) - self.settings_height.unwrap_or(room) - theme::GAP;
            let height = left.max(theme::PLOT_HEIGHT).floor();
            self.plot.show(ui, module, &series, pass.settings, pass.bench.now(), height);
        }
        let height = ui.scope(|ui| self.settings(ui, module, pass)).response.rect.height();
        if self.settings_height != Some(height) {
            self.settings_height = Some(height);
            ui.ctx().request_repaint();
        }
    }

    fn settings(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let items = tabs::items(module, TAB);
        let plain = |item: &&Item| !item.live && !latches::is_latch(module, item);
        let (offsets, others): (Vec<&Item>, Vec<&Item>) =
            items.into_iter().filter(plain).partition(|item| calibration::measured(pass.bench, module, item).is_some());
        let (alarm, others): (Vec<&Item>, Vec<&Item>) = others.into_iter().partition(|item| alarm::is_setting(item));
        if ui.available_width() >= 2.0 * theme::FORM_COLUMN && !offsets.is_empty() && !alarm.is_empty() {
            ui.columns(2, |columns| {
                if let [left, right] = columns {
                    self.offsets(left, module, pass, &offsets);
                    group(right, module, pass, alarm::HEADING, &alarm);
                }
            });
        } else {
            self.offsets(ui, module, pass, &offsets);
            group(ui, module, pass, alarm::HEADING, &alarm);
        }
        group(ui, module, pass, "Settings", &others);
        let known = |id: &str| alarm::is_action(id) || latches::is_action(id);
        generic::actions_but(ui, TAB, module, pass, known);
    }

    fn offsets(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, offsets: &[&Item]) {
        if offsets.is_empty() {
            return;
        }
        form::heading(ui, "Offsets");
        for item in offsets {
            form::row(ui, module, pass, &item.id);
            self.calibration.row(ui, module, pass, item);
        }
    }
}

fn group(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, heading: &str, items: &[&Item]) {
    if !items.is_empty() {
        form::heading(ui, heading);
        form::rows(ui, module, pass, items.iter().map(|item| item.id.as_str()));
    }
}

fn of_tab<'a>(bench: &'a Bench, module: &'a Module, unit: TemperatureUnit) -> Vec<Series<'a>> {
    series_of(bench.history(), module, unit).into_iter().filter(|series| series.item.tab == TAB).collect()
}

fn other(unit: TemperatureUnit) -> TemperatureUnit {
    match unit {
        TemperatureUnit::Celsius => TemperatureUnit::Fahrenheit,
        TemperatureUnit::Fahrenheit => TemperatureUnit::Celsius,
    }
}
