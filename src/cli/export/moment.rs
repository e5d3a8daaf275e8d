//! Times as users give them to say which part of a recording is meant.

use std::str::FromStr;
use std::time::Duration;

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;
use jiff::{Span, Timestamp, ToSpan, Zoned};

use crate::record::{Micros, micros_of, timestamp};

/// A moment of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Moment {
    At(Timestamp),
    /// In the zone that is shown.
    Civil(DateTime),
    /// The whole day, in the zone that is shown.
    Day(Date),
    /// Of the recording's last day, in the zone that is shown.
    Clock(Time),
    /// So long before the recording's end.
    Back(Duration),
}

impl FromStr for Moment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        if let Some(back) = text.strip_prefix(['-', '−']) {
            return humantime::parse_duration(back).map(Self::Back).map_err(|_| wrong(text));
        }
        let known = text.parse().ok().map(Self::At);
        let known = known.or_else(|| text.parse::<Zoned>().ok().map(|zoned| Self::At(zoned.timestamp())));
        let known = known.or_else(|| match text.contains(':') {
            true => text.parse().ok().map(Self::Civil).or_else(|| text.parse().ok().map(Self::Clock)),
            false => text.parse().ok().map(Self::Day),
        });
        known.ok_or_else(|| wrong(text))
    }
}

fn wrong(text: &str) -> String {
    format!(
        "\"{text}\" is not a time: use a date and time such as 2026-03-02T09:30 (with or without an offset such as +01:00), \
         a day such as 2026-03-02, a time of the recording's last day such as 09:30, or a duration back from its end \
         such as -1h"
    )
}

impl Moment {
    /// As the first moment that is meant. `end` is the recording's.
    pub fn first(&self, end: Micros, zone: &TimeZone) -> Micros {
        match self {
            Self::Day(day) => micros_of(start_of(*day, zone)),
            _ => self.point(end, zone),
        }
    }

    /// As the last moment that is meant: of a day its last microsecond.
    pub fn last(&self, end: Micros, zone: &TimeZone) -> Micros {
        match self {
            Self::Day(day) => {
                let next: Span = 1.day();
                day.checked_add(next).map_or(Micros::MAX, |next| micros_of(start_of(next, zone)).saturating_sub(1))
            }
            _ => self.point(end, zone),
        }
    }

    fn point(&self, end: Micros, zone: &TimeZone) -> Micros {
        match self {
            Self::At(at) => micros_of(*at),
            Self::Civil(civil) => micros_of(instant(*civil, zone)),
            Self::Day(day) => micros_of(start_of(*day, zone)),
            Self::Clock(time) => {
                let last_day = timestamp(end).to_zoned(zone.clone()).date();
                micros_of(instant(last_day.to_datetime(*time), zone))
            }
            Self::Back(back) => end.saturating_sub(Micros::try_from(back.as_micros()).unwrap_or(Micros::MAX)),
        }
    }
}

fn start_of(day: Date, zone: &TimeZone) -> Timestamp {
    instant(day.at(0, 0, 0, 0), zone)
}

/// Of a time that the zone has twice, the first; of one that it leaves out, the one as long after the change.
fn instant(civil: DateTime, zone: &TimeZone) -> Timestamp {
    let nearest = if civil.year() < 0 { Timestamp::MIN } else { Timestamp::MAX };
    zone.to_ambiguous_timestamp(civil).compatible().unwrap_or(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jiff::tz::Offset;

    /// 2 March 2026, 09:30 in UTC+2.
    const END: Micros = 1_772_436_600_000_000;
    const HOUR: Micros = 3_600_000_000;

    fn meant(text: &str) -> [Micros; 2] {
        let (moment, zone): (Moment, _) = (text.parse().unwrap(), TimeZone::fixed(Offset::constant(2)));
        [moment.first(END, &zone), moment.last(END, &zone)]
    }

    #[test]
    fn every_way_of_saying_a_time_means_the_same() {
        for text in [
            "2026-03-02T08:30",
            "2026-03-02 08:30:00",
            "2026-03-02T06:30:00Z",
            "2026-03-02T07:30+01:00",
            "2026-03-02T08:30[+02:00]",
            "08:30",
            "08:30:00.0",
            "-1h",
            "-60min",
        ] {
            assert_eq!(meant(text), [END - HOUR; 2], "{text}");
        }
    }

    #[test]
    fn a_day_is_meant_from_its_begin_to_its_end() {
        assert_eq!(meant("2026-03-02"), [END - 19 * HOUR / 2, END + 29 * HOUR / 2 - 1]);
    }

    #[test]
    fn what_is_not_a_time_is_refused_with_examples() {
        for text in ["", "yesterday", "1h", "-1", "25:00", "2026-13-01", "-"] {
            let error = text.parse::<Moment>().unwrap_err();
            assert!(error.contains("09:30") && error.contains("-1h"), "{error}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            if let Ok(moment) = text.parse::<Moment>() {
                moment.first(END, &TimeZone::UTC);
                moment.last(END, &TimeZone::UTC);
            }
        }
    }
}
