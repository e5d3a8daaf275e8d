//! Scanning: the buttons that begin it, how far it is, and how it went.

use eframe::egui::{self, Align, Ui};

use super::{Ready, plan_of};
use crate::bench::{Action, LineState, ScanState};
use crate::bus::{ScanProgress, ScanSummary};
use crate::ui::app::Pass;
use crate::ui::scan_form::ScanForm;
use crate::ui::settings::{LineChoice, Settings};
use crate::ui::{faults, theme, widgets, words};

/// Scans at once, or with what the menu beside it offers.
pub fn buttons(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    let scanning = pass.bench.is_scanning();
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
        let quick = pass.connect.scan(pass.bench, pass.settings, plan_of(Ready::Quick, pass.settings));
        let reason = if scanning { Some(RUNNING) } else { quick.as_ref().err().map(String::as_str) };
        let button = ui.add_enabled(reason.is_none(), egui::Button::new("Scan"));
        let button = button.on_disabled_hover_text(reason.unwrap_or_default());
        if button.on_hover_text(quick_words(pass.settings)).clicked()
            && let Ok(action) = quick
        {
            pass.actions.push(action);
        }
        let options = |ui: &mut Ui| widgets::menu(ui, "", "Scan options", |ui| scan_menu(ui, pass, form));
        let options = ui.add_enabled_ui(!scanning, options).inner;
        options.on_hover_text("Other scans: more places, or those that you choose").on_disabled_hover_text(RUNNING);
    });
}

pub const RUNNING: &str = "A scan is running";

/// What a quick scan asks.
pub fn quick_words(settings: &Settings) -> String {
    match settings.line {
        LineChoice::Tcp => "Asks NetID 1 over Modbus TCP".to_owned(),
        _ => format!("Asks 33 likely addresses in both protocols at {}", settings.line_settings),
    }
}

/// What a full scan asks.
pub fn full_words(settings: &Settings) -> &'static str {
    match settings.line {
        LineChoice::Tcp => "All 247 NetIDs",
        _ => "Every address, speed, format, protocol and checksum",
    }
}

fn scan_menu(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    ui.set_width(theme::SCAN_MENU_WIDTH);
    let kinds = [
        (Ready::Quick, "Quick scan", quick_words(pass.settings)),
        (Ready::Full, "Full scan", full_words(pass.settings).to_owned()),
    ];
    for (ready, title, explanation) in kinds {
        let plan = plan_of(ready, pass.settings);
        let title_with_time = format!("{title} – at most {}", words::span(plan.duration()));
        let action = pass.connect.scan(pass.bench, pass.settings, plan);
        let response = widgets::menu_entry(ui, action.is_ok(), &title_with_time, &explanation);
        widgets::describe(&response, egui::Role::MenuItem, title);
        if response.clicked()
            && let Ok(action) = action
        {
            pass.actions.push(action);
            ui.close();
        }
    }
    if widgets::menu_entry(ui, true, "Custom…", "Choose addresses, speeds, formats and protocols").clicked() {
        form.open(pass.settings);
        ui.close();
    }
}

/// How far the scan is, and what holds or ends it.
pub fn running(ui: &mut Ui, progress: Option<&ScanProgress>, found: usize, actions: &mut Vec<Action>) {
    let paused = progress.is_some_and(|progress| progress.paused);
    let (done, total) = progress.map_or((0, 0), |progress| (progress.done, progress.total));
    let part = if total == 0 { 0.0 } else { done as f32 / total as f32 };
    let place = progress.map(|progress| format!("at {}, {}", progress.at.address, words::spoken(&progress.at)));
    let place = place.unwrap_or_default();
    widgets::progress(ui, part, "Scan progress")
        .on_hover_text(format!("{done} of {total} asked, {found} found\n{place}"));
    widgets::fixed(ui, theme::PERCENT_WIDTH, Align::Max, &format!("{:.0} %", (part * 100.0).floor()));
    let left = match progress {
        _ if paused => "paused".to_owned(),
        Some(progress) => format!("{} left", words::span(progress.left)),
        None => String::new(),
    };
    widgets::fixed(ui, theme::TIME_LEFT, Align::Min, &left);
    let hold = if paused { "Resume" } else { "Pause" };
    let button = egui::Button::new(hold).min_size(egui::vec2(theme::BUTTON_WIDTH, theme::CONTROL_HEIGHT));
    if ui.add(button).on_hover_text("The scan waits and goes on where it was").clicked() {
        actions.push(Action::PauseScan(!paused));
    }
    if ui.button("Stop").on_hover_text("Ends the scan; what was found stays").clicked() {
        actions.push(Action::CancelScan);
    }
    let width = ui.available_width() - theme::BUTTON_WIDTH;
    if width >= theme::PLACE_LEAST {
        widgets::fixed_coloured(ui, width, Align::Min, &place, theme::palette(ui).quiet);
    }
}

/// While no scan runs: how the last one went.
pub fn at_rest(ui: &mut Ui, pass: &mut Pass<'_>) {
    if !matches!(pass.bench.line(), LineState::Closed) {
        let close = ui.button("Close line").on_hover_text("Gives the port back; polling ends");
        if close.clicked() {
            pass.actions.push(Action::Disconnect);
        }
    }
    faults::button(ui, pass);
    if let Some(ScanState::Ended(summary)) = pass.bench.scan() {
        let response = widgets::quiet(ui, &ended(summary));
        if !summary.unreadable.is_empty() {
            response.on_hover_ui(|ui| unreadable(ui, summary));
        }
    }
}

/// How the last scan went.
fn ended(summary: &ScanSummary) -> String {
    let ScanSummary { done, total, found, unreadable, cancelled, lost } = summary;
    let modules = if *found == 1 { "1 module".to_owned() } else { format!("{found} modules") };
    let outcome = match (lost, cancelled) {
        (Some(_), _) => format!("Line lost after {done} of {total} – {modules} found"),
        (None, true) => format!("Stopped after {done} of {total} – {modules} found"),
        (None, false) => format!("{modules} found, {total} asked"),
    };
    if unreadable.is_empty() { outcome } else { format!("{outcome}, {} unreadable", unreadable.len()) }
}

/// Most places listed; the rest is counted.
const PLACES_LISTED: usize = 12;

fn unreadable(ui: &mut Ui, summary: &ScanSummary) {
    ui.label("Something came back that is no answer: noise, another speed, or two modules at one address");
    for (target, reason) in summary.unreadable.iter().take(PLACES_LISTED) {
        widgets::quiet(ui, &format!("{target}: {reason}"));
    }
}
