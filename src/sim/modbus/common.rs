//! Coils and registers that PIR-130 and PIR-234 have in common; `None` where there is none of that number.

use super::super::climate::Hundredths;
use super::super::device::Device;
use super::super::identity;
use super::super::refusal::Refusal;
use super::Via;
use crate::protocol::Protocol;

/// "Only for Modbus RTU protocol" (PIR-234 manual 6.1).
fn serial_only_bit(number: u16) -> bool {
    matches!(number, 257 | 273)
}

fn serial_only_register(number: u16) -> bool {
    matches!(number, 485 | 486 | 488)
}

pub(super) fn bit(device: &mut Device, number: u16, via: Via) -> Option<bool> {
    if via == Via::Tcp && serial_only_bit(number) {
        return None;
    }
    match number {
        257 => Some(device.comms.stored().protocol != Protocol::Dcon),
        262 => Some(device.alarm.enabled),
        263 => Some(device.alarm.latched),
        273 => Some(device.take_reset_status()),
        305 => Some(device.alarm.active()),
        _ => None,
    }
}

pub(super) fn set_bit(device: &mut Device, number: u16, on: bool, via: Via) -> Option<Result<(), Refusal>> {
    if via == Via::Tcp && serial_only_bit(number) {
        return None;
    }
    match number {
        257 => return Some(device.comms.store_protocol(on)),
        262 => device.alarm.enabled = on,
        263 => device.alarm.latched = on,
        305 if on => device.alarm.clear(),
        305 => (),
        _ => return None,
    }
    Some(Ok(()))
}

pub(super) fn register(device: &Device, number: u16, via: Via) -> Option<u16> {
    if via == Via::Tcp && serial_only_register(number) {
        return None;
    }
    let identity = identity::of(device.model);
    let ([name_low, name_high], [firmware_low, firmware_high]) = (identity.name, identity.firmware);
    match number {
        // A limit above 655.35 °C, as DCON can set it, does not fit.
        226 => Some(u16::try_from(device.alarm.limit).unwrap_or(u16::MAX)),
        481 => Some(firmware_low),
        482 => Some(firmware_high),
        483 => Some(name_low),
        484 => Some(name_high),
        485 => Some(device.comms.address().into()),
        486 => Some(device.comms.line_code().into()),
        488 => Some(device.comms.response_delay_ms()),
        513 => Some(device.trigger.on_time_code()),
        516 => Some(device.trigger.active_delay_ms()),
        _ => None,
    }
}

pub(super) fn set_register(device: &mut Device, number: u16, value: u16, via: Via) -> Option<Result<(), Refusal>> {
    if via == Via::Tcp && serial_only_register(number) {
        return None;
    }
    match number {
        226 => device.alarm.limit = Hundredths::from(value),
        485 => return Some(device.comms.set_modbus_address(value)),
        486 => return Some(device.comms.store_line_code(value)),
        488 => return Some(device.comms.set_response_delay(value)),
        513 => return Some(device.trigger.set_on_time_code(value)),
        516 => return Some(device.trigger.set_active_delay(value)),
        _ => return None,
    }
    Some(Ok(()))
}
