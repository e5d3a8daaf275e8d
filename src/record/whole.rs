//! Files that have their name only once they are whole.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Names that are tried for what is not whole yet.
const MOST_PARTS: u32 = 10_000;

/// Lets `write` fill a file under another name, and gives it the name `path` once it is whole and on the disk. After a
/// failure no part is left behind, and a file that stood there is as it was. What is no file, such as a pipe, is written
/// as it stands.
///
/// # Errors
/// If `write` fails, or the file cannot be made or named.
pub fn write_whole<T, E: From<io::Error>>(path: &Path, write: impl FnOnce(&File) -> Result<T, E>) -> Result<T, E> {
    // Through links, so that the file is replaced and not the link.
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    if path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        return write(&File::options().write(true).open(&path)?);
    }
    let (unfinished, file) = begin_part(&path)?;
    let written = write_part(file, write).and_then(|written| {
        fs::rename(&unfinished, &path)?;
        Ok(written)
    });
    if written.is_err() {
        // Nothing more can be done if that fails too.
        let _ = fs::remove_file(&unfinished);
    }
    written
}

/// Whether [`write_whole`] could begin now; nothing is left behind.
///
/// # Errors
/// What would keep it from beginning.
pub fn check_writable(path: &Path) -> io::Result<()> {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match path.metadata() {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        // Windows replaces no such file.
        Ok(found) if cfg!(windows) && found.permissions().readonly() => {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        Ok(found) if !found.is_file() => return File::options().write(true).open(&path).map(drop),
        _ => {}
    }
    let (part, _) = begin_part(&path)?;
    fs::remove_file(part)
}

/// A new file beside `path`: `PATH.part`, or `PATH.part2` and so on where somebody else has such a file, be it one that
/// was left by a crash.
fn begin_part(path: &Path) -> io::Result<(PathBuf, File)> {
    let mut taken = io::Error::from(io::ErrorKind::AlreadyExists);
    for number in 1..=MOST_PARTS {
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        if number > 1 {
            name.push(number.to_string());
        }
        let part = path.with_file_name(name);
        match File::create_new(&part) {
            Ok(file) => return Ok((part, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => taken = error,
            Err(error) => return Err(error),
        }
    }
    Err(taken)
}

fn write_part<T, E: From<io::Error>>(file: File, write: impl FnOnce(&File) -> Result<T, E>) -> Result<T, E> {
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

    #[test]
    fn a_part_that_somebody_else_has_is_left_and_does_not_stand_in_the_way() {
        let folder = tempfile::tempdir().unwrap();
        let (file, foreign) = (folder.path().join("file"), folder.path().join("file.part"));
        fs::write(&foreign, "foreign").unwrap();
        write_whole(&file, |mut outer| {
            // Another export to the same path, meanwhile.
            write_whole(&file, |mut inner| inner.write_all(b"inner"))?;
            outer.write_all(b"outer")
        })
        .unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "outer");
        write_whole(&file, |_| Err::<(), _>(io::Error::other("no"))).unwrap_err();
        assert_eq!(fs::read_to_string(&foreign).unwrap(), "foreign");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
