//! The high temperature alarm, and the latched extremes of the analogue channels.

use super::climate::{Channels, Hundredths};

/// +999.99 °C, the highest limit DCON can write (PIR-234 manual 5.32, PIR-130 manual 2.25).
pub(super) const HIGHEST_LIMIT: Hundredths = 99_999;

/// `@AAEAT`, `@AAHI(Data)`, coils 262, 263 and 305, register 226.
#[derive(Debug, Clone)]
pub(super) struct Alarm {
    pub enabled: bool,
    /// Stays active until cleared; else only while it is too warm.
    pub latched: bool,
    /// In 0.01 °C, 0 to 99999.
    pub limit: Hundredths,
    active: bool,
}

impl Alarm {
    pub fn new() -> Self {
        Self { enabled: false, latched: false, limit: 6500, active: false }
    }

    pub fn active(&self) -> bool {
        self.active
    }

    pub fn enable(&mut self, latched: bool) {
        self.enabled = true;
        self.latched = latched;
    }

    /// A latched alarm comes back at once if it is still too warm.
    pub fn clear(&mut self) {
        self.active = false;
    }

    /// S of `@AADI`: 0 disabled, 1 momentary, 2 latched.
    pub fn mode_digit(&self) -> u8 {
        match (self.enabled, self.latched) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => 2,
        }
    }

    pub fn live(&mut self, celsius: Hundredths) {
        let too_warm = celsius > self.limit;
        self.active = self.enabled && (too_warm || self.latched && self.active);
    }
}

/// Highest and lowest value of each channel since power-on or since cleared (registers 545 to 549 and 577 to 581).
#[derive(Debug, Clone, Default)]
pub(super) struct Extremes {
    range: Option<(Channels, Channels)>,
}

impl Extremes {
    pub fn live(&mut self, now: &Channels) {
        let (low, high) = self.range.get_or_insert((*now, *now));
        for ((low, high), &value) in low.iter_mut().zip(high.iter_mut()).zip(now) {
            *low = value.min(*low);
            *high = value.max(*high);
        }
    }

    pub fn low(&self, channel: usize) -> Option<Hundredths> {
        self.range.as_ref().and_then(|(low, _)| low.get(channel).copied())
    }

    pub fn high(&self, channel: usize) -> Option<Hundredths> {
        self.range.as_ref().and_then(|(_, high)| high.get(channel).copied())
    }

    /// Sets the low value of one channel, or of all, to the present one.
    pub fn clear_low(&mut self, channel: Option<usize>, now: &Channels) {
        if let Some((low, _)) = &mut self.range {
            reset(low, channel, now);
        }
    }

    /// Sets the high value of one channel, or of all, to the present one.
    pub fn clear_high(&mut self, channel: Option<usize>, now: &Channels) {
        if let Some((_, high)) = &mut self.range {
            reset(high, channel, now);
        }
    }
}

fn reset(latched: &mut Channels, channel: Option<usize>, now: &Channels) {
    for (index, (latch, &value)) in latched.iter_mut().zip(now).enumerate() {
        if channel.is_none_or(|wanted| wanted == index) {
            *latch = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_momentary_alarm_follows_the_temperature_and_a_latched_one_waits_to_be_cleared() {
        let mut alarm = Alarm::new();
        alarm.limit = 3000;
        alarm.live(3001);
        assert!(!alarm.active(), "disabled");
        alarm.enable(false);
        for (celsius, active) in [(3000, false), (3001, true), (3000, false)] {
            alarm.live(celsius);
            assert_eq!(alarm.active(), active, "momentary at {celsius}");
        }
        alarm.enable(true);
        for (celsius, active) in [(3000, false), (3001, true), (2000, true)] {
            alarm.live(celsius);
            assert_eq!(alarm.active(), active, "latched at {celsius}");
        }
        alarm.clear();
        alarm.live(2000);
        assert!(!alarm.active());
    }

    #[test]
    fn extremes_are_cleared_one_by_one_or_all_together() {
        let mut extremes = Extremes::default();
        extremes.live(&[10; 5]);
        extremes.live(&[30; 5]);
        extremes.live(&[20; 5]);
        extremes.clear_high(Some(2), &[20; 5]);
        assert_eq!((extremes.high(1), extremes.high(2), extremes.low(2)), (Some(30), Some(20), Some(10)));
        extremes.clear_high(None, &[20; 5]);
        extremes.clear_low(None, &[20; 5]);
        assert_eq!((extremes.high(4), extremes.low(0), extremes.low(5)), (Some(20), Some(20), None));
    }
}
