//! One plot before it is drawn, on the screen or into a file: its curves, its axes with their scales, its limits, and
//! the lines as parts of its width and height.

use std::collections::BTreeMap;

use super::choice::{Choice, Shown, Side};
use super::curve::Curve;
use super::limits::{self, Limit};
use super::scene::Scene;
use crate::record::Point;
use crate::ui::plot::{Scale, TimeView};

/// Ranges of values that the user has chosen; all others follow the values.
pub type Ranges = BTreeMap<(usize, Side), [f64; 2]>;
/// A line as parts of a plot's width and height, from its left upper corner; all of it lies inside.
pub type Trace = Vec<[f32; 2]>;

pub struct Axis {
    pub side: Side,
    /// Of all its curves.
    pub unit: String,
    pub scale: Scale,
    pub limits: Vec<Limit>,
}

pub struct PlotModel<'a> {
    /// Counted from the top.
    pub index: usize,
    /// Hidden ones too.
    pub curves: Vec<(Curve<'a>, Shown)>,
    pub axes: Vec<Axis>,
}

impl<'a> PlotModel<'a> {
    /// The plot with this number; `height` in points.
    pub fn new(scene: &Scene<'a>, choice: &Choice, index: usize, ranges: &Ranges, height: f32) -> Self {
        let of_plot = scene.curves(choice).filter(|(curve, shown)| curve.is_number() && shown.plot == index);
        let curves: Vec<(Curve<'a>, Shown)> = of_plot.map(|(curve, shown)| (curve, shown.clone())).collect();
        let mut plot = Self { index, curves, axes: Vec::new() };
        let axes = [Side::Left, Side::Right].into_iter().filter_map(|side| plot.make_axis(scene, side, ranges, height));
        plot.axes = axes.collect();
        plot
    }

    fn make_axis(&self, scene: &Scene<'_>, side: Side, ranges: &Ranges, height: f32) -> Option<Axis> {
        let all: Vec<&Curve<'a>> =
            self.curves.iter().filter(|(_, shown)| shown.side == side).map(|(curve, _)| curve).collect();
        let mut units: Vec<&str> = all.iter().map(|curve| curve.info.unit.as_str()).collect();
        units.dedup();
        if all.is_empty() {
            return None;
        }
        let visible: Vec<&Curve<'a>> = self.visible(side).collect();
        let limits = limits::of(scene, visible.iter().copied());
        let scale = match ranges.get(&(self.index, side)) {
            Some(range) => Scale::fixed(*range, height),
            None => {
                let view = &scene.view;
                let extremes = visible.iter().filter_map(|curve| curve.trend.extremes(view.from, view.to));
                let extremes = extremes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
                let least = Scale::least(visible.iter().map(|curve| curve.resolution()).fold(0.0, f64::max));
                Scale::around(extremes.map(|range| limits::taken_into(range, &limits, least)), least, height)
            }
        };
        Some(Axis { side, unit: units.join(", "), scale, limits })
    }

    /// The curves that are drawn at this axis.
    pub fn visible(&self, side: Side) -> impl Iterator<Item = &Curve<'a>> {
        let of = move |shown: &Shown| !shown.hidden && shown.side == side;
        self.curves.iter().filter(move |(_, shown)| of(shown)).map(|(curve, _)| curve)
    }

    pub fn axis(&self, side: Side) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.side == side)
    }

    /// In place of curves, where there is none to be seen.
    pub fn nothing(&self) -> Option<&'static str> {
        let seen = self.axes.iter().any(|axis| !axis.scale.empty && self.visible(axis.side).next().is_some());
        let mut visible = self.curves.iter().filter(|(_, shown)| !shown.hidden).peekable();
        match (seen, visible.peek().is_some()) {
            (true, _) => None,
            (false, false) => Some("Hidden"),
            (false, true) if visible.all(|(curve, _)| curve.trend.is_empty()) => Some("No readings yet"),
            (false, true) => Some("No readings in this time"),
        }
    }
}

/// The lines of a curve, cut at the plot's edges.
pub fn traces(curve: &Curve<'_>, view: &TimeView, scale: &Scale) -> Vec<Trace> {
    let stretches = curve.lines(view);
    let mut all = Vec::with_capacity(stretches.len());
    for stretch in stretches {
        cut(&stretch, view, scale, &mut all);
    }
    all
}

/// A single sample between gaps is a trace of one point.
fn cut(stretch: &[Point], view: &TimeView, scale: &Scale, all: &mut Vec<Trace>) {
    let place = |[at, value]: Point| [view.part(at), 1.0 - scale.part(value)];
    let inside = |[x, y]: [f64; 2]| (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
    let mut trace = Trace::with_capacity(stretch.len());
    let mut before: Option<[f64; 2]> = None;
    for point in stretch {
        let now = place(*point);
        let piece = match before {
            None if inside(now) => Some([now, now]),
            None => None,
            Some(before) if inside(before) && inside(now) => Some([before, now]),
            Some(before) => clipped(before, now),
        };
        if let Some([start, end]) = piece {
            // The line came in from outside.
            if trace.is_empty() && start != end {
                trace.push(narrow(start));
            }
            trace.push(narrow(end));
        }
        if piece.is_none_or(|[_, end]| end != now) && !trace.is_empty() {
            all.push(std::mem::take(&mut trace));
        }
        before = Some(now);
    }
    if !trace.is_empty() {
        all.push(trace);
    }
}

fn narrow([x, y]: [f64; 2]) -> [f32; 2] {
    [x as f32, y as f32]
}

/// The part of a line that lies in the unit square (Liang and Barsky).
fn clipped(a: [f64; 2], b: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (run, room) in [(-dx, a[0]), (dx, 1.0 - a[0]), (-dy, a[1]), (dy, 1.0 - a[1])] {
        if run == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if run < 0.0 {
            enter = enter.max(room / run);
        } else {
            leave = leave.min(room / run);
        }
    }
    let at = |part: f64| if part >= 1.0 { b } else { [a[0] + part * dx, a[1] + part * dy] };
    (enter <= leave).then(|| [at(enter), at(leave)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Rangef;

    fn lines(stretch: &[Point]) -> Vec<Trace> {
        let view = TimeView { from: 0.0, to: 10.0, columns: Rangef::new(0.0, 100.0) };
        let mut all = Vec::new();
        cut(stretch, &view, &Scale::fixed([0.0, 10.0], 100.0), &mut all);
        all
    }

    #[test]
    fn lines_end_at_the_edges_of_the_plot() {
        assert_eq!(lines(&[[-5.0, 5.0], [5.0, 5.0], [15.0, 5.0]]), [[[0.0, 0.5], [0.5, 0.5], [1.0, 0.5]]]);
        assert_eq!(
            lines(&[[0.0, 5.0], [5.0, 15.0], [10.0, 5.0]]),
            [vec![[0.0, 0.5], [0.25, 0.0]], vec![[0.75, 0.0], [1.0, 0.5]]]
        );
        assert_eq!(lines(&[[2.0, 2.0]]), [[[0.2, 0.8]]]);
        assert!(lines(&[[-3.0, 5.0], [-2.0, 5.0]]).is_empty());
        assert!(lines(&[[2.0, 20.0], [4.0, 30.0]]).is_empty());
    }
}
