//! The tabs in the middle of the window: the dashboard, modules and the traffic, side by side or in windows of their
//! own.

mod views;
mod windows;

use std::collections::HashSet;

use eframe::egui::{self, Id, Ui, Vec2, ViewportId};
use egui_tiles::{ContainerKind, Tile, TileId, Tree};
use serde::{Deserialize, Serialize};

pub(super) use views::{Views, title};

use super::app::Pass;
use super::dialogs::Dialogs;
use super::help;
use super::pane_tabs::Tabs;
use crate::bench::RecordingId;
use crate::bus::Target;
use windows::{elsewhere, viewport_id};

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

/// Scrolling a bar of tabs shows or hides the arrows at its ends, which changes the room once more.
const SETTLES_IN: u8 = 4;

/// Where the panes are, as it is kept between starts.
#[derive(Serialize, Deserialize)]
struct Layout {
    tree: Tree<Pane>,
    windows: Vec<Pane>,
    #[serde(default)]
    active: Option<Pane>,
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
    /// The tabs in front in the last frame, and how large the window was.
    shown: (Vec<TileId>, Vec2),
    /// Frames until the bars of tabs have settled after that changed.
    settling: u8,
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
            shown: Default::default(),
            settling: 0,
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
        let came_to_front = self.came_to_front(ui.ctx());
        let Self { tree, views, active, .. } = self;
        let mut tabs =
            Tabs { pass, dialogs, views, active, wishes: &mut wishes, focus_moved_to, alone, shared, came_to_front };
        tree.ui(&mut tabs, ui);
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

    /// The tabs in front, while they may not be in view: others are, or the window has another size.
    fn came_to_front(&mut self, ctx: &egui::Context) -> Vec<TileId> {
        let now = (self.tree.active_tiles(), ctx.content_rect().size());
        if self.shown != now {
            self.settling = SETTLES_IN;
            self.shown.clone_from(&now);
        }
        if self.settling == 0 {
            return Vec::new();
        }
        self.settling = self.settling.saturating_sub(1);
        ctx.request_repaint();
        now.0
    }

    /// The active pane is always one that can be seen.
    fn settle(&mut self) {
        let tiles = self.tree.active_tiles();
        let seen: Vec<Pane> = tiles.iter().filter_map(|tile| self.tree.tiles.get_pane(tile)).copied().collect();
        if !seen.contains(&self.active) && !self.windows.contains(&self.active) {
            self.active = seen.first().or(self.windows.first()).copied().unwrap_or(Pane::Dashboard);
        }
    }
}
