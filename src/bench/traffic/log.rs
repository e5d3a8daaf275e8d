//! Frames in a ring, their bytes in chunks beside it.

use std::collections::VecDeque;
use std::time::Duration;

use jiff::Timestamp;

use crate::bus::{Direction, Frame, Verdict};
use crate::protocol::{BaudRate, DataFormat, LineSettings, Protocol};

/// Frames kept at most: a day and more of polling at 9600 bps.
const MOST_FRAMES: usize = 1_000_000;
/// Bytes kept at most, reasons of broken answers included.
const MOST_BYTES: usize = 48 << 20;
/// Bytes are forgotten together with the frames of so many others.
const CHUNK: usize = 256 << 10;
/// Bytes of a reason kept at most.
const MOST_REASON: usize = 500;
/// How far the end of a request and the beginning of the wait for its answer may lie apart on the clock: frames are kept
/// in microseconds, and over TCP the two are read from the clock one after the other.
const TOLERANCE: Duration = Duration::from_millis(2);

/// How it ended, as [`Verdict`] says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome<'a> {
    Request,
    Answer,
    Refusal,
    /// With the reason.
    Broken(&'a str),
    Silent,
}

impl Outcome<'_> {
    /// Whether a person who looks for trouble wants to see it.
    pub fn is_error(self) -> bool {
        matches!(self, Self::Refusal | Self::Broken(_) | Self::Silent)
    }

    /// The word of exported files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Request => "request",
            Self::Answer => "answer",
            Self::Refusal => "refusal",
            Self::Broken(_) => "broken",
            Self::Silent => "silent",
        }
    }

    /// In words for a person; empty where nothing is wrong.
    pub fn trouble(&self) -> &str {
        match self {
            Self::Request | Self::Answer => "",
            Self::Refusal => "refused",
            Self::Broken(reason) => reason,
            Self::Silent => "no answer",
        }
    }
}

/// One frame of the log; the fields are those of [`Frame`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRef<'a> {
    /// Counts on from 0 as long as the log lives, also over what was forgotten.
    pub seq: u64,
    pub at: Timestamp,
    pub direction: Direction,
    pub bytes: &'a [u8],
    pub protocol: Protocol,
    pub settings: LineSettings,
    pub address: Option<u8>,
    pub checksum: bool,
    /// To a microsecond.
    pub took: Duration,
    /// To a microsecond.
    pub first_byte: Option<Duration>,
    pub echo: bool,
    pub noise: bool,
    pub outcome: Outcome<'a>,
}

impl FrameRef<'_> {
    /// The frame as the line told it, to a microsecond.
    pub fn to_frame(&self) -> Frame {
        let Self { at, direction, protocol, settings, address, checksum, took, first_byte, echo, noise, .. } = *self;
        let verdict = match self.outcome {
            Outcome::Request => Verdict::Request,
            Outcome::Answer => Verdict::Answer,
            Outcome::Refusal => Verdict::Refusal,
            Outcome::Broken(reason) => Verdict::Broken(reason.to_owned()),
            Outcome::Silent => Verdict::Silent,
        };
        let bytes = self.bytes.to_vec();
        Frame { at, direction, bytes, protocol, settings, address, checksum, took, first_byte, echo, noise, verdict }
    }
}

/// What is kept of a frame beside its bytes.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// Nanoseconds since 1970.
    at: i64,
    took_microseconds: u32,
    /// [`u32::MAX`] if there was no first byte.
    first_byte_microseconds: u32,
    chunk: u32,
    start: u32,
    length: u16,
    reason_length: u16,
    address: Option<u8>,
    direction: Direction,
    protocol: Protocol,
    /// Index into [`BaudRate::ALL`].
    baud_rate: u8,
    data_format: DataFormat,
    checksum: bool,
    echo: bool,
    noise: bool,
    outcome: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Request,
    Answer,
    Refusal,
    Broken,
    Silent,
}

/// The last frames of the line, in order, bounded by number and bytes; the oldest are forgotten.
#[derive(Debug)]
pub struct TrafficLog {
    entries: VecDeque<Entry>,
    first_seq: u64,
    chunks: VecDeque<Vec<u8>>,
    /// Number of the first of `chunks`.
    first_chunk: u32,
    most_frames: usize,
    most_chunks: usize,
}

impl Default for TrafficLog {
    fn default() -> Self {
        Self::bounded(MOST_FRAMES, MOST_BYTES)
    }
}

impl TrafficLog {
    /// At least one frame and one chunk of 256 KiB are kept.
    pub fn bounded(frames: usize, bytes: usize) -> Self {
        Self {
            entries: VecDeque::new(),
            first_seq: 0,
            chunks: VecDeque::new(),
            first_chunk: 0,
            most_frames: frames.max(1),
            most_chunks: (bytes / CHUNK).max(1),
        }
    }

    /// Takes a frame in. Of a frame of more than 65535 bytes the beginning is kept.
    pub fn push(&mut self, frame: Frame) {
        while self.entries.len() >= self.most_frames {
            self.forget_first();
        }
        let reason = if let Verdict::Broken(reason) = &frame.verdict { reason.as_str() } else { "" };
        let bytes = clipped(&frame.bytes);
        let reason = reason.get(..reason.floor_char_boundary(MOST_REASON)).unwrap_or_default();
        let (chunk, start) = self.store(bytes, reason.as_bytes());
        let baud_rate = BaudRate::ALL.iter().position(|rate| *rate == frame.settings.baud_rate);
        self.entries.push_back(Entry {
            at: i64::try_from(frame.at.as_nanosecond()).unwrap_or(i64::MAX),
            took_microseconds: u32::try_from(frame.took.as_micros()).unwrap_or(u32::MAX),
            first_byte_microseconds: frame
                .first_byte
                .and_then(|time| u32::try_from(time.as_micros()).ok())
                .unwrap_or(u32::MAX),
            chunk,
            start: u32::try_from(start).unwrap_or(u32::MAX),
            length: u16::try_from(bytes.len()).unwrap_or(u16::MAX),
            reason_length: u16::try_from(reason.len()).unwrap_or(0),
            address: frame.address,
            direction: frame.direction,
            protocol: frame.protocol,
            baud_rate: baud_rate.and_then(|index| u8::try_from(index).ok()).unwrap_or(u8::MAX),
            data_format: frame.settings.data_format,
            checksum: frame.checksum,
            echo: frame.echo,
            noise: frame.noise,
            outcome: match frame.verdict {
                Verdict::Request => Kind::Request,
                Verdict::Answer => Kind::Answer,
                Verdict::Refusal => Kind::Refusal,
                Verdict::Broken(_) => Kind::Broken,
                Verdict::Silent => Kind::Silent,
            },
        });
    }

    /// Number of frames kept.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Sequence number of the oldest frame kept.
    pub fn first_seq(&self) -> u64 {
        self.first_seq
    }

    /// Sequence number that the next frame will have.
    pub fn next_seq(&self) -> u64 {
        self.first_seq.saturating_add(self.entries.len() as u64)
    }

    /// `None` if it was forgotten, or has not come yet.
    pub fn get(&self, seq: u64) -> Option<FrameRef<'_>> {
        let index = usize::try_from(seq.checked_sub(self.first_seq)?).ok()?;
        let entry = self.entries.get(index)?;
        let chunk = self.chunks.get(usize::try_from(entry.chunk.checked_sub(self.first_chunk)?).ok()?)?;
        let stored = chunk.get(usize::try_from(entry.start).ok()?..)?;
        let (bytes, rest) = stored.split_at_checked(usize::from(entry.length))?;
        let reason = rest.get(..usize::from(entry.reason_length))?;
        Some(FrameRef {
            seq,
            at: Timestamp::from_nanosecond(i128::from(entry.at)).unwrap_or_default(),
            direction: entry.direction,
            bytes,
            protocol: entry.protocol,
            settings: LineSettings {
                baud_rate: BaudRate::ALL.get(usize::from(entry.baud_rate)).copied().unwrap_or_default(),
                data_format: entry.data_format,
            },
            address: entry.address,
            checksum: entry.checksum,
            took: Duration::from_micros(entry.took_microseconds.into()),
            first_byte: (entry.first_byte_microseconds != u32::MAX)
                .then(|| Duration::from_micros(entry.first_byte_microseconds.into())),
            echo: entry.echo,
            noise: entry.noise,
            outcome: match entry.outcome {
                Kind::Request => Outcome::Request,
                Kind::Answer => Outcome::Answer,
                Kind::Refusal => Outcome::Refusal,
                Kind::Broken => Outcome::Broken(std::str::from_utf8(reason).unwrap_or_default()),
                Kind::Silent => Outcome::Silent,
            },
        })
    }

    /// All frames kept, oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = FrameRef<'_>> {
        (self.first_seq..self.next_seq()).filter_map(|seq| self.get(seq))
    }

    /// The request that the received frame `seq` answers: the frame before it, unless one of the two that belong together
    /// did not reach the log.
    pub fn request_of(&self, seq: u64) -> Option<FrameRef<'_>> {
        let answer = self.get(seq).filter(|frame| frame.direction == Direction::Received)?;
        let request = self.get(seq.checked_sub(1)?).filter(|frame| frame.direction == Direction::Sent)?;
        let belongs = (request.address, request.protocol) == (answer.address, answer.protocol);
        let since = Duration::try_from(answer.at.duration_since(request.at)).ok()?;
        let in_time = since.abs_diff(request.took.saturating_add(answer.took)) <= TOLERANCE;
        (belongs && in_time).then_some(request)
    }

    /// Forgets all frames; sequence numbers go on.
    pub fn clear(&mut self) {
        self.first_seq = self.next_seq();
        self.entries.clear();
        self.first_chunk = self.first_chunk.saturating_add(u32::try_from(self.chunks.len()).unwrap_or_default());
        self.chunks.clear();
    }

    /// Room taken in memory, in bytes.
    pub fn footprint(&self) -> usize {
        let chunks: usize = self.chunks.iter().map(Vec::capacity).sum();
        chunks.saturating_add(self.entries.capacity().saturating_mul(size_of::<Entry>()))
    }

    /// Puts the bytes of a frame into one chunk and tells which, and where in it.
    fn store(&mut self, bytes: &[u8], reason: &[u8]) -> (u32, usize) {
        let needed = bytes.len().saturating_add(reason.len());
        if self.chunks.back().is_none_or(|chunk| chunk.len().saturating_add(needed) > CHUNK) {
            while self.chunks.len() >= self.most_chunks && !self.entries.is_empty() {
                self.forget_first();
            }
            self.drop_unused_chunks();
            self.chunks.push_back(Vec::with_capacity(CHUNK));
        }
        let last = u32::try_from(self.chunks.len().saturating_sub(1)).unwrap_or_default();
        let start = self.chunks.back().map_or(0, Vec::len);
        if let Some(chunk) = self.chunks.back_mut() {
            chunk.extend_from_slice(bytes);
            chunk.extend_from_slice(reason);
        }
        (self.first_chunk.saturating_add(last), start)
    }

    fn forget_first(&mut self) {
        if self.entries.pop_front().is_some() {
            self.first_seq = self.first_seq.saturating_add(1);
        }
        self.drop_unused_chunks();
    }

    /// Chunks before that of the oldest frame; the last one stays, to be filled.
    fn drop_unused_chunks(&mut self) {
        while self.chunks.len() > 1 && self.entries.front().is_none_or(|entry| entry.chunk > self.first_chunk) {
            self.chunks.pop_front();
            self.first_chunk = self.first_chunk.saturating_add(1);
        }
        if self.entries.is_empty() && self.chunks.len() >= self.most_chunks {
            self.first_chunk = self.first_chunk.saturating_add(u32::try_from(self.chunks.len()).unwrap_or_default());
            self.chunks.clear();
        }
    }
}

fn clipped(bytes: &[u8]) -> &[u8] {
    bytes.get(..usize::from(u16::MAX)).unwrap_or(bytes)
}
