//! How a simulated module is described in one word: `pir-234@1:modbus_rtu:9600`.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use crate::protocol::{BaudRate, DataFormat, LineSettings, Protocol};

/// Node addresses the rotary switch and DIP 3 can choose (PIR-234 manual 2.5, PIR-130 manual 1.5).
pub const SWITCH_ADDRESSES: RangeInclusive<u8> = 160..=191;
/// Addresses a Modbus slave can have; DCON also knows 0 and 248 to 255 (PIR-234 manual 6.1).
pub const MODBUS_ADDRESSES: RangeInclusive<u8> = 1..=247;

/// What kind of module is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Model {
    Pir130,
    /// The older sister of the PIR-234: behaves like it, under another name.
    Pir230,
    Pir234,
    /// A PIR-234 with Wi-Fi, and so with registers 642 to 720.
    Pir234Wf,
    /// A stranger on the line: answers, but has none of the family's registers.
    Unknown,
}

impl Model {
    pub const ALL: [Self; 5] = [Self::Pir130, Self::Pir230, Self::Pir234, Self::Pir234Wf, Self::Unknown];

    /// The word a specification begins with.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pir130 => "pir-130",
            Self::Pir230 => "pir-230",
            Self::Pir234 => "pir-234",
            Self::Pir234Wf => "pir-234-wf",
            Self::Unknown => "unknown",
        }
    }

    /// Whether the module also has an Ethernet port, and so speaks Modbus TCP.
    pub fn has_ethernet(self) -> bool {
        matches!(self, Self::Pir230 | Self::Pir234 | Self::Pir234Wf)
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// A simulated module as it is switched on, written `MODEL@ADDRESS` and then, in any order and separated by `:`,
/// a protocol (`dcon`, `modbus_rtu`), a speed, a data format (`n81`, `n82`, `e81`, `o81`), `checksum`, `init` and
/// `hardware`. What is left out has its factory value: Modbus RTU, 9600, N81, no checksum, both switches in their
/// software and normal positions. The address is decimal, `0x..` or `..h`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModuleSpec {
    pub model: Model,
    /// 1 to 247 with Modbus, 0 to 255 with DCON, 160 to 191 with `hardware`.
    pub address: u8,
    pub protocol: Protocol,
    pub settings: LineSettings,
    /// DCON frames carry a checksum.
    pub checksum: bool,
    /// DIP 4 on: speed, format, checksum and protocol can be changed.
    pub init: bool,
    /// DIP 2 off: the switches rule address and protocol, whatever is stored.
    pub hardware: bool,
}

/// Why a specification is none; each message says what is allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    #[error("\"{0}\" lacks its address: write MODEL@ADDRESS, such as pir-234@1 or pir-130@0xA0")]
    NoAddress(String),
    #[error("\"{word}\" is not a model: use {}", Model::ALL.map(Model::word).join(", "))]
    UnknownModel { word: String },
    #[error("\"{0}\" is not an address: use 0 to 255 in decimal, or hexadecimal as 0xA0 or A0h")]
    BadAddress(String),
    #[error(
        "\"{0}\" is not part of a module: use dcon, modbus_rtu, a speed such as 9600, n81, n82, e81, o81, checksum, \
         init or hardware"
    )]
    UnknownWord(String),
    #[error("\"{0}\" repeats or contradicts an earlier word")]
    Repeated(String),
    #[error("address {0} is impossible with Modbus: use 1 to 247")]
    NotAModbusAddress(u8),
    #[error("address {0} is impossible with \"hardware\": the switches give 160 to 191")]
    NotASwitchAddress(u8),
}

impl ModuleSpec {
    /// How it is reached.
    pub fn placing(&self) -> Placing {
        let Self { address, protocol, settings, checksum, init, hardware, .. } = *self;
        Placing { address, protocol, settings, checksum, init, hardware }
    }
}

/// What stands behind the `@` of a specification: how a simulated module is reached when it is switched on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Placing {
    pub address: u8,
    pub protocol: Protocol,
    pub settings: LineSettings,
    pub checksum: bool,
    pub init: bool,
    pub hardware: bool,
}

impl FromStr for ModuleSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        let head = text.split(':').next().unwrap_or_default();
        let (model, _) = head.split_once('@').ok_or_else(|| SpecError::NoAddress(head.to_owned()))?;
        let model = Model::ALL
            .into_iter()
            .find(|known| known.word().eq_ignore_ascii_case(model))
            .ok_or_else(|| SpecError::UnknownModel { word: model.to_owned() })?;
        let (_, place) = text.split_once('@').unwrap_or_default();
        let Placing { address, protocol, settings, checksum, init, hardware } = place.parse()?;
        Ok(Self { model, address, protocol, settings, checksum, init, hardware })
    }
}

impl fmt::Display for ModuleSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.model, self.placing())
    }
}

impl FromStr for Placing {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut words = text.trim().split(':');
        let address = words.next().unwrap_or_default();
        let address = read_address(address).ok_or_else(|| SpecError::BadAddress(address.to_owned()))?;
        let mut options = Options::default();
        for word in words {
            options.add(word.trim())?;
        }
        options.placing(address)
    }
}

impl fmt::Display for Placing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { address, protocol, settings, checksum, init, hardware } = self;
        write!(f, "{address}:{protocol}:{}:{}", settings.baud_rate, settings.data_format)?;
        for (present, word) in [(checksum, "checksum"), (init, "init"), (hardware, "hardware")] {
            if *present {
                write!(f, ":{word}")?;
            }
        }
        Ok(())
    }
}

/// The optional words of a specification, each at most once.
#[derive(Default)]
struct Options {
    protocol: Option<Protocol>,
    baud_rate: Option<BaudRate>,
    data_format: Option<DataFormat>,
    checksum: Option<()>,
    init: Option<()>,
    hardware: Option<()>,
}

impl Options {
    fn add(&mut self, word: &str) -> Result<(), SpecError> {
        let fresh = if let Some(protocol) = Protocol::SERIAL.into_iter().find(|known| same(known.word(), word)) {
            self.protocol.replace(protocol).is_none()
        } else if let Ok(baud_rate) = word.parse() {
            self.baud_rate.replace(baud_rate).is_none()
        } else if let Ok(data_format) = word.parse() {
            self.data_format.replace(data_format).is_none()
        } else if same("checksum", word) {
            self.checksum.replace(()).is_none()
        } else if same("init", word) {
            self.init.replace(()).is_none()
        } else if same("hardware", word) {
            self.hardware.replace(()).is_none()
        } else {
            return Err(SpecError::UnknownWord(word.to_owned()));
        };
        if fresh { Ok(()) } else { Err(SpecError::Repeated(word.to_owned())) }
    }

    fn placing(self, address: u8) -> Result<Placing, SpecError> {
        let protocol = self.protocol.unwrap_or(Protocol::ModbusRtu);
        let hardware = self.hardware.is_some();
        if hardware && !SWITCH_ADDRESSES.contains(&address) {
            return Err(SpecError::NotASwitchAddress(address));
        }
        if protocol.is_modbus() && !MODBUS_ADDRESSES.contains(&address) {
            return Err(SpecError::NotAModbusAddress(address));
        }
        Ok(Placing {
            address,
            protocol,
            settings: LineSettings {
                baud_rate: self.baud_rate.unwrap_or_default(),
                data_format: self.data_format.unwrap_or_default(),
            },
            checksum: self.checksum.is_some(),
            init: self.init.is_some(),
            hardware,
        })
    }
}

fn same(known: &str, word: &str) -> bool {
    known.eq_ignore_ascii_case(word)
}

/// Decimal, `0x..` or `..h`.
fn read_address(text: &str) -> Option<u8> {
    let text = text.trim().to_ascii_lowercase();
    let hexadecimal = text.strip_prefix("0x").or_else(|| text.strip_suffix('h'));
    let (digits, radix) = hexadecimal.map_or((text.as_str(), 10), |digits| (digits, 16));
    // `from_str_radix` alone would accept a sign.
    if digits.chars().all(|digit| digit.is_digit(radix)) { u8::from_str_radix(digits, radix).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(text: &str) -> ModuleSpec {
        text.parse().unwrap()
    }

    #[test]
    fn what_is_left_out_has_its_factory_value() {
        let factory = spec("pir-234@1");
        assert_eq!(factory.protocol, Protocol::ModbusRtu);
        assert_eq!(factory.settings, LineSettings::default());
        assert!(!factory.checksum && !factory.init && !factory.hardware);
    }

    #[test]
    fn an_address_is_decimal_or_hexadecimal_in_both_spellings() {
        for text in ["pir-130@163", "pir-130@0xA3", "pir-130@a3h"] {
            assert_eq!(spec(text).address, 163, "{text}");
        }
    }

    #[test]
    fn words_come_in_any_order() {
        assert_eq!(spec("pir-234@5:dcon:9600:e81:init"), spec("PIR-234@5:init:e81:dcon:9600"));
    }

    #[test]
    fn every_specification_reads_back_as_itself() {
        for text in [
            "pir-234@1:modbus_rtu:9600",
            "pir-130@0xA0:dcon:19200:checksum",
            "pir-234-wf@5:dcon:9600:e81:init",
            "pir-130@A3h:hardware",
            "unknown@17:o81:115200",
            "pir-230@0:dcon",
        ] {
            let module = spec(text);
            assert_eq!(spec(&module.to_string()), module, "{text}");
        }
    }

    #[test]
    fn a_refusal_says_what_is_allowed() {
        for (text, hint) in [
            ("pir-234", "MODEL@ADDRESS"),
            ("pir-235@1", "pir-234-wf"),
            ("pir-234@256", "0 to 255"),
            ("pir-234@+1", "0 to 255"),
            ("pir-234@", "0 to 255"),
            ("pir-234@1:9601", "9600"),
            ("pir-234@1:modbus_tcp", "modbus_rtu"),
            ("pir-234@1:dcon:modbus_rtu", "contradicts"),
            ("pir-234@0", "1 to 247"),
            ("pir-234@1:hardware", "160 to 191"),
        ] {
            let error = text.parse::<ModuleSpec>().unwrap_err().to_string();
            assert!(error.contains(hint), "{text}: {error}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = text.parse::<ModuleSpec>();
        }
    }
}
