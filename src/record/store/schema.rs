//! The file: an SQLite database (`application_id` 0x44434252, `user_version` 1) that any program can read.
//!
//! Times are microseconds since 1970 UTC; values are integers in units of the series' last decimal (`decimals` = 2:
//! 2499 is 24.99), 0 or 1 for switches, the place of a word in the JSON list `words` for choices.
//!
//! | table | one row for |
//! |---|---|
//! | `modules` | a module as it is described now |
//! | `series` | an item of a module; `kind` is `number`, `switch` or `choice` |
//! | `events` | something that happened; `kind` as in exports, `module` may be null |
//! | `changes` | a setting that was written, beside its event |
//! | `fresh` | a sample among the newest, in order of arrival |
//! | `spans` | up to 512 samples in a row of one series: what is known of them, and where in `blocks` they are |
//! | `blocks` | the samples of several spans one after the other, each as [`codec`](super::codec) says |
//! | `counters` | `next_fresh`: every later row of `fresh` has this id or a higher one |
//!
//! The samples of a span begin at byte `start` (from 0) of the row `block`. A sample stands in `fresh` or in one block,
//! never in both. `gap` is 1 where samples are missing before. Of a span, `rises` says how often the value came from
//! zero, or out of a gap, to something else; `on_time` and `observed` for how long it was not zero, and for how long it
//! was observed, from the sample before the span to its last. The views `readings` and `settings_written` are for
//! people.

use std::fs;
use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, OpenFlags};

use super::lock::beside;
use super::problem::StoreError;

/// "DCBR": a recording of this program.
pub const APPLICATION: i64 = 0x4443_4252;

/// How long another program is waited for that holds the file.
const PATIENCE: Duration = Duration::from_secs(2);

/// The steps from one version to the next; `user_version` says how many were taken.
const STEPS: [&str; 1] = [FIRST];

const FIRST: &str = "
CREATE TABLE modules (
    id INTEGER PRIMARY KEY, line TEXT NOT NULL, address INTEGER NOT NULL, protocol TEXT NOT NULL, baud_rate INTEGER,
    data_format TEXT, checksum INTEGER NOT NULL, model TEXT NOT NULL, label TEXT NOT NULL, name TEXT NOT NULL,
    firmware TEXT NOT NULL
);
CREATE TABLE series (
    id INTEGER PRIMARY KEY, module INTEGER NOT NULL REFERENCES modules, item TEXT NOT NULL, label TEXT NOT NULL,
    unit TEXT NOT NULL, kind TEXT NOT NULL, decimals INTEGER NOT NULL, words TEXT, UNIQUE (module, item)
);
CREATE TABLE events (
    id INTEGER PRIMARY KEY, at INTEGER NOT NULL, module INTEGER REFERENCES modules, kind TEXT NOT NULL,
    text TEXT NOT NULL
);
CREATE TABLE changes (
    event INTEGER PRIMARY KEY REFERENCES events, item TEXT NOT NULL, before TEXT, after TEXT NOT NULL
);
CREATE TABLE fresh (
    id INTEGER PRIMARY KEY, series INTEGER NOT NULL, at INTEGER NOT NULL, value INTEGER NOT NULL, gap INTEGER NOT NULL
);
CREATE TABLE blocks (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
CREATE TABLE spans (
    series INTEGER NOT NULL, first INTEGER NOT NULL, last INTEGER NOT NULL, count INTEGER NOT NULL,
    low INTEGER NOT NULL, high INTEGER NOT NULL, low_first INTEGER NOT NULL, gap INTEGER NOT NULL, sum INTEGER NOT NULL,
    rises INTEGER NOT NULL, on_time INTEGER NOT NULL, observed INTEGER NOT NULL, last_value INTEGER NOT NULL,
    block INTEGER NOT NULL, start INTEGER NOT NULL, PRIMARY KEY (series, first)
) WITHOUT ROWID;
CREATE TABLE counters (name TEXT PRIMARY KEY, value INTEGER NOT NULL) WITHOUT ROWID;
INSERT INTO counters VALUES ('next_fresh', 1);
CREATE VIEW readings AS
    SELECT strftime('%Y-%m-%dT%H:%M:%fZ', fresh.at / 1e6, 'unixepoch') AS time, modules.line,
        modules.label || '@' || modules.address AS module, series.item,
        CASE WHEN series.kind = 'choice' THEN json_extract(series.words, '$[' || fresh.value || ']')
        WHEN series.decimals = 0 THEN fresh.value
        ELSE fresh.value / CAST('1e' || series.decimals AS REAL) END AS value, series.unit, fresh.gap
    FROM fresh JOIN series ON series.id = fresh.series JOIN modules ON modules.id = series.module ORDER BY fresh.id;
CREATE VIEW settings_written AS
    SELECT strftime('%Y-%m-%dT%H:%M:%fZ', events.at / 1e6, 'unixepoch') AS time, modules.line,
        modules.label || '@' || modules.address AS module, changes.item, changes.before, changes.after
    FROM changes JOIN events ON events.id = changes.event LEFT JOIN modules ON modules.id = events.module
    ORDER BY events.id;
";

/// A recording that may be written; made if there is none. The caller holds its lock.
///
/// # Errors
/// If there is another kind of file, or it cannot be written.
pub fn open_to_write(path: &Path) -> Result<Connection, StoreError> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(StoreError::NotARecording { path: path.to_owned() }),
        Ok(metadata) if metadata.len() > 0 && !is_recording(path)? => {
            return Err(StoreError::NotARecording { path: path.to_owned() });
        }
        Ok(metadata) if metadata.permissions().readonly() => {
            return Err(StoreError::ReadOnly { path: path.to_owned() });
        }
        _ => {}
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE;
    let connection = connect(path, "", flags)?;
    prepare(&connection, path)?;
    Ok(connection)
}

fn prepare(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    let problem = |error: &_| StoreError::sqlite(path, error);
    let version = version(connection, path)?;
    let steps = STEPS.get(version..).ok_or_else(|| StoreError::Later { path: path.to_owned() })?;
    if !steps.is_empty() {
        // All in one, before the journal changes: whoever looks into the file's beginning knows it from then on.
        let steps = steps.concat();
        let all = format!(
            "BEGIN IMMEDIATE; PRAGMA application_id = {APPLICATION}; {steps} PRAGMA user_version = {}; COMMIT;",
            STEPS.len()
        );
        connection.execute_batch(&all).map_err(|error| problem(&error))?;
    }
    let journal: String =
        connection.query_row("PRAGMA journal_mode = WAL", [], |row| row.get(0)).map_err(|error| problem(&error))?;
    if journal != "wal" {
        return Err(StoreError::Busy { path: path.to_owned() });
    }
    connection.execute_batch("PRAGMA synchronous = NORMAL").map_err(|error| problem(&error))
}

/// How many steps were taken; an error if they are more than are known here.
fn version(connection: &Connection, path: &Path) -> Result<usize, StoreError> {
    let version = pragma(connection, "user_version").map_err(|error| StoreError::sqlite(path, &error))?;
    let version = usize::try_from(version).map_err(|_| StoreError::damaged(path, "its version is below zero"))?;
    if version > STEPS.len() { Err(StoreError::Later { path: path.to_owned() }) } else { Ok(version) }
}

/// How a recording was opened for reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// It may be written meanwhile.
    Shared,
    /// As it stands, because its folder cannot be written.
    Frozen,
}

/// A recording that is only read.
///
/// # Errors
/// If it is not there, is not a recording, is of a later version or cannot be read.
pub fn open_to_read(path: &Path) -> Result<(Connection, Access), StoreError> {
    let metadata = fs::metadata(path).map_err(|error| StoreError::reading(path, &error))?;
    if metadata.is_dir() {
        return Err(StoreError::NotARecording { path: path.to_owned() });
    }
    let shared = connect(path, "?mode=ro", OpenFlags::SQLITE_OPEN_READ_ONLY).and_then(|it| check(it, path));
    match shared {
        Ok(connection) => Ok((connection, Access::Shared)),
        Err(error @ (StoreError::Other { .. } | StoreError::ReadOnly { .. } | StoreError::NotAllowed { .. })) => {
            let waiting = fs::metadata(beside(path, "-wal")).is_ok_and(|wal| wal.len() > 0);
            if waiting {
                return Err(error);
            }
            let connection = connect(path, "?immutable=1", OpenFlags::SQLITE_OPEN_READ_ONLY)?;
            Ok((check(connection, path)?, Access::Frozen))
        }
        Err(error) => Err(error),
    }
}

fn check(connection: Connection, path: &Path) -> Result<Connection, StoreError> {
    let application = pragma(&connection, "application_id").map_err(|error| StoreError::sqlite(path, &error))?;
    if application != APPLICATION {
        return Err(StoreError::NotARecording { path: path.to_owned() });
    }
    if version(&connection, path)? == 0 {
        return Err(StoreError::damaged(path, "its tables are missing"));
    }
    // Nothing in a file from elsewhere is carried out, and its pages are looked at before they are believed.
    connection
        .execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON")
        .map_err(|error| StoreError::sqlite(path, &error))?;
    Ok(connection)
}

/// Whether the file's beginning says that it is a recording; nothing is made or changed beside it.
///
/// # Errors
/// If it cannot be read.
pub fn is_recording(path: &Path) -> Result<bool, StoreError> {
    let connection = connect(path, "?immutable=1", OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    // Without its journal the file may be shorter than its beginning says: after a full disk.
    connection.execute_batch("PRAGMA writable_schema = ON").map_err(|error| StoreError::sqlite(path, &error))?;
    match pragma(&connection, "application_id").map_err(|error| StoreError::sqlite(path, &error)) {
        Ok(application) => Ok(application == APPLICATION),
        Err(StoreError::NotARecording { .. } | StoreError::Damaged { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

pub fn pragma(connection: &Connection, name: &str) -> rusqlite::Result<i64> {
    connection.query_row(&format!("PRAGMA {name}"), [], |row| row.get(0))
}

fn connect(path: &Path, parameters: &str, flags: OpenFlags) -> Result<Connection, StoreError> {
    let flags = flags | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let problem = |error: rusqlite::Error| StoreError::sqlite(path, &error);
    let connection = Connection::open_with_flags(uri(path, parameters), flags).map_err(problem)?;
    connection.busy_timeout(PATIENCE).map_err(problem)?;
    Ok(connection)
}

/// The path as SQLite's addresses have it; every byte that could mean something else as `%` and two digits.
fn uri(path: &Path, parameters: &str) -> String {
    let mut uri = String::from("file:");
    let bytes = path.as_os_str().as_encoded_bytes();
    let is_slash = |byte: &u8| *byte == b'/' || (cfg!(windows) && *byte == b'\\');
    if cfg!(windows) && bytes.get(1) == Some(&b':') {
        // `C:\x` is `file:/C:/x`.
        uri.push('/');
    } else if bytes.iter().take(2).filter(|byte| is_slash(byte)).count() == 2 {
        // `\\server\x` is `file:////server/x`.
        uri.push_str("//");
    }
    for byte in bytes {
        match byte {
            b'\\' if cfg!(windows) => uri.push('/'),
            b'/' | b'.' | b'-' | b'_' | b':' => uri.push(char::from(*byte)),
            byte if byte.is_ascii_alphanumeric() => uri.push(char::from(*byte)),
            byte => uri.push_str(&format!("%{byte:02x}")),
        }
    }
    uri + parameters
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strange_name_is_a_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("50 % off?mode=memory#1 ü.sqlite");
        drop(open_to_write(&path).unwrap());
        assert!(path.exists());
        assert!(open_to_read(&path).is_ok());
    }

    #[test]
    fn what_is_not_a_recording_is_told_apart_and_not_changed() {
        let folder = tempfile::tempdir().unwrap();
        let text = folder.path().join("text.sqlite");
        fs::write(&text, "not a database at all, but long enough to look like one".repeat(100)).unwrap();
        let foreign = folder.path().join("foreign.sqlite");
        Connection::open(&foreign).unwrap().execute_batch("CREATE TABLE t (a)").unwrap();
        for path in [text, foreign, folder.path().to_owned()] {
            let before = fs::read(&path).ok();
            assert_eq!(open_to_write(&path).unwrap_err(), StoreError::NotARecording { path: path.clone() });
            assert_eq!(open_to_read(&path).unwrap_err(), StoreError::NotARecording { path: path.clone() });
            assert_eq!(fs::read(&path).ok(), before);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_recording_that_a_full_disk_cut_is_one_all_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.sqlite");
        open_to_write(&path).unwrap().query_row("PRAGMA journal_mode = DELETE", [], |_| Ok(())).unwrap();
        let length = fs::metadata(&path).unwrap().len();
        fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(length / 2).unwrap();
        assert_eq!(is_recording(&path), Ok(true));
    }

    #[test]
    fn a_later_version_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("later.sqlite");
        open_to_write(&path).unwrap().execute_batch("PRAGMA user_version = 99").unwrap();
        assert_eq!(open_to_read(&path).unwrap_err(), StoreError::Later { path: path.clone() });
        assert_eq!(open_to_write(&path).unwrap_err(), StoreError::Later { path });
    }

    #[test]
    fn a_file_that_is_not_there_is_told() {
        let path = Path::new("/no/such/folder/a.sqlite");
        assert_eq!(open_to_read(path).unwrap_err(), StoreError::NotThere { path: path.to_owned() });
    }
}
