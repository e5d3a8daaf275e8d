//! The measured values in large digits, a temperature also in the other unit, and the latched extremes beneath.

use eframe::egui::{Align, Layout, Rect, Role, Sense, Ui, UiBuilder, Vec2, pos2, vec2};

use super::super::readings;
use super::super::series::{Freshness, Series};
use super::latches::{self, Extreme};
use crate::bench::Module;
use crate::ui::app::Pass;
use crate::ui::theme;
use crate::ui::widgets;

/// `twins` are the same readings in the other temperature unit.
pub fn show(ui: &mut Ui, module: &Module, numbers: &[&Series<'_>], twins: &[Series<'_>], pass: &mut Pass<'_>) {
    let [least, most] = theme::CHANNEL_WIDTHS;
    let columns = (ui.available_width() / least).floor().clamp(1.0, numbers.len().max(1) as f32);
    let latched = |one: &&Series<'_>| Extreme::ALL.iter().any(|extreme| extreme.item(module, &one.item.id).is_some());
    let latches = if numbers.iter().any(latched) { theme::CONTROL_HEIGHT } else { 0.0 };
    let size = vec2(
        (ui.available_width() / columns).floor().min(most),
        readings::DIGITS_HEIGHT + theme::LEGEND_ROW + latches + theme::UNIT,
    );
    readings::cells(ui, |ui| {
        for series in numbers {
            let twin = twins.iter().find(|twin| twin.stem == series.stem && twin.item.id != series.item.id);
            cell(ui, size, module, series, twin, pass);
        }
    });
}

fn cell(ui: &mut Ui, size: Vec2, module: &Module, series: &Series<'_>, twin: Option<&Series<'_>>, pass: &mut Pass<'_>) {
    let now = pass.bench.now();
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let freshness = series.freshness(module, now);
    let (upper, beneath) = rect.split_top_bottom_at_y(rect.top() + readings::DIGITS_HEIGHT + theme::LEGEND_ROW);
    let room = readings::digits(ui, upper, series, &freshness);
    readings::name_line(ui, upper.with_min_y(upper.top() + readings::DIGITS_HEIGHT), series, &freshness);
    let response = ui.interact(upper, ui.scope_id().with((series.stem, "digits")), Sense::hover());
    readings::tell(response, module, series, &freshness);
    if let Some(twin) = twin {
        in_other_unit(ui, room.with_min_x(room.left() + theme::CHANNEL_UNIT), twin, twin.freshness(module, now));
    }
    let row = readings::beside_mark(beneath.with_max_y(beneath.top() + theme::CONTROL_HEIGHT));
    let layout = Layout::left_to_right(Align::Center);
    let mut ui = ui.new_child(UiBuilder::new().max_rect(row).layout(layout).id_salt(series.stem));
    latches::row(&mut ui, module, series, twin, pass);
}

fn in_other_unit(ui: &Ui, room: Rect, twin: &Series<'_>, freshness: Freshness) {
    let palette = theme::palette(ui);
    let colour = if freshness == Freshness::Fresh { palette.quiet } else { palette.old };
    let text = format!("{} {}", readings::value_text(twin), twin.unit);
    let place = widgets::line_in(ui, room, Align::Min, &text, theme::heading(), colour);
    let place = Rect::from_min_max(place.min, pos2(room.right(), place.bottom()));
    let response = ui.interact(place, ui.scope_id().with((twin.stem, "other unit")), Sense::hover());
    widgets::describe(&response, Role::Label, &format!("{} in {}: {text}", twin.label, twin.unit));
    response.on_hover_text(&twin.item.help);
}
