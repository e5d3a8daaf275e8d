//! The list at the left: all series of all modules, with their colours and last values, to be shown or not.

use eframe::egui::{
    Align, Color32, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind, TextEdit, Ui, WidgetInfo, pos2, vec2,
};

use super::choice::Choice;
use super::curve::Curve;
use crate::bench::{Bench, Module, SwitchKind};
use crate::record::{History, ModuleId, ModuleInfo, SeriesId};
use crate::ui::settings::TemperatureUnit;
use crate::ui::widgets::{self, Glyph};
use crate::ui::{theme, words};

/// A value is old after so many poll intervals, and after so many seconds at least.
const OLD_AFTER: f64 = 3.0;

/// What the list remembers between frames.
#[derive(Default)]
pub struct Chooser {
    /// `None` until it was opened or closed: then it is open where there is room.
    open: Option<bool>,
    search: String,
}

enum Row<'a> {
    Module(ModuleId, &'a ModuleInfo),
    Series(Curve<'a>),
}

impl Chooser {
    pub fn is_open(&self, width: f32) -> bool {
        self.open.unwrap_or(width >= theme::CHOOSER_ROOM)
    }

    pub fn set_open(&mut self, open: bool) {
        self.open = Some(open);
    }

    pub fn show(
        &mut self,
        ui: &mut Ui,
        history: &History,
        bench: Option<&Bench>,
        unit: TemperatureUnit,
        choice: &mut Choice,
    ) {
        let field = TextEdit::singleline(&mut self.search).desired_width(f32::INFINITY).hint_text("Search series");
        let response = ui.add(field);
        widgets::name_field(&response, "Search series", &self.search);
        response.on_hover_text("Shows only series with this in their module or name");
        let curves: Vec<Curve<'_>> = Curve::all(history, unit).collect();
        quick(ui, history, choice, &curves);
        ui.add_space(theme::UNIT);
        let rows = self.rows(history, &curves);
        if rows.is_empty() {
            widgets::quiet(ui, "No series has this in its name.");
        }
        ui.spacing_mut().item_spacing.y = 0.0;
        ScrollArea::vertical().auto_shrink(false).show_rows(ui, theme::LIST_ROW, rows.len(), |ui, range| {
            for row in rows.get(range).unwrap_or_default() {
                match row {
                    Row::Module(id, info) => heading(ui, history, *id, info),
                    Row::Series(curve) => entry(ui, history, bench, choice, curve),
                }
            }
        });
    }

    fn rows<'a>(&self, history: &'a History, curves: &[Curve<'a>]) -> Vec<Row<'a>> {
        let wanted = self.search.trim().to_lowercase();
        let matches = |curve: &&Curve<'a>| {
            wanted.is_empty() || format!("{} {}", curve.module, curve.label()).to_lowercase().contains(&wanted)
        };
        let mut rows = Vec::new();
        for (id, info) in history.modules() {
            let of = curves.iter().filter(|curve| curve.info.module == id).filter(matches);
            let mut of: Vec<Curve<'a>> = of.copied().collect();
            of.sort_by_key(Curve::rank);
            if !of.is_empty() {
                rows.push(Row::Module(id, info));
            }
            rows.extend(of.into_iter().map(Row::Series));
        }
        rows
    }
}

/// All of a kind at once.
fn quick(ui: &mut Ui, history: &History, choice: &mut Choice, curves: &[Curve<'_>]) {
    let ids = |wanted: &dyn Fn(&Curve<'_>) -> bool| -> Vec<SeriesId> {
        curves.iter().filter(|curve| wanted(curve)).map(|curve| curve.id).collect()
    };
    let kinds = [
        ("Temperatures", "All temperatures", ids(&|curve| curve.stem() == "temperature")),
        ("Motion", "All motion", ids(&|curve| curve.switch() == Some(SwitchKind::Motion))),
    ];
    ui.horizontal(|ui| {
        for (text, name, ids) in kinds.iter().filter(|(_, _, ids)| !ids.is_empty()) {
            let on = ids.iter().all(|id| choice.get(*id).is_some());
            if widgets::chip(ui, on, text, name, "Those of all modules in the plots, or none of them") {
                choice.toggle_all(history, ids);
            }
        }
    });
}

fn heading(ui: &mut Ui, history: &History, id: ModuleId, info: &ModuleInfo) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::LIST_ROW), Sense::hover());
    // The line says more only where there are several.
    let lines = history.modules().any(|(_, other)| other.line != info.line);
    let text = if lines { format!("{info}  {}", info.line) } else { info.to_string() };
    widgets::line_in(ui, rect, Align::Min, &text, theme::body(), palette.text);
    widgets::describe(&response, Role::Label, &text);
    let name = history.module_info(id).map(|info| info.name.as_str()).filter(|name| !name.is_empty());
    let name = name.map(|name| format!("\n{name}")).unwrap_or_default();
    response.on_hover_text(format!("{info}, {}, {}{name}", info.protocol, info.line));
}

fn entry(ui: &mut Ui, history: &History, bench: Option<&Bench>, choice: &mut Choice, curve: &Curve<'_>) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::LIST_ROW), Sense::click());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let shown = choice.get(curve.id);
    let colour = shown.map(|shown| curve.colour(shown.colour, palette));
    let inside = rect.shrink2(vec2(theme::UNIT, 0.0));
    tick_box(ui, inside, colour);
    let text = inside.with_min_x(inside.left() + theme::GLYPH + theme::GAP);
    let last = curve.trend.last();
    let value = last.map_or_else(|| words::UNKNOWN.to_owned(), |[_, value]| curve.text(value));
    let is_old = bench.is_some_and(|bench| is_old(bench, curve, last.map(|[at, _]| at)));
    let shade = if is_old { palette.old } else { palette.text };
    let place = widgets::line_in(ui, text, Align::Max, &value, theme::small(), shade);
    let name = text.with_max_x(place.left() - theme::UNIT);
    widgets::line_in(ui, name, Align::Min, curve.label(), theme::small(), palette.quiet);
    let on = shown.is_some();
    let label = format!("{} of {}", curve.label(), curve.module);
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, &label));
    let old = if is_old { "\nThe value is old" } else { "" };
    let does = if on { "Click to take it out of the plots" } else { "Click to show it in the plots" };
    let response = response.on_hover_text(format!("{}\n{does}{old}", curve.full_name()));
    if response.clicked() {
        choice.toggle(history, curve.id);
    }
}

/// Filled with the colour of its curve, with a tick in it; an empty frame for what is not shown.
fn tick_box(ui: &Ui, rect: Rect, colour: Option<Color32>) {
    let palette = theme::palette(ui);
    let centre = pos2(rect.left() + theme::GLYPH / 2.0, rect.center().y);
    let square = Rect::from_center_size(centre, vec2(theme::GLYPH, theme::GLYPH));
    match colour {
        Some(colour) => {
            ui.painter().rect_filled(square, theme::HAIRLINE, colour);
            widgets::paint_glyph(ui.painter(), Glyph::Tick, centre, theme::GLYPH - theme::UNIT / 2.0, palette.ground);
        }
        None => {
            let stroke = Stroke::new(theme::HAIRLINE, palette.old);
            ui.painter().rect_stroke(square, theme::HAIRLINE, stroke, StrokeKind::Inside);
        }
    }
}

/// Whether the live value is older than its polls are apart; a setting is not polled and does not grow old.
fn is_old(bench: &Bench, curve: &Curve<'_>, at: Option<f64>) -> bool {
    let Some(at) = at.filter(|_| !curve.is_setting()) else { return false };
    if bench.line().is_lost() {
        return true;
    }
    let module = bench.modules().iter().find(|module| module.history_id() == Some(curve.info.module));
    let interval = module.and_then(|module: &Module| module.interval).unwrap_or_default().as_secs_f64();
    words::seconds(bench.now()) - at > OLD_AFTER * interval.max(1.0)
}
