//! The menu: every command with its keys, and how the window looks.

use eframe::egui::{self, Button, DragValue, Layout, Response, Role, ScrollArea, Ui, WidgetInfo, vec2};

use super::{TemperatureUnit, ThemeChoice, ZOOMS, milliseconds};
use crate::bench::Action;
use crate::bus::Tuning;
use crate::ui::app::Pass;
use crate::ui::commands::{self, Command};
use crate::ui::{theme, widgets};

const ZOOM_STEP: f32 = 0.1;

/// The menu at the right end of the top row.
pub fn menu(ui: &mut Ui, pass: &mut Pass<'_>) {
    let menu = widgets::menu(ui, "Menu", "Menu", |ui| {
        // In a small window, or with large text, not all of it has room.
        let room = ui.ctx().content_rect().size() - vec2(4.0 * theme::GAP, 4.0 * theme::GAP + theme::TAB_HEIGHT);
        let area = ScrollArea::both().max_width(room.x).max_height(room.y);
        // A popup offers less height than there is.
        let beside = (room.x / (theme::COMMANDS_WIDTH + theme::GAP)).floor() as usize;
        area.min_scrolled_width(room.x).min_scrolled_height(room.y).show(ui, |ui| columns(ui, pass, beside));
    });
    menu.on_hover_text("All commands with their keys, and how the window looks");
}

type Column = fn(&mut Ui, &mut Pass<'_>);
/// Three, because fewer would be higher than a small window.
const COLUMNS: [Column; 3] = [line_and_program, module_and_patience, tabs_and_looks];

/// As many columns `beside` each other as have room, the rest below them.
fn columns(ui: &mut Ui, pass: &mut Pass<'_>, beside: usize) {
    for row in COLUMNS.chunks(beside.max(1)) {
        ui.with_layout(Layout::left_to_right(egui::Align::Min), |ui| {
            for contents in row {
                column(ui, |ui| contents(ui, pass));
                ui.add_space(theme::GAP);
            }
        });
        ui.add_space(theme::GAP);
    }
}

fn line_and_program(ui: &mut Ui, pass: &mut Pass<'_>) {
    group(ui, pass, "Line", commands::LINE);
    ui.add_space(theme::GAP);
    group(ui, pass, "Recording", commands::RECORDING);
    ui.add_space(theme::GAP);
    group(ui, pass, "Program and help", commands::PROGRAM);
}

fn module_and_patience(ui: &mut Ui, pass: &mut Pass<'_>) {
    group(ui, pass, "Module in view", commands::MODULE);
    ui.add_space(theme::GAP);
    patience(ui, pass);
}

fn tabs_and_looks(ui: &mut Ui, pass: &mut Pass<'_>) {
    group(ui, pass, "Tabs", commands::TABS);
    ui.add_space(theme::GAP);
    looks(ui, pass);
}

fn column(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    ui.vertical(|ui| {
        ui.set_width(theme::COMMANDS_WIDTH);
        ui.spacing_mut().item_spacing.y = 0.0;
        contents(ui);
    });
}

fn group(ui: &mut Ui, pass: &mut Pass<'_>, title: &str, commands: &[Command]) {
    widgets::section(ui, title);
    for command in commands {
        entry(ui, pass, *command);
    }
}

/// What the command does, and its keys at the right.
fn entry(ui: &mut Ui, pass: &mut Pass<'_>, command: Command) {
    let obstacle = command.obstacle(pass);
    let keys = command.shortcut().map(|shortcut| ui.ctx().format_shortcut(&shortcut)).unwrap_or_default();
    let text = command.text_now(pass);
    let button = Button::selectable(false, text.as_str())
        .truncate()
        .shortcut_text(keys)
        .min_size(vec2(ui.available_width(), theme::CONTROL_HEIGHT));
    let response = ui.add_enabled(obstacle.is_none(), button);
    response.widget_info(|| WidgetInfo::labeled(Role::MenuItem, obstacle.is_none(), &text));
    let response = response.on_hover_text(command.explanation());
    if response.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
        pass.commands.push(command);
        ui.close();
    }
}

fn looks(ui: &mut Ui, pass: &mut Pass<'_>) {
    widgets::section(ui, "Theme and temperatures");
    ui.horizontal(|ui| {
        for (choice, name) in ThemeChoice::ALL {
            let radio = ui.radio_value(&mut pass.settings.theme, choice, name);
            if radio.on_hover_text("Light or dark colours of the window").changed() {
                ui.ctx().set_theme(choice.preference());
            }
        }
    });
    ui.horizontal(|ui| {
        for unit in TemperatureUnit::ALL {
            ui.radio_value(&mut pass.settings.temperature, unit, unit.symbol()).on_hover_text(unit.means());
        }
    });
    size(ui);
    commands::SIZE.iter().for_each(|command| entry(ui, pass, *command));
}

/// How large everything is drawn; it is put in force when the field is left, so that nothing moves under the pointer.
fn size(ui: &mut Ui) {
    widgets::section(ui, "Size of everything");
    let id = ui.scope_id().with("size");
    let in_force = f64::from(ui.ctx().zoom_factor()) * 100.0;
    let mut percent = ui.data(|data| data.get_temp(id)).unwrap_or(in_force.round());
    let range = f64::from(*ZOOMS.start()) * 100.0..=f64::from(*ZOOMS.end()) * 100.0;
    let field = DragValue::new(&mut percent).range(range).speed(1.0).fixed_decimals(0).suffix(" %");
    let response = ui.horizontal(|ui| {
        // In a menu buttons have no ground, but this is a field.
        ui.visuals_mut().widgets.inactive.weak_bg_fill = theme::palette(ui).raised;
        ui.add(field)
    });
    let response = response.inner.on_hover_text("Text and everything else; 100 % is as large as the system wants it");
    name_number(&response, "Size", percent);
    if response.dragged() || response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, percent));
    } else {
        ui.data_mut(|data| data.remove::<f64>(id));
        if response.lost_focus() || response.drag_stopped() {
            ui.ctx().set_zoom_factor((percent / 100.0) as f32);
        }
    }
}

/// How long answers are waited for, and how often a read is asked again.
fn patience(ui: &mut Ui, pass: &mut Pass<'_>) {
    widgets::section(ui, "Waiting for answers");
    let before = pass.settings.tuning();
    ui.horizontal(|ui| {
        // In a menu buttons have no ground, but these are fields.
        let ground = theme::palette(ui).raised;
        ui.visuals_mut().widgets.inactive.weak_bg_fill = ground;
        let timeouts = milliseconds(*Tuning::TIMEOUTS.start())..=milliseconds(*Tuning::TIMEOUTS.end());
        widgets::quiet(ui, "Timeout");
        let field = DragValue::new(&mut pass.settings.timeout_ms).range(timeouts).speed(2.0).suffix(" ms");
        let response = ui.add(field).on_hover_text(
            "From the end of a request to the first byte of its answer. Slow adapters, hubs and networks need more; with \
             more, a silent module costs more time",
        );
        name_number(&response, "Timeout", pass.settings.timeout_ms.into());
        ui.add_space(theme::GAP);
        widgets::quiet(ui, "Repeats");
        let field = DragValue::new(&mut pass.settings.repeats).range(Tuning::REPEATS).speed(0.05);
        let response = ui.add(field).on_hover_text(
            "A read is asked again so often when no usable answer came; writes never are. 0 shows every fault of the line",
        );
        name_number(&response, "Repeats", pass.settings.repeats.into());
    });
    let tuning = pass.settings.tuning();
    if tuning != before {
        pass.actions.push(Action::Tune(tuning));
    }
}

fn name_number(response: &Response, name: &str, value: f64) {
    response.widget_info(|| WidgetInfo { value: Some(value), ..WidgetInfo::labeled(Role::SpinButton, true, name) });
}

/// Makes everything larger by so many steps, or smaller.
pub fn zoom_by(ctx: &egui::Context, steps: f32) {
    let wanted = ctx.zoom_factor() + steps * ZOOM_STEP;
    ctx.set_zoom_factor(wanted.clamp(*ZOOMS.start(), *ZOOMS.end()));
}
