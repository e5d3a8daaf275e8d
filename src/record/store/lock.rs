//! One writer at a time: the system's lock on a file beside the recording, which ends with the program whatever ends
//! it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use super::problem::StoreError;

/// How often a lock is taken again that was removed by its owner while it was taken.
const ATTEMPTS: usize = 8;

/// Held by whoever writes a recording.
#[derive(Debug)]
pub struct WriterLock {
    path: PathBuf,
    _file: File,
}

impl WriterLock {
    /// # Errors
    /// If another one holds it, or the folder cannot be written.
    pub fn take(recording: &Path) -> Result<Self, StoreError> {
        let path = beside(recording, ".lock");
        let problem = |error: &_| StoreError::writing(recording, error);
        for _ in 0..ATTEMPTS {
            let mut options = OpenOptions::new();
            let file = options.create(true).truncate(false).write(true).open(&path).map_err(|error| problem(&error))?;
            match file.try_lock() {
                Ok(()) if is_at(&file, &path) => return Ok(Self { path, _file: file }),
                // Its owner removed it between the opening and the lock.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => break,
                Err(TryLockError::Error(error)) => return Err(problem(&error)),
            }
        }
        Err(StoreError::InUse { path: recording.to_owned() })
    }
}

impl Drop for WriterLock {
    fn drop(&mut self) {
        // One that stays does no harm: what counts is the system's lock on it.
        let _ = fs::remove_file(&self.path);
    }
}

/// The file with this ending added to its whole name.
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

/// The same name for the same file, whatever links lead there, be it there or not yet.
pub fn real_path(path: &Path) -> PathBuf {
    // What is real on Windows begins with `\\?\`, which SQLite does not take.
    if cfg!(windows) {
        return std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    }
    let in_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(in_folder).unwrap_or_else(|| path.to_owned())
}

fn is_at(file: &File, path: &Path) -> bool {
    let (Ok(opened), Ok(there)) = (file.metadata(), fs::metadata(path)) else { return false };
    FileId::of(&opened) == FileId::of(&there)
}

/// Tells a file from another one of the same name, where the system can.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileId(u64, u64);

impl FileId {
    #[cfg(unix)]
    pub fn of(metadata: &fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self(metadata.dev(), metadata.ino())
    }

    /// Elsewhere a file that is open cannot be replaced.
    #[cfg(not(unix))]
    pub fn of(_metadata: &fs::Metadata) -> Self {
        Self(0, 0)
    }

    /// Of the file that has this name now.
    pub fn at(path: &Path) -> Option<Self> {
        fs::metadata(path).ok().map(|metadata| Self::of(&metadata))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_writer_is_refused_until_the_first_has_ended() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sqlite");
        let first = WriterLock::take(&path).unwrap();
        assert_eq!(WriterLock::take(&path).unwrap_err(), StoreError::InUse { path: path.clone() });
        drop(first);
        assert!(WriterLock::take(&path).is_ok());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_lock_that_a_killed_program_left_behind_is_free() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sqlite");
        fs::write(beside(&path, ".lock"), "").unwrap();
        assert!(WriterLock::take(&path).is_ok());
    }

    #[test]
    fn a_folder_that_is_not_there_is_told() {
        let path = Path::new("/no/such/folder/a.sqlite");
        assert_eq!(WriterLock::take(path).unwrap_err(), StoreError::NoFolder { path: path.to_owned() });
    }
}
