//! Times as text: ISO 8601 with offset and microseconds.

use jiff::fmt::temporal::DateTimePrinter;
use jiff::tz::TimeZone;

use super::ExportError;
use crate::record::objects::timestamp;
use crate::record::trend::Micros;

const PRINTER: DateTimePrinter = DateTimePrinter::new().precision(Some(6));

/// Writes times in one zone.
pub(super) struct Clock {
    zone: TimeZone,
    text: String,
}

impl Clock {
    pub fn new(zone: &TimeZone) -> Self {
        Self { zone: zone.clone(), text: String::new() }
    }

    /// `2026-03-02T10:30:00.000000+01:00`
    pub fn text(&mut self, at: Micros) -> Result<&str, ExportError> {
        let at = timestamp(at);
        self.text.clear();
        let printed = PRINTER.print_timestamp_with_offset(&at, self.zone.to_offset(at), &mut self.text);
        printed.map_err(|error| ExportError::Write(std::io::Error::other(error.to_string())))?;
        Ok(&self.text)
    }
}
