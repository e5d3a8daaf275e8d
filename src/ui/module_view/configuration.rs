//! Configuration: identity, communication, the picture of the switches, and what needs INIT mode.

mod rows;
mod switches;

use std::collections::BTreeSet;

use eframe::egui::{Align, Layout, Ui, UiBuilder, vec2};

use super::tabs::{self, Tab};
use super::{form, generic};
use crate::bench::Module;
use crate::module::Item;
use crate::ui::app::Pass;
use crate::ui::theme;

const TAB: &str = "configuration";
/// The groups of the form; what else the tab has follows them.
const IDENTITY: [&str; 2] = ["name", "firmware"];
const COMMUNICATION: [&str; 8] =
    ["address", "protocol", "baud_rate", "data_format", "checksum", "response_delay", "init_mode", "reset_status"];

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Configuration;

impl Configuration {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let panel = switches::panel(module);
        let room = ui.available_width().min(theme::TAB_WIDTH);
        if panel.is_empty() {
            return in_column(ui, room.min(theme::CONFIGURATION_FORM), |ui| settings(ui, module, pass));
        }
        let beside = room - theme::SWITCHES_WIDTH - theme::GAP_SECTION;
        if beside < theme::CONFIGURATION_FORM_LEAST {
            settings(ui, module, pass);
            ui.add_space(theme::GAP_SECTION);
            return switches::show(ui, module, &panel);
        }
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GAP_SECTION;
            in_column(ui, beside.min(theme::CONFIGURATION_FORM), |ui| settings(ui, module, pass));
            in_column(ui, theme::SWITCHES_WIDTH, |ui| switches::show(ui, module, &panel));
        });
    }
}

fn in_column(ui: &mut Ui, width: f32, contents: impl FnOnce(&mut Ui)) {
    let room = eframe::egui::Rect::from_min_size(ui.cursor().min, vec2(width, ui.available_height()));
    let builder = UiBuilder::new().max_rect(room).layout(Layout::top_down(Align::Min));
    let spacing = theme::GAP;
    ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.x = spacing;
        ui.set_width(width);
        contents(ui);
    });
}

fn settings(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let items = tabs::items(module, TAB);
    let there = |id: &&str| items.iter().any(|item| item.id == *id);
    let settings = |item: &&&Item| !item.live;
    let others: Vec<&str> = items.iter().filter(settings).map(|item| item.id.as_str()).collect();
    let others = others.into_iter().filter(|id| !IDENTITY.contains(id) && !COMMUNICATION.contains(id));
    let groups: [(&str, Vec<&str>); 3] = [
        ("Identity", IDENTITY.into_iter().filter(there).collect()),
        ("Communication", COMMUNICATION.into_iter().filter(there).collect()),
        ("Other", others.collect()),
    ];
    for (heading, ids) in groups {
        if ids.is_empty() {
            continue;
        }
        form::heading(ui, heading);
        ids.iter().for_each(|id| rows::show(ui, module, pass, id));
        if heading == "Communication" {
            rows::notes(ui, module, pass, &items);
        }
    }
    generic::actions(ui, TAB, module, pass);
}

/// Items of other tabs that tell how the switches stand, and that the tab asks for as well.
pub fn also_read(module: &Module, tab: &Tab) -> Vec<String> {
    if tab.key() != TAB {
        return Vec::new();
    }
    let layout = module.definition().map(|definition| &definition.switch_layout);
    let groups = layout.into_iter().flat_map(|layout| &layout.banks).flat_map(|bank| &bank.groups);
    let told_by: BTreeSet<&String> =
        groups.flat_map(|group| &group.rows).flat_map(|row| row.when.iter().map(|(id, _)| id)).collect();
    let polled = |item: &Item| item.live && module.interval.is_some();
    let items = told_by.into_iter().filter_map(|id| module.item(id)).filter(|item| item.tab != TAB);
    items.filter(|item| module.has(item) && !item.on_request && !polled(item)).map(|item| item.id.clone()).collect()
}
