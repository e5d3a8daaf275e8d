//! DCON as a module hears it (PIR-234 manual 5, PIR-130 manual 2): frames, checksum, and whose turn it is.

mod common;
mod pir130;
mod pir234;
mod words;

use super::device::Device;
use super::refusal::Refusal;
use super::spec::Model;

/// What a module makes of a command: nothing if the syntax is wrong, else an answer or a refusal.
type Outcome = Option<Result<Reply, Refusal>>;

/// An answer without its address, checksum and end.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Reply {
    /// `!AA` and this.
    Addressed(String),
    /// This alone: the manuals print some answers without the address.
    Bare(String),
}

/// An answer with data after `!AA`.
fn data(text: impl Into<String>) -> Outcome {
    Some(Ok(Reply::Addressed(text.into())))
}

/// The answer to a setting that was accepted or not.
fn done(result: Result<(), Refusal>) -> Outcome {
    Some(result.map(|()| Reply::Addressed(String::new())))
}

/// The answer to a question about channel 0: `C0` is all that follows, and other channels do not exist.
fn read(channel: &str, value: String) -> Outcome {
    Some(words::of_channel(channel, &[0])?.map(|_| Reply::Addressed(value)))
}

/// The whole answer to a whole frame.
pub(super) fn hear(device: &mut Device, frame: &[u8]) -> Option<Vec<u8>> {
    let checksum = device.comms.in_force().checksum;
    let mut text = body(frame, checksum)?.chars();
    let delimiter = text.next()?;
    let text = text.as_str();
    if text == "**" {
        if delimiter == '~' {
            device.watchdog.feed(device.now());
        }
        return None;
    }
    let (address, command) = text.split_at_checked(2)?;
    if words::hex(address, 2)? != u16::from(device.comms.address()) {
        return None;
    }
    let outcome = match device.model {
        Model::Pir130 => pir130::execute(device, delimiter, command),
        Model::Pir230 | Model::Pir234 | Model::Pir234Wf => pir234::execute(device, delimiter, command),
        Model::Unknown => stranger(delimiter, command),
    }?;
    // Read only now: after `%` the answer carries the new address.
    let address = device.comms.address();
    let answer = match outcome {
        Ok(Reply::Addressed(data)) => format!("!{address:02X}{data}"),
        Ok(Reply::Bare(text)) => text,
        Err(Refusal::Tripped) => "!".to_owned(),
        Err(_) => format!("?{address:02X}"),
    };
    Some(framed(&answer, checksum))
}

/// A module of another family, of which only the name is known.
fn stranger(delimiter: char, command: &str) -> Outcome {
    if (delimiter, command) == ('$', "M") { data("7065") } else { None }
}

/// What stands between the start of a frame and its checksum, if that is right.
fn body(frame: &[u8], checksum: bool) -> Option<&str> {
    let text = std::str::from_utf8(frame.strip_suffix(b"\r")?).ok()?;
    let text = if checksum {
        let (text, digits) = text.split_at_checked(text.len().checked_sub(2)?)?;
        (words::hex(digits, 2)? == u16::from(sum(text))).then_some(text)?
    } else {
        text
    };
    text.bytes().all(|byte| byte.is_ascii_graphic()).then_some(text)
}

fn framed(text: &str, checksum: bool) -> Vec<u8> {
    if checksum { format!("{text}{:02X}\r", sum(text)) } else { format!("{text}\r") }.into_bytes()
}

/// Sum of the character codes modulo 256.
pub(super) fn sum(text: impl AsRef<[u8]>) -> u8 {
    text.as_ref().iter().fold(0, |sum, &byte| sum.wrapping_add(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_sum_of_the_character_codes() {
        for (text, checksum) in [("$012", 0xB7), ("!01200600", 0xAA), ("!02PIR130", 0x02), ("~**", 0xD2)] {
            assert_eq!(sum(text), checksum, "{text}");
        }
    }

    #[test]
    fn a_frame_needs_its_end_and_the_right_checksum() {
        assert_eq!(body(b"$012B7\r", true), Some("$012"));
        assert_eq!(body(b"$012\r", false), Some("$012"));
        for (frame, checksum) in [
            (&b"$012B8\r"[..], true),
            (b"$012b7\r", true),
            (b"\r", true),
            (b"$012", false),
            (b"$0\x9c\r", false),
            (b"$\r12\r", false),
        ] {
            assert_eq!(body(frame, checksum), None, "{frame:?}");
        }
    }
}
