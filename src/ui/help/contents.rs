//! The list at the left: all articles, or what was found.

use eframe::egui::{Align, Rect, Response, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2};

use super::Place;
use crate::help::{Group, Hit, Library, MOST_HITS};
use crate::ui::{theme, widgets};

/// True if the text was changed.
pub fn search_field(ui: &mut Ui, text: &mut String, focus: bool) -> bool {
    let before = text.clone();
    let hint = "Search the help";
    let response = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(ui.available_width() - theme::GAP));
    widgets::name_field(&response, hint, text);
    let response = response.on_hover_text("Finds pages that have all of these words; Esc empties it");
    if focus {
        response.request_focus();
    }
    if response.has_focus() && ui.input(|input| input.key_pressed(eframe::egui::Key::Escape)) {
        text.clear();
    }
    *text != before
}

/// All articles; the one that was chosen. With `reveal`, that which is shown comes into view.
pub fn articles(ui: &mut Ui, library: &Library, shown: &str, reveal: bool) -> Option<Place> {
    let mut chosen = None;
    ScrollArea::vertical().id_salt("articles").auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let mut group: Option<Group> = None;
        for article in library.articles() {
            if group != Some(article.group) {
                if group.is_some() {
                    ui.add_space(theme::GAP);
                }
                group = Some(article.group);
                widgets::quiet_small(ui, article.group.title());
            }
            let is_shown = article.id == shown;
            let response = row(ui, &article.title, is_shown);
            if reveal && is_shown {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                chosen = Some(Place { article: article.id.clone(), block: 0 });
            }
        }
    });
    chosen
}

/// What was found; the one that was chosen.
pub fn hits(ui: &mut Ui, library: &Library, hits: &[Hit], shown: Option<&Place>) -> Option<Place> {
    let mut chosen = None;
    let count = match hits.len() {
        0 => "Nothing has all of these words – use fewer".to_owned(),
        1 => "1 place".to_owned(),
        MOST_HITS => format!("The first {MOST_HITS} places – use more words"),
        many => format!("{many} places"),
    };
    widgets::quiet_small(ui, &count);
    ScrollArea::vertical().id_salt("hits").auto_shrink(false).show_rows(
        ui,
        theme::HELP_HIT,
        hits.len(),
        |ui, range| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for hit in hits.get(range).unwrap_or_default() {
                let title = library.article(&hit.article).map_or("", |article| article.title.as_str());
                let name = if hit.heading == title { title.to_owned() } else { format!("{title} – {}", hit.heading) };
                let place = Place { article: hit.article.clone(), block: hit.block };
                let below = [if hit.heading == title { "" } else { title }, hit.snippet.as_str()];
                if hit_row(ui, &name, &hit.heading, below, shown == Some(&place)) {
                    chosen = Some(place);
                }
            }
        },
    );
    chosen
}

fn row(ui: &mut Ui, title: &str, shown: bool) -> Response {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::HELP_ROW), Sense::click());
    ground(ui, rect, &response, shown);
    widgets::line_in(ui, rect.shrink2(vec2(theme::UNIT, 0.0)), Align::Min, title, theme::body(), palette.text);
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, shown, title));
    response.on_hover_text(title)
}

/// Heading, article and text of what was found.
fn hit_row(ui: &mut Ui, name: &str, heading: &str, [article, snippet]: [&str; 2], shown: bool) -> bool {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::HELP_HIT), Sense::click());
    ground(ui, rect, &response, shown);
    let inside = rect.shrink2(vec2(theme::UNIT, theme::UNIT));
    let (upper, rest) = inside.split_top_bottom_at_fraction(0.4);
    let (middle, lower) = rest.split_top_bottom_at_fraction(0.5);
    widgets::line_in(ui, upper, Align::Min, heading, theme::body(), palette.text);
    let (first, second) = if article.is_empty() { (snippet, "") } else { (article, snippet) };
    widgets::line_in(ui, middle, Align::Min, first, theme::small(), palette.quiet);
    widgets::line_in(ui, lower, Align::Min, second, theme::small(), palette.quiet);
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, shown, name));
    response.on_hover_text(format!("{name}\n{snippet}")).clicked()
}

fn ground(ui: &Ui, rect: Rect, response: &Response, shown: bool) {
    let palette = theme::palette(ui);
    if shown {
        ui.painter().rect_filled(rect, theme::UNIT, palette.selection);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
}
