//! How many exchanges failed, over the last hour.

use std::collections::VecDeque;

use jiff::Timestamp;
use serde::Serialize;

/// Seconds that are counted together.
pub const SLOT_SECONDS: i64 = 10;
/// An hour of them.
const MOST_SLOTS: i64 = 360;

/// Exchanges of some seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Slot {
    /// When it began, in seconds since 1970.
    pub second: i64,
    pub exchanges: u32,
    pub failed: u32,
}

impl Slot {
    /// The part that failed, 0 to 1.
    pub fn share(&self) -> f64 {
        f64::from(self.failed) / f64::from(self.exchanges.max(1))
    }
}

/// The last hour in slots of ten seconds; those without an exchange are left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rates {
    slots: VecDeque<Slot>,
}

impl Rates {
    /// An exchange that ended `at`. If the clock was put back, it counts to the newest slot.
    pub fn add(&mut self, at: Timestamp, failed: bool) {
        let second = at.as_second().div_euclid(SLOT_SECONDS).saturating_mul(SLOT_SECONDS);
        if self.slots.back().is_none_or(|newest| newest.second < second) {
            self.slots.push_back(Slot { second, exchanges: 0, failed: 0 });
            let oldest = second.saturating_sub(SLOT_SECONDS.saturating_mul(MOST_SLOTS));
            while self.slots.front().is_some_and(|slot| slot.second <= oldest) {
                self.slots.pop_front();
            }
        }
        if let Some(slot) = self.slots.back_mut() {
            slot.exchanges = slot.exchanges.saturating_add(1);
            slot.failed = slot.failed.saturating_add(u32::from(failed));
        }
    }

    /// Oldest first.
    pub fn slots(&self) -> impl DoubleEndedIterator<Item = Slot> + ExactSizeIterator {
        self.slots.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(second: i64) -> Timestamp {
        Timestamp::from_second(second).unwrap()
    }

    #[test]
    fn exchanges_are_counted_in_slots_of_ten_seconds() {
        let mut rates = Rates::default();
        for (second, failed) in [(100, false), (109, true), (110, false), (149, true)] {
            rates.add(at(second), failed);
        }
        let slots: Vec<_> = rates.slots().map(|slot| (slot.second, slot.exchanges, slot.failed)).collect();
        assert_eq!(slots, [(100, 2, 1), (110, 1, 0), (140, 1, 1)]);
    }

    #[test]
    fn an_hour_is_kept_however_long_it_goes_on_and_whatever_the_clock_does() {
        let mut rates = Rates::default();
        for second in 0..20_000 {
            rates.add(at(second), second % 2 == 0);
        }
        assert_eq!(rates.slots().len(), 360);
        rates.add(at(5), true);
        assert_eq!(rates.slots().len(), 360);
        assert_eq!(rates.slots().next_back().map(|slot| (slot.second, slot.exchanges)), Some((19_990, 11)));
        rates.add(at(9_000_000), false);
        assert_eq!(rates.slots().len(), 1);
    }
}
