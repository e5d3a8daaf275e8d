//! The RS-485 host watchdog of the PIR-234 (manual 5.1, `~**` and `~AA0` to `~AA3`; coils 261 and 270, registers 489
//! and 492).

use std::time::Duration;

use super::refusal::Refusal;

#[derive(Debug, Clone, Default)]
pub(super) struct Watchdog {
    enabled: bool,
    /// In 0.1 s; 0 never trips.
    timeout: u8,
    tripped: bool,
    trips: u16,
    fed: Duration,
}

impl Watchdog {
    /// Bit 7 of `~AA0`. A trip disables the watchdog, which is how `~010` comes to answer `!0104`.
    pub fn enabled(&self) -> bool {
        self.enabled
    }

    pub fn enable(&mut self, enabled: bool, now: Duration) {
        self.enabled = enabled;
        self.fed = now;
    }

    /// In 0.1 s.
    pub fn timeout(&self) -> u8 {
        self.timeout
    }

    /// In 0.1 s, 0 to 255.
    pub fn set_timeout(&mut self, timeout: u16, now: Duration) -> Result<(), Refusal> {
        self.timeout = u8::try_from(timeout).map_err(|_| Refusal::Value)?;
        self.fed = now;
        Ok(())
    }

    /// Stored: only [`Self::clear`] ends it, not a power cycle.
    pub fn tripped(&self) -> bool {
        self.tripped
    }

    pub fn clear(&mut self) {
        self.tripped = false;
    }

    pub fn trips(&self) -> u16 {
        self.trips
    }

    /// "Write 0 to clear", and nothing else.
    pub fn write_trips(&mut self, trips: u16) -> Result<(), Refusal> {
        self.trips = Refusal::unless_within(trips, 0..=0)?;
        Ok(())
    }

    pub fn feed(&mut self, now: Duration) {
        self.fed = now;
    }

    pub fn live(&mut self, now: Duration) {
        let timeout = Duration::from_millis(u64::from(self.timeout) * 100);
        if self.enabled && self.timeout != 0 && now.saturating_sub(self.fed) >= timeout {
            self.enabled = false;
            self.tripped = true;
            self.trips = self.trips.saturating_add(1);
        }
    }
}
