//! Recordings: SQLite files that hold everything that was measured and that happened.

use std::path::{Path, PathBuf};

use jiff::Timestamp;

use super::history::{History, Record};
use super::objects::SeriesId;
use super::trend::{Micros, Sample};

/// Someone who has the samples that are not in memory.
pub trait Archive: Send {
    /// The samples of a series between two times, both included, in order of time.
    ///
    /// # Errors
    /// If the file cannot be read.
    fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError>;
}

/// Why a recording cannot be written or read, and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    #[error("{path}: {reason}")]
    Other { path: PathBuf, reason: String },
}

/// Where a recording goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Destination {
    /// This file, which is continued if it is a recording already.
    File(PathBuf),
    /// Files in this folder, a new one at each start.
    Folder { folder: PathBuf, keeping: Keeping },
}

/// When a new file begins and old ones are removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Keeping {
    /// Bytes after which a new file is begun.
    pub file_size: u64,
    /// Bytes of all files together; the oldest are removed. `None` keeps all.
    pub total_size: Option<u64>,
    /// Days after which a file is removed. `None` keeps all.
    pub days: Option<u32>,
}

/// How a recording fares.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordingStatus {
    /// The file that is written now.
    pub file: Option<PathBuf>,
    /// The files of this recording, from the first time that each may hold.
    pub files: Vec<(Micros, PathBuf)>,
    /// When it began.
    pub since: Option<Timestamp>,
    /// Samples on the disk.
    pub samples: u64,
    /// Bytes of all files of this recording.
    pub bytes: u64,
    /// Samples and events in memory that are not on the disk yet.
    pub waiting: u64,
    /// Samples that found no room while the disk could not be written.
    pub lost: u64,
    /// Why nothing is written now, and what to do.
    pub problem: Option<String>,
    /// Everything earlier is on the disk.
    pub saved_until: Option<Micros>,
}

/// Writes a recording on a thread of its own.
pub struct Recorder {}

impl Recorder {
    /// Begins a recording; `wake` is called when its status has changed in a way that people should see.
    ///
    /// # Errors
    /// If no thread can be started. A file that cannot be written is told by [`Recorder::status`].
    pub fn start(_destination: Destination, _wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Err(std::io::Error::other("not written yet"))
    }

    /// Hands news over, in their order; never blocks.
    pub fn put(&mut self, _records: Vec<Record>) {}

    pub fn status(&self) -> RecordingStatus {
        RecordingStatus::default()
    }

    /// Writes what waits and closes the file.
    ///
    /// # Errors
    /// What is lost because it cannot be written.
    pub fn finish(self) -> Result<RecordingStatus, StoreError> {
        Ok(RecordingStatus::default())
    }
}

/// A recording that is looked at; it may grow meanwhile.
pub struct Recording {}

impl Recording {
    /// # Errors
    /// If it is not a recording, is of a later version or cannot be read.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Err(StoreError::Other { path: path.to_owned(), reason: "not written yet".to_owned() })
    }

    pub fn path(&self) -> &Path {
        Path::new("")
    }

    /// Modules, series and events, and what is known of the samples without reading each.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn load(&mut self) -> Result<History, StoreError> {
        Ok(History::default())
    }

    /// Takes what was written since into `history`. True if there was anything.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn refresh(&mut self, _history: &mut History) -> Result<bool, StoreError> {
        Ok(false)
    }
}

/// A recording opened for the window: read on a thread of its own, and kept up to date while it grows.
pub struct Viewer {
    path: PathBuf,
    history: Option<History>,
    problem: Option<StoreError>,
}

impl Viewer {
    /// Begins to open `path`; `wake` is called when there is something new.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn open(path: PathBuf, _wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Ok(Self { path, history: None, problem: None })
    }

    /// Takes in what was read, and asks for what was looked at and is not in memory. True if anything changed.
    pub fn pump(&mut self) -> bool {
        false
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// `None` until it is read.
    pub fn history(&self) -> Option<&History> {
        self.history.as_ref()
    }

    pub fn problem(&self) -> Option<&StoreError> {
        self.problem.as_ref()
    }
}

impl Archive for Recording {
    fn samples(&mut self, _series: SeriesId, _from: Micros, _to: Micros) -> Result<Vec<Sample>, StoreError> {
        Ok(Vec::new())
    }
}
