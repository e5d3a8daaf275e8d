//! Summary: everything about the module on one page, compared with its factory settings.

use eframe::egui::{Align, Checkbox, Color32, Rect, RichText, ScrollArea, Sense, Ui, pos2, vec2};
use jiff::{Timestamp, tz::TimeZone};

use super::explanation::explanation;
use super::{item_sheet, theme};
use crate::bench::summary::{self, Entry, Group};
use crate::bench::{Action, Module, Presence, Severity};
use crate::ui::app::Pass;
use crate::ui::picture::{self, Look};
use crate::ui::saving::{SaveAs, WholeText};
use crate::ui::tables::{Part, copied};
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Summary {
    only_different: bool,
}

impl Summary {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        let summary = summary::Summary::of(module, pass.bench.now());
        ui.horizontal(|ui| {
            exports(ui, &summary, pass);
            let text = "Only what differs from factory";
            let means = "Leaves out what is as the module leaves the factory, and what the manual does not tell";
            let mut check = |ui: &mut Ui| ui.add(Checkbox::new(&mut self.only_different, text)).on_hover_text(means);
            widgets::at_right(ui, |ui| drop(check(ui)));
        });
        ui.add_space(theme::GAP);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.set_max_width(theme::TAB_WIDTH.min(ui.available_width()));
            if !self.only_different {
                facts(ui, &summary);
                pictures(ui, module, &summary);
            }
            self.table(ui, module, &summary, pass.bench.now());
        });
    }

    fn table(&self, ui: &mut Ui, module: &Module, summary: &summary::Summary, now: Timestamp) {
        if self.only_different {
            let text = format!("{}. The manual does not tell every factory setting.", summary.comparison());
            widgets::quiet(ui, &text);
        }
        ui.spacing_mut().item_spacing.y = 0.0;
        for group in &summary.groups {
            let entries: Vec<&Entry> =
                group.entries.iter().filter(|entry| entry.differs || !self.only_different).collect();
            if !entries.is_empty() {
                heading(ui, group);
                entries.into_iter().for_each(|entry| row(ui, module, entry, now));
            }
        }
        ui.add_space(theme::GAP);
    }
}

fn exports(ui: &mut Ui, summary: &summary::Summary, pass: &mut Pass<'_>) {
    if ui.button("Copy as text").on_hover_text("With aligned columns, such as for an e-mail").clicked() {
        ui.ctx().copy_text(summary.to_text());
        pass.actions.push(Action::Notify(Severity::Info, "The summary was copied as text".to_owned()));
    }
    if ui.button("Save as HTML…").on_hover_text("One page with the pictures, to hand on or to print").clicked() {
        save_as(pass, "Save as HTML", summary.file_name("html"), summary.to_html());
    }
    if ui.button("Save as JSON…").on_hover_text("Values by their names, for programs").clicked() {
        match summary.to_json() {
            Ok(text) => save_as(pass, "Save as JSON", summary.file_name("json"), text),
            Err(error) => {
                let text = format!("The summary was not saved ({error}) – save it as HTML instead");
                pass.actions.push(Action::Notify(Severity::Error, text));
            }
        }
    }
}

fn save_as(pass: &mut Pass<'_>, title: &str, name: String, text: String) {
    let contents = Box::new(WholeText { what: "The summary was".to_owned(), text });
    *pass.save = Some(SaveAs { title: title.to_owned(), name, contents });
}

/// In two columns, read downwards.
fn facts(ui: &mut Ui, summary: &summary::Summary) {
    let mut facts = summary.facts(&TimeZone::system());
    // The time of drawing up is that of the frame.
    facts.retain(|(name, _)| *name != "Drawn up");
    let rows = facts.len().div_ceil(2);
    let (left, right) = facts.split_at(rows.min(facts.len()));
    ui.spacing_mut().interact_size.y = theme::SUMMARY_ROW;
    for (index, fact) in left.iter().enumerate() {
        ui.horizontal(|ui| {
            one_fact(ui, fact, theme::SUMMARY_FACT);
            if let Some(fact) = right.get(index) {
                let rest = ui.available_width() - theme::SUMMARY_NAME - 2.0 * theme::GAP;
                one_fact(ui, fact, rest.max(0.0));
            }
        });
    }
    ui.add_space(theme::GAP);
}

fn one_fact(ui: &mut Ui, (name, fact): &(&'static str, String), width: f32) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(theme::SUMMARY_NAME, theme::SUMMARY_ROW), Sense::hover());
    widgets::line_in(ui, rect, Align::Min, name, theme::body(), palette.quiet);
    let (rect, response) = ui.allocate_exact_size(vec2(width, theme::SUMMARY_ROW), Sense::hover());
    widgets::line_in(ui, rect, Align::Min, fact, theme::body(), palette.text);
    widgets::describe(&response, eframe::egui::Role::Label, &format!("{name}: {fact}"));
    response.on_hover_text(fact);
}

fn pictures(ui: &mut Ui, module: &Module, summary: &summary::Summary) {
    let faded = matches!(module.presence, Presence::Silent { .. });
    let (switches, face) = (summary.switch_picture(), summary.face_picture());
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP_SECTION;
        if let Some(picture) = &switches {
            ui.vertical(|ui| {
                let width = picture.size[0];
                ui.set_width(width.max(theme::SUMMARY_NOTES));
                picture::show(ui, picture, &Look { width, name: "Switches", faded, clicks: &[] });
                for note in &summary.switches.notes {
                    ui.add_space(theme::UNIT);
                    let text = RichText::new(note).small().color(theme::palette(ui).quiet);
                    ui.add(eframe::egui::Label::new(text).wrap());
                }
            });
        }
        if let Some(picture) = &face {
            picture::show(ui, picture, &Look { width: theme::FACE_WIDTH, name: "Sensor", faded, clicks: &[] });
        }
    });
}

/// Where the columns of a row lie.
struct Columns {
    name: Rect,
    value: Rect,
    unit: Rect,
    factory: Rect,
    mark: Rect,
    remark: Rect,
    read: Rect,
    /// From the mark to the end.
    rest: Rect,
}

impl Columns {
    fn of(row: Rect) -> Self {
        let mut left = row.left();
        let mut column = |width: f32, gap: f32| {
            let room = Rect::from_min_max(pos2(left, row.top()), pos2((left + width).min(row.right()), row.bottom()));
            left += width + gap;
            room
        };
        let name = column(theme::SUMMARY_LABEL, theme::GAP);
        let value = column(theme::SUMMARY_VALUE, theme::UNIT);
        let unit = column(theme::FORM_UNIT, theme::GAP);
        let factory = column(theme::SUMMARY_FACTORY, theme::GAP);
        let mark = column(theme::GLYPH, theme::GAP);
        let remark = column(theme::SUMMARY_REMARK, theme::GAP);
        let read = Rect::from_min_max(remark.right_top() + vec2(theme::GAP, 0.0), row.right_bottom());
        let rest = Rect::from_min_max(remark.min, row.max);
        Self { name, value, unit, factory, mark, remark, read, rest }
    }
}

const COLUMNS: &str = "Value: what the module said last. Factory: as it leaves the factory, where the manual tells. Read: how \
                       long ago it said so";

fn heading(ui: &mut Ui, group: &Group) {
    let palette = theme::palette(ui);
    ui.add_space(theme::GAP_SECTION - theme::UNIT);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::CONTROL_HEIGHT), Sense::hover());
    let columns = Columns::of(rect);
    widgets::line_in(ui, columns.name, Align::Min, &group.label, theme::heading(), palette.text);
    let titles = [
        (columns.value, Align::Max, "Value"),
        (columns.factory, Align::Min, "Factory"),
        (columns.read, Align::Min, "Read"),
    ];
    for (rect, align, title) in titles {
        widgets::line_in(ui, rect, align, title, theme::small(), palette.quiet);
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), eframe::egui::Stroke::new(theme::HAIRLINE, palette.line));
    widgets::describe(&response, eframe::egui::Role::Label, &format!("Group {}", group.label));
    response.on_hover_text(COLUMNS);
}

/// What stands behind the value: a mark, words beside it, when it was read.
struct Remark {
    glyph: Option<(Glyph, Color32)>,
    text: String,
    read: String,
}

fn row(ui: &mut Ui, module: &Module, entry: &Entry, now: Timestamp) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::SUMMARY_ROW), Sense::hover());
    let remark = remark(ui, module, entry, now);
    widgets::describe(&response, eframe::egui::Role::Label, &told(entry, &remark));
    if !ui.is_rect_visible(rect) {
        return;
    }
    if response.hovered() {
        ui.painter().rect_filled(rect, 0.0, palette.raised);
    }
    let columns = Columns::of(rect);
    let known = entry.value.is_some();
    let colour = if !known || entry.problem.is_some() { palette.old } else { palette.text };
    let line = |rect, align, text: &str, colour| {
        widgets::line_in(ui, rect, align, text, theme::body(), colour);
    };
    line(columns.name, Align::Min, &entry.label, palette.quiet);
    line(columns.value, Align::Max, &entry.text, colour);
    line(columns.unit, Align::Min, if known { &entry.unit } else { "" }, palette.quiet);
    line(columns.factory, Align::Min, &entry.factory_text, palette.quiet);
    if let Some((glyph, colour)) = remark.glyph {
        widgets::paint_glyph(ui.painter(), glyph, columns.mark.center(), theme::GLYPH, colour);
        // Without an age there is more room.
        let room = if remark.read.is_empty() { columns.rest } else { columns.remark };
        line(room, Align::Min, &remark.text, colour);
    }
    line(columns.read, Align::Min, &remark.read, palette.old);
    let problem = entry.problem.as_ref().map(|problem| format!("{problem}\n")).unwrap_or_default();
    copied(&response, |part| match (part, module.item(&entry.id)) {
        (Part::Row, Some(item)) => item_sheet::sheet(module, [item]),
        _ => item_sheet::whole(module),
    });
    response.on_hover_ui(|ui| {
        let help = module.item(&entry.id).map(|item| explanation(module, item)).unwrap_or_default();
        ui.label(format!("{problem}{help}"));
    });
}

fn remark(ui: &Ui, module: &Module, entry: &Entry, now: Timestamp) -> Remark {
    let palette = theme::palette(ui);
    let failure = module.reading(&entry.id).and_then(|reading| reading.problem.as_ref()).map(words::not_read);
    let (glyph, text) = match &entry.problem {
        _ if module.edit(&entry.id).is_some() => (Some((Glyph::Edited, palette.accent)), "changed, not written"),
        Some(problem) if failure.is_some() => {
            (Some((Glyph::Cross, palette.error)), failure.as_deref().unwrap_or(problem.as_str()))
        }
        Some(problem) => (Some((Glyph::Dashes, palette.quiet)), problem.as_str()),
        None if entry.differs => (Some((Glyph::Disc, palette.accent)), "differs from factory"),
        None => (None, ""),
    };
    Remark { glyph, text: text.to_owned(), read: read(module, entry, now) }
}

/// Values that are polled change their age all the time and are as fresh as they can be.
fn read(module: &Module, entry: &Entry, now: Timestamp) -> String {
    let Some(at) = entry.at else { return String::new() };
    let live = module.item(&entry.id).is_some_and(|item| item.live);
    if live && module.interval.is_some() && entry.problem.is_none() {
        return "polled".to_owned();
    }
    format!("{} ago", words::age(words::since(at, now)))
}

/// `Address: 5, factory 1, differs from factory, 4 s ago`.
fn told(entry: &Entry, remark: &Remark) -> String {
    let unit = if entry.unit.is_empty() || entry.value.is_none() { String::new() } else { format!(" {}", entry.unit) };
    let mut text = format!("{}: {}{unit}", entry.label, entry.text);
    if !entry.factory_text.is_empty() {
        text.push_str(&format!(", factory {}", entry.factory_text));
    }
    for part in [&remark.text, &remark.read].into_iter().filter(|part| !part.is_empty()) {
        text.push_str(&format!(", {part}"));
    }
    text
}
