//! What the dashboard says while there is no module: what is missing, and what to do about it.

use eframe::egui::Ui;

use super::app::Pass;
use super::{connect, theme, widgets};
use crate::bench::{Action, ScanState};

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>) {
    ui.add_space(theme::GAP_SECTION);
    ui.vertical(|ui| {
        ui.set_max_width(theme::TEXT_WIDTH);
        match pass.bench.scan() {
            Some(ScanState::Running { .. }) => searching(ui),
            Some(ScanState::Ended(_)) => nothing_found(ui, pass),
            None if pass.connect.line(pass.bench, pass.settings).is_ok() => not_searched(ui, pass),
            None if pass.bench.knows_no_ports_yet() => looking(ui),
            None => no_port(ui, pass),
        }
    });
}

fn looking(ui: &mut Ui) {
    let palette = theme::palette(ui);
    let lines = ["They stand in the list at the top left as soon as the system has told them."];
    widgets::empty_state(ui, palette, "Looking for serial ports", &lines);
}

fn searching(ui: &mut Ui) {
    let palette = theme::palette(ui);
    let lines = ["Modules appear on the left as soon as they answer."];
    widgets::empty_state(ui, palette, "Searching the line", &lines);
}

fn nothing_found(ui: &mut Ui, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    let lines = [
        "Is the module powered? PIR-130: 10 to 30 V DC, PIR-234: 10 to 48 V DC.",
        "Are D+ and D− swapped, or is the line not terminated?",
        "Does the module speak another protocol or speed? A full scan tries them all.",
        "DIP 2 OFF: the switches rule, and the address is 160 to 191.",
    ];
    widgets::empty_state(ui, palette, "No module answered", &lines);
    ui.horizontal(|ui| {
        connect::offers(ui, pass);
        connect::offer_simulated(ui, pass);
    });
}

fn no_port(ui: &mut Ui, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    let lines = ["Plug in an adapter and choose it at the top left, or try the simulated line."];
    widgets::empty_state(ui, palette, "There is no serial port", &lines);
    connect::hints(ui, pass.bench.port_hints());
    ui.horizontal(|ui| {
        if ui.button("Look again").on_hover_text("Looks up which ports there are now").clicked() {
            pass.actions.push(Action::RefreshPorts);
        }
        connect::offer_simulated(ui, pass);
    });
}

fn not_searched(ui: &mut Ui, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    let lines = ["Choose the line at the top left, then search it for modules."];
    widgets::empty_state(ui, palette, "Nothing searched yet", &lines);
    ui.horizontal(|ui| {
        connect::offers(ui, pass);
        connect::offer_simulated(ui, pass);
    });
}
