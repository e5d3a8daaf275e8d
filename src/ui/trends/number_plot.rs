//! One plot of numbers: grid, lines, limits, and its axes at the left and the right.

use eframe::egui::{Align2, Rangef, Rect, Stroke, Ui, pos2, vec2};

use super::choice::Side;
use super::limits;
use super::model::{Axis, PlotModel, traces};
use super::scene::Scene;
use crate::ui::plot::{Scale, line};
use crate::ui::theme;

/// The areas of one plot.
#[derive(Debug, Clone, Copy)]
pub struct Areas {
    pub names: Rect,
    pub left: Rect,
    pub plot: Rect,
    pub right: Rect,
}

impl Areas {
    pub fn axis(&self, side: Side) -> Rect {
        if side == Side::Left { self.left } else { self.right }
    }
}

pub fn show(ui: &Ui, areas: &Areas, model: &PlotModel<'_>, scene: &Scene<'_>, time_ticks: &[(f64, String)]) {
    let palette = theme::palette(ui);
    let rect = areas.plot;
    let painter = ui.painter().with_clip_rect(rect.expand(theme::HAIRLINE).intersect(ui.clip_rect()));
    let grid = Stroke::new(theme::HAIRLINE, palette.grid);
    for (tick, _) in time_ticks {
        painter.vline(scene.view.x(*tick), rect.y_range(), grid);
    }
    if let Some(axis) = model.axes.first() {
        for tick in &axis.scale.ticks {
            painter.hline(rect.x_range(), axis.scale.y(*tick, rect), grid);
        }
    }
    painter.hline(rect.x_range(), rect.bottom(), Stroke::new(theme::HAIRLINE, palette.line));
    if let Some(text) = model.nothing() {
        painter.text(rect.center(), Align2::CENTER_CENTER, text, theme::body(), palette.old);
        return;
    }
    for axis in &model.axes {
        labels(ui, areas.axis(axis.side), axis);
        if axis.scale.empty {
            continue;
        }
        for (curve, shown) in model.curves.iter().filter(|(_, shown)| !shown.hidden && shown.side == axis.side) {
            let colour = curve.colour(shown.colour, palette);
            for trace in traces(curve, &scene.view, &axis.scale) {
                let points: Vec<_> = trace.iter().map(|[x, y]| rect.lerp_inside(vec2(*x, *y))).collect();
                painter.add(line(points, Stroke::new(theme::TRACE, colour)));
            }
            if let Some(value) = scene.pointer.and_then(|at| scene.value(curve, at)) {
                let place = pos2(scene.view.x(value.at), axis.scale.y(value.value, rect));
                painter.circle(place, theme::SAMPLE_MARK, colour, Stroke::new(theme::HAIRLINE, palette.ground));
            }
        }
        limits::show(ui, rect, &axis.limits, &axis.scale, scene, model.index);
    }
}

/// The unit at the top and numbers at the grid's lines; those that would touch the unit or the neighbouring plot are
/// left out.
fn labels(ui: &Ui, rect: Rect, axis: &Axis) {
    let palette = theme::palette(ui);
    let (x, anchor) = match axis.side {
        Side::Left => (rect.right() - theme::UNIT, [Align2::RIGHT_TOP, Align2::RIGHT_CENTER]),
        Side::Right => (rect.left() + theme::UNIT, [Align2::LEFT_TOP, Align2::LEFT_CENTER]),
    };
    let [top, middle] = anchor;
    ui.painter().text(pos2(x, rect.top()), top, &axis.unit, theme::small(), palette.quiet);
    let rows = Rangef::new(rect.top() + theme::LEGEND_ROW, rect.bottom() - theme::UNIT);
    let Scale { ticks, .. } = &axis.scale;
    for tick in ticks {
        let y = axis.scale.y(*tick, rect);
        if rows.contains(y) {
            ui.painter().text(pos2(x, y), middle, axis.scale.label(*tick), theme::small(), palette.quiet);
        }
    }
}
