//! From the switches of a definition file as written to a [`SwitchLayout`] that can be relied on.

use std::collections::BTreeSet;

use super::super::check::{Checked, Problem, plain, range};
use super::super::definition::{Item, Kind};
use super::super::file;
use super::super::value::Fixed;
use super::{Bank, Condition, Group, ROTARY_POSITIONS, Rotary, Row, SwitchLayout};

/// More than any bank has; a row stays readable.
const MOST_POSITIONS: u8 = 16;

pub fn layout(file: &file::File, items: &[Item]) -> Checked<SwitchLayout> {
    let mut seen = BTreeSet::new();
    for bank in &file.dip {
        if !seen.insert(bank.id.get_ref()) {
            return problem(bank.id.span().start, bank, "this id stands twice");
        }
    }
    let banks = file.dip.iter().map(|bank| check_bank(bank, items)).collect::<Checked<Vec<_>>>()?;
    one_ruler(file)?;
    let rotary = match file.rotary.as_ref().map(|rotary| (rotary, check_rotary(rotary, items))) {
        // The item was replaced by one that it cannot tell.
        Some((rotary, Err(_))) if rotary.inherited => None,
        checked => checked.map(|(_, checked)| checked).transpose()?,
    };
    Ok(SwitchLayout { banks, rotary })
}

/// The banks of `base`, for a definition that may have replaced the items that tell their positions.
pub fn inherited_banks(base: &file::File) -> Vec<file::Bank> {
    base.dip.iter().map(|bank| file::Bank { inherited: true, ..bank.clone() }).collect()
}

pub fn inherited_rotary(base: &file::File) -> Option<file::Rotary> {
    base.rotary.as_ref().map(|rotary| file::Rotary { inherited: true, ..rotary.clone() })
}

/// Where `file` has what a reason of this file speaks of.
pub fn entry(file: &file::File, reason: &str) -> Option<usize> {
    let (subject, _) = reason.split_once(": ")?;
    if subject == "[rotary]" {
        return file.rotary.as_ref().map(|rotary| rotary.label.span().start);
    }
    let id = subject.strip_prefix("[[dip]] ")?;
    file.dip.iter().find(|bank| bank.id.get_ref() == id).map(|bank| bank.id.span().start)
}

fn problem<T>(at: usize, bank: &file::Bank, reason: impl std::fmt::Display) -> Checked<T> {
    Err(Problem { at, reason: format!("[[dip]] {}: {reason}", bank.id.get_ref()) })
}

fn check_bank(bank: &file::Bank, items: &[Item]) -> Checked<Bank> {
    let at = bank.id.span().start;
    if !(1..=MOST_POSITIONS).contains(&bank.positions) {
        return problem(at, bank, format!("`positions` has to be 1 to {MOST_POSITIONS}"));
    }
    let mut free: BTreeSet<u8> = (1..=bank.positions).collect();
    let mut groups = Vec::new();
    for group in &bank.group {
        let (first, last) = match positions(group, bank.positions) {
            Ok(found) => found,
            Err(reason) => return problem(group.positions.span().start, bank, reason),
        };
        for number in first..=last {
            if !free.remove(&number) {
                return problem(group.positions.span().start, bank, format!("position {number} is in two groups"));
            }
        }
        groups.push(check_group(group, (first, last), bank, items)?);
    }
    if let Some(number) = free.first() {
        return problem(at, bank, format!("position {number} is in no [[dip.group]]"));
    }
    groups.sort_by_key(|group| group.first);
    Ok(Bank {
        id: bank.id.get_ref().clone(),
        label: bank.label.clone(),
        name: bank.name.clone(),
        positions: bank.positions,
        groups,
    })
}

fn positions(group: &file::Group, most: u8) -> Result<(u8, u8), String> {
    let (first, last) = range(group.positions.get_ref())?;
    if first < 1 || last > most || first > last {
        return Err(format!("positions \"{}\" are not in a bank of 1 to {most}", group.positions.get_ref()));
    }
    Ok((first, last))
}

fn check_group(group: &file::Group, (first, last): (u8, u8), bank: &file::Bank, items: &[Item]) -> Checked<Group> {
    let width = usize::from(last.saturating_sub(first)).saturating_add(1);
    let rows = match check_rows(group, width, bank, items) {
        // A replaced item takes other values: it no longer tells these positions.
        Err(_) if bank.inherited => check_rows(&untold(group), width, bank, items),
        checked => checked,
    }?;
    let at = group.positions.span().start;
    for (number, index) in (first..=last).zip(0..) {
        let stands = |on: bool| rows.iter().any(|row| row.set.get(index) == Some(&on));
        if !(stands(true) && stands(false)) {
            return problem(at, bank, format!("position {number} needs a row with ON and one with OFF"));
        }
    }
    let rules: Vec<_> = rows.iter().filter_map(|row| row.switches_rule).collect();
    let complete = width == 1 && rules.contains(&true) && rules.contains(&false);
    if !rules.is_empty() && !complete {
        let reason = "`switches_rule` belongs to a single position: true in one of its two rows, false in the other";
        return problem(at, bank, reason);
    }
    let always = group.always || !rules.is_empty();
    Ok(Group { first, last, label: group.label.clone(), help: group.help.clone(), always, rows })
}

/// `group` with rows that no value tells.
fn untold(group: &file::Group) -> file::Group {
    let rows = group.rows.iter().map(|row| file::Row { when: Default::default(), ..row.clone() });
    file::Group { rows: rows.collect(), ..group.clone() }
}

fn check_rows(group: &file::Group, width: usize, bank: &file::Bank, items: &[Item]) -> Checked<Vec<Row>> {
    let mut rows: Vec<Row> = Vec::new();
    for row in &group.rows {
        let refuse = |reason| problem(row.set.span().start, bank, format!("\"{}\": {reason}", row.set.get_ref()));
        let checked = check_row(row, width, items).or_else(refuse)?;
        if rows.iter().any(|other| other.set == checked.set) {
            return problem(row.set.span().start, bank, format!("\"{}\" stands twice", row.set.get_ref()));
        }
        if checked.factory && rows.iter().any(|other| other.factory) {
            return problem(row.set.span().start, bank, "two rows of a group are the factory setting");
        }
        rows.push(checked);
    }
    Ok(rows)
}

fn check_row(row: &file::Row, width: usize, items: &[Item]) -> Result<Row, String> {
    let set = row
        .set
        .get_ref()
        .split_whitespace()
        .map(|word| match word {
            "on" => Ok(true),
            "off" => Ok(false),
            other => Err(format!("{other} is neither on nor off")),
        })
        .collect::<Result<Vec<_>, _>>()?;
    if set.len() != width {
        return Err(format!("the group has {width} positions, the row {}", set.len()));
    }
    if row.switches_rule.is_some() && !row.when.is_empty() {
        return Err("a row with `switches_rule` has no `when`: the address tells it".to_owned());
    }
    let when = row
        .when
        .iter()
        .map(|(id, value)| Ok((id.clone(), condition(find_item(id, items)?, value)?)))
        .collect::<Result<_, String>>()?;
    Ok(Row { set, means: row.means.clone(), factory: row.factory, switches_rule: row.switches_rule, when })
}

fn find_item<'a>(id: &str, items: &'a [Item]) -> Result<&'a Item, String> {
    items.iter().find(|item| item.id == id).ok_or_else(|| format!("there is no parameter or reading \"{id}\""))
}

fn condition(item: &Item, value: &toml::Value) -> Result<Condition, String> {
    let text = plain(value)?;
    if let Some(value) = item.parse_any(&text) {
        return Ok(Condition::Is(value));
    }
    let refused = || format!("{} cannot be {text}: use {}", item.id, item.allowed());
    let Kind::Number { min, max, .. } = &item.kind else { return Err(refused()) };
    let (low, high) = text.split_once('-').ok_or_else(refused)?;
    let end = |text| Fixed::parse(text, min.decimals).filter(|end| (min.raw..=max.raw).contains(&end.raw));
    match (end(low), end(high)) {
        (Some(low), Some(high)) if low.raw <= high.raw => Ok(Condition::Between(low, high)),
        _ => Err(refused()),
    }
}

/// Two switches cannot both say whether the switches are in force.
fn one_ruler(file: &file::File) -> Checked<()> {
    let rulers = file.dip.iter().flat_map(|bank| bank.group.iter().map(move |group| (bank, group)));
    let mut rulers = rulers.filter(|(_, group)| group.rows.iter().any(|row| row.switches_rule.is_some()));
    match (rulers.next(), rulers.next()) {
        (Some(_), Some((bank, group))) => {
            problem(group.positions.span().start, bank, "there is another switch with `switches_rule`")
        }
        _ => Ok(()),
    }
}

fn check_rotary(rotary: &file::Rotary, items: &[Item]) -> Checked<Rotary> {
    let check = || {
        let item = find_item(&rotary.item, items)?;
        let Kind::Number { min, max, .. } = &item.kind else {
            return Err(format!("{} is not a number", item.id));
        };
        if rotary.first.is_empty() {
            return Err("`first` has to tell the number of position 0".to_owned());
        }
        let last = i64::from(ROTARY_POSITIONS.saturating_sub(1));
        let fits = |first: &i64| *first >= min.raw && first.checked_add(last).is_some_and(|last| last <= max.raw);
        match rotary.first.iter().find(|first| !fits(first)) {
            Some(first) if min.decimals == 0 => {
                Err(format!("{} cannot be {first} to {}: use {}", item.id, first.saturating_add(last), item.allowed()))
            }
            _ if min.decimals != 0 => Err(format!("{} is not a whole number", item.id)),
            _ => Ok(()),
        }
    };
    check().map_err(|reason| Problem { at: rotary.label.span().start, reason: format!("[rotary]: {reason}") })?;
    Ok(Rotary {
        label: rotary.label.get_ref().clone(),
        help: rotary.help.clone(),
        item: rotary.item.clone(),
        first: rotary.first.clone(),
    })
}
