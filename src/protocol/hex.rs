//! Bytes as text: spaced hexadecimal for binary frames, escaped ASCII for DCON.

use std::fmt::Write;

/// `01 03 0A`: two capital digits a byte, one space between.
pub fn spaced(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len() * 3);
    for (i, byte) in bytes.iter().enumerate() {
        let separator = if i == 0 { "" } else { " " };
        let _ = write!(text, "{separator}{byte:02X}");
    }
    text
}

/// Printable ASCII as it is, everything else as `\r`, `\n` or `\x..`.
pub fn escaped(bytes: &[u8]) -> String {
    bytes.escape_ascii().to_string()
}

/// Reads hexadecimal bytes, with or without spaces: `01 03` or `0103`.
pub fn parse(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    for word in text.split_whitespace() {
        let digits = word.strip_prefix("0x").unwrap_or(word);
        if digits.is_empty() || digits.len() % 2 != 0 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(format!("\"{word}\" is not a sequence of hexadecimal bytes such as 01 03"));
        }
        for pair in digits.as_bytes().chunks(2) {
            let value = pair.iter().fold(0u8, |value, &digit| (value << 4) | digit_value(digit));
            bytes.push(value);
        }
    }
    Ok(bytes)
}

fn digit_value(digit: u8) -> u8 {
    (digit as char).to_digit(16).and_then(|value| u8::try_from(value).ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn spaced_bytes_read_back(bytes: Vec<u8>) {
            prop_assert_eq!(parse(&spaced(&bytes)), Ok(bytes));
        }

        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = parse(&text);
        }
    }

    #[test]
    fn half_a_byte_is_refused() {
        assert!(parse("01 3").unwrap_err().contains("\"3\""));
    }
}
