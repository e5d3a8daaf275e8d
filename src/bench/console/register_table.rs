//! The registers and coils of a module by name.

use std::collections::BTreeMap;

use crate::module::{Access, Definition, ModbusPlace};
use crate::protocol::Protocol;

/// More names are not told in one line.
const MOST_NAMES: usize = 12;

/// The four address spaces of Modbus (Modbus application protocol 1.1b3, 4.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Space {
    Coils,
    DiscreteInputs,
    HoldingRegisters,
    InputRegisters,
}

impl Space {
    /// What one of them is called.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Coils => "coil",
            Self::DiscreteInputs => "discrete input",
            Self::HoldingRegisters => "register",
            Self::InputRegisters => "input register",
        }
    }

    /// The first number of the space as the manuals' tables print it: 40486 is register 486.
    pub fn printed_base(self) -> u32 {
        match self {
            Self::Coils => 0,
            Self::DiscreteInputs => 10_000,
            Self::InputRegisters => 30_000,
            Self::HoldingRegisters => 40_000,
        }
    }

    /// Space, first 1-based number and count.
    fn of(place: ModbusPlace) -> (Self, u16, u16) {
        match place {
            ModbusPlace::Coils { first, count } => (Self::Coils, first, count),
            ModbusPlace::Holding { first, count } => (Self::HoldingRegisters, first, count),
            ModbusPlace::Input { first, count } => (Self::InputRegisters, first, count),
        }
    }
}

/// Coils or registers that have a meaning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RegisterEntry {
    pub space: Space,
    /// The first, 1-based as in the manuals.
    pub number: u16,
    pub count: u16,
    /// Ids of the items and actions that are there; several share one register.
    pub items: Vec<String>,
    /// Their labels.
    pub label: String,
    /// Something in it can be written.
    pub writable: bool,
    /// Sections of the manual.
    pub source: String,
}

impl RegisterEntry {
    /// The first number on the wire, 0-based.
    pub fn wire(&self) -> u16 {
        self.number.saturating_sub(1)
    }

    fn add(&mut self, id: &str, label: &str, writable: bool, source: &str) {
        if self.items.iter().any(|known| known == id) {
            return;
        }
        self.items.push(id.to_owned());
        append(&mut self.label, label);
        self.writable |= writable;
        for section in source.split(", ").filter(|section| !section.is_empty()) {
            if !self.source.split(", ").any(|known| known == section) {
                append(&mut self.source, section);
            }
        }
    }

    fn overlaps(&self, first: u32, count: u32) -> bool {
        let (from, to) = (u32::from(self.number), u32::from(self.number).saturating_add(u32::from(self.count)));
        from < first.saturating_add(count) && first < to
    }
}

fn append(list: &mut String, word: &str) {
    if !list.is_empty() {
        list.push_str(", ");
    }
    list.push_str(word);
}

/// All coils and registers that `definition` names over `protocol`, by space and number. Empty for DCON.
pub fn register_table(definition: &Definition, protocol: Protocol) -> Vec<RegisterEntry> {
    let mut entries = BTreeMap::<(Space, u16, u16), RegisterEntry>::new();
    let mut add = |place: ModbusPlace, id: &str, label: &str, writable: bool, source: &str| {
        let (space, number, count) = Space::of(place);
        let new = || RegisterEntry {
            space,
            number,
            count,
            items: Vec::new(),
            label: String::new(),
            writable: false,
            source: String::new(),
        };
        let writable = writable && space != Space::InputRegisters;
        entries.entry((space, number, count)).or_insert_with(new).add(id, label, writable, source);
    };
    for item in &definition.items {
        for access in item.accesses.iter().filter(|access| access.serves(protocol)) {
            if let Access::Modbus(access) = access {
                add(access.place, &item.id, &item.label, !item.read_only, &item.source);
            }
        }
    }
    for action in definition.actions.iter().filter(|action| protocol.is_modbus() && action.is_offered(protocol)) {
        if let Some(place) = action.modbus {
            add(place, &action.id, &action.label, true, &action.source);
        }
    }
    entries.into_values().collect()
}

/// The entries in which every word of `text` is found: in ids, labels, the kind, or as a number (486, 40486).
pub fn search_registers<'a>(entries: &'a [RegisterEntry], text: &str) -> Vec<&'a RegisterEntry> {
    let words: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
    let found = |entry: &&RegisterEntry| words.iter().all(|word| has_word(entry, word));
    entries.iter().filter(found).collect()
}

fn has_word(entry: &RegisterEntry, word: &str) -> bool {
    let contains = |text: &str| text.to_lowercase().contains(word);
    let by_number = word.parse::<u32>().is_ok_and(|number| {
        let printed = number.checked_sub(entry.space.printed_base()).filter(|_| entry.space.printed_base() > 0);
        entry.overlaps(number, 1) || printed.is_some_and(|number| entry.overlaps(number, 1))
    });
    by_number || contains(entry.space.noun()) || contains(&entry.label) || entry.items.iter().any(|id| contains(id))
}

/// `register 486 = wire 485 (01E5h): baud_rate, data_format`; `first` is the number on the wire.
pub fn describe_registers(entries: &[RegisterEntry], space: Space, first: u16, count: u16) -> String {
    let noun = space.noun();
    let last = first.saturating_add(count.saturating_sub(1));
    let number = |wire: u16| u32::from(wire).saturating_add(1);
    let place = if last == first {
        format!("{noun} {} = wire {first} ({first:04X}h)", number(first))
    } else {
        format!("{noun}s {} to {} = wire {first} to {last} ({first:04X}h to {last:04X}h)", number(first), number(last))
    };
    let there: Vec<_> = entries
        .iter()
        .filter(|entry| entry.space == space && entry.overlaps(number(first), u32::from(count.max(1))))
        .collect();
    let names: Vec<String> = match there.as_slice() {
        _ if last == first => there.iter().flat_map(|entry| entry.items.clone()).collect(),
        many => many.iter().map(|entry| format!("{} {}", entry.number, entry.items.join(" + "))).collect(),
    };
    match names.len() {
        0 => format!("{place}: no name known"),
        some if some > MOST_NAMES => {
            let more = some.saturating_sub(MOST_NAMES);
            format!("{place}: {} and {more} more", names.get(..MOST_NAMES).unwrap_or_default().join(", "))
        }
        _ => format!("{place}: {}", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::module::Catalogue;

    fn table(protocol: Protocol) -> Vec<RegisterEntry> {
        register_table(&Catalogue::built_in().0.get("pir-234").unwrap(), protocol)
    }

    fn ids(found: &[&RegisterEntry]) -> Vec<String> {
        found.iter().flat_map(|entry| entry.items.clone()).collect()
    }

    #[test]
    fn items_that_share_a_register_stand_in_one_entry() {
        let table = table(Protocol::ModbusRtu);
        let entry = table.iter().find(|entry| entry.number == 486 && entry.space == Space::HoldingRegisters).unwrap();
        assert_eq!(entry.items, ["baud_rate", "data_format"]);
        assert_eq!(entry.label, "Baud rate, Data format");
        assert_eq!((entry.wire(), entry.writable, entry.source.as_str()), (485, true, "4.3, 5.2, 5.7, 6.1"));
    }

    #[test]
    fn every_item_and_action_of_the_protocol_is_in_the_table_and_nothing_else() {
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        for protocol in [Protocol::ModbusRtu, Protocol::ModbusTcp] {
            let table = table(protocol);
            for item in definition.items_over(protocol) {
                assert!(table.iter().any(|entry| entry.items.contains(&item.id)), "{}", item.id);
            }
            let reboot = table.iter().any(|entry| entry.items.iter().any(|id| id == "reboot") && entry.writable);
            assert_eq!(reboot, protocol == Protocol::ModbusTcp);
            assert!(table.iter().filter(|entry| entry.space == Space::InputRegisters).all(|entry| !entry.writable));
            assert!(table.is_sorted_by_key(|entry| (entry.space, entry.number)));
        }
        assert_eq!(table(Protocol::Dcon), []);
    }

    #[test]
    fn registers_are_found_by_number_name_and_kind() {
        let table = table(Protocol::ModbusRtu);
        assert!(ids(&search_registers(&table, "486")).contains(&"baud_rate".to_owned()));
        assert_eq!(ids(&search_registers(&table, "40486")), ["baud_rate", "data_format"]);
        assert_eq!(ids(&search_registers(&table, "BAUD rate")), ["baud_rate", "data_format"]);
        assert!(search_registers(&table, "coil").iter().all(|entry| entry.space == Space::Coils));
        assert!(search_registers(&table, "no-such-thing").is_empty());
        assert_eq!(search_registers(&table, " ").len(), table.len());
    }

    #[test]
    fn a_range_is_described_with_both_numberings_and_its_names() {
        let table = table(Protocol::ModbusRtu);
        let describe = |first, count| describe_registers(&table, Space::HoldingRegisters, first, count);
        assert_eq!(describe(485, 1), "register 486 = wire 485 (01E5h): baud_rate, data_format");
        assert_eq!(
            describe(484, 2),
            "registers 485 to 486 = wire 484 to 485 (01E4h to 01E5h): 485 address, 486 baud_rate + data_format"
        );
        assert!(describe(65_535, 1).starts_with("register 65536 = wire 65535 (FFFFh): no name"));
        assert!(describe(0, 2_000).contains(" more"));
    }
}
