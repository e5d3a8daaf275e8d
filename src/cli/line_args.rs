//! The options that say which line, and which module on it.

use clap::{ArgGroup, Args};

use super::stop::Stop;
use super::{Outcome, parse};
use crate::bus::{LineAddress, Target};
use crate::protocol::{BaudRate, DataFormat, LineSettings, Protocol, parse_address};

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
    /// A simulated line with five modules
    #[arg(long, group = "line")]
    demo: bool,
}

impl LineArgs {
    pub fn address(&self) -> LineAddress {
        match (&self.port, &self.tcp) {
            (Some(port), _) => LineAddress::Serial { port: port.clone() },
            (None, Some(tcp)) => tcp.clone(),
            (None, None) => LineAddress::demo(),
        }
    }

    pub fn settings(&self) -> LineSettings {
        LineSettings {
            baud_rate: self.baud_rate.unwrap_or_default(),
            data_format: self.data_format.unwrap_or_default(),
        }
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
        let protocol = if line.is_tcp() { Protocol::ModbusTcp } else { self.protocol.unwrap_or(Protocol::ModbusRtu) };
        if self.checksum && protocol != Protocol::Dcon {
            return Err(Stop::usage("--checksum belongs to DCON: add --protocol dcon, or leave it out"));
        }
        if protocol.is_modbus() && !MODBUS_ADDRESSES.contains(&self.address) {
            let label = protocol.label();
            return Err(Stop::usage(format!("address {} is impossible with {label}: use 1 to 247", self.address)));
        }
        Ok(Target { address: self.address, protocol, settings: line.settings(), checksum: self.checksum })
    }
}
