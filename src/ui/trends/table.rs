//! Values and figures of what is shown, as a table: at the pointer, at the cursors, and between them.

use eframe::egui::{Align, Panel, ScrollArea, Sense, Ui};
use egui_extras::{Column as Room, TableBuilder};

use super::choice::Shown;
use super::cursors::{Cursors, NAMES};
use super::curve::{Curve, Value};
use super::legend;
use super::scene::Scene;
use super::window::span_text;
use crate::record::{SeriesId, Statistics};
use crate::ui::tables::{Part, Sheet, copied};
use crate::ui::{theme, widgets, words};

const COLUMNS: [&str; 11] =
    ["Pointer", "A", "B", "B − A", "Lowest", "Highest", "Mean", "Times on", "Time on", "Observed", "Samples"];
/// What stands in each.
const MEANINGS: [&str; COLUMNS.len()] = [
    "Value at the pointer",
    "Value at cursor A",
    "Value at cursor B",
    "How much the value changes from A to B",
    "Lowest sample",
    "Highest sample",
    "Mean of the samples",
    "How often it went on",
    "For how long it was on",
    "For how long its value is known",
    "How many samples there are",
];

/// Everything that the table says, in the words in which it is copied too.
struct Row {
    name: String,
    unit: String,
    cells: [String; COLUMNS.len()],
}

/// What the table is about: the scene with its pointer, the cursors, and the span of the figures.
pub struct Table<'a> {
    pub scene: &'a Scene<'a>,
    pub cursors: &'a Cursors,
    pub curves: &'a [(Curve<'a>, Shown)],
}

impl Table<'_> {
    /// From when to when figures are told: between the cursors, else what is in view.
    fn span(&self) -> [f64; 2] {
        self.cursors.span().unwrap_or([self.scene.view.from, self.scene.view.to])
    }

    /// Shows it; true if the cursors are to be cleared.
    pub fn show(&self, ui: &mut Ui) -> bool {
        let mut clear = false;
        ui.horizontal(|ui| clear = self.heading(ui));
        ui.add_space(theme::UNIT);
        // In a narrow pane not all columns have room.
        ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| self.rows(ui));
        clear
    }

    fn rows(&self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing = [theme::GAP, 0.0].into();
        let mut builder = TableBuilder::new(ui)
            .id_salt("values")
            .striped(true)
            .sense(Sense::hover())
            .auto_shrink(false)
            .min_scrolled_height(0.0)
            .column(Room::initial(theme::VALUES_NAME).at_least(theme::TABLE_LEAST).clip(true));
        for name in COLUMNS {
            let width =
                if name.starts_with("Time ") || name == "Observed" { theme::VALUES_SPAN } else { theme::VALUES_COLUMN };
            builder = builder.column(Room::exact(width).clip(true));
        }
        let table = builder.header(theme::LIST_ROW, |mut row| {
            let mut column = |name: &str, align: Align, means: &str| {
                let (_, response) = row.col(|ui| {
                    let (rect, colour) = (ui.max_rect(), theme::palette(ui).quiet);
                    widgets::line_in(ui, rect, align, name, theme::small(), colour);
                });
                response.on_hover_text(means);
            };
            column("Series", Align::Min, "Module and reading");
            for (name, means) in COLUMNS.into_iter().zip(MEANINGS) {
                column(name, Align::Max, means);
            }
        });
        table.body(|body| {
            body.rows(theme::LIST_ROW, self.curves.len(), |mut row| {
                let Some((curve, shown)) = self.curves.get(row.index()) else { return };
                let said = self.row(curve);
                let (_, response) = row.col(|ui| name(ui, curve, shown, &said));
                let told: Vec<String> =
                    COLUMNS.iter().zip(&said.cells).filter(|(_, cell)| !cell.is_empty()).map(pair).collect();
                widgets::describe(&response, eframe::egui::Role::Row, &format!("{}: {}", said.name, told.join(", ")));
                copied(&response, |part| self.sheet((part == Part::Row).then_some(curve.id)));
                for cell in &said.cells {
                    row.col(|ui| {
                        let (rect, colour) = (ui.max_rect(), theme::palette(ui).text);
                        widgets::line_in(ui, rect, Align::Max, cell, theme::small(), colour);
                    });
                }
            });
        });
    }

    /// The times of the cursors, what the figures are of, and what can be done.
    fn heading(&self, ui: &mut Ui) -> bool {
        for (name, at) in NAMES.iter().zip(self.cursors.at) {
            let time = at.map_or_else(|| words::UNKNOWN.to_owned(), |at| self.scene.clock(at));
            let response = widgets::fixed(ui, theme::VALUES_CURSOR, Align::Min, &format!("{name} {time}"));
            if let Some(at) = at {
                response.on_hover_text(self.scene.zone.text(at, "%Y-%m-%d %H:%M:%S%.6f%:z"));
            }
        }
        let difference = match self.cursors.at {
            [Some(a), Some(b)] => exact_span(b - a),
            _ => words::UNKNOWN.to_owned(),
        };
        widgets::fixed(ui, theme::VALUES_CURSOR + theme::VALUES_COLUMN, Align::Min, &format!("B − A {difference}"))
            .on_hover_text("The time from cursor A to cursor B");
        let of = if self.cursors.span().is_some() { "Figures between A and B" } else { "Figures of the time in view" };
        widgets::quiet(ui, of);
        let mut clear = false;
        widgets::at_right(ui, |ui| {
            if ui.button("Copy table").on_hover_text("As text, its columns parted by tabs").clicked() {
                self.sheet(None).copy(ui.ctx());
            }
            let button = ui.add_enabled(self.cursors.any(), eframe::egui::Button::new("Clear cursors"));
            let button = button.on_hover_text("Takes both cursors out of the plots");
            clear = button.on_disabled_hover_text("Click into the plots to place one").clicked();
        });
        clear
    }

    fn row(&self, curve: &Curve<'_>) -> Row {
        let value = |at: Option<f64>| at.map(|at| self.scene.value(curve, at));
        let [a, b] = self.cursors.at.map(value);
        let text = |value: Option<Option<Value>>| value.map(|value| curve.value_text(value)).unwrap_or_default();
        let difference = match (a.flatten(), b.flatten()) {
            (Some(a), Some(b)) if curve.is_number() => curve.word(b.value - a.value),
            _ => String::new(),
        };
        let [from, to] = self.span();
        let figures = curve.statistics(from, to);
        let [low, high, mean, times, on, observed, samples] = figures_text(curve, figures);
        let pointer = text(value(self.scene.pointer));
        let cells = [pointer, text(a), text(b), difference, low, high, mean, times, on, observed, samples];
        Row { name: curve.name(), unit: curve.info.unit.clone(), cells }
    }

    /// All of it as it is copied, or one row.
    fn sheet(&self, only: Option<SeriesId>) -> Sheet {
        let mut sheet = Sheet::new(["Series", "Unit"].into_iter().chain(COLUMNS));
        for (curve, _) in self.curves.iter().filter(|(curve, _)| only.is_none_or(|only| only == curve.id)) {
            let Row { name, unit, cells } = self.row(curve);
            sheet.push([name, unit].iter().chain(&cells));
        }
        sheet
    }
}

fn pair((name, cell): (&&str, &String)) -> String {
    format!("{name} {cell}")
}

fn name(ui: &mut Ui, curve: &Curve<'_>, shown: &Shown, said: &Row) {
    let palette = theme::palette(ui);
    let rect = ui.max_rect();
    legend::mark(ui, rect, curve.colour(shown.colour, palette), shown.hidden);
    let text = rect.with_min_x(rect.left() + theme::GLYPH + theme::UNIT);
    let unit = widgets::line_in(ui, text, Align::Max, &said.unit, theme::small(), palette.quiet);
    let text = text.with_max_x(unit.left() - theme::UNIT);
    curve.paint_name(ui, text, palette.text);
}

/// A dash while the samples are still to be fetched, or where there are none.
fn figures_text(curve: &Curve<'_>, figures: Option<Statistics>) -> [String; 7] {
    let unknown = || words::UNKNOWN.to_owned();
    let empty = String::new;
    let Some(figures) = figures else {
        return match curve.is_number() {
            true => [unknown(), unknown(), unknown(), empty(), empty(), unknown(), unknown()],
            false => [empty(), empty(), empty(), unknown(), unknown(), unknown(), unknown()],
        };
    };
    let Statistics { count, low, high, mean, times, on, observed, on_at_start: _ } = figures;
    let (observed, count) =
        (short_span(observed), crate::ui::tables::grouped(usize::try_from(count).unwrap_or(usize::MAX)));
    if curve.is_number() && figures.count == 0 {
        // Observed by the samples beyond both ends, but none lies between.
        return [unknown(), unknown(), unknown(), empty(), empty(), observed, count];
    }
    if curve.is_number() {
        let finer = curve.word_finer(mean, 1);
        return [curve.word(low), curve.word(high), finer, empty(), empty(), observed, count];
    }
    if curve.switch().is_some() {
        return [empty(), empty(), empty(), times.to_string(), short_span(on), observed, count];
    }
    [empty(), empty(), empty(), empty(), empty(), observed, count]
}

/// Seconds to a tenth below a minute, else as words.
fn short_span(seconds: f64) -> String {
    match seconds {
        ..60.0 => format!("{seconds:.1} s"),
        _ => words::span(std::time::Duration::try_from_secs_f64(seconds.round()).unwrap_or_default()),
    }
}

/// To a millisecond, with its sign, and in larger units where it is long.
fn exact_span(seconds: f64) -> String {
    match seconds.abs() {
        ..60.0 => format!("{seconds:.3} s"),
        _ => format!("{seconds:.1} s ({})", span_text(seconds.abs())),
    }
}

/// The panel below the plots.
pub fn panel(height: f32) -> Panel {
    let [usual, most] = theme::below_plots(theme::VALUES, height);
    Panel::bottom("values")
        .frame(theme::details_frame())
        .resizable(true)
        .default_size(usual)
        .size_range(*theme::VALUES_RANGE.start()..=most)
}

#[cfg(test)]
mod tests {
    use super::super::choice::Side;
    use super::super::testing;
    use super::*;
    use crate::record::{History, SeriesKind};
    use crate::ui::plot::{TimeView, Zone};
    use eframe::egui::Rangef;

    fn history() -> (History, [SeriesId; 2]) {
        let mut history = History::default();
        let number = testing::series(&mut history, 1, "temperature_c", SeriesKind::Number { decimals: 2 });
        let motion = testing::series(&mut history, 1, "pir", SeriesKind::Switch);
        for second in 0..=100 {
            history.push(number, second * 1_000_000, 2_000 + second);
            history.push(motion, second * 1_000_000, i64::from((20..30).contains(&(second % 50))));
        }
        (history, [number, motion])
    }

    fn said(cursors: [Option<f64>; 2], pointer: Option<f64>) -> String {
        let (history, ids) = history();
        let view = TimeView { from: 0.0, to: 100.0, columns: Rangef::new(0.0, 600.0) };
        let scene = Scene { history: &history, bench: None, view, zone: Zone::Utc, pointer };
        let shown = |id| Shown { id, plot: 0, side: Side::Left, colour: 0, hidden: false };
        let curves: Vec<(Curve<'_>, Shown)> = ids.map(|id| (Curve::of(&history, id).unwrap(), shown(id))).into();
        Table { scene: &scene, cursors: &Cursors { at: cursors }, curves: &curves }.sheet(None).into_text()
    }

    #[test]
    fn figures_between_the_cursors_are_those_of_the_samples() {
        let text = said([Some(10.0), Some(90.0)], Some(50.2));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], "temperature_c\t°C\t20.50\t20.10\t20.90\t0.80\t20.10\t20.90\t20.500\t\t\t1 min 20 s\t81");
        assert_eq!(lines[2], "pir\t\tquiet\tquiet\tquiet\t\t\t\t\t2\t20.0 s\t1 min 20 s\t81");
    }

    #[test]
    fn without_cursors_the_figures_are_of_what_is_in_view() {
        let text = said([None, Some(30.0)], None);
        assert!(text.contains("temperature_c\t°C\t\t\t20.30\t\t20.00\t21.00\t20.500\t\t\t1 min 40 s\t101"), "{text}");
    }

    #[test]
    fn differences_of_times_are_exact() {
        assert_eq!([exact_span(-1.25), exact_span(5_400.0)], ["-1.250 s", "5400.0 s (90 min)"]);
    }
}
