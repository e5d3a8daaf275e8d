//! What both ends of a line have to agree on before a byte can be understood: speed, data format and protocol.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// A word that names none of the choices; the message lists those that exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{word}\" is not a {what}: use {allowed}")]
pub struct UnknownWord {
    pub what: &'static str,
    pub word: String,
    pub allowed: String,
}

impl UnknownWord {
    fn new<T: fmt::Display>(what: &'static str, word: &str, allowed: &[T]) -> Self {
        let allowed = allowed.iter().map(T::to_string).collect::<Vec<_>>().join(", ");
        Self { what, word: word.to_owned(), allowed }
    }
}

/// Serial speed in bits per second; only the eight speeds of the modules exist (PIR-234 manual 5.2, PIR-130 manual 1.9).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct BaudRate(u32);

impl BaudRate {
    pub const B9600: Self = Self(9_600);
    pub const ALL: [Self; 8] =
        [Self(1_200), Self(2_400), Self(4_800), Self(9_600), Self(19_200), Self(38_400), Self(57_600), Self(115_200)];

    /// The speed of `bits_per_second`, if the modules know it.
    pub fn new(bits_per_second: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|rate| rate.0 == bits_per_second)
    }

    /// Bits per second.
    pub fn bps(self) -> u32 {
        self.0
    }
}

impl Default for BaudRate {
    fn default() -> Self {
        Self::B9600
    }
}

impl fmt::Display for BaudRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl TryFrom<u32> for BaudRate {
    type Error = UnknownWord;

    fn try_from(bits_per_second: u32) -> Result<Self, Self::Error> {
        Self::new(bits_per_second)
            .ok_or_else(|| UnknownWord::new("baud rate", &bits_per_second.to_string(), &Self::ALL))
    }
}

impl From<BaudRate> for u32 {
    fn from(rate: BaudRate) -> Self {
        rate.0
    }
}

impl FromStr for BaudRate {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        word.trim().parse().ok().and_then(Self::new).ok_or_else(|| UnknownWord::new("baud rate", word, &Self::ALL))
    }
}

/// Parity and stop bits; there are always eight data bits (PIR-234 manual 5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DataFormat {
    /// No parity, one stop bit: the factory setting.
    #[default]
    N81,
    /// No parity, two stop bits.
    N82,
    /// Even parity, one stop bit.
    E81,
    /// Odd parity, one stop bit.
    O81,
}

impl DataFormat {
    pub const ALL: [Self; 4] = [Self::N81, Self::N82, Self::E81, Self::O81];

    /// Bits on the wire for one character: start, eight data bits, parity, stop.
    pub fn bits_per_character(self) -> u32 {
        match self {
            Self::N81 => 10,
            Self::N82 | Self::E81 | Self::O81 => 11,
        }
    }

    /// The word of the command line and of saved files.
    pub fn word(self) -> &'static str {
        match self {
            Self::N81 => "n81",
            Self::N82 => "n82",
            Self::E81 => "e81",
            Self::O81 => "o81",
        }
    }

    /// The way the manuals and the window write it, in capitals.
    pub fn label(self) -> &'static str {
        match self {
            Self::N81 => "N81",
            Self::N82 => "N82",
            Self::E81 => "E81",
            Self::O81 => "O81",
        }
    }
}

impl fmt::Display for DataFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl FromStr for DataFormat {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|format| format.word().eq_ignore_ascii_case(word.trim()))
            .ok_or_else(|| UnknownWord::new("data format", word, &Self::ALL))
    }
}

/// The language spoken with a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Protocol {
    ModbusRtu,
    Dcon,
    ModbusTcp,
}

impl Protocol {
    pub const ALL: [Self; 3] = [Self::ModbusRtu, Self::Dcon, Self::ModbusTcp];
    /// Those of a serial line, the likelier first (Modbus RTU is the factory setting).
    pub const SERIAL: [Self; 2] = [Self::ModbusRtu, Self::Dcon];

    /// The word of the command line and of saved files.
    pub fn word(self) -> &'static str {
        match self {
            Self::ModbusRtu => "modbus_rtu",
            Self::Dcon => "dcon",
            Self::ModbusTcp => "modbus_tcp",
        }
    }

    /// The name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::ModbusRtu => "Modbus RTU",
            Self::Dcon => "DCON",
            Self::ModbusTcp => "Modbus TCP",
        }
    }

    pub fn is_modbus(self) -> bool {
        self != Self::Dcon
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl FromStr for Protocol {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|protocol| protocol.word().eq_ignore_ascii_case(word.trim()))
            .ok_or_else(|| UnknownWord::new("protocol", word, &Self::ALL))
    }
}

/// Speed and format of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
pub struct LineSettings {
    pub baud_rate: BaudRate,
    pub data_format: DataFormat,
}

impl LineSettings {
    /// How long `characters` occupy the wire.
    pub fn wire_time(self, characters: usize) -> Duration {
        let bits = characters as u64 * u64::from(self.data_format.bits_per_character());
        Duration::from_nanos(bits.saturating_mul(1_000_000_000) / u64::from(self.baud_rate.bps()))
    }

    /// Whether what is sent with these can be read with `others`: a second stop bit is a pause to who expects one.
    pub fn is_read_at(self, others: Self) -> bool {
        let without_parity = |format| matches!(format, DataFormat::N81 | DataFormat::N82);
        let alike = without_parity(self.data_format) && without_parity(others.data_format);
        self.baud_rate == others.baud_rate && (alike || self.data_format == others.data_format)
    }

    /// The pause that separates two Modbus RTU frames: 3.5 characters, but 1.75 ms above 19200 bps
    /// (Modbus over serial line 1.02, 2.5.1.1).
    pub fn frame_silence(self) -> Duration {
        if self.baud_rate.bps() > 19_200 { Duration::from_micros(1_750) } else { self.wire_time(7) / 2 }
    }
}

impl fmt::Display for LineSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.baud_rate, self.data_format.label())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_reads_back_as_itself() {
        for rate in BaudRate::ALL {
            assert_eq!(rate.to_string().parse(), Ok(rate));
        }
        for format in DataFormat::ALL {
            assert_eq!(format.word().parse(), Ok(format));
        }
        for protocol in Protocol::ALL {
            assert_eq!(protocol.word().parse(), Ok(protocol));
        }
    }

    #[test]
    fn an_unknown_word_is_refused_with_the_allowed_ones() {
        let error = "9601".parse::<BaudRate>().unwrap_err().to_string();
        assert!(error.contains("9601") && error.contains("9600, 19200"), "{error}");
    }

    #[test]
    fn wire_time_counts_start_parity_and_stop_bits() {
        let slow = LineSettings { baud_rate: BaudRate::ALL[0], data_format: DataFormat::N81 };
        assert_eq!(slow.wire_time(12), Duration::from_millis(100));
        let even = LineSettings { baud_rate: BaudRate::B9600, data_format: DataFormat::E81 };
        assert_eq!(even.wire_time(96), Duration::from_millis(110));
    }

    #[test]
    fn frame_silence_is_fixed_above_19200() {
        let at = |bps| LineSettings { baud_rate: BaudRate(bps), data_format: DataFormat::N81 }.frame_silence();
        assert_eq!(at(115_200), Duration::from_micros(1_750));
        assert_eq!(at(9_600), Duration::from_nanos(3_645_833));
    }
}
