//! How an event is marked.

use eframe::egui::Color32;

use crate::bench::EntryKind;
use crate::ui::theme::Palette;
use crate::ui::widgets::Glyph;

/// The mark of a kind of event, and its colour.
pub fn kind_mark(kind: EntryKind, palette: &Palette) -> (Glyph, Color32) {
    match kind {
        EntryKind::Found => (Glyph::Disc, palette.ok),
        EntryKind::Lost => (Glyph::Cross, palette.error),
        EntryKind::Motion => (Glyph::Disc, palette.motion),
        EntryKind::Output => (Glyph::Square, palette.output),
        EntryKind::Alarm => (Glyph::Triangle, palette.alarm),
        EntryKind::Watchdog => (Glyph::Outline, palette.alarm),
        EntryKind::Written => (Glyph::Edited, palette.ok),
        EntryKind::Refused => (Glyph::Triangle, palette.warning),
        EntryKind::Done => (Glyph::Square, palette.accent),
        EntryKind::Note => (Glyph::Ring, palette.quiet),
    }
}
