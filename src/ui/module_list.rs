//! The modules that were found, with what they last said.

use eframe::egui::{Align, Color32, Rect, Role, ScrollArea, Sense, Ui, pos2, vec2};

use super::app::Pass;
use super::dashboard_table::Table;
use super::module_view::{Freshness, Series, series_of};
use super::panes::Pane;
use super::tables::{Part, copied};
use super::theme::Palette;
use super::widgets::{self, Glyph};
use super::{theme, words};
use crate::bench::{Action, LineState, Module, Presence, ScanState};
use crate::protocol::Failure;

/// How many numbers of a module the list shows.
const NUMBERS_SHOWN: usize = 2;

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>) {
    title(ui, pass);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for module in pass.bench.modules() {
            if row(ui, pass, module, pass.active == Pane::Module(module.target)) {
                pass.actions.push(Action::Show(module.target));
            }
        }
        if pass.bench.modules().is_empty() {
            hint(ui, pass);
        }
    });
}

fn title(ui: &mut Ui, pass: &Pass<'_>) {
    let palette = theme::palette(ui);
    let size = vec2(ui.available_width(), theme::CONTROL_HEIGHT);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let inside = rect.shrink2(vec2(theme::GAP, 0.0));
    widgets::line_in(ui, inside, Align::Min, "Modules", theme::small(), palette.quiet);
    let count = pass.bench.modules().len().to_string();
    widgets::line_in(ui, inside, Align::Max, &count, theme::small(), palette.quiet);
}

/// While nothing is found yet: what is going on, in one line; the middle of the window says more.
fn hint(ui: &mut Ui, pass: &Pass<'_>) {
    let text = match pass.bench.scan() {
        Some(ScanState::Running { .. }) => "Searching…",
        Some(ScanState::Ended(_)) => "Nothing found",
        None => "Not searched yet",
    };
    ui.horizontal(|ui| {
        ui.add_space(theme::GAP);
        widgets::quiet(ui, text);
    });
}

/// How a module is: a shape, a colour and a word.
pub struct State {
    pub glyph: Glyph,
    pub colour: Color32,
    pub word: &'static str,
    /// Where there is little room.
    pub short: &'static str,
}

pub fn state(module: &Module, line: &LineState, palette: &Palette) -> State {
    let (glyph, colour, word, short) = match &module.presence {
        _ if module.definition().is_none() => (Glyph::Dashes, palette.warning, "unknown model", "unknown"),
        _ if matches!(line, LineState::Closed) => (Glyph::Ring, palette.quiet, "line closed", "line closed"),
        _ if line.is_lost() => (Glyph::Cross, palette.error, "line lost", "line lost"),
        Presence::Silent { failure: Failure::LineLost(_) } => (Glyph::Cross, palette.error, "line lost", "line lost"),
        Presence::Silent { failure } if failure.is_garbage() => {
            (Glyph::Cross, palette.error, "answers cannot be used", "unusable")
        }
        Presence::Silent { .. } => (Glyph::Cross, palette.error, "silent", "silent"),
        Presence::Answering if module.attention().is_some() => {
            let word = module.attention().unwrap_or_default();
            (Glyph::Triangle, palette.alarm, word, word)
        }
        Presence::Answering if module.interval.is_some() => (Glyph::Disc, palette.ok, "answering", "answering"),
        Presence::Answering => (Glyph::Ring, palette.ok, "polling paused", "paused"),
        Presence::Found if module.interval.is_some() => {
            (Glyph::Ring, palette.quiet, "waiting for its first answer", "waiting")
        }
        Presence::Found => (Glyph::Ring, palette.quiet, "found, not polled", "found"),
    };
    State { glyph, colour, word, short }
}

/// Draws a module; true if it was chosen.
fn row(ui: &mut Ui, pass: &Pass<'_>, module: &Module, shown: bool) -> bool {
    let palette = theme::palette(ui);
    let size = vec2(ui.available_width(), theme::ROW_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    if shown {
        ui.painter().rect_filled(rect, 0.0, palette.selection);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 0.0, palette.raised);
    }
    let State { glyph, colour, word, .. } = state(module, pass.bench.line(), palette);
    let inside = rect.shrink(theme::ROW_MARGIN);
    let [first, second, third] = thirds(inside);
    let mark = pos2(inside.left() + theme::GLYPH / 2.0, first.center().y);
    widgets::paint_glyph(ui.painter(), glyph, mark, theme::GLYPH, colour);
    let address = format!("@{}", module.target.address);
    let right = widgets::line_in(ui, first, Align::Max, &address, theme::body(), palette.text);
    let name = first.with_max_x(right.left() - theme::GAP);
    widgets::line_in(ui, name, Align::Min, module.label(), theme::body(), palette.text);
    let spoken = words::spoken(&module.target);
    widgets::line_in(ui, second, Align::Min, &spoken, theme::small(), palette.quiet);
    let (said, fresh) = what_it_says(pass, module, word);
    let colour = if fresh { palette.text } else { palette.quiet };
    widgets::line_in(ui, third, Align::Min, &said, theme::small(), colour);

    let name = format!("{}, address {}", module.label(), module.target.address);
    response.widget_info(|| eframe::egui::WidgetInfo::selected(Role::ListItem, true, shown, &name));
    let response = response.on_hover_text(format!(
        "{} – {word}\nAddress {}\n{spoken}\n{said}",
        module.label(),
        words::address(module.target.address)
    ));
    copied(&response, |part| Table::of(pass, palette).sheet((part == Part::Row).then_some(module.target)));
    response.clicked()
}

/// Three lines of text, to the right of the mark.
fn thirds(inside: Rect) -> [Rect; 3] {
    let text = inside.with_min_x(inside.left() + theme::GLYPH + theme::GAP);
    let height = text.height() / 3.0;
    [0.0, 1.0, 2.0].map(|index| {
        let top = text.top() + index * height;
        Rect::from_min_max(pos2(text.left(), top), pos2(text.right(), top + height))
    })
}

/// The third line, and whether it is fresh: key values, what an unknown module said, or the state.
fn what_it_says(pass: &Pass<'_>, module: &Module, state: &str) -> (String, bool) {
    if module.definition().is_none() {
        let said = &module.identified.said;
        return (if said.is_empty() { "said nothing".to_owned() } else { said.clone() }, false);
    }
    let series = series_of(pass.bench.history(), module, pass.settings.temperature);
    let numbers: Vec<&Series> = series.iter().filter(|series| series.is_number()).take(NUMBERS_SHOWN).collect();
    let shown = if numbers.is_empty() { series.iter().take(NUMBERS_SHOWN).collect() } else { numbers };
    let now = pass.bench.now();
    let known: Vec<String> = shown.iter().filter_map(|series| value_of(series)).collect();
    let fresh = shown.iter().all(|series| series.freshness(module, now) == Freshness::Fresh);
    match (known.is_empty(), &module.presence) {
        (true, _) => (state.to_owned(), false),
        (false, Presence::Silent { .. }) => (format!("{} – {state}", known.join("   ")), false),
        (false, Presence::Answering) if module.attention().is_some() => {
            (format!("{} – {state}", known.join("   ")), fresh)
        }
        (false, _) => (known.join("   "), fresh),
    }
}

fn value_of(series: &Series<'_>) -> Option<String> {
    let value = series.reading?.value.as_ref()?;
    Some(match series.is_number() {
        true => format!("{value} {}", series.unit),
        false => format!("{} {}", series.label, series.word(value)),
    })
}
