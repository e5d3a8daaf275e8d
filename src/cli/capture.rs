//! `--capture`: all that passes the line, into a file beside the work.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::stop::Stop;
use super::{Outcome, output};
use crate::bus::{BusEvent, Statistics};
use crate::capture::{self, CaptureWriter, Form};

/// Bytes of a file that are looked at to see whether it is a capture.
const BEGINNING: u64 = 1 << 16;

/// The file that was asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaptureFile {
    path: PathBuf,
    form: Form,
}

/// Reads the option's value.
pub fn capture_file(text: &str) -> Result<CaptureFile, String> {
    let path = PathBuf::from(text);
    match Form::of_path(&path) {
        Some(form) => Ok(CaptureFile { path, form }),
        None => Err("the name must end with .pcapng (for Wireshark), .txt or .log (text)".to_owned()),
    }
}

/// A capture under way. Each frame is handed to the system in one piece, so that the file is whole after every frame and
/// whatever ends the program.
pub struct Capture {
    path: PathBuf,
    /// `None` after a failure.
    writer: Option<CaptureWriter<File>>,
    missed: u64,
}

impl Capture {
    /// Begins the file. An earlier capture is replaced; any other file is left alone.
    pub fn begin(file: &CaptureFile, line: &str) -> Outcome<Self> {
        let CaptureFile { path, form } = file;
        let failed =
            |error| Stop::failed(format!("{} cannot be written: {error} – choose another file", path.display()));
        if !may_be_replaced(path).map_err(failed)? {
            let path = path.display();
            return Err(Stop::usage(format!(
                "{path} exists and was not captured by this program – choose another name, or remove it"
            )));
        }
        let writer = File::create(path).and_then(|to| CaptureWriter::new(*form, to, line)).map_err(failed)?;
        Ok(Self { path: path.clone(), writer: Some(writer), missed: 0 })
    }

    /// Notes what belongs into the file.
    pub fn take(&mut self, event: &BusEvent) {
        match event {
            BusEvent::Traffic(frame) => {
                let Some(writer) = &mut self.writer else { return };
                if let Err(error) = writer.frame(frame) {
                    let path = self.path.display();
                    output::warning(&format!("the capture {path} ends here, what stands in it is whole: {error}"));
                    self.writer = None;
                }
            }
            BusEvent::Statistics(Statistics { frames_missed, .. }) => self.missed = self.missed.max(*frames_missed),
            _ => {}
        }
    }
}

impl Drop for Capture {
    fn drop(&mut self) {
        if self.missed > 0 {
            let (missed, path) = (self.missed, self.path.display());
            output::warning(&format!("{missed} frames are missing in {path}: they came faster than they were taken"));
        }
    }
}

/// A file that is not there, is empty, is a capture, or is no file at all, such as a pipe.
fn may_be_replaced(path: &Path) -> io::Result<bool> {
    match path.metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(true),
        Err(error) => return Err(error),
        Ok(found) if found.is_file() && found.len() > 0 => {}
        Ok(_) => return Ok(true),
    }
    let mut beginning = Vec::new();
    File::open(path)?.take(BEGINNING).read_to_end(&mut beginning)?;
    Ok(capture::is_own(&beginning))
}
