//! Why a module refuses what it has understood.

use std::ops::RangeInclusive;

/// DCON shows most of these as `?AA`, Modbus as an exception.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The value is outside its range.
    Value,
    /// The setting can be changed in INIT mode only.
    InitOff,
    /// The output is not switched by command.
    Linked,
    /// The host watchdog has tripped, and outputs hold their safe values.
    Tripped,
}

impl Refusal {
    pub fn unless_within(value: u16, range: RangeInclusive<u16>) -> Result<u16, Self> {
        if range.contains(&value) { Ok(value) } else { Err(Self::Value) }
    }
}
