//! Two times that are held, A and B, to be compared.

use eframe::egui::{Align2, CursorIcon, Rangef, Rect, Role, Sense, Stroke, Ui, pos2, vec2};

use super::scene::Scene;
use crate::ui::theme;
use crate::ui::widgets;

pub const NAMES: [&str; 2] = ["A", "B"];

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cursors {
    /// Seconds since 1970 UTC.
    pub at: [Option<f64>; 2],
}

impl Cursors {
    pub fn set(&mut self, which: usize, at: f64) {
        if let Some(place) = self.at.get_mut(which) {
            *place = Some(at);
        }
    }

    /// The first click places A, the second B; each further one moves the nearer.
    pub fn click(&mut self, at: f64) {
        let nearer_to_b = matches!(self.at, [Some(a), Some(b)] if (b - at).abs() < (a - at).abs());
        let b_is_free = matches!(self.at, [Some(_), None]);
        self.set(usize::from(nearer_to_b || b_is_free), at);
    }

    pub fn clear(&mut self) {
        self.at = [None; 2];
    }

    pub fn any(&self) -> bool {
        self.at.iter().any(Option::is_some)
    }

    /// From the earlier to the later, if both are there.
    pub fn span(&self) -> Option<[f64; 2]> {
        match self.at {
            [Some(a), Some(b)] => Some([a.min(b), a.max(b)]),
            _ => None,
        }
    }

    /// Draws lines over `rows` of `timed` with handles at the top, and lets them be dragged.
    pub fn show(&mut self, ui: &Ui, timed: Rect, rows: Rangef, scene: &Scene<'_>) {
        let palette = theme::palette(ui);
        if let Some([from, to]) = self.span() {
            let columns = Rangef::new(scene.view.x(from).max(timed.left()), scene.view.x(to).min(timed.right()));
            if columns.min < columns.max {
                let fill = palette.accent.gamma_multiply(theme::SELECTION_FILL / 2.0);
                ui.painter().rect_filled(Rect::from_x_y_ranges(columns, rows), 0.0, fill);
            }
        }
        for (place, name) in self.at.iter_mut().zip(NAMES) {
            let Some(at) = *place else { continue };
            let x = scene.view.x(at);
            if !timed.x_range().contains(x) {
                continue;
            }
            let [width, height] = theme::CURSOR_HANDLE;
            let handle = Rect::from_min_size(pos2(x - width / 2.0, rows.min), vec2(width, height));
            let line = handle.with_max_y(rows.max).shrink2(vec2(width / 4.0, 0.0));
            ui.painter().vline(x, rows, Stroke::new(theme::HAIRLINE, palette.accent));
            ui.painter().rect_filled(handle, theme::HAIRLINE, palette.accent);
            ui.painter().text(handle.center(), Align2::CENTER_CENTER, name, theme::small(), palette.ground);
            let response = ui.interact(handle.union(line), ui.scope_id().with(("cursor", name)), Sense::drag());
            widgets::describe(&response, Role::Slider, &format!("Cursor {name}"));
            if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
                *place = Some(scene.view.seconds(timed.x_range().clamp(pointer.x)));
            }
            response.on_hover_cursor(CursorIcon::ResizeHorizontal).on_hover_text(format!(
                "Cursor {name}: {}\nDrag it, or press {name} where it shall be",
                scene.clock(at)
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clicks_place_a_then_b_then_move_the_nearer() {
        let mut cursors = Cursors::default();
        for (at, expected) in [
            (10.0, [Some(10.0), None]),
            (50.0, [Some(10.0), Some(50.0)]),
            (45.0, [Some(10.0), Some(45.0)]),
            (5.0, [Some(5.0), Some(45.0)]),
        ] {
            cursors.click(at);
            assert_eq!(cursors.at, expected);
        }
        cursors.set(0, 60.0);
        assert_eq!(cursors.span(), Some([45.0, 60.0]));
        cursors.clear();
        assert!(!cursors.any());
    }
}
