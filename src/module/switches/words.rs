//! What the switches mean and why they stand so, in words.

use super::super::definition::{Item, Kind};
use super::super::value::Value;
use super::{Bank, Deduction, Group, Position, ROTARY_POSITIONS, Rotary, Row, Rule, agreed};

impl Deduction<'_> {
    /// What has to be known to read the panel.
    pub(super) fn notes(&self, rule: Rule) -> Vec<String> {
        let Some((bank, ruler)) = self.ruler() else { return Vec::new() };
        let name = group_name(bank, ruler);
        let others = match rule {
            Rule::Software => "The others are not in force: they are drawn as the present settings would need them.",
            _ => "The others are drawn as the present settings need them.",
        };
        let mut notes = vec![format!("{} {others}", self.rule_words(rule))];
        if rule == Rule::Untold {
            let groups = self.layout.banks.iter().flat_map(|bank| bank.groups.iter().map(move |group| (bank, group)));
            let impossible = groups.filter(|(_, group)| !group.always && self.possible_rows(group, rule).is_empty());
            notes.extend(impossible.map(|(bank, group)| {
                let on = ruling_word(ruler, false);
                format!("{} {name} is probably {on}.", self.no_row_words(bank, group))
            }));
        }
        notes
    }

    /// Whether the switches rule, and why.
    fn rule_words(&self, rule: Rule) -> String {
        let Some((bank, ruler)) = self.ruler() else { return String::new() };
        let name = group_name(bank, ruler);
        let rotary = self.layout.rotary.as_ref();
        let label = rotary.and_then(|rotary| self.item(&rotary.item)).map(|item| item.label.as_str());
        let value = rotary.and_then(|rotary| (self.value)(&rotary.item));
        match (label, value) {
            (Some(label), Some(value)) if rule == Rule::Software => {
                format!("{label} {value} cannot come from the switches, so {name} is {}.", ruling_word(ruler, false))
            }
            (Some(label), Some(value)) => {
                format!(
                    "{name} is not told by the settings: {label} {value} can come from the switches or from software."
                )
            }
            (Some(label), None) => format!("{name} is not told by the settings: {label} is not known."),
            (None, _) => format!("{name} is not told by the settings."),
        }
    }

    /// For one position of `group`, with the rows that the settings leave open.
    pub(super) fn position_words(&self, bank: &Bank, group: &Group, rows: &[&Row], index: usize, rule: Rule) -> String {
        let mut lines = vec![group.help.clone()];
        lines.extend(meaning_lines(bank, group, rows, index));
        lines.push(if group.rules() { self.rule_words(rule) } else { self.reason(bank, group, rows, index) });
        if !group.always {
            lines.extend(self.force_words(rule));
        }
        lines.join("\n")
    }

    fn reason(&self, bank: &Bank, group: &Group, rows: &[&Row], index: usize) -> String {
        if rows.is_empty() {
            return self.no_row_words(bank, group);
        }
        let ids = group.items();
        let missing: Vec<_> = ids.iter().filter(|id| (self.value)(id).is_none()).collect();
        let labels = missing.iter().filter_map(|id| self.item(id)).map(|item| item.label.clone()).collect::<Vec<_>>();
        match agreed(rows, index) {
            Position::On => format!("ON follows from {}.", self.present(group)),
            Position::Off => format!("OFF follows from {}.", self.present(group)),
            Position::Unknown if ids.is_empty() => "No setting that can be read tells its position.".to_owned(),
            Position::Unknown if labels.is_empty() => {
                format!("{} leaves its position open.", self.present(group))
            }
            Position::Unknown => {
                let are = if labels.len() > 1 { "are" } else { "is" };
                format!("Not told, because {} {are} not known.", joined(&labels))
            }
        }
    }

    fn no_row_words(&self, bank: &Bank, group: &Group) -> String {
        format!("No position of {} gives {}.", group_name(bank, group), self.present(group))
    }

    /// `Protocol = DCON`, for each item that is known of those that tell the position.
    fn present(&self, group: &Group) -> String {
        let known = group.items().into_iter().filter_map(|id| Some((self.item(id)?, (self.value)(id)?)));
        let texts: Vec<_> =
            known.map(|(item, value)| format!("{} = {}", item.label, value_words(item, &value))).collect();
        joined(&texts)
    }

    /// Whether a switch that does not always count is in force.
    fn force_words(&self, rule: Rule) -> Option<String> {
        let (bank, ruler) = self.ruler()?;
        let name = group_name(bank, ruler);
        match rule {
            Rule::Switches => None,
            Rule::Software => Some(format!("Not in force, because {name} is {}.", ruling_word(ruler, false))),
            Rule::Untold => Some(format!("In force only if {name} is {}.", ruling_word(ruler, true))),
        }
    }

    pub(super) fn rotary_words(&self, rotary: &Rotary, rule: Rule) -> String {
        let last = i64::from(ROTARY_POSITIONS.saturating_sub(1));
        let spans: Vec<_> =
            rotary.first.iter().map(|first| format!("{first} to {}", first.saturating_add(last))).collect();
        let label = self.item(&rotary.item).map_or(rotary.item.as_str(), |item| item.label.as_str());
        let mut lines = vec![rotary.help.clone(), format!("Positions 0 to F: {label} {}.", spans.join(" or "))];
        lines.push(match ((self.value)(&rotary.item), self.rotary_position(rotary)) {
            (Some(value), Some(position)) => format!("Position {position:X} follows from {label} {value}."),
            (Some(value), None) => format!("No position gives {label} {value}."),
            (None, _) => format!("Not told, because {label} is not known."),
        });
        lines.extend(self.force_words(rule));
        lines.join("\n")
    }
}

/// What ON and OFF mean at a position: with the other positions as they stand, else the group's whole table.
fn meaning_lines(bank: &Bank, group: &Group, rows: &[&Row], index: usize) -> Vec<String> {
    let width = group.rows.first().map_or(0, |row| row.set.len());
    if width == 1 {
        return [true, false].iter().filter_map(|on| group.row(&[*on])).map(row_line).collect();
    }
    let others: Option<Vec<bool>> = (0..width)
        .map(|other| match agreed(rows, other) {
            Position::On => Some(true),
            Position::Off => Some(false),
            Position::Unknown => (other == index).then_some(false),
        })
        .collect();
    let mut lines = Vec::new();
    let name = group_name(bank, group);
    match others {
        Some(mut set) => {
            lines.push(format!("With the others of {name} as drawn:"));
            for on in [true, false] {
                if let Some(own) = set.get_mut(index) {
                    *own = on;
                }
                let means = group.row(&set).map_or_else(|| "not in the manual".to_owned(), meaning);
                lines.push(format!("{}: {means}", word(on)));
            }
        }
        None => {
            lines.push(format!("{name} together:"));
            lines.extend(group.rows.iter().map(row_line));
        }
    }
    lines
}

fn row_line(row: &Row) -> String {
    let set: Vec<_> = row.set.iter().map(|on| word(*on)).collect();
    format!("{}: {}", set.join(" "), meaning(row))
}

fn meaning(row: &Row) -> String {
    let factory = if row.factory { " (factory setting)" } else { "" };
    format!("{}{factory}", row.means)
}

fn word(on: bool) -> &'static str {
    if on { "ON" } else { "OFF" }
}

/// The word at which the ruling switch lets the switches rule, or not.
fn ruling_word(ruler: &Group, switches_rule: bool) -> &'static str {
    let row = ruler.rows.iter().find(|row| row.switches_rule == Some(switches_rule));
    row.and_then(|row| row.set.first()).map_or("–", |on| word(*on))
}

/// `DIP 2`, `DIP 6 and 7`, `DIP 8 to 10`.
fn group_name(bank: &Bank, group: &Group) -> String {
    let Group { first, last, .. } = group;
    match last.saturating_sub(*first) {
        0 => format!("{} {first}", bank.name),
        1 => format!("{} {first} and {last}", bank.name),
        _ => format!("{} {first} to {last}", bank.name),
    }
}

fn value_words(item: &Item, value: &Value) -> String {
    let text = match (&item.kind, value) {
        (Kind::Choice(choices), Value::Choice(word)) => choices
            .iter()
            .find(|choice| choice.word == *word)
            .map_or_else(|| word.clone(), |choice| choice.label.clone()),
        (_, Value::Bool(on)) => (if *on { "yes" } else { "no" }).to_owned(),
        (_, value) => value.to_string(),
    };
    match item.unit.is_empty() || text.parse::<f64>().is_err() {
        true => text,
        false => format!("{text} {}", item.unit),
    }
}

/// `a`, `a and b`, `a, b and c`.
fn joined(texts: &[String]) -> String {
    match texts {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

impl Group {
    fn row(&self, set: &[bool]) -> Option<&Row> {
        self.rows.iter().find(|row| row.set == set)
    }
}
