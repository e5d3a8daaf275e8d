//! The list of lines to choose from: recent ones, the ports that the system knows, and what needs no port.

use std::slice;

use eframe::egui::{self, Rect, Response, RichText, TextEdit, Ui};

use super::{Connect, SIMULATED, TCP, present_name, recent};
use crate::bench::{Action, Bench};
use crate::bus::PortInfo;
use crate::ui::app::Pass;
use crate::ui::settings::{LineChoice, RecentLine, Settings};
use crate::ui::tables::{Sheet, copied_row};
use crate::ui::{theme, widgets};

/// The box that shows the chosen line and opens the list.
pub fn selector(ui: &mut Ui, pass: &mut Pass<'_>) {
    let text = chosen(pass.connect, pass.bench, pass.settings);
    // The list holds a field, so a click in it does not close it.
    let combo = widgets::combo("line", theme::LINE_BOX_WIDTH, text.trim_end())
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    let response = combo.show_ui(ui, |ui| {
        ui.set_min_width(theme::LINE_MENU_WIDTH);
        lines(ui, pass);
    });
    widgets::name_combo(&response.response, "Line", &text);
    let (is_open, list) = (response.inner.is_some(), &mut pass.connect.list);
    response.response.on_hover_text("Where the modules are: a serial port, a network, or the simulated line");
    if is_open && !list.is_open {
        pass.actions.push(Action::RefreshPorts);
    }
    if !is_open || !list.is_open {
        // In its first frame, which nobody sees, the ports are not looked up yet.
        list.shown = None;
    }
    list.is_open = is_open;
}

/// What is remembered of the list between frames.
#[derive(Default)]
pub struct List {
    is_open: bool,
    shown: Option<Shown>,
}

/// What the open list shows: it stays as it was looked up, so that nothing moves under the pointer.
struct Shown {
    recent: Vec<RecentLine>,
    ports: Vec<PortInfo>,
    hints: Vec<String>,
}

impl Shown {
    fn of(bench: &Bench, settings: &Settings) -> Self {
        Self {
            recent: settings.recent_ports.clone(),
            ports: bench.ports().to_vec(),
            hints: bench.port_hints().to_vec(),
        }
    }
}

fn lines(ui: &mut Ui, pass: &mut Pass<'_>) {
    let mut shown = pass.connect.list.shown.take().unwrap_or_else(|| Shown::of(pass.bench, pass.settings));
    recent::rows(ui, pass, &mut shown.recent);
    let settings = &mut *pass.settings;
    widgets::section(ui, "Serial ports");
    if shown.ports.is_empty() {
        widgets::quiet(ui, "None – plug in an adapter and open this list again");
    }
    hints(ui, &shown.hints);
    for port in &shown.ports {
        let row = port_entry(ui, port, settings);
        copied_row(ui, row, ui.scope_id().with(("port", &port.name)), |part| {
            sheet(part.of(slice::from_ref(port), shown.ports.as_slice()))
        });
    }
    other_port(ui, settings);
    widgets::section(ui, "Others");
    choice(ui, settings, LineChoice::Tcp, TCP).on_hover_text("A PIR-234 with Ethernet or Wi-Fi, or a gateway");
    let simulated = choice(ui, settings, LineChoice::Simulated, SIMULATED);
    simulated.on_hover_text("Modules that the program imitates, for trying it without any");
    pass.connect.list.shown = Some(shown);
}

/// Ports as they are copied.
fn sheet(ports: &[PortInfo]) -> Sheet {
    let mut sheet = Sheet::new(["Port", "Description", "USB", "Serial number", "Problem"]);
    for PortInfo { name, description, problem, usb } in ports {
        let (ids, serial) = match usb {
            Some(usb) => (format!("{:04x}:{:04x}", usb.vendor, usb.product), usb.serial.as_deref().unwrap_or_default()),
            None => (String::new(), ""),
        };
        sheet.push([name, description, &ids, serial, problem.as_deref().unwrap_or_default()]);
    }
    sheet
}

/// What is known of adapters that are plugged in but have no port, and what gives them one.
pub fn hints(ui: &mut Ui, hints: &[String]) {
    let palette = theme::palette(ui);
    for hint in hints {
        ui.horizontal_top(|ui| {
            widgets::glyph(ui, widgets::Glyph::Outline, palette.warning);
            ui.add(egui::Label::new(RichText::new(hint).color(palette.text)).wrap());
        });
    }
}

/// An entry of the list; a click chooses it and closes the list.
fn choice(ui: &mut Ui, settings: &mut Settings, line: LineChoice, name: &str) -> Response {
    let response = ui.selectable_label(settings.line == line, name);
    if response.clicked() {
        settings.line = line;
        ui.close();
    }
    response
}

/// Where it stands.
fn port_entry(ui: &mut Ui, port: &PortInfo, settings: &mut Settings) -> Rect {
    let palette = theme::palette(ui);
    let row = ui.horizontal(|ui| {
        choice(ui, settings, LineChoice::Port(port.name.clone()), &port.name).on_hover_text("Chooses this port");
        widgets::quiet(ui, &port.description);
        if let Some(problem) = &port.problem {
            widgets::glyph(ui, widgets::Glyph::Triangle, palette.warning);
            ui.label(RichText::new(short(problem)).color(palette.warning)).on_hover_text(problem);
        }
    });
    row.response.rect
}

/// What happened, without what to do about it.
fn short(problem: &str) -> &str {
    problem.split_once(" – ").map_or(problem, |(happened, _)| happened)
}

/// A port that the system does not list, such as a pseudo-terminal, by its name.
fn other_port(ui: &mut Ui, settings: &mut Settings) {
    ui.horizontal(|ui| {
        let choice = LineChoice::Port(settings.other_port.trim().to_owned());
        let chosen = settings.line == choice;
        let named = !settings.other_port.trim().is_empty();
        let means = "A port that the system does not list, by its name";
        let entry = ui.add_enabled(named, egui::Button::selectable(chosen, "Other port")).on_hover_text(means);
        if entry.on_disabled_hover_text("Write its name first").clicked() {
            settings.line = choice;
            ui.close();
        }
        let field = TextEdit::singleline(&mut settings.other_port).desired_width(theme::HOST_WIDTH);
        let response = ui.add(field.hint_text(if cfg!(windows) { "COM12" } else { "/dev/pts/3" }));
        widgets::name_field(&response, "Other port", &settings.other_port);
        let response = response.on_hover_text(means);
        if response.changed() {
            settings.line = LineChoice::Port(settings.other_port.trim().to_owned());
        }
        if response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
            ui.close();
        }
    });
}

/// The name of the chosen line, and what the system knows of it.
fn chosen(connect: &Connect, bench: &Bench, settings: &Settings) -> String {
    let named = |port: &PortInfo| format!("{}   {}", port.name, port.description);
    match &settings.line {
        LineChoice::Simulated => connect.simulated.to_string(),
        LineChoice::Tcp => TCP.to_owned(),
        LineChoice::FirstPort => bench.ports().first().map_or_else(|| "No serial port".to_owned(), named),
        LineChoice::Port(name) => {
            let name = present_name(bench, settings, name);
            let present = bench.ports().iter().find(|port| port.name == name);
            present.map_or_else(|| format!("{name}   not listed"), named)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::UsbIdentity;

    #[test]
    fn ports_are_copied_with_what_tells_adapters_apart_and_why_one_cannot_be_opened() {
        let usb = UsbIdentity { vendor: 0x0403, product: 0x6001, serial: Some("A1".to_owned()), interface: None };
        let port = |name: &str, usb, problem: Option<&str>| PortInfo {
            name: name.to_owned(),
            description: "Port".to_owned(),
            problem: problem.map(str::to_owned),
            usb,
        };
        let ports = [port("COM1", None, Some("busy")), port("COM3", Some(usb), None)];
        let text =
            "Port\tDescription\tUSB\tSerial number\tProblem\nCOM1\tPort\t\t\tbusy\nCOM3\tPort\t0403:6001\tA1\t\n";
        assert_eq!(sheet(&ports).into_text(), text);
    }
}
