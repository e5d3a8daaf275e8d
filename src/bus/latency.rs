//! The latency timer of USB adapters: how long an adapter holds back a few bytes in case that more come.

use std::path::Path;

use serde::Serialize;

use super::ports::PortInfo;

/// Longer than this an adapter is worth being set.
pub const GOOD_MS: u32 = 2;
/// FTDI, whose adapters have a latency timer of 16 ms as they come.
const FTDI: u16 = 0x0403;
/// Where Linux tells it.
const SYSTEM: &str = "/sys/bus/usb-serial/devices";

/// What the system tells of an adapter's latency timer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LatencyTimer {
    /// The port, such as `/dev/ttyUSB0`.
    pub port: String,
    /// `None` where the system does not tell.
    pub milliseconds: Option<u32>,
}

impl LatencyTimer {
    /// Of `port`, one of `ports`. `None` if it is no adapter that has such a timer.
    pub fn of_port(port: &str, ports: &[PortInfo]) -> Option<Self> {
        Self::under(Path::new(SYSTEM), port, ports)
    }

    /// With another place for what Linux tells.
    fn under(system: &Path, port: &str, ports: &[PortInfo]) -> Option<Self> {
        let milliseconds = cfg!(target_os = "linux").then(|| read(system, port)).flatten();
        let usb = ports.iter().find(|info| info.name == port).and_then(|info| info.usb.as_ref());
        let is_ftdi = usb.is_some_and(|usb| usb.vendor == FTDI);
        (milliseconds.is_some() || is_ftdi).then(|| Self { port: port.to_owned(), milliseconds })
    }

    /// Whether it costs time, or may.
    pub fn is_slow(&self) -> bool {
        self.milliseconds.is_none_or(|milliseconds| milliseconds > GOOD_MS)
    }

    /// How to set it to 1 ms.
    pub fn how_to_change(&self) -> String {
        if cfg!(windows) {
            return format!(
                "Device Manager, Ports, {}, Properties, Port Settings, Advanced, Latency Timer: 1 ms",
                self.port
            );
        }
        let name = name_of(&self.port);
        format!(
            "`echo 1 | sudo tee {SYSTEM}/{name}/latency_timer` sets it until the adapter is pulled; a udev rule makes it \
             last: ACTION==\"add\", SUBSYSTEM==\"usb-serial\", DRIVER==\"ftdi_sio\", ATTR{{latency_timer}}=\"1\" in \
             /etc/udev/rules.d/99-latency.rules"
        )
    }
}

/// `/dev/serial/by-id/…` leads to the name that the system knows.
fn name_of(port: &str) -> String {
    let real = std::fs::canonicalize(port).unwrap_or_else(|_| port.into());
    real.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn read(system: &Path, port: &str) -> Option<u32> {
    let text = std::fs::read_to_string(system.join(name_of(port)).join("latency_timer")).ok()?;
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::UsbIdentity;

    fn adapter(name: &str, vendor: u16) -> PortInfo {
        let usb = Some(UsbIdentity { vendor, product: 0x6001, serial: None, interface: None });
        PortInfo { name: name.to_owned(), description: String::new(), problem: None, usb }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_tells_the_timer_of_an_adapter_that_has_one() {
        let system = tempfile::tempdir().unwrap();
        let device = system.path().join("ttyUSB7");
        std::fs::create_dir(&device).unwrap();
        std::fs::write(device.join("latency_timer"), "16\n").unwrap();
        let timer = LatencyTimer::under(system.path(), "/dev/ttyUSB7", &[]).unwrap();
        assert_eq!(timer.milliseconds, Some(16));
        assert!(timer.is_slow());
        assert!(timer.how_to_change().contains("ttyUSB7/latency_timer") && timer.how_to_change().contains("udev"));
        std::fs::write(device.join("latency_timer"), "1\n").unwrap();
        assert!(!LatencyTimer::under(system.path(), "/dev/ttyUSB7", &[]).unwrap().is_slow());
        std::fs::write(device.join("latency_timer"), "soon").unwrap();
        assert_eq!(LatencyTimer::under(system.path(), "/dev/ttyUSB7", &[]), None);
    }

    #[test]
    fn an_ftdi_adapter_has_a_timer_even_where_the_system_does_not_tell() {
        let system = Path::new("/nowhere");
        let ports = [adapter("COM3", FTDI), adapter("COM4", 0x1A86)];
        let timer = LatencyTimer::under(system, "COM3", &ports).unwrap();
        assert!(timer.milliseconds.is_none() && timer.is_slow());
        assert_eq!(LatencyTimer::under(system, "COM4", &ports), None);
        assert_eq!(LatencyTimer::under(system, "COM5", &ports), None);
    }
}
