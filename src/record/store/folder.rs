//! A folder of recordings: their names, and which of them are removed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use jiff::Timestamp;

use super::Keeping;
use super::file::{RecordingFile, size_on_disk};
use super::lock::{WriterLock, beside, real_path};
use super::problem::StoreError;
use super::schema;

const BEGIN: &str = "dcon-bench ";
const END: &str = ".sqlite";
/// Recordings begun in the same second.
const MOST_ALIKE: u32 = 1_000;

/// Makes a new recording named after the time, in UTC: `dcon-bench 2026-11-22 14.20.05.sqlite`.
///
/// # Errors
/// If the folder cannot be made or written.
pub fn begin(folder: &Path, now: Timestamp) -> Result<RecordingFile, StoreError> {
    fs::create_dir_all(folder).map_err(|error| StoreError::writing(&folder.join(name(now, 1)), &error))?;
    let folder = real_path(folder);
    for number in 1..MOST_ALIKE {
        let path = folder.join(name(now, number));
        if path.exists() {
            continue;
        }
        match WriterLock::take(&path) {
            // Another copy of the program may have made it before its lock was taken here.
            Ok(_) if path.exists() => {}
            Ok(lock) => return RecordingFile::open_locked(path, lock),
            Err(StoreError::InUse { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Err(StoreError::InUse { path: folder.join(name(now, 1)) })
}

fn name(at: Timestamp, number: u32) -> String {
    let at = at.strftime("%Y-%m-%d %H.%M.%S");
    if number == 1 { format!("{BEGIN}{at}{END}") } else { format!("{BEGIN}{at} {number}{END}") }
}

/// When the recording with this name was begun, so that names can be put in order; `None` for other names.
fn age(name: &str) -> Option<(&str, u32)> {
    let middle = name.strip_prefix(BEGIN)?.strip_suffix(END)?;
    let (at, rest) = middle.split_at_checked("2026-11-22 14.20.05".len())?;
    let matches = at.bytes().zip("dddd-dd-dd dd.dd.dd".bytes());
    let is_time =
        matches.into_iter().all(|(byte, shape)| if shape == b'd' { byte.is_ascii_digit() } else { byte == shape });
    let number = if rest.is_empty() { Some(1) } else { rest.strip_prefix(' ').and_then(|rest| rest.parse().ok()) };
    number.filter(|_| is_time).map(|number| (at, number))
}

/// Removes recordings that are older or larger than is to be kept, oldest first; never `current`, what is being
/// written, or anything else than closed recordings. What was removed.
pub fn tidy(folder: &Path, keeping: &Keeping, current: &Path, now: SystemTime) -> Vec<PathBuf> {
    let files = recordings(folder);
    let mut total = files.iter().map(|path| size_on_disk(path)).fold(0, u64::saturating_add);
    let most = keeping.total_size.unwrap_or(u64::MAX);
    let oldest = keeping.days.and_then(|days| {
        let age = Duration::from_secs(u64::from(days).saturating_mul(86_400));
        now.checked_sub(age)
    });
    let mut removed = Vec::new();
    for path in files.into_iter().filter(|path| path != current) {
        let changed = fs::metadata(&path).and_then(|metadata| metadata.modified()).ok();
        let is_old = matches!((changed, oldest), (Some(changed), Some(oldest)) if changed < oldest);
        let size = size_on_disk(&path);
        if (is_old || total > most) && remove(&path) {
            total = total.saturating_sub(size);
            removed.push(path);
        }
    }
    removed
}

/// The recordings of a folder by their names, oldest first.
fn recordings(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| age(name).is_some()).collect();
    names.sort_by(|one, other| age(one).cmp(&age(other)));
    names.into_iter().map(|name| folder.join(name)).collect()
}

fn remove(path: &Path) -> bool {
    // While this is held nobody begins to continue it.
    let Ok(_lock) = WriterLock::take(path) else { return false };
    if !matches!(schema::is_recording(path), Ok(true)) || fs::remove_file(path).is_err() {
        return false;
    }
    for ending in ["-wal", "-shm"] {
        // They are not there if the recording was closed.
        let _ = fs::remove_file(beside(path, ending));
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Timestamp {
        text.parse().unwrap()
    }

    fn make(folder: &Path, time: &str) -> PathBuf {
        let file = begin(folder, at(time)).unwrap();
        let path = file.path().to_owned();
        file.close();
        path
    }

    fn keeping(total_size: Option<u64>, days: Option<u32>) -> Keeping {
        Keeping { file_size: u64::MAX, total_size, days }
    }

    #[test]
    fn recordings_are_named_after_their_time_and_never_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<String> = (0..3)
            .map(|_| make(folder.path(), "2026-11-22T14:20:05Z").file_name().unwrap().to_string_lossy().into_owned())
            .collect();
        assert_eq!(names, ["", " 2", " 3"].map(|number| format!("dcon-bench 2026-11-22 14.20.05{number}.sqlite")));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "no journals or locks stay");
    }

    #[test]
    fn a_file_that_cannot_be_made_leaves_nothing_and_its_name_free() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name(at("2026-11-22T14:20:05Z"), 1));
        // The file is made, but its first transaction fails.
        let journal = beside(&path, "-journal");
        fs::create_dir(&journal).unwrap();
        for _ in 0..3 {
            assert!(begin(folder.path(), at("2026-11-22T14:20:05Z")).is_err());
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
        fs::remove_dir(&journal).unwrap();
        assert_eq!(make(folder.path(), "2026-11-22T14:20:05Z"), real_path(&path));
    }

    #[test]
    fn names_of_others_are_no_recordings() {
        for name in [
            "dcon-bench.sqlite",
            "dcon-bench 2026-11-22.sqlite",
            "dcon-bench 2026-11-22 14.20.0x.sqlite",
            "my dcon-bench 2026-11-22 14.20.05.sqlite",
            "dcon-bench 2026-11-22 14.20.05.sqlite-wal",
            "dcon-bench 2026-11-22 14.20.05 x.sqlite",
            "dcon-bench 2026-11-22 14.20.05ü.sqlite",
            "ü",
        ] {
            assert_eq!(age(name), None, "{name}");
        }
        assert!(age("dcon-bench 2026-11-22 14.20.05 2.sqlite") > age("dcon-bench 2026-11-22 14.20.05.sqlite"));
    }

    #[test]
    fn the_oldest_go_until_the_rest_is_small_enough() {
        let folder = tempfile::tempdir().unwrap();
        let files: Vec<PathBuf> =
            (1..=4).map(|day| make(folder.path(), &format!("2026-11-0{day}T00:00:00Z"))).collect();
        let size = size_on_disk(&files[0]);
        let now = SystemTime::now();
        assert!(tidy(folder.path(), &keeping(None, None), &files[3], now).is_empty());
        assert_eq!(tidy(folder.path(), &keeping(Some(size * 5 / 2), None), &files[3], now), files[..2]);
        assert_eq!(tidy(folder.path(), &keeping(Some(0), None), &files[3], now), files[2..3]);
        assert!(files[3].exists());
    }

    #[test]
    fn what_was_not_changed_for_long_goes() {
        let folder = tempfile::tempdir().unwrap();
        let old = make(folder.path(), "2026-11-01T00:00:00Z");
        let current = make(folder.path(), "2026-11-02T00:00:00Z");
        let later = |days: u64| SystemTime::now() + Duration::from_secs(days * 86_400);
        assert!(tidy(folder.path(), &keeping(None, Some(10)), &current, later(9)).is_empty());
        assert_eq!(tidy(folder.path(), &keeping(None, Some(10)), &current, later(11)), [old]);
    }

    #[test]
    fn what_is_written_or_is_no_recording_stays() {
        let folder = tempfile::tempdir().unwrap();
        let written = begin(folder.path(), at("2026-11-01T00:00:00Z")).unwrap();
        let foreign = folder.path().join("dcon-bench 2026-11-02 00.00.00.sqlite");
        fs::write(&foreign, "somebody's text").unwrap();
        let current = make(folder.path(), "2026-11-03T00:00:00Z");
        assert!(tidy(folder.path(), &keeping(Some(0), Some(0)), &current, SystemTime::now()).is_empty());
        assert!(written.path().exists() && foreign.exists());
        assert!(!beside(&foreign, ".lock").exists());
    }
}
