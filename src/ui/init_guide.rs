//! The guided change in INIT mode: its steps, what each asks for, and what came of it.

mod marks;
mod words;

use eframe::egui::{
    Align, Button, Context, Id, Key, Label, Layout, Modal, Response, RichText, Role, Sense, TextStyle, Ui, WidgetInfo,
    vec2,
};

use super::app::Pass;
use super::modal;
use super::picture::{self, Look};
use super::theme::{self, Palette};
use super::widgets::{self, Glyph};
use crate::bench::{Action, InitChange, InitProcedure, InitStep, Module, Simulated};
use crate::bus::LineAddress;
use crate::module::{BankState, Definition, Position, SwitchPanel};
use crate::picture::{Picture, switch_picture};
use marks::StepMark;

/// What the guide remembers between frames.
#[derive(Default)]
pub struct InitGuide {
    /// The step that was drawn last.
    step: Option<InitStep>,
    /// Switch and power of the simulated module were turned in this step.
    turned: bool,
}

/// The switch that puts a module into INIT mode.
struct Switch {
    bank: usize,
    number: u8,
    name: String,
}

impl InitGuide {
    /// Draws the guide over everything else while a change is under way.
    pub fn show(&mut self, ctx: &Context, pass: &mut Pass<'_>) {
        let bench = pass.bench;
        let Some(init) = bench.init() else {
            self.step = None;
            return;
        };
        let Some(module) = bench.module(&init.module) else { return };
        if self.step != Some(init.step) {
            self.step = Some(init.step);
            self.turned = false;
        }
        let frame = theme::guide_frame(if ctx.global_style().visuals.dark_mode { &theme::DARK } else { &theme::LIGHT });
        let modal = Modal::new(Id::unique("init guide")).frame(frame);
        let modal = modal::fit(ctx, modal, theme::GUIDE_WIDTH, |ui| self.contents(ui, init, module, pass));
        let harmless = matches!(init.step, InitStep::SwitchOn | InitStep::Done);
        if harmless && modal.is_top_modal && ctx.input(|input| input.key_pressed(Key::Escape)) {
            pass.actions.push(Action::LeaveInit);
        }
    }

    fn contents(&mut self, ui: &mut Ui, init: &InitProcedure, module: &Module, pass: &mut Pass<'_>) {
        let palette = theme::palette(ui);
        let switch = module.definition().and_then(|definition| init_switch(definition));
        let name = switch.as_ref().map_or("the INIT switch", |switch| switch.name.as_str());
        ui.label(RichText::new("Change in INIT mode").heading().color(palette.text));
        widgets::quiet(ui, &format!("{} at {}", module.label(), init.before));
        ui.add_space(theme::GAP);
        init.changes.iter().for_each(|change| change_row(ui, init, module, change));
        ui.add_space(theme::GAP_SECTION);
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(theme::GUIDE_STEPS);
                steps(ui, init, name);
            });
            if let Some(picture) = switch.as_ref().and_then(|switch| picture_of(module, switch, init.step)) {
                let position = if wants_on(init.step) { "ON" } else { "OFF" };
                let title = format!("{name} is to be {position}");
                let look = Look { width: theme::GUIDE_PICTURE, name: &title, faded: false, clicks: &[] };
                picture::show(ui, &picture, &look);
            }
        });
        ui.add_space(theme::GAP);
        detail(ui, init, module, name, pass);
        ui.add_space(theme::GAP);
        self.buttons(ui, init, pass);
    }

    fn buttons(&mut self, ui: &mut Ui, init: &InitProcedure, pass: &mut Pass<'_>) {
        ui.horizontal(|ui| {
            self.simulated(ui, init, pass);
            widgets::at_right(ui, |ui| {
                if let Some(word) = words::go_on(init) {
                    let open = pass.bench.line().is_open();
                    let response = ui.add_enabled(open || init.is_as_wanted(), Button::new(word));
                    let response = response.on_disabled_hover_text("The line is not open at present");
                    press(&response, Action::ContinueInit, pass);
                    if !ui.memory(|memory| memory.focused().is_some()) {
                        response.request_focus();
                    }
                }
                if init.is_as_wanted() {
                    return;
                }
                if init.is_looking() {
                    let response = ui.button("Back").on_hover_text("To turn switch and power once more");
                    press(&response, Action::BackInInit, pass);
                }
                let response = ui.button("Leave").on_hover_text(words::leaving(init));
                press(&response, Action::LeaveInit, pass);
            });
        });
    }

    /// Nobody can turn the switch of a simulated module by hand.
    fn simulated(&mut self, ui: &mut Ui, init: &InitProcedure, pass: &mut Pass<'_>) {
        let simulated = matches!(pass.bench.line().line(), Some(LineAddress::Simulated { .. }));
        if !simulated || !matches!(init.step, InitStep::SwitchOn | InitStep::SwitchOff) {
            return;
        }
        let word = if self.turned { "Done on the simulated module" } else { "Do this on the simulated module" };
        let response = ui.add_enabled(!self.turned, Button::new(word));
        if response.on_hover_text("Turns its switch, and its power off and on").clicked() {
            self.turned = true;
            for what in [Simulated::Init(wants_on(init.step)), Simulated::PowerCycle] {
                pass.actions.push(Action::Simulated(init.module, what));
            }
        }
    }
}

fn press(response: &Response, action: Action, pass: &mut Pass<'_>) {
    if response.clicked() {
        pass.actions.push(action);
    }
}

/// Whether the switch is to be ON in this step.
fn wants_on(step: InitStep) -> bool {
    step < InitStep::SwitchOff
}

fn init_switch(definition: &Definition) -> Option<Switch> {
    let banks = definition.switch_layout.banks.iter().enumerate();
    let mut groups = banks.flat_map(|(index, bank)| bank.groups.iter().map(move |group| (index, bank, group)));
    let (index, bank, group) = groups.find(|(_, _, group)| {
        let tells = group.rows.iter().any(|row| row.when.iter().any(|(id, _)| id == "init_mode"));
        tells || group.label == "INIT"
    })?;
    Some(Switch { bank: index, number: group.first, name: format!("{} {}", bank.name, group.first) })
}

/// The bank with the switch as it is to be set; the others are drawn as what they are here: of no account.
fn picture_of(module: &Module, switch: &Switch, step: InitStep) -> Option<Picture> {
    let known = |id: &str| module.known(id).cloned();
    let panel = module.definition()?.switches(module.target.address, &known);
    let BankState { label, mut positions } = panel.banks.into_iter().nth(switch.bank)?;
    for state in &mut positions {
        state.in_force = state.number == switch.number;
        if state.in_force {
            state.position = if wants_on(step) { Position::On } else { Position::Off };
        }
    }
    let banks = vec![BankState { label, positions }];
    Some(switch_picture(&SwitchPanel { banks, ..SwitchPanel::default() }))
}

/// One setting: what it was, what it becomes, and what came of it.
fn change_row(ui: &mut Ui, init: &InitProcedure, module: &Module, change: &InitChange) {
    let palette = theme::palette(ui);
    let label = module.item(&change.id).map_or(change.id.as_str(), |item| item.label.as_str());
    let (was, becomes) = (words::was(init, module, change), words::becomes(module, change));
    let (glyph, colour, outcome) = outcome(init, change, palette);
    ui.horizontal(|ui| {
        widgets::fixed_coloured(ui, theme::GUIDE_LABEL, Align::Min, label, palette.quiet);
        widgets::fixed_coloured(ui, theme::GUIDE_VALUE, Align::Max, &was, palette.quiet);
        marks::arrow(ui, palette.quiet);
        widgets::fixed(ui, theme::GUIDE_VALUE, Align::Min, &becomes);
        widgets::glyph(ui, glyph, colour);
        let width = ui.available_width();
        let response = widgets::fixed_coloured(ui, width, Align::Min, &outcome, colour);
        widgets::describe(&response, Role::Label, &format!("{label}: from {was} to {becomes}, {outcome}"));
        response.on_hover_text(outcome);
    });
}

fn outcome(init: &InitProcedure, change: &InitChange, palette: &Palette) -> (Glyph, eframe::egui::Color32, String) {
    match &change.outcome {
        Some(Ok(())) => (Glyph::Disc, palette.ok, "taken".to_owned()),
        Some(Err(reason)) => (Glyph::Cross, palette.error, reason.clone()),
        None if init.step == InitStep::Writing => (Glyph::Dashes, palette.accent, "being written".to_owned()),
        None => (Glyph::Ring, palette.quiet, "not written yet".to_owned()),
    }
}

fn steps(ui: &mut Ui, init: &InitProcedure, switch: &str) {
    let present = words::number(init.step);
    for (number, text) in (1u8..).zip(words::steps(switch)) {
        let mark = match number.cmp(&present) {
            std::cmp::Ordering::Less => StepMark::Past,
            std::cmp::Ordering::Equal => StepMark::Present,
            std::cmp::Ordering::Greater => StepMark::Ahead,
        };
        let mark = if init.is_as_wanted() { StepMark::Past } else { mark };
        ui.horizontal(|ui| marks::step(ui, number, mark, &text));
    }
}

/// What the present step asks for, or what is going on; its room is the same in every step.
fn detail(ui: &mut Ui, init: &InitProcedure, module: &Module, switch: &str, pass: &Pass<'_>) {
    let palette = theme::palette(ui);
    let size = vec2(ui.available_width(), theme::GUIDE_DETAIL);
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        ui.set_min_size(size);
        if let Some((glyph, colour, text)) = problem(init, pass, palette) {
            ui.horizontal_top(|ui| {
                let line = vec2(theme::GLYPH, ui.text_style_height(&TextStyle::Body));
                let (rect, _) = ui.allocate_exact_size(line, Sense::hover());
                widgets::paint_glyph(ui.painter(), glyph, rect.center(), theme::GLYPH, colour);
                said(ui, &text, colour);
            });
        }
        for line in words::detail(init, module, switch) {
            said(ui, &line, palette.text);
        }
    });
}

/// Text in as many lines as it needs.
fn said(ui: &mut Ui, text: &str, colour: eframe::egui::Color32) {
    let response = ui.add(Label::new(RichText::new(text).color(colour)).wrap());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
}

fn problem(init: &InitProcedure, pass: &Pass<'_>, palette: &Palette) -> Option<(Glyph, eframe::egui::Color32, String)> {
    if let Some(text) = words::lost_line(pass.bench.line()) {
        return Some((Glyph::Cross, palette.error, text));
    }
    if init.step == InitStep::Done && !init.is_as_wanted() {
        return Some((Glyph::Triangle, palette.warning, words::found_elsewhere(init)));
    }
    if init.is_as_wanted() {
        return Some((Glyph::Disc, palette.ok, words::found(init)));
    }
    init.problem.as_ref().map(|text| (Glyph::Triangle, palette.warning, text.clone()))
}
