//! Serial ports of the operating system.

use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, DataBits, FlowControl, Parity, SerialPort, SerialPortType, StopBits};

use super::line::{Line, LineLost, sleep_until};
use super::ports::{PortInfo, UsbIdentity};
use super::problem::LineProblem;
use crate::protocol::{DataFormat, LineSettings};

/// A port that takes no bytes for so long has gone.
const WRITE_LIMIT: Duration = Duration::from_secs(2);

/// The serial ports that are there now, USB adapters first.
pub fn ports() -> Vec<PortInfo> {
    // The library panics where Linux has no such folder, as in some containers.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return Vec::new();
    }
    let mut found = serialport::available_ports().unwrap_or_else(|error| {
        log::warn!("the system does not list its serial ports: {error}");
        Vec::new()
    });
    found.sort_by_key(|port| (!matches!(port.port_type, SerialPortType::UsbPort(_)), port_order(&port.port_name)));
    found.into_iter().map(describe).collect()
}

/// COM10 comes after COM9.
fn port_order(name: &str) -> (String, u32) {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = name.get(stem.len()..).and_then(|digits| digits.parse().ok()).unwrap_or(0);
    (stem.to_owned(), number)
}

fn describe(port: serialport::SerialPortInfo) -> PortInfo {
    let description = match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            let words: Vec<&str> =
                [&usb.product, &usb.manufacturer].into_iter().flatten().map(String::as_str).collect();
            if words.is_empty() { format!("USB {:04x}:{:04x}", usb.vid, usb.pid) } else { words.join(", ") }
        }
        SerialPortType::BluetoothPort => "Bluetooth".to_owned(),
        SerialPortType::PciPort => "built in".to_owned(),
        SerialPortType::Unknown => String::new(),
    };
    let usb = match port.port_type {
        SerialPortType::UsbPort(usb) => {
            Some(UsbIdentity { vendor: usb.vid, product: usb.pid, serial: usb.serial_number, interface: usb.interface })
        }
        _ => None,
    };
    PortInfo { problem: why_not(&port.port_name), name: port.port_name, description, usb }
}

#[cfg(unix)]
fn why_not(name: &str) -> Option<String> {
    use rustix::fs::{Access, access};
    let allowed = access(name, Access::READ_OK | Access::WRITE_OK);
    (allowed == Err(rustix::io::Errno::ACCESS)).then(|| "no permission".to_owned())
}

#[cfg(not(unix))]
fn why_not(_name: &str) -> Option<String> {
    None
}

/// What a failed read or write of an open port means.
fn lost(error: &io::Error) -> LineLost {
    match error.kind() {
        io::ErrorKind::BrokenPipe | io::ErrorKind::NotFound => LineLost::new("it was unplugged"),
        _ => LineLost::new(error),
    }
}

/// An open serial port.
pub struct SerialLine {
    port: Box<dyn SerialPort>,
}

impl SerialLine {
    pub fn open(name: &str, settings: LineSettings) -> Result<Self, LineProblem> {
        let problem = |error| LineProblem::of_serial(name, &error, ports().into_iter().map(|port| port.name).collect());
        let mut port = serialport::new(name, settings.baud_rate.bps())
            .data_bits(DataBits::Eight)
            .flow_control(FlowControl::None)
            .timeout(Duration::from_millis(10))
            .open()
            .map_err(problem)?;
        // Converters powered from the port need both lines; ports without them (pseudo-terminals) say so, harmlessly.
        for outcome in [port.write_data_terminal_ready(true), port.write_request_to_send(true)] {
            if let Err(error) = outcome {
                log::debug!("{name}: DTR/RTS: {error}");
            }
        }
        Ok(Self { port })
    }
}

impl Line for SerialLine {
    fn configure(&mut self, settings: LineSettings) -> Result<(), LineLost> {
        let (parity, stop_bits) = match settings.data_format {
            DataFormat::N81 => (Parity::None, StopBits::One),
            DataFormat::N82 => (Parity::None, StopBits::Two),
            DataFormat::E81 => (Parity::Even, StopBits::One),
            DataFormat::O81 => (Parity::Odd, StopBits::One),
        };
        let port = &mut self.port;
        port.set_baud_rate(settings.baud_rate.bps())
            .and_then(|()| port.set_parity(parity))
            .and_then(|()| port.set_stop_bits(stop_bits))
            .and_then(|()| port.clear(ClearBuffer::Input))
            .map_err(LineLost::new)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        self.port.set_timeout(WRITE_LIMIT).map_err(LineLost::new)?;
        self.port.write_all(bytes).map_err(|error| lost(&error))
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            self.port.set_timeout(left).map_err(LineLost::new)?;
            match self.port.read(buffer) {
                // A terminal that was hung up reads as empty instead of failing.
                Ok(0) if !left.is_zero() => return Err(LineLost::new("the port delivers nothing any more")),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => return Ok(0),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(lost(&error)),
            }
        }
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.port.clear(ClearBuffer::Input).map_err(LineLost::new)
    }

    fn look(&mut self) -> Result<(), LineLost> {
        self.port.bytes_to_read().map(|_| ()).map_err(LineLost::new)
    }

    fn now(&self) -> Instant {
        Instant::now()
    }

    fn wait_until(&mut self, instant: Instant) {
        sleep_until(instant);
    }
}
