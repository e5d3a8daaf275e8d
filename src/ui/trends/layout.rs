//! Where everything of the plots' area is: rows from top to bottom, columns from left to right.

use eframe::egui::{Rangef, Rect, vec2};

use super::number_plot::Areas;
use crate::ui::theme;

#[derive(Debug)]
pub struct Layout {
    pub plots: Vec<Areas>,
    /// Beneath each plot but the last.
    pub borders: Vec<Rect>,
    /// Name and trace.
    pub strips: Vec<(Rect, Rect)>,
    pub events: Rect,
    pub axis: Rect,
    /// All of it that has a time, without the axis.
    pub timed: Rect,
}

/// What is to be laid out.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The share of each plot.
    pub weights: &'a [f32],
    pub strips: usize,
    pub right_axis: bool,
}

/// The height below which the plots cannot be read.
pub fn least_height(wanted: &Wanted<'_>) -> f32 {
    let plots = wanted.weights.len() as f32 * (theme::PLOT_LEAST + theme::TREND_BORDER);
    fixed_height() + plots + wanted.strips as f32 * theme::STRIP_LEAST
}

fn fixed_height() -> f32 {
    theme::CURSOR_HANDLE[1] + theme::TREND_EVENTS + theme::TREND_AXIS
}

pub fn layout(all: Rect, wanted: &Wanted<'_>) -> Layout {
    let [least, most] = theme::TREND_NAMES;
    let names =
        Rangef::new(all.left(), all.left() + (all.width() * theme::TREND_NAMES_PART).clamp(least, most).floor());
    let left = Rangef::new(names.max, names.max + theme::Y_LABELS);
    let right_width = if wanted.right_axis { theme::Y_LABELS } else { theme::UNIT };
    let right = Rangef::new(all.right() - right_width, all.right());
    let columns = Rangef::new(left.max, right.min.max(left.max + theme::PLOT_LEAST));

    let count = wanted.weights.len();
    let borders = count as f32 * theme::TREND_BORDER;
    let for_strips = all.height() - fixed_height() - borders - count as f32 * theme::PLOT_LEAST;
    let strip = (for_strips / wanted.strips.max(1) as f32).clamp(theme::STRIP_LEAST, theme::STRIP).floor();
    let for_plots = all.height() - fixed_height() - borders - wanted.strips as f32 * strip;
    let heights = shares(wanted.weights, for_plots.max(count as f32 * theme::PLOT_LEAST));

    let mut top = all.top() + theme::CURSOR_HANDLE[1];
    let mut row = |height: f32| {
        let rows = Rangef::new(top, top + height);
        top += height;
        rows
    };
    let mut plots = Vec::with_capacity(count);
    let mut between = Vec::with_capacity(count);
    for height in heights {
        let rows = row(height);
        let of = |columns: Rangef| Rect::from_x_y_ranges(columns, rows);
        plots.push(Areas { names: of(names), left: of(left), plot: of(columns), right: of(right) });
        between.push(Rect::from_x_y_ranges(names.min..=right.max, row(theme::TREND_BORDER)));
    }
    between.truncate(count.saturating_sub(1));
    let strips = (0..wanted.strips).map(|_| row(strip));
    let named = Rangef::new(names.min, left.max - theme::UNIT);
    let strips =
        strips.map(|rows| (Rect::from_x_y_ranges(named, rows), Rect::from_x_y_ranges(columns, rows))).collect();
    let events = Rect::from_x_y_ranges(columns, row(theme::TREND_EVENTS));
    let axis = Rect::from_x_y_ranges(columns, row(theme::TREND_AXIS));
    let timed = Rect::from_x_y_ranges(columns, all.top()..=axis.top());
    Layout { plots, borders: between, strips, events, axis, timed }
}

/// Whole points for each plot, none below what can be read.
fn shares(weights: &[f32], room: f32) -> Vec<f32> {
    let sum: f32 = weights.iter().sum();
    let spare = room - weights.len() as f32 * theme::PLOT_LEAST;
    weights.iter().map(|weight| (theme::PLOT_LEAST + spare * weight / sum.max(f32::EPSILON)).floor()).collect()
}

/// Makes the plot above the border so much higher and the one below so much lower, as far as both can be read.
pub fn move_border(weights: &mut [f32], plots: &[Areas], border: usize, by: f32) {
    let heights: Vec<f32> = plots.iter().map(|areas| areas.plot.height()).collect();
    let next = border.saturating_add(1);
    let (Some(upper), Some(lower)) = (heights.get(border), heights.get(next)) else { return };
    let by = by.clamp(theme::PLOT_LEAST - upper, lower - theme::PLOT_LEAST);
    for (index, (weight, height)) in weights.iter_mut().zip(&heights).enumerate() {
        let change = if index == border {
            by
        } else if index == next {
            -by
        } else {
            0.0
        };
        *weight = (height + change - theme::PLOT_LEAST).max(theme::HAIRLINE);
    }
}

/// The rows of names beside a plot, as many as there is room for, at the usual distance or closer.
pub fn name_rows(names: Rect, count: usize) -> impl Iterator<Item = Rect> {
    let height = (names.height() / count.max(1) as f32).clamp(theme::STRIP_LEAST, theme::LEGEND_ROW);
    let most = (names.height() / height).floor() as usize;
    let row = move |index: usize| {
        Rect::from_min_size(names.min + vec2(0.0, index as f32 * height), vec2(names.width(), height))
    };
    (0..count.min(most)).map(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    const ALL: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(800.0, 500.0) };

    #[test]
    fn rows_follow_each_other_and_fill_the_room() {
        let wanted = Wanted { weights: &[1.0, 1.0], strips: 4, right_axis: true };
        let layout = layout(ALL, &wanted);
        let [first, second] = layout.plots.as_slice() else { panic!("{layout:?}") };
        assert_eq!(first.plot.height(), second.plot.height());
        assert!(second.plot.top() >= first.plot.bottom() && layout.strips[0].0.top() >= second.plot.bottom());
        assert!(layout.axis.bottom() <= ALL.bottom() && layout.axis.bottom() > ALL.bottom() - 4.0);
        assert_eq!(first.right.right(), ALL.right());
    }

    #[test]
    fn a_border_moves_what_it_parts_and_leaves_both_readable() {
        let mut weights = [1.0, 1.0, 1.0];
        fn wanted(weights: &[f32]) -> Layout {
            layout(ALL, &Wanted { weights, strips: 0, right_axis: false })
        }
        let before: Vec<f32> = wanted(&weights).plots.iter().map(|areas| areas.plot.height()).collect();
        let plots = wanted(&weights).plots;
        move_border(&mut weights, &plots, 0, 30.0);
        let after: Vec<f32> = wanted(&weights).plots.iter().map(|areas| areas.plot.height()).collect();
        let near = |a: f32, b: f32| (a - b).abs() <= 2.0;
        assert!(near(after[0], before[0] + 30.0) && near(after[1], before[1] - 30.0) && near(after[2], before[2]));
        let plots = wanted(&weights).plots;
        move_border(&mut weights, &plots, 0, -1e6);
        assert!(wanted(&weights).plots.iter().all(|areas| areas.plot.height() >= theme::PLOT_LEAST));
    }
}
