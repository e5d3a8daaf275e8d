//! Module addresses as people write them.

/// One address, 0 to 255: decimal, or hexadecimal as `0xA0` or `A0h`.
pub fn parse_address(text: &str) -> Result<u8, String> {
    let text = text.trim();
    let prefixed = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let hexadecimal = prefixed.or_else(|| text.strip_suffix(['h', 'H']));
    let plain = hexadecimal.unwrap_or(text);
    let digits_only = !plain.is_empty() && plain.chars().all(|digit| digit.is_ascii_hexdigit());
    let number = if hexadecimal.is_some() { u8::from_str_radix(plain, 16).ok() } else { plain.parse().ok() };
    number
        .filter(|_| digits_only)
        .ok_or_else(|| format!("\"{text}\" is not an address: use 0 to 255 in decimal, or hexadecimal as 0xA0 or A0h"))
}

/// Addresses and ranges of them, `1,160-191`; each once, in the order given.
pub fn parse_addresses(text: &str) -> Result<Vec<u8>, String> {
    let mut addresses = Vec::new();
    for part in text.split([',', ';']) {
        let (first, last) = part.split_once(['-', '–']).unwrap_or((part, part));
        let (first, last) = (parse_address(first)?, parse_address(last)?);
        if first > last {
            return Err(format!("\"{}\" is an empty range: write the lower address first", part.trim()));
        }
        addresses.extend((first..=last).filter(|address| !addresses.contains(address)).collect::<Vec<_>>());
    }
    Ok(addresses)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn addresses_are_decimal_or_marked_as_hexadecimal() {
        for (text, number) in [("1", 1), ("160", 160), ("0xA0", 160), ("0Xa0", 160), ("A0h", 160), ("0FFH", 255)] {
            assert_eq!(parse_address(text), Ok(number), "{text}");
        }
        for text in ["", "A0", "256", "-1", "+1", "0x", "h", "0x+1", "1.0"] {
            assert!(parse_address(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lists_of_addresses_hold_each_once() {
        assert_eq!(parse_addresses("1, 0xA0-A2h,161"), Ok(vec![1, 160, 161, 162]));
        assert_eq!(parse_addresses("0-255").map(|all| all.len()), Ok(256));
        assert!(parse_addresses("191-160").unwrap_err().contains("empty range"));
        assert!(parse_addresses("1,,2").is_err());
        assert!(parse_addresses(" ").is_err());
    }

    proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = parse_addresses(&text);
        }
    }
}
