//! RTU frames: the check at their end.

/// The register before the first byte.
pub(crate) const CRC_START: u16 = 0xFFFF;

/// CRC-16 of Modbus over serial line 1.02, appendix B: polynomial 0xA001 reflected, all ones at first.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(CRC_START, |crc, &byte| crc_with(crc, byte))
}

/// The register after one more byte.
pub(crate) fn crc_with(crc: u16, byte: u8) -> u16 {
    (0..8).fold(crc ^ u16::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xA001 } else { crc >> 1 })
}

/// Address and request, if the frame's check is right.
pub(crate) fn checked(frame: &[u8]) -> Option<&[u8]> {
    let (content, check) = frame.split_at_checked(frame.len().checked_sub(2)?)?;
    // An address and a function at least.
    (content.len() >= 2 && check == crc(content).to_le_bytes()).then_some(content)
}

/// `content` with its check.
pub(crate) fn sealed(mut content: Vec<u8>) -> Vec<u8> {
    let check = crc(&content).to_le_bytes();
    content.extend(check);
    content
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_frames_pass_the_check() {
        for frame in [
            &[0x01, 0x04, 0x00, 0x00, 0x00, 0x05, 0x30, 0x09][..],
            &[0xA0, 0x03, 0x01, 0xE0, 0x00, 0x04, 0x5D, 0x72],
            &[0x01, 0x46, 0x20, 0x13, 0xB8],
            &[0x01, 0xC6, 0x02, 0xF2, 0x61],
        ] {
            let content = &frame[..frame.len() - 2];
            assert_eq!(checked(frame), Some(content));
            assert_eq!(sealed(content.to_vec()), frame);
        }
        assert_eq!(checked(&[0x01, 0x46, 0x20, 0x13, 0xB9]), None);
        assert_eq!(checked(&[0xFF, 0xFF]), None);
        assert_eq!(checked(&[]), None);
    }
}
