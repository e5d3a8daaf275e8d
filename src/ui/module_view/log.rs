//! Log: what happened to the module, and what was said to it.

mod rows;

use std::collections::BTreeSet;

use eframe::egui::{Panel, Ui};

use rows::{Mode, Rows, What};

use crate::bench::traffic::FrameRef;
use crate::bench::{Bench, Entry, EntryKind, Module};
use crate::capture;
use crate::ui::app::Pass;
use crate::ui::saving::{Contents, SaveAs};
use crate::ui::tables::{
    self, Act, Asked, CaptureFile, Cell, Column, EventsFile, Form, FramesFile, Line, Scroll, Selection, Sheet, Table,
    Wanted, meaning,
};
use crate::ui::{theme, widgets, words};

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Log {
    mode: Mode,
    kinds: BTreeSet<EntryKind>,
    only_errors: bool,
    text: String,
    rows: Rows,
    scroll: Scroll,
    selection: Selection,
}

impl Log {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        self.controls(ui, module, pass);
        self.filter_row(ui);
        let filter = rows::Filter {
            mode: self.mode,
            kinds: self.kinds.clone(),
            only_errors: self.only_errors,
            text: self.text.clone(),
        };
        if self.rows.set_filter(filter, module, pass.bench) {
            self.selection.clear();
        }
        if !self.rows.advance(module, pass.bench, self.scroll.paused) {
            ui.ctx().request_repaint();
        }
        ui.add_space(theme::UNIT);
        Panel::bottom(("log details", module.target.to_string()))
            .frame(theme::details_frame())
            .resizable(true)
            .default_size(theme::LOG_DETAILS)
            .size_range(theme::details_range(ui.available_height()))
            .show(ui, |ui| self.details(ui, module, pass.bench));
        if self.rows.len() == 0 {
            return self.nothing(ui);
        }
        match self.table(ui, module, pass.bench) {
            Some(Act::CopyChosen) => self.copy(ui, module, pass.bench, false),
            Some(Act::CopyAll) => self.copy(ui, module, pass.bench, true),
            None => {}
        }
    }

    fn controls(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        ui.horizontal(|ui| {
            for mode in Mode::ALL {
                if widgets::chip(ui, self.mode == mode, mode.label(), mode.label(), mode.means()) {
                    self.mode = mode;
                    self.scroll.at_end = true;
                }
            }
            ui.separator();
            let files: &[Wanted] = match self.mode {
                Mode::Events => &[Wanted::Events],
                Mode::Communication => &[Wanted::Frames],
                Mode::Both => &[Wanted::Events, Wanted::Frames],
            };
            let has_choice = self.selection.current().is_some();
            match tables::controls(ui, &mut self.scroll, has_choice, files) {
                Some(Asked::CopyChosen) => self.copy(ui, module, pass.bench, false),
                Some(Asked::CopyAll) => self.copy(ui, module, pass.bench, true),
                Some(Asked::Export(wanted, form)) => *pass.save = Some(self.export(module, pass.bench, wanted, form)),
                Some(Asked::Capture(form)) => *pass.save = Some(self.capture(module, pass.bench, form)),
                None => {}
            }
            let shown = self.rows.len();
            match self.mode {
                Mode::Events => tables::count(ui, shown, module.journal.len(), "event"),
                Mode::Communication => tables::count(ui, shown, shown, "frame"),
                Mode::Both => tables::count(ui, shown, shown, "row"),
            }
        });
    }

    fn filter_row(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = theme::UNIT;
            tables::search(ui, &mut self.text, "Search");
            if self.mode != Mode::Events
                && widgets::chip(ui, self.only_errors, "Only errors", "Only errors", meaning::ONLY_ERRORS)
            {
                self.only_errors = !self.only_errors;
            }
            if self.mode == Mode::Communication {
                return;
            }
            for kind in EntryKind::ALL {
                let is_chosen = self.kinds.contains(&kind);
                let chip = widgets::chip(ui, is_chosen, kind.label(), kind.label(), meaning::ONLY_KIND);
                if chip && !self.kinds.remove(&kind) {
                    self.kinds.insert(kind);
                }
            }
        });
    }

    fn table(&mut self, ui: &mut Ui, module: &Module, bench: &Bench) -> Option<Act> {
        let columns = self.columns(ui.available_width());
        let palette = theme::palette(ui);
        let (rows, mode) = (&self.rows, self.mode);
        let explain =
            |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
        let line = |row: usize| {
            let (key, what) = rows.get(row)?;
            let cells = match what {
                What::Event(number) => event_cells(rows::event(module, number)?, mode, palette),
                What::Frame(seq) => {
                    let frame = bench.traffic().get(seq)?;
                    let request = bench.traffic().request_of(seq);
                    let [time, way, _, bytes, meaning, took, state] =
                        tables::frame_look(&frame, request.as_ref(), &explain, palette);
                    vec![time, way, meaning, bytes, took, state]
                }
            };
            Some(Line { key, cells })
        };
        let table = Table { name: "Log", columns: &columns, rows: rows.len() };
        table.show(ui, &mut self.scroll, &mut self.selection, &|row| rows.get(row).map(|(key, _)| key), &line)
    }

    fn columns(&self, width: f32) -> Vec<Column> {
        let time = Column::new("Time", meaning::TIME, theme::TIME_COLUMN);
        let kind = Column::new("Kind", meaning::KIND, theme::STATE_COLUMN);
        if self.mode == Mode::Events {
            return vec![time, kind, Column::rest("Event", meaning::EVENT)];
        }
        let fixed = theme::TIME_COLUMN + 2.0 * theme::STATE_COLUMN + theme::TOOK_COLUMN + 6.0 * theme::GAP;
        vec![
            time,
            kind,
            Column::rest("Event or meaning", meaning::EVENT_OR_MEANING),
            Column::new("Bytes", meaning::BYTES, theme::bytes_width(width - fixed)),
            Column::number("Took", meaning::TOOK, theme::TOOK_COLUMN),
            Column::new("State", meaning::STATE, theme::STATE_COLUMN),
        ]
    }

    fn details(&self, ui: &mut Ui, module: &Module, bench: &Bench) {
        ui.set_min_size(ui.available_size());
        match self.selection.current().and_then(|key| self.rows.find(key)) {
            Some(What::Frame(seq)) => tables::frame_details(ui, bench, seq),
            Some(What::Event(number)) => match rows::event(module, number) {
                Some(entry) => {
                    let title = format!("{}  ·  {}", words::clock(entry.at), entry.kind.label());
                    tables::text_details(ui, &title, &entry.text);
                }
                None => drop(widgets::quiet(ui, "This event was forgotten: only the newest are kept.")),
            },
            None => drop(widgets::quiet(ui, "Click a row to see all of it.")),
        }
    }

    fn copy(&self, ui: &Ui, module: &Module, bench: &Bench, all: bool) {
        let is_meant = |key: u64| all || self.selection.contains(key);
        let rows = (0..self.rows.len()).filter_map(|row| self.rows.get(row)).filter(|(key, _)| is_meant(*key));
        let mut sheet = Sheet::new(["Time (UTC)", "Kind", "Event or meaning", "Address", "Bytes", "Took", "State"]);
        for (_, what) in rows.take(tables::MOST_COPIED) {
            match what {
                What::Event(number) => {
                    let Some(entry) = rows::event(module, number) else { continue };
                    sheet.push([&format!("{:.6}", entry.at), entry.kind.label(), &entry.text, "", "", "", ""]);
                }
                What::Frame(seq) => {
                    let Some(row) = tables::frame_row(bench, seq) else { continue };
                    let [time, way, address, bytes, meaning, took, state] = &row;
                    sheet.push([time, way, meaning, address, bytes, took, state]);
                }
            }
        }
        sheet.copy(ui.ctx());
    }

    fn export(&self, module: &Module, bench: &Bench, wanted: Wanted, form: Form) -> SaveAs {
        let shown = || (0..self.rows.len()).filter_map(|row| self.rows.get(row)).map(|(_, what)| what);
        let events = || shown().filter_map(|what| if let What::Event(number) = what { Some(number) } else { None });
        let (what, contents): (_, Box<dyn Contents>) = match wanted {
            Wanted::Events => {
                let entries: Vec<Entry> = events().filter_map(|number| rows::event(module, number).cloned()).collect();
                ("events", Box::new(EventsFile::new(form, entries)))
            }
            Wanted::Frames => ("frames", Box::new(FramesFile::new(form, self.shown_frames()))),
        };
        save_as(module, bench, what, form.ending(), contents)
    }

    fn capture(&self, module: &Module, bench: &Bench, form: capture::Form) -> SaveAs {
        let contents = CaptureFile::new(form, self.shown_frames());
        save_as(module, bench, "frames", form.ending(), Box::new(contents))
    }

    fn shown_frames(&self) -> impl Iterator<Item = u64> {
        let shown = (0..self.rows.len()).filter_map(|row| self.rows.get(row));
        shown.filter_map(|(_, what)| if let What::Frame(seq) = what { Some(seq) } else { None })
    }

    fn nothing(&self, ui: &mut Ui) {
        let palette = theme::palette(ui);
        let has_filter = !self.text.trim().is_empty() || !self.kinds.is_empty() || self.only_errors;
        let lines: &[&str] = match self.mode {
            _ if has_filter => &["Take back the search or the chosen kinds above to see the rest."],
            Mode::Events => {
                &["What happens to the module appears here: found and lost, motion, alarms, values written."]
            }
            _ => &["Every frame to and from this module appears here, with its bytes and meaning."],
        };
        widgets::empty_state(ui, palette, if has_filter { "Nothing fits the filter" } else { "Nothing yet" }, lines);
    }
}

/// Time, kind and text; in the columns of frames nothing.
fn event_cells(entry: &Entry, mode: Mode, palette: &theme::Palette) -> Vec<Cell> {
    let (glyph, colour) = tables::kind_mark(entry.kind, palette);
    let mut cells = vec![
        Cell::new(words::clock(entry.at), palette.quiet),
        Cell::new(entry.kind.label(), palette.text).marked(glyph, colour),
        Cell::new(&entry.text, palette.text),
    ];
    if mode != Mode::Events {
        cells.extend((0..3).map(|_| Cell::new("", palette.text)));
    }
    cells
}

fn save_as(module: &Module, bench: &Bench, what: &str, ending: &str, contents: Box<dyn Contents>) -> SaveAs {
    let (label, address) = (module.label().to_lowercase(), module.target.address);
    let time = words::for_file(bench.now());
    SaveAs { title: format!("Export {what}"), name: format!("{label}-{address}-{what}-{time}.{ending}"), contents }
}
