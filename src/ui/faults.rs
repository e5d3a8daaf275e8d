//! What goes wrong on the simulated line: each fault with its switch, its strength and how often it has struck.

use std::collections::BTreeMap;
use std::time::Duration;

use eframe::egui::{
    self, Align, Align2, Area, Checkbox, DragValue, Id, Key, LayerId, Order, Rect, Response, Role, Ui, WidgetInfo, vec2,
};

use super::app::Pass;
use super::settings::LineChoice;
use super::{theme, widgets};
use crate::bench::Action;
use crate::protocol::BaudRate;
use crate::sim::{Fault, FaultKind, Faults, Injected, Strength};

/// How often the counts are drawn anew.
const COUNTS_EVERY: Duration = Duration::from_millis(300);

/// What the panel remembers between frames. It does not keep the user from the rest of the window, where what the faults
/// do is seen.
#[derive(Default)]
pub struct FaultsPanel {
    pub open: bool,
    /// Something else had a better right to Esc in the last frame.
    deaf: bool,
    /// Strengths that were chosen, also of faults that are off.
    chosen: BTreeMap<FaultKind, Strength>,
}

/// How many faults of the simulated line are on; `None` while it is neither in use nor chosen again.
pub fn count(pass: &Pass<'_>) -> Option<usize> {
    let count = pass.bench.faults()?.iter().count();
    let in_use = pass.bench.line().line().is_some() || pass.settings.line == LineChoice::Simulated;
    (in_use || count > 0).then_some(count)
}

/// The button that shows the panel, while there is anything to switch.
pub fn button(ui: &mut Ui, pass: &mut Pass<'_>) {
    if count(pass).is_none() {
        return;
    }
    if ui.button("Faults…").on_hover_text("What goes wrong on the simulated line").clicked() {
        *pass.faults = true;
    }
}

/// That faults are on, for the status bar; a click shows the panel.
pub fn status(ui: &mut Ui, pass: &mut Pass<'_>) {
    let Some(count) = count(pass).filter(|count| *count > 0) else { return };
    let text = if count == 1 { "1 fault on".to_owned() } else { format!("{count} faults on") };
    let colour = theme::palette(ui).warning;
    let response = ui.add(egui::Button::new(egui::RichText::new(text).color(colour)).frame_when_inactive(false));
    if response.on_hover_text("The simulated line goes wrong on purpose. Click to see how").clicked() {
        *pass.faults = true;
    }
}

impl FaultsPanel {
    /// Opens at the right end of `middle`, and stands wherever it was moved to.
    pub fn show(&mut self, ctx: &egui::Context, pass: &mut Pass<'_>, middle: Rect) {
        let escaped = !self.deaf && ctx.input(|input| input.key_pressed(Key::Escape));
        if count(pass).is_none() || escaped {
            self.open = false;
        }
        let Some(faults) = pass.bench.faults().filter(|_| self.open) else { return };
        let injected = pass.bench.injected();
        let corner = middle.right_top() + vec2(-theme::UNIT, theme::FAULTS_BELOW);
        let area = Area::new(Id::unique("faults")).order(Order::Middle).pivot(Align2::RIGHT_TOP);
        let shown = area.default_pos(corner).movable(true).constrain(true).show(ctx, |ui| {
            egui::Frame::window(ui.style()).inner_margin(theme::GAP + theme::UNIT).show(ui, |ui| {
                ui.set_width(theme::FAULTS_WIDTH);
                // Dragged anywhere, its words too, the panel moves.
                ui.style_mut().interaction.selectable_labels = false;
                self.contents(ui, faults, &injected, pass.actions);
            });
        });
        self.deaf = is_deaf(ctx, shown.response.layer_id);
        ctx.request_repaint_after(COUNTS_EVERY);
    }

    fn contents(&mut self, ui: &mut Ui, faults: Faults, injected: &Injected, actions: &mut Vec<Action>) {
        ui.heading("Faults of the simulated line");
        widgets::quiet(ui, "Each strikes at once, until it is switched off.");
        ui.add_space(theme::UNIT);
        ui.horizontal(|ui| {
            let fault = theme::FAULTS_WIDTH - theme::FAULT_STRENGTH - theme::FAULT_COUNT - 2.0 * theme::GAP;
            for (width, align, text) in [
                (fault, Align::Min, "Fault"),
                (theme::FAULT_STRENGTH, Align::Max, "Strength"),
                (theme::FAULT_COUNT, Align::Max, "Struck"),
            ] {
                heading(ui, width, align, text);
            }
        });
        let mut wanted = faults.clone();
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for kind in FaultKind::ALL {
                self.row(ui, kind, &mut wanted, injected.get(&kind).copied().unwrap_or_default());
            }
        });
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            let on: Vec<FaultKind> = wanted.iter().map(|fault| fault.kind).collect();
            let all_off = ui.add_enabled(!on.is_empty(), egui::Button::new("All off"));
            if all_off.on_disabled_hover_text("No fault is on").clicked() {
                on.into_iter().for_each(|kind| wanted.switch_off(kind));
            }
            widgets::at_right(ui, |ui| {
                let close = ui.button("Close").on_hover_text("Faults that are on stay on");
                close.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Close faults"));
                self.open &= !close.clicked();
            });
        });
        if wanted != faults {
            actions.push(Action::SetFaults(wanted));
        }
    }

    fn row(&mut self, ui: &mut Ui, kind: FaultKind, wanted: &mut Faults, struck: u64) {
        let (is_on, before) = (wanted.is_on(kind), wanted.get(kind));
        let chosen = before.or_else(|| self.chosen.get(&kind).copied()).unwrap_or_else(|| kind.default_strength());
        let (mut on, mut strength) = (is_on, chosen);
        ui.horizontal(|ui| {
            let width = theme::FAULTS_WIDTH - theme::FAULT_STRENGTH - theme::FAULT_COUNT - 2.0 * theme::GAP;
            let left = egui::Layout::left_to_right(Align::Center);
            ui.allocate_ui_with_layout(vec2(width, theme::CONTROL_HEIGHT), left, |ui| {
                ui.set_min_width(width);
                ui.add(Checkbox::new(&mut on, kind.label())).on_hover_text(kind.explanation());
            });
            let right = egui::Layout::right_to_left(Align::Center);
            ui.allocate_ui_with_layout(vec2(theme::FAULT_STRENGTH, theme::CONTROL_HEIGHT), right, |ui| {
                ui.set_min_width(theme::FAULT_STRENGTH);
                ui.spacing_mut().interact_size.x = theme::SPEED_WIDTH;
                editor(ui, kind, &mut strength);
            });
            let palette = theme::palette(ui);
            let (text, colour) = match struck {
                0 => ("–".to_owned(), palette.old),
                count => (count.to_string(), if on { palette.text } else { palette.quiet }),
            };
            let response = widgets::fixed_coloured(ui, theme::FAULT_COUNT, Align::Max, &text, colour);
            widgets::describe(&response, Role::Label, &format!("{} struck {struck}", kind.label()));
        });
        if strength != chosen {
            self.chosen.insert(kind, strength);
        }
        if !on && is_on {
            wanted.switch_off(kind);
        } else if on && (!is_on || strength != chosen) && wanted.set(Fault { kind, strength }).is_err() {
            wanted.switch_on(kind);
        }
    }
}

/// Whether a menu, a question or what has the focus outside `panel` is what Esc is meant for.
fn is_deaf(ctx: &egui::Context, panel: LayerId) -> bool {
    let focused = ctx.memory(|memory| memory.focused()).and_then(|id| ctx.read_response(id));
    let elsewhere = focused.is_some_and(|response| response.layer_id != panel);
    elsewhere || egui::Popup::is_any_open(ctx) || ctx.memory(|memory| memory.top_modal_layer()).is_some()
}

fn heading(ui: &mut Ui, width: f32, align: Align, text: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(width, theme::LEGEND_ROW), egui::Sense::hover());
    widgets::line_in(ui, rect, align, text, theme::small(), theme::palette(ui).quiet);
}

/// The field of a strength; nothing where a fault is on or off only.
fn editor(ui: &mut Ui, kind: FaultKind, strength: &mut Strength) {
    match strength {
        Strength::On => {}
        Strength::Rate(rate) => {
            let mut percent = *rate * 100.0;
            let field = DragValue::new(&mut percent).range(0.0..=100.0).speed(0.1).max_decimals(2).suffix(" %");
            let response = ui.add(field).on_hover_text("Share of the bytes or answers that it strikes");
            if named(&response, kind, percent).changed() {
                *rate = percent / 100.0;
            }
        }
        Strength::Address(address) => {
            let response = ui.add(DragValue::new(address).range(0..=255).speed(0.2).prefix("at "));
            named(&response, kind, f64::from(*address)).clone().on_hover_text("The address of the module it concerns");
        }
        Strength::Speed(speed) => {
            let text = speed.to_string();
            let combo = widgets::combo(kind.word(), theme::SPEED_WIDTH, &text);
            let response = combo.show_ui(ui, |ui| {
                for rate in BaudRate::ALL {
                    ui.selectable_value(speed, rate, format!("{rate} bps"));
                }
            });
            widgets::name_combo(&response.response, &format!("Strength of {}", kind.label()), &text);
            response.response.on_hover_text("The speed at which it strikes");
        }
        Strength::Seconds(seconds) => {
            let response = ui.add(DragValue::new(seconds).range(-JUMP..=JUMP).speed(10.0).suffix(" s"));
            named(&response, kind, *seconds as f64).clone().on_hover_text("Forward, or back if negative");
        }
    }
}

/// Most seconds that the field offers: a year.
const JUMP: i64 = 365 * 86_400;

fn named(response: &Response, kind: FaultKind, value: f64) -> &Response {
    response.widget_info(|| WidgetInfo {
        value: Some(value),
        ..WidgetInfo::labeled(Role::SpinButton, true, format!("Strength of {}", kind.label()))
    });
    response
}
