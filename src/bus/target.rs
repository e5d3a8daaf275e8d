//! Which line, and which module on it.

use std::fmt;
use std::ops::RangeInclusive;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::protocol::{LineSettings, Protocol};
use crate::sim::Sim;

/// Port of Modbus TCP (PIR-234 manual 3.5.1).
pub const MODBUS_TCP_PORT: u16 = 502;

/// A line that can be opened.
#[derive(Debug, Clone)]
pub enum LineAddress {
    /// A serial port by the system's name for it.
    Serial { port: String },
    /// Modbus TCP to one module.
    Tcp { host: String, port: u16 },
    /// A simulated line; the label is what people see.
    Simulated { label: String, sim: Sim },
}

impl LineAddress {
    pub fn demo() -> Self {
        Self::Simulated { label: "Simulated line".to_owned(), sim: Sim::demo() }
    }

    pub fn is_tcp(&self) -> bool {
        matches!(self, Self::Tcp { .. })
    }

    /// Reads `HOST` or `HOST:PORT`; an IPv6 address with a port stands in brackets.
    pub fn tcp(text: &str) -> Result<Self, String> {
        let wrong = || format!("\"{text}\" is not a host such as 192.168.255.1 or 192.168.255.1:502");
        let (host, port) = match text.rsplit_once(':') {
            Some((host, port)) if !host.contains(':') || host.starts_with('[') => {
                (host, port.parse().map_err(|_| wrong())?)
            }
            _ => (text, MODBUS_TCP_PORT),
        };
        let host = host.trim_start_matches('[').trim_end_matches(']');
        if host.is_empty() { Err(wrong()) } else { Ok(Self::Tcp { host: host.to_owned(), port }) }
    }
}

impl fmt::Display for LineAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { port } => f.write_str(port),
            Self::Tcp { host, port } => write!(f, "{host}:{port}"),
            Self::Simulated { label, .. } => f.write_str(label),
        }
    }
}

/// One module on a line, and how it is spoken to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Target {
    /// 0 to 255 for DCON, 1 to 247 for Modbus; over TCP the NetID.
    pub address: u8,
    pub protocol: Protocol,
    /// Without meaning over TCP.
    #[serde(flatten)]
    pub settings: LineSettings,
    /// DCON only.
    pub checksum: bool,
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "address {} ({:02X}h), {}", self.address, self.address, self.protocol.label())?;
        if self.protocol != Protocol::ModbusTcp {
            write!(f, " {}", self.settings)?;
        }
        if self.checksum { f.write_str(", checksum") } else { Ok(()) }
    }
}

/// What the user can set about how patient a line is with its modules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tuning {
    /// From the end of a request's last bit to the answer's first byte, in conversations and polls; within
    /// [`Self::TIMEOUTS`]. The vendor's utility waits 200 ms too (PIR-234 manual 4.3).
    pub timeout: Duration,
    /// How often a read is asked again when no usable answer came; within [`Self::REPEATS`]. Writes are never repeated.
    pub repeats: u8,
}

impl Tuning {
    pub const DEFAULT: Self = Self { timeout: Duration::from_millis(200), repeats: 2 };
    pub const TIMEOUTS: RangeInclusive<Duration> = Duration::from_millis(20)..=Duration::from_secs(5);
    pub const REPEATS: RangeInclusive<u8> = 0..=5;

    /// The nearest that is allowed.
    pub fn within_limits(self) -> Self {
        let (timeouts, repeats) = (Self::TIMEOUTS, Self::REPEATS);
        Self {
            timeout: self.timeout.clamp(*timeouts.start(), *timeouts.end()),
            repeats: self.repeats.clamp(*repeats.start(), *repeats.end()),
        }
    }
}

impl Default for Tuning {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How long to wait, and how often to ask again; repetitions of either kind count together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// From the end of the request's last bit to the answer's first byte.
    pub window: Duration,
    /// How often a read is repeated after silence.
    pub after_silence: u8,
    /// How often a read is repeated after an answer that could not be used.
    pub after_garbage: u8,
    /// How much more often a read is repeated after silence if speed or format were changed for it: the first exchange
    /// after a change is sometimes lost.
    pub after_change: u8,
}

impl Patience {
    /// For a module that is known to be there, unless the user has set something else.
    pub const CONVERSATION: Self = Self::of_valid(Tuning::DEFAULT);

    /// A module may store what is written before it answers. Writes are never repeated.
    pub const WRITE_WINDOW: Duration = Duration::from_millis(500);

    /// For a module that is known to be there.
    pub fn of(tuning: Tuning) -> Self {
        Self::of_valid(tuning.within_limits())
    }

    const fn of_valid(Tuning { timeout: window, repeats }: Tuning) -> Self {
        Self { window, after_silence: repeats, after_garbage: repeats, after_change: 1 }
    }

    /// For polls of a module that was silent before, which must not delay the others for longer than one window.
    pub fn probing(self) -> Self {
        Self { after_silence: 0, after_garbage: 0, after_change: 0, ..self }
    }

    /// For an address of which nothing is known.
    pub fn scan(window: Duration) -> Self {
        Self { window, after_silence: 0, after_garbage: 1, after_change: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tcp(text: &str) -> Option<(String, u16)> {
        match LineAddress::tcp(text) {
            Ok(LineAddress::Tcp { host, port }) => Some((host, port)),
            _ => None,
        }
    }

    #[test]
    fn a_host_may_have_a_port() {
        assert_eq!(tcp("192.168.255.1"), Some(("192.168.255.1".into(), 502)));
        assert_eq!(tcp("module.local:1502"), Some(("module.local".into(), 1502)));
        assert_eq!(tcp("[fe80::1]:1502"), Some(("fe80::1".into(), 1502)));
        assert_eq!(tcp("fe80::1"), Some(("fe80::1".into(), 502)));
        assert_eq!(tcp("host:99999"), None);
        assert_eq!(tcp(""), None);
    }

    proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = LineAddress::tcp(&text);
        }
    }
}
