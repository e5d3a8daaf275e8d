//! Modbus RTU as the module hears it: functions 1 to 6, 15 and 16, and the non-standard ones of the definition.

use std::collections::BTreeMap;
use std::ops::Range;

use super::dcon::address_in;
use super::fields::{self, Heard};
use super::places::{self, Table};
use super::store::Store;
use crate::protocol::{hex, modbus};

/// Modbus application protocol 1.1b3, section 7.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exception {
    Function = 1,
    Address = 2,
    Value = 3,
}

/// Most of each kind in one request (Modbus application protocol 1.1b3, section 6).
const MOST_BITS_READ: u16 = 2000;
const MOST_REGISTERS_READ: u16 = 125;
const MOST_BITS_WRITTEN: u16 = 1968;
const MOST_REGISTERS_WRITTEN: u16 = 123;

/// The whole answer to a whole frame. Broadcasts are obeyed if they write, and never answered.
pub(super) fn hear(store: &mut Store, address: &mut u8, frame: &[u8]) -> Option<Vec<u8>> {
    let (content, _) = frame.split_at_checked(frame.len().checked_sub(2)?)?;
    let (&unit, pdu) = content.split_first().filter(|_| modbus::with_crc(content) == frame)?;
    let (&function, data) = pdu.split_first()?;
    let broadcast = unit == 0;
    if broadcast && !matches!(function, 5 | 6 | 15 | 16) || !broadcast && unit != *address {
        return None;
    }
    let answer = match execute(store, function, data) {
        Ok(answer) => [&[unit, function], answer.as_slice()].concat(),
        Err(exception) => vec![unit, function | 0x80, exception as u8],
    };
    // The answer has the address that was asked, even if the request changed it.
    *address = address_in(store).unwrap_or(*address);
    (!broadcast).then(|| modbus::with_crc(&answer))
}

fn execute(store: &mut Store, function: u8, data: &[u8]) -> Result<Vec<u8>, Exception> {
    match function {
        1 | 2 => read_bits(store, data),
        3 | 4 => read_registers(store, data, function),
        5 => {
            let (number, value) = pair(data)?;
            let bit = match value {
                0xFF00 => 1,
                0x0000 => 0,
                _ => return Err(Exception::Value),
            };
            write(store, Table::Coils, [(number, bit)].into())?;
            Ok(data.to_vec())
        }
        6 => {
            write(store, Table::Holding, [pair(data)?].into())?;
            Ok(data.to_vec())
        }
        15 => {
            let (numbers, bytes) = span(data, MOST_BITS_WRITTEN, 1)?;
            let bit = |index: usize| {
                let byte = bytes.get(index / 8).copied().unwrap_or_default();
                u16::from(byte.checked_shr(u32::try_from(index % 8).unwrap_or(0)).unwrap_or(0) & 1)
            };
            let written = numbers.enumerate().map(|(index, number)| (number, bit(index))).collect();
            write(store, Table::Coils, written)?;
            Ok(data.iter().copied().take(4).collect())
        }
        16 => {
            let (numbers, bytes) = span(data, MOST_REGISTERS_WRITTEN, 16)?;
            write(store, Table::Holding, numbers.zip(bytes.chunks(2).map(word)).collect())?;
            Ok(data.iter().copied().take(4).collect())
        }
        function => other(store, function, data),
    }
}

/// A function outside the standard: its data bytes are to its commands what text is to DCON's.
fn other(store: &mut Store, function: u8, data: &[u8]) -> Result<Vec<u8>, Exception> {
    if !store.definition.commands.iter().any(|command| command.function == Some(function)) {
        return Err(Exception::Function);
    }
    let text = hex::spaced(data).replace(' ', "");
    match fields::hear(store, Some(function), 0, &text).ok_or(Exception::Address)? {
        Heard::Answer(answer) => hex::parse(&answer).map_err(|_| Exception::Value),
        Heard::Write(changes) => {
            store.apply(changes.map_err(|_| Exception::Value)?);
            Ok(data.to_vec())
        }
    }
}

fn write(store: &mut Store, table: Table, written: BTreeMap<u16, u16>) -> Result<(), Exception> {
    let changes = places::write(store, table, &written)?;
    store.apply(changes);
    Ok(())
}

fn read_bits(store: &mut Store, data: &[u8]) -> Result<Vec<u8>, Exception> {
    let (numbers, _) = span(data, MOST_BITS_READ, 0)?;
    let mut bytes = vec![0u8; numbers.len().div_ceil(8)];
    for (index, number) in numbers.clone().enumerate() {
        let bit = places::word(store, Table::Coils, number).ok_or(Exception::Address)?;
        if let (Some(byte), 1..) = (bytes.get_mut(index / 8), bit) {
            *byte |= 1u8.checked_shl(u32::try_from(index % 8).unwrap_or(0)).unwrap_or(0);
        }
    }
    places::were_read(store, Table::Coils, &numbers);
    counted(bytes)
}

/// Function 04 also reaches the holding registers: the maker's tables have 3xxxx and 4xxxx side by side.
fn read_registers(store: &mut Store, data: &[u8], function: u8) -> Result<Vec<u8>, Exception> {
    let (numbers, _) = span(data, MOST_REGISTERS_READ, 0)?;
    let mut bytes = Vec::new();
    for number in numbers.clone() {
        let input = if function == 4 { places::word(store, Table::Input, number) } else { None };
        let word = input.or_else(|| places::word(store, Table::Holding, number)).ok_or(Exception::Address)?;
        bytes.extend(word.to_be_bytes());
    }
    places::were_read(store, Table::Holding, &numbers);
    counted(bytes)
}

/// The numbers a request is about, counted from 1 as in the manuals, and the values it carries with `bits` each.
fn span(data: &[u8], most: u16, bits: usize) -> Result<(Range<u16>, &[u8]), Exception> {
    let (head, values) = data.split_at_checked(4).ok_or(Exception::Value)?;
    let (first, count) = words(head);
    let values = match values.split_first() {
        None if bits == 0 => values,
        Some((&length, values)) if bits > 0 => {
            let expected = usize::from(count).saturating_mul(bits).div_ceil(8);
            if usize::from(length) != expected || values.len() != expected {
                return Err(Exception::Value);
            }
            values
        }
        _ => return Err(Exception::Value),
    };
    if !(1..=most).contains(&count) {
        return Err(Exception::Value);
    }
    let first = first.checked_add(1).ok_or(Exception::Address)?;
    Ok((first..first.checked_add(count).ok_or(Exception::Address)?, values))
}

/// Number (from 1) and value of a single write.
fn pair(data: &[u8]) -> Result<(u16, u16), Exception> {
    if data.len() != 4 {
        return Err(Exception::Value);
    }
    let (number, value) = words(data);
    Ok((number.checked_add(1).ok_or(Exception::Address)?, value))
}

fn words(bytes: &[u8]) -> (u16, u16) {
    (word(bytes.get(..2).unwrap_or_default()), word(bytes.get(2..4).unwrap_or_default()))
}

fn word(bytes: &[u8]) -> u16 {
    bytes.iter().take(2).fold(0, |word, byte| (word << 8) | u16::from(*byte))
}

/// The byte count, and then the bytes.
fn counted(bytes: Vec<u8>) -> Result<Vec<u8>, Exception> {
    let count = u8::try_from(bytes.len()).map_err(|_| Exception::Value)?;
    Ok([&[count], bytes.as_slice()].concat())
}
