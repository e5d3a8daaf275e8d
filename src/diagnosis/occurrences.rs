//! How often something happened, when it did last, and whether it is over.

use jiff::Timestamp;

/// So many ordinary answers behind the last failure, and more where it was rare, show that it is over.
const SHOWS_END: u64 = 50;
/// So many times the usual distance between two failures passed without one.
const DISTANCES: u64 = 5;

/// Counts of one kind of event.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Occurrences {
    pub count: u64,
    /// When it was seen last.
    pub last: Option<Timestamp>,
    /// Ordinary answers since then.
    pub followed: u64,
}

impl Occurrences {
    pub(super) fn add(&mut self, at: Timestamp) {
        self.count = self.count.saturating_add(1);
        self.last = Some(at);
        self.followed = 0;
    }

    /// An ordinary answer came.
    pub(super) fn follow(&mut self) {
        if self.count > 0 {
            self.followed = self.followed.saturating_add(1);
        }
    }

    /// Both together.
    #[must_use]
    pub(super) fn and(self, other: Self) -> Self {
        match (self.count, other.count) {
            (_, 0) => self,
            (0, _) => other,
            _ => Self {
                count: self.count.saturating_add(other.count),
                last: self.last.max(other.last),
                followed: self.followed.min(other.followed),
            },
        }
    }

    /// Whether what happened by chance in this part of `all` exchanges would have been seen again by now.
    pub fn is_over(&self, all: u64) -> bool {
        let usual = all.checked_div(self.count).unwrap_or_default();
        self.count > 0 && self.followed >= usual.saturating_mul(DISTANCES).max(SHOWS_END)
    }

    /// How long ago it was seen last, for a person: "3 minutes ago".
    pub fn age(&self, now: Timestamp) -> String {
        let seconds = self.last.map_or(0, |last| now.duration_since(last).as_secs()).max(0);
        let (count, unit) = match seconds {
            0..60 => return "less than a minute ago".to_owned(),
            60..3_600 => (seconds / 60, "minute"),
            3_600..172_800 => (seconds / 3_600, "hour"),
            _ => (seconds / 86_400, "day"),
        };
        format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
    }
}

#[cfg(test)]
mod tests {
    use jiff::SignedDuration;

    use super::*;

    #[test]
    fn the_age_is_told_in_the_unit_that_fits() {
        let seen = Occurrences { count: 1, last: Some(Timestamp::UNIX_EPOCH), followed: 0 };
        for (seconds, said) in [
            (-5, "less than a minute ago"),
            (59, "less than a minute ago"),
            (60, "1 minute ago"),
            (190, "3 minutes ago"),
            (7_200, "2 hours ago"),
            (260_000, "3 days ago"),
        ] {
            assert_eq!(seen.age(Timestamp::UNIX_EPOCH + SignedDuration::from_secs(seconds)), said);
        }
    }

    #[test]
    fn the_rarer_something_is_the_longer_its_absence_has_to_last() {
        let seen = |count, followed| Occurrences { count, last: None, followed };
        assert!(!Occurrences::default().is_over(1_000));
        assert!(!seen(20, 49).is_over(100) && seen(20, 50).is_over(100));
        assert!(!seen(10, 400).is_over(1_000) && seen(10, 500).is_over(1_000));
    }
}
