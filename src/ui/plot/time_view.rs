//! The span of time that plots and strips share, and where the ticks of its axis are.

use std::ops::RangeInclusive;

use eframe::egui::Rangef;
use jiff::civil::{Date, Weekday};

use super::Zone;
use crate::ui::{theme, widgets};

pub const MINUTE: f64 = 60.0;
pub const HOUR: f64 = 3_600.0;
pub const DAY: f64 = 86_400.0;

/// Steps between two ticks within a day, in seconds.
const STEPS: [f64; 26] = [
    0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0,
    900.0, 1_800.0, 3_600.0, 7_200.0, 10_800.0, 21_600.0, 43_200.0,
];
/// A step of the calendar: how many days it has on average, and on which days there is a tick.
type CalendarStep = (f64, fn(Date) -> bool);

const CALENDAR: [CalendarStep; 6] = [
    (1.0, |_| true),
    (2.0, |date| date.day() % 2 == 1 && date.day() < 31),
    (7.0, |date| date.weekday() == Weekday::Monday),
    (30.0, |date| date.day() == 1),
    (91.0, |date| date.day() == 1 && date.month() % 3 == 1),
    (365.0, |date| date.day_of_year() == 1),
];
/// Days that are gone through for ticks; more than the longest span.
const MOST_DAYS: usize = 5_000;

/// From when to when is drawn, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeView {
    /// Seconds since 1970 UTC.
    pub from: f64,
    pub to: f64,
    pub columns: Rangef,
}

impl TimeView {
    pub fn span(&self) -> f64 {
        self.to - self.from
    }

    /// Where a time lies, from 0 at the left end to 1 at the right one.
    pub fn part(&self, seconds: f64) -> f64 {
        (seconds - self.from) / self.span()
    }

    pub fn x(&self, seconds: f64) -> f32 {
        self.columns.min + (self.part(seconds) * f64::from(self.columns.span())) as f32
    }

    pub fn seconds(&self, x: f32) -> f64 {
        self.from + f64::from(x - self.columns.min) * self.seconds_per_point()
    }

    pub fn seconds_per_point(&self) -> f64 {
        self.span() / f64::from(self.columns.span().max(1.0))
    }

    pub fn contains(&self, seconds: f64) -> bool {
        (self.from..=self.to).contains(&seconds)
    }

    /// How many points of a line are worth drawing.
    pub fn buckets(&self) -> usize {
        self.columns.span().max(1.0) as usize
    }

    /// Times of the ticks and the step between them, which is not finer than `finest`; full minutes, hours and days are
    /// those of the clock.
    pub fn ticks(&self, zone: Zone, finest: f64) -> (Vec<f64>, f64) {
        let least = (f64::from(theme::TICK_DISTANCE[0]) * self.seconds_per_point()).max(finest);
        match STEPS.into_iter().find(|step| *step >= least) {
            Some(step) => (self.within_days(zone, step), step),
            None => self.of_calendar(zone, least),
        }
    }

    fn within_days(&self, zone: Zone, step: f64) -> Vec<f64> {
        let offset = zone.offset(self.to);
        let clock: RangeInclusive<f64> = self.from + offset..=self.to + offset;
        // The clock may have been changed within a long span.
        let changed = |tick: f64| if step < HOUR / 2.0 { 0.0 } else { offset - zone.offset(tick) };
        let ticks = widgets::multiples(&clock, step).into_iter().map(|tick| tick - offset);
        ticks.map(|tick| tick + changed(tick)).filter(|tick| self.contains(*tick)).collect()
    }

    fn of_calendar(&self, zone: Zone, least: f64) -> (Vec<f64>, f64) {
        let step = CALENDAR.iter().find(|(days, _)| days * DAY >= least).or(CALENDAR.last());
        let Some((days, is_tick)) = step else { return (Vec::new(), DAY) };
        let Some(first) = zone.zoned(self.from) else { return (Vec::new(), DAY) };
        let dates = std::iter::successors(Some(first.date()), |date| date.tomorrow().ok()).take(MOST_DAYS);
        let ticks = dates
            .filter(|date| is_tick(*date))
            .filter_map(|date| date.to_zoned(zone.time_zone()).ok())
            .map(|start| start.timestamp().as_microsecond() as f64 / 1e6)
            .skip_while(|tick| *tick < self.from)
            .take_while(|tick| *tick <= self.to);
        (ticks.collect(), days * DAY)
    }

    /// The beginnings of the days within the span, if there are not too many to be told apart.
    pub fn midnights(&self, zone: Zone) -> Vec<f64> {
        if self.span() > 40.0 * DAY { Vec::new() } else { self.of_calendar(zone, DAY).0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(from: f64, span: f64) -> TimeView {
        TimeView { from, to: from + span, columns: Rangef::new(100.0, 700.0) }
    }

    #[test]
    fn ticks_lie_inside_and_not_too_close() {
        for zone in [Zone::Local, Zone::Utc] {
            for span in [0.1, 2.0, 60.0, 300.0, 3_600.0, 86_400.0, 7.0 * DAY, 31.0 * DAY, 366.0 * DAY] {
                let view = view(1.7e9, span);
                let (ticks, step) = view.ticks(zone, 0.0);
                assert!(ticks.iter().all(|tick| view.contains(*tick)), "{span}");
                assert!((2..=8).contains(&ticks.len()), "{span}: {ticks:?}");
                assert!(step / view.seconds_per_point() >= f64::from(theme::TICK_DISTANCE[0]) * 0.999, "{span}");
            }
        }
        assert_eq!(view(1.7e9, 0.1).ticks(Zone::Utc, 1.0).1, 1.0);
    }

    #[test]
    fn days_begin_at_midnight() {
        let week = view(1.7e9, 7.0 * DAY);
        let (ticks, step) = week.ticks(Zone::Utc, 0.0);
        assert_eq!((step, ticks.len()), (DAY, 7));
        assert!(ticks.iter().all(|tick| tick % DAY == 0.0));
        assert_eq!(week.midnights(Zone::Utc), ticks);
        assert!(view(1.7e9, 60.0).midnights(Zone::Utc).is_empty());
    }

    #[test]
    fn a_place_and_its_time_belong_together() {
        let view = view(1.7e9, 60.0);
        assert!((view.seconds(view.x(1.7e9 + 12.5)) - (1.7e9 + 12.5)).abs() < 0.01);
    }
}
