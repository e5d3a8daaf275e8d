//! What is known of a frame beside its bytes, in words that people read and that are read again:
//! `answer; Modbus RTU; 9600 N81; address 1; took 12.345 ms; first byte 5.210 ms; echo`.

use std::fmt::Write;
use std::time::Duration;

use jiff::Timestamp;

use crate::bus::{Direction, Frame, Verdict};
use crate::protocol::{LineSettings, Protocol};

/// Between two of the words.
const SEPARATOR: &str = "; ";
/// What is wrong; it comes last, because it may contain anything.
const REASON: &str = "reason: ";
const CHECKSUM: &str = "checksum";
const ECHO: &str = "echo";
const NOISE: &str = "noise";
/// Bytes of a reason that are kept.
const MOST_REASON: usize = 4_000;
const NANOSECONDS_PER_MILLISECOND: u128 = 1_000_000;

/// A frame without its bytes, its time and its direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Details {
    pub protocol: Protocol,
    pub settings: LineSettings,
    pub address: Option<u8>,
    pub checksum: bool,
    pub took: Duration,
    pub first_byte: Option<Duration>,
    pub echo: bool,
    pub noise: bool,
    pub verdict: Verdict,
}

impl Details {
    /// Of a frame of which nothing else is known.
    pub fn bare(protocol: Protocol, verdict: Verdict) -> Self {
        Self {
            protocol,
            settings: LineSettings::default(),
            address: None,
            checksum: false,
            took: Duration::ZERO,
            first_byte: None,
            echo: false,
            noise: false,
            verdict,
        }
    }

    pub fn into_frame(self, at: Timestamp, direction: Direction, bytes: Vec<u8>) -> Frame {
        let Self { protocol, settings, address, checksum, took, first_byte, echo, noise, verdict } = self;
        Frame { at, direction, bytes, protocol, settings, address, checksum, took, first_byte, echo, noise, verdict }
    }
}

/// `notes` stand before the reason; they must not contain the separator.
pub(super) fn write(frame: &Frame, notes: &[String]) -> String {
    let mut words = vec![verdict_word(&frame.verdict).to_owned(), frame.protocol.label().to_owned()];
    // Without meaning over TCP.
    if frame.protocol != Protocol::ModbusTcp || frame.settings != LineSettings::default() {
        words.push(frame.settings.to_string());
    }
    words.extend(frame.address.map(|address| format!("address {address}")));
    words.extend(frame.checksum.then(|| CHECKSUM.to_owned()));
    words.push(format!("took {}", milliseconds(frame.took)));
    words.extend(frame.first_byte.map(|time| format!("first byte {}", milliseconds(time))));
    words.extend(frame.echo.then(|| ECHO.to_owned()));
    words.extend(frame.noise.then(|| NOISE.to_owned()));
    words.extend(notes.iter().cloned());
    if let Verdict::Broken(reason) = &frame.verdict {
        words.push(format!("{REASON}{}", escaped(reason)));
    }
    words.join(SEPARATOR)
}

/// `None` if these are not the words of a frame. Words that are not known are passed over.
pub(super) fn read(text: &str) -> Option<Details> {
    let (known, reason) = match text.split_once(&format!("{SEPARATOR}{REASON}")) {
        Some((known, reason)) => (known, unescaped(reason)),
        None => (text, String::new()),
    };
    let mut words = known.split(SEPARATOR);
    let verdict = match words.next()? {
        "broken" => Verdict::Broken(reason),
        "request" => Verdict::Request,
        "answer" => Verdict::Answer,
        "refusal" => Verdict::Refusal,
        "silent" => Verdict::Silent,
        _ => return None,
    };
    let label = words.next()?;
    let protocol = Protocol::ALL.into_iter().find(|protocol| protocol.label() == label)?;
    let mut details = Details::bare(protocol, verdict);
    for word in words {
        match word {
            CHECKSUM => details.checksum = true,
            ECHO => details.echo = true,
            NOISE => details.noise = true,
            word => measured(word, &mut details)?,
        }
    }
    Some(details)
}

/// Takes in a word with a number; `None` if the number makes no sense.
fn measured(word: &str, details: &mut Details) -> Option<()> {
    if let Some(address) = word.strip_prefix("address ") {
        details.address = Some(address.parse().ok()?);
    } else if let Some(time) = word.strip_prefix("took ") {
        details.took = duration(time)?;
    } else if let Some(time) = word.strip_prefix("first byte ") {
        details.first_byte = Some(duration(time)?);
    } else if let Some((rate, format)) = word.split_once(' ')
        && let (Ok(baud_rate), Ok(data_format)) = (rate.parse(), format.parse())
    {
        details.settings = LineSettings { baud_rate, data_format };
    }
    Some(())
}

fn verdict_word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Request => "request",
        Verdict::Answer => "answer",
        Verdict::Refusal => "refusal",
        Verdict::Broken(_) => "broken",
        Verdict::Silent => "silent",
    }
}

/// `12.345 ms`, to a nanosecond where that is needed.
fn milliseconds(time: Duration) -> String {
    let nanoseconds = time.as_nanos();
    let (whole, part) = (nanoseconds / NANOSECONDS_PER_MILLISECOND, nanoseconds % NANOSECONDS_PER_MILLISECOND);
    match part % 1_000 {
        0 => format!("{whole}.{:03} ms", part / 1_000),
        _ => format!("{whole}.{part:06} ms"),
    }
}

fn duration(text: &str) -> Option<Duration> {
    let (whole, part) = text.strip_suffix(" ms")?.split_once('.')?;
    if part.len() > 6 || !part.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let part: u128 = format!("{part:0<6}").parse().ok()?;
    let nanoseconds = whole.parse::<u128>().ok()?.checked_mul(NANOSECONDS_PER_MILLISECOND)?.checked_add(part)?;
    let seconds = u64::try_from(nanoseconds / 1_000_000_000).ok()?;
    Some(Duration::new(seconds, u32::try_from(nanoseconds % 1_000_000_000).ok()?))
}

/// Without line ends and other controls.
fn escaped(reason: &str) -> String {
    let mut text = String::with_capacity(reason.len());
    for character in reason.get(..reason.floor_char_boundary(MOST_REASON)).unwrap_or_default().chars() {
        match character {
            '\\' => text.push_str("\\\\"),
            control if control.is_control() || matches!(control, '\u{2028}' | '\u{2029}') => {
                let _ = write!(text, "\\u{{{:x}}}", u32::from(control));
            }
            other => text.push(other),
        }
    }
    text
}

fn unescaped(text: &str) -> String {
    let mut reason = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        reason.push_str(before);
        let (character, left) = escape(after).unwrap_or(('\\', after));
        reason.push(character);
        rest = left;
    }
    reason.push_str(rest);
    reason
}

/// The character that an escape stands for, and what follows; `text` begins after the backslash.
fn escape(text: &str) -> Option<(char, &str)> {
    if let Some(rest) = text.strip_prefix('\\') {
        return Some(('\\', rest));
    }
    let (digits, rest) = text.strip_prefix("u{")?.split_once('}')?;
    Some((char::from_u32(u32::from_str_radix(digits, 16).ok()?)?, rest))
}
