//! Settings as lines of a form: name, value to edit, unit, and what is to be said of it. Enter writes, Esc reverts.

use eframe::egui::{
    Align, Button, Checkbox, Color32, Id, Key, Layout, Modifiers, Response, Role, Sense, TextEdit, Ui, UiBuilder,
    WidgetInfo, vec2,
};

use super::explanation::explanation;
use super::{item_sheet, watchdog};
use crate::bench::{Action, ItemState, Module};
use crate::module::{Applies, Item, Kind, Value};
use crate::ui::app::Pass;
use crate::ui::guard::Confirm;
use crate::ui::theme::{self, Palette};
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

/// The lines of these items, in this order; those that the module does not have are left out.
pub fn rows<'a>(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, ids: impl IntoIterator<Item = &'a str>) {
    for id in ids {
        row(ui, module, pass, id);
    }
}

/// One line. Nothing if the module does not have the item.
pub fn row(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, id: &str) {
    let Some(item) = module.item(id).filter(|item| module.has(item)) else { return };
    ui.horizontal(|ui| {
        label(ui, module, item, theme::FORM_LABEL);
        if offers_seconds(item) {
            editor(ui, module, pass, item, theme::FORM_EDITOR_WIDE);
        } else {
            editor(ui, module, pass, item, theme::FORM_EDITOR);
            let unit_colour = theme::palette(ui).quiet;
            widgets::fixed_coloured(ui, theme::FORM_UNIT, Align::Min, &item.unit, unit_colour);
        }
        state(ui, module, pass, item);
    });
}

/// The item's name; what it means stands on hover, and a right click copies its row.
pub fn label(ui: &mut Ui, module: &Module, item: &Item, width: f32) -> Response {
    let colour = theme::palette(ui).quiet;
    let text = match item.applies {
        Applies::Init => format!("{}  (INIT)", item.label),
        Applies::Now => item.label.clone(),
    };
    let response = widgets::fixed_coloured(ui, width, Align::Min, &text, colour);
    item_sheet::copies(&response, module, item);
    response.on_hover_text(explanation(module, item))
}

/// What changes the item, as wide as told; text that only says it for an item that cannot be written.
pub fn editor(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item, width: f32) {
    let is_old = pass.bench.line().is_lost() && module.edit(&item.id).is_none();
    if item.read_only {
        let text = module.known(&item.id).map_or_else(|| words::UNKNOWN.to_owned(), |value| item.bare_text(value));
        let colour = if is_old { theme::palette(ui).old } else { ui.visuals().text_color() };
        let response = widgets::fixed_coloured(ui, width, Align::Min, &text, colour);
        widgets::describe(&response, Role::Label, &format!("{} {text}", item.label));
        response.on_hover_text(explanation(module, item));
        return;
    }
    let busy = module.edit(&item.id).is_some_and(crate::bench::Edit::is_being_written);
    // A cell of exact size, so that what follows stands in one column.
    let (cell, _) = ui.allocate_exact_size(vec2(width, theme::CONTROL_HEIGHT), Sense::hover());
    let builder = UiBuilder::new().max_rect(cell).layout(Layout::left_to_right(Align::Center));
    let mut ui = ui.new_child(if busy { builder.disabled() } else { builder });
    let ui = &mut ui;
    if is_old {
        let old = theme::palette(ui).old;
        ui.visuals_mut().override_text_color = Some(old);
    }
    match &item.kind {
        Kind::Bool => switch(ui, module, pass, item),
        Kind::Choice(choices) => {
            let options: Vec<(&str, String)> =
                choices.iter().map(|choice| (choice.word.as_str(), offered(item, &choice.label))).collect();
            choose(ui, module, pass, item, width, &options);
        }
        Kind::Number { .. } | Kind::Text { .. } | Kind::Ipv4 => field(ui, module, pass, item, width),
    }
}

fn switch(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item) {
    let known = module.wanted(&item.id).and_then(Value::as_bool);
    let mut on = known.unwrap_or(false);
    let word = match known {
        Some(true) => "on",
        Some(false) => "off",
        None => words::UNKNOWN,
    };
    written_by_key(ui, ui.next_auto_id(), module, pass, item);
    let response = ui.add(Checkbox::new(&mut on, word).indeterminate(known.is_none()));
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, ui.is_enabled(), on, &item.label));
    let response = response.on_hover_text(explanation(module, item));
    if response.changed() {
        pass.actions.push(Action::Stage(module.target, item.id.clone(), on.to_string()));
    }
    keys(ui, &response, module, pass, item);
}

/// Whether the item is chosen from spans of time in seconds.
fn offers_seconds(item: &Item) -> bool {
    item.unit == "s" && matches!(item.kind, Kind::Choice(_))
}

/// A choice as it is offered: a span has its unit, and from a minute on is told in minutes too, `131 s (2 min 11 s)`.
fn offered(item: &Item, label: &str) -> String {
    match label.parse::<u64>() {
        Ok(seconds) if offers_seconds(item) => words::seconds_and_minutes(seconds),
        _ => label.to_owned(),
    }
}

fn choose(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item, width: f32, options: &[(&str, String)]) {
    let wanted = module.wanted(&item.id);
    let text = wanted.map_or_else(|| words::UNKNOWN.to_owned(), |value| offered(item, &item.bare_text(value)));
    let key = ui.scope_id().with(("box", &item.id));
    if let Some(id) = ui.data(|data| data.get_temp::<Id>(key)) {
        written_by_key(ui, id, module, pass, item);
    }
    let mut chosen_now = false;
    let response = widgets::combo(&item.id, width, &text).show_ui(ui, |ui| {
        for (word, label) in options {
            let chosen = matches!(wanted, Some(Value::Choice(known)) if known == word);
            if ui.selectable_label(chosen, label).clicked() {
                pass.actions.push(Action::Stage(module.target, item.id.clone(), (*word).to_owned()));
                chosen_now = true;
            }
        }
    });
    ui.data_mut(|data| data.insert_temp(key, response.response.id));
    if chosen_now {
        // So that Enter writes what was chosen.
        response.response.request_focus();
    }
    widgets::name_combo(&response.response, &item.label, &text);
    let response = response.response.on_hover_text(explanation(module, item));
    keys(ui, &response, module, pass, item);
}

/// A field keeps what is typed while it has the focus; the bench judges it with every key.
fn field(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item, width: f32) {
    let id = ui.make_persistent_id(("field", &item.id));
    let draft: Option<String> = ui.data(|data| data.get_temp(id)).filter(|_| ui.memory(|memory| memory.has_focus(id)));
    let mut text = draft.unwrap_or_else(|| match module.edit(&item.id) {
        Some(edit) => edit.text.clone(),
        None => module.known(&item.id).map(|value| item.bare_text(value)).unwrap_or_default(),
    });
    let invalid = matches!(module.state(&item.id), ItemState::Invalid(_));
    let palette = theme::palette(ui);
    let mut edit =
        TextEdit::singleline(&mut text).id(id).desired_width(width - theme::FIELD_MARGIN).hint_text(words::UNKNOWN);
    if let Kind::Number { .. } = item.kind {
        edit = edit.align(eframe::egui::Align2::RIGHT_CENTER);
    }
    if invalid {
        edit = edit.text_color(palette.error);
    }
    let response = ui.add(edit);
    widgets::name_field(&response, &item.label, &text);
    let response = response.on_hover_text(explanation(module, item));
    if response.changed() {
        pass.actions.push(Action::Stage(module.target, item.id.clone(), text.clone()));
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    if gave_up(ui, &response) {
        pass.actions.push(Action::Revert(module.target, Some(item.id.clone())));
    } else if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
        write(module, pass, std::slice::from_ref(&item.id));
    }
}

/// Esc reverts what has the focus.
fn keys(ui: &Ui, response: &Response, module: &Module, pass: &mut Pass<'_>, item: &Item) {
    if module.edit(&item.id).is_none() {
        return;
    }
    if gave_up(ui, response) {
        pass.actions.push(Action::Revert(module.target, Some(item.id.clone())));
    }
}

/// Enter writes the change of what has the focus, and with Ctrl all of them, before egui takes the key for a click.
fn written_by_key(ui: &Ui, id: Id, module: &Module, pass: &mut Pass<'_>, item: &Item) {
    if module.edit(&item.id).is_none() || !ui.memory(|memory| memory.has_focus(id)) {
        return;
    }
    if ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Enter)) {
        let all: Vec<String> = module.edited().into_iter().map(str::to_owned).collect();
        write(module, pass, &all);
    } else if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter)) {
        write(module, pass, std::slice::from_ref(&item.id));
    }
}

/// Whether Esc was pressed in it; egui takes the focus away before anything is drawn.
fn gave_up(ui: &Ui, response: &Response) -> bool {
    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape))
}

/// Writes these changes, after a question where one cuts the program off from the module or needs INIT mode.
pub fn write(module: &Module, pass: &mut Pass<'_>, ids: &[String]) {
    let edited: Vec<String> =
        module.edited().into_iter().filter(|id| ids.iter().any(|wanted| wanted == id)).map(str::to_owned).collect();
    let is_barred = pass.bench.line().obstacle().is_some();
    if is_barred || edited.is_empty() || edited.iter().any(|id| module.edit(id).is_some_and(|edit| edit.value.is_err()))
    {
        return;
    }
    let needs_init = |id: &String| module.item(id).is_some_and(|item| item.applies == Applies::Init);
    // What moves the module would leave the others behind, so all are asked for and written in one go.
    if module.known("init_mode") == Some(&Value::Bool(true)) && edited.iter().any(needs_init) {
        *pass.confirm = Some(cut_off(module, edited));
        return;
    }
    let (init, now): (Vec<String>, Vec<String>) = edited.into_iter().partition(needs_init);
    if let Some(question) = watchdog::before_writing(module, &now) {
        *pass.confirm = Some(question);
        return;
    }
    if !now.is_empty() {
        pass.actions.push(Action::Write(module.target, now));
    }
    if !init.is_empty() {
        pass.actions.push(Action::BeginInit(module.target));
    }
}

/// What is written in INIT mode is in force after the next power cycle; the module is not found where it was then.
fn cut_off(module: &Module, ids: Vec<String>) -> Confirm {
    let mut lines: Vec<String> = ids
        .iter()
        .filter_map(|id| Some((module.item(id)?, module.wanted(id)?)))
        .map(|(item, value)| format!("{}: {}", item.label, item.text(value)))
        .collect();
    lines.push(String::new());
    lines.push(
        "In force once INIT mode is left and the power was switched off and on. From then on the module does not answer \
         with its present settings; scan for it, or use the guided change instead."
            .to_owned(),
    );
    Confirm {
        title: format!("{} will be reached in another way", module.label()),
        lines,
        button: format!("Write {}", ids.len()),
        actions: vec![Action::Write(module.target, ids)],
    }
}

/// What is to be said of the value, in the room that is left: a mark, a word, and what can be done.
pub fn state(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item) {
    let palette = theme::palette(ui);
    let state = module.state(&item.id);
    let (glyph, colour, text) = state_words(&state, module, item, pass, palette);
    let changed = matches!(state, ItemState::Edited | ItemState::Invalid(_) | ItemState::Refused(_));
    let buttons = if changed { theme::FORM_BUTTONS } else { 0.0 };
    let width = (ui.available_width() - buttons - theme::GLYPH - 2.0 * theme::GAP).clamp(0.0, theme::FORM_STATE);
    match glyph {
        Some(glyph) => drop(widgets::glyph(ui, glyph, colour)),
        None => drop(ui.allocate_exact_size(vec2(theme::GLYPH, theme::CONTROL_HEIGHT), Sense::hover())),
    }
    let response = widgets::fixed_coloured(ui, width, Align::Min, &text, colour);
    widgets::describe(&response, Role::Label, &format!("{}: {text}", item.label));
    match &state {
        ItemState::Unreadable(failure) => drop(response.on_hover_text(failure.to_string())),
        _ => drop(response.on_hover_text(&text)),
    }
    if changed {
        let obstacle = pass.bench.line().obstacle();
        let writable = !matches!(state, ItemState::Invalid(_)) && obstacle.is_none();
        let word = if matches!(state, ItemState::Refused(_)) { "Retry" } else { "Write" };
        let button = ui.add_enabled(writable, Button::new(word)).on_hover_text("Writes this change (Enter)");
        let button = button.on_disabled_hover_text(obstacle.unwrap_or(&text));
        button.widget_info(|| WidgetInfo::labeled(Role::Button, writable, format!("{word} {}", item.label)));
        if button.clicked() {
            write(module, pass, std::slice::from_ref(&item.id));
        }
        let button = ui.button("Revert").on_hover_text("Drops this change (Esc)");
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Revert {}", item.label)));
        if button.clicked() {
            pass.actions.push(Action::Revert(module.target, Some(item.id.clone())));
        }
    }
}

fn state_words(
    state: &ItemState<'_>,
    module: &Module,
    item: &Item,
    pass: &Pass<'_>,
    palette: &Palette,
) -> (Option<Glyph>, Color32, String) {
    let was = || match module.known(&item.id) {
        Some(value) => format!("not written, was {}", item.text(value)),
        None => "not written".to_owned(),
    };
    match state {
        ItemState::Unknown => (Some(Glyph::Dashes), palette.old, "not read yet".to_owned()),
        ItemState::BeingRead => (Some(Glyph::Dashes), palette.quiet, "being read".to_owned()),
        ItemState::Current(at) => {
            let age = words::since(*at, pass.bench.now());
            let written = module.reading(&item.id).is_some_and(|reading| reading.written);
            match (item.live, written) {
                (_, true) => (Some(Glyph::Tick), palette.ok, format!("written {} ago", words::age(age))),
                (true, false) => (None, palette.old, String::new()),
                (false, false) => (None, palette.old, format!("read {} ago", words::age(age))),
            }
        }
        ItemState::Edited => (Some(Glyph::Edited), palette.accent, was()),
        ItemState::Invalid(allowed) => (Some(Glyph::Cross), palette.error, (*allowed).to_owned()),
        ItemState::BeingWritten => (Some(Glyph::Dashes), palette.accent, "being written".to_owned()),
        ItemState::Refused(reason) => (Some(Glyph::Cross), palette.error, (*reason).to_owned()),
        ItemState::Unreadable(failure) => (Some(Glyph::Cross), palette.error, words::not_read(failure)),
    }
}

/// A button that carries out an action of the definition; nothing if the module does not have it.
pub fn action(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, id: &str) {
    let known = module.definition().and_then(|definition| definition.action(id));
    let Some(action) = known.filter(|action| action.is_offered(module.target.protocol)) else { return };
    let obstacle = pass.bench.line().obstacle();
    let busy = module.is_acting(id) || obstacle.is_some();
    let mut help = action.help.clone();
    if action.is_broadcast() {
        help.push_str("\nA broadcast: every module of the line hears it");
    }
    let response = ui.add_enabled(!busy, Button::new(&action.label)).on_hover_text(help);
    let response = response.on_disabled_hover_text(obstacle.unwrap_or("It is being carried out"));
    if !response.clicked() {
        return;
    }
    let act = Action::Act(module.target, id.to_owned());
    if action.confirm {
        *pass.confirm = Some(Confirm {
            title: format!("{}: {} at address {}", action.label, module.label(), module.target.address),
            lines: vec![action.help.clone()],
            button: action.label.clone(),
            actions: vec![act],
        });
    } else {
        pass.actions.push(act);
    }
}

/// A heading between groups of lines.
pub fn heading(ui: &mut Ui, text: &str) {
    let palette = theme::palette(ui);
    ui.add_space(theme::GAP);
    ui.label(eframe::egui::RichText::new(text).color(palette.text).strong());
    ui.add_space(theme::HAIRLINE);
}
