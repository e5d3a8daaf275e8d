//! Why a subcommand ends early, and with which exit code.

use std::io;
use std::process::ExitCode;

use super::output;
use crate::bus::{BusGone, LineProblem};
use crate::module::WriteError;

/// Why a subcommand ends early.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// The request makes no sense, whatever the line says: exit code 2.
    Usage(String),
    /// The line or a module refused or stayed silent: exit code 1.
    Failed(String),
    /// The same, and standard error has the reasons already.
    Reported,
    /// Nobody takes the results any more: exit code 0.
    NobodyListens,
}

impl Stop {
    pub fn usage(reason: impl Into<String>) -> Self {
        Self::Usage(reason.into())
    }

    pub fn failed(reason: impl Into<String>) -> Self {
        Self::Failed(reason.into())
    }

    /// Tells the user, and gives the exit code.
    pub fn report(&self) -> ExitCode {
        match self {
            Self::Usage(reason) => {
                output::error(reason);
                ExitCode::from(2)
            }
            Self::Failed(reason) => {
                output::error(reason);
                ExitCode::from(1)
            }
            Self::Reported => ExitCode::from(1),
            Self::NobodyListens => ExitCode::SUCCESS,
        }
    }
}

impl From<io::Error> for Stop {
    /// Writing to standard output failed.
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::NobodyListens,
            _ => Self::Failed(format!("the result could not be written: {error}")),
        }
    }
}

impl From<BusGone> for Stop {
    fn from(gone: BusGone) -> Self {
        Self::Failed(gone.to_string())
    }
}

impl From<LineProblem> for Stop {
    fn from(problem: LineProblem) -> Self {
        Self::Failed(problem.to_string())
    }
}

impl From<WriteError> for Stop {
    fn from(error: WriteError) -> Self {
        match &error {
            WriteError::Value(_) | WriteError::NotOffered { .. } => Self::Usage(error.to_string()),
            _ => Self::Failed(error.to_string()),
        }
    }
}
