//! What lives in a range of coils or registers.

use super::super::access::{self, numbers_of};
use super::super::definition::{Access, Action, Definition, Item, ItemKind, ModbusAccess, ModbusPlace};
use super::{ExplainedField, named};
use crate::protocol::{Protocol, Reply};

/// One of the address spaces of Modbus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    Coils,
    Holding,
    Input,
}

impl Space {
    fn of(place: ModbusPlace) -> Self {
        match place {
            ModbusPlace::Coils { .. } => Self::Coils,
            ModbusPlace::Holding { .. } => Self::Holding,
            ModbusPlace::Input { .. } => Self::Input,
        }
    }

    /// Whether what a definition has at `place` is found here: modules answer with their holding registers to the function
    /// for input registers too.
    fn shows(self, place: ModbusPlace) -> bool {
        let place = Self::of(place);
        place == self || (self, place) == (Self::Input, Self::Holding)
    }
}

/// Coils or registers in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Range {
    pub space: Space,
    /// 0-based, as on the wire.
    pub wire: u16,
    pub count: u16,
}

impl Range {
    /// `register 486 (wire 485)`.
    pub fn label(self) -> String {
        let what = if self.space == Space::Coils { "coil" } else { "register" };
        let first = u32::from(self.wire);
        let number = first.saturating_add(1);
        if self.count <= 1 {
            return format!("{what} {number} (wire {first})");
        }
        let more = u32::from(self.count).saturating_sub(1);
        format!("{what}s {number}-{} (wire {first}-{})", number.saturating_add(more), first.saturating_add(more))
    }

    fn end(self) -> u32 {
        u32::from(self.wire).saturating_add(u32::from(self.count))
    }

    fn contains(self, other: Self) -> bool {
        self.wire <= other.wire && other.end() <= self.end()
    }

    fn overlaps(self, other: Self) -> bool {
        u32::from(self.wire) < other.end() && u32::from(other.wire) < self.end()
    }
}

/// Part of a range, and the items that live there; none where the definition knows nothing.
struct Spot<'a> {
    range: Range,
    items: Vec<(&'a Item, &'a ModbusAccess)>,
}

/// Splits `range` at the borders of what the definition has in it.
fn spots(definition: &Definition, protocol: Protocol, range: Range) -> Vec<Spot<'_>> {
    let mut known: Vec<Spot> = Vec::new();
    for item in &definition.items {
        for way in item.accesses.iter().filter(|way| way.serves(protocol)) {
            let Access::Modbus(access) = way else { continue };
            let (first, count) = numbers_of(access.place);
            let place = Range { space: Space::of(access.place), wire: first.saturating_sub(1), count };
            if !range.space.shows(access.place) || !range.contains(place) {
                continue;
            }
            match known.iter_mut().find(|spot| spot.range == place) {
                Some(spot) => spot.items.push((item, access)),
                None => known.push(Spot { range: place, items: vec![(item, access)] }),
            }
        }
    }
    let native: Vec<Range> = known.iter().map(|spot| spot.range).filter(|place| place.space == range.space).collect();
    let hidden = |place: Range| place.space != range.space && native.iter().any(|native| native.overlaps(place));
    known.retain(|spot| !hidden(spot.range));
    known.sort_by_key(|spot| (spot.range.wire, spot.range.count));
    with_gaps(known, range)
}

fn with_gaps(known: Vec<Spot<'_>>, range: Range) -> Vec<Spot<'_>> {
    let mut all = Vec::new();
    let mut next = u32::from(range.wire);
    let gap = |from: u32, to: u32| {
        let (wire, count) = (u16::try_from(from).ok()?, u16::try_from(to.checked_sub(from)?).ok()?);
        (count > 0).then_some(Spot { range: Range { wire, count, ..range }, items: Vec::new() })
    };
    for spot in known {
        all.extend(gap(next, u32::from(spot.range.wire)));
        next = next.max(spot.range.end());
        all.push(spot);
    }
    all.extend(gap(next, range.end()));
    all
}

/// Names of the items in `range`, and a row for each place of theirs.
pub fn names(definition: &Definition, protocol: Protocol, range: Range) -> (Vec<String>, Vec<ExplainedField>) {
    let (mut all, mut rows) = (Vec::new(), Vec::new());
    for spot in spots(definition, protocol, range).into_iter().filter(|spot| !spot.items.is_empty()) {
        let ids: Vec<String> = spot.items.iter().map(|(item, _)| item.id.clone()).collect();
        rows.push(ExplainedField::new(spot.range.label(), "", ids.join(", ")));
        all.extend(ids);
    }
    (all, rows)
}

/// Labels of what a write to `range` changes: actions, and items that can be written.
pub fn changed(definition: &Definition, protocol: Protocol, range: Range) -> Vec<String> {
    let actions = actions(definition, protocol, range).map(|action| action.label.clone());
    let spots = spots(definition, protocol, range);
    let items = spots.iter().flat_map(|spot| &spot.items).filter(|(item, _)| !item.read_only && !item.is_measured());
    actions.chain(items.map(|(item, _)| item.label.clone())).collect()
}

fn actions(definition: &Definition, protocol: Protocol, range: Range) -> impl Iterator<Item = &Action> {
    definition.actions.iter().filter(move |action| action.is_offered(protocol)).filter(move |action| {
        action.modbus.is_some_and(|place| {
            let (first, count) = numbers_of(place);
            range.contains(Range { space: range.space, wire: first.saturating_sub(1), count })
                && Space::of(place) == range.space
        })
    })
}

/// What the coils or registers of `reply` hold, and a row for each place. In a write, actions count as well.
pub fn values(
    definition: Option<&Definition>,
    protocol: Protocol,
    range: Range,
    reply: &Reply,
    write: bool,
) -> (Vec<String>, Vec<ExplainedField>) {
    let (mut all, mut rows) = (Vec::new(), Vec::new());
    let spots = match definition {
        Some(definition) => spots(definition, protocol, range),
        None => vec![Spot { range, items: Vec::new() }],
    };
    for spot in spots {
        let raw = raw(reply, range, spot.range);
        let mut meanings = Vec::new();
        if let Some(definition) = definition.filter(|_| write) {
            meanings.extend(actions(definition, protocol, spot.range).map(|action| action.id.clone()));
        }
        let acts = !meanings.is_empty();
        for (item, access) in spot.items {
            let shown = !(acts && (item.read_only || item.is_measured()));
            let value = definition
                .filter(|_| shown)
                .map(|definition| access::value_in_reply(definition, item, access, range.wire, reply));
            match value {
                Some(Ok(value)) => meanings.push(named(item, &value)),
                Some(Err(_)) => meanings.push(format!("{} unknown value {raw}", item.id)),
                None => {}
            }
        }
        let meaning = meanings.join(", ");
        if meanings.is_empty() {
            all.push(format!("{} {raw}", spot.range.label()));
        }
        all.extend(meanings);
        rows.push(ExplainedField::new(spot.range.label(), raw, meaning));
    }
    (all, rows)
}

/// The part of `reply` that belongs to `part`: `0x0B28 0x0000`, or `1 0 1`.
fn raw(reply: &Reply, whole: Range, part: Range) -> String {
    let from = usize::from(part.wire.saturating_sub(whole.wire));
    let to = from.saturating_add(usize::from(part.count));
    match reply {
        Reply::Words(words) => access::raw_words(words.get(from..to).unwrap_or_default()),
        Reply::Bits(bits) => {
            let bits = bits.get(from..to).unwrap_or_default();
            bits.iter().map(|bit| if *bit { "1" } else { "0" }).collect::<Vec<_>>().join(" ")
        }
        _ => String::new(),
    }
}

impl Item {
    /// Measured, so that nothing is set by writing it.
    fn is_measured(&self) -> bool {
        self.item_kind == ItemKind::Reading
    }
}
