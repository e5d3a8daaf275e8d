//! The digits of DCON: upper-case hexadecimal and signed decimals with two places.

use super::super::climate::Hundredths;
use super::super::refusal::Refusal;

/// Exactly `digits` (at most 4) upper-case hexadecimal digits.
pub(super) fn hex(text: &str, digits: usize) -> Option<u16> {
    let upper = |byte: u8| byte.is_ascii_digit() || (b'A'..=b'F').contains(&byte);
    if text.len() == digits && text.bytes().all(upper) { u16::from_str_radix(text, 16).ok() } else { None }
}

/// `+ddd.dd` in hundredths. More digits before the point are understood but refused (`@01HI+1000.00` in PIR-234
/// manual 5.32); all else is no number.
pub(super) fn signed(text: &str) -> Option<Result<Hundredths, Refusal>> {
    let (sign, digits) = text.split_at_checked(1)?;
    let sign = match sign {
        "+" => 1,
        "-" => -1,
        _ => return None,
    };
    let (whole, fraction) = digits.split_once('.')?;
    let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.len() < 3 || fraction.len() != 2 || !all_digits(whole) || !all_digits(fraction) {
        return None;
    }
    if whole.len() > 3 {
        return Some(Err(Refusal::Value));
    }
    let (whole, fraction): (Hundredths, Hundredths) = (whole.parse().ok()?, fraction.parse().ok()?);
    Some(Ok(sign * (whole * 100 + fraction)))
}

/// Hundredths as `+ddd.dd`.
pub(super) fn decimal(value: Hundredths) -> String {
    let sign = if value < 0 { '-' } else { '+' };
    let magnitude = value.unsigned_abs();
    format!("{sign}{:03}.{:02}", magnitude / 100, magnitude % 100)
}

/// The letter and the rest of `LC...`, the PIR arguments.
pub(super) fn argument(command: &str) -> Option<(char, &str)> {
    let mut letters = command.strip_prefix("LC")?.chars();
    Some((letters.next()?, letters.as_str()))
}

/// The value after `C0` in as many digits as one of `lengths` says (0 digits read as 0). Other channels do not exist
/// and are refused.
pub(super) fn of_channel(text: &str, lengths: &[usize]) -> Option<Result<u16, Refusal>> {
    let (channel, digits) = text.strip_prefix('C')?.split_at_checked(1)?;
    let channel = hex(channel, 1)?;
    let length = lengths.iter().copied().find(|&length| length == digits.len())?;
    let value = if length == 0 { 0 } else { hex(digits, length)? };
    Some(if channel == 0 { Ok(value) } else { Err(Refusal::Value) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_is_upper_case_and_of_the_right_length() {
        assert_eq!(hex("0BB8", 4), Some(3000));
        for text in ["0bb8", "BB8", "+BB8", "00BB8", ""] {
            assert_eq!(hex(text, 4), None, "{text}");
        }
    }

    #[test]
    fn decimals_have_a_sign_three_digits_and_two_places() {
        for (text, value) in [("+086.00", 8600), ("-100.00", -10000), ("-000.05", -5), ("+999.99", 99999)] {
            assert_eq!(signed(text), Some(Ok(value)));
            assert_eq!(decimal(value), text);
        }
        assert_eq!(signed("+1000.00"), Some(Err(Refusal::Value)));
        for text in ["086.00", "+86.00", "+086.0", "+086", "+0-6.00", "", "°"] {
            assert_eq!(signed(text), None, "{text}");
        }
    }

    #[test]
    fn only_channel_zero_exists() {
        assert_eq!(of_channel("C003", &[2]), Some(Ok(3)));
        assert_eq!(of_channel("C03", &[1, 2]), Some(Ok(3)));
        assert_eq!(of_channel("C0", &[0]), Some(Ok(0)));
        assert_eq!(of_channel("C103", &[2]), Some(Err(Refusal::Value)));
        for text in ["", "C", "C0Z", "003", "Cg03"] {
            assert_eq!(of_channel(text, &[2]), None, "{text}");
        }
    }
}
