//! The summary as text with aligned columns.

use jiff::tz::TimeZone;

use super::{Entry, Summary, address, words};
use crate::module::{Position, SwitchPanel};

const COLUMNS: [&str; 7] = ["", "", "Value", "Unit", "Factory", "Read", ""];
/// Stands before what differs.
const MARK: &str = "*";

pub fn text(summary: &Summary, zone: &TimeZone) -> String {
    let title = format!("{} at address {}", summary.label, address(summary.target.address));
    let rule = "=".repeat(title.chars().count());
    let mut lines = vec![title, rule];
    let facts = summary.facts(zone).into_iter().map(|(name, fact)| vec![name.to_owned(), fact]);
    lines.extend(aligned(&facts.collect::<Vec<_>>()));
    let mut rows = vec![COLUMNS.map(str::to_owned).to_vec()];
    rows.extend(summary.entries().map(|entry| row(entry, summary, zone)));
    let mut table = aligned(&rows).into_iter();
    let columns = table.next().unwrap_or_default();
    for group in &summary.groups {
        lines.push(String::new());
        lines.push(headed(&group.label, &columns));
        lines.extend(table.by_ref().take(group.entries.len()));
    }
    if !summary.switches.is_empty() {
        lines.push(String::new());
        lines.push("Switches, as far as the settings tell".to_owned());
        lines.extend(switches(&summary.switches));
    }
    lines.join("\n") + "\n"
}

/// The names of the columns, with the group's name in the empty room at their left.
fn headed(label: &str, columns: &str) -> String {
    let kept: String = columns.chars().skip(label.chars().count()).collect();
    format!("{label}{kept}")
}

fn row(entry: &Entry, summary: &Summary, zone: &TimeZone) -> Vec<String> {
    let mark = if entry.differs { MARK } else { "" };
    let read = entry.at.map(|at| words::clock(at, summary.at, zone)).unwrap_or_default();
    let unit = if entry.value.is_some() { entry.unit.clone() } else { String::new() };
    let cells = [mark.to_owned(), entry.label.clone(), entry.text.clone(), unit, entry.factory_text.clone(), read];
    cells.into_iter().chain([remark(entry)]).collect()
}

/// What is to be said of the value, apart from its age.
pub(super) fn remark(entry: &Entry) -> String {
    let differs = entry.differs.then_some("differs from factory");
    differs.into_iter().chain(entry.problem.as_deref()).collect::<Vec<_>>().join("; ")
}

fn switches(panel: &SwitchPanel) -> Vec<String> {
    let force = |in_force: bool| if in_force { "" } else { "not in force" }.to_owned();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for position in panel.banks.iter().flat_map(|bank| &bank.positions) {
        let stands = match position.position {
            Position::On => "ON",
            Position::Off => "OFF",
            Position::Unknown => "not known",
        };
        rows.push(vec![String::new(), position.title.clone(), stands.to_owned(), force(position.in_force)]);
    }
    if let Some(rotary) = &panel.rotary {
        let stands = rotary.position.map_or_else(|| "not known".to_owned(), |position| format!("{position:X}"));
        rows.push(vec![String::new(), rotary.label.clone(), stands, force(rotary.in_force)]);
    }
    let notes = panel.notes.iter().map(|note| format!("  {note}"));
    aligned(&rows).into_iter().chain(notes).collect()
}

/// Rows with columns of equal width, two spaces between them.
pub(crate) fn aligned(rows: &[Vec<String>]) -> Vec<String> {
    let mut widths: Vec<usize> = Vec::new();
    for row in rows {
        widths.resize(widths.len().max(row.len()), 0);
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let pad = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}")).collect();
        cells.join("  ").trim_end().to_owned()
    };
    rows.iter().map(pad).collect()
}
