//! The row above the plots: how time moves, and what else is shown.

use eframe::egui::{Button, Ui, vec2};

use super::TrendView;
use super::picture::Wanted;
use super::window::NAMED;
use crate::ui::plot::Zone;
use crate::ui::settings::Settings;
use crate::ui::{theme, widgets};

pub fn show(ui: &mut Ui, view: &mut TrendView, settings: &mut Settings, known: [f64; 2]) {
    let room = ui.available_width();
    let wide = room >= theme::TREND_TOOLS;
    ui.horizontal(|ui| {
        let open = view.chooser.is_open(room);
        if widgets::chip(ui, open, "Series", "List of series", "What can be shown, to be ticked or dragged into a plot")
        {
            view.chooser.set_open(!open);
        }
        time(ui, view, known);
        if wide {
            widgets::at_right(ui, |ui| others(ui, view, settings, known));
        }
    });
    if !wide {
        ui.horizontal(|ui| widgets::at_right(ui, |ui| others(ui, view, settings, known)));
    }
}

/// What does not move time.
fn others(ui: &mut Ui, view: &mut TrendView, settings: &mut Settings, known: [f64; 2]) {
    ui.spacing_mut().item_spacing.x = theme::UNIT;
    if widgets::chip(ui, view.events_open, "Events", "List of events", "What happened, as a list below the plots") {
        view.events_open = !view.events_open;
    }
    let means = "Values at the pointer and the cursors, and lowest, highest and mean of the time between";
    if widgets::chip(ui, view.table_open, "Values", "Table of values", means) {
        view.table_open = !view.table_open;
    }
    if ui.button("Export…").on_hover_text("Readings as CSV, JSON Lines or Parquet").clicked() {
        view.ask_to_export();
    }
    picture(ui, view);
    zone(ui, settings, known);
}

fn time(ui: &mut Ui, view: &mut TrendView, known: [f64; 2]) {
    let window = &mut view.area.window;
    let following = window.is_following();
    let (name, help) = match following {
        true => ("Pause", "The plots stand still; polling goes on"),
        false => ("Follow", "The newest values stay at the right edge"),
    };
    let button = Button::new(name).min_size(vec2(theme::FORMAT_WIDTH, theme::CONTROL_HEIGHT));
    if ui.add(button).on_hover_text(help).clicked() {
        if following { window.pause(known) } else { window.follow() }
    }
    let span = window.span_text();
    let combo = widgets::combo("span", theme::SPAN_WIDTH, &span).show_ui(ui, |ui| {
        for (seconds, name) in NAMED {
            if ui.selectable_label(span == name, name).clicked() {
                window.set_span(seconds);
            }
        }
    });
    widgets::name_combo(&combo.response, "Time in view", &span);
    combo.response.on_hover_text("The time in view; the wheel over the plots changes it too");
    if ui.button("All").on_hover_text("Everything there is; all axes follow the values again").clicked() {
        window.all(known);
        view.area.ranges.clear();
    }
    let window = &mut view.area.window;
    let back = ui.add_enabled(window.steps_back() > 0, Button::new("Back"));
    let back = back.on_hover_text("To what was in view before (Backspace)");
    if back.on_disabled_hover_text("Nothing else was in view yet").clicked() {
        window.back();
    }
    let on = view.area.zoom_box;
    let zoom = Button::selectable(on, "Zoom").frame_when_inactive(true);
    let help = "Drag a box to see it large; a drag with the right button selects a time at once";
    if ui.add(zoom).on_hover_text(help).clicked() {
        view.area.zoom_box = !on;
    }
}

fn zone(ui: &mut Ui, settings: &mut Settings, known: [f64; 2]) {
    let chosen = Zone::of(settings.utc);
    for zone in [Zone::Utc, Zone::Local] {
        let (text, name) = if zone == Zone::Utc { ("UTC", "Times in UTC") } else { ("Local", "Local times") };
        let button = Button::selectable(chosen == zone, text).frame_when_inactive(true);
        let response = ui.add(button);
        response.widget_info(|| {
            eframe::egui::WidgetInfo::selected(eframe::egui::Role::CheckBox, true, chosen == zone, name)
        });
        if response.on_hover_text(format!("Times in {}", zone.name(known[1]))).clicked() {
            settings.utc = zone == Zone::Utc;
        }
    }
}

fn picture(ui: &mut Ui, view: &mut TrendView) {
    let picture = widgets::menu(ui, "Picture", "Picture", |ui| {
        for wanted in Wanted::ALL {
            if ui.button(wanted.text()).clicked() {
                view.pictures.ask(wanted);
                ui.close();
            }
        }
    });
    picture.on_hover_text("The plots as they are, as a file or to be pasted");
}
