//! The files of one recording, from which samples are fetched that are no longer in memory.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::super::objects::SeriesId;
use super::super::trend::{Micros, Sample};
use super::Archive;
use super::problem::StoreError;
use super::reading::Recording;

/// Files that are open at a time.
const MOST_OPEN: usize = 4;

/// A file of a recording, and what it has of this run.
#[derive(Debug, Clone, Default)]
pub struct Shelved {
    pub path: PathBuf,
    /// First and last time of the samples.
    pub span: Option<[Micros; 2]>,
    pub rows: HashMap<SeriesId, i64>,
    /// With what it had before this run.
    pub samples: u64,
    pub bytes: u64,
}

/// Shared between who writes the files and who reads them.
#[derive(Debug, Clone, Default)]
pub struct Shelf(Arc<Mutex<Vec<Shelved>>>);

impl Shelf {
    pub fn files(&self) -> MutexGuard<'_, Vec<Shelved>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Where the samples of a series between two times are: files and rows, in the order in which they were written.
    fn find(&self, series: SeriesId, from: Micros, to: Micros) -> Vec<(PathBuf, i64)> {
        let files = self.files();
        let overlaps = |file: &&Shelved| file.span.is_some_and(|[first, last]| first <= to && last >= from);
        files.iter().filter(overlaps).filter_map(|file| Some((file.path.clone(), *file.rows.get(&series)?))).collect()
    }
}

/// The samples that were recorded in this run, by the ids of the history that was recorded.
#[derive(Default)]
pub struct Files {
    shelves: Vec<Shelf>,
    /// The one used last stands last.
    open: Vec<Recording>,
}

impl Files {
    pub(super) fn new(shelf: Shelf) -> Self {
        Self { shelves: vec![shelf], open: Vec::new() }
    }

    /// Adds the files of a later recording of the same history.
    pub fn join(&mut self, later: Self) {
        self.shelves.extend(later.shelves);
    }

    fn opened(&mut self, path: &Path) -> Result<&mut Recording, StoreError> {
        let recording = match self.open.iter().position(|recording| recording.path() == path) {
            Some(place) => self.open.remove(place),
            None => Recording::open(path)?,
        };
        if self.open.len() >= MOST_OPEN {
            self.open.remove(0);
        }
        self.open.push(recording);
        self.open.last_mut().ok_or_else(|| StoreError::NotThere { path: path.to_owned() })
    }
}

impl Archive for Files {
    fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
        let places: Vec<(PathBuf, i64)> = self.shelves.iter().flat_map(|shelf| shelf.find(series, from, to)).collect();
        let mut all: Vec<Sample> = Vec::new();
        for (path, row) in places {
            let found = match self.opened(&path).and_then(|recording| recording.samples_of(row, from, to)) {
                // It was removed because only so much is kept.
                Err(StoreError::NotThere { .. } | StoreError::Removed { .. }) => continue,
                found => found?,
            };
            let last = all.last().map_or(Micros::MIN, |last| last.at);
            all.extend(found.into_iter().filter(|sample| sample.at > last));
        }
        Ok(all)
    }

    fn rest(&mut self) {
        self.open.clear();
    }
}
