//! What serial ports are like on Windows: their names, how they are waited for, and what their errors mean.

use std::time::Duration;

/// How often is looked for bytes where the driver's own wait would be too coarse.
pub const LOOK_EVERY: Duration = Duration::from_millis(1);
/// Drivers count a wait in ticks of the system's clock, of which there are 64 in a second.
const TICK: Duration = Duration::from_millis(16);
/// Never waited for: bytes that are there are given at once.
const AT_ONCE: Duration = Duration::from_millis(10);

/// Error codes of Windows (winerror.h).
mod code {
    pub const FILE_NOT_FOUND: i32 = 2;
    pub const ACCESS_DENIED: i32 = 5;
    pub const INVALID_HANDLE: i32 = 6;
    pub const NOT_READY: i32 = 21;
    pub const BAD_COMMAND: i32 = 22;
    pub const GEN_FAILURE: i32 = 31;
    pub const DEV_NOT_EXIST: i32 = 55;
    pub const NO_SUCH_DEVICE: i32 = 433;
    pub const OPERATION_ABORTED: i32 = 995;
    pub const IO_DEVICE: i32 = 1117;
    pub const DEVICE_NOT_CONNECTED: i32 = 1167;
    pub const DEVICE_REMOVED: i32 = 1617;
}

/// Whether a read or write that failed with `error` says that the port has gone. Drivers say it in many ways.
pub fn says_gone(error: i32) -> bool {
    use code::*;
    matches!(
        error,
        FILE_NOT_FOUND
            | ACCESS_DENIED
            | INVALID_HANDLE
            | NOT_READY
            | BAD_COMMAND
            | GEN_FAILURE
            | DEV_NOT_EXIST
            | NO_SUCH_DEVICE
            | OPERATION_ABORTED
            | IO_DEVICE
            | DEVICE_NOT_CONNECTED
            | DEVICE_REMOVED
    )
}

/// How to wait for the next bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wait {
    /// The driver waits for so long at most, and wakes at the first byte.
    Driver(Duration),
    /// So shortly that the driver would take too long: [`LOOK_EVERY`], then it is looked again.
    Sleep,
    Over,
}

/// The next part of a wait of which so much is `left`, when bytes have `arrived` or not.
pub fn wait(arrived: bool, left: Duration) -> Wait {
    match left.checked_sub(TICK) {
        _ if arrived => Wait::Driver(AT_ONCE),
        _ if left.is_zero() => Wait::Over,
        Some(coarse) if coarse >= LOOK_EVERY => Wait::Driver(coarse),
        _ => Wait::Sleep,
    }
}

/// The name under which Windows lists the port that a person calls `text`.
pub fn port_name(text: &str) -> String {
    let name = text.trim().replace('/', "\\");
    let name = [r"\\.\", r"\\?\"].iter().find_map(|prefix| name.strip_prefix(prefix)).unwrap_or(&name);
    let name = name.trim_end_matches(':').to_ascii_uppercase();
    let is_com = |name: &str| {
        name.strip_prefix("COM").is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
    };
    if is_com(&name) { name } else { text.to_owned() }
}

/// Whether this serial number is the adapter's own. To one without Windows gives an identifier by its place, such as
/// `6&2c1b3a5&0&2`, of which the number before the first `&` remains here.
pub fn is_of_device(serial: &str) -> bool {
    serial.len() > 2
}

#[cfg(windows)]
pub use system::{as_in_the_device_manager, why_not_opened};

#[cfg(windows)]
mod system {
    use std::collections::BTreeMap;
    use std::fs::OpenOptions;
    use std::sync::{Mutex, PoisonError};

    use windows_registry::{Key, LOCAL_MACHINE};

    use super::code::{ACCESS_DENIED, FILE_NOT_FOUND};
    use crate::bus::adapters::adapters_without_port;
    use crate::bus::ports::PortInfo;
    use crate::bus::problem::ProblemKind;

    /// Where Windows keeps what it knows of devices, by bus, device and place.
    const DEVICES: &str = r"SYSTEM\CurrentControlSet\Enum";
    /// Buses with many devices, none of which is a port.
    const WITHOUT_PORTS: [&str; 4] = ["DISPLAY", "HID", "STORAGE", "SWD"];
    const PATH_NOT_FOUND: i32 = 3;
    const SHARING_VIOLATION: i32 = 32;
    const INVALID_NAME: i32 = 123;
    const BAD_PATHNAME: i32 = 161;

    /// What was looked up already, as it takes some milliseconds: by port, empty where there is no name.
    static KNOWN: Mutex<BTreeMap<String, String>> = Mutex::new(BTreeMap::new());

    /// The ports with the names that the device manager shows for them, such as `Communications Port (COM1)`.
    pub fn as_in_the_device_manager(ports: impl Iterator<Item = PortInfo>) -> Vec<PortInfo> {
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let mut ports: Vec<_> = ports.filter(|port| !port.name.is_empty()).collect();
        for port in ports.iter_mut().filter(|port| port.description.is_empty()) {
            if !known.contains_key(&port.name) {
                known.extend(friendly_names());
            }
            port.description.clone_from(known.entry(port.name.clone()).or_default());
        }
        ports
    }

    /// What the device manager calls each port; empty where several devices have had it, of which most are not there.
    fn friendly_names() -> BTreeMap<String, String> {
        let mut names = BTreeMap::new();
        let Ok(devices) = LOCAL_MACHINE.open(DEVICES) else { return names };
        let buses = below(&devices).filter(|(name, _)| !WITHOUT_PORTS.contains(&name.as_str()));
        let kinds = buses.flat_map(|(_, bus)| below(&bus).collect::<Vec<_>>());
        let places = kinds.flat_map(|(_, kind)| below(&kind).collect::<Vec<_>>());
        for (port, friendly) in places.filter_map(|(_, device)| name_of(&device)) {
            names.entry(port).and_modify(String::clear).or_insert(friendly);
        }
        names
    }

    fn below(key: &Key) -> impl Iterator<Item = (String, Key)> {
        key.keys().into_iter().flatten().filter_map(|name| key.open(&name).ok().map(|below| (name, below)))
    }

    fn name_of(device: &Key) -> Option<(String, String)> {
        let friendly = device.get_string("FriendlyName").ok()?;
        let port = device.open("Device Parameters").ok()?.get_string("PortName").ok()?;
        Some((port, friendly))
    }

    /// Why the port `name` cannot be opened, by the system's error code: the library tells only its text, in the language of
    /// the system. `None` if it is something else.
    pub fn why_not_opened(name: &str, present: &[String]) -> Option<ProblemKind> {
        let device = if name.starts_with('\\') { name.to_owned() } else { format!(r"\\.\{name}") };
        match OpenOptions::new().read(true).write(true).open(device) {
            Ok(_) if !present.iter().any(|port| port == name) => Some(ProblemKind::NotASerialPort),
            Ok(_) => None,
            Err(error) => match error.raw_os_error()? {
                ACCESS_DENIED | SHARING_VIOLATION => Some(ProblemKind::Busy { by: None }),
                FILE_NOT_FOUND | PATH_NOT_FOUND | INVALID_NAME | BAD_PATHNAME => {
                    Some(ProblemKind::NoSuchPort { present: present.to_vec(), portless: adapters_without_port() })
                }
                _ => None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_is_known_by_whatever_a_person_calls_it() {
        for text in ["COM10", "com10", " Com10 ", "COM10:", r"\\.\COM10", "//./com10", r"\\?\COM10"] {
            assert_eq!(port_name(text), "COM10", "{text}");
        }
    }

    #[test]
    fn names_of_other_kinds_of_port_stay_as_they_are() {
        for text in [r"\\.\CNCA0", "CNCA0", "COM", "COMPASS1", ""] {
            assert_eq!(port_name(text), text);
        }
    }

    #[test]
    fn a_long_wait_is_the_drivers_but_for_its_last_tick() {
        assert_eq!(wait(false, Duration::from_millis(200)), Wait::Driver(Duration::from_millis(184)));
        assert_eq!(wait(false, Duration::from_millis(17)), Wait::Driver(Duration::from_millis(1)));
    }

    #[test]
    fn a_short_wait_is_looked_through_and_ends() {
        for micros in [1, 900, 4_000, 16_900] {
            assert_eq!(wait(false, Duration::from_micros(micros)), Wait::Sleep, "{micros} µs");
        }
        assert_eq!(wait(false, Duration::ZERO), Wait::Over);
    }

    #[test]
    fn what_has_arrived_is_read_even_if_the_time_is_over() {
        for left in [Duration::ZERO, Duration::from_secs(1)] {
            assert!(matches!(wait(true, left), Wait::Driver(time) if !time.is_zero()));
        }
    }

    #[test]
    fn a_serial_number_by_place_is_none() {
        assert!(is_of_device("A702TB52A") && is_of_device("0001"));
        assert!(!is_of_device("6") && !is_of_device("10") && !is_of_device(""));
    }

    #[test]
    fn a_pulled_adapter_is_told_from_other_errors() {
        for gone in [5, 22, 31, 433, 995, 1167, 1617] {
            assert!(says_gone(gone), "{gone}");
        }
        // A wrong parameter, and a write that takes too long.
        assert!(!says_gone(87) && !says_gone(121));
    }
}
