//! The table itself: rows of one height, of which those in view are asked for and drawn.

use eframe::egui::{
    self, Align, Color32, EventFilter, FontId, Id, Key, Response, Role, Sense, Stroke, StrokeKind, Ui, vec2,
};
use egui_extras::{Column as Room, TableBuilder, TableRow};

use super::scroll::Scroll;
use super::selection::Selection;
use super::sheet::{self, Part};
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

/// A column; without a width it takes what is left.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    pub title: &'static str,
    /// What stands in it.
    pub means: &'static str,
    pub width: Option<f32>,
    pub align: Align,
}

impl Column {
    pub fn new(title: &'static str, means: &'static str, width: f32) -> Self {
        Self { title, means, width: Some(width), align: Align::Min }
    }

    pub fn number(title: &'static str, means: &'static str, width: f32) -> Self {
        Self { align: Align::Max, ..Self::new(title, means, width) }
    }

    pub fn rest(title: &'static str, means: &'static str) -> Self {
        Self { title, means, width: None, align: Align::Min }
    }
}

/// What stands in one column of a row.
pub struct Cell {
    pub mark: Option<(Glyph, Color32)>,
    pub text: String,
    pub font: FontId,
    pub colour: Color32,
    /// What the pointer tells beyond the text; the whole text where it is cut.
    pub hover: String,
}

impl Cell {
    pub fn new(text: impl Into<String>, colour: Color32) -> Self {
        Self { mark: None, text: text.into(), font: theme::body(), colour, hover: String::new() }
    }

    pub fn mono(text: impl Into<String>, colour: Color32) -> Self {
        Self { font: theme::small_mono(), ..Self::new(text, colour) }
    }

    pub fn marked(self, glyph: Glyph, colour: Color32) -> Self {
        Self { mark: Some((glyph, colour)), ..self }
    }

    pub fn hover(self, hover: impl Into<String>) -> Self {
        Self { hover: hover.into(), ..self }
    }
}

/// One row.
pub struct Line {
    /// Names it in a [`Selection`]; grows from row to row.
    pub key: u64,
    pub cells: Vec<Cell>,
}

impl Line {
    /// As one sentence, for assistive technology.
    fn said(&self) -> String {
        let texts: Vec<&str> =
            self.cells.iter().map(|cell| cell.text.as_str()).filter(|text| !text.is_empty()).collect();
        texts.join("  ")
    }
}

/// What the user asked for at the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Act {
    CopyChosen,
    CopyAll,
}

/// A table with `rows` rows.
pub struct Table<'a> {
    /// Tells it apart from others, and names it to assistive technology.
    pub name: &'a str,
    pub columns: &'a [Column],
    pub rows: usize,
}

impl Table<'_> {
    /// Draws it into what room there is. `line` makes the row of that number, oldest first; `key` is its key alone.
    pub fn show(
        &self,
        ui: &mut Ui,
        scroll: &mut Scroll,
        selection: &mut Selection,
        key: &dyn Fn(usize) -> Option<u64>,
        line: &dyn Fn(usize) -> Option<Line>,
    ) -> Option<Act> {
        ui.push_id(self.name, |ui| {
            let room = ui.available_rect_before_wrap();
            let focus = ui.scope_id().with("keys");
            let mut act = self.keys(ui, focus, scroll, selection, key);
            ui.spacing_mut().item_spacing = vec2(theme::GAP, 0.0);
            let body_height = (room.height() - theme::LIST_ROW).max(theme::LIST_ROW);
            let mut builder = TableBuilder::new(ui)
                .striped(true)
                .sense(Sense::CLICK)
                .auto_shrink(false)
                .animate_scrolling(false)
                .min_scrolled_height(0.0)
                .max_scroll_height(body_height);
            for column in self.columns {
                let room = column.width.map_or_else(|| Room::remainder().clip(true), Room::exact);
                builder = builder.column(room);
            }
            if let Some(row) = scroll.reveal.take() {
                builder = builder.scroll_to_row(row, None);
            } else if scroll.at_end {
                let height = self.rows as f32 * theme::LIST_ROW;
                builder = builder.vertical_scroll_offset((height - body_height).max(0.0));
            }
            let table = builder.header(theme::LIST_ROW, |row| header(row, self.columns));
            let output = table.body(|body| {
                body.rows(theme::LIST_ROW, self.rows, |mut row| {
                    let Some(line) = line(row.index()) else { return blank(&mut row, self.columns) };
                    row.set_selected(selection.contains(line.key));
                    let response = cells(&mut row, self.columns, &line);
                    if response.clicked() || response.secondary_clicked() {
                        choose(&response, selection, line.key);
                        scroll.at_end = false;
                        response.ctx.memory_mut(|memory| memory.request_focus(focus));
                    }
                    response.context_menu(|ui| act = menu(ui).or(act));
                });
            });
            let end = output.content_size.y - output.inner_rect.height();
            if end > 0.0 && ui.rect_contains_pointer(room) {
                let is_at_end = output.state.clamped_offset().y >= end - theme::LIST_ROW / 2.0;
                note_movement(ui, scroll, is_at_end);
            }
            ui.painter().rect_stroke(
                room.expand2(vec2(theme::UNIT, 0.0)),
                0.0,
                if ui.memory(|memory| memory.has_focus(focus)) {
                    Stroke::new(theme::HAIRLINE, theme::palette(ui).accent)
                } else {
                    Stroke::NONE
                },
                StrokeKind::Inside,
            );
            act
        })
        .inner
    }

    /// The table is one stop of the Tab key; arrows choose a row, and Copy copies.
    fn keys(
        &self,
        ui: &Ui,
        id: Id,
        scroll: &mut Scroll,
        selection: &mut Selection,
        key: &dyn Fn(usize) -> Option<u64>,
    ) -> Option<Act> {
        let response = ui.interact(ui.available_rect_before_wrap(), id, Sense::focusable_noninteractive());
        widgets::describe(&response, Role::Table, self.name);
        if !response.has_focus() {
            return None;
        }
        let filter = EventFilter { vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        let page = (response.rect.height() / theme::LIST_ROW) as isize - 2;
        let steps = [
            (Key::ArrowUp, -1),
            (Key::ArrowDown, 1),
            (Key::PageUp, -page),
            (Key::PageDown, page),
            (Key::Home, isize::MIN),
            (Key::End, isize::MAX),
        ];
        let pressed = |key: Key| ui.input(|input| input.key_pressed(key));
        if let Some((_, step)) = steps.into_iter().find(|(key, _)| pressed(*key))
            && self.rows > 0
        {
            let last = self.rows - 1;
            let now = selection.current().map_or(last, |chosen| first_from(self.rows, chosen, key).min(last));
            let row = now.saturating_add_signed(step).min(last);
            if let Some(key) = key(row) {
                if ui.input(|input| input.modifiers.shift) { selection.extend(key) } else { selection.choose(key) }
            }
            scroll.at_end = false;
            scroll.reveal = Some(row);
        }
        let copies = ui.input(|input| input.events.iter().any(|event| matches!(event, egui::Event::Copy)));
        copies.then_some(if selection.current().is_some() { Act::CopyChosen } else { Act::CopyAll })
    }
}

/// Looking back ends the following, by the wheel at once; scrolling to the end takes it up again.
fn note_movement(ui: &Ui, scroll: &mut Scroll, is_at_end: bool) {
    let (wheel, is_dragging) = ui.input(|input| (input.smooth_scroll_delta().y, input.pointer.primary_down()));
    if wheel > 0.0 || (is_dragging && !is_at_end) {
        scroll.at_end = false;
    } else if wheel < 0.0 && is_at_end {
        scroll.at_end = true;
    }
}

/// The first row whose key is not below `wanted`.
fn first_from(rows: usize, wanted: u64, key: &dyn Fn(usize) -> Option<u64>) -> usize {
    let (mut low, mut high) = (0, rows);
    while low < high {
        let middle = low.midpoint(high);
        if key(middle).is_some_and(|key| key < wanted) { low = middle + 1 } else { high = middle }
    }
    low
}

fn header(mut row: TableRow<'_, '_>, columns: &[Column]) {
    for column in columns {
        let (_, response) = row.col(|ui| {
            let palette = theme::palette(ui);
            let rect = ui.max_rect();
            widgets::line_in(ui, rect, column.align, column.title, theme::small(), palette.quiet);
        });
        widgets::describe(&response, Role::ColumnHeader, column.title);
        response.on_hover_text(column.means);
    }
}

/// A row that was forgotten while the list stood still.
fn blank(row: &mut TableRow<'_, '_>, columns: &[Column]) {
    for _ in columns {
        row.col(|_| {});
    }
}

fn cells(row: &mut TableRow<'_, '_>, columns: &[Column], line: &Line) -> Response {
    let mut first = None;
    for (column, cell) in columns.iter().zip(&line.cells) {
        let mut is_cut = false;
        let (_, response) = row.col(|ui| is_cut = paint(ui, column, cell));
        let response = match (cell.hover.is_empty(), is_cut) {
            (false, _) => response.on_hover_ui(|ui| drop(hover(ui, &cell.hover, &cell.font))),
            (true, true) => response.on_hover_ui(|ui| drop(hover(ui, &cell.text, &cell.font))),
            _ => response,
        };
        first.get_or_insert(response);
    }
    if let Some(first) = first {
        widgets::describe(&first, Role::Row, &line.said());
    }
    row.response()
}

fn hover(ui: &mut Ui, text: &str, font: &FontId) -> Response {
    ui.set_max_width(theme::TEXT_WIDTH);
    ui.label(egui::RichText::new(text).font(font.clone()))
}

/// True if the text did not fit.
fn paint(ui: &Ui, column: &Column, cell: &Cell) -> bool {
    let mut rect = ui.max_rect();
    if let Some((glyph, colour)) = cell.mark {
        let centre = egui::pos2(rect.left() + theme::GLYPH / 2.0, rect.center().y);
        widgets::paint_glyph(ui.painter(), glyph, centre, theme::GLYPH - theme::OUTLINE, colour);
        rect.min.x += theme::GLYPH + theme::UNIT;
    }
    let galley = widgets::cut(ui, &cell.text, cell.font.clone(), cell.colour, rect.width());
    let is_cut = galley.elided;
    let left = if column.align == Align::Max { rect.right() - galley.size().x } else { rect.left() };
    ui.painter().galley(egui::pos2(left, rect.center().y - galley.size().y / 2.0), galley, cell.colour);
    is_cut
}

fn choose(response: &Response, selection: &mut Selection, key: u64) {
    let keeps = response.secondary_clicked() && selection.contains(key);
    if keeps {
        return;
    }
    if response.ctx.input(|input| input.modifiers.shift) { selection.extend(key) } else { selection.choose(key) }
}

fn menu(ui: &mut Ui) -> Option<Act> {
    sheet::entries(ui).map(|part| match part {
        Part::Row => Act::CopyChosen,
        Part::Table => Act::CopyAll,
    })
}
