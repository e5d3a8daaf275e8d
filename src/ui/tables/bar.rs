//! The controls above a list: pause, follow, copy, export, and how much is shown of how much.

use eframe::egui::{Align, TextEdit, Ui};

use super::export::Form;
use super::grouped;
use super::scroll::Scroll;
use crate::capture;
use crate::ui::{theme, widgets};

/// Something that can be exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    Frames,
    Events,
}

/// What was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    CopyChosen,
    CopyAll,
    Export(Wanted, Form),
    /// Frames as a capture.
    Capture(capture::Form),
}

/// Pause, Follow, Copy and Export; `files` are what can be exported.
pub fn controls(ui: &mut Ui, scroll: &mut Scroll, has_choice: bool, files: &[Wanted]) -> Option<Asked> {
    let mut asked = None;
    if widgets::chip(ui, scroll.paused, "Pause", "Pause", "The list stands still; what comes is kept for later") {
        scroll.paused = !scroll.paused;
    }
    if widgets::chip(ui, scroll.is_following(), "Follow", "Follow", "The newest row stays in view") {
        if scroll.is_following() { scroll.at_end = false } else { scroll.follow() }
    }
    let copy = widgets::menu(ui, "Copy", "Copy", |ui| {
        ui.set_min_width(theme::BUTTON_WIDTH);
        let copy = ui.add_enabled(has_choice, eframe::egui::Button::new("Chosen rows"));
        if copy.on_disabled_hover_text("Click a row first; with Shift, all up to it").clicked() {
            asked = Some(Asked::CopyChosen);
            ui.close();
        }
        if ui.button("All shown").clicked() {
            asked = Some(Asked::CopyAll);
            ui.close();
        }
    });
    copy.on_hover_text("As text, its columns parted by tabs");
    let export = widgets::menu(ui, "Export", "Export", |ui| {
        ui.set_min_width(theme::BUTTON_WIDTH);
        for wanted in files {
            for form in Form::ALL {
                let what = if *wanted == Wanted::Frames { "Frames" } else { "Events" };
                if ui.button(format!("{what} as {}…", form.label())).clicked() {
                    asked = Some(Asked::Export(*wanted, form));
                    ui.close();
                }
            }
            if *wanted == Wanted::Frames {
                asked = captures(ui).or(asked);
            }
        }
    });
    export.on_hover_text("What is shown, as a file for other programs");
    asked
}

/// The forms that other programs for captures read, and `dcon-bench replay`.
fn captures(ui: &mut Ui) -> Option<Asked> {
    let mut asked = None;
    for form in capture::Form::ALL {
        if ui.button(format!("Frames as {}…", form.label())).clicked() {
            asked = Some(Asked::Capture(form));
            ui.close();
        }
    }
    asked
}

/// `12 345 of 1 000 000`, at the right, in a room of its own.
pub fn count(ui: &mut Ui, shown: usize, all: usize, one: &str) {
    let what = if all == 1 { one.to_owned() } else { format!("{one}s") };
    let text = if shown == all {
        format!("{} {what}", grouped(all))
    } else {
        format!("{} of {} {what}", grouped(shown), grouped(all))
    };
    widgets::at_right(ui, |ui| {
        let width = ui.available_width().min(theme::COUNT_WIDTH);
        let colour = theme::palette(ui).quiet;
        widgets::fixed_coloured(ui, width, Align::Max, &text, colour);
    });
}

/// The field in which a text is searched.
pub fn search(ui: &mut Ui, text: &mut String, hint: &str) {
    let field = TextEdit::singleline(text).desired_width(theme::SEARCH_WIDTH).hint_text(hint);
    let response = ui.add(field);
    widgets::name_field(&response, "Search", text);
    let response = response.on_hover_text("Shows only rows in which this text stands; Esc empties it");
    if response.has_focus() && ui.input(|input| input.key_pressed(eframe::egui::Key::Escape)) {
        text.clear();
    }
}
