//! Writes a file on a thread of its own, part by part. The file has its name only once it is whole.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};

use super::whole::write_whole;

/// Parts that may wait for the disk.
const WAITING: usize = 4;

enum Part {
    Bytes(Vec<u8>),
    End,
}

/// A file that is being written. Dropping it before [`FileWriter::end`] leaves no file behind.
pub struct FileWriter {
    parts: SyncSender<Part>,
    outcome: Receiver<io::Result<()>>,
}

impl FileWriter {
    /// Begins to write `path`; `done` is called when it is written or cannot be.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn start(path: PathBuf, done: impl FnOnce() + Send + 'static) -> io::Result<Self> {
        let (parts, incoming) = sync_channel(WAITING);
        let (tell, outcome) = sync_channel(1);
        let write = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = tell.send(write_whole(&path, |file| write_parts(file, &incoming)));
            done();
        };
        std::thread::Builder::new().name("export".to_owned()).spawn(write)?;
        Ok(Self { parts, outcome })
    }

    /// Hands over a part; gives it back if too many wait. What comes after a failure is dropped.
    pub fn put(&self, bytes: Vec<u8>) -> Option<Vec<u8>> {
        match self.parts.try_send(Part::Bytes(bytes)) {
            Err(TrySendError::Full(Part::Bytes(bytes))) => Some(bytes),
            _ => None,
        }
    }

    /// Everything was handed over. False if it cannot be said yet, because too many parts wait.
    pub fn end(&self) -> bool {
        !matches!(self.parts.try_send(Part::End), Err(TrySendError::Full(_)))
    }

    /// How it ended; `None` while it goes on.
    pub fn outcome(&self) -> Option<io::Result<()>> {
        match self.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(io::Error::other("the writing ended"))),
        }
    }
}

fn write_parts(file: &File, parts: &Receiver<Part>) -> io::Result<()> {
    let mut file = BufWriter::new(file);
    loop {
        match parts.recv() {
            Ok(Part::Bytes(bytes)) => file.write_all(&bytes)?,
            Ok(Part::End) => return file.flush(),
            Err(_) => return Err(io::Error::new(io::ErrorKind::Interrupted, "it was stopped")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::path::Path;
    use std::sync::mpsc::channel;

    fn start(path: &Path) -> (FileWriter, Receiver<()>) {
        let (tell, done) = channel();
        let writer = FileWriter::start(path.to_owned(), move || drop(tell)).unwrap();
        (writer, done)
    }

    #[test]
    fn the_file_holds_all_parts_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        let (writer, done) = start(&path);
        for part in ["a,", "b,", "c"] {
            assert!(writer.put(part.into()).is_none());
        }
        while !writer.end() {}
        done.recv().unwrap_err();
        assert!(writer.outcome().unwrap().is_ok());
        assert_eq!(fs::read_to_string(path).unwrap(), "a,b,c");
    }

    #[test]
    fn what_is_stopped_leaves_neither_a_part_nor_the_old_file_changed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        fs::write(&path, "old").unwrap();
        let (writer, done) = start(&path);
        writer.put("new".into());
        drop(writer);
        done.recv().unwrap_err();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told() {
        let (writer, done) = start(Path::new("/no/such/folder/table.csv"));
        done.recv().unwrap_err();
        assert!(writer.outcome().unwrap().is_err());
    }
}
