//! Messages for the user, kept to look back at.

use std::path::PathBuf;

use jiff::Timestamp;

use super::LineState;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Info,
    Warning,
    Error,
}

/// What a message is about, where that tells how long it is true.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Topic {
    #[default]
    Other,
    /// The line that was asked for could not be opened.
    NotOpened,
    /// The line was lost.
    LineLost,
    /// The adapter of the lost line is there, and cannot be taken up.
    StillLost,
}

impl Topic {
    /// Whether this is still so while the line is in the state `line`.
    pub fn holds(self, line: &LineState) -> bool {
        match self {
            Self::Other => true,
            Self::NotOpened => matches!(line, LineState::Closed),
            Self::LineLost | Self::StillLost => line.is_lost(),
        }
    }
}

/// What happened, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// Counts up from the start, whatever the clock does.
    pub number: u64,
    pub at: Timestamp,
    pub severity: Severity,
    pub topic: Topic,
    pub text: String,
    /// A file that was written; its folder can be shown.
    pub file: Option<PathBuf>,
}
