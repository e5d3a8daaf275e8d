//! Values of the command line that need more than `FromStr`.

use std::fmt::Display;
use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs};
use std::str::FromStr;
use std::time::Duration;

use crate::bus::Tuning;
use crate::protocol::{BaudRate, DataFormat, Protocol, parse_addresses};

/// Values separated by commas, each once, in the order given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct List<T>(pub Vec<T>);

impl<T: PartialEq> List<T> {
    fn collect<E: Display>(values: impl Iterator<Item = Result<Vec<T>, E>>) -> Result<Self, String> {
        let mut all = Vec::new();
        for values in values {
            for value in values.map_err(|error| error.to_string())? {
                if !all.contains(&value) {
                    all.push(value);
                }
            }
        }
        Ok(Self(all))
    }
}

/// `all`, or words separated by commas.
fn words<T: Clone + PartialEq, E: Display>(
    text: &str,
    all: &[T],
    read: impl Fn(&str) -> Result<T, E>,
) -> Result<List<T>, String> {
    if text.trim().eq_ignore_ascii_case("all") {
        return Ok(List(all.to_vec()));
    }
    List::collect(text.split(',').map(|word| read(word.trim()).map(|value| vec![value])))
}

/// Addresses and ranges of them, `1,160-191`.
pub fn addresses(text: &str) -> Result<List<u8>, String> {
    parse_addresses(text).map(List)
}

pub fn baud_rates(text: &str) -> Result<List<BaudRate>, String> {
    words(text, &BaudRate::ALL, BaudRate::from_str)
}

pub fn data_formats(text: &str) -> Result<List<DataFormat>, String> {
    words(text, &DataFormat::ALL, DataFormat::from_str)
}

pub fn protocols(text: &str) -> Result<List<Protocol>, String> {
    words(text, &Protocol::SERIAL, serial_protocol)
}

pub fn checksums(text: &str) -> Result<List<bool>, String> {
    words(text, &[false, true], |word| match word.to_ascii_lowercase().as_str() {
        "off" | "false" | "0" => Ok(false),
        "on" | "true" | "1" => Ok(true),
        _ => Err(format!("\"{word}\" is not a checksum setting: use off, on or off,on")),
    })
}

/// A protocol of serial lines.
pub fn serial_protocol(text: &str) -> Result<Protocol, String> {
    let known = Protocol::SERIAL.into_iter().find(|protocol| protocol.word().eq_ignore_ascii_case(text.trim()));
    known.ok_or_else(|| {
        let words = Protocol::SERIAL.map(Protocol::word).join(", ");
        format!(
            "\"{text}\" is not a protocol of serial lines: use {words} (for Modbus TCP give --tcp instead of --port)"
        )
    })
}

/// A duration such as `500ms`, `1s`, `2m`; `0` needs no unit.
pub fn duration(text: &str) -> Result<Duration, String> {
    match text.trim() {
        "0" => Ok(Duration::ZERO),
        text => humantime::parse_duration(text)
            .map_err(|_| format!("\"{text}\" is not a duration: use a number and a unit, such as 500ms, 1s or 2m")),
    }
}

/// How long a scan listens at an address.
pub fn window(text: &str) -> Result<Duration, String> {
    duration_within(text, Duration::from_millis(1), Duration::from_secs(10))
}

/// How long an answer is waited for.
pub fn timeout(text: &str) -> Result<Duration, String> {
    duration_within(text, *Tuning::TIMEOUTS.start(), *Tuning::TIMEOUTS.end())
}

/// Time from one set of readings to the next.
pub fn interval(text: &str) -> Result<Duration, String> {
    duration_within(text, Duration::ZERO, Duration::from_secs(24 * 60 * 60))
}

/// How long is recorded.
pub fn recording_time(text: &str) -> Result<Duration, String> {
    duration_within(text, Duration::from_millis(1), Duration::from_secs(10 * 365 * 24 * 60 * 60))
}

/// How long the whole program is put to the test.
pub fn soak_time(text: &str) -> Result<Duration, String> {
    duration_within(text, crate::soak::SHORTEST_RUN, crate::soak::LONGEST_RUN)
}

/// How long a simulated module takes to answer.
pub fn turnaround(text: &str) -> Result<Duration, String> {
    duration_within(text, Duration::ZERO, Duration::from_secs(10))
}

fn duration_within(text: &str, least: Duration, most: Duration) -> Result<Duration, String> {
    let given = duration(text)?;
    if (least..=most).contains(&given) {
        return Ok(given);
    }
    Err(format!("use {} to {}", humantime::format_duration(least), humantime::format_duration(most)))
}

/// Where to listen: an address with a port, or a port alone, which only this computer reaches.
pub fn listen(text: &str) -> Result<SocketAddr, String> {
    let text = text.trim();
    if let Ok(port) = text.trim_start_matches(':').parse::<u16>() {
        return Ok(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    }
    let found = text.to_socket_addrs().ok().and_then(|mut addresses| addresses.next());
    found.ok_or_else(|| format!("\"{text}\" is not an address and a port such as 127.0.0.1:1502"))
}

/// A new value for a parameter, `NAME=VALUE`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assignment {
    pub name: String,
    pub value: String,
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once('=') {
            Some((name, value)) if !name.trim().is_empty() => {
                Ok(Self { name: name.trim().to_owned(), value: value.to_owned() })
            }
            _ => Err("write NAME=VALUE, such as pir_on_time=33".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_stands_for_every_value() {
        assert_eq!(baud_rates("all").unwrap().0, BaudRate::ALL);
        assert_eq!(protocols("all").unwrap().0, Protocol::SERIAL);
        assert_eq!(protocols("dcon,modbus_rtu").unwrap().0, [Protocol::Dcon, Protocol::ModbusRtu]);
        assert_eq!(checksums("off,on").unwrap().0, [false, true]);
        assert!(baud_rates("9600,300").unwrap_err().contains("115200"));
        assert!(protocols("modbus_tcp").unwrap_err().contains("--tcp"));
    }

    #[test]
    fn zero_is_a_duration_without_a_unit() {
        assert_eq!(duration("0"), Ok(Duration::ZERO));
        assert_eq!(duration("500ms"), Ok(Duration::from_millis(500)));
        assert!(duration("5").unwrap_err().contains("unit"));
        assert!(window("0").unwrap_err().contains("1ms to 10s"));
        assert!(interval("100d").is_err());
    }

    #[test]
    fn only_this_computer_is_served_unless_told_otherwise() {
        assert_eq!(listen("1502").unwrap().to_string(), "127.0.0.1:1502");
        assert_eq!(listen("0.0.0.0:1502").unwrap().to_string(), "0.0.0.0:1502");
        assert!(listen("nowhere").is_err());
    }

    #[test]
    fn a_value_may_contain_an_equals_sign() {
        let assignment: Assignment = "wifi_ssid=a=b".parse().unwrap();
        assert_eq!((assignment.name.as_str(), assignment.value.as_str()), ("wifi_ssid", "a=b"));
        assert!("=1".parse::<Assignment>().is_err());
        assert!("do0".parse::<Assignment>().is_err());
    }
}
