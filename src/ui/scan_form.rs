//! The second row: a scan of one's own choice.

use std::time::Duration;

use eframe::egui::{self, Align, DragValue, RichText, Sense, TextEdit, Ui, vec2};

use super::app::Pass;
use super::connect;
use super::settings::{LineChoice, Settings};
use super::{theme, widgets, words};
use crate::bus::ScanPlan;
use crate::protocol::{BaudRate, DataFormat, Protocol, parse_addresses};

/// Listening window, in milliseconds.
const WINDOWS: std::ops::RangeInclusive<u64> = 5..=2_000;

/// What stands in the form.
pub struct ScanForm {
    pub open: bool,
    addresses: String,
    plan: ScanPlan,
    /// The plan that `duration` belongs to.
    measured: Option<(ScanPlan, usize, Duration)>,
}

impl Default for ScanForm {
    fn default() -> Self {
        Self { open: false, addresses: "1,160-191".to_owned(), plan: ScanPlan::quick(), measured: None }
    }
}

impl ScanForm {
    /// Opens the form; the first time with the chosen speed and format.
    pub fn open(&mut self, settings: &Settings) {
        self.open = true;
        if self.measured.is_none() {
            self.plan.baud_rates = vec![settings.line_settings.baud_rate];
            self.plan.data_formats = vec![settings.line_settings.data_format];
        }
    }

    /// The plan as it stands, or what is missing.
    fn plan(&self, over_tcp: bool) -> Result<ScanPlan, String> {
        let addresses = parse_addresses(&self.addresses)?;
        if over_tcp {
            return Ok(ScanPlan { addresses, stop_at_first: self.plan.stop_at_first, ..ScanPlan::tcp() });
        }
        let ScanPlan { baud_rates, data_formats, protocols, checksums, .. } = &self.plan;
        let missing = [
            (baud_rates.is_empty(), "a speed"),
            (data_formats.is_empty(), "a format"),
            (protocols.is_empty(), "a protocol"),
            (checksums.is_empty() && protocols.contains(&Protocol::Dcon), "with or without checksum"),
        ];
        match missing.into_iter().find(|(missing, _)| *missing) {
            Some((_, what)) => Err(format!("Choose {what}")),
            None => Ok(ScanPlan { addresses, ..self.plan.clone() }),
        }
    }

    /// Places and time of a plan; counted anew only when it has changed.
    fn measure(&mut self, plan: &ScanPlan) -> (usize, Duration) {
        if let Some((measured, places, duration)) = &self.measured
            && measured == plan
        {
            return (*places, *duration);
        }
        let (places, duration) = (plan.targets().len(), plan.duration());
        self.measured = Some((plan.clone(), places, duration));
        (places, duration)
    }
}

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm) {
    let over_tcp = pass.settings.line == LineChoice::Tcp;
    ui.horizontal(|ui| {
        addresses(ui, form);
        if !over_tcp {
            ui.add_space(theme::GAP);
            window(ui, &mut form.plan.window);
        }
        ui.add_space(theme::GAP);
        let first = ui.checkbox(&mut form.plan.stop_at_first, "Stop at the first");
        first.on_hover_text("The scan ends as soon as one module has answered");
    });
    if !over_tcp {
        ui.horizontal(|ui| speeds_and_formats(ui, &mut form.plan));
        ui.horizontal(|ui| languages(ui, &mut form.plan));
    }
    ui.horizontal(|ui| conclusion(ui, pass, form, over_tcp));
}

/// The name of a row and what it means; all rows begin at the same place.
fn row_name(ui: &mut Ui, name: &str, means: &str) {
    let colour = theme::palette(ui).quiet;
    widgets::fixed_coloured(ui, theme::ROW_NAME, Align::Min, name, colour).on_hover_text(means);
}

const ADDRESSES: &str = "Numbers and ranges: 1,160-191 or A0h-BFh";
const SPEEDS: &str = "Asks at this speed; each one takes its time for every address";
const FORMATS: &str = "Data bits, parity and stop bits";
const PROTOCOLS: &str = "Asks in this protocol; a module answers in the one that it is set to";
const CHECKSUMS: &str = "A DCON module answers only if the checksum is there, or left out, as it is set";

fn addresses(ui: &mut Ui, form: &mut ScanForm) {
    row_name(ui, "Addresses", ADDRESSES);
    let response = ui.add(TextEdit::singleline(&mut form.addresses).desired_width(theme::ADDRESSES_WIDTH));
    let response = response.on_hover_text(ADDRESSES);
    widgets::name_field(&response, "Addresses", &form.addresses);
}

fn speeds_and_formats(ui: &mut Ui, plan: &mut ScanPlan) {
    row_name(ui, "Speeds", SPEEDS);
    chips(ui, ("Speed", SPEEDS), &BaudRate::ALL, &mut plan.baud_rates, |rate| rate.to_string());
    ui.add_space(theme::GAP);
    widgets::quiet(ui, "Formats").on_hover_text(FORMATS);
    chips(ui, ("Format", FORMATS), &DataFormat::ALL, &mut plan.data_formats, |format| format.label().to_owned());
}

fn languages(ui: &mut Ui, plan: &mut ScanPlan) {
    row_name(ui, "Protocols", PROTOCOLS);
    chips(ui, ("Protocol", PROTOCOLS), &Protocol::SERIAL, &mut plan.protocols, |protocol| protocol.label().to_owned());
    if plan.protocols.contains(&Protocol::Dcon) {
        ui.add_space(theme::GAP);
        widgets::quiet(ui, "DCON checksum").on_hover_text(CHECKSUMS);
        let word = |with: &bool| if *with { "with".to_owned() } else { "without".to_owned() };
        chips(ui, ("Checksum", CHECKSUMS), &[false, true], &mut plan.checksums, word);
    }
}

/// Chips for `all`, of which those in `chosen` are on. They keep the order of `all`.
fn chips<T: Copy + PartialEq>(
    ui: &mut Ui,
    (kind, means): (&str, &str),
    all: &[T],
    chosen: &mut Vec<T>,
    word: impl Fn(&T) -> String,
) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
        for value in all {
            let on = chosen.contains(value);
            let word = word(value);
            if widgets::chip(ui, on, &word, &format!("{kind} {word}"), means) {
                *chosen = all.iter().copied().filter(|other| chosen.contains(other) != (other == value)).collect();
            }
        }
    });
}

fn window(ui: &mut Ui, window: &mut Duration) {
    widgets::quiet(ui, "Listen for");
    let mut milliseconds = window.as_millis() as u64;
    let field = DragValue::new(&mut milliseconds).range(WINDOWS).suffix(" ms");
    let response = ui.add_sized([theme::WINDOW_FIELD_WIDTH, theme::CONTROL_HEIGHT], field);
    response.on_hover_text("From the end of a question to the first byte of an answer");
    *window = Duration::from_millis(milliseconds);
}

fn conclusion(ui: &mut Ui, pass: &mut Pass<'_>, form: &mut ScanForm, over_tcp: bool) {
    ui.allocate_exact_size(vec2(theme::ROW_NAME, theme::CONTROL_HEIGHT), Sense::hover());
    let plan = form.plan(over_tcp);
    let scanning = pass.bench.is_scanning();
    let start = ui.add_enabled(plan.is_ok() && !scanning, egui::Button::new("Start scan"));
    if ui.button("Close").on_hover_text("What is chosen here is kept for the next time").clicked() {
        form.open = false;
    }
    match plan {
        Ok(plan) => {
            let (places, duration) = form.measure(&plan);
            let text = format!("{} to ask, at most {}", words::counted(places, "place"), words::span(duration));
            widgets::fixed(ui, ui.available_width(), Align::Min, &text);
            if start.clicked() {
                connect::scan_with(pass, plan);
                form.open = false;
            }
        }
        Err(reason) => {
            let palette = theme::palette(ui);
            ui.label(RichText::new(reason).color(palette.error));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_without_a_speed_says_what_is_missing() {
        let mut form = ScanForm::default();
        form.plan.baud_rates.clear();
        assert_eq!(form.plan(false), Err("Choose a speed".to_owned()));
        assert!(form.plan(true).is_ok());
    }
}
