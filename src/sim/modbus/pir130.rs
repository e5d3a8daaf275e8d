//! The table of the PIR-130 (manual 3.1). It has no Ethernet.

use super::super::device::Device;
use super::{Exception, Via, common, signed};

pub(super) fn bit(device: &mut Device, number: u16) -> Result<bool, Exception> {
    match number {
        1 => Ok(device.output_bits() & 1 == 1),
        274 => Ok(device.buzzer.on_pir),
        _ => common::bit(device, number, Via::Serial).ok_or(Exception::Address),
    }
}

pub(super) fn set_bit(device: &mut Device, number: u16, on: bool) -> Result<(), Exception> {
    if number == 274 {
        device.buzzer.on_pir = on;
        return Ok(());
    }
    Ok(common::set_bit(device, number, on, Via::Serial).ok_or(Exception::Address)??)
}

pub(super) fn register(device: &Device, number: u16, function: u8) -> Result<u16, Exception> {
    let [celsius, ..] = *device.channels();
    match number {
        // Not in the manual: sister modules answer their temperature here, by function 4 only.
        1 if function == 4 => Ok(signed(celsius)),
        514 => Ok(device.lux_level),
        517 => Ok(device.sensitivity),
        _ => common::register(device, number, Via::Serial).ok_or(Exception::Address),
    }
}

pub(super) fn set_register(device: &mut Device, number: u16, value: u16) -> Result<(), Exception> {
    let result = match number {
        514 => Some(device.set_lux_level(value)),
        517 => Some(device.set_sensitivity(value)),
        _ => common::set_register(device, number, value, Via::Serial),
    };
    Ok(result.ok_or(Exception::Address)??)
}
