//! The ports that can be opened, and how an adapter is found again that was plugged in anew.

use serde::Serialize;

use super::serial;
use super::target::LineAddress;

/// A port that the system lists.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PortInfo {
    /// What to open: `COM3`, `/dev/ttyUSB0`.
    pub name: String,
    /// What it is: adapter and maker, as far as the system tells.
    pub description: String,
    /// Why it cannot be opened at this moment, where that is known without opening it.
    pub problem: Option<String>,
    /// What it keeps when it is plugged in elsewhere; `None` unless it is a USB adapter.
    pub usb: Option<UsbIdentity>,
}

/// What tells one USB adapter from another, whatever its port is called.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UsbIdentity {
    pub vendor: u16,
    pub product: u16,
    /// Cheap adapters have none.
    pub serial: Option<String>,
    /// Which port of an adapter with several.
    pub interface: Option<u8>,
}

/// Lists the ports that are there now.
pub type ListPorts = Box<dyn Fn() -> Vec<PortInfo> + Send>;

/// The ports on which `line` can be; a network has none.
pub fn ports_of(line: &LineAddress, system: &ListPorts) -> Vec<PortInfo> {
    match line {
        LineAddress::Serial { .. } => system(),
        LineAddress::Simulated { sim, .. } => sim.adapters().into_iter().map(simulated).collect(),
        LineAddress::Tcp { .. } => Vec::new(),
    }
}

fn simulated(adapter: crate::sim::Adapter) -> PortInfo {
    let crate::sim::Adapter { name, vendor, product, serial } = adapter;
    let usb = UsbIdentity { vendor, product, serial: Some(serial), interface: None };
    PortInfo { name, description: "Simulated adapter".to_owned(), problem: None, usb: Some(usb) }
}

/// A port that was opened, and those that look the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KnownPort {
    pub port: PortInfo,
    /// Names of other ports of the same identity that were there: adapters without serial numbers, or the other ports of
    /// an adapter with several.
    pub alike: Vec<String>,
}

impl KnownPort {
    /// The port `name` among those that are `present`.
    pub fn among(present: Vec<PortInfo>, name: &str) -> Option<Self> {
        let name = serial::port_name(name);
        let port = present.iter().find(|port| port.name == name)?.clone();
        let same = |other: &&PortInfo| other.name != port.name && other.usb.is_some() && other.usb == port.usb;
        let alike = present.iter().filter(same).map(|other| other.name.clone()).collect();
        Some(Self { port, alike })
    }

    /// The port that this one is now; `None` if it is not there.
    ///
    /// A USB adapter is known by its identity, wherever it is plugged in. Where several look the same, the name decides, and
    /// one that was another before is never taken for it. Any other port is known by its name.
    pub fn find_again<'a>(&self, present: &'a [PortInfo]) -> Option<&'a PortInfo> {
        let Self { port: known, alike } = self;
        let Some(identity) = &known.usb else {
            return present.iter().find(|port| port.name == known.name && port.usb.is_none());
        };
        let same: Vec<_> =
            present.iter().filter(|port| port.usb.as_ref() == Some(identity) && !alike.contains(&port.name)).collect();
        match same.as_slice() {
            [only] => Some(only),
            several => several.iter().copied().find(|port| port.name == known.name),
        }
    }
}

/// The serial ports of the system, USB adapters first.
pub fn ports() -> Vec<PortInfo> {
    serial::ports()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(name: &str, usb: Option<(u16, Option<&str>)>) -> PortInfo {
        let usb = usb.map(|(vendor, serial)| UsbIdentity {
            vendor,
            product: 0x6001,
            serial: serial.map(str::to_owned),
            interface: None,
        });
        PortInfo { name: name.to_owned(), description: String::new(), problem: None, usb }
    }

    fn found(known: &PortInfo, present: &[PortInfo]) -> Option<String> {
        let known = KnownPort::among(vec![known.clone()], &known.name)?;
        known.find_again(present).map(|port| port.name.clone())
    }

    #[test]
    fn an_adapter_with_a_serial_number_is_found_under_another_name() {
        let known = port("COM3", Some((0x0403, Some("A1"))));
        let present = [port("COM3", Some((0x0403, Some("B2")))), port("COM12", Some((0x0403, Some("A1"))))];
        assert_eq!(found(&known, &present), Some("COM12".to_owned()));
    }

    #[test]
    fn another_adapter_that_got_the_old_name_is_not_taken_for_it() {
        let known = port("/dev/ttyUSB0", Some((0x0403, Some("A1"))));
        assert_eq!(found(&known, &[port("/dev/ttyUSB0", Some((0x0403, Some("B2"))))]), None);
        assert_eq!(found(&known, &[port("/dev/ttyUSB0", Some((0x1A86, None)))]), None);
    }

    #[test]
    fn one_of_several_alike_without_serial_numbers_is_known_by_its_name_only() {
        let known = port("COM3", Some((0x1A86, None)));
        let other = port("COM4", Some((0x1A86, None)));
        assert_eq!(found(&known, std::slice::from_ref(&other)), Some("COM4".to_owned()));
        assert_eq!(found(&known, &[other.clone(), known.clone()]), Some("COM3".to_owned()));
        assert_eq!(found(&known, &[other.clone(), port("COM5", Some((0x1A86, None)))]), None);
    }

    #[test]
    fn a_port_that_is_no_usb_adapter_is_known_by_its_name() {
        let known = port("/dev/ttyS0", None);
        assert_eq!(found(&known, &[port("/dev/ttyS1", None), known.clone()]), Some("/dev/ttyS0".to_owned()));
    }

    #[test]
    fn another_adapter_of_the_same_kind_that_was_there_before_is_never_taken_for_it() {
        let (mine, other) = (port("USB0", Some((0x1A86, None))), port("USB1", Some((0x1A86, None))));
        let known = KnownPort::among(vec![mine.clone(), other.clone()], "USB0").unwrap();
        assert_eq!(known.find_again(std::slice::from_ref(&other)), None);
        let returned = port("USB2", Some((0x1A86, None)));
        assert_eq!(known.find_again(&[other, returned.clone()]), Some(&returned));
    }
}
