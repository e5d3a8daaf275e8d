//! Raw Modbus by function and register, with the names of what lives there, and the table of registers to pick from.

use std::slice;

use eframe::egui::{Align, Button, Response, Role, Sense, TextEdit, TextStyle, Ui, WidgetInfo};

use super::reference::search_field;
use super::{Wish, line_size, scrolled, sending};
use crate::bench::Module;
use crate::bench::console::{FormFunction, ModbusForm, Numbering, RawCommand, RegisterEntry, search_registers};
use crate::protocol::Protocol;
use crate::ui::app::Pass;
use crate::ui::tables::{Sheet, copied};
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

#[derive(Default)]
pub struct ModbusPage {
    form: ModbusForm,
    sought: String,
}

impl ModbusPage {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &Pass<'_>, registers: &[RegisterEntry]) -> Option<Wish> {
        if module.target.protocol == Protocol::Dcon {
            let colour = theme::palette(ui).quiet;
            let text = "The module speaks DCON at present and does not answer Modbus requests";
            sending::told(ui, Glyph::Outline, colour, text);
        }
        self.function(ui);
        self.fields(ui);
        let request = self.form.request(module.target.address).map(|bytes| RawCommand::Modbus { bytes });
        self.description(ui, module, &request, registers);
        let wish = buttons(ui, module, pass, request);
        ui.add_space(theme::UNIT);
        self.table(ui, registers);
        wish
    }

    fn function(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            name(ui, "Function", FUNCTION);
            let width = (ui.available_width() - theme::GAP).min(theme::FORM_LABEL);
            let response = widgets::combo("function", width, self.form.function.label()).show_ui(ui, |ui| {
                for function in FormFunction::ALL {
                    ui.selectable_value(&mut self.form.function, function, function.label());
                }
            });
            widgets::name_combo(&response.response, "Function", self.form.function.label());
            response.response.on_hover_text(FUNCTION);
        });
    }

    fn fields(&mut self, ui: &mut Ui) {
        if self.form.function == FormFunction::Custom {
            ui.horizontal(|ui| {
                let means = "Function code of the request in hexadecimal, such as 46";
                name(ui, "Code", means);
                field(ui, &mut self.form.custom_code, ("Function code", means), theme::NUMBER_FIELD);
                widgets::quiet(ui, "hexadecimal, data");
                let width = ui.available_width() - theme::GAP;
                let means = "What follows the function code, in hexadecimal; the CRC is added";
                field(ui, &mut self.form.custom_data, ("Data bytes", means), width);
            });
            ui.allocate_exact_size(line_size(ui), Sense::hover());
            return;
        }
        ui.horizontal(|ui| {
            let means = "The first coil or register that is meant";
            name(ui, "First", means);
            field(ui, &mut self.form.first, ("First", means), theme::NUMBER_FIELD);
            ui.spacing_mut().item_spacing.x = theme::UNIT;
            let numberings = [
                (Numbering::Register, "register, from 1", "As the manuals count"),
                (Numbering::Wire, "wire, from 0", "As the number is sent, one less than the manuals' own"),
            ];
            for (numbering, text, means) in numberings {
                if widgets::chip(ui, self.form.numbering == numbering, text, text, means) {
                    self.form.count_from(numbering);
                }
            }
        });
        ui.horizontal(|ui| {
            if self.form.function.is_read() {
                let means = "How many are read in one request";
                name(ui, "Count", means);
                field(ui, &mut self.form.count, ("Count", means), theme::NUMBER_FIELD);
                widgets::quiet(ui, &format!("1 to {}", self.form.function.most()));
            } else {
                let means = "What is written, from the first one on";
                name(ui, "Values", means);
                let width = ui.available_width() - theme::GAP;
                field(ui, &mut self.form.values, ("Values", means), width);
            }
        });
    }

    /// What lives there, what the request does, and how it looks.
    fn description(
        &self,
        ui: &mut Ui,
        module: &Module,
        request: &Result<RawCommand, String>,
        registers: &[RegisterEntry],
    ) {
        let palette = theme::palette(ui);
        let described = self.form.describe(registers).unwrap_or_default();
        let width = line_size(ui).x;
        widgets::fixed_coloured(ui, width, Align::Min, &described, palette.text).on_hover_text(&described);
        match request {
            Ok(command) => sending::mark(ui, module, command),
            Err(reason) => sending::wrong(ui, palette, reason),
        }
    }

    fn table(&mut self, ui: &mut Ui, registers: &[RegisterEntry]) {
        search_field(ui, &mut self.sought, "Search the registers", "Name or number, 486 or 40486");
        let found = search_registers(registers, &self.sought);
        scrolled(ui, "registers", |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if registers.is_empty() {
                widgets::quiet(ui, "The definition of this module names no registers.");
            } else if found.is_empty() {
                widgets::quiet(ui, "No register has all of these words – use fewer");
            }
            for entry in &found {
                let response = row(ui, entry);
                copied(&response, |part| sheet(part.of(slice::from_ref(entry), found.as_slice())));
                if response.clicked() {
                    self.form = ModbusForm { numbering: Numbering::Register, ..ModbusForm::reading(entry) };
                }
            }
        });
    }
}

/// Registers as they are copied.
fn sheet(entries: &[&RegisterEntry]) -> Sheet {
    let mut sheet = Sheet::new(["Kind", "Number", "Wire", "Name", "Access", "Used by", "Manual"]);
    for entry in entries {
        sheet.push([
            entry.space.noun(),
            &numbers_of(entry),
            &entry.wire().to_string(),
            &entry.label,
            access(entry),
            &entry.items.join(", "),
            &entry.source,
        ]);
    }
    sheet
}

fn access(entry: &RegisterEntry) -> &'static str {
    if entry.writable { "read, write" } else { "read" }
}

/// A register with both numbers and what is there; a click picks it.
fn row(ui: &mut Ui, entry: &RegisterEntry) -> Response {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(line_size(ui), Sense::click());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised_hovered);
    }
    let inner = rect.shrink2(eframe::egui::vec2(theme::UNIT, 0.0));
    let (numbers, rest) = inner.split_left_right_at_x(inner.left() + theme::REGISTER_NUMBERS);
    let text = format!("{} {}  (wire {})", entry.space.noun(), numbers_of(entry), entry.wire());
    widgets::line_in(ui, numbers, Align::Min, &text, theme::small(), palette.quiet);
    let access_width = widgets::line_in(ui, rest, Align::Max, access(entry), theme::small(), palette.quiet).width();
    let rest = rest.with_min_x(rest.left() + theme::UNIT).with_max_x(rest.right() - access_width - theme::GAP);
    widgets::line_in(ui, rest, Align::Min, &entry.label, theme::body(), palette.text);
    let name = format!("{text}: {}", entry.items.join(", "));
    widgets::describe(&response, Role::ListItem, &name);
    let manual = if entry.source.is_empty() { String::new() } else { format!("\nManual {}", entry.source) };
    response.on_hover_text(format!("{}\n{}{manual}", entry.label, entry.items.join(", ")))
}

fn numbers_of(entry: &RegisterEntry) -> String {
    match entry.count {
        0 | 1 => entry.number.to_string(),
        many => {
            format!("{}–{}", entry.number, u32::from(entry.number).saturating_add(u32::from(many)).saturating_sub(1))
        }
    }
}

fn buttons(ui: &mut Ui, module: &Module, pass: &Pass<'_>, request: Result<RawCommand, String>) -> Option<Wish> {
    let palette = theme::palette(ui);
    let mut wish = None;
    ui.horizontal(|ui| {
        let obstacle = sending::obstacle(module, pass, request.as_ref().ok());
        let button = ui.add_enabled(request.is_ok() && obstacle.is_none(), Button::new("Send"));
        button.widget_info(|| WidgetInfo::labeled(Role::Button, button.enabled(), "Send the request"));
        let button = button.on_disabled_hover_text(obstacle.unwrap_or_else(|| "Put the fields right first".to_owned()));
        let button = button.on_hover_text("Sends it once, as it stands at the right");
        let put = ui.add_enabled(request.is_ok(), Button::new("Put into the command line"));
        let put = put.on_hover_text("To be changed there before it is sent");
        let preview = request.as_ref().map(|command| sending::preview(module, command)).unwrap_or_default();
        let (rect, response) = ui.allocate_exact_size(line_size(ui), Sense::hover());
        widgets::line_in(ui, rect, Align::Min, &preview, theme::small_mono(), palette.quiet);
        widgets::describe(&response, Role::Label, &preview);
        response.on_hover_text(&preview);
        let Ok(command) = request else { return };
        if put.clicked() {
            wish = Some(Wish::Line(command.to_string()));
        }
        if button.clicked() {
            wish = Some(Wish::Send(command));
        }
    });
    wish
}

const FUNCTION: &str = "What is asked for, by its Modbus function";

fn name(ui: &mut Ui, text: &str, means: &str) {
    let colour = theme::palette(ui).quiet;
    widgets::fixed_coloured(ui, theme::NUMBER_FIELD, Align::Min, text, colour).on_hover_text(means);
}

fn field(ui: &mut Ui, text: &mut String, (name, means): (&str, &str), width: f32) {
    let edit = TextEdit::singleline(text).font(TextStyle::Monospace).desired_width(width - theme::FIELD_MARGIN);
    let response = ui.add(edit);
    widgets::name_field(&response, name, text);
    response.on_hover_text(means);
}
