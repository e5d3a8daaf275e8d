//! Lines that were opened before, each with its speed and format; an adapter by what it keeps when it is plugged in
//! elsewhere.

use serde::{Deserialize, Serialize};

use crate::bus::{KnownPort, LineAddress, MODBUS_TCP_PORT, PortInfo, UsbIdentity, port_name};
use crate::protocol::LineSettings;

/// Lines remembered.
pub const MOST: usize = 8;
/// Stands before a host, so that no port's name is taken for one.
const TCP_MARK: &str = "tcp://";

/// A line that was opened before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Kept")]
pub struct RecentLine {
    /// A port's name as it was then, or a host after `tcp://`.
    line: String,
    /// Speed and format with which it was opened; of a port only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<LineSettings>,
    /// What the system said of the port.
    #[serde(skip_serializing_if = "String::is_empty")]
    description: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    usb: Option<Usb>,
    /// Ports of other adapters that look the same.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    alike: Vec<String>,
}

/// As it stands in the file: with everything, or as earlier versions wrote it, by its name alone.
#[derive(Deserialize)]
#[serde(untagged)]
enum Kept {
    Name(String),
    Full {
        line: String,
        settings: Option<LineSettings>,
        #[serde(default)]
        description: String,
        usb: Option<Usb>,
        #[serde(default)]
        alike: Vec<String>,
    },
}

/// [`UsbIdentity`] as it is kept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Usb {
    vendor: u16,
    product: u16,
    #[serde(skip_serializing_if = "Option::is_none")]
    serial: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    interface: Option<u8>,
}

/// What kind of line it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place<'a> {
    /// By its name then.
    Port(&'a str),
    /// As it is typed: `HOST` or `HOST:PORT`.
    Tcp(&'a str),
}

/// Where a remembered line is now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Now<'a> {
    /// The system lists it, perhaps under another name.
    There(&'a PortInfo),
    /// An adapter that is not plugged in.
    Absent,
    /// The system does not list it, so that only opening it tells: a pseudo-terminal, or a host.
    Unlisted,
}

impl From<Kept> for RecentLine {
    fn from(kept: Kept) -> Self {
        match kept {
            Kept::Name(line) => Self { line, settings: None, description: String::new(), usb: None, alike: Vec::new() },
            Kept::Full { line, settings, description, usb, alike } => Self { line, settings, description, usb, alike },
        }
    }
}

impl From<&str> for RecentLine {
    fn from(line: &str) -> Self {
        Kept::Name(line.to_owned()).into()
    }
}

impl RecentLine {
    /// `None` for a simulated line, which is always there and needs no remembering.
    pub fn of(line: &LineAddress, settings: LineSettings, present: &[PortInfo]) -> Option<Self> {
        match line {
            LineAddress::Simulated { .. } => None,
            LineAddress::Tcp { host, port } => {
                Some(Self::from(format!("{TCP_MARK}{}", host_text(host, *port)).as_str()))
            }
            LineAddress::Serial { port } => {
                let bare = Self { settings: Some(settings), ..Self::from(port.as_str()) };
                let Some(KnownPort { port, alike }) = KnownPort::among(present.to_vec(), port) else {
                    return Some(bare);
                };
                let usb = port.usb.map(|UsbIdentity { vendor, product, serial, interface }| Usb {
                    vendor,
                    product,
                    serial,
                    interface,
                });
                Some(Self { description: port.description, usb, alike, ..bare })
            }
        }
    }

    pub fn place(&self) -> Place<'_> {
        self.line.strip_prefix(TCP_MARK).map_or(Place::Port(&self.line), Place::Tcp)
    }

    /// The host as it is typed, or the port's name as it was then.
    pub fn name(&self) -> &str {
        match self.place() {
            Place::Port(name) | Place::Tcp(name) => name,
        }
    }

    /// What the system said of the port when it was opened last; empty if it said nothing.
    pub fn description(&self) -> &str {
        &self.description
    }

    pub fn now<'a>(&self, present: &'a [PortInfo]) -> Now<'a> {
        let Place::Port(name) = self.place() else { return Now::Unlisted };
        let found = match &self.usb {
            None => present.iter().find(|port| port.name == name),
            Some(_) => self.known().find_again(present),
        };
        match found {
            Some(port) => Now::There(port),
            None if self.usb.is_some() => Now::Absent,
            None => Now::Unlisted,
        }
    }

    fn known(&self) -> KnownPort {
        let usb = self.usb.clone().map(|Usb { vendor, product, serial, interface }| UsbIdentity {
            vendor,
            product,
            serial,
            interface,
        });
        let port = PortInfo { name: self.line.clone(), description: self.description.clone(), problem: None, usb };
        KnownPort { port, alike: self.alike.clone() }
    }

    /// Itself, with what is known of its adapter since the system listed it, if it does not now.
    pub fn known_from(self, known: &[Self], present: &[PortInfo]) -> Self {
        let name = port_name(&self.line);
        if present.iter().any(|port| port.name == name) {
            return self;
        }
        match known.iter().find(|other| other.line == self.line && other.usb.is_some()) {
            Some(before) => Self { settings: self.settings, ..before.clone() },
            None => self,
        }
    }

    /// Whether it stands for `other` too: by its name, unless only `other` is an adapter, or as the same adapter at another
    /// place.
    pub fn replaces(&self, other: &Self) -> bool {
        let same_name = self.line == other.line && (self.usb.is_some() || other.usb.is_none());
        let same_adapter = self.usb.as_ref().is_some_and(|usb| usb.serial.is_some()) && self.usb == other.usb;
        same_name || same_adapter
    }

    /// Whether anything is known that can be remembered.
    pub fn is_empty(&self) -> bool {
        self.name().trim().is_empty()
    }
}

/// The host as it is typed; the usual port is left out.
fn host_text(host: &str, port: u16) -> String {
    match port {
        MODBUS_TCP_PORT => host.to_owned(),
        _ if host.contains(':') => format!("[{host}]:{port}"),
        _ => format!("{host}:{port}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Settings;
    use super::*;
    use crate::protocol::BaudRate;

    fn serial(port: &str) -> LineAddress {
        LineAddress::Serial { port: port.to_owned() }
    }

    fn adapter(name: &str, serial: &str) -> PortInfo {
        let usb = UsbIdentity { vendor: 0x0403, product: 0x6001, serial: Some(serial.to_owned()), interface: None };
        PortInfo { name: name.to_owned(), description: "FT232".to_owned(), problem: None, usb: Some(usb) }
    }

    fn fast() -> LineSettings {
        LineSettings { baud_rate: BaudRate::new(115_200).unwrap(), ..LineSettings::default() }
    }

    #[test]
    fn an_adapter_is_found_under_another_name_and_remembered_once() {
        let mut settings = Settings::default();
        settings.note_line(&serial("COM3"), fast(), &[adapter("COM3", "A1")]);
        let present = [adapter("COM3", "B2"), adapter("COM7", "A1")];
        assert_eq!(settings.recent_ports[0].now(&present), Now::There(&present[1]));
        assert_eq!(settings.recent_ports[0].now(&present[..1]), Now::Absent);
        assert_eq!(settings.recent_ports[0].settings, Some(fast()));
        settings.note_line(&serial("COM7"), LineSettings::default(), &present);
        assert_eq!(settings.recent_ports.len(), 1);
        assert_eq!(settings.recent_ports[0].name(), "COM7");
        assert_eq!(settings.recent_ports[0].settings, Some(LineSettings::default()));
    }

    #[test]
    fn what_is_known_of_an_adapter_outlives_a_list_without_it() {
        let mut settings = Settings::default();
        settings.note_line(&serial("COM3"), fast(), &[adapter("COM3", "A1")]);
        settings.note_line(&serial("COM3"), LineSettings::default(), &[]);
        assert_eq!(settings.recent_ports.len(), 1);
        assert_eq!(settings.recent_ports[0].settings, Some(LineSettings::default()));
        let present = [adapter("COM7", "A1")];
        assert_eq!(settings.recent_ports[0].now(&present), Now::There(&present[0]));
    }

    #[test]
    fn a_port_that_is_no_adapter_stands_beside_the_adapter_that_had_its_name() {
        let mut settings = Settings::default();
        settings.note_line(&serial("COM3"), fast(), &[adapter("COM3", "A1")]);
        let built_in = [PortInfo { usb: None, description: "built in".to_owned(), ..adapter("COM3", "") }];
        settings.note_line(&serial("COM3"), fast(), &built_in);
        let described: Vec<&str> = settings.recent_ports.iter().map(RecentLine::description).collect();
        assert_eq!(described, ["built in", "FT232"]);
        settings.note_line(&serial("COM3"), fast(), &[adapter("COM3", "A1")]);
        assert_eq!(settings.recent_ports.len(), 1, "the adapter has its name back");
    }

    #[test]
    fn what_is_no_adapter_is_known_by_its_name_only() {
        let pty = RecentLine::of(&serial("/dev/pts/3"), fast(), &[]).unwrap();
        assert_eq!(pty.now(&[]), Now::Unlisted);
        assert!(RecentLine::of(&LineAddress::demo(), fast(), &[]).is_none());
    }

    #[test]
    fn what_is_kept_reads_back_also_what_earlier_versions_kept() {
        let mut settings = Settings::default();
        settings.note_line(&serial("COM3"), fast(), &[adapter("COM3", "A1"), adapter("COM4", "A1")]);
        settings.note_line(&LineAddress::tcp("bench.local:1502").unwrap(), fast(), &[]);
        let text = toml::to_string(&settings).unwrap();
        assert_eq!(toml::from_str::<Settings>(&text).unwrap().recent_ports, settings.recent_ports, "{text}");
        let old: Settings = toml::from_str("recent_ports = ['COM3', 'tcp://host']").unwrap();
        assert_eq!(
            old.recent_ports.iter().map(RecentLine::place).collect::<Vec<_>>(),
            [Place::Port("COM3"), Place::Tcp("host")]
        );
    }

    #[test]
    fn a_recent_host_reads_back_as_the_same_line() {
        for typed in ["192.168.255.1", "bench.local:1502", "fe80::1", "[fe80::1]:1502"] {
            let line = LineAddress::tcp(typed).unwrap();
            let recent = RecentLine::of(&line, fast(), &[]).unwrap();
            assert_eq!(recent.place(), Place::Tcp(typed));
            assert_eq!(LineAddress::tcp(recent.name()).unwrap().to_string(), line.to_string());
        }
        let by_path = "/dev/serial/by-path/pci-0000:00:14.0-usb-0:1:1.0-port0";
        assert_eq!(RecentLine::from(by_path).place(), Place::Port(by_path));
    }
}
