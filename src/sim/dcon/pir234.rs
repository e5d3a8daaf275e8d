//! Commands of the PIR-234 only.

use super::super::device::Device;
use super::super::outputs::Source;
use super::super::refusal::Refusal;
use super::words::{argument, decimal, hex, of_channel, signed};
use super::{Outcome, Reply, common, data, done, read};

pub(super) fn execute(device: &mut Device, delimiter: char, command: &str) -> Outcome {
    let own = match delimiter {
        '#' => measure(device, command),
        '$' => dollar(device, command),
        '~' => tilde(device, command),
        '@' => at(device, command),
        _ => None,
    };
    own.or_else(|| common::execute(device, delimiter, command))
}

/// `#AA` has the first three channels, as in the example of manual 5.3, and `#AAN` has one of five.
fn measure(device: &Device, command: &str) -> Outcome {
    let channels = match command {
        "" => device.channels().get(..3)?,
        _ => std::slice::from_ref(device.channels().get(channel(command)?)?),
    };
    let values: String = channels.iter().copied().map(decimal).collect();
    Some(Ok(Reply::Bare(format!(">{values}"))))
}

/// 0 to 4.
fn channel(digit: &str) -> Option<usize> {
    hex(digit, 1).filter(|&channel| channel <= 4).map(usize::from)
}

fn dollar(device: &mut Device, command: &str) -> Outcome {
    match command {
        "6" => data(format!("{:02X}", device.trigger.enabled())),
        "I" => data(if device.comms.init { "0" } else { "1" }),
        _ => match command.strip_prefix('5').filter(|mask| !mask.is_empty()) {
            Some(mask) => done(device.trigger.set_enabled(hex(mask, 2)?)),
            None => arguments(device, argument(command)?),
        },
    }
}

fn arguments(device: &mut Device, (letter, rest): (char, &str)) -> Outcome {
    match letter {
        '2' => done(of_channel(rest, &[4])?.and_then(|delay| device.trigger.set_active_delay(delay))),
        '3' if rest.is_empty() => data(format!("{:04X}", device.trigger.active_delay_ms())),
        '9' => done(of_channel(rest, &[2])?.and_then(|bits| set_configuration(device, bits))),
        'A' => read(rest, format!("{:02X}", configuration(device))),
        'D' => done(device.trigger.set_off_time(hex(rest, 2)?)),
        'E' if rest.is_empty() => data(format!("{:02X}", device.trigger.off_time_s())),
        _ => None,
    }
}

/// NN of `$AALC9C0NN`: bit 0 buzzer, bits 1 and 2 source of DO0, bits 3 and 4 source of DO1.
fn configuration(device: &Device) -> u16 {
    let [first, second] = &device.outputs;
    u16::from(device.buzzer.on_pir) | first.source().code() << 1 | second.source().code() << 3
}

fn set_configuration(device: &mut Device, bits: u16) -> Result<(), Refusal> {
    let (first, second) = (Source::from_code(bits >> 1 & 3)?, Source::from_code(bits >> 3)?);
    device.buzzer.on_pir = bits & 1 != 0;
    for (output, source) in device.outputs.iter_mut().zip([first, second]) {
        output.set_source(source);
    }
    Ok(())
}

fn tilde(device: &mut Device, command: &str) -> Outcome {
    let now = device.now();
    let watchdog = &mut device.watchdog;
    match command {
        "0" => data(format!("{:02X}", u8::from(watchdog.enabled()) << 7 | u8::from(watchdog.tripped()) << 2)),
        "1" => {
            watchdog.clear();
            data("")
        }
        "2" => data(format!("{}{:02X}", u8::from(watchdog.enabled()), watchdog.timeout())),
        "4" => data(start_values(device)),
        _ => match command.split_at_checked(1)? {
            ("3", setting) => {
                let (enabled, timeout) = (hex(setting.get(..1)?, 1)?, hex(setting.get(1..)?, 2)?);
                // Enabled with no time it could not work.
                if enabled > 1 || (enabled, timeout) == (1, 0) {
                    return Some(Err(Refusal::Value));
                }
                watchdog.enable(enabled == 1, now);
                done(watchdog.set_timeout(timeout, now))
            }
            ("5", values) => done(set_start_values(device, hex(values, 4)?)),
            _ => None,
        },
    }
}

/// `0P0S` of `~AA4`: power-on and safe values, bit 0 for DO0.
fn start_values(device: &Device) -> String {
    let [first, second] = &device.outputs;
    let power_on = u8::from(first.power_on) | u8::from(second.power_on) << 1;
    let safe = u8::from(first.safe) | u8::from(second.safe) << 1;
    format!("{power_on:02X}{safe:02X}")
}

fn set_start_values(device: &mut Device, values: u16) -> Result<(), Refusal> {
    if values & !0x0303 != 0 {
        return Err(Refusal::Value);
    }
    for (index, output) in device.outputs.iter_mut().enumerate() {
        output.safe = values >> index & 1 != 0;
        output.power_on = values >> 8 >> index & 1 != 0;
    }
    Ok(())
}

fn at(device: &mut Device, command: &str) -> Outcome {
    match command {
        "DI" => data(inputs(device)),
        "HO" => data(decimal(device.humidity_offset())),
        "TO" => data(decimal(device.temperature_offset())),
        _ => {
            let (word, value) = command.split_at_checked(2)?;
            match word {
                "DO" => done(device.command_outputs(hex(value, 2)?)),
                "HO" => done(signed(value)?.and_then(|offset| device.set_humidity_offset(offset))),
                "TO" => done(signed(value)?.and_then(|offset| device.set_temperature_offset(offset))),
                _ => extremes(device, word, value),
            }
        }
    }
}

/// `S0OPP` of `@AADI`, manual 5.1: alarm mode, outputs, and whether any sensor sees someone.
fn inputs(device: &Device) -> String {
    let (mode, pir) = (device.alarm.mode_digit(), u8::from(device.trigger.any()));
    format!("{mode}{:02X}{pir:02X}", device.output_bits())
}

/// `CH`, `CL`, `CHN`, `CLN`, `RHN` and `RLN`; what is left (`RH`, `CHC0`) belongs to the alarm.
fn extremes(device: &mut Device, word: &str, digit: &str) -> Outcome {
    let now = *device.channels();
    let extremes = &mut device.extremes;
    match (word, digit) {
        ("CH", "") => extremes.clear_high(None, &now),
        ("CL", "") => extremes.clear_low(None, &now),
        ("CH", _) => extremes.clear_high(Some(channel(digit)?), &now),
        ("CL", _) => extremes.clear_low(Some(channel(digit)?), &now),
        ("RH", _) => return data(decimal(extremes.high(channel(digit)?)?)),
        ("RL", _) => return data(decimal(extremes.low(channel(digit)?)?)),
        _ => return None,
    }
    data("")
}
