//! Asks before something is done that cannot be taken back: leaving changes that are not written, stopping Host OK, or
//! what a part of the window wants confirmed.

use std::path::Path;

use eframe::egui::{Context, Key, RichText, Ui, ViewportCommand};

use super::panes::Pane;
use super::{modal, theme, widgets};
use crate::bench::{Action, Bench, Module};
use crate::bus::Target;
use crate::module::Addition;

/// A question with its consequences.
#[derive(Debug, Clone)]
pub struct Confirm {
    pub title: String,
    /// What will happen, line by line.
    pub lines: Vec<String>,
    /// What the button does: "Write 2", "Reboot".
    pub button: String,
    pub actions: Vec<Action>,
}

/// What waits for an answer.
enum Held {
    Confirm(Confirm),
    /// These changes would be lost.
    Leaving {
        targets: Vec<Target>,
        then: Then,
    },
    /// What was measured and is not on the disk would be lost by quitting.
    Unsaved,
}

enum Then {
    Apply(Action),
    Close(Pane),
    Quit,
}

#[derive(Default)]
pub struct Guard {
    held: Option<Held>,
    /// The user has agreed to quit.
    quitting: bool,
}

/// What is left to do after the question.
#[derive(Default)]
pub struct Outcome {
    pub actions: Vec<Action>,
    pub close: Option<Pane>,
}

/// Whether leaving this module loses something: changes, or the Host OK that keeps its relays.
fn holds_back(module: &Module) -> bool {
    !module.edits.is_empty() || (module.host_ok.is_some() && module.watchdog_counts())
}

/// How much waits for the disk, and why it cannot be written.
fn unsaved(bench: &Bench) -> Option<(u64, &str)> {
    let status = bench.recording().filter(|status| status.waiting > 0)?;
    Some((status.waiting, status.problem.as_deref()?))
}

fn all_that_hold_back(bench: &Bench) -> Vec<Target> {
    bench.modules().iter().filter(|module| holds_back(module)).map(|module| module.target).collect()
}

impl Guard {
    pub fn confirm(&mut self, confirm: Confirm) {
        self.held = Some(Held::Confirm(confirm));
    }

    /// The action if it may be carried out at once; else it is held until the user has decided.
    pub fn pass(&mut self, bench: &Bench, action: Action) -> Option<Action> {
        if let Action::AddDefinition(path) = &action
            && self.held.is_none()
            && let Some(there) = bench.replaced_by(path)
        {
            self.held = Some(Held::Confirm(replacing(&there, path)));
            return None;
        }
        let targets = match &action {
            Action::Disconnect | Action::Connect { .. } => all_that_hold_back(bench),
            Action::Scan { line, .. } => match bench.line().line() {
                Some(open) if open.to_string() == line.to_string() => Vec::new(),
                _ => all_that_hold_back(bench),
            },
            Action::Remove(target) => vec![*target],
            _ => Vec::new(),
        };
        let targets = really_held(bench, targets);
        if targets.is_empty() {
            return Some(action);
        }
        self.held = Some(Held::Leaving { targets, then: Then::Apply(action) });
        None
    }

    /// Whether the pane may be closed at once.
    pub fn close(&mut self, bench: &Bench, pane: Pane) -> bool {
        let targets = match pane {
            Pane::Module(target) => really_held(bench, vec![target]),
            Pane::Dashboard | Pane::Traffic | Pane::Trends | Pane::Diagnosis | Pane::Help | Pane::Recording(_) => {
                Vec::new()
            }
        };
        if targets.is_empty() {
            return true;
        }
        self.held = Some(Held::Leaving { targets, then: Then::Close(pane) });
        false
    }

    /// Holds the window open while there is something to lose.
    pub fn quit(&mut self, ctx: &Context, bench: &Bench) {
        if !ctx.input(|input| input.viewport().close_requested()) || self.quitting {
            return;
        }
        let targets = all_that_hold_back(bench);
        if !targets.is_empty() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.held = Some(Held::Leaving { targets, then: Then::Quit });
        } else if unsaved(bench).is_some() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.held = Some(Held::Unsaved);
        }
    }

    pub fn show(&mut self, ctx: &Context, bench: &Bench) -> Outcome {
        let mut outcome = Outcome::default();
        let Some(held) = self.held.take() else { return outcome };
        let mut decided = false;
        let modal = modal::show(ctx, "question", theme::QUESTION_WIDTH, |ui| {
            decided = match &held {
                Held::Confirm(confirm) => ask(ui, confirm, &mut outcome),
                Held::Leaving { targets, then } => self.ask_leaving(ui, bench, targets, then, &mut outcome),
                Held::Unsaved => self.ask_unsaved(ui, bench),
            };
        });
        if !decided && !modal.should_close() {
            self.held = Some(held);
        }
        outcome
    }

    fn ask_unsaved(&mut self, ui: &mut Ui, bench: &Bench) -> bool {
        let Some((waiting, problem)) = unsaved(bench) else { return true };
        heading(ui, "What was measured is not on the disk");
        ui.label(format!("{waiting} samples and events wait in memory: {problem}"));
        ui.add_space(theme::GAP);
        let mut decided = false;
        ui.horizontal(|ui| {
            if ui.button("Quit and lose them").clicked() {
                self.quitting = true;
                ui.ctx().send_viewport_cmd(ViewportCommand::Close);
                decided = true;
            }
            decided |= ui.button("Cancel").clicked();
        });
        decided
    }

    fn ask_leaving(
        &mut self,
        ui: &mut Ui,
        bench: &Bench,
        targets: &[Target],
        then: &Then,
        outcome: &mut Outcome,
    ) -> bool {
        let modules: Vec<&Module> = targets.iter().filter_map(|target| bench.module(target)).collect();
        let edits: usize = modules.iter().map(|module| module.edits.len()).sum();
        heading(ui, if edits > 0 { "Some changes are not written" } else { "Host OK is being sent" });
        for module in &modules {
            describe(ui, module);
        }
        ui.add_space(theme::GAP);
        let mut decided = false;
        ui.horizontal(|ui| {
            // What is asked about before it is written has to be written in its tab.
            let plain = |module: &&Module| {
                module.unwritable().is_none()
                    && module.edited_for_init().is_empty()
                    && !module.edits.keys().any(|id| id.starts_with("wdt_"))
            };
            let writable = modules.iter().all(plain);
            if edits > 0 && writable && ui.button(format!("Write {edits} and stay")).clicked() {
                outcome.actions.extend(modules.iter().map(|module| {
                    Action::Write(module.target, module.edited().into_iter().map(str::to_owned).collect())
                }));
                decided = true;
            }
            let (leave, stay) = (leave_words(edits, then), "Cancel");
            if ui.button(leave).clicked() {
                self.leave(ui.ctx(), targets, then, outcome);
                decided = true;
            }
            let cancel = ui.button(stay);
            if cancel.clicked() {
                decided = true;
            }
            if !ui.memory(|memory| memory.focused().is_some()) {
                cancel.request_focus();
            }
        });
        decided
    }

    fn leave(&mut self, ctx: &Context, targets: &[Target], then: &Then, outcome: &mut Outcome) {
        for target in targets {
            outcome.actions.push(Action::Revert(*target, None));
            outcome.actions.push(Action::StopHostOk(*target));
        }
        match then {
            Then::Apply(action) => outcome.actions.push(action.clone()),
            Then::Close(pane) => outcome.close = Some(*pane),
            Then::Quit => {
                self.quitting = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }
}

/// Asks whether the definition at `path` shall take the place of the one that is there.
fn replacing(there: &Addition, path: &Path) -> Confirm {
    let Addition { id, place, .. } = there;
    Confirm {
        title: "Replace a definition?".to_owned(),
        lines: vec![
            format!("{} defines {id} in another way.", place.display()),
            format!("{} takes its place.", path.display()),
        ],
        button: "Replace".to_owned(),
        actions: vec![Action::ReplaceDefinition(path.to_owned())],
    }
}

fn really_held(bench: &Bench, targets: Vec<Target>) -> Vec<Target> {
    targets.into_iter().filter(|target| bench.module(target).is_some_and(holds_back)).collect()
}

fn leave_words(edits: usize, then: &Then) -> String {
    let leave = match then {
        Then::Apply(Action::Disconnect) => "close the line",
        Then::Apply(Action::Remove(_)) => "remove the module",
        Then::Apply(_) => "open the other line",
        Then::Close(_) => "close the tab",
        Then::Quit => "quit",
    };
    if edits > 0 { format!("Discard {edits} and {leave}") } else { format!("Stop Host OK and {leave}") }
}

fn describe(ui: &mut Ui, module: &Module) {
    let palette = theme::palette(ui);
    ui.label(RichText::new(format!("{} at address {}", module.label(), module.target.address)).color(palette.text));
    for id in module.edited() {
        let label = module.item(id).map_or(id, |item| item.label.as_str());
        let text = module.edit(id).map_or("", |edit| edit.text.as_str());
        widgets::quiet(ui, &format!("   {label}: {text}"));
    }
    if module.host_ok.is_some() && module.watchdog_counts() {
        let after =
            module.watchdog_timeout().map_or_else(String::new, |timeout| format!(" {:.1} s", timeout.as_secs_f64()));
        widgets::quiet(
            ui,
            &format!("   Its host watchdog trips{after} after the last Host OK: relays go to their safe values"),
        );
    }
}

fn heading(ui: &mut Ui, text: &str) {
    let colour = theme::palette(ui).text;
    ui.label(RichText::new(text).heading().color(colour));
    ui.add_space(theme::UNIT);
}

fn ask(ui: &mut Ui, confirm: &Confirm, outcome: &mut Outcome) -> bool {
    heading(ui, &confirm.title);
    for line in &confirm.lines {
        ui.label(line);
    }
    ui.add_space(theme::GAP);
    let mut decided = false;
    ui.horizontal(|ui| {
        if ui.button(&confirm.button).clicked() {
            outcome.actions.extend(confirm.actions.iter().cloned());
            decided = true;
        }
        let cancel = ui.button("Cancel");
        if cancel.clicked() || ui.input(|input| input.key_pressed(Key::Escape)) {
            decided = true;
        }
        if !ui.memory(|memory| memory.focused().is_some()) {
            cancel.request_focus();
        }
    });
    decided
}
