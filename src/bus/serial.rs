//! Serial ports of the operating system.

#[cfg(any(windows, test))]
mod windows;

use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, DataBits, FlowControl, Parity, SerialPort, SerialPortType, StopBits};

use super::line::{Line, LineLost, sleep_until};
use super::ports::{PortInfo, UsbIdentity};
use super::problem::LineProblem;
use crate::protocol::{DataFormat, LineSettings};

/// A port that takes no bytes for so long has gone.
const WRITE_LIMIT: Duration = Duration::from_secs(2);
/// How long it is waited until it is looked whether somebody is in a hurry.
const WRITE_SLICE: Duration = Duration::from_millis(100);

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
    let described = found.into_iter().map(describe);
    #[cfg(windows)]
    return windows::as_in_the_device_manager(described);
    #[cfg(not(windows))]
    described.collect()
}

/// The system's name for the port that a person calls `text`: on Windows `com10`, `COM10:` and `\\.\COM10` are COM10.
pub fn port_name(text: &str) -> String {
    #[cfg(windows)]
    let text = &windows::port_name(text);
    text.to_owned()
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
            let serial = usb.serial_number;
            #[cfg(windows)]
            let serial = serial.filter(|serial| windows::is_of_device(serial));
            Some(UsbIdentity { vendor: usb.vid, product: usb.pid, serial, interface: usb.interface })
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
    #[cfg(windows)]
    if error.raw_os_error().is_some_and(windows::says_gone) {
        return LineLost::new("it was unplugged");
    }
    match error.kind() {
        io::ErrorKind::BrokenPipe | io::ErrorKind::NotFound => LineLost::new("it was unplugged"),
        io::ErrorKind::TimedOut => LineLost::new("the port takes no bytes"),
        _ => LineLost::new(error),
    }
}

/// What a failed request to an open port means.
fn failed(error: serialport::Error) -> LineLost {
    // On Windows such requests fail only when the port has gone, with one error or another, as the driver likes.
    match cfg!(windows) {
        true => LineLost::new(format!("it was unplugged ({})", error.description.trim_end_matches('.'))),
        false => LineLost::new(error),
    }
}

/// Why a port cannot be opened.
fn problem(name: &str, error: &serialport::Error) -> LineProblem {
    let present: Vec<String> = ports().into_iter().map(|port| port.name).collect();
    #[cfg(windows)]
    if let Some(kind) = windows::why_not_opened(name, &present) {
        return LineProblem { line: name.to_owned(), kind };
    }
    LineProblem::of_serial(name, error, present)
}

/// Converters powered from the port need both lines; ports without them (pseudo-terminals) say so, harmlessly.
fn raise_lines(port: &mut dyn SerialPort) {
    for outcome in [port.write_data_terminal_ready(true), port.write_request_to_send(true)] {
        if let Err(error) = outcome {
            log::debug!("DTR/RTS: {error}");
        }
    }
}

/// An open serial port.
pub struct SerialLine {
    port: Box<dyn SerialPort>,
    hurry: Arc<AtomicBool>,
}

impl SerialLine {
    pub fn open(name: &str, settings: LineSettings) -> Result<Self, LineProblem> {
        let name = port_name(name);
        let mut port = serialport::new(&name, settings.baud_rate.bps())
            .data_bits(DataBits::Eight)
            .flow_control(FlowControl::None)
            .timeout(Duration::from_millis(10))
            .open()
            .map_err(|error| problem(&name, &error))?;
        raise_lines(&mut *port);
        Ok(Self { port, hurry: Arc::default() })
    }

    /// Reads what has arrived, or arrives within `left`. `None` if nothing did, or the system let go of the wait.
    fn read(&mut self, buffer: &mut [u8], left: Duration) -> Result<Option<usize>, LineLost> {
        self.port.set_timeout(left).map_err(failed)?;
        match self.port.read(buffer) {
            // A terminal that was hung up reads as empty instead of failing.
            Ok(0) if !left.is_zero() => Err(LineLost::new("the port delivers nothing any more")),
            Ok(count) => Ok(Some(count)),
            // Some errors of Windows count as timeouts, such as that of a pulled adapter; the port tells whether it is there.
            Err(error) if error.kind() == io::ErrorKind::TimedOut => match error.raw_os_error() {
                Some(_) => self.look().map(|()| None),
                None => Ok(None),
            },
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(None),
            Err(error) => Err(lost(&error)),
        }
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
            .map_err(LineLost::new)?;
        // There each change of settings also sets both lines, which the library has at rest.
        if cfg!(windows) {
            raise_lines(&mut **port);
        }
        Ok(())
    }

    fn hurry_by(&mut self, hurry: Arc<AtomicBool>) {
        self.hurry = hurry;
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        self.port.set_timeout(WRITE_SLICE).map_err(failed)?;
        let (mut rest, began) = (bytes, Instant::now());
        while !rest.is_empty() {
            let taken = match self.port.write(rest) {
                Ok(count) => count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => 0,
                // An error of the system that counts as a timeout is more than that.
                Err(error) if error.kind() == io::ErrorKind::TimedOut && error.raw_os_error().is_none() => 0,
                Err(error) => return Err(lost(&error)),
            };
            rest = rest.get(taken..).unwrap_or_default();
            let waited = began.elapsed();
            let given_up = waited >= WRITE_LIMIT || (waited >= WRITE_SLICE && self.hurry.load(Ordering::Relaxed));
            if taken == 0 && given_up {
                return Err(LineLost::new("the port takes no bytes"));
            }
        }
        Ok(())
    }

    #[cfg(not(windows))]
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.read(buffer, left)? {
                Some(count) => return Ok(count),
                None if Instant::now() >= deadline => return Ok(0),
                None => {}
            }
        }
    }

    #[cfg(windows)]
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        use windows::Wait;
        loop {
            let arrived = self.port.bytes_to_read().map_err(failed)? > 0;
            let left = deadline.saturating_duration_since(Instant::now());
            match windows::wait(arrived, left) {
                Wait::Over => return Ok(0),
                Wait::Driver(time) => {
                    if let Some(count) = self.read(buffer, time)? {
                        return Ok(count);
                    }
                }
                Wait::Sleep => {}
            }
            // Also after the driver: one whose device has gone may return at once, again and again.
            std::thread::sleep(windows::LOOK_EVERY.min(left));
        }
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.port.clear(ClearBuffer::Input).map_err(failed)
    }

    fn look(&mut self) -> Result<(), LineLost> {
        self.port.bytes_to_read().map(|_| ()).map_err(failed)
    }

    fn now(&self) -> Instant {
        Instant::now()
    }

    fn wait_until(&mut self, instant: Instant) {
        sleep_until(instant);
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use rustix::pty::OpenptFlags;

    #[test]
    fn a_port_that_takes_no_bytes_is_given_up_and_at_once_by_somebody_in_a_hurry() {
        let master = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        rustix::pty::grantpt(&master).unwrap();
        rustix::pty::unlockpt(&master).unwrap();
        let name = rustix::pty::ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
        let mut line = SerialLine::open(&name, LineSettings::default()).unwrap();
        // The system keeps some bytes for a reader that does not read.
        while line.send(b"#").is_ok() {}
        line.hurry_by(Arc::new(AtomicBool::new(true)));
        let start = line.now();
        assert_eq!(line.send(b"#"), Err(LineLost::new("the port takes no bytes")));
        let took = line.now() - start;
        assert!((WRITE_SLICE..WRITE_LIMIT).contains(&took), "{took:?}");
    }
}
