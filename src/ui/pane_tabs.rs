//! How the tabs in the middle of the window look, and what a click on them does.

use eframe::egui::style::ScrollAnimation;
use eframe::egui::{self, Button, Rect, Ui, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, TileId, Tiles, UiResponse};

use super::app::Pass;
use super::commands::Command;
use super::dialogs::Dialogs;
use super::panes::{Pane, Views, Wish, title};
use super::theme;
use super::widgets::{self, Glyph};

/// Draws the tabs for one frame.
pub(super) struct Tabs<'a, 'p> {
    pub pass: &'a mut Pass<'p>,
    pub dialogs: &'a mut Dialogs,
    pub views: &'a mut Views,
    pub active: &'a mut Pane,
    pub wishes: &'a mut Vec<Wish>,
    /// Where the focus went, if it moved: the pane there is worked in from now on.
    pub focus_moved_to: Option<Rect>,
    /// Panes that share their place with no other, and whether others do. While they are drawn, tiles do not know
    /// their parents.
    pub alone: Vec<Pane>,
    pub shared: bool,
    /// Tabs that have come to the front: they are to be seen also where not all have room.
    pub came_to_front: Vec<TileId>,
}

impl Tabs<'_, '_> {
    fn menu(&mut self, ui: &mut Ui, pane: Pane) {
        let (beside, possible) = match self.alone.contains(&pane) {
            true => ("Show among the other tabs", self.alone.len() > 1 || self.shared),
            false => ("Show beside", true),
        };
        if entry(ui, possible, beside, Some(Command::Beside)) {
            self.wishes.push(Wish::Beside(pane));
        }
        if entry(ui, true, "Open in a window of its own", Some(Command::OwnWindow)) {
            self.wishes.push(Wish::Window(pane));
        }
        if pane != Pane::Dashboard && entry(ui, true, "Close", Some(Command::ClosePane)) {
            self.wishes.push(Wish::Close(pane));
        }
    }
}

/// An entry with the keys of the command that does the same for the active tab.
fn entry(ui: &mut Ui, enabled: bool, text: &str, command: Option<Command>) -> bool {
    let keys = command.and_then(Command::shortcut).map(|shortcut| ui.ctx().format_shortcut(&shortcut));
    let response = ui.add_enabled(enabled, Button::new(text).shortcut_text(keys.unwrap_or_default()));
    widgets::describe(&response, egui::Role::Button, text);
    if response.clicked() {
        ui.close();
    }
    response.clicked()
}

impl Behavior<Pane> for Tabs<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let palette = theme::palette(ui);
        let pressed = ui.rect_contains_pointer(ui.max_rect()) && ui.input(|input| input.pointer.any_pressed());
        let focused = self.focus_moved_to.is_some_and(|rect| ui.max_rect().contains(rect.center()));
        if pressed || focused {
            *self.active = *pane;
        }
        theme::ground_frame(palette).show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            ui.set_clip_rect(ui.max_rect().expand(theme::UNIT).intersect(ui.clip_rect()));
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
        if self.came_to_front.contains(&tile) {
            response.scroll_to_me_animation(None, ScrollAnimation::none());
        }
        response.context_menu(|ui| self.menu(ui, pane));
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
                self.wishes.push(Wish::Window(pane));
            }
        }
        // The tabs need the room more: the menu offers these too.
        if ui.available_width() < theme::TABS_AND_BUTTONS {
            return;
        }
        let offered = [
            (Pane::Traffic, "Traffic", "Every frame of the line, explained"),
            (Pane::Trends, "Trends", "Plots of everything that is polled"),
            (Pane::Diagnosis, "Diagnosis", "What is wrong with the line, and what to do about it"),
        ];
        for (pane, name, means) in offered {
            // Its room stays, so that the other does not move under the pointer.
            let open = tiles.find_pane(&pane).is_some();
            if ui.add_visible(!open, egui::Button::new(name)).on_hover_text(means).clicked() {
                self.wishes.push(Wish::Open(pane));
            }
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn cycle_tabs_with_keyboard(&self) -> bool {
        // Commands do, through all panes and wherever the pointer is.
        false
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
