//! What is chosen in the dialog, in numbers.

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use crate::record::{History, Micros, SeriesId, micros_of, timestamp};

/// A time as people write it: `2026-03-02 09:30`, with seconds or without, in `zone`; or in full with its offset.
///
/// # Errors
/// What is wrong, and an example.
pub fn parse_time(text: &str, zone: &TimeZone) -> Result<Micros, String> {
    let text = text.trim();
    if let Ok(at) = text.parse::<Timestamp>() {
        return Ok(micros_of(at));
    }
    let local: Result<DateTime, _> = text.parse();
    let at = local.and_then(|local| local.to_zoned(zone.clone()));
    at.map(|at| micros_of(at.timestamp())).map_err(|_| format!("\"{text}\" is no time – write 2026-03-02 09:30:00"))
}

/// The time as it is proposed, to be read by [`parse_time`].
pub fn time_text(at: Micros, zone: &TimeZone) -> String {
    timestamp(at).to_zoned(zone.clone()).strftime("%Y-%m-%d %H:%M:%S").to_string()
}

/// About how many samples there are between two times, without looking at each; blocks at the ends count in part.
pub fn estimate(history: &History, series: &[SeriesId], [from, to]: [Option<Micros>; 2]) -> u64 {
    let (from, to) = (from.unwrap_or(Micros::MIN), to.unwrap_or(Micros::MAX));
    let of_series = |id: &SeriesId| -> f64 {
        let Some(series) = history.get(*id) else { return 0.0 };
        let blocks = series.trend.blocks();
        let begin = blocks.partition_point(|block| block.node.last < from);
        let inside = blocks.iter().skip(begin).take_while(|block| block.node.first <= to);
        let part = |first: Micros, last: Micros| {
            let width = last.saturating_sub(first).max(1) as f64;
            let covered = last.min(to).saturating_sub(first.max(from)) as f64;
            if first == last { 1.0 } else { (covered / width).clamp(0.0, 1.0) }
        };
        inside.map(|block| block.node.count as f64 * part(block.node.first, block.node.last)).sum()
    };
    series.iter().map(of_series).sum::<f64>().round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{ModuleInfo, SeriesInfo, SeriesKind};

    #[test]
    fn times_are_read_as_they_are_written() {
        let berlin = TimeZone::fixed(jiff::tz::offset(1));
        let at = parse_time("2026-03-02 09:30:00", &berlin).unwrap();
        assert_eq!(time_text(at, &berlin), "2026-03-02 09:30:00");
        assert_eq!(parse_time(" 2026-03-02T08:30Z ", &berlin), Ok(at));
        assert_eq!(parse_time("2026-03-02 09:30", &berlin), Ok(at));
        assert!(parse_time("yesterday", &berlin).unwrap_err().contains("is no time"));
    }

    #[test]
    fn the_estimate_is_exact_for_everything_and_near_for_a_part() {
        let mut history = History::default();
        let module = history.module(ModuleInfo::default());
        let kind = SeriesKind::Number { decimals: 2 };
        let info = SeriesInfo { module, item: "t".into(), label: "T".into(), unit: String::new(), kind };
        let id = history.series_for(info);
        (0..10_000).for_each(|at| history.push(id, at * 1_000, at));
        assert_eq!(estimate(&history, &[id], [None, None]), 10_000);
        let part = estimate(&history, &[id], [Some(2_500_000), Some(7_500_000)]);
        assert!((4_990..=5_010).contains(&part), "{part}");
        assert_eq!(estimate(&history, &[id], [Some(10_000_001), None]), 0);
        assert_eq!(estimate(&history, &[], [None, None]), 0);
    }
}
