//! The tabs in the middle of the window: the dashboard, modules and the traffic, side by side or in windows of their
//! own.

use std::collections::BTreeMap;

use eframe::egui::{self, CentralPanel, Id, Ui, ViewportBuilder, ViewportId, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, Tile, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

use super::app::Pass;
use super::dashboard::Dashboard;
use super::dialogs::Dialogs;
use super::module_view::ModuleView;
use super::traffic::TrafficView;
use super::widgets::{self, Glyph};
use super::{theme, words};
use crate::bench::Bench;
use crate::bus::Target;

/// What a tab shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Pane {
    Dashboard,
    Traffic,
    Module(Target),
}

/// Where the panes are, as it is kept between starts.
#[derive(Serialize, Deserialize)]
struct Layout {
    tree: Tree<Pane>,
    windows: Vec<Pane>,
}

/// What the contents of the panes remember between frames.
#[derive(Default)]
struct Views {
    modules: BTreeMap<Target, ModuleView>,
    traffic: TrafficView,
    dashboard: Dashboard,
}

pub struct Panes {
    tree: Tree<Pane>,
    /// Panes in windows of their own.
    windows: Vec<Pane>,
    views: Views,
    /// The pane that the user looked at last.
    active: Pane,
}

/// What the tabs ask for while they are drawn.
enum Wish {
    Close(Pane),
    OwnWindow(Pane),
    Open(Pane),
}

impl Default for Panes {
    fn default() -> Self {
        Self { tree: new_tree(), windows: Vec::new(), views: Views::default(), active: Pane::Dashboard }
    }
}

fn new_tree() -> Tree<Pane> {
    Tree::new_tabs(Id::unique("panes"), vec![Pane::Dashboard])
}

impl Panes {
    /// The layout that [`Self::layout`] gave, or the first one if it cannot be read.
    pub fn from_layout(text: &str) -> Self {
        let layout: Option<Layout> = serde_json::from_str(text).ok();
        match layout {
            Some(Layout { tree, windows }) if !tree.is_empty() => Self { tree, windows, ..Self::default() },
            _ => Self::default(),
        }
    }

    pub fn layout(&self) -> Option<String> {
        serde_json::to_string(&Layout { tree: self.tree.clone(), windows: self.windows.clone() })
            .map_err(|error| log::warn!("the layout cannot be kept: {error}"))
            .ok()
    }

    /// Brings a pane to the front, opening it first if it is not there.
    pub fn open(&mut self, pane: Pane) {
        self.active = pane;
        if self.windows.contains(&pane) {
            return;
        }
        if self.tree.tiles.find_pane(&pane).is_none() {
            self.insert(pane);
        }
        let Some(tile) = self.tree.tiles.find_pane(&pane) else { return };
        self.tree.make_active(|id, _| id == tile);
    }

    /// Beside the pane that was looked at last, else beside the dashboard.
    fn insert(&mut self, pane: Pane) {
        let beside = [self.active, Pane::Dashboard].into_iter().find_map(|pane| self.tree.tiles.find_pane(&pane));
        let container = beside.and_then(|tile| self.tree.tiles.parent_of(tile)).or(self.tree.root);
        let tile = self.tree.tiles.insert_pane(pane);
        match container {
            Some(container) => self.tree.move_tile_to_container(tile, container, usize::MAX, true),
            None => {
                let root = self.tree.tiles.insert_tab_tile(vec![tile]);
                self.tree.root = Some(root);
            }
        }
    }

    pub fn close(&mut self, pane: Pane) {
        self.windows.retain(|window| *window != pane);
        if let Some(tile) = self.tree.tiles.find_pane(&pane) {
            self.tree.remove_recursively(tile);
        }
    }

    pub fn active(&self) -> Pane {
        self.active
    }

    /// Modules whose panes are open, wherever.
    pub fn modules(&self) -> Vec<Target> {
        let in_tree = self.tree.tiles.tiles().filter_map(|tile| match tile {
            Tile::Pane(pane) => Some(*pane),
            Tile::Container(_) => None,
        });
        let all = in_tree.chain(self.windows.iter().copied());
        all.filter_map(|pane| if let Pane::Module(target) = pane { Some(target) } else { None }).collect()
    }

    /// The module at `from` is at `to` now.
    pub fn follow(&mut self, from: Target, to: Target) {
        let (from_pane, to_pane) = (Pane::Module(from), Pane::Module(to));
        self.close(to_pane);
        for tile in self.tree.tiles.tiles_mut() {
            if let Tile::Pane(pane) = tile
                && *pane == from_pane
            {
                *pane = to_pane;
            }
        }
        self.windows.iter_mut().filter(|pane| **pane == from_pane).for_each(|pane| *pane = to_pane);
        if self.active == from_pane {
            self.active = to_pane;
        }
        if let Some(view) = self.views.modules.remove(&from) {
            self.views.modules.insert(to, view);
        }
    }

    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>, dialogs: &mut Dialogs) {
        if self.tree.is_empty() {
            self.tree = new_tree();
        }
        let mut wishes = Vec::new();
        let Self { tree, views, active, .. } = self;
        tree.ui(&mut Tabs { pass, dialogs, views, active, wishes: &mut wishes }, ui);
        self.show_windows(ui.ctx(), pass, dialogs, &mut wishes);
        for wish in wishes {
            match wish {
                Wish::Close(pane) => pass.closing.push(pane),
                Wish::Open(pane) => self.open(pane),
                Wish::OwnWindow(pane) => {
                    self.close(pane);
                    self.windows.push(pane);
                }
            }
        }
    }

    fn show_windows(
        &mut self,
        ctx: &egui::Context,
        pass: &mut Pass<'_>,
        dialogs: &mut Dialogs,
        wishes: &mut Vec<Wish>,
    ) {
        let mut back = Vec::new();
        for pane in &self.windows {
            let builder = ViewportBuilder::default()
                .with_title(format!("{} – dcon-bench", title(pass.bench, *pane)))
                .with_inner_size(theme::WINDOW_OWN)
                .with_min_inner_size(theme::WINDOW_LEAST);
            let views = &mut self.views;
            ctx.show_viewport_immediate(ViewportId::from_hash_of(pane_key(*pane)), builder, |ui, _class| {
                let palette = theme::palette(ui);
                CentralPanel::default()
                    .frame(theme::ground_frame(palette))
                    .show(ui, |ui| views.show(ui, *pane, pass, dialogs, wishes));
                if ui.input(|input| input.viewport().close_requested()) {
                    back.push(*pane);
                }
            });
        }
        for pane in back {
            self.windows.retain(|window| *window != pane);
            self.open(pane);
        }
    }
}

fn pane_key(pane: Pane) -> String {
    format!("{pane:?}")
}

/// What stands on the tab.
fn title(bench: &Bench, pane: Pane) -> String {
    match pane {
        Pane::Dashboard => "Dashboard".to_owned(),
        Pane::Traffic => "Traffic".to_owned(),
        Pane::Module(target) => {
            let label = bench.module(&target).map_or("Module", |module| module.label());
            format!("{label} @{}", target.address)
        }
    }
}

impl Views {
    fn show(&mut self, ui: &mut Ui, pane: Pane, pass: &mut Pass<'_>, dialogs: &mut Dialogs, wishes: &mut Vec<Wish>) {
        match pane {
            Pane::Dashboard => self.dashboard.show(ui, pass),
            Pane::Traffic => self.traffic.show(ui, pass),
            Pane::Module(target) => match pass.bench.module(&target) {
                Some(module) => self.modules.entry(target).or_default().show(ui, module, pass, dialogs),
                None => absent(ui, target, wishes),
            },
        }
    }
}

/// A module that was open when the program was used last, and is not found yet.
fn absent(ui: &mut Ui, target: Target, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    let place = format!("Address {}, {}", words::address(target.address), words::spoken(&target));
    let lines = [place.as_str(), "It shows here as soon as a scan finds it."];
    widgets::empty_state(ui, palette, "Not found on this line yet", &lines);
    if ui.button("Close").clicked() {
        wishes.push(Wish::Close(Pane::Module(target)));
    }
}

struct Tabs<'a, 'p> {
    pass: &'a mut Pass<'p>,
    dialogs: &'a mut Dialogs,
    views: &'a mut Views,
    active: &'a mut Pane,
    wishes: &'a mut Vec<Wish>,
}

impl Behavior<Pane> for Tabs<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let palette = theme::palette(ui);
        if ui.rect_contains_pointer(ui.max_rect()) && ui.input(|input| input.pointer.any_pressed()) {
            *self.active = *pane;
        }
        theme::ground_frame(palette).show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            self.views.show(ui, *pane, self.pass, self.dialogs, self.wishes);
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        title(self.pass.bench, *pane).into()
    }

    fn is_tab_closable(&self, tiles: &Tiles<Pane>, tile: TileId) -> bool {
        !matches!(tiles.get_pane(&tile), Some(Pane::Dashboard) | None)
    }

    fn on_tab_close(&mut self, tiles: &mut Tiles<Pane>, tile: TileId) -> bool {
        if let Some(pane) = tiles.get_pane(&tile) {
            self.wishes.push(Wish::Close(*pane));
        }
        // Unwritten changes are asked about first.
        false
    }

    fn on_tab_button(&mut self, tiles: &mut Tiles<Pane>, tile: TileId, response: egui::Response) -> egui::Response {
        let Some(pane) = tiles.get_pane(&tile).copied() else { return response };
        if response.clicked() {
            *self.active = pane;
        }
        response.context_menu(|ui| {
            if ui.button("Open in a window of its own").clicked() {
                self.wishes.push(Wish::OwnWindow(pane));
                ui.close();
            }
            if pane != Pane::Dashboard && ui.button("Close").clicked() {
                self.wishes.push(Wish::Close(pane));
                ui.close();
            }
        });
        response.on_hover_text("Drag it to the side of another to see both; right click for more")
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<Pane>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &egui_tiles::Tabs,
        _: &mut f32,
    ) {
        ui.add_space(theme::UNIT);
        let active = tabs.active.and_then(|tile| tiles.get_pane(&tile)).copied();
        if let Some(pane) = active {
            let response = widgets::glyph_button(ui, Glyph::Detach, "Own window", true);
            if response.on_hover_text("Show this tab in a window of its own").clicked() {
                self.wishes.push(Wish::OwnWindow(pane));
            }
        }
        if tiles.find_pane(&Pane::Traffic).is_none() && ui.button("Traffic").clicked() {
            self.wishes.push(Wish::Open(Pane::Traffic));
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        theme::TAB_HEIGHT
    }

    fn tab_bar_color(&self, visuals: &egui::Visuals) -> egui::Color32 {
        visuals.panel_fill
    }

    fn tab_bg_color(
        &self,
        visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if state.active { visuals.extreme_bg_color } else { visuals.panel_fill }
    }

    fn tab_outline_stroke(
        &self,
        visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Stroke {
        if state.active { visuals.widgets.noninteractive.bg_stroke } else { egui::Stroke::NONE }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        theme::UNIT
    }

    fn min_size(&self) -> f32 {
        theme::PANE_LEAST
    }
}
