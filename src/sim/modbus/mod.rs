//! Modbus as a module hears it (PIR-234 manual 6, PIR-130 manual 3): functions 1 to 6, 15 and 16 over the tables of
//! the models, and function 0x46 of the PIR-130.

mod common;
mod frame;
mod module_settings;
mod pir130;
mod pir234;

pub(super) use frame::{CRC_START, checked, crc_with, sealed};

use super::climate::Hundredths;
use super::device::Device;
use super::refusal::Refusal;
use super::spec::Model;

/// Which side a request came in on: the tables reserve some numbers for one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Via {
    Serial,
    Tcp,
}

/// Modbus application protocol 1.1b3, section 7.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Exception {
    Function = 1,
    Address = 2,
    Value = 3,
    Failure = 4,
}

impl From<Refusal> for Exception {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Tripped => Self::Failure,
            Refusal::Value | Refusal::InitOff | Refusal::Linked => Self::Value,
        }
    }
}

/// Most of each kind in one request (Modbus application protocol 1.1b3, section 6).
const MOST_BITS_READ: u16 = 2000;
const MOST_REGISTERS_READ: u16 = 125;
const MOST_BITS_WRITTEN: u16 = 1968;
const MOST_REGISTERS_WRITTEN: u16 = 123;

/// The whole answer to a whole RTU frame. Broadcasts are obeyed if they write, and never answered.
pub(super) fn hear(device: &mut Device, frame: &[u8]) -> Option<Vec<u8>> {
    let (&unit, pdu) = frame::checked(frame)?.split_first()?;
    let broadcast = unit == 0;
    if !broadcast && unit != device.comms.address() {
        return None;
    }
    // What feeds the host watchdog over Modbus is not documented: here any valid frame for the module does.
    device.watchdog.feed(device.now());
    if broadcast {
        if matches!(pdu.first(), Some(5 | 6 | 15 | 16)) {
            serve(device, pdu, Via::Serial);
        }
        return None;
    }
    // The answer has the address that was asked, even if the request changed it.
    let answer = [&[unit], serve(device, pdu, Via::Serial).as_slice()].concat();
    Some(frame::sealed(answer))
}

/// The answer to a request without address and check. A request that is refused in part changes nothing.
pub(super) fn serve(device: &mut Device, pdu: &[u8], via: Via) -> Vec<u8> {
    let Some((&function, data)) = pdu.split_first() else { return Vec::new() };
    let mut changed = device.clone();
    match execute(&mut changed, function, data, via) {
        Ok(answer) => {
            *device = changed;
            [&[function], answer.as_slice()].concat()
        }
        Err(exception) => vec![function | 0x80, exception as u8],
    }
}

fn execute(device: &mut Device, function: u8, data: &[u8], via: Via) -> Result<Vec<u8>, Exception> {
    match function {
        1 | 2 => read_bits(device, data, via),
        3 | 4 => read_registers(device, data, function, via),
        5 => write_bit(device, data, via),
        6 => write_register(device, data, via),
        15 => write_bits(device, data, via),
        16 => write_registers(device, data, via),
        0x46 if device.model == Model::Pir130 => module_settings::execute(device, data),
        _ => Err(Exception::Function),
    }
}

fn read_bits(device: &mut Device, data: &[u8], via: Via) -> Result<Vec<u8>, Exception> {
    let (numbers, _) = span(data, MOST_BITS_READ, 0)?;
    let mut bytes = vec![0; numbers.len().div_ceil(8)];
    for (index, number) in numbers.enumerate() {
        let bit = bit(device, number, via)?;
        if let Some(byte) = bytes.get_mut(index / 8) {
            *byte |= u8::from(bit) << (index % 8);
        }
    }
    counted(bytes)
}

fn read_registers(device: &mut Device, data: &[u8], function: u8, via: Via) -> Result<Vec<u8>, Exception> {
    let (numbers, _) = span(data, MOST_REGISTERS_READ, 0)?;
    let mut bytes = Vec::with_capacity(numbers.len() * 2);
    for number in numbers {
        bytes.extend(register(device, number, function, via)?.to_be_bytes());
    }
    counted(bytes)
}

fn write_bit(device: &mut Device, data: &[u8], via: Via) -> Result<Vec<u8>, Exception> {
    let (number, value) = pair(data)?;
    let on = match value {
        0xFF00 => true,
        0x0000 => false,
        _ => return Err(Exception::Value),
    };
    set_bit(device, number, on, via)?;
    Ok(data.to_vec())
}

fn write_register(device: &mut Device, data: &[u8], via: Via) -> Result<Vec<u8>, Exception> {
    let (number, value) = pair(data)?;
    set_register(device, number, value, via)?;
    Ok(data.to_vec())
}

fn write_bits(device: &mut Device, data: &[u8], via: Via) -> Result<Vec<u8>, Exception> {
    let (numbers, bytes) = span(data, MOST_BITS_WRITTEN, 1)?;
    for (index, number) in numbers.enumerate() {
        let byte = bytes.get(index / 8).copied().unwrap_or_default();
        set_bit(device, number, byte >> (index % 8) & 1 == 1, via)?;
    }
    Ok(data.iter().copied().take(4).collect())
}

fn write_registers(device: &mut Device, data: &[u8], via: Via) -> Result<Vec<u8>, Exception> {
    let (numbers, bytes) = span(data, MOST_REGISTERS_WRITTEN, 16)?;
    for (number, value) in numbers.zip(bytes.chunks_exact(2)) {
        set_register(device, number, word(value).unwrap_or_default(), via)?;
    }
    Ok(data.iter().copied().take(4).collect())
}

/// The numbers a request is about, counted from 1 as in the tables, and the values it carries with `bits` each.
fn span(data: &[u8], most: u16, bits: usize) -> Result<(std::ops::Range<u16>, &[u8]), Exception> {
    let (head, values) = data.split_at_checked(4).ok_or(Exception::Value)?;
    let (first, count) = pair_words(head).ok_or(Exception::Value)?;
    let values = match values.split_first() {
        None if bits == 0 => values,
        Some((&length, values)) if bits > 0 => {
            let expected = (usize::from(count) * bits).div_ceil(8);
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
    // The highest number of the tables is 720, so a span up to 65535 loses nothing.
    let first = first.checked_add(1).ok_or(Exception::Address)?;
    let end = first.checked_add(count).ok_or(Exception::Address)?;
    Ok((first..end, values))
}

/// Number (from 1) and value of a single write.
fn pair(data: &[u8]) -> Result<(u16, u16), Exception> {
    let (number, value) = pair_words(data).ok_or(Exception::Value)?;
    Ok((number.checked_add(1).ok_or(Exception::Address)?, value))
}

fn pair_words(data: &[u8]) -> Option<(u16, u16)> {
    let (first, second) = data.split_at_checked(2)?;
    Some((word(first)?, word(second)?))
}

fn word(bytes: &[u8]) -> Option<u16> {
    bytes.try_into().ok().map(u16::from_be_bytes)
}

/// The byte count, and then the bytes.
fn counted(bytes: Vec<u8>) -> Result<Vec<u8>, Exception> {
    let count = u8::try_from(bytes.len()).map_err(|_| Exception::Value)?;
    Ok([&[count], bytes.as_slice()].concat())
}

/// Two's complement in a register; what does not fit saturates.
fn signed(value: Hundredths) -> u16 {
    value.clamp(i16::MIN.into(), i16::MAX.into()) as u16
}

fn unsigned(register: u16) -> Hundredths {
    Hundredths::from(register.cast_signed())
}

fn bit(device: &mut Device, number: u16, via: Via) -> Result<bool, Exception> {
    match device.model {
        Model::Pir130 => pir130::bit(device, number),
        Model::Pir230 | Model::Pir234 | Model::Pir234Wf => pir234::bit(device, number, via),
        Model::Unknown => Err(Exception::Address),
    }
}

fn set_bit(device: &mut Device, number: u16, on: bool, via: Via) -> Result<(), Exception> {
    match device.model {
        Model::Pir130 => pir130::set_bit(device, number, on),
        Model::Pir230 | Model::Pir234 | Model::Pir234Wf => pir234::set_bit(device, number, on, via),
        Model::Unknown => Err(Exception::Address),
    }
}

fn register(device: &Device, number: u16, function: u8, via: Via) -> Result<u16, Exception> {
    match device.model {
        Model::Pir130 => pir130::register(device, number, function),
        Model::Pir230 | Model::Pir234 | Model::Pir234Wf => pir234::register(device, number, via),
        Model::Unknown => Err(Exception::Address),
    }
}

fn set_register(device: &mut Device, number: u16, value: u16, via: Via) -> Result<(), Exception> {
    match device.model {
        Model::Pir130 => pir130::set_register(device, number, value),
        Model::Pir230 | Model::Pir234 | Model::Pir234Wf => pir234::set_register(device, number, value, via),
        Model::Unknown => Err(Exception::Address),
    }
}
