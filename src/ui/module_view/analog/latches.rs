//! The highest and lowest value that the module keeps of each channel. They are not polled: while they are in view
//! they are read again every few seconds.

use std::time::Duration;

use eframe::egui::{Align, Color32, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, pos2, vec2};
use jiff::Timestamp;

use super::super::explanation::explanation;
use super::super::item_sheet;
use super::super::series::Series;
use crate::bench::{self, Module, Presence, Reading};
use crate::module::{self, Item};
use crate::ui::app::Pass;
use crate::ui::theme;
use crate::ui::{widgets, words};

/// How often latches are read again.
const EVERY: Duration = Duration::from_secs(5);
/// A latch is shown as old after so many of these.
const FRESH_READS: u32 = 3;
const LOST: &str = "the extremes so far are lost";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extreme {
    High,
    Low,
}

impl Extreme {
    pub const ALL: [Self; 2] = [Self::High, Self::Low];

    fn word(self) -> &'static str {
        match self {
            Self::High => "high",
            Self::Low => "low",
        }
    }

    /// The latched value of a reading, if the module has it.
    pub fn item<'a>(self, module: &'a Module, reading: &str) -> Option<&'a Item> {
        module.item(&format!("{reading}_{}", self.word())).filter(|item| module.has(item))
    }

    /// What resets it for one reading, or for all.
    fn action<'a>(self, module: &'a Module, reading: Option<&str>) -> Option<&'a module::Action> {
        let channel = reading.map(|reading| format!(":{reading}")).unwrap_or_default();
        let action = module.definition()?.action(&format!("clear_{}_latch{channel}", self.word()))?;
        Some(action).filter(|action| action.is_offered(module.target.protocol))
    }
}

/// Whether the item is a latched value of a live reading.
pub fn is_latch(module: &Module, item: &Item) -> bool {
    let of = |extreme: &Extreme| item.id.strip_suffix(extreme.word()).and_then(|id| id.strip_suffix('_'));
    let reading = Extreme::ALL.iter().find_map(of).and_then(|id| module.item(id));
    reading.is_some_and(|reading| reading.live)
}

pub fn is_action(id: &str) -> bool {
    Extreme::ALL.iter().any(|extreme| id.starts_with(&format!("clear_{}_latch", extreme.word())))
}

/// When which latches were asked for last.
#[derive(Default)]
pub struct Refresh {
    last: Option<(Timestamp, Vec<String>)>,
}

impl Refresh {
    /// Asks for the latches in view when it is time. A module that is not polled is left alone, and so is one that is
    /// silent and what the module has refused.
    pub fn run(&mut self, module: &Module, mut ids: Vec<String>, pass: &mut Pass<'_>) {
        if module.interval.is_none() || matches!(module.presence, Presence::Silent { .. }) {
            return;
        }
        let refused = |reading: &Reading| {
            reading.value.is_none() && reading.problem.as_ref().is_some_and(|problem| problem.shows_presence())
        };
        ids.retain(|id| !module.reading(id).is_some_and(refused));
        let now = pass.bench.now();
        let recent = |(at, asked): &(Timestamp, Vec<String>)| *asked == ids && words::since(*at, now) < EVERY;
        if ids.is_empty() || self.last.as_ref().is_some_and(recent) {
            return;
        }
        pass.actions.push(bench::Action::Read(module.target, ids.clone()));
        self.last = Some((now, ids));
    }
}

/// Both extremes of a channel and what resets them. A temperature's latches in both units are reset together, as the
/// module keeps them apart.
pub fn row(ui: &mut Ui, module: &Module, series: &Series<'_>, twin: Option<&Series<'_>>, pass: &mut Pass<'_>) {
    let now = pass.bench.now();
    for extreme in Extreme::ALL {
        if let Some(item) = extreme.item(module, &series.item.id) {
            latch(ui, module, item, extreme, now);
        }
    }
    let channels: Vec<&str> = [Some(series), twin].into_iter().flatten().map(|one| one.item.id.as_str()).collect();
    let choices = Extreme::ALL.map(|extreme| {
        let actions = channels.iter().filter_map(|channel| extreme.action(module, Some(channel))).collect();
        let value = extreme.item(module, &series.item.id).and_then(|item| Some((item, module.known(&item.id)?)));
        let value = value.map(|(item, value)| format!(" {}", item.text(value))).unwrap_or_default();
        Choice { title: format!("Reset {} latch{value}", extreme.word()), actions }
    });
    menu(ui, module, "Reset", &format!("Reset latches of {}", series.label), choices, pass);
}

/// Resets the latches of all channels.
pub fn reset_all(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let choices = Extreme::ALL.map(|extreme| Choice {
        title: format!("Reset all {} latches", extreme.word()),
        actions: extreme.action(module, None).into_iter().collect(),
    });
    menu(ui, module, "Reset all latches", "Reset all latches", choices, pass);
}

struct Choice<'a> {
    title: String,
    actions: Vec<&'a module::Action>,
}

fn menu(ui: &mut Ui, module: &Module, text: &str, name: &str, choices: [Choice<'_>; 2], pass: &mut Pass<'_>) {
    if choices.iter().all(|choice| choice.actions.is_empty()) {
        return;
    }
    let obstacle = pass.bench.line().obstacle();
    let contents = |ui: &mut Ui| {
        ui.set_width(theme::LATCH_MENU_WIDTH);
        for Choice { title, actions } in choices.iter().filter(|choice| !choice.actions.is_empty()) {
            let help: Vec<&str> = actions.iter().map(|action| action.help.as_str()).collect();
            if entry(ui, module, title, actions, pass).on_hover_text(help.join("\n")).clicked() {
                ui.close();
            }
        }
        if let [Choice { actions: high, .. }, Choice { actions: low, .. }] = &choices
            && !high.is_empty()
            && !low.is_empty()
        {
            let both: Vec<&module::Action> = high.iter().chain(low).copied().collect();
            if entry(ui, module, "Reset both", &both, pass).clicked() {
                ui.close();
            }
        }
    };
    let menu = |ui: &mut Ui| widgets::menu(ui, text, name, contents);
    let response = ui.add_enabled_ui(obstacle.is_none(), menu).inner;
    let response = response.on_disabled_hover_text(obstacle.unwrap_or_default());
    response.on_hover_text(format!("Latches start again from the present values; {LOST}"));
}

fn entry(
    ui: &mut Ui,
    module: &Module,
    title: &str,
    actions: &[&module::Action],
    pass: &mut Pass<'_>,
) -> eframe::egui::Response {
    let obstacle = pass.bench.line().obstacle();
    let busy = obstacle.is_some() || actions.iter().any(|action| module.is_acting(&action.id));
    let explanation = obstacle.map_or_else(|| format!("From the present value on; {LOST}"), str::to_owned);
    let response = widgets::menu_entry(ui, !busy, title, &explanation);
    if response.clicked() {
        pass.actions.extend(actions.iter().map(|action| bench::Action::Act(module.target, action.id.clone())));
    }
    response
}

fn latch(ui: &mut Ui, module: &Module, item: &Item, extreme: Extreme, now: Timestamp) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(theme::LATCH, theme::CONTROL_HEIGHT), Sense::hover());
    let reading = module.reading(&item.id);
    let value = reading.and_then(|reading| reading.value.as_ref());
    let age = reading.and_then(|reading| reading.at).map(|at| words::since(at, now));
    let problem = reading.and_then(|reading| reading.problem.as_ref());
    let fresh = value.is_some() && problem.is_none() && age.is_some_and(|age| age <= EVERY * FRESH_READS);
    let colour = if fresh { palette.text } else { palette.old };

    let centre = pos2(rect.left() + theme::CARET / 2.0, rect.center().y);
    let mark = if fresh { palette.quiet } else { palette.old };
    paint_mark(ui.painter(), extreme, centre, mark);
    let bare = value.map_or_else(|| words::UNKNOWN.to_owned(), |value| item.bare_text(value));
    let room: Rect = rect.with_min_x(rect.left() + theme::CARET + theme::UNIT);
    widgets::line_in(ui, room, Align::Min, &bare, theme::body(), colour);

    let text = value.map_or_else(|| words::UNKNOWN.to_owned(), |value| item.text(value));
    let state = match (fresh, value.and(age)) {
        (true, _) => String::new(),
        (false, Some(age)) => format!(", {} old", words::age(age)),
        (false, None) => ", not known".to_owned(),
    };
    widgets::describe(&response, Role::Label, &format!("{}: {text}{state}", item.label));
    let problem = problem.map(|problem| format!("\n{problem}")).unwrap_or_default();
    item_sheet::copies(&response, module, item);
    response.on_hover_text(format!("{}: {text}{state}{problem}\n{}", item.label, explanation(module, item)));
}

/// A triangle that points up or down; a dash would be a value that is not known.
fn paint_mark(painter: &Painter, extreme: Extreme, centre: Pos2, colour: Color32) {
    let half = theme::CARET / 2.0;
    let tip = match extreme {
        Extreme::High => -half,
        Extreme::Low => half,
    };
    let corners = vec![centre + vec2(0.0, tip), centre + vec2(half, -tip), centre + vec2(-half, -tip)];
    painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
}
