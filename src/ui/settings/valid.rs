//! What is valid of the settings: a value that was mistyped in the file, or is of another version, becomes the nearest that is.

use super::{
    DEFAULT_SPAN, HISTORY, LEAST_FILE_MEGABYTES, MOST_MEGABYTES, NAMED_SPANS, RECENT_PORTS, SCRIPTS, Settings,
    TREND_SERIES, ZOOMS, milliseconds, tidy,
};
use crate::bus::Tuning;

impl Settings {
    /// Puts what is out of range right and says so.
    pub(super) fn make_valid(&mut self, warnings: &mut Vec<String>) {
        if !ZOOMS.contains(&self.zoom) {
            let nearest = if self.zoom.is_nan() { 1.0 } else { self.zoom.clamp(*ZOOMS.start(), *ZOOMS.end()) };
            let (least, most) = (ZOOMS.start(), ZOOMS.end());
            warnings.push(format!("zoom is {}, not within {least} to {most} – {nearest} is used", self.zoom));
            self.zoom = nearest;
        }
        if !self.has_named_span() {
            let named = NAMED_SPANS.map(|span| span.to_string()).join(", ");
            warnings.push(format!("span is {}, not one of {named} – {DEFAULT_SPAN} is used", self.span));
            self.span = DEFAULT_SPAN;
        }
        self.make_keeping_valid(warnings);
        self.make_tuning_valid(warnings);
        tidy(&mut self.trend_series, TREND_SERIES);
        self.recent_ports.retain(|recent| !recent.is_empty());
        self.recent_ports.truncate(RECENT_PORTS);
        tidy(&mut self.recent_scripts, SCRIPTS);
        tidy(&mut self.command_history, HISTORY);
    }

    fn make_keeping_valid(&mut self, warnings: &mut Vec<String>) {
        let file = self.recording_file_megabytes;
        if !(LEAST_FILE_MEGABYTES..=MOST_MEGABYTES).contains(&file) {
            self.recording_file_megabytes = file.clamp(LEAST_FILE_MEGABYTES, MOST_MEGABYTES);
            let (used, least) = (self.recording_file_megabytes, LEAST_FILE_MEGABYTES);
            warnings.push(format!(
                "recording_file_megabytes is {file}, not within {least} to {MOST_MEGABYTES} – {used} is used"
            ));
        }
        let total = self.recording_total_megabytes;
        if total != 0 && total < self.recording_file_megabytes {
            self.recording_total_megabytes = self.recording_file_megabytes;
            let used = self.recording_total_megabytes;
            warnings.push(format!("recording_total_megabytes is {total}, less than one file – {used} is used"));
        }
    }

    fn make_tuning_valid(&mut self, warnings: &mut Vec<String>) {
        let nearest = self.tuning().within_limits();
        let timeout = milliseconds(nearest.timeout);
        if timeout != self.timeout_ms {
            let (least, most) = (milliseconds(*Tuning::TIMEOUTS.start()), milliseconds(*Tuning::TIMEOUTS.end()));
            let text = format!("timeout_ms is {}, not within {least} to {most} – {timeout} is used", self.timeout_ms);
            warnings.push(text);
            self.timeout_ms = timeout;
        }
        if nearest.repeats != self.repeats {
            let (most, used) = (Tuning::REPEATS.end(), nearest.repeats);
            warnings.push(format!("repeats is {}, more than {most} – {used} is used", self.repeats));
            self.repeats = used;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Keeping;

    #[test]
    fn values_out_of_range_become_valid_and_are_named() {
        let mut broken = Settings { zoom: f32::NAN, span: f64::INFINITY, ..Settings::default() };
        let mut warnings = Vec::new();
        broken.make_valid(&mut warnings);
        assert_eq!(broken, Settings::default());
        assert!(warnings[0].starts_with("zoom is NaN") && warnings[1].starts_with("span is inf"), "{warnings:?}");
        let mut extreme = Settings { zoom: 40.0, span: 0.0, ..Settings::default() };
        extreme.make_valid(&mut warnings);
        assert_eq!((extreme.zoom, extreme.span), (3.0, DEFAULT_SPAN));
        let mut valid = Settings { zoom: 3.0, span: 900.0, ..Settings::default() };
        warnings.clear();
        valid.make_valid(&mut warnings);
        assert_eq!((valid.zoom, valid.span, warnings.len()), (3.0, 900.0, 0));
    }

    #[test]
    fn what_is_kept_of_recordings_is_never_less_than_one_file() {
        let mut settings =
            Settings { recording_file_megabytes: 0, recording_total_megabytes: 3, ..Settings::default() };
        let mut warnings = Vec::new();
        settings.make_valid(&mut warnings);
        assert_eq!((settings.recording_file_megabytes, settings.recording_total_megabytes), (10, 10));
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        let keeping = Settings::default().keeping();
        assert_eq!(keeping, Keeping { file_size: 1_000_000_000, total_size: Some(10_000_000_000), days: None });
        let all = Settings { recording_total_megabytes: 0, recording_days: 30, ..Settings::default() }.keeping();
        assert_eq!((all.total_size, all.days), (None, Some(30)));
    }

    #[test]
    fn a_timeout_and_repeats_out_of_range_become_the_nearest_and_are_named() {
        let mut settings = Settings { timeout_ms: 1, repeats: 200, ..Settings::default() };
        let mut warnings = Vec::new();
        settings.make_valid(&mut warnings);
        assert_eq!((settings.timeout_ms, settings.repeats), (20, 5));
        assert!(
            warnings[0].starts_with("timeout_ms is 1,") && warnings[1].starts_with("repeats is 200,"),
            "{warnings:?}"
        );
        assert_eq!(Settings::default().tuning(), Tuning::default());
    }
}
