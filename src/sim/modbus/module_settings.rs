//! Function 0x46 of the PIR-130 (manual 3.10).

use super::super::comms::{Language, baud_code, baud_rate};
use super::super::device::Device;
use super::super::identity;
use super::Exception;
use crate::protocol::{LineSettings, Protocol};

/// The data of the answer, which begins with the sub-function.
pub(super) fn execute(device: &mut Device, data: &[u8]) -> Result<Vec<u8>, Exception> {
    let (&sub, rest) = data.split_first().ok_or(Exception::Value)?;
    let answer = match (sub, rest) {
        (0x00, []) => name(device),
        (0x04, &[address, _, _, _]) => write_address(device, address),
        (0x05, [_]) => read_settings(device),
        (0x06, &[_, baud, _, _, _, mode, _, _]) => write_settings(device, baud, mode),
        // 01.00, and a build number that the manual does not print.
        (0x20, []) => vec![0x01, 0x00, 0x00],
        (0x00 | 0x04 | 0x05 | 0x06 | 0x20, _) => return Err(Exception::Value),
        // Printed so for a sub-function that is not supported.
        _ => return Err(Exception::Address),
    };
    Ok([&[sub], answer.as_slice()].concat())
}

fn name(device: &Device) -> Vec<u8> {
    let [low, high] = identity::of(device.model).name;
    [high.to_be_bytes(), low.to_be_bytes()].concat()
}

/// 0 for done, anything else for an error.
fn status(done: bool) -> u8 {
    u8::from(!done)
}

fn write_address(device: &mut Device, address: u8) -> Vec<u8> {
    let done = device.comms.set_modbus_address(address.into()).is_ok();
    vec![status(done), 0, 0, 0]
}

/// What is stored for the next power-on, not what is in use.
fn read_settings(device: &Device) -> Vec<u8> {
    let stored = device.comms.stored();
    let mode = u8::from(stored.protocol != Protocol::Dcon);
    vec![0, baud_code(stored.settings.baud_rate), 0, 0, 0, mode, 0, 0]
}

/// Speed and protocol are accepted or refused each on its own.
fn write_settings(device: &mut Device, baud: u8, mode: u8) -> Vec<u8> {
    let comms = &mut device.comms;
    let baud_done = baud_rate(baud).is_some_and(|baud_rate| {
        let stored = comms.stored();
        comms.store(Language { settings: LineSettings { baud_rate, ..stored.settings }, ..stored }).is_ok()
    });
    let mode_done = mode <= 1 && comms.store_protocol(mode == 1).is_ok();
    vec![0, status(baud_done), 0, 0, 0, status(mode_done), 0, 0]
}
