//! The reference of the module's commands: searchable, each with what the manual says and a form that fills it in.

use std::slice;

use eframe::egui::{Align, Button, Label, Response, RichText, Role, Sense, TextEdit, Ui, WidgetInfo};

use super::{Wish, fields, line_size, scrolled, sending};
use crate::bench::Module;
use crate::bench::console::{Direction, RawCommand, ReferenceEntry, search};
use crate::module::Fields;
use crate::protocol::Protocol;
use crate::ui::app::Pass;
use crate::ui::tables::{Sheet, copied};
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

#[derive(Default)]
pub struct ReferencePage {
    sought: String,
    /// The entry that is open, by id.
    open: Option<String>,
    direction: Option<Direction>,
    /// What is typed into the fields of the open entry.
    texts: Fields,
}

impl ReferencePage {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &Pass<'_>, entries: &[ReferenceEntry]) -> Option<Wish> {
        let mut wish = None;
        search_field(ui, &mut self.sought, "Search the reference", "Title, syntax, section, name, or a whole command");
        note_of_protocol(ui, module);
        let found = search(entries, &self.sought);
        // What the module's protocol can carry comes first.
        let modbus = module.target.protocol.is_modbus();
        let (first, then): (Vec<&ReferenceEntry>, Vec<&ReferenceEntry>) =
            found.iter().partition(|entry| entry.function.is_some() == modbus);
        scrolled(ui, "reference", |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if entries.is_empty() {
                widgets::quiet(ui, "The definition of this module names no commands.");
            } else if found.is_empty() {
                widgets::quiet(ui, "No command has all of these words – use fewer");
            }
            let shown: Vec<&ReferenceEntry> = first.into_iter().chain(then).collect();
            for entry in &shown {
                ui.push_id(&entry.id, |ui| {
                    let title = self.title(ui, entry);
                    copied(&title, |part| sheet(part.of(slice::from_ref(entry), shown.as_slice())));
                    if self.open.as_ref() == Some(&entry.id) {
                        wish = self.details(ui, module, pass, entry).or(wish.take());
                    }
                });
            }
        });
        wish
    }

    fn title(&mut self, ui: &mut Ui, entry: &ReferenceEntry) -> Response {
        let palette = theme::palette(ui);
        let (rect, response) = ui.allocate_exact_size(line_size(ui), Sense::click());
        let open = self.open.as_ref() == Some(&entry.id);
        if open || response.hovered() || response.has_focus() {
            let fill = if open { palette.selection } else { palette.raised_hovered };
            ui.painter().rect_filled(rect, theme::UNIT, fill);
        }
        let inner = rect.shrink2(eframe::egui::vec2(theme::UNIT, 0.0));
        let syntax = entry.syntax_read.as_deref().or(entry.syntax_write.as_deref()).unwrap_or_default();
        let font = theme::small_mono();
        let width = widgets::line_in(ui, inner, Align::Max, syntax, font, palette.quiet).width();
        let left = inner.with_max_x(inner.right() - width - theme::GAP);
        widgets::line_in(ui, left, Align::Min, &entry.title, theme::body(), palette.text);
        response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, open, &entry.title));
        let hover = [entry.title.as_str(), syntax, entry.note.as_str()].join("\n");
        if response.clicked() {
            self.open = Some(entry.id.clone()).filter(|_| !open);
            self.direction = None;
            self.texts.clear();
        }
        response.on_hover_text(hover)
    }

    fn details(&mut self, ui: &mut Ui, module: &Module, pass: &Pass<'_>, entry: &ReferenceEntry) -> Option<Wish> {
        ui.spacing_mut().item_spacing.y = theme::UNIT;
        ui.add_space(theme::GAP);
        let mut wish = None;
        ui.horizontal(|ui| {
            ui.add_space(theme::GAP);
            ui.vertical(|ui| {
                said(ui, entry);
                let direction = self.choose_direction(ui, entry);
                let address = module.target.address;
                fields::show(ui, entry, direction, address, &mut self.texts);
                let line = entry.fill(direction, address, &self.texts);
                wish = finish(ui, module, pass, entry, line);
            });
        });
        ui.add_space(theme::GAP_SECTION);
        wish
    }

    /// Read or write, where the command has both.
    fn choose_direction(&mut self, ui: &mut Ui, entry: &ReferenceEntry) -> Direction {
        match (&entry.syntax_read, &entry.syntax_write) {
            (Some(_), Some(_)) => {}
            (None, _) => return Direction::Write,
            (Some(_), None) => return Direction::Read,
        }
        let mut direction = self.direction.unwrap_or(Direction::Read);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = theme::UNIT;
            for (other, word) in [(Direction::Read, "Read"), (Direction::Write, "Write")] {
                let means = "The command both reads and writes, in two forms";
                if widgets::chip(ui, direction == other, word, &format!("{word} with this command"), means) {
                    direction = other;
                }
            }
        });
        self.direction = Some(direction);
        direction
    }
}

pub fn search_field(ui: &mut Ui, text: &mut String, name: &str, hint: &str) {
    let response = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(ui.available_width() - theme::GAP));
    widgets::name_field(&response, name, text);
    response.on_hover_text(format!("Shows what has all of these words: {hint}"));
}

/// Commands of another protocol are listed too, but the module does not answer them.
fn note_of_protocol(ui: &mut Ui, module: &Module) {
    let text = match module.target.protocol {
        Protocol::Dcon => return,
        Protocol::ModbusRtu => "The module speaks Modbus at present: it answers Modbus functions, not DCON commands",
        Protocol::ModbusTcp => sending::no_dcon(),
    };
    let colour = theme::palette(ui).quiet;
    sending::told(ui, Glyph::Outline, colour, text);
}

/// Commands as they are copied.
fn sheet(entries: &[&ReferenceEntry]) -> Sheet {
    let mut sheet = Sheet::new(["Command", "Read", "Write", "Answer", "Manual", "Note", "Used by", "Id"]);
    for entry in entries {
        let syntax = |syntax: &Option<String>| syntax.clone().unwrap_or_default();
        sheet.push([
            &entry.title,
            &syntax(&entry.syntax_read),
            &syntax(&entry.syntax_write),
            &entry.answers.join("  or  "),
            &entry.source,
            &entry.note,
            &entry.items.join(", "),
            &entry.id,
        ]);
    }
    sheet
}

/// What the manual says.
fn said(ui: &mut Ui, entry: &ReferenceEntry) {
    let answers = entry.answers.join("  or  ");
    for (word, syntax) in [("Read", &entry.syntax_read), ("Write", &entry.syntax_write), ("Answer", &Some(answers))] {
        let Some(syntax) = syntax.as_ref().filter(|syntax| !syntax.is_empty()) else { continue };
        ui.horizontal(|ui| {
            let palette = theme::palette(ui);
            widgets::fixed_coloured(ui, theme::FIELD_NAME, Align::Min, word, palette.quiet);
            ui.add(Label::new(RichText::new(syntax).monospace().color(palette.text)).wrap());
        });
    }
    let palette = theme::palette(ui);
    if !entry.note.is_empty() {
        ui.add(Label::new(RichText::new(&entry.note).color(palette.quiet)).wrap());
    }
    let mut origin = if entry.source.is_empty() { String::new() } else { format!("Manual {}", entry.source) };
    if !entry.items.is_empty() {
        let dot = if origin.is_empty() { "" } else { "  ·  " };
        origin.push_str(&format!("{dot}{}", entry.items.join(", ")));
    }
    ui.add(Label::new(RichText::new(origin).small().color(palette.quiet)).wrap());
    ui.add_space(theme::UNIT);
}

/// The line that comes of it, what it does, and what to do with it.
fn finish(
    ui: &mut Ui,
    module: &Module,
    pass: &Pass<'_>,
    entry: &ReferenceEntry,
    line: Result<String, String>,
) -> Option<Wish> {
    let palette = theme::palette(ui);
    let command = line.as_ref().map_err(Clone::clone);
    let command = command.and_then(|line| RawCommand::parse(line, module.target.checksum));
    match &command {
        Ok(command) => sending::mark(ui, module, command),
        Err(reason) => sending::told(ui, Glyph::Edited, palette.quiet, &sending::sentence(reason)),
    }
    let mut wish = None;
    ui.horizontal(|ui| {
        let shown = line.as_deref().unwrap_or_default();
        let obstacle = sending::obstacle(module, pass, command.as_ref().ok());
        let button = ui.add_enabled(command.is_ok() && obstacle.is_none(), Button::new("Send"));
        button.widget_info(|| WidgetInfo::labeled(Role::Button, button.enabled(), format!("Send: {}", entry.title)));
        let button = button.on_disabled_hover_text(obstacle.unwrap_or_else(|| "Fill in the fields first".to_owned()));
        let button = button.on_hover_text("Sends it once, as it stands at the right");
        let put = ui.add_enabled(command.is_ok(), Button::new("Put into the command line"));
        let put = put.on_hover_text("To be changed there before it is sent");
        if put.clicked() {
            wish = Some(Wish::Line(shown.to_owned()));
        }
        if let (true, Ok(command)) = (button.clicked(), command) {
            wish = Some(Wish::Send(command));
        }
        ui.add(Label::new(RichText::new(shown).monospace().color(palette.text)).truncate());
    });
    wish
}
