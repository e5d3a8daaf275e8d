//! USB adapters that are plugged in without a port to open, and who holds a port that is busy: what Linux tells of both,
//! and Windows of the former.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// Makers of USB adapters by their number, and the driver that Linux has for them.
const MAKERS: [(u16, &str, &str); 4] = [
    (0x0403, "FTDI", "ftdi_sio"),
    (0x067B, "Prolific", "pl2303"),
    (0x10C4, "Silicon Labs", "cp210x"),
    (0x1A86, "WCH", "ch341"),
];
/// Processes looked through at most for one that holds a port.
const MOST_PROCESSES: usize = 10_000;

/// An adapter that is plugged in, but cannot be opened as a port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WithoutPort {
    pub maker: &'static str,
    pub vendor: u16,
    pub product: u16,
    pub reason: NoPort,
}

/// Why there is no port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoPort {
    /// The screen reader for braille displays takes adapters with the numbers of such a display.
    Brltty,
    /// Another program has taken it away from the system.
    Taken,
    NoDriver {
        driver: &'static str,
    },
    /// Windows has the driver from the maker or its update service only.
    NoDriverOnWindows,
}

impl fmt::Display for WithoutPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} – {}", self.happened(), self.reason.next_step())
    }
}

impl WithoutPort {
    /// Which adapter it is, and why it has no port.
    pub fn happened(&self) -> String {
        let Self { maker, vendor, product, reason } = self;
        let cause = reason.cause();
        format!("An adapter of {maker} ({vendor:04x}:{product:04x}) is plugged in, but has no port: {cause}")
    }
}

impl NoPort {
    fn cause(&self) -> &'static str {
        match self {
            Self::Brltty => "brltty, the screen reader for braille displays, takes it",
            Self::Taken => "a program uses it directly, such as a virtual machine",
            Self::NoDriver { .. } | Self::NoDriverOnWindows => "its driver is missing",
        }
    }

    /// What gives the adapter a port; begins with a small letter or a command.
    pub fn next_step(&self) -> String {
        match self {
            Self::Brltty => {
                "`sudo apt remove brltty`, or `sudo systemctl mask brltty-udev.service` to keep it, then plug the \
                             adapter in again"
                    .to_owned()
            }
            Self::Taken => "end that program, then plug the adapter in again".to_owned(),
            Self::NoDriver { driver } => format!(
                "`sudo modprobe {driver}`; if that says that there is none, install the package linux-modules-extra of \
                 this kernel"
            ),
            Self::NoDriverOnWindows => {
                "install its maker's driver; until then the Device Manager shows it under \"Other devices\"".to_owned()
            }
        }
    }
}

/// The adapters that are plugged in without a port. Empty on systems that do not tell.
pub fn adapters_without_port() -> Vec<WithoutPort> {
    if cfg!(windows) {
        without_driver(&devices_with_problems())
    } else if cfg!(target_os = "linux") {
        look_through(Path::new("/"))
    } else {
        Vec::new()
    }
}

/// Those of known makers among the devices that Windows lists as plugged in and not working. The words around them are in
/// the system's language; what is looked for is each device's own name, such as `USB\VID_1A86&PID_7523\5&2A1B`.
fn without_driver(listed: &str) -> Vec<WithoutPort> {
    let number = |line: &str, name: &str| {
        let digits = line.split_once(name)?.1.get(..4)?;
        u16::from_str_radix(digits, 16).ok()
    };
    let adapter = |line: &str| {
        let line = line.to_ascii_uppercase();
        let device = line.split_once("USB\\")?.1;
        let (vendor, product) = (number(device, "VID_")?, number(device, "PID_")?);
        let (_, maker, _) = *MAKERS.iter().find(|(number, ..)| *number == vendor)?;
        Some(WithoutPort { maker, vendor, product, reason: NoPort::NoDriverOnWindows })
    };
    let mut found: Vec<_> = listed.lines().filter_map(adapter).collect();
    found.sort_by_key(|adapter| (adapter.vendor, adapter.product));
    found
}

/// How long what Windows has told is believed: it takes a program of its own, and a lost line is looked for twice a second.
#[cfg(windows)]
const BELIEVED_FOR: std::time::Duration = std::time::Duration::from_secs(5);
/// Given to that program, and how long it is left alone if it takes longer.
#[cfg(windows)]
const LONGEST_ANSWER: std::time::Duration = std::time::Duration::from_secs(3);
#[cfg(windows)]
const LEFT_ALONE_FOR: std::time::Duration = std::time::Duration::from_secs(60);

/// What Windows tells of devices that are plugged in and have no driver (problem 28); empty where it does not tell.
#[cfg(windows)]
fn devices_with_problems() -> String {
    use std::os::windows::process::CommandExt;
    use std::sync::{Mutex, PoisonError};
    use std::time::Instant;
    const NO_WINDOW: u32 = 0x0800_0000;
    /// Until when it is believed, and what was told.
    static TOLD: Mutex<Option<(Instant, String)>> = Mutex::new(None);
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, text)) = told.as_ref().filter(|(until, _)| Instant::now() < *until) {
        return text.clone();
    }
    let mut command = std::process::Command::new("pnputil");
    command.args(["/enum-devices", "/connected", "/problem", "28"]).creation_flags(NO_WINDOW);
    let (text, believed_for) = match super::asked::answer_of(command, LONGEST_ANSWER) {
        Ok(text) => (text, BELIEVED_FOR),
        Err(error) => {
            log::debug!("pnputil does not tell of adapters: {error}");
            (String::new(), LEFT_ALONE_FOR)
        }
    };
    *told = Some((Instant::now() + believed_for, text.clone()));
    text
}

#[cfg(not(windows))]
fn devices_with_problems() -> String {
    String::new()
}

/// As [`adapters_without_port`], with the files of a system below `root`.
fn look_through(root: &Path) -> Vec<WithoutPort> {
    let devices = fs::read_dir(root.join("sys/bus/usb/devices")).into_iter().flatten().flatten();
    let mut found: Vec<_> = devices.filter_map(|device| without_port(root, &device.path())).collect();
    found.sort_by_key(|adapter| (adapter.vendor, adapter.product));
    found
}

fn without_port(root: &Path, device: &Path) -> Option<WithoutPort> {
    let number = |name: &str| {
        let text = fs::read_to_string(device.join(name)).ok()?;
        u16::from_str_radix(text.trim(), 16).ok()
    };
    let (vendor, product) = (number("idVendor")?, number("idProduct")?);
    let (_, maker, driver) = *MAKERS.iter().find(|(number, ..)| *number == vendor)?;
    let name = device.file_name()?.to_str()?;
    // The interfaces of device 1-2 are 1-2:1.0 and so on.
    let interfaces: Vec<PathBuf> = fs::read_dir(device)
        .ok()?
        .flatten()
        .filter(|entry| entry.file_name().to_str().is_some_and(|inner| inner.starts_with(&format!("{name}:"))))
        .map(|entry| entry.path())
        .collect();
    if interfaces.is_empty() || interfaces.iter().any(|interface| has_port(interface)) {
        return None;
    }
    let drivers: Vec<PathBuf> = interfaces.iter().filter_map(|path| fs::read_link(path.join("driver")).ok()).collect();
    let taken = drivers.iter().any(|driver| driver.ends_with("usbfs"));
    let reason = match taken {
        true if has_brltty(root) => NoPort::Brltty,
        true => NoPort::Taken,
        // Other interfaces of such a device, such as one for programming, have drivers of their own.
        false if drivers.is_empty() => NoPort::NoDriver { driver },
        false => return None,
    };
    Some(WithoutPort { maker, vendor, product, reason })
}

fn has_port(interface: &Path) -> bool {
    let entries = fs::read_dir(interface).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok()).any(|name| name.starts_with("tty"))
}

fn has_brltty(root: &Path) -> bool {
    ["usr/bin/brltty", "bin/brltty", "usr/sbin/brltty"].iter().any(|path| root.join(path).exists())
}

/// The program that has `port` open, with its number, if the system lets us see it.
pub fn holder(port: &str) -> Option<String> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let port = fs::canonicalize(port).ok()?;
    let is_process = |entry: &fs::DirEntry| entry.file_name().to_str().is_some_and(|name| name.parse::<u32>().is_ok());
    let processes = fs::read_dir("/proc").ok()?.flatten().filter(is_process).take(MOST_PROCESSES);
    let holds = |process: &PathBuf| {
        let files = fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
        files.map(|file| file.path()).any(|file| fs::read_link(file).is_ok_and(|target| target == port))
    };
    let process = processes.map(|entry| entry.path()).find(holds)?;
    let name = fs::read_to_string(process.join("comm")).ok()?;
    Some(format!("{} (process {})", name.trim(), process.file_name()?.to_str()?))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// A system with one adapter of WCH, whose interface has `driver` and perhaps a port.
    fn system(driver: Option<&str>, port: bool) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let device = root.path().join("sys/bus/usb/devices/1-2");
        let interface = device.join("1-2:1.0");
        fs::create_dir_all(&interface).unwrap();
        fs::write(device.join("idVendor"), "1a86\n").unwrap();
        fs::write(device.join("idProduct"), "7523\n").unwrap();
        if let Some(driver) = driver {
            std::os::unix::fs::symlink(format!("../../drivers/{driver}"), interface.join("driver")).unwrap();
        }
        if port {
            fs::create_dir(interface.join("ttyUSB0")).unwrap();
        }
        root
    }

    fn told(root: &tempfile::TempDir) -> Vec<String> {
        look_through(root.path()).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn an_adapter_with_a_port_is_no_trouble() {
        assert_eq!(told(&system(Some("ch341"), true)), Vec::<String>::new());
    }

    #[test]
    fn an_adapter_that_brltty_took_is_named_with_the_command_that_frees_it() {
        let root = system(Some("usbfs"), false);
        assert!(told(&root)[0].contains("a program uses it directly"), "{:?}", told(&root));
        fs::create_dir_all(root.path().join("usr/bin")).unwrap();
        fs::write(root.path().join("usr/bin/brltty"), "").unwrap();
        let told = told(&root);
        assert!(told[0].contains("1a86:7523") && told[0].contains("sudo apt remove brltty"), "{told:?}");
    }

    #[test]
    fn a_missing_driver_is_named_with_the_command_that_loads_it() {
        let told = told(&system(None, false));
        assert!(told[0].contains("sudo modprobe ch341"), "{told:?}");
    }

    #[test]
    fn a_system_without_such_files_tells_nothing() {
        assert_eq!(look_through(Path::new("/nowhere")), []);
    }
}

#[cfg(test)]
mod windows_tests {
    use super::*;

    /// As a German Windows tells it: an adapter, a keyboard and an adapter of another kind.
    const LISTED: &str = "Microsoft-PnP-Dienstprogramm\r\n\r\n\
        Instanz-ID:                 USB\\VID_1A86&PID_7523\\5&2a1b3c&0&2\r\n\
        Ger\u{e4}tebeschreibung:        USB Serial\r\nStatus:  Problem\r\nProblemcode: 28 (0x1C)\r\n\r\n\
        Instanz-ID:                 HID\\VID_1A86&PID_0001\\6&1\r\n\
        Instanz-ID:                 USB\\VID_046D&PID_C31C\\6&2\r\n\
        Instanz-ID:                 usb\\vid_0403&pid_6001\\A1B2\r\n";

    #[test]
    fn an_adapter_without_driver_is_named_whatever_the_language_and_the_other_ports() {
        let told: Vec<String> = without_driver(LISTED).iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(
            told[0].starts_with("An adapter of FTDI (0403:6001) is plugged in, but has no port: its driver is missing")
        );
        assert!(told[1].contains("WCH (1a86:7523)") && told[1].contains("Device Manager"), "{told:?}");
    }

    #[test]
    fn a_system_that_does_not_tell_has_no_adapter_without_driver() {
        for listed in ["", "USB\\VID_", "USB\\VID_1A86", "USB\\VID_1A8\u{e4}&PID_7523", "\u{fffd}USB\\PID_7523"] {
            assert_eq!(without_driver(listed), [], "{listed}");
        }
    }
}
