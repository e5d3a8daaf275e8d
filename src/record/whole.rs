//! Files that have their name only once they are whole.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// Lets `write` fill a file under another name, and gives it the name `path` once it is whole and on the disk. After a
/// failure no part is left behind, and a file that stood there is as it was. What is no file, such as a pipe, is written
/// as it stands.
///
/// # Errors
/// If `write` fails, or the file cannot be made or named.
pub(super) fn write_whole<T, E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&File) -> Result<T, E>,
) -> Result<T, E> {
    // Through links, so that the file is replaced and not the link.
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    if path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        return write(&File::options().write(true).open(&path)?);
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let unfinished = path.with_file_name(name);
    let written = write_part(&unfinished, write).and_then(|written| {
        fs::rename(&unfinished, &path)?;
        Ok(written)
    });
    if written.is_err() {
        // Nothing more can be done if that fails too.
        let _ = fs::remove_file(&unfinished);
    }
    written
}

fn write_part<T, E: From<io::Error>>(path: &Path, write: impl FnOnce(&File) -> Result<T, E>) -> Result<T, E> {
    let file = File::create(path)?;
    let written = write(&file)?;
    file.sync_all()?;
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, |mut file| file.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_written_as_it_stands() {
        write_whole(Path::new("/dev/null"), |mut file| file.write_all(b"new")).unwrap();
        assert!(!Path::new("/dev/null").is_file());
    }
}
