//! What plots and strips have in common while they are drawn: the module, the span of time and the pointer.

use super::series::Series;
use super::time_axis::TimeView;
use crate::bench::Module;
use crate::ui::words;

/// How far from the pointer a sample may lie: in poll intervals, in points and in seconds; the largest counts.
const REACH_INTERVALS: f64 = 1.5;
const REACH_POINTS: f64 = 6.0;
const REACH_SECONDS: f64 = 0.5;

pub struct Scene<'a> {
    pub module: &'a Module,
    pub view: TimeView,
    /// The pointer's time, in seconds since 1970 UTC.
    pub cursor: Option<f64>,
}

impl Scene<'_> {
    /// The sample at the pointer's time; none in a gap.
    pub fn sample(&self, series: &Series<'_>) -> Option<[f64; 2]> {
        let seconds = self.cursor?;
        let sample = series.trend?.nearest(seconds)?;
        let interval = self.module.interval.unwrap_or_default().as_secs_f64();
        let reach = (interval * REACH_INTERVALS).max(self.view.seconds_per_point() * REACH_POINTS).max(REACH_SECONDS);
        ((sample[0] - seconds).abs() <= reach).then_some(sample)
    }

    /// That sample in words: a dash in a gap, nothing without a pointer.
    pub fn value(&self, series: &Series<'_>) -> String {
        match (self.cursor, self.sample(series)) {
            (None, _) => String::new(),
            (Some(_), None) => words::UNKNOWN.to_owned(),
            (Some(_), Some([_, value])) => {
                format!("{} {}", series.sample_word(value), series.unit).trim_end().to_owned()
            }
        }
    }
}
