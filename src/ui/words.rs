//! How the window writes times, spans, addresses and line settings.

use std::time::Duration;

use jiff::{Timestamp, tz::TimeZone};

use crate::protocol::Failure;

pub use crate::bench::summary::{UNKNOWN, address, spoken};

/// `12 s`, `4 min 10 s`, `3 h 20 min`: what remains, or how long something takes.
pub fn span(span: Duration) -> String {
    let seconds = span.as_millis().div_ceil(1_000);
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3_600 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3_600, seconds % 3_600 / 60),
    }
}

/// `33 s`, `131 s (2 min 11 s)`, `4194 s (1 h 9 min 54 s)`: exact, for values that are set in seconds.
pub fn seconds_and_minutes(seconds: u64) -> String {
    let (hours, minutes, rest) = (seconds / 3_600, seconds % 3_600 / 60, seconds % 60);
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3_600 => format!("{seconds} s ({minutes} min {rest} s)"),
        _ => format!("{seconds} s ({hours} h {minutes} min {rest} s)"),
    }
}

/// How old something is, in whole units.
pub fn age(age: Duration) -> String {
    let seconds = age.as_secs();
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3_600 => format!("{} min", seconds / 60),
        _ => format!("{} h", seconds / 3_600),
    }
}

/// How long ago `at` was; never negative.
pub fn since(at: Timestamp, now: Timestamp) -> Duration {
    now.duration_since(at).try_into().unwrap_or_default()
}

/// Poll intervals: `0.2 s`, `5 s`, `1 min`.
pub fn interval(interval: Duration) -> String {
    match interval.as_millis() {
        0 => "as fast as the line allows".to_owned(),
        milliseconds if milliseconds % 1_000 != 0 => format!("{} s", interval.as_secs_f32()),
        milliseconds if milliseconds % 60_000 == 0 => format!("{} min", milliseconds / 60_000),
        milliseconds => format!("{} s", milliseconds / 1_000),
    }
}

/// Local time of day, with so many decimals of a second.
pub fn time_of_day(seconds_utc: f64, decimals: u8) -> String {
    // Half a millisecond, so that 59.9999 is shown as the next second and not cut.
    let Ok(at) = Timestamp::from_millisecond((seconds_utc * 1e3).round() as i64) else { return UNKNOWN.to_owned() };
    let format = if decimals == 0 { "%H:%M:%S" } else { "%H:%M:%S%.1f" };
    at.to_zoned(TimeZone::system()).strftime(format).to_string()
}

/// Local time of day to a millisecond.
pub fn clock(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%H:%M:%S%.3f").to_string()
}

/// Date and time of day to a millisecond, in UTC or local: `2026-03-02 09:30:00.000`.
pub fn moment(at: Timestamp, utc: bool) -> String {
    at.to_zoned(zone(utc)).strftime("%Y-%m-%d %H:%M:%S%.3f").to_string()
}

/// Date and time of day to a minute, in UTC or local: `2026-03-02 09:30`.
pub fn minute(at: Timestamp, utc: bool) -> String {
    at.to_zoned(zone(utc)).strftime("%Y-%m-%d %H:%M").to_string()
}

/// UTC, or the zone of this machine.
pub fn zone(utc: bool) -> TimeZone {
    if utc { TimeZone::UTC } else { TimeZone::system() }
}

/// `340 kB`, `18 MB`, `1.2 GB`: how much a file holds.
pub fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{} kB", bytes / 1_000),
        1_000_000..1_000_000_000 => format!("{} MB", bytes / 1_000_000),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// `8.3 ms`, `1250 ms`: how long a frame took.
pub fn milliseconds(span: Duration) -> String {
    let milliseconds = span.as_secs_f64() * 1e3;
    if milliseconds < 1_000.0 { format!("{milliseconds:.1} ms") } else { format!("{milliseconds:.0} ms") }
}

/// Local date and time as a part of a file's name: `2026-03-02-093000`.
pub fn for_file(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d-%H%M%S").to_string()
}

/// Seconds since 1970 UTC, as trends count them.
pub fn seconds(at: Timestamp) -> f64 {
    at.as_nanosecond() as f64 / 1e9
}

/// `1 frame`, `0 frames`, `2 frames`.
pub fn counted(count: impl TryInto<u64>, one: &str) -> String {
    let count = count.try_into().unwrap_or(u64::MAX);
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {one}{plural}")
}

/// Why a value was not read, in few words: what concerns the whole module is told at its name.
pub fn not_read(failure: &Failure) -> String {
    match failure {
        Failure::LineLost(_) => "line lost".to_owned(),
        failure if failure.is_garbage() => "not read".to_owned(),
        failure => failure.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_rounded_up_and_name_two_units_at_most() {
        let text = |milliseconds| span(Duration::from_millis(milliseconds));
        assert_eq!(text(0), "0 s");
        assert_eq!(text(11_200), "12 s");
        assert_eq!(text(250_000), "4 min 10 s");
        assert_eq!(text(12_000_000), "3 h 20 min");
    }

    #[test]
    fn sizes_have_the_unit_that_is_read_at_a_glance() {
        let texts = [999, 340_900, 18_000_000, 1_240_000_000].map(size);
        assert_eq!(texts, ["999 B", "340 kB", "18 MB", "1.2 GB"]);
        assert_eq!(moment(Timestamp::from_millisecond(1_500).unwrap(), true), "1970-01-01 00:00:01.500");
    }

    #[test]
    fn long_times_are_told_in_minutes_too() {
        let texts = [6, 131, 4_194].map(seconds_and_minutes);
        assert_eq!(texts, ["6 s", "131 s (2 min 11 s)", "4194 s (1 h 9 min 54 s)"]);
    }

    #[test]
    fn one_is_not_many() {
        assert_eq!([0_usize, 1, 2].map(|count| counted(count, "frame")), ["0 frames", "1 frame", "2 frames"]);
    }

    #[test]
    fn what_lies_ahead_has_no_age() {
        let now = Timestamp::UNIX_EPOCH;
        assert_eq!(since(now + Duration::from_secs(5), now), Duration::ZERO);
        assert_eq!(age(since(now, now + Duration::from_secs(61))), "1 min");
    }

    #[test]
    fn intervals_read_as_a_person_would_say_them() {
        let text = |milliseconds| interval(Duration::from_millis(milliseconds));
        assert_eq!([text(200), text(1_000), text(60_000)], ["0.2 s", "1 s", "1 min"]);
    }
}
