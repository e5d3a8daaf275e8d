//! Text in its styles, with links and with what was searched for marked.

use eframe::egui::{Color32, FontId, Label, RichText, TextFormat, Ui, Vec2, text::LayoutJob, vec2};

use crate::help::markdown::Span;
use crate::ui::theme;

/// How a piece of text looks.
#[derive(Clone)]
pub struct Style<'a> {
    pub font: FontId,
    pub colour: Color32,
    /// All of it.
    pub bold: bool,
    /// In small letters; where they stand, the ground is marked.
    pub words: &'a [String],
}

/// Draws `spans` as one text; the link that was clicked.
pub fn show(ui: &mut Ui, spans: &[Span], style: &Style<'_>) -> Option<String> {
    if spans.iter().all(|span| span.link.is_none()) {
        label(ui, spans, style);
        return None;
    }
    let mut clicked = None;
    ui.spacing_mut().interact_size.y = 0.0;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::ZERO;
        for span in spans {
            match &span.link {
                None => label(ui, std::slice::from_ref(span), style),
                Some(target) => {
                    let text = RichText::new(&span.text).font(style.font.clone());
                    if ui.link(text).clicked() {
                        clicked = Some(target.clone());
                    }
                }
            }
        }
    });
    clicked
}

fn label(ui: &mut Ui, spans: &[Span], style: &Style<'_>) {
    let width = ui.available_width();
    let wraps_in_row = ui.layout().main_wrap();
    let response = ui.add(Label::new(job(ui, spans, style, false)).wrap());
    let one_row = response.rect.height() < 1.5 * style.font.size * ROW;
    if (style.bold || spans.iter().any(|span| span.bold)) && (one_row || !wraps_in_row) {
        // The font has one weight only: strong text is painted twice, a little apart.
        let mut strong = job(ui, spans, style, true);
        strong.wrap.max_width = width;
        let galley = ui.fonts_mut(|fonts| fonts.layout_job(strong));
        let apart = vec2(style.font.size * theme::STRONG, 0.0);
        ui.painter().galley(response.rect.min + apart, galley, style.colour);
    }
}

/// Height of a row as a part of its font's size, at most.
const ROW: f32 = 1.35;

/// The text with its formats; with `only_bold`, the rest takes its room and cannot be seen.
fn job(ui: &Ui, spans: &[Span], style: &Style<'_>, only_bold: bool) -> LayoutJob {
    let palette = theme::palette(ui);
    let mut job = LayoutJob::default();
    for span in spans {
        let visible = !only_bold || span.bold || style.bold;
        let font = if span.code { FontId::monospace(style.font.size) } else { style.font.clone() };
        let colour = if visible { style.colour } else { theme::NO_COLOUR };
        for (text, is_match) in matches(&span.text, style.words) {
            let ground = match (only_bold, is_match, span.code) {
                (true, ..) | (_, false, false) => theme::NO_COLOUR,
                (_, true, _) => palette.selection,
                (_, false, true) => palette.raised,
            };
            let format = TextFormat { background: ground, ..TextFormat::simple(font.clone(), colour) };
            job.append(text, 0.0, format);
        }
    }
    job
}

/// Takes `text` apart into what is one of `words` and what is not. Only letters of ASCII are alike in both cases.
fn matches<'a>(text: &'a str, words: &[String]) -> Vec<(&'a str, bool)> {
    let lower = text.to_ascii_lowercase();
    let mut parts = Vec::new();
    let mut at = 0;
    while let Some(rest) = lower.get(at..).filter(|rest| !rest.is_empty()) {
        let found = words.iter().filter(|word| !word.is_empty());
        let found = found.filter_map(|word| rest.find(word.as_str()).map(|place| (place, word.len())));
        // The first one, and of those the longest.
        let Some((place, length)) = found.min_by_key(|(place, length)| (*place, usize::MAX.saturating_sub(*length)))
        else {
            break;
        };
        let (from, to) = (at.saturating_add(place), at.saturating_add(place).saturating_add(length));
        parts.extend(text.get(at..from).filter(|part| !part.is_empty()).map(|part| (part, false)));
        parts.extend(text.get(from..to).map(|part| (part, true)));
        at = to;
    }
    parts.extend(text.get(at..).filter(|part| !part.is_empty()).map(|part| (part, false)));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_longest_word_is_marked_wherever_it_stands() {
        let words = ["temp".to_owned(), "temperature".to_owned(), "°c".to_owned()];
        let parts = matches("Temperature in °c, temp", &words);
        assert_eq!(parts, [("Temperature", true), (" in ", false), ("°c", true), (", ", false), ("temp", true)]);
        assert_eq!(matches("abc", &[]), [("abc", false)]);
    }

    proptest! {
        #[test]
        fn nothing_of_the_text_is_lost(text: String, words: Vec<String>) {
            let words: Vec<String> = words.iter().map(|word| word.to_ascii_lowercase()).collect();
            let parts: String = matches(&text, &words).into_iter().map(|(part, _)| part).collect();
            prop_assert_eq!(parts, text);
        }
    }
}
