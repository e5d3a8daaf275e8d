//! How far a scan is, on one line of the terminal.

use std::time::Duration;

use super::super::terminal::TerminalLine;
use crate::bus::ScanProgress;

/// Faster than this nobody can read.
const PAUSE: Duration = Duration::from_millis(100);

pub struct Progress(TerminalLine);

impl Progress {
    pub fn new() -> Self {
        Self(TerminalLine::new(PAUSE))
    }

    pub fn show(&mut self, progress: &ScanProgress) {
        self.0.show(|| describe(progress));
    }

    /// Makes room for something else.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

fn describe(progress: &ScanProgress) -> String {
    let percent = progress.done.saturating_mul(100).checked_div(progress.total).unwrap_or(100);
    let left = Duration::from_secs(progress.left.as_secs());
    format!("{percent:3} %  {} left  {}", humantime::format_duration(left), progress.at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::ScanPlan;

    #[test]
    fn the_progress_says_how_far_how_long_and_where() {
        let at = ScanPlan::quick().targets()[1];
        let progress = ScanProgress { done: 33, total: 66, at, left: Duration::from_millis(62_900), paused: false };
        assert_eq!(describe(&progress), " 50 %  1m 2s left  address 160 (A0h), Modbus RTU 9600 N81");
    }
}
