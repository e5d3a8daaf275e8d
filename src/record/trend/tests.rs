use proptest::prelude::*;

use super::*;

const SECOND: Micros = 1_000_000;

/// One sample a second.
fn trend(values: impl IntoIterator<Item = i64>) -> Trend {
    let mut trend = Trend::default();
    values.into_iter().zip(0..).for_each(|(value, at)| {
        trend.push(at * SECOND, value);
    });
    trend
}

#[test]
fn a_single_peak_among_a_million_samples_is_drawn_from_few_points() {
    let trend = trend((0..1_000_000).map(|i| if i == 543_210 { 99 } else { 1 }));
    let lines = trend.lines(0.0, 1e6, 500);
    assert_eq!(lines.len(), 1);
    assert!(lines[0].len() <= 1_004, "{}", lines[0].len());
    assert!(lines[0].iter().any(|point| point[1] == 99.0 && (point[0] - 543_210.0).abs() < 2_000.0));
    assert!(lines[0].is_sorted_by_key(|point| point[0]));
}

#[test]
fn a_gap_splits_the_line_and_stays_wherever_it_lies_in_the_levels() {
    let mut trend = trend((0..1_000).map(|_| 2));
    trend.mark_gap();
    for at in 50_000..51_000 {
        trend.push(at * SECOND, 3);
    }
    let lines = trend.lines(0.0, 60_000.0, 100);
    assert_eq!(lines.len(), 2);
    assert_eq!(lines[0].last().unwrap()[0], 999.0);
    assert_eq!(lines[1].first().unwrap(), &[50_000.0, 3.0]);
}

#[test]
fn lines_reach_beyond_both_edges() {
    let trend = trend([5, 6, 7, 8]);
    assert_eq!(trend.lines(0.5, 2.5, 100), [vec![[0.0, 5.0], [1.0, 6.0], [2.0, 7.0], [3.0, 8.0]]]);
}

#[test]
fn values_have_the_decimals_of_their_series() {
    let mut trend = Trend::new(2);
    trend.push(SECOND, 2_499);
    assert_eq!(trend.last(), Some([1.0, 24.99]));
    assert_eq!(trend.extremes(0.0, 2.0), Some((24.99, 24.99)));
}

#[test]
fn time_never_goes_back() {
    let mut trend = Trend::default();
    assert!(trend.push(2 * SECOND, 1).is_some());
    assert!(trend.push(SECOND, 5).is_none());
    assert!(trend.push(2 * SECOND, 5).is_none());
    trend.push(3 * SECOND, 2);
    assert_eq!(trend.len(), 2);
    assert_eq!(trend.nearest(2.4), Some([2.0, 1.0]));
    assert_eq!(trend.nearest(99.0), Some([3.0, 2.0]));
}

#[test]
fn what_was_given_up_is_wanted_when_looked_at_and_comes_back() {
    let mut whole = trend((0..5_000).map(|i| i % 100));
    let expected = whole.lines(1_000.0, 1_100.0, 1_000);
    let all: Vec<Sample> =
        whole.blocks().iter().flat_map(|block| block.samples.iter()).flat_map(|samples| samples.iter()).collect();
    let look = whole.looks();
    assert_eq!(whole.give_up(Micros::MAX, look), 9 * BLOCK);
    assert_eq!(whole.resident(), 5_000 - 9 * BLOCK);
    assert_eq!(whole.len(), 5_000);

    assert!(whole.take_wanted().is_empty());
    assert_ne!(whole.lines(1_000.0, 1_100.0, 1_000), expected);
    let wanted = whole.take_wanted();
    assert!(!wanted.is_empty());
    for [from, to] in wanted {
        let samples: Vec<Sample> = all.iter().copied().filter(|sample| (from..=to).contains(&sample.at)).collect();
        whole.fill(&samples);
    }
    assert_eq!(whole.lines(1_000.0, 1_100.0, 1_000), expected);
    assert!(whole.take_wanted().is_empty());
}

/// Draws until nothing is wanted any more.
fn drawn(trend: &mut Trend, all: &[Sample], from: f64, to: f64, columns: usize) -> Vec<Vec<Point>> {
    loop {
        let lines = trend.lines(from, to, columns);
        let wanted = trend.take_wanted();
        if wanted.is_empty() {
            return lines;
        }
        for [from, to] in wanted {
            let begin = all.partition_point(|sample| sample.at < from);
            let end = all.partition_point(|sample| sample.at <= to);
            trend.fill(&all[begin..end]);
        }
    }
}

#[test]
fn what_is_on_the_disk_is_drawn_from_sketches_until_each_sample_counts() {
    let values = |i: i64| (i * 37) % 101 + if i == 33_333 { 500 } else { 0 };
    let mut whole = trend((0..100_000).map(values));
    let all: Vec<Sample> =
        whole.blocks().iter().flat_map(|block| block.samples.iter()).flat_map(|samples| samples.iter()).collect();
    let complete = whole.clone();
    whole.give_up(Micros::MAX, u32::MAX);

    // 50 samples in each of 1000 columns: groups of 16 are enough.
    let lines = drawn(&mut whole, &all, 20_000.0, 70_000.0, 1_000);
    let highest = |lines: &[Vec<Point>]| lines.iter().flatten().map(|point| point[1]).fold(0.0, f64::max);
    assert_eq!(highest(&lines), highest(&complete.lines(20_000.0, 70_000.0, 1_000)));
    assert!(whole.resident() < 50_000 / 4, "{} samples' room", whole.resident());

    let lines = drawn(&mut whole, &all, 33_000.0, 33_700.0, 1_000);
    assert_eq!(lines, complete.lines(33_000.0, 33_700.0, 1_000), "each sample is seen");
}

#[test]
fn a_look_from_far_needs_no_samples() {
    let mut whole = trend((0..100_000).map(|i| i64::from(i == 77_777)));
    let look = whole.looks();
    whole.give_up(Micros::MAX, look);
    let lines = whole.lines(-1.0, 100_000.0, 100);
    assert!(lines[0].iter().any(|point| point[1] == 1.0));
    assert!(whole.take_wanted().is_empty());
    assert_eq!(whole.statistics(-1.0, 200_000.0).unwrap().times, 1);
}

#[test]
fn statistics_wait_for_samples_that_are_on_the_disk() {
    let mut whole = trend(0..5_000);
    let look = whole.looks();
    whole.give_up(Micros::MAX, look);
    assert_eq!(whole.statistics(100.0, 4_000.0), None);
    assert!(!whole.take_wanted().is_empty());
}

#[test]
fn the_oldest_are_forgotten_in_whole_blocks() {
    let mut whole = trend((0..10_000).map(|i| i % 7));
    assert_eq!(whole.forget_oldest(1_000), 1_024);
    assert_eq!(whole.first(), Some(1_024.0));
    assert_eq!(whole.len(), 10_000 - 1_024);
    assert_eq!(whole.statistics(0.0, 1e5).unwrap().count, 10_000 - 1_024);
    whole.push(20_000 * SECOND, 1);
    assert_eq!(whole.last(), Some([20_000.0, 1.0]));
}

#[test]
fn what_is_forgotten_between_leaves_a_gap_and_what_is_on_the_disk_stays() {
    let mut whole = trend((0..5_000).map(|_| 3));
    whole.give_up(1_100 * SECOND, 0);
    assert_eq!(whole.forget_oldest(1_000), 1_024);
    assert_eq!((whole.first(), whole.len()), (Some(0.0), 5_000 - 1_024));
    let lines = whole.lines(0.0, 5_000.0, 100);
    assert_eq!(lines.len(), 2, "the third and fourth block are gone");
    assert_eq!(lines[1][0][0], 2_048.0);
    let observed = whole.statistics(0.0, 5_000.0).unwrap().observed;
    assert_eq!(observed, 1_023.0 + 2_951.0, "from 0 to 1023 and from 2048 to 4999");
}

#[test]
fn a_switch_that_was_on_before_counts_as_on() {
    let mut trend = Trend::default();
    for (at, value) in [(0, 0), (10, 1), (15, 1), (30, 0), (50, 1), (90, 0)] {
        trend.push(at * SECOND, value);
    }
    let seen =
        |from, to| trend.statistics(from, to).map(|found| (found.times + u64::from(found.on_at_start), found.on));
    assert_eq!(seen(0.0, 100.0), Some((2, 60.0)));
    assert_eq!(seen(20.0, 40.0), Some((1, 10.0)));
    assert_eq!(seen(20.0, 25.0), Some((1, 5.0)), "no sample lies inside");
    assert_eq!(seen(200.0, 300.0), None);
}

/// Samples at irregular times, with gaps and steps.
fn samples() -> impl Strategy<Value = Vec<(Micros, i64, bool)>> {
    let step = (1i64..4_000_000, -50i64..50, proptest::bool::weighted(0.02));
    proptest::collection::vec(step, 0..3_000)
}

fn build(steps: &[(Micros, i64, bool)]) -> (Trend, Vec<Sample>) {
    let (mut trend, mut plain, mut at) = (Trend::default(), Vec::new(), 0);
    for (step, value, gap) in steps {
        if *gap {
            trend.mark_gap();
        }
        at += step;
        plain.extend(trend.push(at, *value));
    }
    (trend, plain)
}

/// What statistics mean, sample by sample.
fn plain_statistics(samples: &[Sample], from: Micros, to: Micros) -> Option<Statistics> {
    let inside: Vec<Sample> = samples.iter().copied().filter(|s| (from..=to).contains(&s.at)).collect();
    let mut result = Statistics { count: inside.len() as u64, ..Statistics::default() };
    result.low = inside.iter().map(|s| s.value as f64).fold(f64::INFINITY, f64::min);
    result.high = inside.iter().map(|s| s.value as f64).fold(f64::NEG_INFINITY, f64::max);
    result.mean = inside.iter().map(|s| s.value as f64).sum::<f64>() / inside.len() as f64;
    let mut was_on = false;
    for (index, sample) in samples.iter().enumerate() {
        let next = samples.get(index + 1).filter(|next| !next.gap);
        let until = next.map_or(sample.at, |next| next.at);
        let (begin, end) = (sample.at.max(from), until.min(to));
        let on = sample.value != 0;
        if sample.gap {
            was_on = false;
        }
        let touches = sample.at <= to && (sample.at >= from || until > from) && (until >= from);
        if touches {
            if end > begin {
                result.observed += (end - begin) as f64 / 1e6;
                result.on += if on { (end - begin) as f64 / 1e6 } else { 0.0 };
            }
            let counted_before =
                was_on && sample.at >= from && index > 0 && samples[index - 1].at <= to && sample.at <= to;
            if on && !(was_on && counted_before) {
                result.times += 1;
            }
        }
        was_on = on;
    }
    (result.count > 0 || result.observed > 0.0).then_some(result)
}

proptest! {
    #[test]
    fn every_look_shows_the_true_extremes_and_no_more_points_than_it_has_room_for(
        steps in samples(), start in 0.0f64..1.0, part in 0.001f64..1.0, columns in 1usize..400,
    ) {
        let (trend, plain) = build(&steps);
        let Some(last) = plain.last() else { return Ok(()) };
        let from = start * seconds(last.at);
        let to = from + part * seconds(last.at);
        let inside: Vec<f64> = plain.iter().filter(|s| (micros(from)..=micros(to)).contains(&s.at)).map(|s| s.value as f64).collect();
        let lines = trend.lines(from, to, columns);
        let drawn: Vec<Point> = lines.iter().flatten().copied().collect();
        let shown: Vec<f64> = drawn.iter().filter(|p| (from - 1e-6..=to + 1e-6).contains(&p[0])).map(|p| p[1]).collect();
        let extremes = |values: &[f64]| (
            values.iter().copied().fold(f64::INFINITY, f64::min),
            values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        );
        let (low, high) = extremes(&inside);
        let (drawn_low, drawn_high) = extremes(&drawn.iter().map(|p| p[1]).collect::<Vec<_>>());
        prop_assert!(inside.is_empty() || (drawn_low <= low && drawn_high >= high));
        prop_assert!(shown.len() <= inside.len());
        prop_assert!(drawn.len() <= 2 * columns + 6, "{} points in {columns} columns", drawn.len());
        for line in &lines {
            prop_assert!(line.is_sorted_by_key(|point| point[0]));
        }
        prop_assert_eq!(trend.extremes(from, to), (!inside.is_empty()).then_some((low, high)));
    }

    #[test]
    fn statistics_are_those_of_the_samples(steps in samples(), start in 0.0f64..1.0, part in 0.0f64..1.0) {
        let (trend, plain) = build(&steps);
        let end = plain.last().map_or(10 * SECOND, |last| last.at);
        let from = (start * end as f64) as Micros;
        let to = from + (part * end as f64) as Micros;
        let found = trend.statistics(seconds(from), seconds(to));
        let expected = plain_statistics(&plain, from, to);
        prop_assert_eq!(found.is_some(), expected.is_some());
        if let (Some(found), Some(expected)) = (found, expected) {
            prop_assert_eq!(found.count, expected.count);
            prop_assert!((found.observed - expected.observed).abs() < 1e-3, "{found:?} {expected:?}");
            prop_assert!((found.on - expected.on).abs() < 1e-3, "{found:?} {expected:?}");
            prop_assert_eq!(found.times + u64::from(found.on_at_start), expected.times);
            if expected.count > 0 {
                prop_assert_eq!((found.low, found.high), (expected.low, expected.high));
                prop_assert!((found.mean - expected.mean).abs() < 1e-9);
            }
        }
    }
}
