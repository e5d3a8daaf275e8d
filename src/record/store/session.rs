//! A recording from its start to its end: into which file is written, and when the next one begins.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant, SystemTime};

use jiff::Timestamp;

use super::super::history::Record;
use super::super::objects::SeriesId;
use super::Destination;
use super::catalogue::Catalogue;
use super::file::{Outcome, RecordingFile};
use super::folder;
use super::inbox::Batch;
use super::problem::StoreError;
use super::shelf::{Shelf, Shelved};

/// What is written is moved from the journal into the file after this time, which is what a loss of power may cost.
const SETTLE: Duration = Duration::from_secs(10);
/// How often it is looked whether old files are to be removed.
const TIDY: Duration = Duration::from_secs(600);
/// A file is not smaller than this before the next one is begun, in bytes: its empty tables alone take a part of it.
const LEAST_FILE: u64 = 128 * 1024;

pub struct Session {
    destination: Destination,
    catalogue: Catalogue,
    /// Series of which samples were written.
    begun: HashSet<SeriesId>,
    file: Option<RecordingFile>,
    /// Where to go on after a problem.
    path: Option<PathBuf>,
    shelf: Shelf,
    unsettled: Option<Instant>,
    tidied: Option<Instant>,
    /// Pages to which files may grow; for tests of a full disk.
    limit: Option<Arc<AtomicU32>>,
}

impl Session {
    pub fn new(destination: Destination, shelf: Shelf, limit: Option<Arc<AtomicU32>>) -> Self {
        let (catalogue, begun) = (Catalogue::default(), HashSet::new());
        let (file, path, unsettled, tidied) = (None, None, None, None);
        Self { destination, catalogue, begun, file, path, shelf, unsettled, tidied, limit }
    }

    pub fn describe(&mut self, described: Vec<Record>) {
        described.into_iter().for_each(|record| self.catalogue.take(record));
    }

    /// The file that is written now.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Makes sure that there is a file.
    ///
    /// # Errors
    /// If none can be written.
    pub fn open(&mut self) -> Result<(), StoreError> {
        match &self.file {
            Some(file) if !file.is_removed() => return Ok(()),
            Some(file) => {
                let path = file.path().to_owned();
                self.file = None;
                return Err(StoreError::Removed { path });
            }
            None => {}
        }
        let file = self.next_file()?;
        let path = file.path().to_owned();
        self.path = Some(path.clone());
        self.shelve(path, &file, &Outcome::default());
        self.file = Some(file);
        self.tidy();
        Ok(())
    }

    fn next_file(&self) -> Result<RecordingFile, StoreError> {
        let folder = match &self.destination {
            Destination::File(path) => return RecordingFile::open(path),
            Destination::Folder { folder, .. } => folder,
        };
        match self.path.as_ref().filter(|path| path.exists()).map(|path| RecordingFile::open(path)) {
            Some(Err(StoreError::Damaged { .. } | StoreError::NotARecording { .. })) | None => {
                folder::begin(folder, Timestamp::now())
            }
            Some(opened) => opened,
        }
    }

    /// Writes all of the batch or nothing.
    ///
    /// # Errors
    /// If it cannot be written now.
    pub fn write(&mut self, batch: &Batch) -> Result<Outcome, StoreError> {
        self.open()?;
        let Some(mut file) = self.file.take() else { return Ok(Outcome::default()) };
        if let Some(limit) = &self.limit {
            file.limit(limit.load(Ordering::Relaxed));
        }
        let written = file.write(&self.catalogue, &self.begun, &batch.events, &batch.samples);
        if self.is_beyond_repair(&file, &written) {
            self.path = None;
        }
        let outcome = written?;
        self.begun.extend(outcome.begun.iter().copied());
        self.shelve(file.path().to_owned(), &file, &outcome);
        self.unsettled = self.unsettled.or_else(|| Some(Instant::now()));
        if self.is_full(&file) {
            file.close();
            (self.path, self.unsettled) = (None, None);
        } else {
            self.file = Some(file);
        }
        if self.settle_at().is_some_and(|at| Instant::now() >= at) {
            self.settle();
        }
        if self.tidied.is_some_and(|at| at.elapsed() >= TIDY) {
            self.tidy();
        }
        Ok(outcome)
    }

    /// The next file is to be tried. Where nothing could ever be written, the next one would not fare better.
    fn is_beyond_repair(&self, file: &RecordingFile, written: &Result<Outcome, StoreError>) -> bool {
        let is_damaged = matches!(written, Err(StoreError::Damaged { .. }));
        is_damaged && file.samples() > 0 && matches!(self.destination, Destination::Folder { .. })
    }

    fn is_full(&self, file: &RecordingFile) -> bool {
        let Destination::Folder { keeping, .. } = &self.destination else { return false };
        file.size() >= keeping.file_size.max(LEAST_FILE)
    }

    /// Notes what a file has now.
    fn shelve(&self, path: PathBuf, file: &RecordingFile, outcome: &Outcome) {
        let mut files = self.shelf.files();
        if files.last().is_none_or(|last| last.path != path) {
            files.push(Shelved { path, ..Shelved::default() });
        }
        let Some(shelved) = files.last_mut() else { return };
        (shelved.samples, shelved.bytes) = (file.samples(), file.size());
        if let Some([first, last]) = outcome.span {
            let [from, to] = shelved.span.unwrap_or([first, last]);
            shelved.span = Some([from.min(first), to.max(last)]);
        }
        if outcome.described || shelved.rows.is_empty() {
            shelved.rows = file.series_rows().clone();
        }
    }

    fn tidy(&mut self) {
        let (Destination::Folder { keeping, .. }, Some(path)) = (&self.destination, &self.path) else { return };
        let Some(folder) = path.parent() else { return };
        let removed = folder::tidy(folder, keeping, path, SystemTime::now());
        self.shelf.files().retain(|file| !removed.contains(&file.path));
        self.tidied = Some(Instant::now());
    }

    /// When what was written is to be moved out of the journal.
    pub fn settle_at(&self) -> Option<Instant> {
        self.unsettled.and_then(|since| since.checked_add(SETTLE))
    }

    pub fn settle(&mut self) {
        self.unsettled = None;
        if let Some(file) = &self.file {
            file.settle();
        }
    }

    pub fn close(mut self) {
        if let Some(file) = self.file.take() {
            file.close();
        }
    }
}
