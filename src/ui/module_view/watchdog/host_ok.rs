//! Sending Host OK: once, or again and again with a period that the watchdog does not outlast.

use std::time::Duration;

use eframe::egui::{Align, Align2, Button, Key, TextEdit, Ui};

use super::questions;
use crate::bench::{Action, HOST_OK, Module};
use crate::ui::app::Pass;
use crate::ui::module_view::form;
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

/// In seconds; shorter ones would leave no room on the line.
const PERIOD: &str =
    "How often Host OK is sent; well below the watchdog's timeout, so that one lost frame does no harm";
const SHORTEST: f64 = 0.05;
/// A day.
const LONGEST: f64 = 86_400.0;
/// While the timeout is not known.
const DEFAULT: f64 = 1.0;

/// What was typed as the period; the safe one until then.
#[derive(Default)]
pub struct Period {
    typed: Option<String>,
}

impl Period {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        form::heading(ui, "Host OK");
        let known = module.definition().and_then(|definition| definition.action(HOST_OK));
        if !known.is_some_and(|action| action.is_offered(module.target.protocol)) {
            return not_offered(ui, module);
        }
        ui.horizontal(|ui| {
            form::action(ui, module, pass, HOST_OK);
            widgets::quiet(ui, "once, a broadcast that every module of the line hears and none answers");
        });
        let chosen = self.field_and_buttons(ui, module, pass);
        let typed = self.typed.is_some();
        ui.horizontal(|ui| progress(ui, module, pass, &chosen, typed));
    }

    fn text(&self, module: &Module) -> String {
        self.typed.clone().unwrap_or_else(|| {
            let running = module.host_ok.as_ref().map(|host_ok| host_ok.period);
            let safe = module.safe_host_ok_period().filter(|period| !period.is_zero());
            let period = running.or(safe).map_or(DEFAULT, |period| period.as_secs_f64());
            if period < 0.1 { format!("{:.2}", period.max(SHORTEST)) } else { format!("{period:.1}") }
        })
    }

    fn field_and_buttons(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) -> Result<Duration, String> {
        let palette = theme::palette(ui);
        let mut text = self.text(module);
        let chosen = judge(module, &text);
        ui.horizontal(|ui| {
            widgets::fixed_coloured(ui, theme::FORM_LABEL, Align::Min, "Send again every", palette.quiet)
                .on_hover_text(PERIOD);
            let mut edit =
                TextEdit::singleline(&mut text).desired_width(theme::WINDOW_FIELD_WIDTH).align(Align2::RIGHT_CENTER);
            if chosen.is_err() && self.typed.is_some() {
                edit = edit.text_color(palette.error);
            }
            let response = ui.add(edit);
            widgets::name_field(&response, "Host OK period", &text);
            let response = response.on_hover_text(PERIOD);
            if response.changed() {
                self.typed = Some(text);
            }
            let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            if response.has_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
                self.typed = None;
            }
            widgets::fixed_coloured(ui, theme::FORM_UNIT, Align::Min, "s", palette.quiet);
            self.buttons(ui, module, pass, &chosen, entered);
        });
        chosen
    }

    fn buttons(
        &mut self,
        ui: &mut Ui,
        module: &Module,
        pass: &mut Pass<'_>,
        chosen: &Result<Duration, String>,
        entered: bool,
    ) {
        let obstacle = pass.bench.line().obstacle();
        let reason = obstacle.map(str::to_owned).or_else(|| chosen.as_ref().err().cloned());
        let possible = reason.is_none();
        let running = module.host_ok.as_ref().map(|host_ok| host_ok.period);
        let other = chosen.as_ref().is_ok_and(|chosen| running.is_some_and(|running| !same(*chosen, running)));
        if running.is_none() || other || chosen.is_err() {
            let word = if running.is_some() { "Use this period" } else { "Start Host OK" };
            let button = ui.add_enabled(possible, Button::new(word));
            let button = button.on_hover_text("Tells all modules again and again that the host is there");
            let button = button.on_disabled_hover_text(reason.unwrap_or_default());
            if let (true, Ok(period)) = (button.clicked() || entered && possible, chosen) {
                pass.actions.push(Action::StartHostOk(module.target, *period));
                self.typed = None;
            }
        }
        if running.is_some() {
            let button = ui.button("Stop sending");
            if button.on_hover_text("Without Host OK a watchdog that is enabled trips after its timeout").clicked() {
                stop(module, pass);
            }
        }
    }
}

/// Stops Host OK, after a question while the watchdog is enabled.
pub fn stop(module: &Module, pass: &mut Pass<'_>) {
    match questions::before_stopping(module) {
        Some(question) => *pass.confirm = Some(question),
        None => pass.actions.push(Action::StopHostOk(module.target)),
    }
}

/// As the field shows it.
fn same(a: Duration, b: Duration) -> bool {
    a.abs_diff(b) < Duration::from_millis(50)
}

/// The period, or why it will not do.
fn judge(module: &Module, text: &str) -> Result<Duration, String> {
    let seconds = text.trim().replace(',', ".").parse::<f64>().ok();
    let Some(seconds) = seconds.filter(|seconds| (SHORTEST..=LONGEST).contains(seconds)) else {
        return Err(format!("\"{text}\" is not a period – use {SHORTEST} s or more"));
    };
    let period = Duration::from_secs_f64(seconds);
    match module.watchdog_timeout() {
        Some(Duration::ZERO) => Err("The timeout is 0 s – write a timeout first".to_owned()),
        Some(timeout) if period > timeout => {
            let timeout = questions::seconds(timeout);
            Err(format!("Too late: the watchdog trips after {timeout} – use {timeout} or less"))
        }
        _ => Ok(period),
    }
}

/// What is being sent, or why it cannot be; the room is always kept.
fn progress(ui: &mut Ui, module: &Module, pass: &Pass<'_>, chosen: &Result<Duration, String>, typed: bool) {
    let palette = theme::palette(ui);
    let (glyph, colour, text) = match (&module.host_ok, chosen) {
        (_, Err(reason)) if typed => (Glyph::Cross, palette.error, reason.clone()),
        (None, Err(reason)) => (Glyph::Ring, palette.quiet, reason.clone()),
        (Some(host_ok), _) => match (&host_ok.problem, host_ok.last) {
            (Some(problem), _) => (Glyph::Cross, palette.error, format!("Not sent: {problem}")),
            (None, Some(last)) => {
                let age = words::age(words::since(last, pass.bench.now()));
                let sent = format!("{}, {} sent, the last {age} ago", questions::period_words(host_ok), host_ok.sent);
                (Glyph::Disc, palette.ok, sent)
            }
            (None, None) => (Glyph::Dashes, palette.quiet, "about to be sent".to_owned()),
        },
        (None, Ok(period)) => match module.watchdog_timeout() {
            Some(timeout) if period.saturating_mul(2) > timeout => {
                (Glyph::Outline, palette.warning, "One message that is lost lets the watchdog trip".to_owned())
            }
            _ => (Glyph::Ring, palette.quiet, "Not being sent from here".to_owned()),
        },
    };
    widgets::glyph(ui, glyph, colour);
    let width = ui.available_width();
    widgets::fixed_coloured(ui, width, Align::Min, &text, colour).on_hover_text(&text);
}

fn not_offered(ui: &mut Ui, module: &Module) {
    let protocol = module.target.protocol.label();
    widgets::quiet(
        ui,
        &format!(
            "Not offered over {protocol}: the manual documents no Host OK over Modbus, and does not say whether Modbus \
             traffic feeds the watchdog. Try it before you rely on it."
        ),
    );
}
