//! What happened: a list that can be searched, linked with the plots.

mod file;
mod rows;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use eframe::egui::{Color32, Ui};

use super::Source;
use crate::record::{
    Event, EventKind, History, Micros, ModuleId, ModuleInfo, micros, micros_of, module_names, seconds,
};
use crate::ui::app::Pass;
use crate::ui::saving::SaveAs;
use crate::ui::tables::{self, Act, Asked, Cell, Column, Form, Line, Scroll, Selection, Sheet, Table, Wanted, meaning};
use crate::ui::theme::{self, Palette};
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;
use file::EventsFile;
use rows::{Filter, Rows};

const ALL_MODULES: &str = "All modules";

/// What the list remembers between frames.
#[derive(Default)]
pub struct EventList {
    filter: Filter,
    /// Only what happened in the span that the plots show.
    only_in_view: bool,
    rows: Rows,
    scroll: Scroll,
    selection: Selection,
    names: Names,
}

/// The modules' names, found anew only when a module is described in another way.
#[derive(Default)]
struct Names {
    of: Vec<ModuleInfo>,
    names: Arc<BTreeMap<ModuleId, String>>,
}

impl Names {
    fn of(&mut self, history: &History) -> Arc<BTreeMap<ModuleId, String>> {
        if !history.modules().map(|(_, info)| info).eq(&self.of) {
            self.of = history.modules().map(|(_, info)| info.clone()).collect();
            self.names = Arc::new(module_names(history));
        }
        self.names.clone()
    }
}

/// How the rows of one frame look.
struct Look<'a> {
    names: &'a BTreeMap<ModuleId, String>,
    palette: &'a Palette,
    utc: bool,
    view: [Micros; 2],
    /// The place of the row nearest to the middle of the view.
    nearest: Option<usize>,
}

impl EventList {
    /// Shows the list; `view` is the span that the plots show. Returns the time that the user wants to see, in seconds since
    /// 1970 UTC.
    pub fn show(&mut self, ui: &mut Ui, source: &Source<'_>, view: [f64; 2], pass: &mut Pass<'_>) -> Option<f64> {
        let names = self.names.of(source.history);
        let view = view.map(micros);
        if self.rows.set_filter(&self.filter) {
            self.selection.clear();
        }
        let is_done = self.rows.advance(source.history, &names, self.scroll.paused);
        self.controls(ui, source, &names, view, pass);
        self.filter_row(ui);
        if !is_done || *self.rows.filter() != self.filter {
            ui.ctx().request_repaint();
        }
        let shown = self.shown(view);
        if shown.is_empty() {
            self.nothing(ui);
            return None;
        }
        let [from, to] = view;
        let nearest = self.rows.nearest(from.midpoint(to));
        let look = Look { names: &names, palette: theme::palette(ui), utc: pass.settings.utc, view, nearest };
        match self.table(ui, source, &shown, &look) {
            Some(Act::CopyChosen) => self.copy(ui, source, &names, &shown, false),
            Some(Act::CopyAll) => self.copy(ui, source, &names, &shown, true),
            None => {}
        }
        let chosen = self.selection.take_new().and_then(|key| self.rows.find(key));
        chosen.and_then(|row| rows::event(source.history, row.number)).map(|event| seconds(micros_of(event.at)))
    }

    /// The places of the rows that are listed.
    fn shown(&self, view: [Micros; 2]) -> Range<usize> {
        if self.only_in_view { self.rows.within(view) } else { 0..self.rows.len() }
    }

    fn controls(
        &mut self,
        ui: &mut Ui,
        source: &Source<'_>,
        names: &BTreeMap<ModuleId, String>,
        view: [Micros; 2],
        pass: &mut Pass<'_>,
    ) {
        ui.horizontal(|ui| {
            let has_choice = self.selection.current().is_some();
            let shown = self.shown(view);
            match tables::controls(ui, &mut self.scroll, has_choice, &[Wanted::Events]) {
                Some(Asked::CopyChosen) => self.copy(ui, source, names, &shown, false),
                Some(Asked::CopyAll) => self.copy(ui, source, names, &shown, true),
                Some(Asked::Export(_, form)) => *pass.save = Some(self.export(source, pass, &shown, form)),
                // Of frames only.
                Some(Asked::Capture(_)) | None => {}
            }
            ui.separator();
            tables::search(ui, &mut self.filter.text, "Search");
            self.module_choice(ui, names);
            tables::count(ui, shown.len(), source.history.events().len(), "event");
        });
    }

    fn module_choice(&mut self, ui: &mut Ui, names: &BTreeMap<ModuleId, String>) {
        let chosen = self.filter.module.and_then(|module| names.get(&module)).map_or(ALL_MODULES, String::as_str);
        let combo = widgets::combo("events of", theme::MODULE_COLUMN, chosen).show_ui(ui, |ui| {
            ui.selectable_value(&mut self.filter.module, None, ALL_MODULES);
            for (id, name) in names {
                ui.selectable_value(&mut self.filter.module, Some(*id), name);
            }
        });
        widgets::name_combo(&combo.response, "Events of", chosen);
        combo.response.on_hover_text("Only what happened with this module");
    }

    fn filter_row(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = theme::UNIT;
            let means = "Only what happened within the time that the plots show";
            if widgets::chip(ui, self.only_in_view, "In view", "Only the span in view", means) {
                self.only_in_view = !self.only_in_view;
            }
            for kind in EventKind::ALL {
                let is_chosen = self.filter.kinds.contains(&kind);
                let chip = widgets::chip(ui, is_chosen, kind.label(), kind.label(), meaning::ONLY_KIND);
                if chip && !self.filter.kinds.remove(&kind) {
                    self.filter.kinds.insert(kind);
                }
            }
        });
    }

    fn table(&mut self, ui: &mut Ui, source: &Source<'_>, shown: &Range<usize>, look: &Look<'_>) -> Option<Act> {
        let time = if look.utc { "Time (UTC)" } else { "Time" };
        let columns = [
            Column::new(time, meaning::TIME, theme::MOMENT_COLUMN),
            Column::new("Module", meaning::MODULE, theme::MODULE_COLUMN),
            Column::new("Kind", meaning::KIND, theme::STATE_COLUMN),
            Column::rest("Event", meaning::EVENT),
        ];
        let rows = &self.rows;
        let at = |row: usize| rows.get(shown.start.saturating_add(row));
        let line = |row: usize| {
            let place = shown.start.saturating_add(row);
            let found = rows.get(place)?;
            let cells = look.cells(rows::event(source.history, found.number)?, look.nearest == Some(place));
            Some(Line { key: found.key, cells })
        };
        let table = Table { name: "Events", columns: &columns, rows: shown.len() };
        table.show(ui, &mut self.scroll, &mut self.selection, &|row| at(row).map(|found| found.key), &line)
    }

    fn copy(&self, ui: &Ui, source: &Source<'_>, names: &BTreeMap<ModuleId, String>, shown: &Range<usize>, all: bool) {
        let rows = shown.clone().filter_map(|place| self.rows.get(place));
        let meant = rows.filter(|row| all || self.selection.contains(row.key));
        let events = meant.filter_map(|row| rows::event(source.history, row.number));
        let mut sheet = Sheet::new(["Time (UTC)", "Module", "Kind", "Event"]);
        for event in events.take(tables::MOST_COPIED) {
            let module = event.module.and_then(|module| names.get(&module)).map_or("", String::as_str);
            sheet.push([&format!("{:.6}", event.at), module, event.kind.label(), &event.text]);
        }
        sheet.copy(ui.ctx());
    }

    fn export(&self, source: &Source<'_>, pass: &Pass<'_>, shown: &Range<usize>, form: Form) -> SaveAs {
        let numbers = shown.clone().filter_map(|place| self.rows.get(place)).map(|row| row.number).collect();
        let zone = words::zone(pass.settings.utc);
        let contents = EventsFile { form, recording: source.recording, zone, numbers, done: 0 };
        let time = words::for_file(pass.bench.now());
        SaveAs {
            title: "Export events".to_owned(),
            name: format!("{}-events-{time}.{}", source.name, form.ending()),
            contents: Box::new(contents),
        }
    }

    fn nothing(&self, ui: &mut Ui) {
        let palette = theme::palette(ui);
        if self.rows.filter().is_empty() && !self.only_in_view {
            let lines = ["Motion, relays, alarms, modules found and lost, values written and notes appear here."];
            return widgets::empty_state(ui, palette, "Nothing happened yet", &lines);
        }
        let lines = ["Take back the search, the chosen kinds or the span to see the rest."];
        widgets::empty_state(ui, palette, "Nothing fits the filter", &lines);
    }
}

impl Look<'_> {
    /// Time, module, kind and text; grey outside the view.
    fn cells(&self, event: &Event, is_nearest: bool) -> Vec<Cell> {
        let Self { names, palette, utc, view: [from, to], .. } = self;
        let is_in_view = (*from..=*to).contains(&micros_of(event.at));
        let (glyph, colour) = tables::kind_mark(event.kind, palette);
        let tone = |colour: Color32| if is_in_view { colour } else { palette.old };
        let pointer = if is_nearest { palette.accent } else { theme::NO_COLOUR };
        let module = event.module.and_then(|module| names.get(&module)).map_or("", String::as_str);
        vec![
            Cell::new(words::moment(event.at, *utc), tone(palette.quiet)).marked(Glyph::Sent, pointer),
            Cell::new(module, tone(palette.text)),
            Cell::new(event.kind.label(), tone(palette.text)).marked(glyph, tone(colour)),
            Cell::new(&event.text, tone(palette.text)),
        ]
    }
}
