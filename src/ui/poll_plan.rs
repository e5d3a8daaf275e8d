//! The poll plan: which modules are polled, how often, and what of each.

use std::collections::BTreeSet;

use eframe::egui::{self, Align, Grid, Id, Modal, Role, ScrollArea, Ui, WidgetInfo};

use super::app::Pass;
use super::{interval, theme, widgets};
use crate::bench::{Action, DEFAULT_INTERVAL, LineState, Module};
use crate::module::{Definition, Item};

/// What the window of the plan remembers between frames.
#[derive(Default)]
pub struct PollPlan {
    pub open: bool,
}

impl PollPlan {
    pub fn show(&mut self, ctx: &egui::Context, pass: &mut Pass<'_>) {
        if !self.open {
            return;
        }
        let modal = Modal::new(Id::unique("poll plan")).show(ctx, |ui| {
            ui.heading("Poll plan");
            widgets::quiet(ui, "Which modules are asked again and again, how often, and what for.");
            ui.add_space(theme::GAP);
            if pass.bench.modules().iter().all(|module| module.definition().is_none()) {
                ui.label("No module of a known model was found yet – scan first.");
            } else {
                ScrollArea::vertical().max_height(theme::PLAN_HEIGHT).show(ui, |ui| plan(ui, pass));
            }
            ui.add_space(theme::GAP);
            ui.horizontal(|ui| {
                widgets::quiet(ui, "A silent module is asked ever more rarely, until it answers again.");
                widgets::at_right(ui, |ui| self.open = !ui.button("Close").clicked());
            });
        });
        if modal.should_close() {
            self.open = false;
        }
    }
}

fn plan(ui: &mut Ui, pass: &mut Pass<'_>) {
    let closed = matches!(pass.bench.line(), LineState::Closed);
    let bench = pass.bench;
    Grid::new("poll plan").num_columns(5).spacing([theme::GAP, theme::UNIT]).show(ui, |ui| {
        for heading in ["Polled", "Module", "Interval", "What", "Questions"] {
            widgets::quiet_small(ui, heading);
        }
        ui.end_row();
        for module in bench.modules() {
            if let Some(definition) = module.definition() {
                row(ui, module, definition, closed, pass.actions);
                ui.end_row();
            }
        }
    });
}

fn row(ui: &mut Ui, module: &Module, definition: &Definition, closed: bool, actions: &mut Vec<Action>) {
    let target = module.target;
    let name = format!("{} @{}", module.label(), target.address);
    let mut polled = module.interval.is_some();
    let check = ui.add_enabled(!closed, egui::Checkbox::without_text(&mut polled));
    check.widget_info(|| WidgetInfo::selected(Role::CheckBox, !closed, polled, format!("Poll {name}")));
    if check.on_disabled_hover_text("No line is open: scan to open it again").changed() {
        actions.push(match polled {
            true => Action::SetInterval(target, module.last_interval.unwrap_or(DEFAULT_INTERVAL)),
            false => Action::StopPolling(target),
        });
    }
    ui.label(&name).on_hover_text(target.to_string());
    let shown = module.interval.or(module.last_interval).unwrap_or(DEFAULT_INTERVAL);
    let id = format!("{target:?}");
    ui.add_enabled_ui(!closed, |ui| {
        if let Some(interval) = interval::selector(ui, &id, &format!("Interval of {name}"), shown) {
            actions.push(Action::SetInterval(target, interval));
        }
    });
    what(ui, module, definition, &name, actions);
    let questions = module.poll_questions().to_string();
    widgets::fixed_coloured(ui, theme::RATE_WIDTH, Align::Min, &questions, theme::palette(ui).quiet)
        .on_hover_text("Requests of one poll; neighbouring registers and coils are asked for together");
}

/// The readings that are polled, to be ticked.
fn what(ui: &mut Ui, module: &Module, definition: &Definition, name: &str, actions: &mut Vec<Action>) {
    let items: Vec<&Item> = definition.live_items(module.target.protocol).filter(|item| module.has(item)).collect();
    let is_polled = |item: &Item| module.polled.as_ref().is_none_or(|polled| polled.contains(&item.id));
    let count = items.iter().filter(|item| is_polled(item)).count();
    let text = match count == items.len() {
        true => format!("All {count} readings"),
        false => format!("{count} of {} readings", items.len()),
    };
    widgets::menu(ui, &text, &format!("What of {name}"), |ui| {
        if ui.button("All").clicked() {
            actions.push(Action::ChoosePolled(module.target, None));
        }
        ScrollArea::vertical().max_height(theme::PLAN_HEIGHT).show(ui, |ui| {
            for item in &items {
                let mut on = is_polled(item);
                let last = on && count == 1;
                let check = ui.add_enabled(!last, egui::Checkbox::new(&mut on, item.label.as_str()));
                if check.on_disabled_hover_text("One reading is polled at least").changed() {
                    let mut chosen: BTreeSet<String> =
                        items.iter().filter(|item| is_polled(item)).map(|item| item.id.clone()).collect();
                    if on {
                        chosen.insert(item.id.clone());
                    } else {
                        chosen.remove(&item.id);
                    }
                    let all = chosen.len() == items.len();
                    actions.push(Action::ChoosePolled(module.target, (!all).then_some(chosen)));
                }
            }
        });
    });
}
