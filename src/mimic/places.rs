//! Between the items of a module and its coils and registers, from the module's side.

use std::collections::BTreeMap;

use super::modbus::Exception;
use super::store::{Change, Store};
use super::texts;
use crate::module::access::{self, numbers_of, raw_of_value, words_of_text};
use crate::module::definition::{Encoding, ModbusAccess};
use crate::module::{Access, Item, Kind, ModbusPlace, Value};
use crate::protocol::{Protocol, Reply};

/// Registers 481 and 482 have the firmware, 483 and 484 the name (PIR-234 manual 6.1, DL-302 manual C-3).
const NAME: u16 = 483;

/// One of the tables that numbers are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Table {
    Coils,
    Holding,
    Input,
}

fn table(place: ModbusPlace) -> Table {
    match place {
        ModbusPlace::Coils { .. } => Table::Coils,
        ModbusPlace::Holding { .. } => Table::Holding,
        ModbusPlace::Input { .. } => Table::Input,
    }
}

fn covers(place: ModbusPlace, wanted: Table, number: u16) -> bool {
    let (first, count) = numbers_of(place);
    table(place) == wanted && number.checked_sub(first).is_some_and(|at| at < count)
}

/// Items with their places in `wanted`.
fn items(all: &[Item], wanted: Table) -> impl Iterator<Item = (&Item, &ModbusAccess)> {
    all.iter().flat_map(move |item| {
        item.accesses.iter().filter_map(move |access| match access {
            Access::Modbus(access) if access.over_rtu && table(access.place) == wanted => Some((item, access)),
            _ => None,
        })
    })
}

/// The number's word, for a coil 0 or 1; nothing if the module has no such number.
pub(super) fn word(store: &Store, wanted: Table, number: u16) -> Option<u16> {
    let mut found = None;
    for (item, access) in
        items(&store.definition.items, wanted).filter(|(_, access)| covers(access.place, wanted, number))
    {
        let at = usize::from(number.saturating_sub(numbers_of(access.place).0));
        let part = words(store, item, access).get(at).copied().unwrap_or_default();
        let mask = access.bits.map_or(u16::MAX, |bits| u16::try_from(bits.mask() & 0xFFFF).unwrap_or(u16::MAX));
        found = Some((found.unwrap_or(0) & !mask) | (part & mask));
    }
    found.or_else(|| identity(store, wanted, number))
}

/// What says which module it is, where no item has it.
fn identity(store: &Store, wanted: Table, number: u16) -> Option<u16> {
    let known = store.definition.identity.words.first().filter(|_| wanted == Table::Holding)?;
    match number.checked_sub(NAME) {
        Some(0) => Some(known.low),
        Some(1) => Some(known.high),
        _ if known.needs.contains(&number) || (NAME.saturating_sub(2)..NAME).contains(&number) => Some(0),
        _ => None,
    }
}

/// All words, or all bits, of an item's place.
fn words(store: &Store, item: &Item, access: &ModbusAccess) -> Vec<u16> {
    let count = numbers_of(access.place).1;
    let value = store.value(item);
    let filled = |bytes: Vec<u8>| -> Vec<u16> {
        let all = bytes.into_iter().chain(std::iter::repeat(0)).take(usize::from(count).saturating_mul(2));
        let all: Vec<u8> = all.collect();
        all.chunks(2).map(|pair| pair.iter().fold(0, |word, byte| (word << 8) | u16::from(*byte))).collect()
    };
    match (&item.kind, access.encoding) {
        (Kind::Text { .. }, Encoding::Name | Encoding::Version | Encoding::Mac) => {
            filled(texts::bytes(&store.definition, access.encoding, true, &value.to_string()))
        }
        (Kind::Text { .. } | Kind::Ipv4, encoding) => words_of_text(item, encoding, count, &value).unwrap_or_default(),
        _ => {
            let raw = raw_of_value(item, &value, Protocol::ModbusRtu, access.inverted).unwrap_or_default();
            let raw = access.bits.map_or(raw.cast_unsigned(), |bits| bits.put(0, raw.cast_unsigned()));
            spread(raw, count, table(access.place) == Table::Coils)
        }
    }
}

/// Coils have the lowest bit first, registers the highest word.
fn spread(raw: u64, count: u16, coils: bool) -> Vec<u16> {
    let part = |shift: u32, mask: u64| u16::try_from(raw.checked_shr(shift).unwrap_or(0) & mask).unwrap_or(0);
    match coils {
        true => (0..u32::from(count)).map(|at| part(at, 1)).collect(),
        false => (0..u32::from(count)).rev().map(|at| part(at.saturating_mul(16), 0xFFFF)).collect(),
    }
}

/// What writing these numbers changes, all or nothing.
pub(super) fn write(store: &Store, wanted: Table, written: &BTreeMap<u16, u16>) -> Result<Vec<Change>, Exception> {
    let definition = store.definition.clone();
    let takes = |number: u16| {
        items(&definition.items, wanted).any(|(item, access)| !item.read_only && covers(access.place, wanted, number))
    };
    let acts = |number: u16| {
        let mut places = definition.actions.iter().filter(|action| action.over_rtu).filter_map(|action| action.modbus);
        places.any(|place| covers(place, wanted, number))
    };
    if written.keys().any(|number| !takes(*number) && !acts(*number)) {
        return Err(Exception::Address);
    }
    let mut changes = Vec::new();
    for (item, access) in items(&definition.items, wanted).filter(|(item, _)| !item.read_only) {
        let (first, count) = numbers_of(access.place);
        let numbers = first..first.saturating_add(count);
        if !numbers.clone().any(|number| written.contains_key(&number)) {
            continue;
        }
        let present = |number| word(store, wanted, number).unwrap_or_default();
        let words: Vec<u16> =
            numbers.map(|number| written.get(&number).copied().unwrap_or_else(|| present(number))).collect();
        let reply = match wanted {
            Table::Coils => Reply::Bits(words.iter().map(|word| *word != 0).collect()),
            Table::Holding | Table::Input => Reply::Words(words),
        };
        let value = access::value_in_reply(&definition, item, access, first.saturating_sub(1), &reply);
        let value = value.map_err(|_| Exception::Value)?;
        if !in_range(access, &value) {
            return Err(Exception::Value);
        }
        store.judge(item, &value).map_err(|_| Exception::Value)?;
        changes.push((item.id.clone(), value));
    }
    Ok(changes)
}

fn in_range(access: &ModbusAccess, value: &Value) -> bool {
    match (access.range, value) {
        (Some((low, high)), Value::Number(number)) => (low..=high).contains(&number.raw),
        _ => true,
    }
}

/// Items whose reading changes them have been read.
pub(super) fn were_read(store: &mut Store, wanted: Table, numbers: &std::ops::Range<u16>) {
    let definition = store.definition.clone();
    for (item, access) in items(&definition.items, wanted) {
        let (first, _) = numbers_of(access.place);
        if item.on_request && numbers.contains(&first) {
            store.was_read(&item.id);
        }
    }
}
