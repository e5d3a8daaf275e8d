//! Scripts: an editor with line numbers, and a run that can be followed line by line.

use std::sync::Arc;

use eframe::egui::{
    Align, Button, Galley, Label, Rect, RichText, Role, ScrollArea, Sense, TextBuffer, TextEdit, TextStyle, Ui,
    WidgetInfo, pos2, vec2,
};

use super::sending;
use crate::bench::console::{Running, Script, ScriptError};
use crate::bench::{Action, Module};
use crate::protocol::Protocol;
use crate::ui::app::Pass;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

/// Scripts that are offered again.
const OFFERED: usize = 10;

#[derive(Default)]
pub struct ScriptPage {
    text: String,
    /// An example was put in; not again when the user empties the editor.
    begun: bool,
    /// The text that runs or ran last, as a mark of a line is of that text only.
    ran: String,
}

/// A line that is marked.
#[derive(Clone, Copy, PartialEq)]
enum Marked {
    UnderWay(usize),
    Wrong(usize),
}

impl ScriptPage {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        if !self.begun {
            self.begun = true;
            self.text = example(module);
        }
        let parsed = Script::parse(&self.text);
        self.controls(ui, module, pass, &parsed);
        let room = (ui.available_height() - theme::SCRIPT_STATE).max(theme::CONTROL_HEIGHT);
        let marked = self.marked(module.console.running(), &parsed);
        ScrollArea::both().id_salt("script").auto_shrink(false).max_height(room).show(ui, |ui| {
            self.editor(ui, marked, room);
        });
        self.state(ui, module, &parsed);
    }

    fn controls(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, parsed: &Result<Script, ScriptError>) {
        ui.horizontal(|ui| {
            let size = vec2(theme::BUTTON_WIDTH, theme::CONTROL_HEIGHT);
            if module.console.is_running() {
                let button = ui.add(Button::new("Stop").min_size(size));
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Stop the script"));
                if button.on_hover_text("Ends it before the next line").clicked() {
                    pass.actions.push(Action::StopRaw(module.target));
                }
            } else {
                let obstacle = sending::obstacle(module, pass, None);
                let runs = parsed.as_ref().is_ok_and(|script| !script.is_empty()) && obstacle.is_none();
                let button = ui.add_enabled(runs, Button::new("Run").min_size(size));
                let reason = obstacle.unwrap_or_else(|| "Put the script right first".to_owned());
                let button = button.on_hover_text("Sends line after line, each after the answer to the one before");
                if button.on_disabled_hover_text(reason).clicked()
                    && let Ok(script) = parsed
                {
                    self.ran.clone_from(&self.text);
                    pass.settings.note_script(self.text.clone());
                    sending::run(module, pass, script);
                }
            }
            if let Some(running) = module.console.running() {
                let progress = running.run.progress();
                widgets::progress(ui, progress.fraction(), "Progress of the script");
                widgets::quiet(ui, &format!("{} of {}", progress.done, progress.total));
            }
            widgets::at_right(ui, |ui| self.recent(ui, pass));
        });
    }

    fn recent(&mut self, ui: &mut Ui, pass: &Pass<'_>) {
        let scripts = &pass.settings.recent_scripts;
        if scripts.is_empty() {
            return;
        }
        let recent = widgets::menu(ui, "Recent", "Recent scripts", |ui| {
            ui.set_width(theme::SCAN_MENU_WIDTH);
            for script in scripts.iter().take(OFFERED) {
                let title = script.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
                let lines = script.lines().count();
                let count = if lines == 1 { "1 line".to_owned() } else { format!("{lines} lines") };
                if widgets::menu_entry(ui, true, title, &count).on_hover_text(script).clicked() {
                    self.text.clone_from(script);
                    ui.close();
                }
            }
        });
        recent.on_hover_text("Scripts that were run before, to be put into the editor");
    }

    fn marked(&self, running: Option<&Running>, parsed: &Result<Script, ScriptError>) -> Option<Marked> {
        if let Err(error) = parsed {
            return Some(Marked::Wrong(error.line));
        }
        let running = running.filter(|_| self.ran == self.text)?;
        match &running.ended {
            None => running.run.current_line().map(Marked::UnderWay),
            Some(Err((line, _))) => Some(Marked::Wrong(*line)),
            Some(Ok(())) => None,
        }
    }

    fn editor(&mut self, ui: &mut Ui, marked: Option<Marked>, room: f32) {
        let palette = theme::palette(ui);
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            let (gutter, _) = ui.allocate_exact_size(vec2(theme::GUTTER, room), Sense::hover());
            // Lines are not broken, so that each row is a line of the script.
            let mut layouter = |ui: &Ui, text: &dyn TextBuffer, _: f32| -> Arc<Galley> {
                let text = text.as_str().to_owned();
                ui.fonts_mut(|fonts| fonts.layout(text, theme::mono(), palette.text, f32::INFINITY))
            };
            let rows = (room / ui.text_style_height(&TextStyle::Monospace)).floor().max(1.0);
            let output = TextEdit::multiline(&mut self.text)
                .font(TextStyle::Monospace)
                .layouter(&mut layouter)
                .desired_width(ui.available_width())
                .desired_rows(rows as usize)
                .show(ui);
            widgets::name_field(&output.response, "Script", &self.text);
            for (index, row) in output.galley.rows.iter().enumerate() {
                let line = index.saturating_add(1);
                let (top, bottom) = (output.galley_pos.y + row.rect().top(), output.galley_pos.y + row.rect().bottom());
                let number = Rect::from_min_max(pos2(gutter.left(), top), pos2(gutter.right() - theme::GAP, bottom));
                let text = Rect::from_min_max(pos2(gutter.right(), top), pos2(output.response.rect.right(), bottom));
                line_number(ui, palette, line, number, text, marked);
            }
        });
    }

    /// What is to be said of the script. Its room is always kept.
    fn state(&self, ui: &mut Ui, module: &Module, parsed: &Result<Script, ScriptError>) {
        let palette = theme::palette(ui);
        let running = module.console.running().filter(|_| self.ran == self.text);
        let (glyph, colour, text) = match (parsed, running) {
            (Err(error), _) => (Glyph::Cross, palette.error, sending::sentence(&error.to_string())),
            (Ok(_), Some(Running { run, ended: None, .. })) => {
                let line = run.current_line().map(|line| format!("Line {line}")).unwrap_or_default();
                let left = run
                    .repeats_left()
                    .map(|left| format!(", {} left", words::counted(left, "repeat")))
                    .unwrap_or_default();
                (Glyph::Disc, palette.accent, format!("{line} is under way{left}"))
            }
            (Ok(_), Some(Running { run, ended: Some(Ok(())), .. })) => {
                let done = format!(
                    "Done: {}, {} as expected",
                    words::counted(run.progress().done, "step"),
                    words::counted(run.met(), "answer")
                );
                (Glyph::Ring, palette.ok, done)
            }
            (Ok(_), Some(Running { ended: Some(Err((line, reason))), .. })) => {
                (Glyph::Cross, palette.error, format!("Ended at line {line}: {reason}"))
            }
            (Ok(script), None) => match script.hints(module.target.checksum).first() {
                Some(hint) => (Glyph::Outline, palette.warning, format!("Line {}: {}", hint.line, hint.text)),
                None => (
                    Glyph::Dashes,
                    palette.quiet,
                    "Commands, send, expect, wait 500 ms, repeat 10 … end; // begins a comment".to_owned(),
                ),
            },
        };
        ui.horizontal_top(|ui| {
            widgets::glyph(ui, glyph, colour);
            ui.with_layout(eframe::egui::Layout::top_down(Align::Min), |ui| {
                ui.add_space(theme::UNIT);
                ui.add(Label::new(RichText::new(text).color(colour)).wrap());
            });
        });
    }
}

fn line_number(ui: &Ui, palette: &Palette, line: usize, number: Rect, text: Rect, marked: Option<Marked>) {
    let colour = match marked {
        Some(Marked::UnderWay(at)) if at == line => {
            ui.painter().rect_filled(text, 0.0, theme::line_mark(palette));
            palette.accent
        }
        Some(Marked::Wrong(at)) if at == line => {
            let left = number.left_center() + vec2(theme::CARET, 0.0);
            widgets::paint_glyph(ui.painter(), Glyph::Cross, left, theme::CARET, palette.error);
            palette.error
        }
        _ => palette.quiet,
    };
    widgets::line_in(ui, number, Align::Max, &line.to_string(), theme::small(), colour);
}

/// A script to begin with.
fn example(module: &Module) -> String {
    let address = module.target.address;
    match module.target.protocol {
        Protocol::Dcon => format!("// Ask for the name\n${address:02X}M\nexpect !{address:02X}*\n"),
        _ => format!(
            "// Read the first register three times\nrepeat 3\nsend hex {address:02X} 03 00 00 00 01\n\
             expect hex {address:02X} 03 02 *\nwait 500 ms\nend\n"
        ),
    }
}
