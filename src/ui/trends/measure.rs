//! The plots alone, without a window around them, so that their cost can be measured.

use eframe::egui::{Rangef, Ui};

use super::area::Area;
use super::scene::Scene;
use crate::record::History;
use crate::ui::plot::Zone;
use crate::ui::settings::TemperatureUnit;
use crate::ui::theme;

/// The plots of a history, with every series in them.
#[derive(Default)]
pub struct Plots {
    area: Area,
    styled: bool,
}

impl Plots {
    /// Draws what lies between two times, in seconds since 1970 UTC.
    pub fn show(&mut self, ui: &mut Ui, history: &History, [from, to]: [f64; 2]) {
        if !std::mem::replace(&mut self.styled, true) {
            theme::apply(ui.ctx());
            self.area.choice.keep_up(history, TemperatureUnit::Celsius, &[]);
            for (id, _) in history.series() {
                if self.area.choice.get(id).is_none() {
                    self.area.choice.toggle(history, id);
                }
            }
        }
        let Some(known) = history.span().map(|span| span.map(crate::record::seconds)) else { return };
        self.area.window.show(from, to);
        let view = self.area.window.view(known, Rangef::new(0.0, ui.available_width()));
        self.area.show(ui, Scene { history, bench: None, view, zone: Zone::Utc, pointer: None }, known);
    }
}
