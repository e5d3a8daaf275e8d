//! One line of the terminal that is written again and again.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use super::output;

/// The line. Nothing is written if standard error is something else than a terminal.
pub struct TerminalLine {
    terminal: bool,
    /// Time between two texts at least.
    pause: Duration,
    /// Characters that stand there.
    shown: usize,
    at: Option<Instant>,
}

impl TerminalLine {
    /// A line that changes once in `pause` at most.
    pub fn new(pause: Duration) -> Self {
        Self { terminal: io::stderr().is_terminal(), pause, shown: 0, at: None }
    }

    pub fn show(&mut self, text: impl FnOnce() -> String) {
        if !self.terminal || self.at.is_some_and(|at| at.elapsed() < self.pause) {
            return;
        }
        self.at = Some(Instant::now());
        let (text, width) = (text(), self.shown);
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

    /// Tells the user something on a line of its own.
    pub fn message(&mut self, text: &str) {
        self.clear();
        output::message(text);
    }

    fn write(&self, text: &str) {
        let mut terminal = io::stderr().lock();
        // If the terminal has gone, nobody misses the line.
        let _ = write!(terminal, "{text}").and_then(|()| terminal.flush());
    }
}
