//! Which frames a reader could find in bytes. Damage that happens to leave a checksum or CRC right is no fault that any
//! reader could notice, so it is drawn anew.

use super::super::{dcon, modbus};

/// A function code and the CRC at least stand behind an address (Modbus over serial line 1.02, 2.3).
const SHORTEST_RTU: usize = 4;
/// What begins commands and answers (PIR-234 manual 5.1).
const DELIMITERS: &[u8] = b"!?>$#%@~";

/// How right frames can be told from wrong ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::sim) enum Code {
    /// Modbus RTU from or to the module at this address.
    Rtu(u8),
    /// DCON with checksum.
    Summed,
    /// DCON without checksum: nothing tells them apart.
    Open,
}

impl Code {
    /// What a frame that was sent undamaged is.
    pub fn of(frame: &[u8]) -> Self {
        match frame.first() {
            Some(&address) if modbus::checked(frame).is_some() => Self::Rtu(address),
            Some(_) if is_summed(frame) => Self::Summed,
            _ => Self::Open,
        }
    }

    /// Every stretch of `bytes` that passes for a frame.
    pub fn frames(self, bytes: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Rtu(address) => starts(bytes, |byte| byte == address).flat_map(rtu_frames).collect(),
            Self::Summed => starts(bytes, |byte| DELIMITERS.contains(&byte)).filter_map(summed_frame).collect(),
            Self::Open => Vec::new(),
        }
    }

    /// Whether a reader could find a frame in `bytes` that is none of `sent`.
    pub fn misleads(self, bytes: &[u8], sent: &[Vec<u8>]) -> bool {
        self.frames(bytes).into_iter().any(|frame| !sent.iter().any(|sent| sent == frame))
    }
}

fn starts(bytes: &[u8], begins: impl Fn(u8) -> bool) -> impl Iterator<Item = &[u8]> {
    let tails = (0..bytes.len()).filter_map(|start| bytes.get(start..));
    tails.filter(move |tail| tail.first().is_some_and(|&byte| begins(byte)))
}

/// The register of a CRC is 0 after a frame that has the right one.
fn rtu_frames(tail: &[u8]) -> impl Iterator<Item = &[u8]> {
    let after_each = tail.iter().scan(modbus::CRC_START, |crc, &byte| {
        *crc = modbus::crc_with(*crc, byte);
        Some(*crc)
    });
    let sound = after_each.zip(1_usize..).filter(|&(crc, length)| crc == 0 && length >= SHORTEST_RTU);
    sound.filter_map(|(_, length)| tail.get(..length))
}

/// What ends with the next carriage return.
fn summed_frame(tail: &[u8]) -> Option<&[u8]> {
    let end = tail.iter().position(|&byte| byte == b'\r')?;
    let frame = tail.get(..=end)?;
    is_summed(frame).then_some(frame)
}

/// Generous: a reader may take small letters for digits, or overlook blanks.
fn is_summed(frame: &[u8]) -> bool {
    let Some(text) = frame.strip_suffix(b"\r").map(<[u8]>::trim_ascii_end) else { return false };
    let Some((text, digits)) = text.len().checked_sub(2).and_then(|end| text.split_at_checked(end)) else {
        return false;
    };
    let found = std::str::from_utf8(digits).ok().and_then(|digits| u8::from_str_radix(digits, 16).ok());
    text.first().is_some_and(|byte| DELIMITERS.contains(byte)) && found == Some(dcon::sum(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    const READ: &[u8] = &[0x01, 0x04, 0x00, 0x00, 0x00, 0x05, 0x30, 0x09];

    #[test]
    fn a_frame_says_what_checks_it() {
        assert_eq!(Code::of(READ), Code::Rtu(1));
        assert_eq!(Code::of(b"$012B7\r"), Code::Summed);
        for frame in [&b"$012\r"[..], b"$012B8\r", b"\r", b"", b"B7\r", &READ[1..]] {
            assert_eq!(Code::of(frame), Code::Open, "{frame:?}");
        }
    }

    #[test]
    fn frames_are_found_wherever_they_begin_and_end() {
        let bytes = [&[0, 1, 1], READ, &[0xFF]].concat();
        assert_eq!(Code::Rtu(1).frames(&bytes), [READ]);
        assert!(Code::Rtu(2).frames(&bytes).is_empty());
        assert_eq!(Code::Summed.frames(b"!0!$012B7\r!01\r"), [b"$012B7\r"]);
        assert!(Code::Open.frames(b"$012B7\r").is_empty());
    }

    #[test]
    fn zeros_behind_a_frame_make_a_longer_one_with_a_right_crc() {
        let longer = [READ, &[0, 0]].concat();
        assert!(modbus::checked(&longer).is_some());
        assert!(Code::Rtu(1).misleads(&longer, &[READ.to_vec()]));
        let between = [READ, &[0]].concat();
        assert!(!Code::Rtu(1).misleads(&longer, &[READ.to_vec(), between, longer.clone()]));
    }
}
