//! Recordings: SQLite files that hold everything that was measured and that happened. [`schema`] says what stands in
//! them.
//!
//! A [`Recorder`] writes on a thread of its own, a transaction every 400 ms while there is news: [`session`] decides
//! into which [`file`](self::file), [`folder`] what old ones are removed, [`lock`] that nobody else writes it. What
//! cannot be written waits in the [`inbox`] and is tried again. A [`Recording`] reads, also while somebody writes; a
//! [`Viewer`] does it for the window, and a [`Fetcher`] gets what a history has given up.

mod catalogue;
mod codec;
mod fetcher;
mod file;
mod folder;
mod inbox;
mod lock;
mod news;
mod problem;
mod reading;
mod recorder;
mod rows;
mod schema;
mod session;
mod shared;
mod shelf;
#[cfg(test)]
mod tests;
mod viewer;

use std::path::PathBuf;

use jiff::Timestamp;

use super::objects::SeriesId;
use super::trend::{Micros, Sample};

pub use fetcher::Fetcher;
pub use problem::StoreError;
pub use reading::Recording;
pub use recorder::Recorder;
pub use shelf::Files;
pub use viewer::Viewer;

/// Someone who has the samples that are not in memory.
pub trait Archive: Send {
    /// The samples of a series between two times, both included, in order of time.
    ///
    /// # Errors
    /// If the file cannot be read.
    fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError>;

    /// Nothing is wanted for now: files need not stay open.
    fn rest(&mut self) {}
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
    /// Bytes after which a new file is begun; 128 KiB at least.
    pub file_size: u64,
    /// Bytes of all files together; the oldest are removed. `None` keeps all.
    pub total_size: Option<u64>,
    /// Days after which a file is removed that was not written since. `None` keeps all.
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
    /// Samples on the disk, in a continued file also the earlier ones.
    pub samples: u64,
    /// Bytes of all files of this recording.
    pub bytes: u64,
    /// Samples and events in memory that are not on the disk yet.
    pub waiting: u64,
    /// Samples and events that found no room while the disk could not be written, or that cannot be written at all.
    pub lost: u64,
    /// Why nothing is written now, and what to do.
    pub problem: Option<String>,
    /// Everything earlier is on the disk.
    pub saved_until: Option<Micros>,
}
