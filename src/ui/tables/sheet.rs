//! Tables as text for a spreadsheet, and the menu and keys that copy them: the same wherever a table stands.

use eframe::egui::{Context, Event, Response, Sense, Ui, text_selection::LabelSelectionState};

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

/// Lets a row be copied by a right click, and by Ctrl+C where it has the focus, or where nothing else has it and the
/// pointer is on the row.
pub fn copied(response: &Response, sheet: impl Fn(Part) -> Sheet) {
    // Not focusable: a row that only shows something is no stop of the Tab key.
    let response = response.interact(Sense::CLICK);
    response.context_menu(|ui| {
        if let Some(part) = entries(ui) {
            sheet(part).copy(ui.ctx());
        }
    });
    let ctx = &response.ctx;
    let is_meant = || match ctx.memory(|memory| memory.focused()) {
        Some(focused) => focused == response.id,
        None => response.hovered() && !has_selected_text(ctx),
    };
    if ctx.input(|input| input.events.contains(&Event::Copy)) && is_meant() {
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
