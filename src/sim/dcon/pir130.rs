//! Commands of the PIR-130 only. Its manual prints several answers in two ways (`!01..` and `>01..`, one digit and
//! two); what the syntax tables say is taken, and in commands one digit and two are understood.

use super::super::device::Device;
use super::super::refusal::Refusal;
use super::words::{argument, of_channel};
use super::{Outcome, Reply, common, done, read};

/// Digits of NN in `LCxC0NN`.
const ONE_OR_TWO: &[usize] = &[1, 2];

pub(super) fn execute(device: &mut Device, delimiter: char, command: &str) -> Outcome {
    match (delimiter, command) {
        ('$', "6") => Some(Ok(Reply::Bare(relay_status(device)))),
        ('@', "DI") => Some(Ok(Reply::Bare(inputs(device)))),
        ('$', _) => argument(command)
            .and_then(|(letter, rest)| arguments(device, letter, rest))
            .or_else(|| common::execute(device, delimiter, command)),
        _ => common::execute(device, delimiter, command),
    }
}

/// `!(Data)` of manual 2.4, without the address: two digits of relay, two reserved (01 in its example), and 00.
fn relay_status(device: &Device) -> String {
    format!("!{:02X}0100", device.output_bits() & 1)
}

/// `>AASOOII` of manual 2.9. II is 00 while the PIR is active, as its text has it; its example says the opposite.
fn inputs(device: &Device) -> String {
    let idle = u8::from(!device.trigger.any());
    let (address, mode) = (device.comms.address(), device.alarm.mode_digit());
    format!(">{address:02X}{mode}{:02X}{idle:02X}", device.output_bits() & 1)
}

fn arguments(device: &mut Device, letter: char, rest: &str) -> Outcome {
    let written = |lengths| of_channel(rest, lengths);
    match letter {
        '3' => done(written(&[4])?.and_then(|delay| device.trigger.set_active_delay(delay))),
        '4' => read(rest, format!("{:04X}", device.trigger.active_delay_ms())),
        '5' => done(written(ONE_OR_TWO)?.and_then(|code| device.set_lux_level(code))),
        '6' => read(rest, format!("{:02X}", device.lux_level)),
        '9' => done(written(ONE_OR_TWO)?.and_then(|mode| set_buzzer(device, mode))),
        'A' => read(rest, format!("{:02X}", u8::from(device.buzzer.on_pir))),
        'B' => done(written(ONE_OR_TWO)?.and_then(|value| device.set_sensitivity(value))),
        'C' => read(rest, format!("{:02X}", device.sensitivity)),
        _ => None,
    }
}

fn set_buzzer(device: &mut Device, mode: u16) -> Result<(), Refusal> {
    device.buzzer.on_pir = Refusal::unless_within(mode, 0..=1)? == 1;
    Ok(())
}
