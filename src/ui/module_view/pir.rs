//! PIR / Relay: the sensor's face, the relays, and what switches them.

mod face;
mod history;
mod relays;
mod settings;

use eframe::egui::{Ui, UiBuilder, pos2, vec2};

use super::readings;
use super::series::{Series, series_of};
use crate::bench::{Module, SwitchKind};
use crate::ui::app::Pass;
use crate::ui::theme;

/// Whose items stand here.
const TAB: &str = "pir";

/// What the tab remembers between frames.
#[derive(Default)]
pub struct PirRelay;

impl PirRelay {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        ui.set_max_width(ui.available_width().min(theme::TAB_WIDTH));
        let all = series_of(pass.bench.history(), module, pass.settings.temperature);
        let series: Vec<Series<'_>> = all.into_iter().filter(|series| series.item.tab == TAB).collect();
        // The face at the left, what it switches at its right; the taller of them rules.
        let top = ui.cursor().min;
        let face = ui.vertical(|ui| face::show(ui, module, pass, &series)).response.rect;
        let left = face.right() + theme::GAP_SECTION;
        let room =
            eframe::egui::Rect::from_min_max(pos2(left, top.y), pos2(top.x + ui.available_width(), f32::INFINITY));
        let mut beside = ui.new_child(UiBuilder::new().max_rect(room));
        self.beside(&mut beside, module, pass, &series);
        let below = beside.min_rect().bottom() - ui.cursor().min.y;
        ui.allocate_space(vec2(0.0, below.max(0.0)));
        history::show(ui, module, &series, pass.bench.now());
        settings::show(ui, module, pass);
    }

    fn beside(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, series: &[Series<'_>]) {
        let (outputs, others): (Vec<&Series<'_>>, Vec<&Series<'_>>) =
            series.iter().partition(|series| is_output(series));
        // The zones stand in the picture.
        let others: Vec<Series<'_>> =
            others.into_iter().filter(|series| face::zone_of(&series.item.id).is_none()).cloned().collect();
        readings::show(ui, module, &others, pass.bench.now());
        ui.add_space(theme::GAP);
        relays::show(ui, module, pass, &outputs);
    }
}

fn is_output(series: &Series<'_>) -> bool {
    !series.is_number() && SwitchKind::of(&series.item.id) == SwitchKind::Output
}
