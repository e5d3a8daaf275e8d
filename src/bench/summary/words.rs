//! How addresses, line settings and times are written.

use jiff::{Timestamp, tz::TimeZone};

use crate::bus::Target;
use crate::protocol::Protocol;

/// Stands for a value that is not known.
pub const UNKNOWN: &str = "–";

/// Decimal and hexadecimal, as on the module's switches: `160 (A0h)`.
pub fn address(address: u8) -> String {
    format!("{address} ({address:02X}h)")
}

/// `Modbus RTU 9600 N81`, `DCON 19200 N81 checksum`, `Modbus TCP`.
pub fn spoken(target: &Target) -> String {
    let Target { protocol, settings, checksum, .. } = target;
    if *protocol == Protocol::ModbusTcp {
        return protocol.label().to_owned();
    }
    let checksum = if *checksum { " checksum" } else { "" };
    format!("{} {settings}{checksum}", protocol.label())
}

/// `2026-03-02 09:30:00 +00:00`.
pub fn moment(at: Timestamp, zone: &TimeZone) -> String {
    at.to_zoned(zone.clone()).strftime("%Y-%m-%d %H:%M:%S %:z").to_string()
}

/// Time of day, with the date if that is not the day of `day`.
pub fn clock(at: Timestamp, day: Timestamp, zone: &TimeZone) -> String {
    let (at, day) = (at.to_zoned(zone.clone()), day.to_zoned(zone.clone()));
    let format = if at.date() != day.date() { "%Y-%m-%d %H:%M:%S" } else { "%H:%M:%S" };
    at.strftime(format).to_string()
}
