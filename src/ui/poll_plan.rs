//! The poll plan: which modules are polled, how often, and what of each.

use std::collections::BTreeSet;
use std::slice;

use eframe::egui::{self, Align, Align2, Grid, Id, Modal, Rect, Role, ScrollArea, Ui, WidgetInfo};

use super::app::Pass;
use super::tables::{Sheet, copied_row};
use super::{interval, theme, widgets, words};
use crate::bench::{Action, DEFAULT_INTERVAL, LineState, Module};
use crate::module::{Definition, Item};

const QUESTIONS: &str = "Requests of one poll; neighbouring registers and coils are asked for together";
/// The columns, and what stands in them.
const HEADINGS: [(&str, &str); 5] = [
    ("Polled", "Whether it is asked again and again"),
    ("Module", "What it calls itself, and its address"),
    ("Interval", "How often it is asked"),
    ("What", "Which of its readings are asked for"),
    ("Questions", QUESTIONS),
];

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
        let id = Id::unique("poll plan");
        // From the top on, as in the middle every module that a scan finds would move those above it.
        let area = Modal::default_area(id).anchor(Align2::CENTER_TOP, [0.0, theme::PLAN_BELOW]);
        let modal = Modal::new(id).area(area).show(ctx, |ui| {
            ui.heading("Poll plan");
            widgets::quiet(ui, "Which modules are asked again and again, how often, and what for.");
            ui.add_space(theme::GAP);
            if pass.bench.modules().iter().all(|module| module.definition().is_none()) {
                ui.label("No module of a known model was found yet – scan first.");
            } else {
                let room = ctx.content_rect().height() - theme::PLAN_BELOW - theme::PLAN_AROUND;
                let height = theme::PLAN_HEIGHT.min(room.max(theme::PLAN_LEAST));
                ScrollArea::vertical().max_height(height).show(ui, |ui| plan(ui, pass));
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
        for (heading, means) in HEADINGS {
            widgets::quiet_small(ui, heading).on_hover_text(means);
        }
        ui.end_row();
        for module in bench.modules() {
            if let Some(definition) = module.definition() {
                let rect = row(ui, module, definition, closed, pass.actions);
                copied_row(ui, rect, ui.scope_id().with(("row", module.target)), |part| {
                    sheet(part.of(slice::from_ref(module), bench.modules()))
                });
                ui.end_row();
            }
        }
    });
}

/// The plan as it is copied.
fn sheet(modules: &[Module]) -> Sheet {
    let mut sheet = Sheet::new(["Module", "Line", "Interval", "What", "Questions"]);
    for module in modules {
        let Some(definition) = module.definition() else { continue };
        let interval = module.interval.map_or_else(|| "not polled".to_owned(), words::interval);
        let (_, what) = Readings::of(module, definition).in_words();
        let questions = module.poll_questions().to_string();
        sheet.push([&name(module), &module.target.to_string(), &interval, &what, &questions]);
    }
    sheet
}

fn name(module: &Module) -> String {
    format!("{} @{}", module.label(), module.target.address)
}

/// Draws a module's line; where it is.
fn row(ui: &mut Ui, module: &Module, definition: &Definition, closed: bool, actions: &mut Vec<Action>) -> Rect {
    let target = module.target;
    let name = name(module);
    let mut polled = module.interval.is_some();
    let check = ui.add_enabled(!closed, egui::Checkbox::without_text(&mut polled));
    check.widget_info(|| WidgetInfo::selected(Role::CheckBox, !closed, polled, format!("Poll {name}")));
    let check = check.on_hover_text("Polls it, or pauses that");
    let check = check.on_disabled_hover_text("No line is open: scan to open it again");
    if check.changed() {
        actions.push(match polled {
            true => Action::SetInterval(target, module.last_interval.unwrap_or(DEFAULT_INTERVAL)),
            false => Action::StopPolling(target),
        });
    }
    ui.label(&name).on_hover_text(target.to_string());
    let shown = module.interval.or(module.last_interval).unwrap_or(DEFAULT_INTERVAL);
    let id = format!("{target:?}");
    ui.add_enabled_ui(!closed, |ui| {
        if let Some(interval) =
            interval::selector(ui, &id, &format!("Interval of {name}"), theme::INTERVAL_WIDTH, shown)
        {
            actions.push(Action::SetInterval(target, interval));
        }
    });
    what(ui, module, definition, &name, actions);
    let questions = module.poll_questions().to_string();
    let questions = widgets::fixed_coloured(ui, theme::RATE_WIDTH, Align::Min, &questions, theme::palette(ui).quiet)
        .on_hover_text(QUESTIONS);
    check.rect.union(questions.rect)
}

/// What can be polled of a module, and what is.
struct Readings<'a> {
    items: Vec<&'a Item>,
    polled: Option<&'a BTreeSet<String>>,
}

impl<'a> Readings<'a> {
    fn of(module: &'a Module, definition: &'a Definition) -> Self {
        let items = definition.live_items(module.target.protocol).filter(|item| module.has(item)).collect();
        Self { items, polled: module.polled.as_ref() }
    }

    fn is_polled(&self, item: &Item) -> bool {
        self.polled.is_none_or(|polled| polled.contains(&item.id))
    }

    /// How many are polled, also in words.
    fn in_words(&self) -> (usize, String) {
        let (all, count) = (self.items.len(), self.items.iter().filter(|item| self.is_polled(item)).count());
        let text = match count == all {
            true => format!("All {count} readings"),
            false => format!("{count} of {all} readings"),
        };
        (count, text)
    }

    /// What is polled with `item` ticked or not; `None` is everything.
    fn with(&self, item: &Item, on: bool) -> Option<BTreeSet<String>> {
        let is_chosen = |other: &&&Item| if other.id == item.id { on } else { self.is_polled(other) };
        let chosen: BTreeSet<String> = self.items.iter().filter(is_chosen).map(|item| item.id.clone()).collect();
        (chosen.len() < self.items.len()).then_some(chosen)
    }
}

/// The readings that are polled, to be ticked.
fn what(ui: &mut Ui, module: &Module, definition: &Definition, name: &str, actions: &mut Vec<Action>) {
    let readings = Readings::of(module, definition);
    let (count, text) = readings.in_words();
    let menu = widgets::menu(ui, &text, &format!("What of {name}"), |ui| {
        if ui.button("All").on_hover_text("Polls everything that the module measures").clicked() {
            actions.push(Action::ChoosePolled(module.target, None));
        }
        ScrollArea::vertical().max_height(theme::PLAN_HEIGHT).show(ui, |ui| {
            for item in &readings.items {
                let mut on = readings.is_polled(item);
                let last = on && count == 1;
                let check = ui.add_enabled(!last, egui::Checkbox::new(&mut on, item.label.as_str()));
                let check = check.on_hover_text(&item.help);
                if check.on_disabled_hover_text("One reading is polled at least").changed() {
                    actions.push(Action::ChoosePolled(module.target, readings.with(item, on)));
                }
            }
        });
    });
    menu.on_hover_text("Which readings are polled; others keep their last value");
}
