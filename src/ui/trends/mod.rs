//! The trends: any series of any modules on one axis of time, live or of a recording, and what happened meanwhile.
//!
//! `area` draws stacked plots on the axis of time that `window` moves; `choice` says what is shown where, `curve` how a
//! series looks and reads, `model` what one plot consists of. Around it stand `chooser`, `tools`, `table` and `events`.

mod area;
mod axis;
mod choice;
mod chooser;
mod cursors;
mod curve;
mod drawing;
mod events;
pub mod export;
mod layout;
mod legend;
mod limits;
mod markers;
pub mod measure;
mod model;
mod note;
mod number_plot;
mod picture;
mod pointer;
mod scene;
mod source;
mod strip;
mod table;
#[cfg(test)]
mod testing;
mod tools;
mod window;

use eframe::egui::{Panel, Rangef, Ui};
use jiff::Timestamp;

use super::app::Pass;
use super::plot::{TimeView, Zone};
use super::{theme, widgets, words};
use crate::bench::{Action, Bench};
use area::{Area, Asked};
use choice::Shown;
use chooser::Chooser;
use curve::Curve;
use events::EventList;
use note::NoteField;
use picture::Pictures;
use scene::Scene;
pub use source::Source;
use table::Table;

/// What a trend view remembers between frames.
#[derive(Default)]
pub struct TrendView {
    area: Area,
    chooser: Chooser,
    note: NoteField,
    pictures: Pictures,
    events: EventList,
    /// The user wants to export readings.
    export: bool,
    table_open: bool,
    events_open: bool,
    /// A recording is shown as a whole when it is opened.
    seen: bool,
}

impl TrendView {
    pub fn show(&mut self, ui: &mut Ui, source: &Source<'_>, pass: &mut Pass<'_>) {
        let Some(known) = known(source, pass.bench) else { return nothing_yet(ui, source, pass) };
        if !std::mem::replace(&mut self.seen, true) && !source.is_live() {
            self.area.window.all(known);
        }
        let kept = if source.is_live() { pass.settings.trend_series.as_slice() } else { &[] };
        self.area.choice.keep_up(source.history, pass.settings.temperature, kept);

        let (room, height) = (ui.available_width(), ui.available_height());
        tools::show(ui, self, pass.settings, known);
        ui.add_space(theme::UNIT);
        let scene = Scene {
            history: source.history,
            bench: source.is_live().then_some(pass.bench),
            view: self.area.window.view(known, Rangef::new(0.0, room)),
            zone: Zone::of(pass.settings.utc),
            pointer: self.area.pointer,
        };
        if std::mem::take(&mut self.export) {
            let shown = self.area.choice.shown().iter().filter(|shown| !shown.hidden);
            let view = Some([scene.view.from, scene.view.to]);
            let plots = export::InPlots {
                series: shown.map(|shown| shown.id).collect(),
                view,
                cursors: self.area.cursors.span(),
            };
            export::ask(source, plots, pass);
        }
        self.list_events(ui, source, &scene.view, height, pass);
        self.tell_values(ui, &scene, height);
        self.choose(ui, &scene, pass, room);
        let name = format!("{}-{}", source.name, words::for_file(pass.bench.now()));
        let Self { pictures, area, .. } = self;
        pictures.go_on(ui, area.rect, &name, pass, || drawing::drawing(area, &scene, &source.name));
        self.area.posing = self.pictures.is_under_way();
        self.plots(ui, scene, known, pass);
        self.keep_choice(source, pass);
    }

    fn choose(&mut self, ui: &mut Ui, scene: &Scene<'_>, pass: &Pass<'_>, room: f32) {
        if !self.chooser.is_open(room) {
            return;
        }
        let panel = Panel::left("series").frame(theme::beside_frame()).resizable(true);
        panel.default_size(theme::CHOOSER).size_range(theme::CHOOSER_RANGE).show(ui, |ui| {
            let unit = pass.settings.temperature;
            self.chooser.show(ui, scene.history, scene.bench, unit, &mut self.area.choice);
        });
    }

    fn list_events(&mut self, ui: &mut Ui, source: &Source<'_>, view: &TimeView, height: f32, pass: &mut Pass<'_>) {
        if !self.events_open {
            return;
        }
        let panel = Panel::bottom("events").frame(theme::details_frame()).resizable(true);
        let [usual, most] = theme::below_plots(theme::EVENTS_PANEL, height);
        let panel = panel.default_size(usual).size_range(*theme::VALUES_RANGE.start()..=most);
        let at = panel.show(ui, |ui| self.events.show(ui, source, [view.from, view.to], pass)).inner;
        if let Some(at) = at {
            self.area.window.centre(at);
            self.area.cursors.set(0, at);
        }
    }

    fn tell_values(&mut self, ui: &mut Ui, scene: &Scene<'_>, height: f32) {
        if !self.table_open {
            return;
        }
        let drawn = scene.curves(&self.area.choice).filter(|(_, shown)| !shown.hidden);
        let curves: Vec<(Curve<'_>, Shown)> = drawn.map(|(curve, shown)| (curve, shown.clone())).collect();
        let table = Table { scene, cursors: &self.area.cursors, curves: &curves };
        let clear = table::panel(height).show(ui, |ui| table.show(ui)).inner;
        if clear {
            self.area.cursors.clear();
        }
    }

    fn plots(&mut self, ui: &mut Ui, scene: Scene<'_>, known: [f64; 2], pass: &mut Pass<'_>) {
        if self.area.choice.shown().is_empty() {
            self.area.rect = None;
            return self.nothing_chosen(ui);
        }
        let written = self.note.show(ui, &scene);
        match self.area.show(ui, scene, known) {
            Some(Asked::Note(at, place)) => self.note.open(at, place),
            Some(Asked::Event) => self.events_open = true,
            None => {}
        }
        if let Some((at, text)) = written {
            let at = Timestamp::from_microsecond(crate::record::micros(at)).unwrap_or(pass.bench.now());
            pass.actions.push(Action::AddNote(at, text));
        }
    }

    fn nothing_chosen(&mut self, ui: &mut Ui) {
        let palette = theme::palette(ui);
        let lines = ["Tick what is to be drawn in the list at the left."];
        ui.vertical(|ui| {
            widgets::empty_state(ui, palette, "Nothing is chosen", &lines);
            if ui.button("Show the list").on_hover_text("All series that can be shown, at the left").clicked() {
                self.chooser.set_open(true);
            }
        });
    }

    fn keep_choice(&mut self, source: &Source<'_>, pass: &mut Pass<'_>) {
        if !self.area.choice.take_changed() {
            return;
        }
        // Plots may have other numbers now.
        self.area.ranges.clear();
        if source.is_live() {
            pass.settings.trend_series = self.area.choice.to_keep(source.history, &pass.settings.trend_series);
        }
    }
}

/// First and last time there is something to see; the present while anything is polled.
fn known(source: &Source<'_>, bench: &Bench) -> Option<[f64; 2]> {
    let [first, last] = source.span()?;
    let polled = source.is_live() && bench.modules().iter().any(|module| module.interval.is_some());
    // A simulated line may be ahead of the clock.
    let last = if polled { last.max(words::seconds(bench.now())) } else { last };
    Some([first, last])
}

fn nothing_yet(ui: &mut Ui, source: &Source<'_>, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    if !source.is_live() {
        let lines = ["It holds no samples. If it is being written, they appear here as they come."];
        return widgets::empty_state(ui, palette, "This recording is empty", &lines);
    }
    let can_poll = pass.bench.line().is_open() && pass.bench.modules().iter().any(|one| one.definition().is_some());
    let first =
        if can_poll { "Open a module in the list to poll it, or poll all of them." } else { "Scan a line first." };
    let lines = [first, "Every reading and every state that is polled can be drawn here, of any modules together."];
    widgets::empty_state(ui, palette, "Nothing was measured yet", &lines);
    let poll = |ui: &mut Ui| ui.button("Poll all modules").on_hover_text("Asks each again and again for its readings");
    if can_poll && poll(ui).clicked() {
        pass.actions.push(Action::PollAll(true));
    }
}

impl TrendView {
    /// Asks in the next frame what of the readings is to be exported.
    pub fn ask_to_export(&mut self) {
        self.export = true;
    }
}

/// In place of a recording that cannot be shown.
pub fn not_there(ui: &mut Ui, lines: &[String]) {
    let palette = theme::palette(ui);
    let (heading, rest) = lines.split_first().map_or(("", lines), |(heading, rest)| (heading.as_str(), rest));
    let rest: Vec<&str> = rest.iter().map(String::as_str).collect();
    widgets::empty_state(ui, palette, heading, &rest);
}
