//! Frames as text, one line a frame: time, direction, bytes and what is known of it, two spaces apart.
//!
//! `2024-05-06T07:08:09.028000000Z  received  01 04 02 0B B8 BE 72  answer; Modbus RTU; 9600 N81; address 1; took 20.000 ms`

use std::io::{BufRead, BufReader, Read};

use jiff::Timestamp;

use super::words;
use super::{APPLICATION, CaptureError, MOST_BYTES};
use crate::bus::{Direction, Frame};
use crate::protocol::{Protocol, hex};

/// Begins a line that is for people only.
const REMARK: char = '#';
const COLUMNS: &str = "  ";
const SENT: &str = "sent";
const RECEIVED: &str = "received";
/// In place of the bytes where there are none.
const NOTHING: &str = "-";
/// Bytes of a line at most: three for each of a frame, four for each as text, and the words.
const MOST_IN_LINE: u64 = 8 * MOST_BYTES as u64;

/// What stands above the frames.
pub(super) fn beginning(line: &str) -> String {
    let name: String = line.chars().filter(|character| !character.is_control()).collect();
    format!("# {APPLICATION}{}: traffic of {name}, times in UTC\n", env!("CARGO_PKG_VERSION"))
}

pub(super) fn line(frame: &Frame) -> String {
    let direction = if frame.direction == Direction::Sent { SENT } else { RECEIVED };
    let kept = frame.bytes.get(..MOST_BYTES).unwrap_or(&frame.bytes);
    let bytes = if kept.is_empty() { NOTHING.to_owned() } else { hex::spaced(kept) };
    // The words are separated by semicolons.
    let text = (frame.protocol == Protocol::Dcon && !kept.is_empty())
        .then(|| format!("text \"{}\"", hex::escaped(kept).replace(';', "\\x3b")));
    let words = words::write(frame, text.as_slice());
    format!("{:.9}{COLUMNS}{direction:8}{COLUMNS}{bytes}{COLUMNS}{words}\n", frame.at)
}

fn parsed(line: &str) -> Option<Frame> {
    let (at, rest) = line.split_once(COLUMNS)?;
    let (direction, rest) = rest.split_once(COLUMNS)?;
    let (bytes, words) = rest.trim_start().split_once(COLUMNS)?;
    let at: Timestamp = at.parse().ok()?;
    let direction = match direction.trim() {
        SENT => Direction::Sent,
        RECEIVED => Direction::Received,
        _ => return None,
    };
    let bytes = if bytes == NOTHING { Vec::new() } else { hex::parse(bytes).ok()? };
    Some(words::read(words.trim_start())?.into_frame(at, direction, bytes))
}

/// Makes frames of the lines.
pub(super) struct Reader<R: Read> {
    lines: BufReader<R>,
    number: u64,
    frames: u64,
}

impl<R: Read> Reader<R> {
    /// A file that begins with neither a remark nor a frame is refused.
    pub fn begin(from: R) -> Result<Self, CaptureError> {
        let mut lines = BufReader::new(from);
        let first = lines.fill_buf()?.first().copied();
        if first.is_none_or(|byte| byte != b'#' && !byte.is_ascii_digit() && byte != b'-') {
            return Err(CaptureError::NotACapture);
        }
        Ok(Self { lines, number: 0, frames: 0 })
    }

    pub fn next_frame(&mut self) -> Result<Option<Frame>, CaptureError> {
        loop {
            let Some((line, is_whole)) = self.next_line()? else { return Ok(None) };
            if !is_whole {
                return Err(CaptureError::Cut);
            }
            if line.is_empty() || line.starts_with(REMARK) {
                continue;
            }
            match parsed(&line) {
                Some(frame) => {
                    self.frames = self.frames.saturating_add(1);
                    return Ok(Some(frame));
                }
                None if self.frames == 0 && self.number == 1 => return Err(CaptureError::NotACapture),
                None => return Err(self.damaged("it is not a frame")),
            }
        }
    }

    /// The next line without its end, and whether it had one.
    fn next_line(&mut self) -> Result<Option<(String, bool)>, CaptureError> {
        let mut line = Vec::new();
        self.lines.by_ref().take(MOST_IN_LINE).read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        self.number = self.number.saturating_add(1);
        let is_whole = line.pop_if(|byte| *byte == b'\n').is_some();
        if line.len() as u64 >= MOST_IN_LINE {
            return Err(self.damaged("it is too long"));
        }
        line.pop_if(|byte| *byte == b'\r');
        let line = String::from_utf8(line).map_err(|_| self.damaged("it is not text"))?;
        Ok(Some((line, is_whole)))
    }

    fn damaged(&self, reason: &str) -> CaptureError {
        CaptureError::Damaged { place: format!("line {}", self.number), reason: reason.to_owned() }
    }
}
