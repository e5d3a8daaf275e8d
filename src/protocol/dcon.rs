//! The DCON frame: delimiter, address, text, optional checksum, carriage return
//! (PIR-130 manual chapter 2, PIR-234 manual 5.1).
//!
//! This layer knows frames only. What the text of an answer means stands in the module definitions.

/// Ends every frame.
pub const CR: u8 = b'\r';

/// First characters of what a host sends. An answer never starts with one of them, so an echo is recognisable.
pub const COMMAND_DELIMITERS: &[u8] = b"$#%@~";

/// First characters of what a module sends.
pub const ANSWER_DELIMITERS: &[u8] = b"!>?";

/// A frame that is not a DCON answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    #[error("the answer is empty")]
    Empty,
    #[error("the answer starts with 0x{0:02X} instead of !, > or ?")]
    Delimiter(u8),
    #[error("the answer contains 0x{0:02X}, which is not a printable character")]
    NotText(u8),
    #[error("the answer is too short to carry a checksum")]
    ChecksumMissing,
    #[error("wrong checksum: {found} was received, {expected} is right")]
    Checksum { found: String, expected: String },
}

/// What a module said, checksum verified and taken off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// `!…` or `>…`: the text behind the delimiter, with the address where the command's answer has one.
    Valid { delimiter: char, text: String },
    /// `?AA`: understood and refused; the text behind the `?`.
    Refused { text: String },
    /// A lone `!`: an output command ignored because the host watchdog has tripped.
    Ignored,
}

impl Answer {
    /// The frame's text as it was received, delimiter first, without checksum.
    pub fn to_text(&self) -> String {
        match self {
            Self::Valid { delimiter, text } => format!("{delimiter}{text}"),
            Self::Refused { text } => format!("?{text}"),
            Self::Ignored => "!".to_owned(),
        }
    }
}

/// Sum of all characters modulo 256.
pub fn checksum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum, &byte| sum.wrapping_add(byte))
}

/// The bytes of a command: `text`, its checksum where asked for, and the carriage return.
pub fn encode(text: &str, with_checksum: bool) -> Vec<u8> {
    let mut frame = text.as_bytes().to_vec();
    if with_checksum {
        frame.extend(format!("{:02X}", checksum(text.as_bytes())).into_bytes());
    }
    frame.push(CR);
    frame
}

/// Reads one answer; CR and LF around it are tolerated, other control characters are noise wherever they stand.
pub fn decode(frame: &[u8], with_checksum: bool) -> Result<Answer, FrameError> {
    let frame = without_line_ends(frame);
    let Some(&delimiter) = frame.first() else { return Err(FrameError::Empty) };
    if !ANSWER_DELIMITERS.contains(&delimiter) {
        return Err(FrameError::Delimiter(delimiter));
    }
    if let Some(&byte) = frame.iter().find(|byte| !(b' '..=b'~').contains(*byte)) {
        return Err(FrameError::NotText(byte));
    }
    let frame = if with_checksum { strip_checksum(frame)? } else { frame };
    let text: String = frame.iter().skip(1).map(|&byte| char::from(byte)).collect();
    Ok(match delimiter {
        b'?' => Answer::Refused { text },
        b'!' if text.is_empty() => Answer::Ignored,
        _ => Answer::Valid { delimiter: char::from(delimiter), text },
    })
}

fn without_line_ends(mut frame: &[u8]) -> &[u8] {
    while let Some((&(CR | b'\n'), rest)) = frame.split_first() {
        frame = rest;
    }
    while let Some((&(CR | b'\n'), rest)) = frame.split_last() {
        frame = rest;
    }
    frame
}

fn strip_checksum(frame: &[u8]) -> Result<&[u8], FrameError> {
    let (text, found) =
        frame.len().checked_sub(2).and_then(|at| frame.split_at_checked(at)).ok_or(FrameError::ChecksumMissing)?;
    if text.is_empty() {
        return Err(FrameError::ChecksumMissing);
    }
    let expected = format!("{:02X}", checksum(text));
    if found == expected.as_bytes() {
        Ok(text)
    } else {
        Err(FrameError::Checksum { found: String::from_utf8_lossy(found).into_owned(), expected })
    }
}

/// Where the first answer stands among `received` bytes: from its delimiter up to, not including, its CR.
/// Stray bytes before the delimiter (line noise, line feeds) are passed over; `None` until a CR has come.
pub fn find_answer(received: &[u8]) -> Option<std::ops::Range<usize>> {
    let start = received.iter().position(|byte| ANSWER_DELIMITERS.contains(byte))?;
    let length = received.get(start..)?.iter().position(|&byte| byte == CR)?;
    Some(start..start.saturating_add(length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_published_checksum_is_reproduced() {
        let vectors = include_str!("../../tests/vectors/dcon-checksum.csv");
        let rows: Vec<_> = vectors.lines().skip(1).filter_map(|row| row.split_once(',')).collect();
        assert!(rows.len() > 20);
        for (text, sum) in rows {
            assert_eq!(format!("{:02X}", checksum(text.as_bytes())), sum, "{text}");
            assert_eq!(encode(text, true), format!("{text}{sum}\r").into_bytes());
        }
    }

    #[test]
    fn an_answer_with_its_checksum_is_read_with_the_checksum_taken_off() {
        let answer = decode(b"!02PIR13002\r", true).unwrap();
        assert_eq!(answer, Answer::Valid { delimiter: '!', text: "02PIR130".into() });
    }

    #[test]
    fn a_wrong_checksum_is_named() {
        let error = decode(b"!02PIR13003", true).unwrap_err();
        assert_eq!(error, FrameError::Checksum { found: "03".into(), expected: "02".into() });
    }

    #[test]
    fn refusals_and_ignored_commands_are_told_apart() {
        assert_eq!(decode(b"?01", false), Ok(Answer::Refused { text: "01".into() }));
        assert_eq!(decode(b"!", false), Ok(Answer::Ignored));
        assert_eq!(decode(b"!21\r", true), Ok(Answer::Ignored));
    }

    #[test]
    fn a_stray_control_character_behind_an_answer_is_not_taken_for_its_end() {
        assert_eq!(decode(b"!\x0C\r", false), Err(FrameError::NotText(0x0C)));
        assert_eq!(decode(b"!01\t\r\n", false), Err(FrameError::NotText(b'\t')));
        assert_eq!(decode(b"\n!\r\n", false), Ok(Answer::Ignored));
    }

    #[test]
    fn noise_around_an_answer_is_passed_over() {
        let received = b"\x00\xFF!01PIR234E\r\n";
        let range = find_answer(received).unwrap();
        assert_eq!(&received[range], b"!01PIR234E");
        assert_eq!(find_answer(b"\x00!01PIR"), None);
    }

    proptest! {
        #[test]
        fn what_is_encoded_decodes(text in "[!>][0-9A-Z.+-]{1,40}", with_checksum: bool) {
            let answer = decode(&encode(&text, with_checksum), with_checksum).unwrap();
            prop_assert_eq!(answer.to_text(), text);
        }

        #[test]
        fn no_bytes_make_the_decoder_panic(bytes: Vec<u8>, with_checksum: bool) {
            let _ = decode(&bytes, with_checksum);
            let _ = find_answer(&bytes);
        }
    }
}
