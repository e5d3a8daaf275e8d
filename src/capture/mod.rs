//! Frames of a line as files that other programs read, and such files as frames again.
//!
//! Two forms: `pcapng`, whose packets have the link type `WIRESHARK_UPPER_PDU` (252) and name their dissector (`mbrtu`,
//! `mbtcp`, for DCON `data-text-lines`), so that Wireshark decodes them without being told anything; and text, one line a
//! frame. What neither has a field for stands in words with the frame (`words`), for people and for reading it again.
//! Reading and writing go frame by frame; nothing that a file contains makes the reader panic or take much memory.

mod parts;
mod pcapng;
mod pdu;
mod text;
mod words;

use std::fs::File;
use std::io::{self, Cursor, Read, Write};
use std::path::Path;

use crate::bus::Frame;

/// Bytes of a frame that are kept; of a longer one the beginning is.
pub const MOST_BYTES: usize = 65_535;
/// How a pcapng file begins, and how one does that has another form of the same name.
const PCAPNG_BEGINNING: [u8; 4] = [0x0A, 0x0D, 0x0D, 0x0A];
const PCAP_BEGINNINGS: [[u8; 4]; 4] =
    [[0xA1, 0xB2, 0xC3, 0xD4], [0xD4, 0xC3, 0xB2, 0xA1], [0xA1, 0xB2, 0x3C, 0x4D], [0x4D, 0x3C, 0xB2, 0xA1]];

/// As the files name who wrote them.
const APPLICATION: &str = "dcon-bench ";
/// Bytes of a pcapng file in which its writer's name stands, if it is this program's.
const OWN_NAME_WITHIN: usize = 256;

/// How a capture is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Pcapng,
    Text,
}

impl Form {
    pub const ALL: [Self; 2] = [Self::Pcapng, Self::Text];

    /// The name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Pcapng => "pcapng (Wireshark)",
            Self::Text => "text",
        }
    }

    /// As file names end.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Pcapng => "pcapng",
            Self::Text => "txt",
        }
    }

    /// As the end of the file's name says: `.pcapng`, `.txt` or `.log`.
    pub fn of_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "pcapng" => Some(Self::Pcapng),
            "txt" | "log" => Some(Self::Text),
            _ => None,
        }
    }
}

/// Why a capture cannot be read, or not to its end.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    #[error("it could not be read: {0}")]
    Io(#[from] io::Error),
    #[error("it is no capture – pcapng and the text of this program can be read")]
    NotACapture,
    #[error("it is a capture in the older pcap form – save it as pcapng with Wireshark")]
    OlderForm,
    #[error("{packets} packets are in it, but none of Modbus or DCON – choose another file")]
    NothingKnown { packets: u64 },
    #[error("it ends in the middle of a frame – what stands before that is whole")]
    Cut,
    #[error("it is damaged at {place}: {reason} – what stands before that is whole")]
    Damaged { place: String, reason: String },
}

/// Writes a capture, frame by frame. After each frame the file is whole: nothing is needed to end it but that `to` was
/// flushed.
pub struct CaptureWriter<W: Write> {
    to: W,
    writer: FormWriter,
}

enum FormWriter {
    Pcapng(Box<pcapng::Writer>),
    Text,
}

impl<W: Write> CaptureWriter<W> {
    /// Begins a capture of the line of this name, such as `COM3`.
    ///
    /// # Errors
    /// What `to` says.
    pub fn new(form: Form, mut to: W, line: &str) -> io::Result<Self> {
        let writer = match form {
            Form::Pcapng => {
                let (writer, beginning) = pcapng::Writer::begin(line)?;
                to.write_all(&beginning)?;
                FormWriter::Pcapng(Box::new(writer))
            }
            Form::Text => {
                to.write_all(text::beginning(line).as_bytes())?;
                FormWriter::Text
            }
        };
        Ok(Self { to, writer })
    }

    /// Adds a frame, in one write. Times in pcapng are those from 1970 to 2554; of more than [`MOST_BYTES`] the beginning
    /// is kept.
    ///
    /// # Errors
    /// What `to` says.
    pub fn frame(&mut self, frame: &Frame) -> io::Result<()> {
        match &mut self.writer {
            FormWriter::Pcapng(writer) => self.to.write_all(&writer.frame(frame)?),
            FormWriter::Text => self.to.write_all(text::line(frame).as_bytes()),
        }
    }

    /// Where it is written to.
    pub fn get_mut(&mut self) -> &mut W {
        &mut self.to
    }

    /// Flushes, and gives back where it was written to.
    ///
    /// # Errors
    /// What it says.
    pub fn finish(mut self) -> io::Result<W> {
        self.to.flush()?;
        Ok(self.to)
    }
}

/// The frames of a capture, as they are read. After an error nothing follows.
pub struct Frames<R: Read> {
    source: Source<R>,
    has_ended: bool,
}

/// What was looked at to tell the form, and the rest.
type Whole<R> = io::Chain<Cursor<Vec<u8>>, R>;

enum Source<R: Read> {
    Pcapng(Box<pcapng::Reader<Whole<R>>>),
    Text(Box<text::Reader<Whole<R>>>),
}

/// Begins to read a capture of either form.
///
/// # Errors
/// If it is neither, or is damaged at its beginning.
pub fn read<R: Read>(mut from: R) -> Result<Frames<R>, CaptureError> {
    let mut beginning = Vec::new();
    from.by_ref().take(PCAPNG_BEGINNING.len() as u64).read_to_end(&mut beginning)?;
    let is_pcapng = beginning == PCAPNG_BEGINNING;
    if PCAP_BEGINNINGS.iter().any(|known| beginning == known) {
        return Err(CaptureError::OlderForm);
    }
    let whole = Cursor::new(beginning).chain(from);
    let source = if is_pcapng {
        Source::Pcapng(Box::new(pcapng::Reader::begin(whole)?))
    } else {
        Source::Text(Box::new(text::Reader::begin(whole)?))
    };
    Ok(Frames { source, has_ended: false })
}

/// As [`read`], from a file.
///
/// # Errors
/// If it cannot be opened, and as [`read`].
pub fn read_file(path: &Path) -> Result<Frames<File>, CaptureError> {
    read(File::open(path)?)
}

/// Whether a file that begins so was written by this program.
pub fn is_own(beginning: &[u8]) -> bool {
    let named = |bytes: &[u8]| bytes.windows(APPLICATION.len()).any(|window| window == APPLICATION.as_bytes());
    match beginning.strip_prefix(&PCAPNG_BEGINNING) {
        // Among the first words of the file.
        Some(rest) => named(rest.get(..OWN_NAME_WITHIN).unwrap_or(rest)),
        None => beginning.strip_prefix(b"# ").is_some_and(|rest| rest.starts_with(APPLICATION.as_bytes())),
    }
}

/// All frames of a capture in memory, and why they are not more.
pub fn read_bytes(bytes: &[u8]) -> (Vec<Frame>, Option<CaptureError>) {
    let mut found = Vec::new();
    let frames = match read(bytes) {
        Ok(frames) => frames,
        Err(error) => return (found, Some(error)),
    };
    for frame in frames {
        match frame {
            Ok(frame) => found.push(frame),
            Err(error) => return (found, Some(error)),
        }
    }
    (found, None)
}

impl<R: Read> Iterator for Frames<R> {
    type Item = Result<Frame, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.has_ended {
            return None;
        }
        let next = match &mut self.source {
            Source::Pcapng(reader) => reader.next_frame(),
            Source::Text(reader) => reader.next_frame(),
        };
        self.has_ended = !matches!(next, Ok(Some(_)));
        next.transpose()
    }
}

#[cfg(test)]
mod tests;
