//! Files that are dragged onto the window: what will become of them while they hover, and opening them.

use eframe::egui::{self, RichText};

use super::widgets::{self, Glyph};
use super::{modal, theme, words};
use crate::bench::Action;
use crate::bench::files::{self, FileKind};

/// Files that are told one by one; the rest is counted.
const MOST_TOLD: usize = 8;

/// What opens the files that were dropped in this frame.
pub fn dropped(ctx: &egui::Context) -> Vec<Action> {
    let files = ctx.input(|input| input.raw.dropped_files.clone());
    files.iter().map(|file| files::opening(file.path().to_owned())).collect()
}

/// Stands before the window while files hover over it, and says what will become of each.
pub fn overlay(ctx: &egui::Context) {
    // Not every system tells their names before they are dropped.
    let hovering: Vec<Option<(String, FileKind)>> = ctx.input(|input| {
        let paths = input.raw.hovered_files.iter().map(|file| file.path.as_deref());
        paths.map(|path| path.map(|path| (files::name_of(path), FileKind::of(path)))).collect()
    });
    if hovering.is_empty() {
        return;
    }
    modal::show(ctx, "dropping", theme::TEXT_WIDTH, |ui| {
        ui.heading("Drop to open");
        ui.add_space(theme::UNIT);
        for (name, kind) in hovering.iter().flatten().take(MOST_TOLD) {
            file(ui, name, *kind);
        }
        let more = hovering.iter().flatten().count().saturating_sub(MOST_TOLD);
        if more > 0 {
            widgets::quiet(ui, &format!("and {more} more"));
        }
        if hovering.iter().all(Option::is_none) {
            ui.label(words::counted(hovering.len(), "file"));
        }
        ui.add_space(theme::GAP);
        widgets::quiet(ui, "Module definitions (.toml) are checked and added, recordings (.sqlite) are opened.");
    });
}

fn file(ui: &mut egui::Ui, name: &str, kind: FileKind) {
    let palette = theme::palette(ui);
    let (glyph, colour) = match kind {
        FileKind::Definition | FileKind::Recording => (Glyph::Disc, palette.ok),
        FileKind::Capture => (Glyph::Triangle, palette.warning),
        FileKind::Unknown => (Glyph::Cross, palette.error),
    };
    ui.horizontal(|ui| {
        widgets::glyph(ui, glyph, colour);
        let text = format!("{name} {}", kind.becomes());
        ui.add(egui::Label::new(RichText::new(text).color(palette.text)).wrap());
    });
}
