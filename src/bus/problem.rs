//! Why a line cannot be opened, and what to do about it.

use std::fmt;

use super::adapters::{WithoutPort, adapters_without_port, holder};

/// A line that could not be opened: what happened and the step that cures it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LineProblem {
    pub line: String,
    pub kind: ProblemKind,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProblemKind {
    NoSuchPort {
        present: Vec<String>,
        /// Adapters that are plugged in and have no port.
        portless: Vec<WithoutPort>,
    },
    PermissionDenied,
    /// Held by this program, if the system tells.
    Busy {
        by: Option<String>,
    },
    NotASerialPort,
    NotReached(String),
    Other(String),
}

/// Why a lost line cannot be taken up although its adapter is there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Obstacle {
    NotOpened(LineProblem),
    WithoutPort(WithoutPort),
}

impl std::error::Error for LineProblem {}

impl fmt::Display for LineProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, kind } = self;
        match kind {
            ProblemKind::NoSuchPort { portless, .. } if !portless.is_empty() => {
                let told: Vec<String> = portless.iter().map(ToString::to_string).collect();
                write!(f, "There is no port {line}. {}", told.join(". "))
            }
            ProblemKind::NoSuchPort { present, .. } if present.is_empty() => {
                write!(
                    f,
                    "There is no port {line}, nor any other – plug in the adapter, or try the simulated line (--demo)"
                )?;
                if cfg!(windows) { f.write_str(NO_DRIVER_ON_WINDOWS) } else { Ok(()) }
            }
            ProblemKind::NoSuchPort { present, .. } => {
                write!(f, "There is no port {line} – present are {}", present.join(", "))?;
                if cfg!(windows) { f.write_str(NO_DRIVER_ON_WINDOWS) } else { Ok(()) }
            }
            ProblemKind::PermissionDenied if cfg!(windows) => {
                write!(f, "Access to {line} was denied – another program has it open: close it and try again")
            }
            ProblemKind::PermissionDenied => {
                write!(
                    f,
                    "No permission to open {line} – add yourself to its group with `sudo usermod -a -G dialout $USER`, \
                     then log out and in again"
                )
            }
            ProblemKind::Busy { by: Some(program) } => {
                write!(f, "{line} is in use by {program} – close that program and try again")
            }
            ProblemKind::Busy { by: None } => {
                write!(f, "{line} is in use by another program – close that program and try again")
            }
            ProblemKind::NotASerialPort => {
                write!(f, "{line} is not a serial port – `dcon-bench ports` lists those that are there")
            }
            ProblemKind::NotReached(reason) => {
                write!(f, "{line} could not be reached ({reason}) – check the cable, the address and the port number")
            }
            ProblemKind::Other(reason) => {
                write!(f, "{line} could not be opened: {reason} – unplug and replug the adapter")
            }
        }
    }
}

/// Where Windows shows an adapter that has no driver.
const NO_DRIVER_ON_WINDOWS: &str = "; if the adapter is plugged in, the Device Manager shows it under \"Other devices\": install its \
                                    maker's driver";

impl LineProblem {
    /// What a failed `open` of a serial port means. `present` are the ports that exist.
    pub fn of_serial(line: &str, error: &serialport::Error, present: Vec<String>) -> Self {
        use std::io::ErrorKind as Io;
        let text = error.description.to_ascii_lowercase();
        let kind = match error.kind() {
            serialport::ErrorKind::Io(Io::PermissionDenied) => ProblemKind::PermissionDenied,
            _ if text.contains("permission denied") || text.contains("access is denied") => {
                ProblemKind::PermissionDenied
            }
            _ if text.contains("typewriter")
                || text.contains("inappropriate ioctl")
                || text.contains("directory") && !text.contains("no such") =>
            {
                ProblemKind::NotASerialPort
            }
            _ if text.contains("busy") || text.contains("exclusive") => ProblemKind::Busy { by: holder(line) },
            serialport::ErrorKind::NoDevice if text.contains("no such") || !exists(line) => {
                ProblemKind::NoSuchPort { present, portless: adapters_without_port() }
            }
            serialport::ErrorKind::Io(Io::NotFound) => {
                ProblemKind::NoSuchPort { present, portless: adapters_without_port() }
            }
            _ if text.contains("cannot find the file") => {
                ProblemKind::NoSuchPort { present, portless: adapters_without_port() }
            }
            serialport::ErrorKind::NoDevice => ProblemKind::Busy { by: holder(line) },
            _ => ProblemKind::Other(error.description.clone()),
        };
        Self { line: line.to_owned(), kind }
    }
}

/// Windows names are not paths; there only the error's text tells.
fn exists(line: &str) -> bool {
    cfg!(windows) || std::path::Path::new(line).exists()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::{Error, ErrorKind};

    fn told(kind: ErrorKind, description: &str, present: &[&str]) -> String {
        let present = present.iter().map(|name| (*name).to_owned()).collect();
        LineProblem::of_serial("/dev/no-such-port", &Error::new(kind, description), present).to_string()
    }

    #[test]
    fn a_missing_port_is_told_with_those_that_are_there() {
        let text = told(ErrorKind::NoDevice, "No such file or directory", &["/dev/ttyUSB0", "/dev/ttyS0"]);
        assert_eq!(text, "There is no port /dev/no-such-port – present are /dev/ttyUSB0, /dev/ttyS0");
        let text = told(ErrorKind::Io(std::io::ErrorKind::NotFound), "No such file or directory", &[]);
        assert!(text.contains("--demo"), "{text}");
    }

    #[cfg(unix)]
    #[test]
    fn a_denied_port_names_the_group_and_the_command() {
        let text = told(ErrorKind::Io(std::io::ErrorKind::PermissionDenied), "Permission denied", &[]);
        assert!(text.contains("sudo usermod -a -G dialout $USER"), "{text}");
    }

    #[test]
    fn what_is_no_serial_port_is_told_as_such() {
        for description in ["Not a typewriter", "Is a directory", "Inappropriate ioctl for device"] {
            let text = told(ErrorKind::Unknown, description, &[]);
            assert!(text.contains("is not a serial port"), "{text}");
        }
    }

    #[test]
    fn a_busy_port_is_told_as_such() {
        for description in ["Device or resource busy", "Unable to acquire exclusive lock on serial port"] {
            let text = told(ErrorKind::NoDevice, description, &[]);
            assert!(text.contains("in use by another program"), "{text}");
        }
    }
}
