//! How a module is reached: what is stored, what is in force, and what only INIT mode may change.

use std::ops::RangeInclusive;
use std::time::Duration;

use crate::protocol::{BaudRate, DataFormat, LineSettings, Protocol};

use super::refusal::Refusal;
use super::spec::{MODBUS_ADDRESSES, ModuleSpec};

/// Response delay in milliseconds (PIR-234 manual 5.24, PIR-130 manual 2.23).
pub(super) const RESPONSE_DELAYS: RangeInclusive<u16> = 0..=30;

/// What takes effect at the next power-on only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Language {
    pub protocol: Protocol,
    pub settings: LineSettings,
    /// DCON frames carry a checksum.
    pub checksum: bool,
}

/// The RS-485 side of a module.
#[derive(Debug, Clone)]
pub(super) struct Comms {
    stored: Language,
    in_force: Language,
    address: u8,
    response_delay_ms: u16,
    /// TT of `$AA2`. The manuals print 40, even after a `%` with 20 (PIR-130 manual 2.2), but 00 after one with 00
    /// (PIR-234 manual 5.7).
    type_code: u8,
    /// DIP 4 is on.
    pub init: bool,
    /// DIP 2 is off: address and protocol are what the switches say, whatever is stored.
    switches: Option<(u8, Protocol)>,
}

impl Comms {
    pub fn new(spec: &ModuleSpec) -> Self {
        let ModuleSpec { address, protocol, settings, checksum, init, hardware, .. } = *spec;
        let language = Language { protocol, settings, checksum };
        Self {
            stored: language,
            in_force: language,
            address,
            response_delay_ms: 0,
            type_code: 0x40,
            init,
            switches: hardware.then_some((address, protocol)),
        }
    }

    /// What is stored comes into force, unless the switches rule it.
    pub fn power_on(&mut self) {
        self.in_force = self.stored;
        if let Some((_, protocol)) = self.switches {
            self.in_force.protocol = protocol;
        }
    }

    /// The address the module answers at.
    pub fn address(&self) -> u8 {
        self.switches.map_or(self.address, |(address, _)| address)
    }

    pub fn stored(&self) -> Language {
        self.stored
    }

    pub fn in_force(&self) -> Language {
        self.in_force
    }

    pub fn response_delay(&self) -> Duration {
        Duration::from_millis(u64::from(self.response_delay_ms))
    }

    pub fn response_delay_ms(&self) -> u16 {
        self.response_delay_ms
    }

    pub fn set_response_delay(&mut self, milliseconds: u16) -> Result<(), Refusal> {
        self.response_delay_ms = Refusal::unless_within(milliseconds, RESPONSE_DELAYS)?;
        Ok(())
    }

    pub fn type_code(&self) -> u8 {
        self.type_code
    }

    /// Takes effect at once, but with DIP 2 off only once the switches no longer rule.
    pub fn set_modbus_address(&mut self, address: u16) -> Result<(), Refusal> {
        let address = u8::try_from(address).ok().filter(|address| MODBUS_ADDRESSES.contains(address));
        self.address = address.ok_or(Refusal::Value)?;
        Ok(())
    }

    /// Stores `wanted` for the next power-on; a change needs INIT mode.
    pub fn store(&mut self, wanted: Language) -> Result<(), Refusal> {
        if wanted != self.stored && !self.init {
            return Err(Refusal::InitOff);
        }
        self.stored = wanted;
        Ok(())
    }

    pub fn store_protocol(&mut self, modbus: bool) -> Result<(), Refusal> {
        let protocol = if modbus { Protocol::ModbusRtu } else { Protocol::Dcon };
        self.store(Language { protocol, ..self.stored })
    }

    /// Register 486, and CC of `%AANNTTCCFF`: speed in bits 0 to 5, data format in bits 6 and 7.
    pub fn line_code(&self) -> u8 {
        baud_code(self.stored.settings.baud_rate) | format_code(self.stored.settings.data_format) << 6
    }

    pub fn store_line_code(&mut self, code: u16) -> Result<(), Refusal> {
        let settings = u8::try_from(code).ok().and_then(line_settings).ok_or(Refusal::Value)?;
        self.store(Language { settings, ..self.stored })
    }

    /// `%AANNTTCCFF` (PIR-234 manual 5.2): all or nothing.
    pub fn configure(&mut self, address: u8, type_code: u8, line: u8, format: u8) -> Result<(), Refusal> {
        let settings = line_settings(line).ok_or(Refusal::Value)?;
        let checksum = match format {
            0x00 => false,
            0x40 => true,
            _ => return Err(Refusal::Value),
        };
        if !matches!(type_code, 0x00 | 0x20 | 0x40) {
            return Err(Refusal::Value);
        }
        self.store(Language { settings, checksum, ..self.stored })?;
        self.address = address;
        self.type_code = if type_code == 0x00 { 0x00 } else { 0x40 };
        Ok(())
    }
}

/// 03 to 0A for 1200 to 115200 bps (PIR-234 manual 5.2, PIR-130 manual 1.9).
pub(super) fn baud_code(rate: BaudRate) -> u8 {
    match rate.bps() {
        1_200 => 0x03,
        2_400 => 0x04,
        4_800 => 0x05,
        9_600 => 0x06,
        19_200 => 0x07,
        38_400 => 0x08,
        57_600 => 0x09,
        _ => 0x0A,
    }
}

pub(super) fn baud_rate(code: u8) -> Option<BaudRate> {
    BaudRate::ALL.into_iter().find(|&rate| baud_code(rate) == code)
}

fn format_code(format: DataFormat) -> u8 {
    match format {
        DataFormat::N81 => 0b00,
        DataFormat::N82 => 0b01,
        DataFormat::E81 => 0b10,
        DataFormat::O81 => 0b11,
    }
}

fn line_settings(code: u8) -> Option<LineSettings> {
    let data_format = DataFormat::ALL.into_iter().find(|&format| format_code(format) == code >> 6)?;
    Some(LineSettings { baud_rate: baud_rate(code & 0x3F)?, data_format })
}
