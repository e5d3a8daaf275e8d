//! How the recording fares, in a few words at a fixed place.

use eframe::egui::{self, Color32, Response, Role, Sense, Ui, WidgetInfo, vec2};

use super::file_name;
use crate::bench::Bench;
use crate::record::{RecordingStatus, timestamp};
use crate::ui::tables::grouped;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

pub fn show(ui: &mut Ui, bench: &Bench) -> Response {
    let palette = theme::palette(ui);
    let (glyph, colour, text) = state(bench, palette);
    let size = vec2(theme::RECORDING_WIDTH, theme::CONTROL_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let centre = egui::pos2(rect.left() + theme::UNIT + theme::GLYPH / 2.0, rect.center().y);
    widgets::paint_glyph(ui.painter(), glyph, centre, theme::GLYPH, colour);
    let room = rect.with_min_x(centre.x + theme::GLYPH / 2.0 + theme::GAP);
    widgets::line_in(ui, room, egui::Align::Min, &text, theme::body(), palette.text);
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(text.clone()),
        ..WidgetInfo::labeled(Role::Button, true, "Recording")
    });
    response.on_hover_ui(|ui| {
        ui.set_max_width(theme::TEXT_WIDTH);
        facts(bench).iter().for_each(|line| drop(ui.label(line)));
    })
}

/// Shape, colour and words.
fn state(bench: &Bench, palette: &Palette) -> (Glyph, Color32, String) {
    match bench.recording() {
        None => (Glyph::Frame, palette.quiet, "not recording".to_owned()),
        Some(RecordingStatus { problem: Some(_), waiting: 0, lost, .. }) if *lost > 0 => {
            (Glyph::Triangle, palette.warning, format!("recording, {} lost", count(*lost)))
        }
        Some(RecordingStatus { problem: Some(_), waiting, .. }) => {
            (Glyph::Triangle, palette.warning, format!("not on disk: {} wait", count(*waiting)))
        }
        Some(_) if bench.modules().iter().all(|module| module.interval.is_none()) => {
            (Glyph::Frame, palette.quiet, "recording, nothing is polled".to_owned())
        }
        Some(status) => {
            let since = status.since.map_or_else(String::new, |since| {
                let lasting = words::since(since, bench.now());
                format!(" {}", words::span(std::time::Duration::from_secs(lasting.as_secs())))
            });
            (Glyph::Square, palette.ok, format!("recording{since}, {}", words::size(status.bytes)))
        }
    }
}

/// The same in full, line by line.
pub fn facts(bench: &Bench) -> Vec<String> {
    let Some(status) = bench.recording() else {
        return vec!["What is measured is in memory only, and gone when the program ends.".to_owned()];
    };
    let RecordingStatus { file, samples, waiting, lost, problem, saved_until, .. } = status;
    let mut lines = Vec::new();
    lines.extend(problem.clone());
    lines.extend(file.as_ref().map(|file| format!("File  {}", file_name(file))));
    lines.push(format!("{} on the disk, {} waiting", counted(*samples), count(*waiting)));
    let until = saved_until.map(|until| words::clock(timestamp(until)));
    lines.extend(until.map(|until| format!("Everything until {until} is saved")));
    if *lost > 0 {
        let are = if *lost == 1 { "is" } else { "are" };
        lines.push(format!("{} found no room in memory and {are} lost", counted(*lost)));
    }
    lines
}

fn counted(samples: u64) -> String {
    format!("{} {}", count(samples), if samples == 1 { "sample" } else { "samples" })
}

fn count(number: u64) -> String {
    grouped(usize::try_from(number).unwrap_or(usize::MAX))
}
