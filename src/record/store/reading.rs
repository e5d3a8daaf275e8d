//! A recording that is looked at, closed or while it grows.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use rusqlite::{Connection, params};

use super::super::history::{History, MOST_EVENTS};
use super::super::objects::{ModuleId, ModuleInfo, SeriesId, SeriesInfo};
use super::super::trend::{Micros, Sample};
use super::Archive;
use super::codec::decode;
use super::lock::FileId;
use super::news::{News, Piece};
use super::problem::StoreError;
use super::rows::{self, Span};
use super::schema::{self, Access};

/// Modules and series that are read; no line has more by far.
const MOST_DESCRIBED: usize = 10_000;

/// A recording that is looked at; it may grow meanwhile.
pub struct Recording {
    path: PathBuf,
    connection: Connection,
    access: Access,
    id: Option<FileId>,
    /// Length and time of change of a file that cannot tell of its changes.
    seen: Option<(u64, Option<SystemTime>)>,
    known: Known,
    blocks: Blocks,
}

/// What was read so far.
#[derive(Debug, Default)]
struct Known {
    /// What the file says when anybody has changed it.
    version: Option<i64>,
    modules: Vec<(i64, ModuleInfo)>,
    module_of_row: HashMap<i64, ModuleId>,
    series: Vec<KnownSeries>,
    series_of_row: HashMap<i64, SeriesId>,
    /// Rows that make no sense beside others.
    left_out: HashSet<i64>,
    fresh: i64,
    event: i64,
    block: Option<i64>,
}

#[derive(Debug)]
struct KnownSeries {
    row: i64,
    module: ModuleId,
    item: String,
    last: Option<Micros>,
}

impl Recording {
    /// # Errors
    /// If it is not there, is not a recording, is of a later version or cannot be read.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let (connection, access) = schema::open_to_read(path)?;
        let (id, seen) = (FileId::at(path), seen(path));
        Ok(Self {
            path: path.to_owned(),
            connection,
            access,
            id,
            seen,
            known: Known::default(),
            blocks: Blocks::default(),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Modules, series and events, and what is known of the samples without reading each.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn load(&mut self) -> Result<History, StoreError> {
        self.known = Known::default();
        let mut history = History::default();
        self.news()?.add_to(&mut history);
        Ok(history)
    }

    /// Takes what was written since into `history`, which was loaded from this recording. True if there was anything.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn refresh(&mut self, history: &mut History) -> Result<bool, StoreError> {
        let news = self.news()?;
        let any = !news.is_empty();
        news.add_to(history);
        Ok(any)
    }

    /// What was written since this was last asked.
    pub(super) fn news(&mut self) -> Result<News, StoreError> {
        if FileId::at(&self.path) != self.id {
            return Err(StoreError::Removed { path: self.path.clone() });
        }
        if self.access == Access::Frozen && seen(&self.path) != self.seen {
            self.seen = seen(&self.path);
            (self.connection, self.access) = schema::open_to_read(&self.path)?;
            self.known.version = None;
        }
        let Self { path, connection, known, .. } = self;
        let problem = |error: rusqlite::Error| StoreError::sqlite(path, &error);
        let version = schema::pragma(connection, "data_version").map_err(problem)?;
        if known.version == Some(version) {
            return Ok(News::default());
        }
        let news = consistent(connection, |connection| known.read(connection)).map_err(problem)?;
        known.version = Some(version);
        Ok(news)
    }

    /// The samples of a series by its row in this file.
    pub(super) fn samples_of(&mut self, row: i64, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
        if FileId::at(&self.path) != self.id {
            return Err(StoreError::Removed { path: self.path.clone() });
        }
        let Self { path, connection, blocks, .. } = self;
        let all = consistent(connection, |connection| samples(connection, blocks, row, from, to));
        all.map_err(|error| StoreError::sqlite(path, &error))
    }
}

impl Archive for Recording {
    fn samples(&mut self, series: SeriesId, from: Micros, to: Micros) -> Result<Vec<Sample>, StoreError> {
        let place = usize::try_from(series.0).unwrap_or(usize::MAX);
        let Some(row) = self.known.series.get(place).map(|known| known.row) else { return Ok(Vec::new()) };
        self.samples_of(row, from, to)
    }
}

fn seen(path: &Path) -> Option<(u64, Option<SystemTime>)> {
    fs::metadata(path).ok().map(|metadata| (metadata.len(), metadata.modified().ok()))
}

/// Everything that is read is of the same moment.
fn consistent<T>(
    connection: &Connection,
    read: impl FnOnce(&Connection) -> rusqlite::Result<T>,
) -> rusqlite::Result<T> {
    let transaction = connection.unchecked_transaction()?;
    read(&transaction)
}

impl Known {
    fn read(&mut self, connection: &Connection) -> rusqlite::Result<News> {
        let mut news = News::default();
        self.read_modules(connection, &mut news)?;
        self.read_series(connection, &mut news)?;
        self.read_spans(connection, &mut news)?;
        self.read_fresh(connection, &mut news)?;
        self.read_events(connection, &mut news)?;
        Ok(news)
    }

    fn read_modules(&mut self, connection: &Connection, news: &mut News) -> rusqlite::Result<()> {
        let sql = format!("{} ORDER BY id LIMIT {MOST_DESCRIBED}", rows::MODULES);
        rows::rows(connection, &sql, [], rows::module, |(row, info)| {
            let id = self.module_of_row.get(&row).copied();
            let known = id.and_then(|id| self.modules.get_mut(usize::try_from(id.0).unwrap_or(usize::MAX)));
            match (id, known) {
                (Some(_), Some((_, known))) if *known == info => {}
                (Some(id), Some((_, known))) => {
                    *known = info.clone();
                    news.modules.push((id, info));
                }
                _ => {
                    let id = ModuleId(u32::try_from(self.modules.len()).unwrap_or(u32::MAX));
                    self.module_of_row.insert(row, id);
                    self.modules.push((row, info.clone()));
                    news.modules.push((id, info));
                }
            }
        })
    }

    fn read_series(&mut self, connection: &Connection, news: &mut News) -> rusqlite::Result<()> {
        let sql = format!("{} ORDER BY id LIMIT {MOST_DESCRIBED}", rows::SERIES);
        rows::rows(connection, &sql, [], rows::series, |(row, module, info)| {
            if self.series_of_row.contains_key(&row) || self.left_out.contains(&row) {
                return;
            }
            let module = self.module_of_row.get(&module).copied();
            let is_new = |module| !self.series.iter().any(|known| known.module == module && known.item == info.item);
            let Some(module) = module.filter(|module| is_new(*module)) else {
                self.left_out.insert(row);
                return;
            };
            let id = SeriesId(u32::try_from(self.series.len()).unwrap_or(u32::MAX));
            self.series_of_row.insert(row, id);
            self.series.push(KnownSeries { row, module, item: info.item.clone(), last: None });
            news.series.push(SeriesInfo { module, ..info });
        })
    }

    fn series_mut(&mut self, row: i64) -> Option<(SeriesId, &mut KnownSeries)> {
        let id = *self.series_of_row.get(&row)?;
        Some((id, self.series.get_mut(usize::try_from(id.0).ok()?)?))
    }

    fn read_spans(&mut self, connection: &Connection, news: &mut News) -> rusqlite::Result<()> {
        let newest: Option<i64> = connection.query_row("SELECT max(id) FROM blocks", [], |row| row.get(0))?;
        if newest == self.block {
            return Ok(());
        }
        if self.block.is_none() && self.series.iter().all(|series| series.last.is_none()) {
            let sql = format!("{} ORDER BY series, first", rows::SPANS);
            rows::rows(connection, &sql, [], rows::span, |span| self.take_span(&span, news))?;
        } else {
            self.read_new_spans(connection, news)?;
        }
        self.block = newest;
        Ok(())
    }

    /// Some of what is in a block now may have been read while it was fresh.
    fn read_new_spans(&mut self, connection: &Connection, news: &mut News) -> rusqlite::Result<()> {
        let sql = format!(
            "{} WHERE series = ?1
            AND first >= coalesce((SELECT max(first) FROM spans WHERE series = ?1 AND first <= ?2), ?2) ORDER BY first",
            rows::SPANS
        );
        let ends: Vec<(i64, Micros)> =
            self.series.iter().map(|known| (known.row, known.last.unwrap_or(Micros::MIN))).collect();
        for (row, last) in ends {
            let mut spans = Vec::new();
            rows::rows(connection, &sql, params![row, last], rows::span, |span| spans.push(span))?;
            for span in spans.into_iter().filter(|span| span.node.last > last) {
                if span.node.first > last {
                    self.take_span(&span, news);
                    continue;
                }
                for sample in Blocks::default().read(connection, &span)?.into_iter().filter(|sample| sample.at > last) {
                    self.take_sample(row, sample, news);
                }
            }
        }
        Ok(())
    }

    fn take_span(&mut self, span: &Span, news: &mut News) {
        let Some((id, known)) = self.series_mut(span.series) else { return };
        if known.last.is_none_or(|last| span.node.first > last) {
            known.last = Some(span.node.last);
            news.pieces.push(Piece::Stored(id, span.node, span.last()));
        }
    }

    fn take_sample(&mut self, row: i64, sample: Sample, news: &mut News) {
        let Some((id, known)) = self.series_mut(row) else { return };
        if known.last.is_none_or(|last| sample.at > last) {
            known.last = Some(sample.at);
            news.pieces.push(Piece::Sample(id, sample));
        }
    }

    fn read_fresh(&mut self, connection: &Connection, news: &mut News) -> rusqlite::Result<()> {
        let sql = "SELECT id, series, at, value, gap FROM fresh WHERE id > ? ORDER BY id";
        rows::rows(connection, sql, [self.fresh], rows::fresh, |(id, row, sample)| {
            self.fresh = id;
            self.take_sample(row, sample, news);
        })
    }

    fn read_events(&mut self, connection: &Connection, news: &mut News) -> rusqlite::Result<()> {
        let most = i64::try_from(MOST_EVENTS).unwrap_or(i64::MAX);
        let before = self.event;
        rows::rows(connection, rows::EVENTS, params![before, most], rows::event, |(id, module, mut event)| {
            self.event = self.event.max(id);
            event.module = module.and_then(|row| self.module_of_row.get(&row).copied());
            news.events.push(event);
        })?;
        news.events.reverse();
        Ok(())
    }
}

/// Reads blocks, and keeps the row that was read last: neighbours are often in it. Rows never change.
#[derive(Debug, Default)]
struct Blocks {
    row: Option<i64>,
    data: Vec<u8>,
}

impl Blocks {
    /// The samples of a span; none if they are damaged.
    fn read(&mut self, connection: &Connection, span: &Span) -> rusqlite::Result<Vec<Sample>> {
        if self.row != Some(span.block) {
            (self.row, self.data) = (None, Vec::new());
            let read = |row: &rusqlite::Row<'_>| Ok(row.get_ref(0)?.as_blob().map(<[u8]>::to_vec).unwrap_or_default());
            let sql = "SELECT data FROM blocks WHERE id = ?";
            rows::rows(connection, sql, [span.block], read, |data| self.data = data)?;
            self.row = Some(span.block);
        }
        let bytes = usize::try_from(span.start).ok().and_then(|start| self.data.get(start..)).unwrap_or_default();
        let count = usize::try_from(span.node.count).unwrap_or(usize::MAX);
        let samples = decode(bytes, count).unwrap_or_default();
        // One that belongs to another span is damage.
        let ends = [samples.first(), samples.last()].map(|sample| sample.map(|sample| sample.at));
        let fits = ends == [Some(span.node.first), Some(span.node.last)];
        Ok(if fits { samples } else { Vec::new() })
    }
}

fn samples(
    connection: &Connection,
    blocks: &mut Blocks,
    row: i64,
    from: Micros,
    to: Micros,
) -> rusqlite::Result<Vec<Sample>> {
    let sql = format!(
        "{} WHERE series = ?1 AND first <= ?3
        AND first >= coalesce((SELECT max(first) FROM spans WHERE series = ?1 AND first <= ?2), ?2) ORDER BY first",
        rows::SPANS
    );
    let mut spans = Vec::new();
    rows::rows(connection, &sql, params![row, from, to], rows::span, |span| spans.push(span))?;
    let mut all: Vec<Sample> = Vec::new();
    let add = |all: &mut Vec<Sample>, sample: Sample| {
        let last = all.last().map_or(Micros::MIN, |last| last.at);
        if (from..=to).contains(&sample.at) && sample.at > last {
            all.push(sample);
        }
    };
    for span in spans.iter().filter(|span| span.node.last >= from) {
        blocks.read(connection, span)?.into_iter().for_each(|sample| add(&mut all, sample));
    }
    let end = "SELECT last FROM spans WHERE series = ? ORDER BY first DESC LIMIT 1";
    let mut last = None;
    rows::rows(connection, end, [row], |row| row.get::<_, Micros>(0), |at| last = Some(at))?;
    if last.is_none_or(|last| to > last) {
        let sql = "SELECT id, series, at, value, gap FROM fresh WHERE series = ? AND at BETWEEN ? AND ? ORDER BY id";
        rows::rows(connection, sql, params![row, from, to], rows::fresh, |(.., sample)| add(&mut all, sample))?;
    }
    Ok(all)
}
