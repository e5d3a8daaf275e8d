//! Where the log and panics are told: standard error, or a file where nobody reads that.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::folders;

/// A longer file is begun anew at the next start.
const MOST_BYTES: u64 = 1_000_000;

/// Whether standard error leads anywhere. On Windows it does not where the program was started from the desktop, or has let go
/// of the console of whoever started it.
pub fn are_read() -> bool {
    #[cfg(windows)]
    return !std::os::windows::io::AsRawHandle::as_raw_handle(&std::io::stderr()).is_null();
    #[cfg(not(windows))]
    return true;
}

/// The file that takes their place; `None` where they are read, or where there is no folder for it.
pub fn file() -> Option<PathBuf> {
    if are_read() { None } else { folders::log() }
}

/// Opens it to go on with it.
///
/// # Errors
/// What the system says.
pub fn open(path: &Path) -> std::io::Result<File> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    if path.metadata().is_ok_and(|metadata| metadata.len() > MOST_BYTES) {
        return File::create(path);
    }
    File::options().append(true).create(true).open(path)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn the_file_goes_on_until_it_is_long_and_is_then_begun_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("not there yet").join("log.txt");
        for text in ["first\n", "second\n"] {
            open(&path).unwrap().write_all(text.as_bytes()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "first\nsecond\n");
        File::options().write(true).open(&path).unwrap().set_len(MOST_BYTES + 1).unwrap();
        open(&path).unwrap().write_all(b"third\n").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "third\n");
    }
}
