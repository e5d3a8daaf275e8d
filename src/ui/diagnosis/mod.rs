//! What is wrong with the line: its modules at the left, what is known of the chosen one at the right, what to do first.

mod charts;
mod details;
mod file;
mod stations;

use eframe::egui::{Align, Button, Layout, Panel, ScrollArea, Ui};

use super::app::Pass;
use super::saving::SaveAs;
use super::theme::Palette;
use super::widgets::Glyph;
use super::{theme, widgets, words};
use crate::bus::Target;
use crate::diagnosis::{Report, Severity};
use file::BundleFile;

/// What the view remembers between frames.
#[derive(Default)]
pub struct DiagnosisView {
    /// The module that is looked at; `None` is the line.
    chosen: Option<Target>,
}

impl DiagnosisView {
    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>) {
        if pass.bench.diagnosis().is_empty() {
            return nothing(ui);
        }
        let report = pass.bench.diagnosis_report();
        if self.chosen.is_some_and(|target| report.modules.iter().all(|module| module.target != target)) {
            self.chosen = None;
        }
        head(ui, &report, pass);
        ui.add_space(theme::UNIT);
        Panel::left("stations")
            .frame(theme::beside_frame())
            .resizable(true)
            .default_size(theme::STATIONS)
            .size_range(theme::STATIONS_RANGE)
            .show(ui, |ui| stations::show(ui, &report, &mut self.chosen));
        ScrollArea::vertical().id_salt(self.chosen).auto_shrink(false).show(ui, |ui| {
            theme::behind_list_frame().show(ui, |ui| {
                match report.modules.iter().find(|module| Some(module.target) == self.chosen) {
                    Some(module) => details::module(ui, module, pass),
                    None => details::line(ui, &report, pass),
                }
            });
        });
    }
}

/// Everything in one sentence, and the way to ask others.
fn head(ui: &mut Ui, report: &Report, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        let (glyph, colour) = mark(report.worst().filter(|_| report.is_wrong()), palette);
        widgets::glyph(ui, glyph, colour);
        ui.label(report.conclusion());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let why = "One zip for asking others for help: report, versions, settings, ports and the last traffic. The \
                       traffic holds what was sent, possibly Wi-Fi keys";
            if ui.add(Button::new("Save bundle…")).on_hover_text(why).clicked() {
                *pass.save = Some(SaveAs {
                    title: "Save diagnostic bundle".to_owned(),
                    name: format!("dcon-bench-{}.zip", words::for_file(pass.bench.now())),
                    contents: Box::new(BundleFile::new(pass.bench)),
                });
            }
        });
    });
}

/// How bad it is: a shape and a colour.
fn mark(severity: Option<Severity>, palette: &Palette) -> (Glyph, eframe::egui::Color32) {
    match severity {
        None => (Glyph::Tick, palette.ok),
        Some(Severity::Note) => (Glyph::Ring, palette.quiet),
        Some(Severity::Warning) => (Glyph::Triangle, palette.warning),
        Some(Severity::Fault) => (Glyph::Cross, palette.error),
    }
}

fn nothing(ui: &mut Ui) {
    let palette = theme::palette(ui);
    let lines = [
        "Answer times, errors, echo and noise of every module appear here as soon as something passes the line, with the \
         likely cause of what is wrong and the next step.",
        "Scan the line, or open a module to poll it.",
    ];
    widgets::empty_state(ui, palette, "Nothing to diagnose yet", &lines);
}
