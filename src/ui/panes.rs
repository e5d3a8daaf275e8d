//! The tabs in the middle of the window: the dashboard, modules and the traffic, side by side or in windows of their
//! own.

use std::collections::{BTreeMap, HashSet};

use eframe::egui::{self, CentralPanel, Id, Panel, Ui, ViewportBuilder, ViewportClass, ViewportCommand, ViewportId};
use egui_tiles::{ContainerKind, Tile, TileId, Tree};
use serde::{Deserialize, Serialize};

use super::app::Pass;
use super::commands;
use super::dashboard::Dashboard;
use super::diagnosis::DiagnosisView;
use super::dialogs::Dialogs;
use super::help::{self, HelpView, about::AboutBox};
use super::module_view::ModuleView;
use super::pane_tabs::Tabs;
use super::traffic::TrafficView;
use super::trends::TrendView;
use super::trends::{self, Source};
use super::{theme, widgets, words};
use crate::bench::{Action, Bench, RecordingId};
use crate::bus::Target;
use crate::version::NAME;

/// What a tab shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Pane {
    Dashboard,
    Traffic,
    /// The plots of everything that is polled.
    Trends,
    /// What is wrong with the line.
    Diagnosis,
    /// How to use the program, and the command reference.
    Help,
    /// A recording that was opened.
    Recording(RecordingId),
    Module(Target),
}

/// Where the panes are, as it is kept between starts.
#[derive(Serialize, Deserialize)]
struct Layout {
    tree: Tree<Pane>,
    windows: Vec<Pane>,
    #[serde(default)]
    active: Option<Pane>,
}

/// What the contents of the panes remember between frames.
#[derive(Default)]
pub(super) struct Views {
    modules: BTreeMap<Target, ModuleView>,
    traffic: TrafficView,
    trends: TrendView,
    diagnosis: DiagnosisView,
    help: HelpView,
    pub about: AboutBox,
    recordings: BTreeMap<RecordingId, TrendView>,
    dashboard: Dashboard,
}

pub struct Panes {
    tree: Tree<Pane>,
    /// Panes in windows of their own.
    windows: Vec<Pane>,
    pub(super) views: Views,
    /// The pane that the user works in.
    active: Pane,
    /// What had the focus in the last frame.
    focused: Option<Id>,
    /// A window that is to come to the front.
    to_front: Option<ViewportId>,
    /// The pane whose own window had the keyboard in the last frame.
    in_front: Option<Pane>,
}

/// What the tabs ask for while they are drawn.
pub(super) enum Wish {
    Close(Pane),
    /// In a window of its own.
    Window(Pane),
    /// Back from there.
    Tab(Pane),
    Open(Pane),
    /// Side by side with the others, or back among them.
    Beside(Pane),
}

impl Default for Panes {
    fn default() -> Self {
        Self {
            tree: new_tree(),
            windows: Vec::new(),
            views: Views::default(),
            active: Pane::Dashboard,
            focused: None,
            to_front: None,
            in_front: None,
        }
    }
}

impl Pane {
    fn is_recording(self) -> bool {
        matches!(self, Self::Recording(_))
    }
}

/// Recordings are closed when the program ends.
fn without_recordings(tree: &mut Tree<Pane>, windows: &mut Vec<Pane>) {
    let recordings: Vec<TileId> = tree
        .tiles
        .iter()
        .filter_map(|(id, tile)| matches!(tile, Tile::Pane(pane) if pane.is_recording()).then_some(*id))
        .collect();
    for tile in recordings {
        tree.remove_recursively(tile);
    }
    windows.retain(|pane| !pane.is_recording());
}

fn new_tree() -> Tree<Pane> {
    Tree::new_tabs(Id::unique("panes"), vec![Pane::Dashboard])
}

impl Panes {
    /// The layout that [`Self::layout`] gave, or the first one if it cannot be read.
    pub fn from_layout(text: &str) -> Self {
        let Ok(Layout { mut tree, mut windows, active }) = serde_json::from_str(text) else { return Self::default() };
        without_recordings(&mut tree, &mut windows);
        windows.retain(|pane| tree.tiles.find_pane(pane).is_none());
        windows.sort_unstable();
        windows.dedup();
        let active = active.filter(|pane| !pane.is_recording()).unwrap_or(Pane::Dashboard);
        Self { tree, windows, active, ..Self::default() }
    }

    pub fn layout(&self) -> Option<String> {
        let (mut tree, mut windows) = (self.tree.clone(), self.windows.clone());
        without_recordings(&mut tree, &mut windows);
        let layout = Layout { tree, windows, active: Some(self.active).filter(|pane| !pane.is_recording()) };
        serde_json::to_string(&layout).map_err(|error| log::warn!("the layout cannot be kept: {error}")).ok()
    }

    /// Brings a pane to the front, opening it first if it is not there.
    pub fn open(&mut self, pane: Pane) {
        if self.windows.contains(&pane) {
            self.to_front = Some(viewport_id(pane));
        } else {
            if self.windows.contains(&self.active) {
                self.to_front = Some(ViewportId::ROOT);
            }
            if self.tree.tiles.find_pane(&pane).is_none() {
                self.insert(pane);
            }
            if let Some(tile) = self.tree.tiles.find_pane(&pane) {
                self.tree.make_active(|id, _| id == tile);
            }
        }
        self.active = pane;
    }

    /// Among the tabs of the pane that was worked in last, else beside the dashboard.
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

    /// Forgets how a recording that is closed was looked at.
    pub fn forget(&mut self, recording: RecordingId) {
        self.views.recordings.remove(&recording);
    }

    /// Asks what of the readings in this pane is to be exported.
    pub fn export_readings(&mut self, pane: Pane) {
        let view = match pane {
            Pane::Recording(id) => self.views.recordings.entry(id).or_default(),
            _ => &mut self.views.trends,
        };
        view.ask_to_export();
    }

    /// Shows the help on what is in front.
    pub fn show_help(&mut self, pass: &Pass<'_>) {
        let module = if let Pane::Module(target) = pass.active { Some(target) } else { None };
        self.views.help.ask(help::topic(pass), module);
        self.open(Pane::Help);
    }

    /// The pane that the user works in.
    pub fn active(&self) -> Pane {
        self.active
    }

    /// Asks the module again for what its pane shows.
    pub fn read_again(&mut self, target: Target) {
        if let Some(view) = self.views.modules.get_mut(&target) {
            view.read_again();
        }
    }

    /// Goes to the next pane, or to the one before; after the last comes the first.
    pub fn step(&mut self, forward: bool) {
        let all = self.in_order();
        let index = all.iter().position(|pane| *pane == self.active).unwrap_or_default();
        let step = if forward { 1 } else { all.len().saturating_sub(1) };
        if let Some(pane) = all.iter().cycle().nth(index.saturating_add(step)).copied() {
            self.open(pane);
        }
    }

    /// All panes as they stand from left to right, then those in windows of their own.
    fn in_order(&self) -> Vec<Pane> {
        let mut panes = Vec::new();
        let mut waiting: Vec<TileId> = self.tree.root.into_iter().collect();
        let mut seen = HashSet::new();
        while let Some(tile) = waiting.pop().filter(|tile| seen.insert(*tile)) {
            match self.tree.tiles.get(tile) {
                Some(Tile::Pane(pane)) => panes.push(*pane),
                Some(Tile::Container(container)) => waiting.extend(container.children_vec().into_iter().rev()),
                None => {}
            }
        }
        panes.extend(&self.windows);
        panes
    }

    /// Puts a pane into a window of its own, or back among the tabs.
    pub fn toggle_window(&mut self, pane: Pane) {
        if self.windows.contains(&pane) {
            self.windows.retain(|window| *window != pane);
        } else {
            self.close(pane);
            self.windows.push(pane);
        }
        self.open(pane);
    }

    /// Puts a pane to the right of the tabs among which it stands; one that stands alone goes back among the others.
    pub fn toggle_beside(&mut self, pane: Pane) {
        let tiles = &self.tree.tiles;
        let Some(tile) = tiles.find_pane(&pane) else { return };
        let Some(tabs) = tiles.parent_of(tile) else { return };
        if self.stands_alone(pane) {
            let others = self.in_order().into_iter().filter(|other| *other != pane);
            let neighbour = others.filter_map(|other| self.tree.tiles.find_pane(&other)).next_back();
            let Some(home) = neighbour.and_then(|tile| self.tree.tiles.parent_of(tile)) else { return };
            self.tree.move_tile_to_container(tile, home, usize::MAX, true);
        } else {
            self.split(tile, tabs);
        }
        self.open(pane);
    }

    fn stands_alone(&self, pane: Pane) -> bool {
        let tiles = &self.tree.tiles;
        let tabs =
            tiles.find_pane(&pane).and_then(|tile| tiles.parent_of(tile)).and_then(|tabs| tiles.get_container(tabs));
        tabs.is_none_or(|tabs| tabs.num_children() < 2)
    }

    /// Takes `tile` out of `tabs` and puts it to the right of them.
    fn split(&mut self, tile: TileId, tabs: TileId) {
        let tiles = &mut self.tree.tiles;
        let row = tiles.parent_of(tabs);
        let index = row.and_then(|row| tiles.get_container(row)).and_then(|container| {
            let horizontal = container.kind() == ContainerKind::Horizontal;
            container.children().position(|child| *child == tabs).filter(|_| horizontal)
        });
        let own = tiles.insert_tab_tile(Vec::new());
        if let (Some(row), Some(index)) = (row, index) {
            self.tree.move_tile_to_container(own, row, index.saturating_add(1), true);
        } else {
            let both = tiles.insert_horizontal_tile(vec![tabs, own]);
            match row.and_then(|row| tiles.get_mut(row)) {
                Some(Tile::Container(container)) => drop(container.replace_child(tabs, both)),
                _ => self.tree.root = Some(both),
            }
        }
        self.tree.move_tile_to_container(tile, own, 0, true);
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
        let mut wishes = Vec::new();
        let focus_moved_to = self.focus_moved_to(ui.ctx());
        if self.tree.is_empty() && !self.windows.contains(&Pane::Dashboard) {
            self.tree = new_tree();
        }
        if self.tree.is_empty() {
            elsewhere(ui, &mut wishes);
        }
        let in_tree = self.in_order().into_iter().filter(|pane| !self.windows.contains(pane));
        let (alone, others): (Vec<Pane>, Vec<Pane>) = in_tree.partition(|pane| self.stands_alone(*pane));
        let shared = !others.is_empty();
        let Self { tree, views, active, .. } = self;
        tree.ui(&mut Tabs { pass, dialogs, views, active, wishes: &mut wishes, focus_moved_to, alone, shared }, ui);
        self.show_windows(ui.ctx(), pass, dialogs, &mut wishes);
        self.views.about.show(ui.ctx(), pass);
        for wish in wishes {
            match wish {
                Wish::Close(pane) => pass.closing.push(pane),
                Wish::Open(pane) => self.open(pane),
                Wish::Window(pane) | Wish::Tab(pane) => self.toggle_window(pane),
                Wish::Beside(pane) => self.toggle_beside(pane),
            }
        }
        self.settle();
    }

    /// Where the focus is, if it was elsewhere in the last frame.
    fn focus_moved_to(&mut self, ctx: &egui::Context) -> Option<egui::Rect> {
        let focused = ctx.memory(|memory| memory.focused());
        let before = std::mem::replace(&mut self.focused, focused);
        let id = focused.filter(|_| before != focused)?;
        ctx.read_response(id).map(|response| response.rect)
    }

    /// The active pane is always one that can be seen.
    fn settle(&mut self) {
        let tiles = self.tree.active_tiles();
        let seen: Vec<Pane> = tiles.iter().filter_map(|tile| self.tree.tiles.get_pane(tile)).copied().collect();
        if !seen.contains(&self.active) && !self.windows.contains(&self.active) {
            self.active = seen.first().or(self.windows.first()).copied().unwrap_or(Pane::Dashboard);
        }
    }

    fn show_windows(
        &mut self,
        ctx: &egui::Context,
        pass: &mut Pass<'_>,
        dialogs: &mut Dialogs,
        wishes: &mut Vec<Wish>,
    ) {
        if let Some(window) = self.to_front.take() {
            ctx.send_viewport_cmd_to(window, ViewportCommand::Focus);
        }
        let Self { windows, views, active, in_front, .. } = self;
        let before = in_front.take();
        for pane in windows.iter().copied() {
            let name = title(pass.bench, pane);
            let builder = ViewportBuilder::default()
                .with_title(format!("{name} – {NAME}"))
                .with_app_id(NAME)
                .with_inner_size(theme::WINDOW_OWN)
                .with_min_inner_size(theme::WINDOW_LEAST);
            ctx.show_viewport_immediate(viewport_id(pane), builder, |ui, class| {
                let pressed = ui.rect_contains_pointer(ui.max_rect()) && ui.input(|input| input.pointer.any_pressed());
                let own = class != ViewportClass::EmbeddedWindow;
                if own && ui.input(|input| input.viewport().focused == Some(true)) {
                    *in_front = Some(pane);
                }
                if pressed || (*in_front == Some(pane) && before != Some(pane)) {
                    *active = pane;
                }
                if own {
                    commands::take_typed(ui.ctx(), pass.commands);
                }
                let closed = own && ui.input(|input| input.viewport().close_requested());
                if back_button(ui, &name) || closed {
                    wishes.push(Wish::Tab(pane));
                }
                let frame = theme::ground_frame(theme::palette(ui));
                CentralPanel::default().frame(frame).show(ui, |ui| views.show(ui, pane, pass, dialogs, wishes));
            });
        }
    }
}

/// The row above the contents of a window of its own.
fn back_button(ui: &mut Ui, name: &str) -> bool {
    let frame = theme::bar_frame(theme::palette(ui));
    let row = Panel::top("window row").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            widgets::quiet(ui, name);
            let button = |ui: &mut Ui| ui.button("Back as a tab").clicked();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), button).inner
        })
    });
    row.inner.inner
}

/// In the middle of the window while every pane has a window of its own.
fn elsewhere(ui: &mut Ui, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    theme::ground_frame(palette).show(ui, |ui| {
        let lines = ["Close their windows to bring them back as tabs."];
        widgets::empty_state(ui, palette, "All tabs are in windows of their own", &lines);
        if ui.button("Bring the dashboard back").clicked() {
            wishes.push(Wish::Tab(Pane::Dashboard));
        }
    });
}

fn viewport_id(pane: Pane) -> ViewportId {
    ViewportId::from_hash_of(pane_key(pane))
}

fn pane_key(pane: Pane) -> String {
    format!("{pane:?}")
}

/// What stands on the tab.
pub(super) fn title(bench: &Bench, pane: Pane) -> String {
    match pane {
        Pane::Dashboard => "Dashboard".to_owned(),
        Pane::Traffic => "Traffic".to_owned(),
        Pane::Trends => "Trends".to_owned(),
        Pane::Diagnosis => "Diagnosis".to_owned(),
        Pane::Help => "Help".to_owned(),
        Pane::Recording(id) => {
            let name = bench.opened_recording(id).and_then(|viewer| viewer.path().file_stem());
            name.map_or_else(|| "Recording".to_owned(), |name| name.to_string_lossy().into_owned())
        }
        Pane::Module(target) => {
            let label = bench.module(&target).map_or("Module", |module| module.label());
            format!("{label} @{}", target.address)
        }
    }
}

impl Views {
    pub fn show(
        &mut self,
        ui: &mut Ui,
        pane: Pane,
        pass: &mut Pass<'_>,
        dialogs: &mut Dialogs,
        wishes: &mut Vec<Wish>,
    ) {
        match pane {
            Pane::Dashboard => self.dashboard.show(ui, pass),
            Pane::Traffic => self.traffic.show(ui, pass),
            Pane::Trends => self.trends.show(ui, &Source::live(pass.bench), pass),
            Pane::Diagnosis => self.diagnosis.show(ui, pass),
            Pane::Help => self.help.show(ui, pass, wishes),
            Pane::Recording(id) => match Source::recording(pass.bench, id) {
                Ok(source) => self.recordings.entry(id).or_default().show(ui, &source, pass),
                Err(lines) => trends::not_there(ui, &lines),
            },
            Pane::Module(target) => match pass.bench.module(&target) {
                Some(module) => self.modules.entry(target).or_default().show(ui, module, pass, dialogs),
                None => absent(ui, target, pass, wishes),
            },
        }
    }
}

/// A module that was open when the program was used last, and is not found yet.
fn absent(ui: &mut Ui, target: Target, pass: &mut Pass<'_>, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    let place = format!("Address {}, {}", words::address(target.address), words::spoken(&target));
    let lines = [place.as_str(), "It shows here as soon as it is found: by a scan, or by asking there."];
    widgets::empty_state(ui, palette, "Not found on this line yet", &lines);
    ui.horizontal(|ui| {
        let obstacle = pass.bench.line().obstacle();
        let ask = ui.add_enabled(obstacle.is_none(), egui::Button::new("Ask there"));
        if ask.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
            pass.actions.push(Action::LookFor(target));
        }
        if ui.button("Close").clicked() {
            wishes.push(Wish::Close(Pane::Module(target)));
        }
    });
}
