//! One article. Of a long one only the blocks in view are laid out.

use eframe::egui::{Align, FontId, Frame, Label, Layout, Margin, RichText, ScrollArea, Stroke, Ui, pos2, vec2};

use super::text::{self, Style};
use crate::help::Article;
use crate::help::markdown::{Block, Column, Document, Mark, Span};
use crate::ui::tables::{Part, Sheet, copied_row};
use crate::ui::theme::{self, Palette};

/// What is remembered between frames.
#[derive(Default)]
pub struct ArticleView {
    /// Article and width for which the heights are known.
    laid_out: (String, f32),
    /// Of each block, as far as it was drawn.
    heights: Vec<Option<f32>>,
    /// The block that is to come to the top.
    to_top: Option<usize>,
}

impl ArticleView {
    pub fn scroll_to(&mut self, block: usize) {
        self.to_top = Some(block);
    }

    /// The articles have changed.
    pub fn forget(&mut self) {
        self.laid_out = Default::default();
    }

    /// Draws the article; the link that was clicked. `words` are marked.
    pub fn show(&mut self, ui: &mut Ui, article: &Article, words: &[String]) -> Option<String> {
        let mut clicked = None;
        ScrollArea::vertical().id_salt("article").auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let now = (article.id.clone(), ui.available_width());
            if self.laid_out != now {
                self.heights = vec![None; article.document.blocks.len()];
                self.laid_out = now;
            }
            for (index, block) in article.document.blocks.iter().enumerate() {
                let first = index == 0;
                let top = ui.cursor().top();
                let known = self.heights.get(index).copied().flatten();
                let rect = ui.cursor().with_max_y(top + known.unwrap_or_default());
                if known.is_some() && !ui.clip_rect().intersects(rect) {
                    ui.allocate_space(rect.size().min(vec2(ui.available_width(), f32::INFINITY)));
                } else {
                    let tables = &article.document.tables;
                    let shown = ui.scope(|ui| show_block(ui, block, tables, words, first));
                    clicked = shown.inner.or(clicked.take());
                    if let Block::Row { table, .. } = block {
                        let id = ui.scope_id().with(("row", index));
                        copied_row(ui, shown.response.rect, id, |part| {
                            sheet(&article.document, *table, (part == Part::Row).then_some(index))
                        });
                    }
                    if let Some(height) = self.heights.get_mut(index) {
                        *height = Some(ui.cursor().top() - top);
                    }
                }
                if self.to_top == Some(index) {
                    let rect = rect.with_max_y(ui.cursor().top());
                    // A row of a table is understood by its neighbours.
                    let row = matches!(block, Block::Row { .. });
                    ui.scroll_to_rect(rect, Some(if row { Align::Center } else { Align::TOP }));
                }
            }
            ui.add_space(theme::GAP_SECTION);
        });
        if self.to_top.take().is_some() {
            ui.ctx().request_repaint();
        }
        clicked
    }
}

fn show_block(ui: &mut Ui, block: &Block, tables: &[Vec<Column>], words: &[String], first: bool) -> Option<String> {
    let palette = theme::palette(ui);
    let style = |font: FontId, bold: bool| Style { font, colour: palette.text, bold, words };
    match block {
        Block::Heading(level, spans) => {
            ui.add_space(match level {
                _ if first => 0.0,
                1 | 2 => theme::GAP_SECTION,
                _ => theme::GAP,
            });
            let font = if *level == 1 { theme::heading() } else { theme::body() };
            let clicked = in_width(ui, |ui| text::show(ui, spans, &style(font, true)));
            ui.add_space(theme::UNIT);
            clicked
        }
        Block::Paragraph(spans) => {
            let clicked = in_width(ui, |ui| text::show(ui, spans, &style(theme::body(), false)));
            ui.add_space(theme::GAP);
            clicked
        }
        Block::Item(mark, spans) => {
            let clicked = in_width(ui, |ui| item(ui, *mark, spans, &style(theme::body(), false)));
            ui.add_space(theme::UNIT);
            clicked
        }
        Block::Row { table, head, cells } => {
            let columns = tables.get(*table).map(Vec::as_slice).unwrap_or_default();
            let font = if *head { theme::small() } else { theme::body() };
            let colour = if *head { palette.quiet } else { palette.text };
            row(ui, cells, columns, &Style { colour, ..style(font, false) }, palette)
        }
        Block::Code(text) => {
            code(ui, text, palette);
            None
        }
    }
}

/// A table as it is copied; with `only`, of its rows that block alone.
fn sheet(document: &Document, table: usize, only: Option<usize>) -> Sheet {
    let plain = |cells: &[Vec<Span>]| -> Vec<String> {
        cells.iter().map(|cell| cell.iter().map(|span| span.text.as_str()).collect()).collect()
    };
    let mut head = Vec::new();
    let mut rows = Vec::new();
    for (index, block) in document.blocks.iter().enumerate() {
        let Block::Row { table: known, head: is_head, cells } = block else { continue };
        if *known == table && *is_head {
            head = plain(cells);
        } else if *known == table && only.is_none_or(|only| only == index) {
            rows.push(plain(cells));
        }
    }
    let mut sheet = Sheet::new(head);
    rows.into_iter().for_each(|row| sheet.push(row));
    sheet
}

/// Text is hard to follow in lines that are too long.
fn in_width<T>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> T) -> T {
    ui.scope(|ui| {
        ui.set_max_width(ui.available_width().min(theme::HELP_TEXT));
        contents(ui)
    })
    .inner
}

fn item(ui: &mut Ui, mark: Mark, spans: &[Span], style: &Style<'_>) -> Option<String> {
    let mark = match mark {
        Mark::Bullet => "•".to_owned(),
        Mark::Number(number) => format!("{number}."),
    };
    let layout = Layout::left_to_right(Align::Min);
    ui.with_layout(layout, |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.allocate_ui_with_layout(vec2(theme::HELP_MARK, 0.0), Layout::top_down(Align::Min), |ui| {
            ui.set_width(theme::HELP_MARK);
            ui.add(Label::new(RichText::new(mark).color(theme::palette(ui).quiet)));
        });
        ui.vertical(|ui| text::show(ui, spans, style)).inner
    })
    .inner
}

fn row(ui: &mut Ui, cells: &[Vec<Span>], columns: &[Column], style: &Style<'_>, palette: &Palette) -> Option<String> {
    let widths = widths(columns, ui.available_width() - theme::GAP);
    let mut clicked = None;
    let row = ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
        ui.spacing_mut().item_spacing.x = theme::HELP_COLUMN_GAP;
        for (cell, width) in cells.iter().zip(&widths) {
            ui.allocate_ui_with_layout(vec2(*width, 0.0), Layout::top_down(Align::Min), |ui| {
                ui.set_width(*width);
                ui.add_space(theme::UNIT);
                clicked = text::show(ui, cell, style).or(clicked.take());
                ui.add_space(theme::UNIT);
            });
        }
    });
    let (rect, edge) = (row.response.rect, Stroke::new(theme::HAIRLINE, palette.line));
    let right = rect.left() + widths.iter().map(|width| width + theme::HELP_COLUMN_GAP).sum::<f32>();
    ui.painter().line_segment([rect.left_bottom(), pos2(right, rect.bottom())], edge);
    clicked
}

/// How wide each column is: as wide as its cells if there is room, else no word is broken unless there is no other way.
fn widths(columns: &[Column], room: f32) -> Vec<f32> {
    let count = columns.len() as f32;
    let room = (room - theme::HELP_COLUMN_GAP * count).max(1.0);
    let wide = |characters: usize| characters as f32 * theme::HELP_CHARACTER + theme::GAP;
    let wanted: Vec<f32> = columns.iter().map(|column| wide(column.cell)).collect();
    let all: f32 = wanted.iter().sum();
    if all <= room {
        return wanted;
    }
    let least: Vec<f32> = columns.iter().map(|column| wide(column.word.min(theme::HELP_WORD))).collect();
    let needed: f32 = least.iter().sum();
    if needed >= room {
        return least.iter().map(|width| width * room / needed).collect();
    }
    // The rest goes where there is most to say, but long texts do not starve short ones.
    let more: Vec<f32> = wanted.iter().zip(&least).map(|(wanted, least)| (wanted - least).max(0.0).powf(0.7)).collect();
    let all_more = more.iter().sum::<f32>().max(1.0);
    least.iter().zip(more).map(|(least, more)| least + (room - needed) * more / all_more).collect()
}

fn code(ui: &mut Ui, text: &str, palette: &Palette) {
    ui.add_space(theme::UNIT);
    Frame::new().fill(palette.panel).inner_margin(Margin::same(8)).show(ui, |ui| {
        ui.set_width(ui.available_width().min(theme::HELP_TEXT));
        ui.add(Label::new(RichText::new(text).font(theme::mono()).color(palette.text)).wrap());
    });
    ui.add_space(theme::GAP);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_fill_the_room_and_no_more() {
        let columns = [(3, 3), (12, 40), (9, 200)].map(|(word, cell)| Column { word, cell });
        let natural = widths(&columns, 5000.0);
        assert!(natural.windows(2).all(|pair| pair[0] < pair[1]));
        for room in [300.0, 600.0, 900.0] {
            let all: f32 = widths(&columns, room).iter().map(|width| width + theme::HELP_COLUMN_GAP).sum();
            assert!((all - room).abs() < 1.0, "{all} of {room}");
        }
        let narrow = widths(&columns, 60.0);
        assert!(narrow.iter().sum::<f32>() <= 60.0 && widths(&[], 60.0).is_empty());
    }
}
