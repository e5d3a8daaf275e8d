//! Panes in windows of their own.

use eframe::egui::{self, CentralPanel, Panel, Ui, ViewportBuilder, ViewportClass, ViewportCommand, ViewportId};

use super::views::title;
use super::{Pane, Panes, Wish};
use crate::ui::app::Pass;
use crate::ui::dialogs::Dialogs;
use crate::ui::{commands, theme, widgets};
use crate::version::NAME;

impl Panes {
    pub(super) fn show_windows(
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
            let button =
                |ui: &mut Ui| ui.button("Back as a tab").on_hover_text("Among the tabs of the main window").clicked();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), button).inner
        })
    });
    row.inner.inner
}

/// In the middle of the window while every pane has a window of its own.
pub fn elsewhere(ui: &mut Ui, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    theme::ground_frame(palette).show(ui, |ui| {
        let lines = ["Close their windows to bring them back as tabs."];
        widgets::empty_state(ui, palette, "All tabs are in windows of their own", &lines);
        if ui.button("Bring the dashboard back").clicked() {
            wishes.push(Wish::Tab(Pane::Dashboard));
        }
    });
}

pub fn viewport_id(pane: Pane) -> ViewportId {
    ViewportId::from_hash_of(pane_key(pane))
}

fn pane_key(pane: Pane) -> String {
    format!("{pane:?}")
}
