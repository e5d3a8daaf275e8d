//! Values as people write and read them.

use std::fmt;

use serde::{Serialize, Serializer};

/// A decimal number with a fixed number of decimals, exact as the module sends it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Fixed {
    /// The number times 10^`decimals`.
    pub raw: i64,
    pub decimals: u8,
}

impl Fixed {
    pub fn new(raw: i64, decimals: u8) -> Self {
        Self { raw, decimals }
    }

    /// Reads `+030.00`, `-5`, `12.5`. Digits beyond `decimals` are refused unless they are zeros.
    pub fn parse(text: &str, decimals: u8) -> Option<Self> {
        let text = text.trim();
        let (negative, digits) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let all_digits = whole.bytes().chain(fraction.bytes()).all(|b| b.is_ascii_digit());
        if !all_digits || (whole.is_empty() && fraction.is_empty()) || whole.len() > 12 {
            return None;
        }
        let places = usize::from(decimals);
        if fraction.len() > places && fraction.bytes().skip(places).any(|digit| digit != b'0') {
            return None;
        }
        let kept: String = fraction.chars().chain(std::iter::repeat('0')).take(places).collect();
        let raw: i64 = format!("0{whole}{kept}").parse().ok()?;
        Some(Self { raw: if negative { raw.checked_neg()? } else { raw }, decimals })
    }

    pub fn to_f64(self) -> f64 {
        self.raw as f64 / 10f64.powi(i32::from(self.decimals))
    }

    /// Nearest number with so many decimals.
    pub fn from_f64(number: f64, decimals: u8) -> Self {
        Self { raw: (number * 10f64.powi(i32::from(decimals))).round() as i64, decimals }
    }

    /// The signed form of DCON data, `+ddd.dd` (PIR-234 manual 5.32).
    pub fn to_dcon(self) -> String {
        let sign = if self.raw < 0 { '-' } else { '+' };
        let scale = 10u64.saturating_pow(u32::from(self.decimals));
        let magnitude = self.raw.unsigned_abs();
        let places = usize::from(self.decimals);
        let (whole, fraction) = (magnitude.checked_div(scale), magnitude.checked_rem(scale));
        format!("{sign}{:03}.{:0places$}", whole.unwrap_or_default(), fraction.unwrap_or_default())
    }
}

impl fmt::Display for Fixed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scale = 10u64.saturating_pow(u32::from(self.decimals));
        let magnitude = self.raw.unsigned_abs();
        let whole = magnitude.checked_div(scale).unwrap_or_default();
        let sign = if self.raw < 0 { "-" } else { "" };
        if self.decimals == 0 {
            return f.pad(&format!("{sign}{whole}"));
        }
        let places = usize::from(self.decimals);
        let fraction = magnitude.checked_rem(scale).unwrap_or_default();
        f.pad(&format!("{sign}{whole}.{fraction:0places$}"))
    }
}

/// What a module sent, or what a user wants it to hold.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Value {
    Bool(bool),
    Number(Fixed),
    /// One of a list, by its word; words that are numbers are numbers in JSON.
    Choice(String),
    Text(String),
}

impl Value {
    /// A number to plot: switches as 0 and 1, words that are numbers as such.
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Bool(on) => Some(f64::from(u8::from(*on))),
            Self::Number(number) => Some(number.to_f64()),
            Self::Choice(word) => word.parse().ok(),
            Self::Text(_) => None,
        }
    }

    pub fn as_bool(&self) -> Option<bool> {
        if let Self::Bool(on) = self { Some(*on) } else { None }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool(on) => f.pad(if *on { "true" } else { "false" }),
            Self::Number(number) => number.fmt(f),
            Self::Choice(text) | Self::Text(text) => f.pad(text),
        }
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Bool(on) => serializer.serialize_bool(*on),
            Self::Number(number) if number.decimals == 0 => serializer.serialize_i64(number.raw),
            Self::Number(number) => serializer.serialize_f64(number.to_f64()),
            Self::Choice(word) => match word.parse::<i64>() {
                Ok(number) => serializer.serialize_i64(number),
                Err(_) => serializer.serialize_str(word),
            },
            Self::Text(text) => serializer.serialize_str(text),
        }
    }
}

/// A value that a parameter cannot take; the message names what it can.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    #[error("{id} cannot be {given}: use {allowed}")]
    NotAllowed { id: String, given: String, allowed: String },
    #[error("{id} can only be read")]
    ReadOnly { id: String },
    #[error("{id} = {given} does not fit: {protocol} carries {allowed}")]
    DoesNotFit { id: String, given: String, protocol: String, allowed: String },
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn dcon_data_is_signed_with_three_digits_before_the_point() {
        assert_eq!(Fixed::new(8600, 2).to_dcon(), "+086.00");
        assert_eq!(Fixed::new(-125, 2).to_dcon(), "-001.25");
    }

    #[test]
    fn small_negative_numbers_keep_their_sign() {
        assert_eq!(Fixed::new(-5, 2).to_string(), "-0.05");
        assert_eq!(Fixed::parse("-0.05", 2), Some(Fixed::new(-5, 2)));
    }

    #[test]
    fn more_decimals_than_the_module_has_are_refused_unless_zero() {
        assert_eq!(Fixed::parse("1.250", 2), Some(Fixed::new(125, 2)));
        assert_eq!(Fixed::parse("1.255", 2), None);
    }

    proptest! {
        #[test]
        fn numbers_read_back_as_written(raw in -1_000_000i64..1_000_000, decimals in 0u8..4) {
            let number = Fixed::new(raw, decimals);
            prop_assert_eq!(Fixed::parse(&number.to_string(), decimals), Some(number));
        }

        #[test]
        fn no_text_makes_the_parser_panic(text: String, decimals: u8) {
            let _ = Fixed::parse(&text, decimals % 20);
        }
    }
}
