//! What a command does before it is sent, and sending it: what changes a module, or is heard by all, is asked for twice.

use eframe::egui::{Align, Color32, Ui};

use crate::bench::console::{Exchange, RawCommand, Script};
use crate::bench::{Action, Module};
use crate::module::{Danger, Definition, Explanation, danger, explain};
use crate::protocol::{Protocol, modbus};
use crate::ui::app::Pass;
use crate::ui::guard::Confirm;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets::{self, Glyph};

/// The Modbus that a module is reached by, or would be.
pub fn modbus_of(module: &Module) -> Protocol {
    match module.target.protocol {
        Protocol::ModbusTcp => Protocol::ModbusTcp,
        Protocol::ModbusRtu | Protocol::Dcon => Protocol::ModbusRtu,
    }
}

fn protocol_of(module: &Module, command: &RawCommand) -> Protocol {
    match command {
        RawCommand::Dcon { .. } => Protocol::Dcon,
        RawCommand::Modbus { .. } => modbus_of(module),
    }
}

/// Whether the frames of `command` carry a DCON checksum.
fn with_checksum(command: &RawCommand) -> bool {
    matches!(command, RawCommand::Dcon { checksum: true, .. })
}

/// Address, function and data behind the header of Modbus TCP; its number does not matter here.
fn behind_header(body: &[u8]) -> Vec<u8> {
    let length = u16::try_from(body.len()).unwrap_or(u16::MAX).to_be_bytes();
    [&[0, 0, 0, 0], &length[..], body].concat()
}

/// The frame as the module hears it.
fn frame(module: &Module, command: &RawCommand) -> Vec<u8> {
    match command {
        RawCommand::Modbus { bytes } if module.target.protocol == Protocol::ModbusTcp => behind_header(bytes),
        command => command.on_wire(),
    }
}

/// What a command means.
pub fn meaning(module: &Module, command: &RawCommand) -> Explanation {
    let protocol = protocol_of(module, command);
    explain(definition_for(module, command), protocol, with_checksum(command), &frame(module, command), None)
}

/// What the answer of an exchange means; `None` while there is none.
pub fn meaning_of_answer(module: &Module, exchange: &Exchange) -> Option<Explanation> {
    let answer = exchange.result.as_ref()?.as_ref().ok().filter(|answer| !answer.is_empty())?;
    let command = &exchange.sent;
    let protocol = protocol_of(module, command);
    let answer = match protocol {
        Protocol::ModbusTcp => behind_header(answer),
        Protocol::ModbusRtu if !ends_with_crc(answer) => modbus::with_crc(answer),
        _ => answer.clone(),
    };
    let request = frame(module, command);
    Some(explain(definition_for(module, command), protocol, with_checksum(command), &request, Some(&answer)))
}

fn ends_with_crc(frame: &[u8]) -> bool {
    let split = frame.len().checked_sub(2).and_then(|at| frame.split_at_checked(at));
    split.is_some_and(|(body, crc)| modbus::crc(body).to_le_bytes() == crc)
}

/// The address that a command names; `None` for a broadcast, and for what names none.
fn addressed(command: &RawCommand) -> Option<u8> {
    match command {
        RawCommand::Dcon { text, .. } => u8::from_str_radix(text.get(1..3)?, 16).ok(),
        RawCommand::Modbus { bytes } => bytes.first().copied().filter(|address| *address != 0),
    }
}

/// What is known of the module that a command goes to: nothing if it is not the one of this tab, because the same command
/// may read on one model and write on another.
fn definition_for<'a>(module: &'a Module, command: &RawCommand) -> Option<&'a Definition> {
    let here = addressed(command).is_none_or(|address| address == module.target.address);
    module.definition().map(AsRef::as_ref).filter(|_| here)
}

/// To whom a command goes, for a question.
fn receiver(module: &Module, command: &RawCommand) -> String {
    match addressed(command) {
        Some(address) if address != module.target.address => format!("address {address}, which is not this module"),
        _ => format!("{} at address {}", module.label(), module.target.address),
    }
}

/// What a command may do; `None` if it only reads.
pub fn danger_of(module: &Module, command: &RawCommand) -> Option<Danger> {
    danger(
        definition_for(module, command),
        protocol_of(module, command),
        with_checksum(command),
        &frame(module, command),
    )
}

/// Why nothing can be sent at present, or not this.
pub fn obstacle(module: &Module, pass: &Pass<'_>, command: Option<&RawCommand>) -> Option<String> {
    if !pass.bench.line().is_open() {
        return Some("The line is not open – open it first".to_owned());
    }
    let over_tcp = module.target.protocol == Protocol::ModbusTcp;
    let dcon = matches!(command, Some(RawCommand::Dcon { .. }));
    (over_tcp && dcon).then(|| no_dcon().to_owned())
}

/// Why there is no DCON over a network.
pub fn no_dcon() -> &'static str {
    "DCON commands are for serial lines; this module is reached over Modbus TCP – use a Modbus request"
}

/// Mark and words for what a command does.
pub fn mark(ui: &mut Ui, module: &Module, command: &RawCommand) {
    let palette = theme::palette(ui);
    let meaning = meaning(module, command);
    let (glyph, colour, text) = match &meaning.danger {
        None => (Glyph::Ring, palette.quiet, format!("Reads: {}", meaning.summary)),
        Some(danger) => (Glyph::Triangle, palette.warning, danger.to_string()),
    };
    told(ui, glyph, colour, &text);
}

/// One line with a mark, cut where there is no room; the whole stands on hover.
pub fn told(ui: &mut Ui, glyph: Glyph, colour: Color32, text: &str) {
    ui.horizontal(|ui| {
        widgets::glyph(ui, glyph, colour);
        let width = ui.available_width();
        widgets::fixed_coloured(ui, width, Align::Min, text, colour).on_hover_text(text);
    });
}

/// [`told`] of something that is wrong.
pub fn wrong(ui: &mut Ui, palette: &Palette, text: &str) {
    told(ui, Glyph::Cross, palette.error, &sentence(text));
}

/// With a capital at its beginning.
pub fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map(|first| first.to_uppercase().chain(characters).collect()).unwrap_or_default()
}

/// Sends once; what does more than read is asked for first.
pub fn send(module: &Module, pass: &mut Pass<'_>, command: RawCommand) {
    pass.settings.note_command(command.to_string());
    let action = Action::SendRaw(module.target, command.clone());
    ask_or_do(module, pass, &command, action, "");
}

/// Sends again and again; what does more than read is asked for first.
pub fn repeat(module: &Module, pass: &mut Pass<'_>, command: RawCommand, period: std::time::Duration) {
    pass.settings.note_command(command.to_string());
    let action = Action::RepeatRaw(module.target, command.clone(), period);
    let again = format!("Again and again, every {} ms until it is stopped", period.as_millis());
    ask_or_do(module, pass, &command, action, &again);
}

fn ask_or_do(module: &Module, pass: &mut Pass<'_>, command: &RawCommand, action: Action, more: &str) {
    let Some(danger) = danger_of(module, command) else { return pass.actions.push(action) };
    let mut lines = vec![danger.to_string(), format!("On the wire: {}", preview(module, command))];
    if !more.is_empty() {
        lines.push(more.to_owned());
    }
    *pass.confirm = Some(Confirm {
        title: format!("Send {command} to {}", receiver(module, command)),
        lines,
        button: button_of(&danger).to_owned(),
        actions: vec![action],
    });
}

fn button_of(danger: &Danger) -> &'static str {
    match danger {
        Danger::Broadcast { .. } => "Send to every module",
        Danger::Writes { .. } => "Send and change the module",
        Danger::Unknown { .. } => "Send what is not known",
    }
}

/// Runs a script; what lines of it do more than read is told first.
pub fn run(module: &Module, pass: &mut Pass<'_>, script: &Script) {
    const MOST: usize = 8;
    let dangers: Vec<String> = script
        .commands()
        .filter_map(|(line, command)| Some(format!("Line {line}, {command}: {}", danger_of(module, command)?)))
        .collect();
    let action = Action::RunScript(module.target, script.clone());
    if dangers.is_empty() {
        return pass.actions.push(action);
    }
    let more = dangers.len().saturating_sub(MOST);
    let mut lines: Vec<String> = dangers.into_iter().take(MOST).collect();
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    *pass.confirm = Some(Confirm {
        title: format!("This script does more than read from {}", module.label()),
        lines,
        button: "Run the script".to_owned(),
        actions: vec![action],
    });
}

/// What exactly goes out.
pub fn preview(module: &Module, command: &RawCommand) -> String {
    match command {
        RawCommand::Modbus { bytes } if module.target.protocol == Protocol::ModbusTcp => {
            format!("{} behind the header of Modbus TCP", crate::protocol::hex::spaced(bytes))
        }
        command => command.preview(),
    }
}
