//! Where a request ends in a stream of bytes that may be DCON or Modbus RTU.

use super::super::modbus;

/// How many bytes at the start of `heard` are one whole request. What never becomes one ends with a silence.
pub(super) fn complete(heard: &[u8]) -> Option<usize> {
    let sound = |&length: &usize| heard.get(..length).is_some_and(|frame| modbus::checked(frame).is_some());
    modbus_length(heard).filter(sound).or_else(|| dcon_length(heard))
}

/// A command begins with one of five characters and ends with CR (PIR-234 manual 5.1).
fn dcon_length(heard: &[u8]) -> Option<usize> {
    let end = heard.iter().position(|&byte| byte == b'\r')?;
    let text = heard.get(..end)?;
    let begins = matches!(text.first(), Some(b'$' | b'#' | b'%' | b'@' | b'~'));
    (begins && text.iter().all(u8::is_ascii_graphic)).then_some(end + 1)
}

/// Bytes of the whole Modbus RTU request that begins like this, once that can be told; functions that no module has
/// are unknown.
fn modbus_length(start: &[u8]) -> Option<usize> {
    match start.get(1)? {
        1..=6 => Some(8),
        15 | 16 => Some(9 + usize::from(*start.get(6)?)),
        0x46 => match start.get(2)? {
            0x00 | 0x20 => Some(5),
            0x04 => Some(9),
            0x05 => Some(6),
            0x06 => Some(13),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_of_a_modbus_request_follows_from_its_beginning() {
        for (start, length) in [
            (&[1, 3][..], Some(8)),
            (&[1], None),
            (&[1, 16, 0, 0, 0, 2], None),
            (&[1, 16, 0, 0, 0, 2, 4], Some(13)),
            (&[1, 0x46, 6], Some(13)),
            (&[1, 0x46, 9], None),
            (&[1, 0x2B], None),
        ] {
            assert_eq!(modbus_length(start), length, "{start:?}");
        }
    }

    #[test]
    fn a_request_is_complete_with_its_check_or_its_carriage_return() {
        for (heard, length) in [
            (&b"$01M\r$02M\r"[..], Some(5)),
            (b"$F0M\r", Some(5)),
            (b"$01M", None),
            (b"01M\r", None),
            (&[0x01, 0x46, 0x20, 0x13, 0xB8, 0x01], Some(5)),
            (&[0x01, 0x46, 0x20, 0x13, 0xB9], None),
            (&[], None),
        ] {
            assert_eq!(complete(heard), length, "{heard:?}");
        }
    }

    #[test]
    fn a_modbus_address_that_looks_like_dcon_does_not_end_at_a_carriage_return() {
        // Address 0x24 is "$"; the register is 13.
        let request = [0x24, 0x03, 0x00, 0x0D, 0x00, 0x01];
        assert_eq!(complete(&request), None);
    }
}
