//! What the user should know: errors until they are acknowledged, and all notices to look back at.

use std::path::Path;

use eframe::egui::{self, Color32, RichText, ScrollArea, Ui};

use super::app::Pass;
use super::recording::{Recordings, Wish};
use super::theme::{self, Palette};
use super::widgets::{self, Glyph};
use super::words;
use crate::bench::{Action, Bench, Notice, Severity, Topic};

/// Which errors the user has acknowledged.
#[derive(Default)]
pub struct Notices {
    /// All up to this number.
    acknowledged: Option<u64>,
    /// What is said of the line is over up to this number: it was open since.
    line_well: Option<u64>,
    /// While the list is open it shows all up to this number, so that newer ones do not move the others.
    listed: Option<u64>,
}

impl Notices {
    /// Takes note of how the line is.
    pub fn look_at_line(&mut self, bench: &Bench) {
        if bench.line().is_open() {
            let of_line = bench.notices().rev().find(|notice| notice.topic != Topic::Other);
            self.line_well = of_line.map(|notice| notice.number).or(self.line_well);
        }
    }

    /// Errors that still hold and that the user has not acknowledged, newest first. Of the line only the newest is
    /// told: each one replaces those before.
    pub fn waiting<'a>(&self, bench: &'a Bench) -> impl Iterator<Item = &'a Notice> {
        let Self { acknowledged, line_well, .. } = *self;
        let after = |notice: &Notice, until: Option<u64>| until.is_none_or(|until| notice.number > until);
        let mut line_told = false;
        let holds = move |notice: &&Notice| match notice.topic {
            Topic::Other => true,
            topic => !std::mem::replace(&mut line_told, true) && topic.holds(bench.line()) && after(notice, line_well),
        };
        let errors = bench.notices().rev().filter(|notice| notice.severity == Severity::Error);
        errors.filter(holds).filter(move |notice| after(notice, acknowledged))
    }
}

fn mark(severity: Severity, palette: &Palette) -> (Glyph, Color32) {
    match severity {
        Severity::Info => (Glyph::Ring, palette.quiet),
        Severity::Warning => (Glyph::Outline, palette.warning),
        Severity::Error => (Glyph::Triangle, palette.error),
    }
}

fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Info => "Note",
        Severity::Warning => "Warning",
        Severity::Error => "Error",
    }
}

/// The newest error, above the status bar, until it is acknowledged.
pub fn strip(ui: &mut Ui, bench: &Bench, notices: &mut Notices) {
    let palette = theme::palette(ui);
    let mut waiting = notices.waiting(bench);
    let Some(newest) = waiting.next() else { return };
    let (number, more) = (newest.number, waiting.count());
    ui.horizontal(|ui| {
        widgets::glyph(ui, Glyph::Triangle, palette.error);
        widgets::at_right(ui, |ui| {
            let text = if more == 0 { "Dismiss".to_owned() } else { format!("Dismiss {}", more + 1) };
            if ui.button(text).on_hover_text("Takes it away here; the list of notices keeps it").clicked() {
                notices.acknowledged = Some(number);
            }
            if ui.button("Copy").on_hover_text("Copies this text").clicked() {
                ui.ctx().copy_text(newest.text.clone());
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(&newest.text).color(palette.text)).wrap());
            });
        });
    });
}

/// The newest notice, in the status bar, unless it stands in the strip above; a click shows them all.
pub fn newest(ui: &mut Ui, pass: &mut Pass<'_>, notices: &mut Notices) {
    let palette = theme::palette(ui);
    let Some(notice) = pass.bench.notices().next_back() else {
        widgets::quiet(ui, "No notices");
        return;
    };
    let in_strip = notices.waiting(pass.bench).next().is_some_and(|above| std::ptr::eq(above, notice));
    let (glyph, colour) = mark(notice.severity, palette);
    if let Some(file) = &notice.file {
        folder_button(ui, pass.recordings, file);
    }
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, theme::CONTROL_HEIGHT), egui::Sense::click());
    let text = if in_strip { told_above(pass.bench) } else { notice.text.clone() };
    let galley = widgets::cut(ui, &text, theme::body(), palette.quiet, width - theme::GLYPH - 2.0 * theme::GAP);
    let left = rect.right() - galley.size().x - theme::GAP;
    if response.hovered() {
        let behind = rect.with_min_x(left - theme::GLYPH - 2.0 * theme::GAP);
        ui.painter().rect_filled(behind, theme::UNIT, palette.raised);
    }
    let centre = egui::pos2(left - theme::GAP - theme::GLYPH / 2.0, rect.center().y);
    widgets::paint_glyph(ui.painter(), glyph, centre, theme::GLYPH, colour);
    ui.painter().galley(egui::pos2(left, rect.center().y - galley.size().y / 2.0), galley, palette.quiet);
    widgets::describe(&response, egui::Role::Button, "Notices");
    let response = response.on_hover_text(format!("{}: {}\nClick for all notices", word(notice.severity), notice.text));
    let until = notices.listed.get_or_insert(notice.number);
    let list = egui::Popup::menu(&response)
        .align(egui::RectAlign::TOP_END)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| list(ui, pass, until));
    if list.is_none() {
        notices.listed = None;
    }
}

fn told_above(bench: &Bench) -> String {
    words::counted(bench.notices().count(), "notice")
}

/// The notices up to this number, the newest first.
fn list(ui: &mut Ui, pass: &mut Pass<'_>, until: &mut u64) {
    ui.set_width(theme::NOTICES_WIDTH);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Notices").heading());
        widgets::at_right(ui, |ui| {
            if ui.button("Clear").on_hover_text("Forgets all notices so far").clicked() {
                pass.actions.push(Action::ClearNotices);
                ui.close();
            }
            if ui.button("Copy all").on_hover_text("One line each, with time and kind").clicked() {
                ui.ctx().copy_text(pass.bench.notices().map(as_line).collect());
            }
            let newest = pass.bench.notices().next_back().map_or(*until, |notice| notice.number);
            let newer = newest.saturating_sub(*until);
            if newer > 0 && ui.button(format!("Show {newer} newer")).clicked() {
                *until = newest;
            }
        });
    });
    ScrollArea::vertical().max_height(theme::NOTICES_HEIGHT).show(ui, |ui| {
        for notice in pass.bench.notices().rev().skip_while(|notice| notice.number > *until) {
            entry(ui, notice, pass.recordings);
        }
    });
}

fn entry(ui: &mut Ui, notice: &Notice, recordings: &mut Recordings) {
    let palette = theme::palette(ui);
    let (glyph, colour) = mark(notice.severity, palette);
    ui.horizontal_top(|ui| {
        widgets::glyph(ui, glyph, colour);
        widgets::quiet(ui, &words::time_of_day(words::seconds(notice.at), 0));
        ui.vertical(|ui| {
            ui.add(egui::Label::new(&notice.text).wrap());
            if let Some(file) = &notice.file {
                folder_button(ui, recordings, file);
            }
        });
    });
}

/// Shows where a file was written.
fn folder_button(ui: &mut Ui, recordings: &mut Recordings, file: &Path) {
    if ui.button("Open folder").on_hover_text(file.display().to_string()).clicked() {
        recordings.ask(Wish::ShowFolder(file.to_owned()));
    }
}

fn as_line(notice: &Notice) -> String {
    format!("{} {}: {}\n", notice.at, word(notice.severity), notice.text)
}
