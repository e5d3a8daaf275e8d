//! One file that is written: the newest samples as rows in order of arrival, older ones in blocks.
//!
//! A row at the end of a table costs one page for each transaction, however many series there are. From time to time
//! all full blocks are made in one go, and what is left over is written at the end again.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, params};

use super::super::objects::{Event, SeriesId};
use super::super::trend::{BLOCK, Micros, Node, Sample};
use super::catalogue::{Catalogue, Rows};
use super::codec::{encode, is_time};
use super::lock::{FileId, WriterLock, beside, real_path};
use super::problem::StoreError;
use super::rows::{self, Span};
use super::schema;

/// Fresh samples for each series before blocks are made. More than a block, so that there is always one to be made.
const FRESH: usize = BLOCK / 4 * 5;
/// Fresh samples of all series before blocks are made.
const LEAST_FRESH: usize = 16 * BLOCK;
/// Bytes after which blocks go into another row.
const PACK: usize = 64 * 1024;

/// What is known of a series of this file.
#[derive(Debug, Default)]
struct Written {
    last: Option<Sample>,
    /// The last sample that is in a block.
    before: Option<Sample>,
    /// What is not in a block yet.
    fresh: Vec<Sample>,
    /// A sample of this run was written.
    begun: bool,
}

/// What came of a transaction.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Series of which samples were written for the first time in this run.
    pub begun: Vec<SeriesId>,
    /// First and last time of what was written.
    pub span: Option<[Micros; 2]>,
    /// Samples that cannot be written because later ones of their series are there already.
    pub earlier: u64,
    /// Samples of no known series, or of no possible time.
    pub strange: u64,
    /// Series or modules were added.
    pub described: bool,
}

/// A recording that is written, with its lock.
pub struct RecordingFile {
    path: PathBuf,
    connection: Connection,
    id: Option<FileId>,
    rows: Rows,
    series: HashMap<i64, Written>,
    next_fresh: i64,
    samples: u64,
    lock: Option<WriterLock>,
}

impl RecordingFile {
    /// Opens the recording, or makes it.
    ///
    /// # Errors
    /// If somebody else writes it, it is no recording or cannot be written.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let path = real_path(path);
        let lock = WriterLock::take(&path)?;
        Self::open_locked(path, lock)
    }

    /// The same under a lock that is held already. A file that was not there before and cannot be made is removed
    /// again.
    ///
    /// # Errors
    /// As [`RecordingFile::open`].
    pub fn open_locked(path: PathBuf, lock: WriterLock) -> Result<Self, StoreError> {
        let is_new = fs::symlink_metadata(&path).is_err_and(|error| error.kind() == ErrorKind::NotFound);
        let opened = Self::open_unlocked(&path);
        if is_new && opened.is_err() {
            for ending in ["", "-journal", "-wal", "-shm"] {
                // Most of them are not there.
                let _ = fs::remove_file(beside(&path, ending));
            }
        }
        Ok(Self { lock: Some(lock), ..opened? })
    }

    fn open_unlocked(path: &Path) -> Result<Self, StoreError> {
        let connection = schema::open_to_write(path)?;
        let (path, id) = (path.to_owned(), FileId::at(path));
        let (rows, series) = (Rows::default(), HashMap::new());
        let mut file = Self { path, connection, id, rows, series, next_fresh: 1, samples: 0, lock: None };
        file.read_state().map_err(|error| file.problem(&error))?;
        Ok(file)
    }

    fn read_state(&mut self) -> rusqlite::Result<()> {
        let Self { connection, series, next_fresh, samples, .. } = self;
        let ends = "SELECT series, max(last), last_value, sum(count) FROM spans GROUP BY series";
        let end = |row: &rusqlite::Row<'_>| {
            let last = Sample { at: row.get(1)?, value: row.get(2)?, gap: false };
            Ok((row.get::<_, i64>(0)?, last, rows::number(row, 3)?))
        };
        rows::rows(connection, ends, [], end, |(row, last, count)| {
            *samples = samples.saturating_add(count);
            let written = series.entry(row).or_default();
            (written.last, written.before) = (Some(last), Some(last));
        })?;
        let counter = "SELECT value FROM counters WHERE name = 'next_fresh'";
        rows::rows(connection, counter, [], |row| row.get(0), |next: i64| *next_fresh = next.max(1))?;
        let all = "SELECT id, series, at, value, gap FROM fresh ORDER BY id";
        rows::rows(connection, all, [], rows::fresh, |(id, row, sample)| {
            *next_fresh = (*next_fresh).max(id.saturating_add(1));
            let written = series.entry(row).or_default();
            if written.last.is_none_or(|last| sample.at > last.at) {
                *samples = samples.saturating_add(1);
                written.last = Some(sample);
                written.fresh.push(sample);
            }
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// There is no file of this name any more, or another one.
    pub fn is_removed(&self) -> bool {
        FileId::at(&self.path) != self.id
    }

    pub fn series_rows(&self) -> &HashMap<SeriesId, i64> {
        self.rows.all_series()
    }

    /// All that it holds, also from earlier runs.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// In bytes, with what was not moved from the journal yet.
    pub fn size(&self) -> u64 {
        let pragma = |name| schema::pragma(&self.connection, name).ok().and_then(|number| u64::try_from(number).ok());
        pragma("page_count").unwrap_or_default().saturating_mul(pragma("page_size").unwrap_or_default())
    }

    /// The file grows to so many pages at most; for tests of a full disk.
    pub fn limit(&self, pages: u32) {
        // Where it cannot be set, the test fails.
        let _ = self.connection.query_row(&format!("PRAGMA max_page_count = {pages}"), [], |_| Ok(()));
    }

    /// Writes all of it or nothing. `begun` are the series of which samples were written in this run, be it into
    /// another file. After an error the file is to be opened again.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(
        &mut self,
        catalogue: &Catalogue,
        begun: &HashSet<SeriesId>,
        events: &[Event],
        samples: &[(SeriesId, Sample)],
    ) -> Result<Outcome, StoreError> {
        self.write_all(catalogue, begun, events, samples).map_err(|error| self.problem(&error))
    }

    fn write_all(
        &mut self,
        catalogue: &Catalogue,
        begun: &HashSet<SeriesId>,
        events: &[Event],
        samples: &[(SeriesId, Sample)],
    ) -> rusqlite::Result<Outcome> {
        self.connection.execute_batch("BEGIN IMMEDIATE")?;
        let described = self.rows.update(&self.connection, catalogue)?;
        let mut outcome = Outcome { described, ..Outcome::default() };
        if described {
            for (id, row) in self.rows.all_series() {
                self.series.entry(*row).or_default().begun |= begun.contains(id);
            }
        }
        for event in events {
            let module = event.module.and_then(|id| self.rows.module(id));
            rows::add_event(&self.connection, module, event)?;
        }
        let new = self.arrange(samples, &mut outcome);
        let waiting: usize = self.series.values().map(|written| written.fresh.len()).sum();
        let active = self.series.values().filter(|written| !written.fresh.is_empty()).count();
        if waiting >= active.saturating_mul(FRESH).max(LEAST_FRESH) {
            self.make_blocks()?;
        } else {
            self.append(&new)?;
        }
        self.connection.execute_batch("COMMIT")?;
        self.samples = self.samples.saturating_add(new.len() as u64);
        Ok(outcome)
    }

    /// The samples that are new, by the rows of their series.
    fn arrange(&mut self, samples: &[(SeriesId, Sample)], outcome: &mut Outcome) -> Vec<(i64, Sample)> {
        let mut new = Vec::with_capacity(samples.len());
        for (id, sample) in samples {
            let Some(row) = self.rows.series(*id).filter(|_| is_time(sample.at)) else {
                outcome.strange = outcome.strange.saturating_add(1);
                continue;
            };
            let written = self.series.entry(row).or_default();
            if written.last.is_some_and(|last| sample.at <= last.at) {
                // What this run has written already was on the disk although an error was told.
                outcome.earlier = outcome.earlier.saturating_add(u64::from(!written.begun));
                continue;
            }
            let gap = sample.gap || (!written.begun && written.last.is_some());
            if !std::mem::replace(&mut written.begun, true) {
                outcome.begun.push(*id);
            }
            let sample = Sample { gap, ..*sample };
            written.last = Some(sample);
            written.fresh.push(sample);
            let [first, last] = outcome.span.unwrap_or([sample.at, sample.at]);
            outcome.span = Some([first.min(sample.at), last.max(sample.at)]);
            new.push((row, sample));
        }
        new
    }

    fn append(&mut self, samples: &[(i64, Sample)]) -> rusqlite::Result<()> {
        let mut insert = self.connection.prepare_cached("INSERT INTO fresh VALUES (?, ?, ?, ?, ?)")?;
        for (row, Sample { at, value, gap }) in samples {
            insert.execute(params![self.next_fresh, row, at, value, gap])?;
            self.next_fresh = self.next_fresh.saturating_add(1);
        }
        Ok(())
    }

    /// Makes all blocks that are full, or that the next sample would not fit into, and begins `fresh` anew with the
    /// rest.
    fn make_blocks(&mut self) -> rusqlite::Result<()> {
        let Self { connection, series, .. } = self;
        let mut pack = Pack::default();
        for (row, written) in series.iter_mut() {
            let mut rest = written.fresh.as_slice();
            while let Some((block, after)) = complete(rest).and_then(|count| rest.split_at_checked(count)) {
                pack.add(*row, block, written.before);
                if pack.data.len() >= PACK {
                    std::mem::take(&mut pack).write(connection)?;
                }
                written.before = block.last().copied();
                rest = after;
            }
            written.fresh = rest.to_vec();
        }
        pack.write(connection)?;
        connection.execute_batch("DELETE FROM fresh")?;
        let mut rest: Vec<(i64, Sample)> =
            series.iter().flat_map(|(row, written)| written.fresh.iter().map(|sample| (*row, *sample))).collect();
        rest.sort_by_key(|(row, sample)| (sample.at, *row));
        self.append(&rest)?;
        let counter = "UPDATE counters SET value = ? WHERE name = 'next_fresh'";
        self.connection.prepare_cached(counter)?.execute([self.next_fresh])?;
        Ok(())
    }

    /// Moves everything from the journal into the file, so that it survives also a sudden loss of power.
    pub fn settle(&self) {
        // What cannot be moved now stays safe in the journal.
        let _ = self.connection.query_row("PRAGMA wal_checkpoint(PASSIVE)", [], |_| Ok(()));
    }

    /// Leaves a single file that needs no journal beside it, unless somebody looks at it just now.
    pub fn close(self) {
        let Self { connection, lock: _lock, .. } = self;
        let _ = connection.busy_timeout(Duration::ZERO);
        let _ = connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        let _ = connection.query_row("PRAGMA journal_mode = DELETE", [], |_| Ok(()));
        drop(connection);
    }

    fn problem(&self, error: &rusqlite::Error) -> StoreError {
        if self.is_removed() {
            return StoreError::Removed { path: self.path.clone() };
        }
        StoreError::sqlite(&self.path, error)
    }
}

/// How many samples are a block: a full one, or all before one that comes too late for it.
fn complete(samples: &[Sample]) -> Option<usize> {
    let first = samples.first()?;
    let fits = |sample: &&Sample| u32::try_from(sample.at.saturating_sub(first.at)).is_ok();
    let count = samples.iter().take(BLOCK).take_while(fits).count();
    (count == BLOCK || count < samples.len()).then_some(count)
}

/// Blocks that become one row, which fills its pages better than a row for each.
#[derive(Default)]
struct Pack {
    data: Vec<u8>,
    spans: Vec<Span>,
}

impl Pack {
    fn add(&mut self, series: i64, block: &[Sample], before: Option<Sample>) {
        let (Some(first), Some(last)) = (block.first(), block.last()) else { return };
        let mut node = Node::of(*first, before);
        block.windows(2).for_each(|pair| {
            if let [before, sample] = pair {
                node.merge(&Node::of(*sample, Some(*before)));
            }
        });
        let start = i64::try_from(self.data.len()).unwrap_or(i64::MAX);
        self.spans.push(Span { series, node, last_value: last.value, block: 0, start });
        self.data.extend(encode(block));
    }

    fn write(self, connection: &Connection) -> rusqlite::Result<()> {
        if self.spans.is_empty() {
            return Ok(());
        }
        connection.prepare_cached("INSERT INTO blocks VALUES (NULL, ?)")?.execute([self.data])?;
        let block = connection.last_insert_rowid();
        self.spans.iter().try_for_each(|span| rows::add_span(connection, &Span { block, ..*span }))
    }
}

/// Bytes on the disk of a recording that may not be open, with its journal.
pub fn size_on_disk(path: &Path) -> u64 {
    let size = |path: &Path| fs::metadata(path).map_or(0, |metadata| metadata.len());
    size(path).saturating_add(size(&beside(path, "-wal")))
}
