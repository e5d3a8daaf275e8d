//! A note about a time: a small field beside the place where it was asked for.

use eframe::egui::{self, Area, Id, Key, Order, Pos2, TextEdit, Ui};

use super::scene::Scene;
use crate::ui::{theme, widgets};

/// Letters that a note may have.
const LONGEST: usize = 200;

#[derive(Debug, Default)]
pub struct NoteField {
    open: Option<(f64, Pos2)>,
    text: String,
    /// It has just been opened and takes the focus.
    fresh: bool,
}

impl NoteField {
    pub fn open(&mut self, at: f64, place: Pos2) {
        (self.open, self.fresh) = (Some((at, place)), true);
        self.text.clear();
    }

    /// Shows the field while it is open; the note when it is written.
    pub fn show(&mut self, ui: &Ui, scene: &Scene<'_>) -> Option<(f64, String)> {
        let (at, place) = self.open?;
        let time = scene.zone.clock(at, 1);
        let area = Area::new(Id::unique("note")).order(Order::Foreground).fixed_pos(place).constrain(true);
        let written = area.show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(theme::NOTE_WIDTH);
                widgets::quiet(ui, &format!("Note about {time}"));
                let field = TextEdit::singleline(&mut self.text).char_limit(LONGEST).desired_width(f32::INFINITY);
                let field = ui.add(field.hint_text("What happened?"));
                widgets::name_field(&field, "Note", &self.text);
                if std::mem::take(&mut self.fresh) {
                    field.request_focus();
                }
                let enter = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                let escape = ui.input(|input| input.key_pressed(Key::Escape));
                let named = !self.text.trim().is_empty();
                let mut done = (enter && named).then_some(true).or(escape.then_some(false));
                ui.horizontal(|ui| {
                    if ui.add_enabled(named, egui::Button::new("Add note")).clicked() {
                        done = Some(true);
                    }
                    if ui.button("Cancel").clicked() {
                        done = Some(false);
                    }
                });
                done
            })
        });
        let done = written.inner.inner?;
        self.open = None;
        done.then(|| (at, self.text.trim().to_owned()))
    }
}
