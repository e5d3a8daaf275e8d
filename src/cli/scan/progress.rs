//! How far a scan is, on one line of the terminal that is written again and again.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use crate::bus::ScanProgress;

/// Faster than this nobody can read.
const PAUSE: Duration = Duration::from_millis(100);

/// The line of the terminal. Nothing is written if standard error is something else.
pub struct Progress {
    terminal: bool,
    /// Characters that stand there.
    shown: usize,
    at: Option<Instant>,
}

impl Progress {
    pub fn new() -> Self {
        Self { terminal: io::stderr().is_terminal(), shown: 0, at: None }
    }

    pub fn show(&mut self, progress: &ScanProgress) {
        if !self.terminal || self.at.is_some_and(|at| at.elapsed() < PAUSE) {
            return;
        }
        self.at = Some(Instant::now());
        let text = describe(progress);
        let width = self.shown;
        self.write(&format!("\r{text:width$}"));
        self.shown = text.chars().count();
    }

    /// Makes room for something else.
    pub fn clear(&mut self) {
        if self.shown > 0 {
            self.write(&format!("\r{:1$}\r", "", self.shown));
            self.shown = 0;
            self.at = None;
        }
    }

    fn write(&self, text: &str) {
        let mut terminal = io::stderr().lock();
        // If the terminal has gone, nobody misses the progress.
        let _ = write!(terminal, "{text}").and_then(|()| terminal.flush());
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
