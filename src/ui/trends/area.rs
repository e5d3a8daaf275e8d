//! The plots' area: stacked plots and strips on one axis of time. `pointer` is what pointer and keys do there.

use eframe::egui::{Align2, Pos2, Rangef, Rect, Response, Role, ScrollArea, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use super::axis;
use super::choice::{Choice, Move, Shown, Side};
use super::cursors::Cursors;
use super::curve::Curve;
use super::layout::{self, Layout, Wanted};
use super::legend::{self, Wish};
use super::markers::Markers;
use super::model::{PlotModel, Ranges};
use super::number_plot;
use super::pointer::LEAST_BOX;
use super::scene::Scene;
use super::strip;
use super::window::Window;
use crate::ui::{theme, widgets};

/// What the area remembers between frames.
#[derive(Default)]
pub struct Area {
    pub window: Window,
    pub choice: Choice,
    pub cursors: Cursors,
    /// Dragging selects a box to be zoomed to, and does not move the view.
    pub zoom_box: bool,
    pub ranges: Ranges,
    markers: Markers,
    /// The shares of the plots.
    pub weights: Vec<f32>,
    /// Where a selection began, and whether it may select values too.
    pub selecting: Option<(Pos2, bool)>,
    /// The time at which the menu was opened.
    pub menu_at: f64,
    /// The time at the pointer in the last frame.
    pub pointer: Option<f64>,
    /// A picture is taken, in which the pointer is not to be seen.
    pub posing: bool,
    /// Where everything was drawn last.
    pub rect: Option<Rect>,
}

/// What is asked for in the area and carried out elsewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Asked {
    /// A note about this time, to be written beside this place.
    Note(f64, Pos2),
    /// An event was clicked; cursor A is there now.
    Event,
}

impl Area {
    /// Draws everything into what room there is. `known` is the first and last time of all that can be seen.
    pub fn show(&mut self, ui: &mut Ui, scene: Scene<'_>, known: [f64; 2]) -> Option<Asked> {
        let plots = self.choice.plots(scene.history);
        self.weights.resize(plots, 1.0);
        let strips: Vec<(Curve<'_>, Shown)> = scene
            .curves(&self.choice)
            .filter(|(curve, _)| !curve.is_number())
            .map(|(curve, shown)| (curve, shown.clone()))
            .collect();
        let is_right = |(curve, shown): &(Curve<'_>, &Shown)| curve.is_number() && shown.side == Side::Right;
        let right_axis = scene.curves(&self.choice).any(|one| is_right(&one));
        let weights = self.weights.clone();
        let wanted = Wanted { weights: &weights, strips: strips.len(), right_axis };
        let room = ui.available_size();
        let size = vec2(room.x, room.y.max(layout::least_height(&wanted)));
        ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| {
                let (all, _) = ui.allocate_exact_size(size, Sense::hover());
                let layout = layout::layout(all, &wanted);
                self.rect = Some(all.intersect(ui.clip_rect()));
                self.draw(ui, scene, known, &layout, &strips)
            })
            .inner
    }

    fn draw(
        &mut self,
        ui: &mut Ui,
        mut scene: Scene<'_>,
        known: [f64; 2],
        layout: &Layout,
        strips: &[(Curve<'_>, Shown)],
    ) -> Option<Asked> {
        let response = ui.interact(layout.timed, ui.scope_id().with("time"), Sense::click_and_drag());
        scene.view = self.window.view(known, layout.timed.x_range());
        let models = self.models(&scene, layout);
        self.navigate(ui, &response, &scene, layout, &models);
        self.axes(ui, layout, &models);
        scene.view = self.window.view(known, layout.timed.x_range());
        scene.pointer = response.hover_pos().filter(|_| !self.posing).map(|pointer| scene.view.seconds(pointer.x));
        self.pointer = scene.pointer;
        let mut asked = self.keys(ui, &response, &scene);

        let words = axis::words(&scene.view, scene.zone);
        let models = self.models(&scene, layout);
        let mut wish = None;
        for (model, areas) in models.iter().zip(&layout.plots) {
            number_plot::show(ui, areas, model, &scene, &words.times);
            wish = names(ui, areas.names, model, models.len(), &scene).or(wish);
        }
        self.borders(ui, layout);
        wish = show_strips(ui, layout, strips, &scene, &words.times).or(wish);
        axis::show(ui, layout.axis, &scene.view, &words);
        if let Some(at) = self.markers.show(ui, layout.events, layout.timed, &scene) {
            self.cursors.set(0, at);
            asked = Some(Asked::Event);
        }
        let rows = Rangef::new(layout.timed.top(), layout.events.top());
        self.cursors.show(ui, layout.timed, rows, &scene);
        self.draw_selection(ui, &response, layout);
        if let Some(at) = scene.pointer {
            pointer_line(ui, layout, &scene, at);
        }
        widgets::describe(&response, Role::Canvas, "Plots");
        asked = self.menu(&response, &scene).or(asked);
        if let Some(wish) = wish {
            self.grant(wish, &scene, layout);
        }
        asked
    }

    fn models<'a>(&self, scene: &Scene<'a>, layout: &Layout) -> Vec<PlotModel<'a>> {
        let heights = layout.plots.iter().map(|areas| areas.plot.height()).enumerate();
        heights.map(|(index, height)| PlotModel::new(scene, &self.choice, index, &self.ranges, height)).collect()
    }

    fn menu(&mut self, response: &Response, scene: &Scene<'_>) -> Option<Asked> {
        let at = self.menu_at;
        let mut asked = None;
        response.context_menu(|ui| {
            let entry = |ui: &mut Ui, enabled: bool, text: &str| {
                let clicked = ui.add_enabled(enabled, eframe::egui::Button::new(text)).clicked();
                if clicked {
                    ui.close();
                }
                clicked
            };
            if scene.bench.is_some() && entry(ui, true, "Add a note here…") {
                asked = Some(Asked::Note(at, ui.max_rect().left_top()));
            }
            if entry(ui, true, "Cursor A here") {
                self.cursors.set(0, at);
            }
            if entry(ui, true, "Cursor B here") {
                self.cursors.set(1, at);
            }
            if entry(ui, self.cursors.any(), "Clear cursors") {
                self.cursors.clear();
            }
            let span = self.cursors.span().filter(|[from, to]| to > from);
            if entry(ui, span.is_some(), "Zoom to the cursors")
                && let Some([from, to]) = span
            {
                self.window.show(from, to);
            }
            if entry(ui, !self.ranges.is_empty(), "All axes follow the values") {
                self.ranges.clear();
            }
        });
        asked
    }

    fn draw_selection(&self, ui: &Ui, response: &Response, layout: &Layout) {
        let Some(((start, boxed), pointer)) = self.selecting.zip(response.interact_pointer_pos()) else { return };
        let palette = theme::palette(ui);
        let chosen = Rect::from_two_pos(start, layout.timed.clamp(pointer));
        let whole = !boxed || chosen.height() < LEAST_BOX;
        let rows = if whole { layout.timed.y_range() } else { chosen.y_range() };
        let fill = palette.accent.gamma_multiply(theme::SELECTION_FILL);
        let stroke = Stroke::new(theme::HAIRLINE, palette.accent);
        let rect = Rect::from_x_y_ranges(chosen.x_range(), rows);
        ui.painter().rect(rect, 0.0, fill, stroke, StrokeKind::Inside);
    }

    fn grant(&mut self, wish: Wish, scene: &Scene<'_>, layout: &Layout) {
        match wish {
            Wish::Hide(id) => {
                if let Some(shown) = self.choice.get_mut(id) {
                    shown.hidden = !shown.hidden;
                }
            }
            Wish::Remove(id) => self.choice.toggle(scene.history, id),
            Wish::Move(id, to) => self.choice.apply(scene.history, id, to),
            Wish::Dropped(id, y) => {
                let plots = layout.plots.iter().map(|areas| areas.plot.y_range());
                let y = y as f32;
                let onto = plots.enumerate().find(|(_, rows)| rows.contains(y)).map(|(index, _)| index);
                let lowest = layout.plots.last().map_or(0.0, |areas| areas.plot.bottom());
                match onto {
                    Some(plot) => self.choice.apply(scene.history, id, Move::ToPlot(plot)),
                    None if y > lowest => self.choice.apply(scene.history, id, Move::NewPlot),
                    None => {}
                }
            }
        }
    }
}

fn names(ui: &mut Ui, rect: Rect, model: &PlotModel<'_>, plots: usize, scene: &Scene<'_>) -> Option<Wish> {
    let mut wish = None;
    for (row, (curve, shown)) in layout::name_rows(rect, model.curves.len()).zip(&model.curves) {
        wish = legend::entry(ui, row, (curve, shown), plots, scene).or(wish);
    }
    wish
}

fn show_strips(
    ui: &mut Ui,
    layout: &Layout,
    strips: &[(Curve<'_>, Shown)],
    scene: &Scene<'_>,
    ticks: &[(f64, String)],
) -> Option<Wish> {
    let palette = theme::palette(ui);
    let mut wish = None;
    if let (Some((_, first)), Some((_, last))) = (layout.strips.first(), layout.strips.last()) {
        for (tick, _) in ticks {
            let rows = Rangef::new(first.top(), last.bottom());
            ui.painter().vline(scene.view.x(*tick), rows, Stroke::new(theme::HAIRLINE, palette.grid));
        }
    }
    for ((name, trace), (curve, shown)) in layout.strips.iter().zip(strips) {
        wish = legend::entry(ui, *name, (curve, shown), 0, scene).or(wish);
        if !shown.hidden {
            strip::show(ui, *trace, curve, curve.colour(shown.colour, palette), scene);
        }
    }
    wish
}

/// A line at the pointer's time, with the time at its foot.
fn pointer_line(ui: &Ui, layout: &Layout, scene: &Scene<'_>, at: f64) {
    let palette = theme::palette(ui);
    let x = scene.view.x(at);
    let rows = Rangef::new(layout.timed.top(), layout.events.top());
    ui.painter().vline(x, rows, Stroke::new(theme::HAIRLINE, palette.quiet));
    let galley = widgets::cut(ui, &scene.clock(at), theme::small(), palette.text, f32::INFINITY);
    let (upper, _) = layout.axis.split_top_bottom_at_fraction(0.5);
    let room = Rect::from_center_size(pos2(x, upper.center().y), vec2(galley.size().x, upper.height()));
    let place = Align2::CENTER_BOTTOM.align_size_within_rect(galley.size(), room);
    let shift = (layout.axis.left() - place.left()).max(0.0) - (place.right() - layout.axis.right()).max(0.0);
    let place = place.translate(vec2(shift, 0.0));
    ui.painter().rect_filled(place.expand2(vec2(theme::UNIT, 0.0)), 0.0, palette.raised);
    ui.painter().galley(place.min, galley, palette.text);
}
