//! What the pointer and the keys do in the plots' area: they move and zoom time and values, select, and place cursors.

use eframe::egui::{CursorIcon, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2};

use super::area::{Area, Asked};
use super::choice::Side;
use super::layout::{self, Layout};
use super::model::{Axis, PlotModel};
use super::scene::Scene;
use crate::ui::{theme, widgets};

/// Zoom of a scroll by one point.
const ZOOM_PER_POINT: f64 = 0.004;
/// A selection narrower than this many points is a slip of the hand; one lower than this selects a time only.
const LEAST_SELECTION: f32 = 6.0;
pub const LEAST_BOX: f32 = 24.0;

impl Area {
    /// Dragging moves, scrolling zooms, dragging with the right button or in the zoom mode selects; a click places a
    /// cursor.
    pub(super) fn navigate(
        &mut self,
        ui: &Ui,
        response: &Response,
        scene: &Scene<'_>,
        layout: &Layout,
        models: &[PlotModel<'_>],
    ) {
        let view = &scene.view;
        let now = ui.input(|input| input.time);
        if response.dragged_by(PointerButton::Primary) && !self.zoom_box {
            let moved = f64::from(response.drag_delta().x) * view.seconds_per_point();
            if moved != 0.0 {
                self.window.pan(view, -moved, now);
            }
        }
        if let Some(pointer) = response.hover_pos() {
            let (scroll, pinch, values) =
                ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta(), input.modifiers.command));
            let factor = (-f64::from(scroll.y) * ZOOM_PER_POINT).exp() / f64::from(pinch);
            if factor != 1.0 && values {
                self.zoom_values(layout, models, pointer, factor);
            } else if factor != 1.0 {
                self.window.zoom(view, view.seconds(pointer.x), factor, now);
            }
            if scroll.x != 0.0 {
                self.window.pan(view, -f64::from(scroll.x) * view.seconds_per_point(), now);
            }
            // A scroll area around the plots shall not move as well.
            ui.input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
        }
        self.select(response, scene, layout, models);
        if response.clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            self.cursors.click(view.seconds(pointer.x));
        }
        if response.secondary_clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            self.menu_at = view.seconds(pointer.x);
        }
    }

    fn select(&mut self, response: &Response, scene: &Scene<'_>, layout: &Layout, models: &[PlotModel<'_>]) {
        let boxed = self.zoom_box;
        let buttons: &[PointerButton] =
            if boxed { &[PointerButton::Primary, PointerButton::Secondary] } else { &[PointerButton::Secondary] };
        for asked in buttons.iter().copied() {
            let pointer = response.interact_pointer_pos().map(|pointer| layout.timed.clamp(pointer));
            if response.drag_started_by(asked) {
                let pressed = response.ctx.input(|input| input.pointer.press_origin());
                self.selecting = pressed.or(pointer).map(|start| (layout.timed.clamp(start), boxed));
            }
            if response.drag_stopped_by(asked)
                && let (Some((start, boxed)), Some(end)) = (self.selecting.take(), pointer)
                && (start.x - end.x).abs() >= LEAST_SELECTION
            {
                let chosen = Rect::from_two_pos(start, end);
                self.window.show(scene.view.seconds(chosen.left()), scene.view.seconds(chosen.right()));
                if boxed && chosen.height() >= LEAST_BOX {
                    self.show_values(layout, models, chosen);
                }
                self.zoom_box = false;
            }
        }
    }

    /// Zooms the values of the plot in which a box begins.
    fn show_values(&mut self, layout: &Layout, models: &[PlotModel<'_>], chosen: Rect) {
        let plot = layout.plots.iter().zip(models).find(|(areas, _)| areas.plot.contains(chosen.left_top()));
        let Some((areas, model)) = plot else { return };
        for axis in model.axes.iter().filter(|axis| !axis.scale.empty) {
            let rows = chosen.y_range();
            let value = |y: f32| axis.scale.value(areas.plot.y_range().clamp(y), areas.plot);
            self.set_range(model.index, axis.side, [value(rows.max), value(rows.min)]);
        }
    }

    fn zoom_values(&mut self, layout: &Layout, models: &[PlotModel<'_>], pointer: Pos2, factor: f64) {
        for (areas, model) in layout.plots.iter().zip(models) {
            let is_here = |axis: &&Axis| areas.plot.contains(pointer) || areas.axis(axis.side).contains(pointer);
            for axis in model.axes.iter().filter(is_here).filter(|axis| !axis.scale.empty) {
                let fixed = axis.scale.value(pointer.y, areas.plot);
                let [low, high] = [*axis.scale.values.start(), *axis.scale.values.end()];
                self.set_range(model.index, axis.side, [low, high].map(|end| fixed + (end - fixed) * factor));
            }
        }
    }

    fn set_range(&mut self, plot: usize, side: Side, [low, high]: [f64; 2]) {
        if (high - low).is_finite() && (1e-9..1e15).contains(&(high - low)) {
            self.ranges.insert((plot, side), [low, high]);
        }
    }

    /// The axes of values: the wheel zooms, dragging moves, a double click makes them follow the values again.
    pub(super) fn axes(&mut self, ui: &Ui, layout: &Layout, models: &[PlotModel<'_>]) {
        for (areas, model) in layout.plots.iter().zip(models) {
            for axis in &model.axes {
                let rect = areas.axis(axis.side);
                let id = ui.scope_id().with(("axis", model.index, axis.side == Side::Left));
                let response = ui.interact(rect, id, Sense::click_and_drag());
                let [low, high] = [*axis.scale.values.start(), *axis.scale.values.end()];
                let name = format!("Axis {}", axis.unit);
                widgets::tell(&response, Role::Slider, &name, &format!("{low:.2} to {high:.2}"));
                if let Some(pointer) = response.hover_pos() {
                    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
                    let factor = (-f64::from(scroll) * ZOOM_PER_POINT).exp() / f64::from(pinch);
                    if factor != 1.0 {
                        self.zoom_values(layout, models, pointer, factor);
                        ui.input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
                    }
                }
                let dragged = f64::from(response.drag_delta().y);
                if response.dragged() && dragged != 0.0 && !axis.scale.empty {
                    let by = dragged * (high - low) / f64::from(rect.height().max(1.0));
                    self.set_range(model.index, axis.side, [low + by, high + by]);
                }
                if response.double_clicked() {
                    self.ranges.remove(&(model.index, axis.side));
                }
                let own = self.ranges.contains_key(&(model.index, axis.side));
                let text = if own { "Double click: follow the values again" } else { "Wheel zooms, dragging moves" };
                response.on_hover_cursor(CursorIcon::ResizeVertical).on_hover_text(text);
            }
        }
    }

    pub(super) fn borders(&mut self, ui: &Ui, layout: &Layout) {
        for (index, rect) in layout.borders.iter().enumerate() {
            let response = ui.interact(*rect, ui.scope_id().with(("border", index)), Sense::click_and_drag());
            widgets::describe(&response, Role::Splitter, &format!("Border {} of the plots", index + 1));
            let response = response.on_hover_cursor(CursorIcon::ResizeVertical);
            if response.hovered() || response.dragged() {
                let stroke = Stroke::new(theme::HAIRLINE, theme::palette(ui).accent);
                ui.painter().hline(rect.x_range(), rect.center().y, stroke);
            }
            if response.dragged() && response.drag_delta().y != 0.0 {
                layout::move_border(&mut self.weights, &layout.plots, index, response.drag_delta().y);
            }
            if response.double_clicked() {
                self.weights.iter_mut().for_each(|weight| *weight = 1.0);
            }
        }
    }

    /// Keys that are heard while the pointer is on the plots: A and B, M for a note, Backspace and Escape.
    pub(super) fn keys(&mut self, ui: &Ui, response: &Response, scene: &Scene<'_>) -> Option<Asked> {
        let at = scene.pointer.filter(|_| !ui.ctx().text_edit_focused())?;
        let pressed = |key: Key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        for (which, key) in [Key::A, Key::B].into_iter().enumerate() {
            if pressed(key) {
                self.cursors.set(which, at);
            }
        }
        if pressed(Key::Backspace) {
            self.window.back();
        }
        if pressed(Key::Escape) {
            self.cursors.clear();
            self.zoom_box = false;
        }
        let place = response.hover_pos().filter(|_| pressed(Key::M) && scene.bench.is_some())?;
        Some(Asked::Note(at, place))
    }
}
