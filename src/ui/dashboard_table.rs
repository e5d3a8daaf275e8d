//! What the table of all modules says: its columns, and a line for each module. Columns that no module fills are left
//! out.

use std::cmp::Ordering;

use eframe::egui::{Align, Color32};
use jiff::Timestamp;

use super::app::Pass;
use super::module_list;
use super::module_view::{Family, Freshness, Series, series_of};
use super::tables::Sheet;
use super::theme::{self, Palette};
use super::widgets::Glyph;
use super::words;
use crate::bench::{Module, Presence, SwitchKind};
use crate::bus::Target;
use crate::module::Value;

/// Switches that have a column, in this order.
const SWITCHES: [(SwitchKind, &str); 4] = [
    (SwitchKind::Motion, "Motion"),
    (SwitchKind::Output, "Outputs"),
    (SwitchKind::Alarm, "Alarm"),
    (SwitchKind::Watchdog, "Watchdog"),
];

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    State,
    Model,
    Address,
    Spoken,
    /// Numbers of the same name, whatever the module.
    Number {
        stem: String,
        label: String,
    },
    Switch(SwitchKind),
    LastAnswer,
    Interval,
}

/// A part of a cell: a mark, a text, or both.
pub struct Piece {
    pub glyph: Option<(Glyph, Color32)>,
    pub text: String,
    pub colour: Color32,
}

/// What a column is sorted by.
#[derive(Debug, Clone, PartialEq, PartialOrd)]
pub enum Rank {
    Number(f64),
    Text(String),
    Unknown,
}

pub struct Cell {
    pub pieces: Vec<Piece>,
    /// What the pointer is told besides the text.
    pub note: String,
    rank: Rank,
}

pub struct Line {
    pub target: Target,
    /// `PIR-234, address 1`.
    pub name: String,
    pub cells: Vec<Cell>,
}

/// How many modules there are, and how many of them want to be looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    pub modules: usize,
    pub silent: usize,
    pub in_alarm: usize,
    pub polled: usize,
}

pub struct Table {
    pub columns: Vec<Column>,
    pub lines: Vec<Line>,
}

impl Count {
    pub fn of(modules: &[Module]) -> Self {
        let count = |wanted: fn(&Module) -> bool| modules.iter().filter(|module| wanted(module)).count();
        Self {
            modules: modules.len(),
            silent: count(|module| matches!(module.presence, Presence::Silent { .. })),
            in_alarm: count(is_in_alarm),
            polled: count(|module| module.interval.is_some()),
        }
    }
}

fn is_in_alarm(module: &Module) -> bool {
    module.attention().is_some()
}

impl Column {
    pub fn label(&self) -> &str {
        match self {
            Self::State => "State",
            Self::Model => "Model",
            Self::Address => "Address",
            Self::Spoken => "Protocol",
            Self::Number { label, .. } => label,
            Self::Switch(kind) => SWITCHES.iter().find(|(known, _)| known == kind).map_or("", |(_, label)| label),
            Self::LastAnswer => "Answered",
            Self::Interval => "Interval",
        }
    }

    pub fn explanation(&self) -> &'static str {
        match self {
            Self::State => "Whether the module answers",
            Self::Model => "What it calls itself",
            Self::Address => "Decimal and hexadecimal",
            Self::Spoken => "Protocol, speed, format and checksum",
            Self::Number { .. } | Self::Switch(_) => "What it said last; grey where that is old",
            Self::LastAnswer => "How long ago it answered last",
            Self::Interval => "How often it is polled",
        }
    }

    /// Least width, in points; a longer heading makes it wider.
    pub fn width(&self) -> f32 {
        match self {
            Self::State => theme::TABLE_STATE,
            Self::Model => theme::TABLE_MODEL,
            Self::Address => theme::TABLE_ADDRESS,
            Self::Spoken => theme::TABLE_SPOKEN,
            Self::Number { .. } => theme::TABLE_NUMBER,
            Self::Switch(SwitchKind::Output) => theme::TABLE_OUTPUTS,
            Self::Switch(_) => theme::TABLE_SWITCH,
            Self::LastAnswer | Self::Interval => theme::TABLE_TIME,
        }
    }

    pub fn align(&self) -> Align {
        match self {
            Self::Address | Self::Number { .. } | Self::LastAnswer | Self::Interval => Align::Max,
            Self::State | Self::Model | Self::Spoken | Self::Switch(_) => Align::Min,
        }
    }

    fn cell(&self, module: &Module, series: &[Series<'_>], pass: &Pass<'_>, palette: &Palette) -> Cell {
        let now = pass.bench.now();
        match self {
            Self::State => {
                let state = module_list::state(module, pass.bench.line(), palette);
                let glyph = Some((state.glyph, state.colour));
                let piece = Piece { glyph, text: state.short.to_owned(), colour: palette.text };
                let note = match &module.presence {
                    Presence::Silent { failure } => failure.to_string(),
                    _ => state.word.to_owned(),
                };
                Cell { pieces: vec![piece], note, rank: Rank::Text(state.short.to_owned()) }
            }
            Self::Model => Cell::text(module.label(), palette.text).noted(&module.identified.said),
            Self::Address => {
                let cell = Cell::text(&words::address(module.target.address), palette.text);
                cell.ranked(Rank::Number(f64::from(module.target.address)))
            }
            Self::Spoken => Cell::text(&words::spoken(&module.target), palette.quiet),
            Self::Number { stem, .. } => match series.iter().find(|series| series.is_number() && series.stem == stem) {
                Some(series) => number(module, series, now, palette),
                None => Cell::absent(palette),
            },
            Self::Switch(kind) => switches(module, *kind, series, now, palette),
            Self::LastAnswer => match module.readings.values().filter_map(|reading| reading.at).max() {
                Some(at) => {
                    let age = words::since(at, now);
                    let cell = Cell::text(&words::age(age), palette.quiet);
                    cell.ranked(Rank::Number(age.as_secs_f64()))
                }
                None => Cell::absent(palette).noted("It was not asked for values yet"),
            },
            Self::Interval => match module.interval {
                Some(interval) => {
                    let cell = Cell::text(&words::interval(interval), palette.quiet);
                    cell.ranked(Rank::Number(interval.as_secs_f64()))
                }
                None => Cell::absent(palette).noted("It is not polled"),
            },
        }
    }
}

impl Cell {
    fn text(text: &str, colour: Color32) -> Self {
        let piece = Piece { glyph: None, text: text.to_owned(), colour };
        Self { pieces: vec![piece], note: String::new(), rank: Rank::Text(text.to_owned()) }
    }

    /// The module has no such thing, or has not said it yet.
    fn absent(palette: &Palette) -> Self {
        Self::text(words::UNKNOWN, palette.old).ranked(Rank::Unknown)
    }

    fn ranked(self, rank: Rank) -> Self {
        Self { rank, ..self }
    }

    fn noted(self, note: &str) -> Self {
        Self { note: note.to_owned(), ..self }
    }

    /// The cell as it is copied and told.
    pub fn plain(&self) -> String {
        let texts: Vec<&str> = self.pieces.iter().map(|piece| piece.text.as_str()).collect();
        texts.join(", ")
    }
}

fn number(module: &Module, series: &Series<'_>, now: Timestamp, palette: &Palette) -> Cell {
    let Some(value) = series.reading.and_then(|reading| reading.value.as_ref()) else {
        return Cell::absent(palette).noted(&note(module, series, now));
    };
    let fresh = series.freshness(module, now) == Freshness::Fresh;
    let colour = if fresh { palette.text } else { palette.old };
    let rank = value.as_f64().map_or(Rank::Unknown, Rank::Number);
    Cell::text(&format!("{} {}", series.word(value), series.unit), colour)
        .ranked(rank)
        .noted(&note(module, series, now))
}

/// Whether any of these is on; outputs one by one.
fn switches(module: &Module, kind: SwitchKind, series: &[Series<'_>], now: Timestamp, palette: &Palette) -> Cell {
    let of_kind: Vec<&Series<'_>> = series.iter().filter(|series| series.family == Family::Switch(kind)).collect();
    let notes: Vec<String> = of_kind.iter().map(|series| note(module, series, now)).collect();
    let shown: Vec<Option<(bool, bool)>> = of_kind
        .iter()
        .map(|series| {
            let on = series.reading.and_then(|reading| reading.value.as_ref()).and_then(Value::as_bool)?;
            Some((on, series.freshness(module, now) == Freshness::Fresh))
        })
        .collect();
    let known: Vec<(bool, bool)> = shown.iter().copied().flatten().collect();
    if known.is_empty() {
        return Cell::absent(palette).noted(&notes.join("\n"));
    }
    let on = known.iter().filter(|(on, _)| *on).count();
    let pieces = match kind {
        SwitchKind::Output => shown.iter().map(|state| lamp(kind, *state, palette)).collect(),
        _ => vec![lamp(kind, Some((on > 0, known.iter().all(|(_, fresh)| *fresh))), palette)],
    };
    Cell { pieces, note: notes.join("\n"), rank: Rank::Number(on as f64) }
}

/// A switch that is on, and whether that is fresh.
fn lamp(kind: SwitchKind, state: Option<(bool, bool)>, palette: &Palette) -> Piece {
    let Some((on, fresh)) = state else {
        return Piece { glyph: None, text: words::UNKNOWN.to_owned(), colour: palette.old };
    };
    let (mark, colour) = match (fresh, on) {
        (true, true) => (theme::switch_colour(palette, kind), palette.text),
        (true, false) => (palette.quiet, palette.quiet),
        (false, _) => (palette.old, palette.old),
    };
    Piece { glyph: Some((Glyph::of_switch(kind, on), mark)), text: kind.word(on).to_owned(), colour }
}

/// Name, value, and how old it is if it is old; and why there is none.
fn note(module: &Module, series: &Series<'_>, now: Timestamp) -> String {
    let value = series.reading.and_then(|reading| reading.value.as_ref());
    let text = value.map_or_else(|| words::UNKNOWN.to_owned(), |value| series.word(value));
    let state = match series.freshness(module, now) {
        Freshness::Fresh => String::new(),
        Freshness::Old(age) => format!(", {} old", words::age(age)),
        Freshness::Unknown => ", not read yet".to_owned(),
    };
    let problem = series.problem().map(|problem| format!(" – {problem}")).unwrap_or_default();
    let value = format!("{text} {}", series.unit);
    format!("{} {}{state}{problem}", series.label, value.trim_end())
}

impl Table {
    pub fn of(pass: &Pass<'_>, palette: &Palette) -> Self {
        let unit = pass.settings.temperature;
        let modules: Vec<(&Module, Vec<Series<'_>>)> =
            pass.bench.modules().iter().map(|module| (module, series_of(pass.bench.history(), module, unit))).collect();
        let all: Vec<&Series<'_>> = modules.iter().flat_map(|(_, series)| series).collect();
        let columns = columns(&all);
        let lines = modules.iter().map(|(module, series)| Line {
            target: module.target,
            name: format!("{}, address {}", module.label(), module.target.address),
            cells: columns.iter().map(|column| column.cell(module, series, pass, palette)).collect(),
        });
        let lines = lines.collect();
        Self { columns, lines }
    }

    /// Sorts the lines by a column; what is not known stands last in both directions.
    pub fn sort(&mut self, column: &Column, ascending: bool) {
        let Some(index) = self.columns.iter().position(|known| known == column) else { return };
        let rank = |line: &Line| line.cells.get(index).map_or(Rank::Unknown, |cell| cell.rank.clone());
        self.lines.sort_by(|a, b| match (rank(a), rank(b)) {
            (Rank::Unknown, Rank::Unknown) => Ordering::Equal,
            (Rank::Unknown, _) => Ordering::Greater,
            (_, Rank::Unknown) => Ordering::Less,
            (a, b) => {
                let order = a.partial_cmp(&b).unwrap_or(Ordering::Equal);
                if ascending { order } else { order.reverse() }
            }
        });
    }

    /// The table as it is copied; with `only`, that module's line alone.
    pub fn sheet(&self, only: Option<Target>) -> Sheet {
        let mut sheet = Sheet::new(self.columns.iter().map(Column::label));
        for line in self.lines.iter().filter(|line| only.is_none_or(|target| line.target == target)) {
            sheet.push(line.cells.iter().map(Cell::plain));
        }
        sheet
    }
}

fn columns(series: &[&Series<'_>]) -> Vec<Column> {
    let mut columns = vec![Column::State, Column::Model, Column::Address, Column::Spoken];
    let mut numbers: Vec<&&Series<'_>> = series.iter().filter(|series| series.is_number()).collect();
    numbers.sort_by_key(|series| series.family);
    for series in numbers {
        let known = |column: &Column| matches!(column, Column::Number { stem, .. } if stem == series.stem);
        if !columns.iter().any(known) {
            columns.push(Column::Number { stem: series.stem.to_owned(), label: series.label.to_owned() });
        }
    }
    let filled = |kind: SwitchKind| series.iter().any(|series| series.family == Family::Switch(kind));
    columns.extend(SWITCHES.iter().filter(|(kind, _)| filled(*kind)).map(|(kind, _)| Column::Switch(*kind)));
    columns.extend([Column::LastAnswer, Column::Interval]);
    columns
}
