//! Modules, series, events and spans as rows, and back. A row that makes no sense is an error of its own, so that it
//! can be left out.

use rusqlite::types::Type;
use rusqlite::{Connection, Error, Params, Result, Row, params};

use super::super::objects::{Change, Event, EventKind, ModuleId, ModuleInfo, SeriesInfo, SeriesKind, timestamp};
use super::super::trend::{BLOCK, Micros, Node, Sample};
use super::codec::is_time;

/// No series has more; a number of 64 bits has no room for more.
const MOST_DECIMALS: u8 = 18;

/// The rows that make sense, in the order of `sql`.
pub fn rows<T>(
    connection: &Connection,
    sql: &str,
    params: impl Params,
    mut read: impl FnMut(&Row<'_>) -> Result<T>,
    mut tell: impl FnMut(T),
) -> Result<()> {
    let mut statement = connection.prepare_cached(sql)?;
    let mut rows = statement.query(params)?;
    while let Some(row) = rows.next()? {
        if let Ok(item) = read(row) {
            tell(item);
        }
    }
    Ok(())
}

fn wrong(column: usize) -> Error {
    Error::InvalidColumnType(column, "a value without meaning".to_owned(), Type::Integer)
}

/// A number that is not below zero.
pub fn number(row: &Row<'_>, column: usize) -> Result<u64> {
    u64::try_from(row.get::<_, i64>(column)?).map_err(|_| wrong(column))
}

pub const MODULES: &str =
    "SELECT id, line, address, protocol, baud_rate, data_format, checksum, model, label, name, firmware FROM modules";

pub fn module(row: &Row<'_>) -> Result<(i64, ModuleInfo)> {
    let info = ModuleInfo {
        line: row.get(1)?,
        address: row.get(2)?,
        protocol: row.get(3)?,
        baud_rate: row.get(4)?,
        data_format: row.get(5)?,
        checksum: row.get(6)?,
        model: row.get(7)?,
        label: row.get(8)?,
        name: row.get(9)?,
        firmware: row.get(10)?,
    };
    Ok((row.get(0)?, info))
}

/// Writes the module as row `id`, or as a new one. Its row.
pub fn put_module(connection: &Connection, id: Option<i64>, info: &ModuleInfo) -> Result<i64> {
    let sql = "INSERT INTO modules VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)
        ON CONFLICT (id) DO UPDATE SET line = ?2, address = ?3, protocol = ?4, baud_rate = ?5, data_format = ?6,
        checksum = ?7, model = ?8, label = ?9, name = ?10, firmware = ?11";
    let ModuleInfo { line, address, protocol, baud_rate, data_format, checksum, model, label, name, firmware } = info;
    let values = params![id, line, address, protocol, baud_rate, data_format, checksum, model, label, name, firmware];
    connection.prepare_cached(sql)?.execute(values)?;
    Ok(id.unwrap_or_else(|| connection.last_insert_rowid()))
}

pub const SERIES: &str = "SELECT id, module, item, label, unit, kind, decimals, words FROM series";

/// The row, that of its module, and what is known of it once the module is.
pub fn series(row: &Row<'_>) -> Result<(i64, i64, SeriesInfo)> {
    let kind: String = row.get(5)?;
    let decimals: u8 = row.get(6)?;
    let kind = match kind.as_str() {
        "number" if decimals <= MOST_DECIMALS => SeriesKind::Number { decimals },
        "switch" => SeriesKind::Switch,
        "choice" => {
            let words: String = row.get(7)?;
            SeriesKind::Choice { words: serde_json::from_str(&words).map_err(|_| wrong(7))? }
        }
        _ => return Err(wrong(5)),
    };
    let info =
        SeriesInfo { module: ModuleId(u32::MAX), item: row.get(2)?, label: row.get(3)?, unit: row.get(4)?, kind };
    Ok((row.get(0)?, row.get(1)?, info))
}

pub fn add_series(connection: &Connection, module: i64, info: &SeriesInfo) -> Result<i64> {
    let (kind, words) = match &info.kind {
        SeriesKind::Number { .. } => ("number", None),
        SeriesKind::Switch => ("switch", None),
        SeriesKind::Choice { words } => ("choice", serde_json::to_string(words).ok()),
    };
    let sql = "INSERT INTO series VALUES (NULL, ?, ?, ?, ?, ?, ?, ?)";
    let values = params![module, info.item, info.label, info.unit, kind, info.kind.decimals(), words];
    connection.prepare_cached(sql)?.execute(values)?;
    Ok(connection.last_insert_rowid())
}

/// The newest events after one, newest first.
pub const EVENTS: &str = "SELECT events.id, at, module, kind, text, item, before, after
    FROM events LEFT JOIN changes ON changes.event = events.id WHERE events.id > ? ORDER BY events.id DESC LIMIT ?";

/// The row, that of its module, and the event once the module is known.
pub fn event(row: &Row<'_>) -> Result<(i64, Option<i64>, Event)> {
    let item: Option<String> = row.get(5)?;
    let change = match item {
        Some(item) => Some(Change { item, before: row.get(6)?, after: row.get(7)? }),
        None => None,
    };
    let kind: String = row.get(3)?;
    let kind = EventKind::by_name(&kind).unwrap_or(EventKind::Note);
    let event = Event { at: timestamp(row.get(1)?), module: None, kind, text: row.get(4)?, change };
    Ok((row.get(0)?, row.get(2)?, event))
}

pub fn add_event(connection: &Connection, module: Option<i64>, event: &Event) -> Result<()> {
    let values = params![event.at.as_microsecond(), module, event.kind.name(), event.text];
    connection.prepare_cached("INSERT INTO events VALUES (NULL, ?, ?, ?, ?)")?.execute(values)?;
    if let Some(Change { item, before, after }) = &event.change {
        let values = params![connection.last_insert_rowid(), item, before, after];
        connection.prepare_cached("INSERT INTO changes VALUES (?, ?, ?, ?)")?.execute(values)?;
    }
    Ok(())
}

/// A stretch of samples whose block is in another table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    pub series: i64,
    pub node: Node,
    pub last_value: i64,
    /// The row of `blocks`, and the byte in it where its samples begin.
    pub block: i64,
    pub start: i64,
}

impl Span {
    pub fn last(&self) -> Sample {
        Sample { at: self.node.last, value: self.last_value, gap: false }
    }
}

pub const SPANS: &str = "SELECT series, first, last, count, low, high, low_first, gap, sum, rises, on_time, observed,
    last_value, block, start FROM spans";

pub fn span(row: &Row<'_>) -> Result<Span> {
    let node = Node {
        first: row.get(1)?,
        last: row.get(2)?,
        count: number(row, 3)?,
        low: row.get(4)?,
        high: row.get(5)?,
        low_first: row.get(6)?,
        gap: row.get(7)?,
        sum: row.get(8)?,
        rises: number(row, 9)?,
        on: row.get(10)?,
        observed: row.get(11)?,
    };
    let Node { first, last, count, low, high, on, observed, .. } = node;
    let width = u32::try_from(last.checked_sub(first).ok_or_else(|| wrong(2))?);
    let counted = count > 0 && count <= BLOCK as u64 && (count > 1) == (last > first);
    let sensible = is_time(first) && is_time(last) && width.is_ok() && counted && low <= high;
    if !sensible || on < 0 || observed < on {
        return Err(wrong(1));
    }
    Ok(Span { series: row.get(0)?, node, last_value: row.get(12)?, block: row.get(13)?, start: row.get(14)? })
}

pub fn add_span(connection: &Connection, span: &Span) -> Result<()> {
    let Span { series, last_value, block, start, node } = span;
    let Node { first, last, count, low, high, low_first, gap, sum, rises, on, observed } = node;
    let (count, rises) = (i64::try_from(*count).unwrap_or(i64::MAX), i64::try_from(*rises).unwrap_or(i64::MAX));
    let sql = "INSERT INTO spans VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)";
    let values = params![
        series, first, last, count, low, high, low_first, gap, sum, rises, on, observed, last_value, block, start
    ];
    connection.prepare_cached(sql)?.execute(values)?;
    Ok(())
}

/// A sample of `fresh`: its row, its series' row and itself.
pub fn fresh(row: &Row<'_>) -> Result<(i64, i64, Sample)> {
    let at: Micros = row.get(2)?;
    if !is_time(at) {
        return Err(wrong(2));
    }
    Ok((row.get(0)?, row.get(1)?, Sample { at, value: row.get(3)?, gap: row.get(4)? }))
}
