//! Check sums, from their descriptions and not from the program.

/// CRC-16/MODBUS by long division: polynomial 0x8005, bits mirrored, begun with ones.
pub fn crc(bytes: &[u8]) -> [u8; 2] {
    let mut remainder = 0xFFFFu16;
    for byte in bytes {
        for place in 0..8 {
            let bit = (byte >> place) & 1 == 1;
            let out = remainder & 1 == 1;
            remainder >>= 1;
            if bit != out {
                remainder ^= 0x8005u16.reverse_bits();
            }
        }
    }
    remainder.to_le_bytes()
}

/// The two digits that follow a DCON text.
pub fn dcon(text: &[u8]) -> [u8; 2] {
    let sum = text.iter().map(|byte| usize::from(*byte)).sum::<usize>() % 256;
    let digits = b"0123456789ABCDEF";
    [digits[sum / 16], digits[sum % 16]]
}

/// `body` and its CRC.
pub fn with_crc(body: &[u8]) -> Vec<u8> {
    [body, &crc(body)].concat()
}
