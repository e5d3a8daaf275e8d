//! The top row: which line, at which speed, and the scan.

pub mod recent;

use eframe::egui::{self, Align, RichText, TextEdit, Ui};

use super::app::Pass;
use super::faults;
use super::scan_form::ScanForm;
use super::settings::{self, LineChoice, Now, Settings};
use super::{theme, widgets, words};
use crate::bench::{Action, Bench, LineState, ScanState};
use crate::bus::{LineAddress, PortInfo, ScanPlan, ScanProgress, ScanSummary};
use crate::protocol::{BaudRate, DataFormat};
use crate::sim::{FaultKind, Faults};

pub const SIMULATED: &str = "Simulated line";
const TCP: &str = "Modbus TCP";

/// The kinds of scan that need no form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ready {
    Quick,
    Full,
}

/// What the line selector remembers.
pub struct Connect {
    simulated: LineAddress,
    /// The simulated line that was asked for last, and is to be open.
    asked: Option<Action>,
    /// The list of lines was open in the last frame.
    list_open: bool,
}

impl Connect {
    pub fn new(simulated: LineAddress) -> Self {
        Self { simulated, asked: None, list_open: false }
    }

    /// The chosen line, or why there is none.
    pub fn line(&self, bench: &Bench, settings: &Settings) -> Result<LineAddress, String> {
        match &settings.line {
            LineChoice::Simulated => Ok(self.simulated.clone()),
            LineChoice::Tcp => LineAddress::tcp(settings.host.trim()),
            LineChoice::Port(port) => Ok(LineAddress::Serial { port: present_name(bench, settings, port).to_owned() }),
            LineChoice::FirstPort => match bench.ports().first() {
                Some(port) => Ok(LineAddress::Serial { port: port.name.clone() }),
                None => Err("There is no serial port – plug in an adapter, or choose the simulated line".to_owned()),
            },
        }
    }

    /// Why the chosen line cannot be scanned, if so.
    pub fn obstacle(&self, bench: &Bench, settings: &Settings) -> Option<String> {
        let line = match self.line(bench, settings) {
            Ok(line) => line,
            Err(reason) => return Some(reason),
        };
        let lost = bench.line().line().filter(|_| bench.line().is_lost());
        let is_lost = lost.is_some_and(|lost| lost.to_string() == line.to_string());
        bench.line().obstacle().filter(|_| is_lost).map(str::to_owned)
    }

    /// A line came back under the name of `line`.
    pub fn follow(&mut self, line: &LineAddress) {
        if matches!(line, LineAddress::Simulated { .. }) {
            self.simulated = line.clone();
        }
    }

    /// Takes note of the line that is asked for.
    pub fn note(&mut self, action: &Action) {
        match action {
            Action::Scan { line, .. } | Action::Connect { line, .. } => {
                let simulated = matches!(line, LineAddress::Simulated { .. });
                self.asked = simulated.then(|| action.clone());
            }
            Action::Disconnect => self.asked = None,
            _ => {}
        }
    }

    /// What opens the simulated line that a fault has kept closed, when `wanted` is to end that fault.
    pub fn mended(&self, bench: &Bench, wanted: &Faults) -> Option<Action> {
        let before = bench.faults().filter(|_| matches!(bench.line(), LineState::Closed))?;
        let keeps_closed = [FaultKind::Unplugged, FaultKind::Renamed];
        let ends = keeps_closed.into_iter().any(|kind| before.is_on(kind) && !wanted.is_on(kind));
        self.asked.clone().filter(|_| ends)
    }

    /// Chooses the simulated line and scans it.
    pub fn try_simulated(&self, settings: &mut Settings) -> Action {
        settings.line = LineChoice::Simulated;
        let plan = plan_of(Ready::Quick, settings);
        Action::Scan { line: self.simulated.clone(), settings: settings.line_settings, plan }
    }

    /// The action of scanning the chosen line, or why it cannot be scanned.
    pub fn scan(&self, bench: &Bench, settings: &Settings, plan: ScanPlan) -> Result<Action, String> {
        if let Some(reason) = self.obstacle(bench, settings) {
            return Err(reason);
        }
        let line = self.line(bench, settings)?;
        Ok(Action::Scan { line, settings: settings.line_settings, plan })
    }
}

/// What a ready-made scan asks on the chosen line. A quick scan keeps to the chosen speed and format.
pub fn plan_of(ready: Ready, settings: &Settings) -> ScanPlan {
    let over_tcp = settings.line == LineChoice::Tcp;
    match ready {
        Ready::Quick if over_tcp => ScanPlan::tcp(),
        Ready::Full if over_tcp => ScanPlan { addresses: (1..=247).collect(), ..ScanPlan::tcp() },
        Ready::Quick => ScanPlan {
            baud_rates: vec![settings.line_settings.baud_rate],
            data_formats: vec![settings.line_settings.data_format],
            ..ScanPlan::quick()
        },
        Ready::Full => ScanPlan::full(),
    }
}

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    // With large text it takes two rows.
    let one_row = ui.available_width() >= theme::CONNECT_WIDTH;
    ui.horizontal(|ui| {
        line_selector(ui, pass);
        if one_row {
            settings_and_scan(ui, pass, form);
        }
        widgets::at_right(ui, |ui| settings::menu(ui, pass));
    });
    if !one_row {
        ui.horizontal_wrapped(|ui| settings_and_scan(ui, pass, form));
    }
}

fn settings_and_scan(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    match pass.settings.line {
        LineChoice::Tcp => host(ui, pass.settings),
        _ => speed_and_format(ui, pass.settings),
    }
    scan_buttons(ui, pass, form);
    if let Some(ScanState::Running { progress, found, .. }) = pass.bench.scan() {
        running(ui, progress.as_ref(), *found, pass.actions);
    } else {
        at_rest(ui, pass);
    }
}

/// What the port `name` is called now, if its adapter was plugged in elsewhere since it was chosen.
fn present_name<'a>(bench: &'a Bench, settings: &Settings, name: &'a str) -> &'a str {
    if bench.ports().iter().any(|port| port.name == name) {
        return name;
    }
    let known = settings.recent_ports.iter().find(|recent| recent.name() == name);
    match known.map(|recent| recent.now(bench.ports())) {
        Some(Now::There(port)) => &port.name,
        _ => name,
    }
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

fn line_selector(ui: &mut Ui, pass: &mut Pass<'_>) {
    let text = chosen(pass.connect, pass.bench, pass.settings);
    // The list holds a field, so a click in it does not close it.
    let combo = widgets::combo("line", theme::LINE_BOX_WIDTH, text.trim_end())
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    let response = combo.show_ui(ui, |ui| {
        ui.set_min_width(theme::LINE_MENU_WIDTH);
        lines(ui, pass);
    });
    widgets::name_combo(&response.response, "Line", &text);
    let open = response.inner.is_some();
    if open && !pass.connect.list_open {
        pass.actions.push(Action::RefreshPorts);
    }
    pass.connect.list_open = open;
}

fn lines(ui: &mut Ui, pass: &mut Pass<'_>) {
    recent::rows(ui, pass);
    let (bench, settings) = (pass.bench, &mut *pass.settings);
    widgets::section(ui, "Serial ports");
    if bench.ports().is_empty() {
        widgets::quiet(ui, "None – plug in an adapter and open this list again");
    }
    hints(ui, bench);
    for port in bench.ports() {
        port_entry(ui, port, settings);
    }
    other_port(ui, settings);
    widgets::section(ui, "Others");
    choice(ui, settings, LineChoice::Tcp, TCP);
    choice(ui, settings, LineChoice::Simulated, SIMULATED);
}

/// What is known of adapters that are plugged in but have no port, and what gives them one.
pub fn hints(ui: &mut Ui, bench: &Bench) {
    let palette = theme::palette(ui);
    for hint in bench.port_hints() {
        ui.horizontal_top(|ui| {
            widgets::glyph(ui, widgets::Glyph::Outline, palette.warning);
            ui.add(egui::Label::new(RichText::new(hint).color(palette.text)).wrap());
        });
    }
}

/// An entry of the list; a click chooses it and closes the list.
fn choice(ui: &mut Ui, settings: &mut Settings, line: LineChoice, name: &str) {
    if ui.selectable_label(settings.line == line, name).clicked() {
        settings.line = line;
        ui.close();
    }
}

fn port_entry(ui: &mut Ui, port: &PortInfo, settings: &mut Settings) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        choice(ui, settings, LineChoice::Port(port.name.clone()), &port.name);
        widgets::quiet(ui, &port.description);
        if let Some(problem) = &port.problem {
            widgets::glyph(ui, widgets::Glyph::Triangle, palette.warning);
            ui.label(RichText::new(short(problem)).color(palette.warning)).on_hover_text(problem);
        }
    });
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
        if ui.add_enabled(named, egui::Button::selectable(chosen, "Other port")).clicked() {
            settings.line = choice;
            ui.close();
        }
        let field = TextEdit::singleline(&mut settings.other_port).desired_width(theme::HOST_WIDTH);
        let response = ui.add(field.hint_text(if cfg!(windows) { "COM12" } else { "/dev/pts/3" }));
        widgets::name_field(&response, "Other port", &settings.other_port);
        if response.changed() {
            settings.line = LineChoice::Port(settings.other_port.trim().to_owned());
        }
        if response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
            ui.close();
        }
    });
}

fn host(ui: &mut Ui, settings: &mut Settings) {
    let field =
        TextEdit::singleline(&mut settings.host).desired_width(theme::HOST_WIDTH).hint_text("Host or host:port");
    let response = ui.add(field);
    widgets::name_field(&response, "Host", &settings.host);
}

fn speed_and_format(ui: &mut Ui, settings: &mut Settings) {
    let chosen = &mut settings.line_settings;
    let speed = chosen.baud_rate.to_string();
    let combo = widgets::combo("speed", theme::SPEED_WIDTH, &speed);
    let response = combo.show_ui(ui, |ui| {
        for rate in BaudRate::ALL {
            ui.selectable_value(&mut chosen.baud_rate, rate, format!("{rate} bps"));
        }
    });
    widgets::name_combo(&response.response, "Speed", &speed);
    let format = chosen.data_format.label();
    let combo = widgets::combo("format", theme::FORMAT_WIDTH, format);
    let response = combo.show_ui(ui, |ui| {
        for format in DataFormat::ALL {
            ui.selectable_value(&mut chosen.data_format, format, format.label());
        }
    });
    widgets::name_combo(&response.response, "Data format", format);
}

fn scan_buttons(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    let scanning = pass.bench.is_scanning();
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
        let quick = pass.connect.scan(pass.bench, pass.settings, plan_of(Ready::Quick, pass.settings));
        let reason = if scanning { Some("A scan is running") } else { quick.as_ref().err().map(String::as_str) };
        let button = ui.add_enabled(reason.is_none(), egui::Button::new("Scan"));
        let button = button.on_disabled_hover_text(reason.unwrap_or_default());
        if button.on_hover_text(quick_words(pass.settings)).clicked()
            && let Ok(action) = quick
        {
            pass.actions.push(action);
        }
        ui.add_enabled_ui(!scanning, |ui| widgets::menu(ui, "", "Scan options", |ui| scan_menu(ui, pass, form)));
    });
}

fn quick_words(settings: &Settings) -> String {
    match settings.line {
        LineChoice::Tcp => "Asks NetID 1 over Modbus TCP".to_owned(),
        _ => format!("Asks 33 likely addresses in both protocols at {}", settings.line_settings),
    }
}

fn scan_menu(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    ui.set_width(theme::SCAN_MENU_WIDTH);
    let full_words = match pass.settings.line {
        LineChoice::Tcp => "All 247 NetIDs",
        _ => "Every address, speed, format, protocol and checksum",
    };
    let kinds =
        [(Ready::Quick, "Quick scan", quick_words(pass.settings)), (Ready::Full, "Full scan", full_words.to_owned())];
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

fn running(ui: &mut Ui, progress: Option<&ScanProgress>, found: usize, actions: &mut Vec<Action>) {
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
    if ui.add(button).clicked() {
        actions.push(Action::PauseScan(!paused));
    }
    if ui.button("Stop").clicked() {
        actions.push(Action::CancelScan);
    }
    let width = ui.available_width() - theme::BUTTON_WIDTH;
    if width >= theme::PLACE_LEAST {
        widgets::fixed_coloured(ui, width, Align::Min, &place, theme::palette(ui).quiet);
    }
}

fn at_rest(ui: &mut Ui, pass: &mut Pass<'_>) {
    if !matches!(pass.bench.line(), LineState::Closed) && ui.button("Close line").clicked() {
        pass.actions.push(Action::Disconnect);
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

/// The buttons that an empty list offers.
pub fn offers(ui: &mut Ui, pass: &mut Pass<'_>) {
    recent::offer(ui, pass);
    let scanning = pass.bench.is_scanning();
    for (ready, name) in [(Ready::Quick, "Quick scan"), (Ready::Full, "Full scan")] {
        let action = pass.connect.scan(pass.bench, pass.settings, plan_of(ready, pass.settings));
        let button = ui.add_enabled(!scanning && action.is_ok(), egui::Button::new(name));
        if button.clicked()
            && let Ok(action) = action
        {
            pass.actions.push(action);
        }
    }
}

pub fn offer_simulated(ui: &mut Ui, pass: &mut Pass<'_>) {
    if ui.button("Try the simulated line").clicked() {
        let action = pass.connect.try_simulated(pass.settings);
        pass.actions.push(action);
    }
}

/// Carries out the form's scan, if it can be.
pub fn scan_with(pass: &mut Pass<'_>, plan: ScanPlan) {
    match pass.connect.scan(pass.bench, pass.settings, plan) {
        Ok(action) => pass.actions.push(action),
        Err(reason) => pass.actions.push(Action::Notify(crate::bench::Severity::Error, reason)),
    }
}
