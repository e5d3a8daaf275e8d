//! Where the program keeps its files.

use std::path::{Path, PathBuf};

use directories::ProjectDirs;
use jiff::Timestamp;

use crate::version::NAME;

/// Overrides the configuration folder; for tests and portable use.
pub const OVERRIDE: &str = "DCON_BENCH_CONFIG";

/// The folders that the system gives a program of this name.
fn own() -> Option<ProjectDirs> {
    ProjectDirs::from("", "", NAME)
}

/// The user's configuration folder, whether it exists or not.
pub fn config() -> Option<PathBuf> {
    match std::env::var_os(OVERRIDE) {
        Some(folder) => Some(PathBuf::from(folder)),
        None => own().map(|folders| folders.config_dir().to_path_buf()),
    }
}

/// Where the user's own module definitions are looked for.
pub fn definitions() -> Option<PathBuf> {
    config().map(|folder| folder.join("modules"))
}

/// Where recordings go unless the user names another folder: beside the settings if their folder is overridden, else
/// among the user's data, whether it exists or not.
pub fn recordings() -> Option<PathBuf> {
    data().map(|folder| folder.join("recordings"))
}

/// Where the log is kept where nobody reads what the program writes to its standard error.
pub fn log() -> Option<PathBuf> {
    data().map(|folder| folder.join("log.txt"))
}

fn data() -> Option<PathBuf> {
    match std::env::var_os(OVERRIDE) {
        Some(folder) => Some(PathBuf::from(folder)),
        None => own().map(|folders| folders.data_local_dir().to_path_buf()),
    }
}

/// A file in a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    pub path: PathBuf,
    pub bytes: u64,
    /// When it was written last.
    pub changed: Timestamp,
}

/// The `most` files of a folder that were written last and whose names end with `ending`, the newest first; none if the
/// folder cannot be read.
pub fn newest(folder: &Path, ending: &str, most: usize) -> Vec<Found> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    let ours = paths.filter(|path| path.extension().is_some_and(|extension| extension == ending));
    let mut files: Vec<Found> = ours.filter_map(found).collect();
    files.sort_by(|one, other| other.changed.cmp(&one.changed).then_with(|| other.path.cmp(&one.path)));
    files.truncate(most);
    files
}

fn found(path: PathBuf) -> Option<Found> {
    let metadata = std::fs::metadata(&path).ok().filter(std::fs::Metadata::is_file)?;
    let changed = Timestamp::try_from(metadata.modified().ok()?).ok()?;
    Some(Found { path, bytes: metadata.len(), changed })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_files_with_the_ending_stand_first() {
        let folder = tempfile::tempdir().unwrap();
        for (name, seconds) in [("a.rec", 10), ("b.rec", 30), ("c.rec", 20), ("d.csv", 40)] {
            let file = std::fs::File::create(folder.path().join(name)).unwrap();
            file.set_modified(std::time::UNIX_EPOCH + std::time::Duration::from_secs(seconds)).unwrap();
        }
        let found = newest(folder.path(), "rec", 2);
        let names: Vec<_> = found.iter().map(|file| file.path.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["b.rec", "c.rec"]);
        assert!(newest(&folder.path().join("none"), "rec", 2).is_empty());
    }
}
