//! The options that say which line, and which module on it.

use std::str::FromStr;
use std::time::Duration;

use clap::{ArgGroup, Args};

use super::capture::{CaptureFile, capture_file};
use super::stop::Stop;
use super::{Outcome, parse};
use crate::bus::{LineAddress, Target, Tuning, port_name};
use crate::protocol::{BaudRate, DataFormat, LineSettings, Protocol, parse_address};
use crate::sim::Fault;

/// Addresses of Modbus modules (PIR-234 manual 6.1).
const MODBUS_ADDRESSES: std::ops::RangeInclusive<u8> = 1..=247;

/// Which line.
#[derive(Debug, Clone, Args)]
#[group(skip)]
#[command(next_help_heading = "Line", group = ArgGroup::new("line").required(true))]
pub struct LineArgs {
    /// Serial port, such as COM3 or /dev/ttyUSB0 (`dcon-bench ports` lists them)
    #[arg(long, value_name = "NAME", group = "line")]
    port: Option<String>,
    /// Speed of the serial line in bits per second [default: 9600]
    #[arg(long, value_name = "BPS", conflicts_with = "tcp")]
    baud_rate: Option<BaudRate>,
    /// Parity and stop bits of the serial line: n81, n82, e81 or o81 [default: n81]
    #[arg(long, value_name = "FORMAT", conflicts_with = "tcp")]
    data_format: Option<DataFormat>,
    /// Modbus TCP to a module or gateway; the port number is 502 unless told
    #[arg(long, value_name = "HOST[:PORT]", group = "line", value_parser = LineAddress::tcp)]
    tcp: Option<LineAddress>,
    /// How long an answer is waited for, from the request's end to its first byte [default: 200ms]
    #[arg(long, value_name = "DURATION", value_parser = parse::timeout)]
    timeout: Option<Duration>,
    /// How often a read is asked again when no usable answer came; writes never are [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=5))]
    repeats: Option<u8>,
    /// A simulated line with five modules
    #[arg(long, group = "line")]
    demo: bool,
    /// What goes wrong on the simulated line, such as flipped=1% (`dcon-bench simulate --help` lists it all); repeatable
    #[arg(long, value_name = "KIND[=STRENGTH]", requires = "demo")]
    fault: Vec<Fault>,
    /// Write all traffic into this file: .pcapng for Wireshark, .txt or .log for text (`dcon-bench replay` reads both)
    #[arg(long, value_name = "FILE", value_parser = capture_file)]
    capture: Option<CaptureFile>,
}

impl LineArgs {
    pub fn address(&self) -> LineAddress {
        match (&self.port, &self.tcp) {
            (Some(port), _) => LineAddress::Serial { port: port_name(port) },
            (None, Some(tcp)) => tcp.clone(),
            (None, None) => self.demo(),
        }
    }

    fn demo(&self) -> LineAddress {
        let line = LineAddress::demo();
        if let LineAddress::Simulated { sim, .. } = &line {
            sim.set_faults(self.fault.iter().copied().collect());
        }
        line
    }

    pub fn settings(&self) -> LineSettings {
        LineSettings {
            baud_rate: self.baud_rate.unwrap_or_default(),
            data_format: self.data_format.unwrap_or_default(),
        }
    }

    /// How patient the line is with its modules.
    pub fn tuning(&self) -> Tuning {
        let usual = Tuning::default();
        let (timeout, repeats) = (self.timeout.unwrap_or(usual.timeout), self.repeats.unwrap_or(usual.repeats));
        Tuning { timeout, repeats }
    }

    /// The timeout, if one was given.
    pub fn given_timeout(&self) -> Option<Duration> {
        self.timeout
    }

    /// The speed, if one was given.
    pub fn given_baud_rate(&self) -> Option<BaudRate> {
        self.baud_rate
    }

    /// The data format, if one was given.
    pub fn given_data_format(&self) -> Option<DataFormat> {
        self.data_format
    }

    pub fn is_tcp(&self) -> bool {
        self.tcp.is_some()
    }

    /// Where the traffic is written to, if it is.
    pub fn capture(&self) -> Option<&CaptureFile> {
        self.capture.as_ref()
    }
}

/// Which module on the line.
#[derive(Debug, Clone, Args)]
#[group(skip)]
#[command(next_help_heading = "Module")]
pub struct ModuleArgs {
    /// Address of the module, over TCP its NetID: decimal, or hexadecimal as 0xA0 or A0h
    #[arg(long, value_name = "N", value_parser = parse_address)]
    address: u8,
    /// Protocol of the module on a serial line: modbus_rtu or dcon [default: modbus_rtu]
    #[arg(long, value_parser = parse::serial_protocol, conflicts_with = "tcp")]
    protocol: Option<Protocol>,
    /// The module uses checksums (DCON only)
    #[arg(long, conflicts_with = "tcp")]
    checksum: bool,
}

impl ModuleArgs {
    /// The module's place on `line`.
    pub fn target(&self, line: &LineArgs) -> Outcome<Target> {
        target(line, self.address, self.protocol, line.settings(), self.checksum)
    }
}

/// A module in one word, `ADDRESS[:PROTOCOL][:SPEED][:FORMAT][:checksum]`; what is left out is as the line has it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ModuleWord {
    pub address: u8,
    pub protocol: Option<Protocol>,
    pub baud_rate: Option<BaudRate>,
    pub data_format: Option<DataFormat>,
    pub checksum: bool,
}

impl FromStr for ModuleWord {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut words = text.trim().split(':').map(str::trim);
        let mut module = Self { address: parse_address(words.next().unwrap_or_default())?, ..Self::default() };
        for word in words {
            let fresh = if let Ok(protocol) = word.parse() {
                module.protocol.replace(protocol).is_none()
            } else if let Ok(baud_rate) = word.parse() {
                module.baud_rate.replace(baud_rate).is_none()
            } else if let Ok(data_format) = word.parse() {
                module.data_format.replace(data_format).is_none()
            } else if word.eq_ignore_ascii_case("checksum") {
                !std::mem::replace(&mut module.checksum, true)
            } else {
                return Err(format!(
                    "\"{word}\" is not part of a module: use modbus_rtu, dcon, a speed such as 9600, n81, n82, e81, o81 \
                     or checksum"
                ));
            };
            if !fresh {
                return Err(format!("\"{word}\" repeats or contradicts an earlier word"));
            }
        }
        Ok(module)
    }
}

impl ModuleWord {
    /// The module's place on `line`.
    pub fn target(&self, line: &LineArgs) -> Outcome<Target> {
        if line.is_tcp() && (self.baud_rate.is_some() || self.data_format.is_some()) {
            return Err(Stop::usage("speed and data format belong to serial lines: leave them out over TCP"));
        }
        let settings = LineSettings {
            baud_rate: self.baud_rate.unwrap_or(line.settings().baud_rate),
            data_format: self.data_format.unwrap_or(line.settings().data_format),
        };
        target(line, self.address, self.protocol, settings, self.checksum)
    }
}

fn target(
    line: &LineArgs,
    address: u8,
    protocol: Option<Protocol>,
    settings: LineSettings,
    checksum: bool,
) -> Outcome<Target> {
    let default = if line.is_tcp() { Protocol::ModbusTcp } else { Protocol::ModbusRtu };
    let protocol = protocol.unwrap_or(default);
    let label = protocol.label();
    if line.is_tcp() != (protocol == Protocol::ModbusTcp) {
        let line = if line.is_tcp() { "--tcp" } else { "a serial line" };
        return Err(Stop::usage(format!("{label} is not spoken over {line}")));
    }
    if checksum && protocol != Protocol::Dcon {
        return Err(Stop::usage("--checksum belongs to DCON: add --protocol dcon, or leave it out"));
    }
    if protocol.is_modbus() && !MODBUS_ADDRESSES.contains(&address) {
        return Err(Stop::usage(format!("address {address} is impossible with {label}: use 1 to 247")));
    }
    Ok(Target { address, protocol, settings, checksum })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_is_one_word() {
        let word: ModuleWord = "0xA0:dcon:19200:e81:checksum".parse().unwrap();
        assert_eq!((word.address, word.protocol, word.checksum), (160, Some(Protocol::Dcon), true));
        assert_eq!((word.baud_rate.map(BaudRate::bps), word.data_format), (Some(19_200), Some(DataFormat::E81)));
        assert_eq!("5".parse(), Ok(ModuleWord { address: 5, ..ModuleWord::default() }));
    }

    #[test]
    fn a_wrong_word_is_refused_with_what_is_allowed() {
        for (text, hint) in
            [("", "0 to 255"), ("pir@1", "0 to 255"), ("1:300", "9600"), ("1:dcon:modbus_rtu", "repeats")]
        {
            let error = text.parse::<ModuleWord>().unwrap_err();
            assert!(error.contains(hint), "{text}: {error}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = text.parse::<ModuleWord>();
        }
    }
}
