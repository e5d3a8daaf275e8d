//! A module's state by the public names of its parameters and readings, for tests to look past the wire.

use super::climate::Hundredths;
use super::device::Device;
use super::identity;
use super::outputs::{Output, Source};
use super::spec::Model;

/// The public textual form: decimal in the parameter's unit, `true` or `false`, or a word.
pub(super) fn read(device: &Device, name: &str) -> Option<String> {
    if device.model == Model::Unknown {
        return communication(device, name);
    }
    communication(device, name).or_else(|| both(device, name)).or_else(|| match device.model {
        Model::Pir130 => of_pir130(device, name),
        _ => of_pir234(device, name),
    })
}

fn communication(device: &Device, name: &str) -> Option<String> {
    let (comms, stored) = (&device.comms, device.comms.stored());
    Some(match name {
        "name" => identity::of(device.model).dcon_name.to_owned(),
        "firmware" => identity::of(device.model).dcon_firmware.to_owned(),
        "address" => comms.address().to_string(),
        "baud_rate" => stored.settings.baud_rate.to_string(),
        "data_format" => stored.settings.data_format.to_string(),
        "checksum" => stored.checksum.to_string(),
        "protocol" => stored.protocol.to_string(),
        "response_delay" => comms.response_delay_ms().to_string(),
        "init_mode" => comms.init.to_string(),
        _ => return None,
    })
}

fn both(device: &Device, name: &str) -> Option<String> {
    Some(match name {
        "reset_status" => device.reset_unread().to_string(),
        "pir_on_time" => device.trigger.on_time_s().to_string(),
        "pir_active_delay" => device.trigger.active_delay_ms().to_string(),
        "pir" => device.trigger.any().to_string(),
        "output_active_state" => if device.active_low { "low" } else { "high" }.to_owned(),
        "alarm_mode" => match device.alarm.mode_digit() {
            0 => "disabled",
            1 => "momentary",
            _ => "latched",
        }
        .to_owned(),
        "alarm_limit" => decimal(device.alarm.limit),
        "alarm_active" => device.alarm.active().to_string(),
        "buzzer_on_pir" => device.buzzer.on_pir.to_string(),
        "temperature_c" => decimal(device.channels().first().copied()?),
        _ => return None,
    })
}

fn of_pir130(device: &Device, name: &str) -> Option<String> {
    Some(match name {
        "lux_level" => match device.lux_level {
            0 => "disabled",
            1 => "100",
            2 => "200",
            3 => "500",
            _ => "1000",
        }
        .to_owned(),
        "sensitivity" => device.sensitivity.to_string(),
        "relay" => device.outputs.first()?.state().to_string(),
        _ => return None,
    })
}

fn of_pir234(device: &Device, name: &str) -> Option<String> {
    let (trigger, watchdog, ethernet) = (&device.trigger, &device.watchdog, &device.ethernet);
    Some(match name {
        "pir_off_time_on_start" => trigger.off_time_s().to_string(),
        "temperature_offset" => decimal(device.temperature_offset()),
        "humidity_offset" => decimal(device.humidity_offset()),
        "buzzer" => device.buzzer.sounds().to_string(),
        "wdt_enabled" => watchdog.enabled().to_string(),
        "wdt_timeout" => format!("{}.{}", watchdog.timeout() / 10, watchdog.timeout() % 10),
        "wdt_tripped" => watchdog.tripped().to_string(),
        "wdt_timeout_count" => watchdog.trips().to_string(),
        "net_id" => ethernet.net_id().to_string(),
        "reset_cause" => (ethernet.reset_cause as u16).to_string(),
        "ethernet_wdt_timeout" => ethernet.host_timeout_s().to_string(),
        "ethernet_wdt_count" => "0".to_owned(),
        "tcp_idle_timeout" => ethernet.tcp_idle_s().to_string(),
        "module_reset_timeout" => ethernet.reset_timeout_s().to_string(),
        _ => return numbered(device, name),
    })
}

/// Names of which there are several alike.
fn numbered(device: &Device, name: &str) -> Option<String> {
    if let Some(sensor) = name.strip_prefix("pir") {
        let (digit, word) = sensor.split_at_checked(1)?;
        let index = digit.parse::<usize>().ok()?.checked_sub(1).filter(|&index| index < 4)?;
        return match word {
            "" => Some(device.trigger.sensor(index).to_string()),
            "_enabled" => Some((device.trigger.enabled() >> index & 1 == 1).to_string()),
            _ => None,
        };
    }
    if let Some(output) = name.strip_prefix("do") {
        let (digit, word) = output.split_at_checked(1)?;
        return of_output(device.outputs.get(digit.parse::<usize>().ok()?)?, word);
    }
    // The names of single Wi-Fi settings are not fixed: `wifi_710` is what rules in register 710.
    if let Some(register) = name.strip_prefix("wifi_") {
        return Some(device.wifi.as_ref()?.in_force(register.parse().ok()?)?.to_string());
    }
    channel(device, name)
}

fn of_output(output: &Output, word: &str) -> Option<String> {
    Some(match word {
        "" => output.state().to_string(),
        "_power_on" => output.power_on.to_string(),
        "_safe" => output.safe.to_string(),
        "_source" => match output.source() {
            Source::Command => "command",
            Source::Pir => "pir",
            Source::Temperature => "temperature",
        }
        .to_owned(),
        _ => return None,
    })
}

fn channel(device: &Device, name: &str) -> Option<String> {
    let index = |name: &str| {
        ["temperature_c", "temperature_f", "humidity", "dew_point_c", "dew_point_f"]
            .iter()
            .position(|&known| known == name)
    };
    let value = if let Some(name) = name.strip_suffix("_high") {
        device.extremes.high(index(name)?)
    } else if let Some(name) = name.strip_suffix("_low") {
        device.extremes.low(index(name)?)
    } else {
        device.channels().get(index(name)?).copied()
    };
    value.map(decimal)
}

/// Hundredths with two decimals, such as `-1.25`.
fn decimal(value: Hundredths) -> String {
    let sign = if value < 0 { "-" } else { "" };
    let magnitude = value.unsigned_abs();
    format!("{sign}{}.{:02}", magnitude / 100, magnitude % 100)
}
