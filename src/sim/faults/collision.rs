//! Modules that answer at the same time spoil each other's bytes; a driven 0 wins here, on a real line it is a matter of
//! strength.

use std::time::Duration;

use crate::protocol::LineSettings;

use super::super::world::Answer;
use super::sound::Code;

/// How often a bit more is spoiled before the second answer is dropped.
const MOST_TRIES: u32 = 64;

/// What is on the wire of several answers, in the order of their beginnings.
///
/// Where they overlap no right frame is left over that no module sent; `spoilt` says that they never fit together by
/// luck either, as two modules that are not in step do not.
pub fn collide(
    mut answers: Vec<Answer>,
    settings: LineSettings,
    code: Code,
    spoilt: bool,
    random: &mut fastrand::Rng,
) -> Vec<Answer> {
    answers.sort_by_key(|answer| answer.delay);
    let sent: Vec<Vec<u8>> = if spoilt { Vec::new() } else { answers.iter().map(|a| a.bytes.clone()).collect() };
    let mut on_the_wire: Vec<Answer> = Vec::new();
    for answer in answers {
        match on_the_wire.last_mut().filter(|first| ends(first, settings) > answer.delay) {
            Some(first) => {
                let place = characters(answer.delay.saturating_sub(first.delay), settings);
                first.bytes = overlay(&first.bytes, &answer.bytes, place, (code, spoilt, &sent), random);
            }
            None => on_the_wire.push(answer),
        }
    }
    on_the_wire
}

fn ends(answer: &Answer, settings: LineSettings) -> Duration {
    answer.delay.saturating_add(settings.wire_time(answer.bytes.len()))
}

/// Whole characters that pass in `time`.
fn characters(time: Duration, settings: LineSettings) -> usize {
    let character = settings.wire_time(1).as_nanos().max(1);
    usize::try_from(time.as_nanos() / character).unwrap_or(usize::MAX)
}

/// `second` begins at `place` of `first`.
fn overlay(
    first: &[u8],
    second: &[u8],
    place: usize,
    (code, spoilt, sent): (Code, bool, &[Vec<u8>]),
    random: &mut fastrand::Rng,
) -> Vec<u8> {
    let mut bytes = first.to_vec();
    for (byte, other) in bytes.iter_mut().skip(place).zip(second) {
        *byte &= other;
    }
    let beyond = first.len().saturating_sub(place);
    bytes.extend(second.iter().skip(beyond));
    let both = place..first.len().min(place.saturating_add(second.len()));
    let lucky = |bytes: &[u8]| {
        spoilt && (bytes.get(..first.len()) == Some(first) || bytes.get(place..) == Some(second))
            || code.misleads(bytes, sent)
    };
    for _ in 0..MOST_TRIES {
        if both.is_empty() || !lucky(&bytes) {
            return bytes;
        }
        if let Some(byte) = bytes.get_mut(random.usize(both.clone())) {
            *byte &= !(1_u8 << random.u8(..8));
        }
    }
    first.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(milliseconds: u64, bytes: &[u8]) -> Answer {
        Answer { delay: Duration::from_millis(milliseconds), bytes: bytes.to_vec() }
    }

    fn heard(answers: Vec<Answer>, spoilt: bool) -> Vec<Answer> {
        collide(answers, LineSettings::default(), Code::Open, spoilt, &mut fastrand::Rng::with_seed(1))
    }

    #[test]
    fn answers_at_the_same_time_spoil_each_other() {
        let heard = heard(vec![answer(5, b"!01AB"), answer(30, b"!"), answer(5, b"!01B")], false);
        assert_eq!(heard, [answer(5, b"!01@B"), answer(30, b"!")]);
    }

    #[test]
    fn a_later_answer_spoils_the_end_of_an_earlier_one_and_goes_on_behind_it() {
        // A character takes 1.04 ms.
        assert_eq!(heard(vec![answer(5, b"!01AB"), answer(8, b"BCDE")], false), [answer(5, b"!0\0A@E")]);
        assert_eq!(heard(vec![answer(5, b"!01"), answer(9, b"!02")], false), [answer(5, b"!01"), answer(9, b"!02")]);
    }

    #[test]
    fn answers_that_are_the_same_do_not_fit_together_if_they_shall_not() {
        let same = || vec![answer(5, b"!01\r"), answer(5, b"!01\r")];
        assert_eq!(heard(same(), false), [answer(5, b"!01\r")]);
        assert_ne!(heard(same(), true), [answer(5, b"!01\r")]);
    }
}
