//! Commands that PIR-130 and PIR-234 have in common (PIR-130 manual 2, PIR-234 manual 5).

use super::super::alarm::HIGHEST_LIMIT;
use super::super::device::Device;
use super::super::identity;
use super::super::refusal::Refusal;
use super::words::{argument, decimal, hex, of_channel, signed};
use super::{Outcome, data, done, read};
use crate::protocol::Protocol;

pub(super) fn execute(device: &mut Device, delimiter: char, command: &str) -> Outcome {
    match delimiter {
        '%' => configure(device, command),
        '$' => dollar(device, command),
        '~' => tilde(device, command),
        '@' => alarm(device, command),
        _ => None,
    }
}

/// `NNTTCCFF` after `%AA`.
fn configure(device: &mut Device, command: &str) -> Outcome {
    let (head, tail) = command.split_at_checked(4)?;
    let [[address, type_code], [line, format]] = [hex(head, 4)?, hex(tail, 4)?].map(u16::to_be_bytes);
    done(device.comms.configure(address, type_code, line, format))
}

fn dollar(device: &mut Device, command: &str) -> Outcome {
    let comms = &mut device.comms;
    match command {
        "2" => {
            let checksum = if comms.stored().checksum { 0x40 } else { 0x00 };
            data(format!("{:02X}{:02X}{checksum:02X}", comms.type_code(), comms.line_code()))
        }
        "5" => data(if device.take_reset_status() { "1" } else { "0" }),
        "F" => data(identity::of(device.model).dcon_firmware),
        "M" => data(identity::of(device.model).dcon_name),
        // The protocol at the next power-on, not the one in use.
        "P" => data(if comms.stored().protocol == Protocol::Dcon { "10" } else { "11" }),
        "P0" => done(comms.store_protocol(false)),
        "P1" => done(comms.store_protocol(true)),
        _ => on_time(device, command),
    }
}

fn on_time(device: &mut Device, command: &str) -> Outcome {
    match argument(command)? {
        ('7', rest) => done(of_channel(rest, &[2])?.and_then(|code| device.trigger.set_on_time_code(code))),
        ('8', rest) => read(rest, format!("{:02X}", device.trigger.on_time_code())),
        _ => None,
    }
}

fn tilde(device: &mut Device, command: &str) -> Outcome {
    if command == "D" {
        return data(if device.active_low { "02" } else { "00" });
    }
    if command == "RD" {
        return data(format!("{:02X}", device.comms.response_delay_ms()));
    }
    if let Some(digits) = command.strip_prefix("RD") {
        return done(device.comms.set_response_delay(hex(digits, 2)?));
    }
    let active_low = match hex(command.strip_prefix('D')?, 2)? {
        0x00 => Ok(false),
        0x02 => Ok(true),
        _ => Err(Refusal::Value),
    };
    done(active_low.map(|low| device.active_low = low))
}

fn alarm(device: &mut Device, command: &str) -> Outcome {
    let alarm = &mut device.alarm;
    match command {
        "EAM" => alarm.enable(false),
        "EAL" => alarm.enable(true),
        "DA" => alarm.enabled = false,
        "CHC0" => alarm.clear(),
        "RH" => return data(decimal(alarm.limit)),
        "RAO" => return data(if alarm.active() { "0100" } else { "0000" }),
        _ => {
            let limit = signed(command.strip_prefix("HI")?)?;
            let limit = limit
                .and_then(|limit| if (0..=HIGHEST_LIMIT).contains(&limit) { Ok(limit) } else { Err(Refusal::Value) });
            return done(limit.map(|limit| alarm.limit = limit));
        }
    }
    data("")
}
