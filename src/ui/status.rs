//! The bar at the bottom: the line and what happens on it, in facts.

use eframe::egui::{Align, Color32, Label, RichText, Ui, vec2};

use super::app::Pass;
use super::faults;
use super::notices::{self, Notices};
use super::recording;
use super::theme::{self, Palette};
use super::widgets::{self, Glyph};
use super::words;
use crate::bench::LineState;
use crate::bus::Statistics;

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>, notices: &mut Notices) {
    ui.horizontal_centered(|ui| {
        // In a narrow window, or with large text, figures are told on hover.
        let wide = ui.available_width() >= theme::STATUS_WIDE;
        let (state, statistics) = (pass.bench.line(), pass.bench.statistics());
        let figures = if state.is_open() { figures(statistics) } else { Default::default() };
        line(ui, state, if wide { String::new() } else { figures.join("\n") });
        if state.is_open() && wide {
            ui.add_space(theme::GAP);
            facts(ui, statistics, figures);
        }
        faults::status(ui, pass);
        ui.add_space(theme::GAP);
        recording::section(ui, pass);
        widgets::at_right(ui, |ui| notices::newest(ui, pass, notices));
    });
}

fn state(line: &LineState, palette: &Palette) -> (Glyph, Color32, String) {
    match line {
        LineState::Closed => (Glyph::Ring, palette.quiet, "No line open".to_owned()),
        LineState::Opening { line } => (Glyph::Dashes, palette.quiet, format!("{line} opening")),
        LineState::Open { line } => (Glyph::Disc, palette.ok, format!("{line} open")),
        LineState::Lost { line, .. } => (Glyph::Cross, palette.error, format!("{line} lost")),
    }
}

/// What passes in a second, how much of it fails, and how long an answer takes.
fn figures(statistics: &Statistics) -> [String; 3] {
    let Statistics { transactions, errors, transactions_per_second, answer_time, .. } = statistics;
    let share = if *transactions == 0 { 0.0 } else { *errors as f64 / *transactions as f64 * 100.0 };
    let answer = answer_time.map_or_else(String::new, |time| format!("answer {:.0} ms", time.as_secs_f64() * 1e3));
    [format!("{transactions_per_second:.1} transactions/s"), format!("{share:.1} % errors"), answer]
}

/// `more` is told on hover, unless something is wrong.
fn line(ui: &mut Ui, line: &LineState, more: String) {
    let palette = theme::palette(ui);
    let (glyph, colour, text) = state(line, palette);
    widgets::glyph(ui, glyph, colour);
    let label = Label::new(RichText::new(text).color(palette.text)).truncate();
    let size = vec2(theme::LINE_STATE_WIDTH, theme::CONTROL_HEIGHT);
    let response = ui.allocate_ui(size, |ui| ui.add(label)).inner;
    match line.loss() {
        Some(loss) => drop(response.on_hover_text(loss)),
        None if !more.is_empty() => drop(response.on_hover_text(more)),
        None => {}
    }
}

fn facts(ui: &mut Ui, statistics: &Statistics, [rate, failed, answer]: [String; 3]) {
    let palette = theme::palette(ui);
    let Statistics { transactions, errors, repeats, echo, frames_missed, kinds, .. } = statistics;
    widgets::fixed_coloured(ui, theme::RATE_WIDTH, Align::Max, &rate, palette.quiet)
        .on_hover_text(format!("{} since the line was opened", words::counted(*transactions, "transaction")));
    let colour = if *errors == 0 { palette.quiet } else { palette.warning };
    let response = widgets::fixed_coloured(ui, theme::ERRORS_WIDTH, Align::Max, &failed, colour);
    let by_kind: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let repeated = (*repeats > 0).then(|| format!("{} asked again", words::counted(*repeats, "read")));
    let by_kind: Vec<String> = by_kind.into_iter().chain(repeated).collect();
    let by_kind = if by_kind.is_empty() { "No answer was missing or unusable".to_owned() } else { by_kind.join("\n") };
    response.on_hover_text(by_kind);
    widgets::fixed_coloured(ui, theme::ANSWER_WIDTH, Align::Max, &answer, palette.quiet)
        .on_hover_text("From the end of the last answered request to the answer's first byte");
    if *echo {
        widgets::quiet(ui, "echo").on_hover_text("The adapter sends back what is sent; the echo is taken away");
    }
    if *frames_missed > 0 {
        ui.label(RichText::new(format!("{} missed", words::counted(*frames_missed, "frame"))).color(palette.warning))
            .on_hover_text("Frames that the window did not take in time; readings are not affected");
    }
}
