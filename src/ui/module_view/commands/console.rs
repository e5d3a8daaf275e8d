//! The command line: what is typed, what it does, what goes on the wire, and sending it once or again and again.

use std::time::Duration;

use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{Align, Button, Checkbox, DragValue, Id, Key, Modifiers, Role, TextEdit, TextStyle, Ui, WidgetInfo};

use super::sending;
use crate::bench::console::{History, RawCommand, check_typed};
use crate::bench::{Action, Module};
use crate::protocol::{Protocol, hex};
use crate::ui::app::Pass;
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

/// Periods of a repeated command in milliseconds.
const PERIODS: std::ops::RangeInclusive<u64> = 10..=3_600_000;

pub struct CommandLine {
    text: String,
    history: History,
    /// The user steps through the history.
    stepping: bool,
    /// What the user wants instead of the module's setting.
    checksum: Option<bool>,
    /// In milliseconds.
    period: u64,
    /// The field is to have the focus.
    wants_focus: bool,
}

impl Default for CommandLine {
    fn default() -> Self {
        Self {
            text: String::new(),
            history: History::default(),
            stepping: false,
            checksum: None,
            period: 1_000,
            wants_focus: false,
        }
    }
}

impl CommandLine {
    /// Puts a line into the field, which gets the focus.
    pub fn put(&mut self, line: String) {
        self.text = line;
        self.stepping = false;
        self.wants_focus = true;
    }

    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let checksum = self.checksum.unwrap_or(module.target.checksum);
        let typed = spelled(module, &self.text);
        let command = RawCommand::parse(&typed, checksum);
        let obstacle = sending::obstacle(module, pass, command.as_ref().ok());
        let entered = self.entry(ui, module, pass, command.is_ok() && obstacle.is_none(), obstacle.as_deref());
        // What was typed in this frame counts, not what was judged before.
        let typed = spelled(module, &self.text);
        let command = RawCommand::parse(&typed, checksum);
        self.judgement(ui, module, &command, obstacle.as_deref());
        self.hints(ui, &typed, checksum);
        self.wire(ui, module, pass, command.as_ref().ok().filter(|_| obstacle.is_none()));
        if let (true, Ok(command), None) = (entered, command, obstacle) {
            self.history.add(&typed);
            self.stepping = false;
            sending::send(module, pass, command);
        }
    }

    /// Field, checksum and button; true if it is to be sent.
    fn entry(&mut self, ui: &mut Ui, module: &Module, pass: &Pass<'_>, sendable: bool, obstacle: Option<&str>) -> bool {
        let mut entered = false;
        ui.horizontal(|ui| {
            let dcon = module.target.protocol != Protocol::ModbusTcp;
            let beside =
                theme::BUTTON_WIDTH + theme::GAP + if dcon { theme::NUMBER_FIELD + theme::GAP_SECTION } else { 0.0 };
            let width = ui.available_width() - beside - theme::FIELD_MARGIN;
            entered |= self.field(ui, module, pass, width);
            if dcon {
                let mut checksum = self.checksum.unwrap_or(module.target.checksum);
                let word = if module.target.checksum { "on" } else { "off" };
                let response = ui
                    .add(Checkbox::new(&mut checksum, "Checksum"))
                    .on_hover_text(format!("Of DCON commands; the module's own setting is {word}"));
                if response.changed() {
                    self.checksum = Some(checksum).filter(|wanted| *wanted != module.target.checksum);
                }
            }
            let button = Button::new("Send").min_size(eframe::egui::vec2(theme::BUTTON_WIDTH, theme::CONTROL_HEIGHT));
            let button = ui.add_enabled(sendable, button).on_hover_text("Sends it once (Enter)");
            entered |= button.on_disabled_hover_text(obstacle.unwrap_or("Write a command first")).clicked();
        });
        entered
    }

    fn field(&mut self, ui: &mut Ui, module: &Module, pass: &Pass<'_>, width: f32) -> bool {
        let id = ui.make_persistent_id("command line");
        if ui.memory(|memory| memory.has_focus(id)) {
            self.step(ui, id, pass);
        }
        let hint = match module.target.protocol {
            Protocol::Dcon => format!("${:02X}M", module.target.address),
            _ => format!("{:02X} 03 00 00 00 01", module.target.address),
        };
        let edit = TextEdit::singleline(&mut self.text).id(id).font(TextStyle::Monospace).hint_text(hint);
        let response = ui.add(edit.desired_width(width));
        widgets::name_field(&response, "Command", &self.text);
        let response =
            response.on_hover_text("What is sent to the module; arrow up and down bring back what was sent before");
        if response.changed() {
            self.history.edited();
            self.stepping = false;
        }
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if entered || std::mem::take(&mut self.wants_focus) {
            response.request_focus();
            cursor_to_end(ui, id, &self.text);
        }
        entered
    }

    /// Up and Down take up again what was sent before.
    fn step(&mut self, ui: &Ui, id: Id, pass: &Pass<'_>) {
        let up = ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::ArrowUp));
        let down = ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::ArrowDown));
        let line = if up {
            if !self.stepping {
                // Other modules' commands are there too.
                self.history = History::from(pass.settings.command_history.clone());
            }
            self.history.older(&self.text).map(str::to_owned)
        } else if down {
            self.history.newer().map(str::to_owned)
        } else {
            None
        };
        if let Some(line) = line {
            self.stepping = true;
            self.text = line;
            cursor_to_end(ui, id, &self.text);
        }
    }

    /// What the command does, or why it is none. The room is kept while nothing is typed.
    fn judgement(&self, ui: &mut Ui, module: &Module, command: &Result<RawCommand, String>, obstacle: Option<&str>) {
        let palette = theme::palette(ui);
        match (command, obstacle) {
            _ if self.text.trim().is_empty() => {
                let start = match module.target.protocol {
                    Protocol::Dcon => "A DCON command with its address, or hex and the bytes of a Modbus request",
                    Protocol::ModbusRtu => "The bytes of a Modbus request, address first; the CRC is added",
                    Protocol::ModbusTcp => "The bytes of a Modbus request, address first; DCON is for serial lines",
                };
                sending::told(ui, Glyph::Dashes, palette.quiet, start);
            }
            (Err(reason), _) => sending::wrong(ui, palette, reason),
            (Ok(_), Some(obstacle)) => sending::wrong(ui, palette, obstacle),
            (Ok(command), None) => sending::mark(ui, module, command),
        }
    }

    /// What is probably meant instead, with a button that takes it.
    fn hints(&mut self, ui: &mut Ui, typed: &str, checksum: bool) {
        let hint = check_typed(typed, checksum).into_iter().next();
        ui.horizontal(|ui| {
            ui.set_height(theme::CONTROL_HEIGHT);
            let Some(hint) = hint else { return };
            let palette = theme::palette(ui);
            widgets::glyph(ui, Glyph::Outline, palette.warning);
            if let Some(better) = hint.better
                && ui.button(format!("Use {better}")).on_hover_text("Puts this into the command line").clicked()
            {
                self.put(better);
            }
            let width = ui.available_width();
            widgets::fixed_coloured(ui, width, Align::Min, &hint.text, palette.quiet).on_hover_text(&hint.text);
        });
    }

    /// What goes on the wire, and repeating it.
    fn wire(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, command: Option<&RawCommand>) {
        let console = &module.console;
        ui.horizontal(|ui| {
            let palette = theme::palette(ui);
            widgets::quiet_small(ui, "On the wire");
            let repeat = theme::PERIOD_WIDTH + theme::BUTTON_WIDTH + theme::COUNTS_WIDTH + 3.0 * theme::GAP;
            let width = (ui.available_width() - repeat).max(0.0);
            let text = command.map(|command| sending::preview(module, command)).unwrap_or_default();
            let (rect, response) =
                ui.allocate_exact_size(eframe::egui::vec2(width, theme::CONTROL_HEIGHT), eframe::egui::Sense::hover());
            widgets::line_in(ui, rect, Align::Min, &text, theme::mono(), palette.text);
            widgets::describe(&response, Role::Label, &format!("On the wire {text}"));
            response.on_hover_text(&text);
            widgets::at_right(ui, |ui| {
                self.repeat_button(ui, module, pass, command);
                let range = DragValue::new(&mut self.period).range(PERIODS).suffix(" ms").speed(10);
                ui.add_sized([theme::PERIOD_WIDTH, theme::CONTROL_HEIGHT], range)
                    .on_hover_text("From one sending to the next");
                if let Some(repeating) = console.repeating() {
                    let text = format!("{} sent, {} answered", repeating.plan.sent, repeating.plan.answered);
                    let width = theme::COUNTS_WIDTH;
                    widgets::fixed_coloured(ui, width, Align::Max, &text, palette.quiet)
                        .on_hover_text(repeating.plan.command.to_string());
                }
            });
        });
    }

    fn repeat_button(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, command: Option<&RawCommand>) {
        let size = eframe::egui::vec2(theme::BUTTON_WIDTH, theme::CONTROL_HEIGHT);
        if module.console.is_repeating() {
            let button = ui.add(Button::new("Stop").min_size(size));
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Stop repeating"));
            if button.on_hover_text("Ends the repeating").clicked() {
                pass.actions.push(Action::StopRaw(module.target));
            }
            return;
        }
        let button = ui.add_enabled(command.is_some(), Button::new("Repeat").min_size(size));
        let button = button.on_hover_text("Send it again and again").on_disabled_hover_text("Write a command first");
        if let (true, Some(command)) = (button.clicked(), command) {
            sending::repeat(module, pass, command.clone(), Duration::from_millis(self.period));
        }
    }
}

/// For a module that speaks Modbus the word `hex` may be left out.
fn spelled(module: &Module, text: &str) -> String {
    let text = text.trim();
    let bytes = module.target.protocol.is_modbus() && hex::parse(text).is_ok_and(|bytes| !bytes.is_empty());
    if bytes { format!("hex {text}") } else { text.to_owned() }
}

fn cursor_to_end(ui: &Ui, id: Id, text: &str) {
    let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    let end = CCursor::new(text.chars().count());
    state.cursor.set_char_range(Some(CCursorRange::one(end)));
    state.store(ui.ctx(), id);
}
