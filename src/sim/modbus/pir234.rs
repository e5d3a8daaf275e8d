//! The tables of the PIR-234 (manual 6.1). What is only written, or only read, is illegal the other way round.

use super::super::device::Device;
use super::super::ethernet::ResetCause;
use super::super::identity;
use super::super::outputs::{Output, Source};
use super::super::refusal::Refusal;
use super::{Exception, Via, common, signed, unsigned};

/// "Only for Modbus RTU protocol".
fn serial_only(coil: u16) -> bool {
    matches!(coil, 261 | 270)
}

/// "Only for Modbus TCP protocol".
fn tcp_only(coil: u16) -> bool {
    matches!(coil, 227 | 234)
}

fn closed(coil: u16, via: Via) -> bool {
    match via {
        Via::Serial => tcp_only(coil),
        Via::Tcp => serial_only(coil),
    }
}

pub(super) fn bit(device: &mut Device, number: u16, via: Via) -> Result<bool, Exception> {
    if closed(number, via) {
        return Err(Exception::Address);
    }
    let output = |index: u16, read: fn(&Output) -> bool| {
        device.outputs.get(usize::from(index)).map(read).ok_or(Exception::Address)
    };
    match number {
        1..=2 => output(number - 1, Output::state),
        33 => Ok(device.trigger.any()),
        34..=37 => Ok(device.trigger.sensor(usize::from(number - 34))),
        129..=130 => output(number - 129, |output| output.safe),
        161..=162 => output(number - 161, |output| output.power_on),
        261 => Ok(device.watchdog.enabled()),
        270 => Ok(device.watchdog.tripped()),
        274 => Ok(device.buzzer.sounds()),
        278 => Ok(device.buzzer.on_pir),
        _ => common::bit(device, number, via).ok_or(Exception::Address),
    }
}

pub(super) fn set_bit(device: &mut Device, number: u16, on: bool, via: Via) -> Result<(), Exception> {
    if closed(number, via) {
        return Err(Exception::Address);
    }
    match number {
        1..=2 => device.command_output(usize::from(number - 1), on)?,
        129..=130 => output(device, number - 129)?.safe = on,
        161..=162 => output(device, number - 161)?.power_on = on,
        261 => device.watchdog.enable(on, device.now()),
        274 => device.buzzer.command(on),
        278 => device.buzzer.on_pir = on,
        227 | 234 | 270 | 280 | 281 | 385..=389 | 417..=421 => {
            if on {
                act(device, number);
            }
        }
        _ => common::set_bit(device, number, on, via).ok_or(Exception::Address)??,
    }
    Ok(())
}

fn output(device: &mut Device, index: u16) -> Result<&mut Output, Exception> {
    device.outputs.get_mut(usize::from(index)).ok_or(Exception::Address)
}

/// "Write 1 to ...".
fn act(device: &mut Device, number: u16) {
    let now = *device.channels();
    match number {
        227 => {
            device.ethernet.reload_defaults();
            device.power_cycle(ResetCause::Software);
        }
        234 => device.power_cycle(ResetCause::Software),
        270 => device.watchdog.clear(),
        280 => device.extremes.clear_high(None, &now),
        281 => device.extremes.clear_low(None, &now),
        385..=389 => device.extremes.clear_high(Some(usize::from(number - 385)), &now),
        417..=421 => device.extremes.clear_low(Some(usize::from(number - 417)), &now),
        _ => (),
    }
}

pub(super) fn register(device: &Device, number: u16, via: Via) -> Result<u16, Exception> {
    let value = match number {
        1..=5 => device.channels().get(usize::from(number - 1)).copied().map(signed),
        450 => Some(signed(device.humidity_offset())),
        451 => Some(signed(device.temperature_offset())),
        490 => Some(device.trigger.enabled()),
        518 => Some(device.trigger.off_time_s()),
        521..=522 => device.outputs.get(usize::from(number - 521)).map(|output| output.source().code()),
        545..=549 => device.extremes.low(usize::from(number - 545)).map(signed),
        577..=581 => device.extremes.high(usize::from(number - 577)).map(signed),
        642..=720 => device.wifi.as_ref().and_then(|wifi| wifi.read(number)),
        _ => match via {
            Via::Serial => serial_register(device, number),
            Via::Tcp => tcp_register(device, number),
        }
        .or_else(|| common::register(device, number, via)),
    };
    value.ok_or(Exception::Address)
}

fn serial_register(device: &Device, number: u16) -> Option<u16> {
    match number {
        489 => Some(device.watchdog.timeout().into()),
        492 => Some(device.watchdog.trips()),
        _ => None,
    }
}

fn tcp_register(device: &Device, number: u16) -> Option<u16> {
    let (ethernet, identity) = (&device.ethernet, identity::of(device.model));
    let ([name, _], [firmware, _]) = (identity.name, identity.firmware);
    match number {
        272 => Some(ethernet.net_id().into()),
        352 => Some(firmware),
        556 => Some(ethernet.reset_cause as u16),
        558 => Some(ethernet.host_timeout_s()),
        559 => Some(0),
        560 => Some(name),
        564 => Some(ethernet.tcp_idle_s()),
        565 => Some(ethernet.reset_timeout_s()),
        _ => None,
    }
}

pub(super) fn set_register(device: &mut Device, number: u16, value: u16, via: Via) -> Result<(), Exception> {
    let result = match number {
        450 => Some(device.set_humidity_offset(unsigned(value))),
        451 => Some(device.set_temperature_offset(unsigned(value))),
        490 => Some(device.trigger.set_enabled(value)),
        518 => Some(device.trigger.set_off_time(value)),
        521..=522 => Some(set_source(device, number - 521, value)),
        642..=720 => device.wifi.as_mut().and_then(|wifi| wifi.write(number, value)),
        _ => match via {
            Via::Serial => set_serial_register(device, number, value),
            Via::Tcp => set_tcp_register(device, number, value),
        }
        .or_else(|| common::set_register(device, number, value, via)),
    };
    Ok(result.ok_or(Exception::Address)??)
}

fn set_source(device: &mut Device, index: u16, code: u16) -> Result<(), Refusal> {
    let source = Source::from_code(code)?;
    device.outputs.get_mut(usize::from(index)).ok_or(Refusal::Value)?.set_source(source);
    Ok(())
}

fn set_serial_register(device: &mut Device, number: u16, value: u16) -> Option<Result<(), Refusal>> {
    match number {
        489 => Some(device.watchdog.set_timeout(value, device.now())),
        492 => Some(device.watchdog.write_trips(value)),
        _ => None,
    }
}

fn set_tcp_register(device: &mut Device, number: u16, value: u16) -> Option<Result<(), Refusal>> {
    let ethernet = &mut device.ethernet;
    match number {
        272 => Some(ethernet.set_net_id(value)),
        558 => Some(ethernet.set_host_timeout(value)),
        564 => Some(ethernet.set_tcp_idle(value)),
        565 => Some(ethernet.set_reset_timeout(value)),
        _ => None,
    }
}
