//! By which clock times are told.

use jiff::{Timestamp, Zoned, tz::TimeZone};

use crate::ui::words::UNKNOWN;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Zone {
    #[default]
    Local,
    Utc,
}

impl Zone {
    pub fn of(utc: bool) -> Self {
        if utc { Self::Utc } else { Self::Local }
    }

    pub fn time_zone(self) -> TimeZone {
        match self {
            Self::Local => TimeZone::system(),
            Self::Utc => TimeZone::UTC,
        }
    }

    /// `None` beyond all calendars.
    pub fn zoned(self, seconds: f64) -> Option<Zoned> {
        // Whole microseconds, so that what was measured at 59.999 999 9 is not shown one second too early.
        let at = Timestamp::from_microsecond((seconds * 1e6).round() as i64).ok()?;
        Some(at.to_zoned(self.time_zone()))
    }

    /// In the words of `strftime`.
    pub fn text(self, seconds: f64, format: &str) -> String {
        self.zoned(seconds).map_or_else(|| UNKNOWN.to_owned(), |at| at.strftime(format).to_string())
    }

    /// Time of day with so many decimals of a second, three at most.
    pub fn clock(self, seconds: f64, decimals: u8) -> String {
        // Half of the last decimal is added by rounding, so that 59.9999 is the next second and not cut.
        let unit = 10f64.powi(-i32::from(decimals.min(3)));
        let rounded = (seconds / unit).round() * unit;
        let format = match decimals {
            0 => "%H:%M:%S",
            1 => "%H:%M:%S%.1f",
            2 => "%H:%M:%S%.2f",
            _ => "%H:%M:%S%.3f",
        };
        self.text(rounded, format)
    }

    /// Seconds by which this clock is ahead of UTC.
    pub fn offset(self, seconds: f64) -> f64 {
        self.zoned(seconds).map_or(0.0, |at| f64::from(at.offset().seconds()))
    }

    /// `UTC`, or `UTC+01:00`.
    pub fn name(self, seconds: f64) -> String {
        match self {
            Self::Utc => "UTC".to_owned(),
            Self::Local => self.text(seconds, "UTC%:z"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_what_is_shown() {
        assert_eq!(Zone::Utc.clock(59.9996, 3), "00:01:00.000");
        assert_eq!(Zone::Utc.clock(59.94, 1), "00:00:59.9");
        assert_eq!(Zone::Utc.clock(59.5, 0), "00:01:00");
        assert_eq!(Zone::Utc.name(0.0), "UTC");
        assert!(Zone::Local.name(0.0).starts_with("UTC+") || Zone::Local.name(0.0).starts_with("UTC-"));
        assert_eq!(Zone::Utc.clock(f64::INFINITY, 0), UNKNOWN);
    }
}
