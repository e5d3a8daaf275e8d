//! Every frame of the line.

use eframe::egui::{Panel, Ui};

use super::app::Pass;
use super::saving::SaveAs;
use super::tables::{
    self, Act, Asked, CaptureFile, Column, Follower, Form, FramesFile, Line, Scroll, Selection, Sheet, Table, Wanted,
    meaning,
};
use super::{theme, widgets, words};
use crate::bench::traffic::{FrameFilter, FrameRef};
use crate::bench::{Action, Bench};
use crate::bus::{Direction, Target};
use crate::capture;

const DIRECTIONS: [(&str, Option<Direction>); 3] =
    [("Both ways", None), ("Sent", Some(Direction::Sent)), ("Received", Some(Direction::Received))];
const ALL_MODULES: &str = "All addresses";

/// What the traffic view remembers between frames.
#[derive(Default)]
pub struct TrafficView {
    filter: FrameFilter,
    frames: Follower,
    scroll: Scroll,
    selection: Selection,
}

impl TrafficView {
    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>) {
        self.frames.notice_modules(pass.bench);
        let is_done = self.frames.advance(pass.bench, self.scroll.paused);
        self.controls(ui, pass);
        self.filter_row(ui, pass.bench);
        let is_new = self.frames.set_filter(self.filter.clone());
        if is_new || !is_done {
            ui.ctx().request_repaint();
        }
        ui.add_space(theme::UNIT);
        Panel::bottom("frame details")
            .frame(theme::details_frame())
            .resizable(true)
            .default_size(theme::DETAILS)
            .size_range(theme::details_range(ui.available_height()))
            .show(ui, |ui| self.details(ui, pass.bench));
        if pass.bench.traffic().is_empty() {
            return nothing(ui);
        }
        match self.table(ui, pass.bench) {
            Some(Act::CopyChosen) => self.copy(ui, pass.bench, false),
            Some(Act::CopyAll) => self.copy(ui, pass.bench, true),
            None => {}
        }
    }

    fn controls(&mut self, ui: &mut Ui, pass: &mut Pass<'_>) {
        ui.horizontal(|ui| {
            let has_choice = self.selection.current().is_some();
            match tables::controls(ui, &mut self.scroll, has_choice, &[Wanted::Frames]) {
                Some(Asked::CopyChosen) => self.copy(ui, pass.bench, false),
                Some(Asked::CopyAll) => self.copy(ui, pass.bench, true),
                Some(Asked::Export(_, form)) => *pass.save = Some(self.export(pass.bench, form)),
                Some(Asked::Capture(form)) => *pass.save = Some(self.capture(pass.bench, form)),
                None => {}
            }
            if ui.button("Clear").on_hover_text("Forget all frames so far").clicked() {
                pass.actions.push(Action::ClearTraffic);
                self.selection.clear();
            }
            tables::count(ui, self.frames.view().len(), pass.bench.traffic().len(), "frame");
        });
    }

    fn filter_row(&mut self, ui: &mut Ui, bench: &Bench) {
        ui.horizontal_wrapped(|ui| {
            tables::search(ui, &mut self.filter.text, "Search bytes, text, meaning");
            let chosen = DIRECTIONS.iter().find(|(_, way)| *way == self.filter.direction).map_or("", |(name, _)| name);
            let combo = widgets::combo("direction", theme::FORM_BUTTONS, chosen).show_ui(ui, |ui| {
                for (name, way) in DIRECTIONS {
                    ui.selectable_value(&mut self.filter.direction, way, name);
                }
            });
            widgets::name_combo(&combo.response, "Direction", chosen);
            combo.response.on_hover_text("Only frames to modules, or only those from them");
            self.module_choice(ui, bench);
            if widgets::chip(ui, self.filter.only_errors, "Only errors", "Only errors", meaning::ONLY_ERRORS) {
                self.filter.only_errors = !self.filter.only_errors;
            }
            let clear = eframe::egui::Button::new("Clear filter");
            if ui.add_enabled(!self.filter.is_empty(), clear).on_hover_text("Shows all frames again").clicked() {
                self.filter = FrameFilter::default();
            }
        });
    }

    fn module_choice(&mut self, ui: &mut Ui, bench: &Bench) {
        let name = |target: &Target| {
            let label = bench.module(target).map_or("Module", |module| module.label());
            format!("{label} @{}", target.address)
        };
        let key = |target: &Target| Some((target.address, target.protocol));
        let modules = || bench.modules().iter().map(|module| &module.target);
        let chosen = match self.filter.module {
            None => ALL_MODULES.to_owned(),
            Some((address, _)) => modules()
                .find(|target| key(target) == self.filter.module)
                .map_or_else(|| format!("Address {address}"), name),
        };
        let combo = widgets::combo("module", theme::CHOICE_WIDTH, &chosen).show_ui(ui, |ui| {
            ui.selectable_value(&mut self.filter.module, None, ALL_MODULES);
            for target in modules() {
                ui.selectable_value(&mut self.filter.module, key(target), name(target));
            }
        });
        widgets::name_combo(&combo.response, "Module", &chosen);
        combo.response.on_hover_text("Only frames to this module and from it");
    }

    fn table(&mut self, ui: &mut Ui, bench: &Bench) -> Option<Act> {
        let columns = columns(ui.available_width());
        let palette = theme::palette(ui);
        let view = self.frames.view();
        let explain =
            |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
        let line = |row: usize| {
            let frame = bench.traffic().get(view.seq(row)?)?;
            let request = bench.traffic().request_of(frame.seq);
            let cells = tables::frame_look(&frame, request.as_ref(), &explain, palette).into();
            Some(Line { key: frame.seq, cells })
        };
        let table = Table { name: "Frames", columns: &columns, rows: view.len() };
        table.show(ui, &mut self.scroll, &mut self.selection, &|row| view.seq(row), &line)
    }

    fn details(&self, ui: &mut Ui, bench: &Bench) {
        ui.set_min_size(ui.available_size());
        match self.selection.current() {
            Some(seq) => tables::frame_details(ui, bench, seq),
            None => drop(widgets::quiet(ui, "Click a frame to see its fields, one by one.")),
        }
    }

    fn copy(&self, ui: &Ui, bench: &Bench, all: bool) {
        let view = self.frames.view();
        let range = if all { Some((0, u64::MAX)) } else { self.selection.range() };
        let Some((first, last)) = range else { return };
        let rows = (view.row_of(first)..view.len()).map_while(|row| view.seq(row).filter(|seq| *seq <= last));
        let mut sheet = Sheet::new(tables::FRAME_HEADER);
        rows.take(tables::MOST_COPIED).filter_map(|seq| tables::frame_row(bench, seq)).for_each(|row| sheet.push(row));
        sheet.copy(ui.ctx());
    }

    fn export(&self, bench: &Bench, form: Form) -> SaveAs {
        SaveAs {
            title: "Export traffic".to_owned(),
            name: format!("traffic-{}.{}", words::for_file(bench.now()), form.ending()),
            contents: Box::new(FramesFile::new(form, self.frames.view().seqs())),
        }
    }

    fn capture(&self, bench: &Bench, form: capture::Form) -> SaveAs {
        SaveAs {
            title: "Export traffic".to_owned(),
            name: format!("traffic-{}.{}", words::for_file(bench.now()), form.ending()),
            contents: Box::new(CaptureFile::new(form, self.frames.view().seqs())),
        }
    }
}

fn columns(width: f32) -> [Column; 7] {
    let fixed = theme::TIME_COLUMN
        + theme::DIRECTION_COLUMN
        + theme::ADDRESS_COLUMN
        + theme::TOOK_COLUMN
        + theme::STATE_COLUMN
        + 7.0 * theme::GAP;
    [
        Column::new("Time", meaning::TIME, theme::TIME_COLUMN),
        Column::new("Direction", meaning::DIRECTION, theme::DIRECTION_COLUMN),
        Column::number("Address", meaning::ADDRESS, theme::ADDRESS_COLUMN),
        Column::new("Bytes", meaning::BYTES, theme::bytes_width(width - fixed)),
        Column::rest("Meaning", meaning::MEANING),
        Column::number("Took", meaning::TOOK, theme::TOOK_COLUMN),
        Column::new("State", meaning::STATE, theme::STATE_COLUMN),
    ]
}

fn nothing(ui: &mut Ui) {
    let palette = theme::palette(ui);
    let lines = [
        "Every frame that is sent or received on the line appears here, with its time, bytes and meaning.",
        "Scan the line, or open a module to poll it.",
    ];
    widgets::empty_state(ui, palette, "No traffic yet", &lines);
}
