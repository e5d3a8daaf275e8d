//! The parts of the program that others have written, with the full texts of their licences.

use eframe::egui::{Align, Label, Panel, RichText, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2};

use crate::help::licences::{self, Part, Texts};
use crate::ui::{theme, widgets};

/// Made when the list is looked at first.
#[derive(Default)]
pub struct LicenceList {
    parts: Vec<Part>,
    texts: Option<Texts>,
    sought: String,
    /// The part whose licence is shown, and its text.
    chosen: Option<(Part, String)>,
}

impl LicenceList {
    pub fn show(&mut self, ui: &mut Ui) {
        if self.parts.is_empty() {
            self.parts = licences::parts();
            self.texts = Texts::unpacked();
            if let Some(first) = self.parts.first().copied() {
                self.choose(first);
            }
        }
        let panel = Panel::left("parts").frame(theme::beside_frame()).resizable(false).exact_size(theme::ABOUT_LIST);
        panel.show(ui, |ui| self.list(ui));
        theme::behind_list_frame().show(ui, |ui| self.text(ui));
    }

    fn choose(&mut self, part: Part) {
        let text = self.texts.as_ref().map(|texts| texts.of(&part)).unwrap_or_default();
        self.chosen = Some((part, text));
    }

    fn list(&mut self, ui: &mut Ui) {
        let hint = "Search name or licence";
        let field =
            TextEdit::singleline(&mut self.sought).hint_text(hint).desired_width(ui.available_width() - theme::GAP);
        let response = ui.add(field);
        widgets::name_field(&response, hint, &self.sought);
        response.on_hover_text("Shows only parts with this in their name or licence");
        let found: Vec<Part> = self.parts.iter().filter(|part| part.has(&self.sought)).copied().collect();
        widgets::quiet_small(ui, &format!("{} of {} parts", found.len(), self.parts.len()));
        let mut chosen = None;
        let scroll = ScrollArea::vertical().id_salt("parts").auto_shrink(false);
        ui.spacing_mut().item_spacing.y = 0.0;
        scroll.show_rows(ui, theme::HELP_ROW, found.len(), |ui, range| {
            for part in found.get(range).unwrap_or_default() {
                if row(ui, part, self.chosen.as_ref().is_some_and(|(shown, _)| shown == part)) {
                    chosen = Some(*part);
                }
            }
        });
        if let Some(part) = chosen {
            self.choose(part);
        }
    }

    fn text(&self, ui: &mut Ui) {
        let Some((part, text)) = &self.chosen else { return };
        ui.horizontal(|ui| {
            ui.label(part.title());
            widgets::quiet(ui, part.licence);
            widgets::at_right(ui, |ui| {
                if ui.button("Copy").on_hover_text("Copies the text of this licence").clicked() {
                    ui.ctx().copy_text(text.clone());
                }
            });
        });
        ScrollArea::vertical().id_salt(part.title()).auto_shrink(false).show(ui, |ui| {
            ui.add(Label::new(RichText::new(text).font(theme::small_mono())).wrap());
        });
    }
}

fn row(ui: &mut Ui, part: &Part, shown: bool) -> bool {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::HELP_ROW), Sense::click());
    if shown {
        ui.painter().rect_filled(rect, theme::UNIT, palette.selection);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let inside = rect.shrink2(vec2(theme::UNIT, 0.0));
    let name = widgets::line_in(ui, inside, Align::Min, &part.title(), theme::body(), palette.text);
    let rest = inside.with_min_x((name.right() + theme::GAP).min(inside.right()));
    widgets::line_in(ui, rest, Align::Max, part.licence, theme::small(), palette.quiet);
    let title = format!("{}, {}", part.title(), part.licence);
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, shown, &title));
    response.on_hover_text(title.as_str()).clicked()
}
