//! What stands in each pane, and on its tab.

use std::collections::BTreeMap;

use eframe::egui::{self, Ui};

use super::{Pane, Wish};
use crate::bench::{Action, Bench, RecordingId};
use crate::bus::Target;
use crate::ui::app::Pass;
use crate::ui::dashboard::Dashboard;
use crate::ui::diagnosis::DiagnosisView;
use crate::ui::dialogs::Dialogs;
use crate::ui::help::{HelpView, about::AboutBox};
use crate::ui::module_view::ModuleView;
use crate::ui::traffic::TrafficView;
use crate::ui::trends::{self, Source, TrendView};
use crate::ui::{theme, widgets, words};

/// What the contents of the panes remember between frames.
#[derive(Default)]
pub struct Views {
    pub modules: BTreeMap<Target, ModuleView>,
    traffic: TrafficView,
    pub trends: TrendView,
    diagnosis: DiagnosisView,
    pub help: HelpView,
    pub about: AboutBox,
    pub recordings: BTreeMap<RecordingId, TrendView>,
    dashboard: Dashboard,
}

/// What stands on the tab.
pub fn title(bench: &Bench, pane: Pane) -> String {
    match pane {
        Pane::Dashboard => "Dashboard".to_owned(),
        Pane::Traffic => "Traffic".to_owned(),
        Pane::Trends => "Trends".to_owned(),
        Pane::Diagnosis => "Diagnosis".to_owned(),
        Pane::Help => "Help".to_owned(),
        Pane::Recording(id) => {
            let name = bench.opened_recording(id).and_then(|viewer| viewer.path().file_stem());
            name.map_or_else(|| "Recording".to_owned(), |name| name.to_string_lossy().into_owned())
        }
        Pane::Module(target) => {
            let label = bench.module(&target).map_or("Module", |module| module.label());
            format!("{label} @{}", target.address)
        }
    }
}

impl Views {
    pub fn show(
        &mut self,
        ui: &mut Ui,
        pane: Pane,
        pass: &mut Pass<'_>,
        dialogs: &mut Dialogs,
        wishes: &mut Vec<Wish>,
    ) {
        match pane {
            Pane::Dashboard => self.dashboard.show(ui, pass),
            Pane::Traffic => self.traffic.show(ui, pass),
            Pane::Trends => self.trends.show(ui, &Source::live(pass.bench), pass),
            Pane::Diagnosis => self.diagnosis.show(ui, pass),
            Pane::Help => self.help.show(ui, pass, wishes),
            Pane::Recording(id) => match Source::recording(pass.bench, id) {
                Ok(source) => self.recordings.entry(id).or_default().show(ui, &source, pass),
                Err(lines) => trends::not_there(ui, &lines),
            },
            Pane::Module(target) => match pass.bench.module(&target) {
                Some(module) => self.modules.entry(target).or_default().show(ui, module, pass, dialogs),
                None => absent(ui, target, pass, wishes),
            },
        }
    }
}

/// A module that was open when the program was used last, and is not found yet.
fn absent(ui: &mut Ui, target: Target, pass: &mut Pass<'_>, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    let place = format!("Address {}, {}", words::address(target.address), words::spoken(&target));
    let lines = [place.as_str(), "It shows here as soon as it is found: by a scan, or by asking there."];
    widgets::empty_state(ui, palette, "Not found on this line yet", &lines);
    ui.horizontal(|ui| {
        let obstacle = pass.bench.line().obstacle();
        let ask = ui.add_enabled(obstacle.is_none(), egui::Button::new("Ask there"));
        let ask = ask.on_hover_text("Asks this address whether a module is there");
        if ask.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
            pass.actions.push(Action::LookFor(target));
        }
        if ui.button("Close").on_hover_text("Closes this tab").clicked() {
            wishes.push(Wish::Close(Pane::Module(target)));
        }
    });
}
