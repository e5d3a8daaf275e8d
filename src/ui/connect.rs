//! The top row: which line, at which speed, and the scan.

mod lines;
pub mod recent;
mod scanning;

use eframe::egui::{self, TextEdit, Ui};

pub use lines::hints;

use super::app::Pass;
use super::scan_form::ScanForm;
use super::settings::{self, LineChoice, Now, Settings};
use super::{theme, widgets};
use crate::bench::{Action, Bench, LineState, ScanState};
use crate::bus::{LineAddress, ScanPlan};
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
    list: lines::List,
}

impl Connect {
    pub fn new(simulated: LineAddress) -> Self {
        Self { simulated, asked: None, list: lines::List::default() }
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
        lines::selector(ui, pass);
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
    scanning::buttons(ui, pass, form);
    if let Some(ScanState::Running { progress, found, .. }) = pass.bench.scan() {
        scanning::running(ui, progress.as_ref(), *found, pass.actions);
    } else {
        scanning::at_rest(ui, pass);
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

fn host(ui: &mut Ui, settings: &mut Settings) {
    let field =
        TextEdit::singleline(&mut settings.host).desired_width(theme::HOST_WIDTH).hint_text("Host or host:port");
    let response = ui.add(field);
    widgets::name_field(&response, "Host", &settings.host);
    response.on_hover_text("Name or address of the module or gateway; without a port it is 502");
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
    response.response.on_hover_text("Speed of the line in bits a second, for the next scan");
    let format = chosen.data_format.label();
    let combo = widgets::combo("format", theme::FORMAT_WIDTH, format);
    let response = combo.show_ui(ui, |ui| {
        for format in DataFormat::ALL {
            ui.selectable_value(&mut chosen.data_format, format, format.label());
        }
    });
    widgets::name_combo(&response.response, "Data format", format);
    response.response.on_hover_text("Data bits, parity and stop bits, for the next scan");
}

/// The buttons that an empty list offers.
pub fn offers(ui: &mut Ui, pass: &mut Pass<'_>) {
    recent::offer(ui, pass);
    let scanning = pass.bench.is_scanning();
    for (ready, name) in [(Ready::Quick, "Quick scan"), (Ready::Full, "Full scan")] {
        let action = pass.connect.scan(pass.bench, pass.settings, plan_of(ready, pass.settings));
        let button = ui.add_enabled(!scanning && action.is_ok(), egui::Button::new(name));
        let means = match ready {
            Ready::Quick => scanning::quick_words(pass.settings),
            Ready::Full => scanning::full_words(pass.settings).to_owned(),
        };
        let reason = action.as_ref().err().cloned().unwrap_or_else(|| scanning::RUNNING.to_owned());
        if button.on_hover_text(means).on_disabled_hover_text(reason).clicked()
            && let Ok(action) = action
        {
            pass.actions.push(action);
        }
    }
}

pub fn offer_simulated(ui: &mut Ui, pass: &mut Pass<'_>) {
    let button = ui.button("Try the simulated line");
    if button.on_hover_text("Modules that the program imitates; nothing has to be connected").clicked() {
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
