//! All modules that were found, in one table.

use eframe::egui::{
    Align, Button, Event, Id, Rect, Response, Role, ScrollArea, Sense, Stroke, TextWrapMode, Ui, UiBuilder, WidgetInfo,
    pos2, vec2,
};
use egui_extras::TableBuilder;

use super::app::Pass;
use super::commands::{Command, toggled_polling};
use super::connect::{self, Ready};
use super::dashboard_table::{Cell, Column, Count, Line, Table};
use super::settings::LineChoice;
use super::tables::Sheet;
use super::widgets::{self, Glyph};
use super::{empty, theme};
use crate::bench::{Action, Module, ScanState};

/// What the dashboard remembers between frames.
#[derive(Default)]
pub struct Dashboard {
    /// The column that the table is sorted by, and whether upwards; else the modules stand as they were found.
    sorted: Option<(Column, bool)>,
    /// Places that full scans ask, over TCP and over a serial line; counted once.
    full: [Option<usize>; 2],
}

/// What the table asks for while it is drawn.
enum Wish {
    Sort(Column),
    Copy(Sheet),
    Do(Action),
}

const NOT_POLLED: &str = "Nothing is polled – poll all, or click a module to open and poll it";

impl Dashboard {
    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>) {
        if pass.bench.modules().is_empty() {
            return empty::show(ui, pass);
        }
        let mut table = Table::of(pass, theme::palette(ui));
        if let Some((column, ascending)) = &self.sorted {
            table.sort(column, *ascending);
        }
        let count = Count::of(pass.bench.modules());
        let mut wishes = Vec::new();
        toolbar(ui, pass, &table, &count, &mut wishes);
        let hint = match count.polled {
            0 => pass.bench.line().obstacle().unwrap_or(NOT_POLLED),
            _ => "",
        };
        quiet_line(ui, hint);
        let room = (ui.available_height() - theme::CONTROL_HEIGHT - theme::UNIT).max(theme::TABLE_ROW * 3.0);
        let place = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), room));
        ui.allocate_rect(place, Sense::hover());
        // What lies to the right of the room is scrolled to.
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            ui.set_clip_rect(place.intersect(ui.clip_rect()));
            ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| self.table(ui, pass, &table, &mut wishes));
        });
        self.scan_hint(ui, pass);
        for wish in wishes {
            match wish {
                Wish::Sort(column) => self.sort_by(column),
                Wish::Copy(sheet) => sheet.copy(ui.ctx()),
                Wish::Do(action) => pass.actions.push(action),
            }
        }
    }

    /// Upwards, downwards, and as they were found.
    fn sort_by(&mut self, column: Column) {
        self.sorted = match self.sorted.take() {
            Some((sorted, true)) if sorted == column => Some((column, false)),
            Some((sorted, false)) if sorted == column => None,
            _ => Some((column, true)),
        };
    }

    fn table(&self, ui: &mut Ui, pass: &Pass<'_>, table: &Table, wishes: &mut Vec<Wish>) {
        // Space separates the columns; their edges show where the pointer can move them.
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.visuals_mut().widgets.noninteractive.bg_stroke = Stroke::NONE;
        // Other columns have other widths, which the user may have changed.
        let salt: Vec<&str> = table.columns.iter().map(Column::label).collect();
        let widths: Vec<f32> = table.columns.iter().map(|column| column_width(ui, column)).collect();
        let mut builder = TableBuilder::new(ui).id_salt(salt).striped(false).resizable(true).auto_shrink(false);
        for width in widths {
            builder = builder.column(egui_extras::Column::initial(width).at_least(theme::TABLE_LEAST));
        }
        let builder = builder.header(theme::TABLE_ROW, |mut header| {
            for column in &table.columns {
                let sorted =
                    self.sorted.as_ref().filter(|(sorted, _)| sorted == column).map(|(_, ascending)| *ascending);
                header.col(|ui| {
                    if head(ui, column, sorted).clicked() {
                        wishes.push(Wish::Sort(column.clone()));
                    }
                });
            }
        });
        builder.body(|body| {
            let width = body.widths().iter().sum::<f32>();
            body.rows(theme::TABLE_ROW, table.lines.len(), |mut row| {
                let Some(line) = table.lines.get(row.index()) else { return };
                for (index, (column, cell)) in table.columns.iter().zip(&line.cells).enumerate() {
                    row.col(|ui| {
                        if index == 0 {
                            whole_line(ui, width, line, pass, table, wishes);
                        }
                        show_cell(ui, line, column, cell);
                    });
                }
            });
        });
    }

    /// One quiet line that is always there: what a further scan would find.
    fn scan_hint(&mut self, ui: &mut Ui, pass: &Pass<'_>) {
        let text = match pass.bench.scan() {
            Some(ScanState::Running { .. }) => "The scan goes on; modules appear as they answer.".to_owned(),
            Some(ScanState::Ended(summary)) => {
                let over_tcp = pass.settings.line == LineChoice::Tcp;
                let [tcp, serial] = &mut self.full;
                let full = if over_tcp { tcp } else { serial };
                let full = *full.get_or_insert_with(|| connect::plan_of(Ready::Full, pass.settings).targets().len());
                let others = if over_tcp { "other NetIDs" } else { "other speeds, formats and addresses" };
                match summary.done < full {
                    true => {
                        format!("The scan asked {} of {full} places. A full scan also finds {others}.", summary.done)
                    }
                    false => String::new(),
                }
            }
            None => String::new(),
        };
        ui.add_space(theme::UNIT);
        quiet_line(ui, &text);
    }
}

/// One line, whether or not there is something to say.
fn quiet_line(ui: &mut Ui, text: &str) {
    let colour = theme::palette(ui).quiet;
    let response = widgets::fixed_coloured(ui, ui.available_width(), Align::Min, text, colour);
    if !text.is_empty() {
        response.on_hover_text(text);
    }
}

fn toolbar(ui: &mut Ui, pass: &mut Pass<'_>, table: &Table, count: &Count, wishes: &mut Vec<Wish>) {
    ui.horizontal_wrapped(|ui| {
        ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
        for (command, text) in
            [(Command::PollAll, "Poll all"), (Command::PauseAll, "Pause all"), (Command::PollPlan, "Poll plan…")]
        {
            let obstacle = command.obstacle(pass);
            let button = ui.add_enabled(obstacle.is_none(), Button::new(text));
            let button = button.on_hover_text(command.explanation());
            if button.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
                pass.commands.push(command);
            }
        }
        if ui.button("Copy table").on_hover_text("As text, separated by tabs").clicked() {
            wishes.push(Wish::Copy(table.sheet(None)));
        }
        ui.add_space(theme::GAP);
        counts(ui, count);
    });
}

fn counts(ui: &mut Ui, count: &Count) {
    let palette = theme::palette(ui);
    let modules = if count.modules == 1 { "1 module".to_owned() } else { format!("{} modules", count.modules) };
    widgets::quiet(ui, &modules);
    let troubles = [
        (count.silent, "silent", Glyph::Cross, palette.error),
        (count.in_alarm, "in alarm", Glyph::Triangle, palette.alarm),
    ];
    for (number, word, glyph, colour) in troubles {
        if number > 0 {
            widgets::glyph(ui, glyph, colour);
            ui.label(format!("{number} {word}"));
        } else {
            widgets::quiet(ui, &format!("none {word}"));
        }
    }
}

/// Wide enough for the heading with its sorting mark.
fn column_width(ui: &Ui, column: &Column) -> f32 {
    let galley = widgets::cut(ui, column.label(), theme::small(), ui.visuals().text_color(), f32::INFINITY);
    column.width().max((galley.size().x + theme::CARET + 2.0 * theme::UNIT).ceil())
}

/// A heading; a click sorts by it.
fn head(ui: &mut Ui, column: &Column, sorted: Option<bool>) -> Response {
    let palette = theme::palette(ui);
    let rect = ui.max_rect();
    let response = ui.interact(rect, ui.scope_id().with("head"), Sense::click());
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, theme::UNIT, palette.raised);
    }
    let colour = if sorted.is_some() { palette.text } else { palette.quiet };
    let inside = rect.shrink2(vec2(theme::UNIT, 0.0));
    let text = if sorted.is_some() { inside.with_max_x(inside.right() - theme::CARET) } else { inside };
    widgets::line_in(ui, text, column.align(), column.label(), theme::small(), colour);
    if let Some(ascending) = sorted {
        let centre = pos2(inside.right() - theme::CARET / 2.0, rect.center().y);
        widgets::paint_caret(ui.painter(), centre, ascending, colour);
    }
    let name = format!("Sort by {}", column.label());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, sorted.is_some(), &name));
    response.on_hover_text(format!("{}: {}\nClick to sort by it", column.label(), column.explanation()))
}

/// What belongs to the line as a whole, drawn before its cells: a click opens the module, a right click offers more.
fn whole_line(ui: &mut Ui, width: f32, line: &Line, pass: &Pass<'_>, table: &Table, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    let cell = ui.max_rect();
    let rect = Rect::from_min_size(cell.min, vec2(width, cell.height()));
    let response = ui.interact(rect, Id::unique(("line", line.target)), Sense::click());
    if response.hovered() || response.has_focus() || response.context_menu_opened() {
        ui.painter().rect_filled(rect, 0.0, palette.raised);
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), (theme::HAIRLINE, palette.grid));
    response.widget_info(|| WidgetInfo::labeled(Role::Row, true, &line.name));
    if response.clicked() {
        wishes.push(Wish::Do(Action::Show(line.target)));
    }
    if response.has_focus() && ui.input(|input| input.events.contains(&Event::Copy)) {
        wishes.push(Wish::Copy(table.sheet(Some(line.target))));
    }
    if let Some(module) = pass.bench.module(&line.target) {
        response.context_menu(|ui| line_menu(ui, module, pass, table, wishes));
    }
}

fn line_menu(ui: &mut Ui, module: &Module, pass: &Pass<'_>, table: &Table, wishes: &mut Vec<Wish>) {
    let target = module.target;
    let polling = if module.interval.is_some() { "Pause polling" } else { "Resume polling" };
    let pollable = module.definition().is_some() && pass.bench.line().line().is_some();
    let entries = [
        ("Open", true, Wish::Do(Action::Show(target))),
        (polling, pollable, Wish::Do(toggled_polling(module))),
        ("Copy row", true, Wish::Copy(table.sheet(Some(target)))),
        ("Copy table", true, Wish::Copy(table.sheet(None))),
        ("Remove from the list", true, Wish::Do(Action::Remove(target))),
    ];
    for (text, enabled, wish) in entries {
        if ui.add_enabled(enabled, Button::new(text)).clicked() {
            wishes.push(wish);
            ui.close();
        }
    }
}

fn show_cell(ui: &mut Ui, line: &Line, column: &Column, cell: &Cell) {
    let rect = ui.max_rect();
    let font = if *column == Column::Spoken { theme::small() } else { theme::body() };
    let mut room = rect.shrink2(vec2(theme::UNIT, 0.0));
    for piece in &cell.pieces {
        if let Some((glyph, colour)) = piece.glyph {
            let centre = pos2(room.left() + theme::GLYPH / 2.0, room.center().y);
            widgets::paint_glyph(ui.painter(), glyph, centre, theme::GLYPH, colour);
            room.min.x += theme::GLYPH + theme::UNIT;
        }
        let place = widgets::line_in(ui, room, column.align(), &piece.text, font.clone(), piece.colour);
        room.min.x = place.right() + theme::GAP;
    }
    let response = ui.interact(rect, ui.scope_id().with("cell"), Sense::hover());
    let text = cell.plain();
    widgets::describe(&response, Role::Label, &format!("{}, {}: {text}", line.name, column.label()));
    let note = if cell.note.is_empty() { &text } else { &cell.note };
    response.on_hover_text(note);
}
