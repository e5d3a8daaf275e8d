//! Tables as text for a spreadsheet, and the menu and keys that copy them: the same wherever a table stands.

use eframe::egui::{Context, Event, Id, Popup, Pos2, Rect, Response, Sense, Ui, text_selection::LabelSelectionState};

/// A table as it is copied: a header, then the rows, their cells parted by tabs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sheet(String);

impl Sheet {
    pub fn new<C: AsRef<str>>(header: impl IntoIterator<Item = C>) -> Self {
        let mut sheet = Self(String::new());
        sheet.push(header);
        sheet
    }

    pub fn push<C: AsRef<str>>(&mut self, cells: impl IntoIterator<Item = C>) {
        for (index, cell) in cells.into_iter().enumerate() {
            if index > 0 {
                self.0.push('\t');
            }
            // A tab or a new line would begin another cell.
            self.0.extend(cell.as_ref().trim_end().chars().map(|c| if c.is_control() { ' ' } else { c }));
        }
        self.0.push('\n');
    }

    #[cfg(test)]
    pub fn into_text(self) -> String {
        self.0
    }

    pub fn copy(self, ctx: &Context) {
        ctx.copy_text(self.0);
    }
}

/// What a table copies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Row,
    Table,
}

impl Part {
    /// Which of the two is meant.
    pub fn of<T>(self, row: T, table: T) -> T {
        match self {
            Self::Row => row,
            Self::Table => table,
        }
    }
}

/// Lets a row be copied by a right click, and by Ctrl+C where it has the focus, or where nothing else has it and the
/// pointer is on the row.
pub fn copied(response: &Response, sheet: impl Fn(Part) -> Sheet) {
    // Not focusable: a row that only shows something is no stop of the Tab key.
    let response = response.interact(Sense::CLICK);
    response.context_menu(|ui| offer(ui, &sheet));
    let focused = response.ctx.memory(|memory| memory.focused());
    if focused.map_or(response.hovered(), |focused| focused == response.id) {
        copy_typed(&response.ctx, focused.is_some(), &sheet);
    }
}

/// The same for a row of several things that take clicks themselves, and for one inside a popup: of those egui remembers
/// only one, which a menu of the usual kind would close.
pub fn copied_row(ui: &Ui, row: Rect, id: Id, sheet: impl Fn(Part) -> Sheet) {
    let response = ui.interact(row, id, Sense::hover());
    let ctx = ui.ctx();
    if response.contains_pointer() && ctx.input(|input| input.pointer.secondary_clicked()) {
        let place = ctx.input(|input| input.pointer.interact_pos());
        place.into_iter().for_each(|at| remember_menu(ctx, id, at));
    }
    if let Some(at) = menu_place(ctx, id) {
        let mut open = true;
        Popup::menu(&response).at_position(at).open_bool(&mut open).show(|ui| offer(ui, &sheet));
        if open { remember_menu(ctx, id, at) } else { ctx.data_mut(|data| data.remove::<(Pos2, u64)>(id)) }
    }
    if response.contains_pointer() && ctx.memory(|memory| memory.focused()).is_none() {
        copy_typed(ctx, false, &sheet);
    }
}

/// Where the menu of a row is open; nowhere if the row was out of sight meanwhile.
fn menu_place(ctx: &Context, id: Id) -> Option<Pos2> {
    let (at, pass) = ctx.data(|data| data.get_temp::<(Pos2, u64)>(id))?;
    (ctx.cumulative_pass_nr() <= pass.saturating_add(1)).then_some(at)
}

fn remember_menu(ctx: &Context, id: Id, at: Pos2) {
    let pass = ctx.cumulative_pass_nr();
    ctx.data_mut(|data| data.insert_temp(id, (at, pass)));
}

fn offer(ui: &mut Ui, sheet: &impl Fn(Part) -> Sheet) {
    if let Some(part) = entries(ui) {
        sheet(part).copy(ui.ctx());
    }
}

/// Copies the row if that was typed; text that is marked goes before a row that is only pointed at.
fn copy_typed(ctx: &Context, has_focus: bool, sheet: &impl Fn(Part) -> Sheet) {
    let typed = ctx.input(|input| input.events.contains(&Event::Copy));
    if typed && (has_focus || !has_selected_text(ctx)) {
        sheet(Part::Row).copy(ctx);
    }
}

/// Whether text of a label is marked, which Ctrl+C copies instead.
fn has_selected_text(ctx: &Context) -> bool {
    ctx.with_plugin(|labels: &mut LabelSelectionState| labels.has_selection()).unwrap_or(false)
}

/// The entries of a menu that copy; what was chosen.
pub fn entries(ui: &mut Ui) -> Option<Part> {
    let mut chosen = None;
    for (part, text) in [(Part::Row, "Copy row"), (Part::Table, "Copy table")] {
        if ui.button(text).clicked() {
            chosen = Some(part);
            ui.close();
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_parted_by_tabs_and_hold_none() {
        let mut sheet = Sheet::new(["Name", "Value"]);
        sheet.push(["a\tb", "two\nlines"]);
        sheet.push(["", "3 "]);
        assert_eq!(sheet.into_text(), "Name\tValue\na b\ttwo lines\n\t3\n");
    }
}
