//! What an answer is expected to look like: text or bytes with wildcards.

/// One place of a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Exactly(u8),
    /// Any one character or byte.
    One,
    /// Any number of them, none included.
    Any,
}

/// A pattern over the characters or bytes of an answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    places: Vec<Place>,
}

impl Pattern {
    /// Reads `!01PIR*`: `*` stands for any characters, `?` for one. A `?` at the beginning is itself, because so begins
    /// a refusal (`?01`).
    pub fn text(source: &str) -> Result<Self, String> {
        if let Some(strange) = source.chars().find(|character| !(' '..='~').contains(character)) {
            return Err(format!("\"{strange}\" is in no answer – use characters of ASCII, * and ?"));
        }
        let place = |(at, byte): (usize, u8)| match byte {
            b'*' => Place::Any,
            b'?' if at > 0 => Place::One,
            byte => Place::Exactly(byte),
        };
        Ok(Self { places: source.bytes().enumerate().map(place).collect() })
    }

    /// Reads `01 03 0A *`: bytes in hexadecimal digits; `*` stands for any bytes, `??` or `?` for one.
    pub fn bytes(source: &str) -> Result<Self, String> {
        let mut places = Vec::new();
        for word in source.split_whitespace() {
            let characters: Vec<char> = word.chars().collect();
            let mut rest = characters.as_slice();
            while !rest.is_empty() {
                let (place, length) = byte_place(rest).ok_or_else(|| {
                    format!("\"{word}\" is not a sequence of bytes – write two hexadecimal digits each, ?? or *")
                })?;
                places.push(place);
                rest = rest.get(length..).unwrap_or_default();
            }
        }
        Ok(Self { places })
    }

    /// Whether all of `bytes` fits. Takes at most as many steps as the product of both lengths.
    pub fn fits(&self, bytes: &[u8]) -> bool {
        let (mut place, mut at) = (0usize, 0usize);
        // Where the last `*` stands and up to which byte it reaches so far.
        let mut any: Option<(usize, usize)> = None;
        while let Some(byte) = bytes.get(at) {
            match self.places.get(place) {
                Some(Place::Any) => {
                    any = Some((place, at));
                    place = place.saturating_add(1);
                }
                Some(fitting) if *fitting == Place::One || *fitting == Place::Exactly(*byte) => {
                    (place, at) = (place.saturating_add(1), at.saturating_add(1));
                }
                _ => {
                    let Some((star, reached)) = any else { return false };
                    at = reached.saturating_add(1);
                    any = Some((star, at));
                    place = star.saturating_add(1);
                }
            }
        }
        self.places.get(place..).unwrap_or_default().iter().all(|place| *place == Place::Any)
    }
}

/// The first place of what is left of a pattern of bytes, and how many characters it takes.
fn byte_place(rest: &[char]) -> Option<(Place, usize)> {
    match rest {
        ['*', ..] => Some((Place::Any, 1)),
        ['?', '?', ..] => Some((Place::One, 2)),
        ['?', ..] => Some((Place::One, 1)),
        [high, low, ..] => {
            let value = high.to_digit(16)?.checked_mul(16)?.checked_add(low.to_digit(16)?)?;
            Some((Place::Exactly(u8::try_from(value).ok()?), 2))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text_fits(pattern: &str, answer: &str) -> bool {
        Pattern::text(pattern).unwrap().fits(answer.as_bytes())
    }

    fn bytes_fit(pattern: &str, answer: &[u8]) -> bool {
        Pattern::bytes(pattern).unwrap().fits(answer)
    }

    #[test]
    fn a_star_stands_for_any_characters_and_a_question_mark_for_one() {
        for pattern in ["!01PIR234", "!01PIR*", "*", "!0?PIR???", "*PIR*", "!*4", "**!01PIR234**"] {
            assert!(text_fits(pattern, "!01PIR234"), "{pattern}");
        }
        for pattern in ["", "!01PIR", "!01PIR234?", "!02*", "*5", "!01PIR23", "!?PIR*"] {
            assert!(!text_fits(pattern, "!01PIR234"), "{pattern}");
        }
        assert!(text_fits("", "") && text_fits("*", "") && !text_fits("!", ""));
    }

    #[test]
    fn a_question_mark_at_the_beginning_is_that_of_a_refusal() {
        assert!(text_fits("?01", "?01"));
        assert!(!text_fits("?01", "!01"));
    }

    #[test]
    fn bytes_are_compared_as_numbers() {
        for pattern in [
            "01 03 02 00 07",
            "0103020007",
            "01 03 ?? 00 07",
            "01 03 *",
            "* 07",
            "01 ? ? ? 07",
            "01??*07",
            "01????0007",
        ] {
            assert!(bytes_fit(pattern, &[1, 3, 2, 0, 7]), "{pattern}");
        }
        for pattern in ["01 03", "02 *", "01 03 02 00 07 ??"] {
            assert!(!bytes_fit(pattern, &[1, 3, 2, 0, 7]), "{pattern}");
        }
        for strange in ["0", "0G", "01 3", "01 3 4", "xx", "0?"] {
            assert!(Pattern::bytes(strange).is_err(), "{strange}");
        }
    }

    #[test]
    fn many_stars_over_a_long_answer_are_decided_at_once() {
        let pattern = Pattern::text(&"a*".repeat(200)).unwrap();
        assert!(!pattern.fits("a".repeat(199).as_bytes()));
        assert!(pattern.fits("a".repeat(2_000).as_bytes()));
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(source: String, answer: Vec<u8>) {
            for pattern in [Pattern::text(&source), Pattern::bytes(&source)].into_iter().flatten() {
                let _ = pattern.fits(&answer);
            }
        }

        #[test]
        fn an_answer_fits_itself_with_any_part_replaced_by_a_star(answer in "[!>][0-9A-Z+.]{0,20}", cut in 0usize..20, length in 0usize..20) {
            let from = cut.min(answer.len());
            let to = (from + length).min(answer.len());
            let pattern = format!("{}*{}", &answer[..from], &answer[to..]);
            prop_assert!(text_fits(&pattern, &answer));
            prop_assert!(text_fits(&answer, &answer));
        }
    }
}
