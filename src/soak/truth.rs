//! What each module has had, and since when, as it says itself: independent of everything between it and the program.

use std::collections::BTreeMap;
use std::time::Instant;

use super::limits::{CLOCK_ERROR, MOST_AGE};

/// A value, compared as what it means: 5.00 is 5.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Known {
    /// In thousandths.
    Number(i64),
    Word(String),
}

impl Known {
    fn of(text: &str) -> Self {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Self::Number((number * 1_000.0).round() as i64),
            _ => Self::Word(text.to_owned()),
        }
    }

    #[cfg(test)]
    fn text(&self) -> String {
        match self {
            Self::Number(number) => (*number as f64 / 1_000.0).to_string(),
            Self::Word(word) => word.clone(),
        }
    }
}

/// What is to be said of a value that the program has taken for a module's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// The module had it when it was asked.
    Right,
    /// The module had it, but not any more when it is said to have answered: a late answer was taken for another one's.
    Outdated,
    /// The module never had it.
    Wrong,
    /// Nobody knows what the module has.
    NotKnown,
}

/// All values of all modules, by address and item.
#[derive(Debug, Default)]
pub struct Truth {
    items: BTreeMap<u8, BTreeMap<String, Vec<(Instant, Known)>>>,
}

impl Truth {
    /// The module has this value from `since` on; times are given in order.
    pub fn note(&mut self, address: u8, item: &str, value: &str, since: Instant) {
        let values = self.items.entry(address).or_default().entry(item.to_owned()).or_default();
        let value = Known::of(value);
        if values.last().is_none_or(|(_, last)| *last != value) {
            values.push((since, value));
        }
    }

    /// Whether the module had the value at the time at which it is said to have been measured.
    pub fn judge(&self, address: u8, item: &str, value: &str, measured: Instant) -> Judgement {
        let Some(values) = self.values(address, item) else { return Judgement::NotKnown };
        let value = Known::of(value);
        let [from, to] = [measured.checked_sub(MOST_AGE), measured.checked_add(CLOCK_ERROR)];
        let ends = values.iter().skip(1).map(|(since, _)| Some(*since)).chain([None]);
        let had = values.iter().zip(ends).filter(|((_, known), _)| *known == value);
        let mut judgement = Judgement::Wrong;
        for ((since, _), end) in had {
            let begun = to.is_none_or(|to| *since <= to);
            let over = end.is_some_and(|end| from.is_some_and(|from| end < from));
            if begun && !over {
                return Judgement::Right;
            }
            judgement = Judgement::Outdated;
        }
        judgement
    }

    /// Whether the module ever had the value.
    pub fn ever(&self, address: u8, item: &str, value: &str) -> Judgement {
        let Some(values) = self.values(address, item) else { return Judgement::NotKnown };
        let value = Known::of(value);
        if values.iter().any(|(_, known)| *known == value) { Judgement::Right } else { Judgement::Wrong }
    }

    /// Whether the module has the value now.
    pub fn is_now(&self, address: u8, item: &str, value: &str) -> Judgement {
        match self.values(address, item).and_then(|values| values.last()) {
            None => Judgement::NotKnown,
            Some((_, known)) if *known == Known::of(value) => Judgement::Right,
            Some(_) => Judgement::Outdated,
        }
    }

    #[cfg(test)]
    pub fn now(&self, address: u8, item: &str) -> Option<String> {
        self.values(address, item)?.last().map(|(_, known)| known.text())
    }

    fn values(&self, address: u8, item: &str) -> Option<&[(Instant, Known)]> {
        self.items.get(&address)?.get(item).map(Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    /// 20 degrees at first, 21 after ten seconds.
    fn truth() -> (Truth, Instant) {
        let (mut truth, start) = (Truth::default(), Instant::now());
        truth.note(1, "temperature_c", "20.00", start);
        truth.note(1, "temperature_c", "21.00", start + Duration::from_secs(10));
        (truth, start)
    }

    fn at(start: Instant, seconds: f64) -> Instant {
        start + Duration::from_secs_f64(seconds)
    }

    #[test]
    fn a_value_that_the_module_never_had_is_wrong() {
        let (truth, start) = truth();
        assert_eq!(truth.judge(1, "temperature_c", "20.01", at(start, 1.0)), Judgement::Wrong);
        assert_eq!(truth.ever(1, "temperature_c", "20.01"), Judgement::Wrong);
        assert_eq!(truth.ever(1, "temperature_c", "20.0"), Judgement::Right);
    }

    #[test]
    fn a_value_is_right_as_long_as_the_module_has_it_and_for_the_time_of_one_answer() {
        let (truth, start) = truth();
        let judge = |value, seconds| truth.judge(1, "temperature_c", value, at(start, seconds));
        assert_eq!(judge("20.00", 9.0), Judgement::Right);
        assert_eq!(judge("20.00", 10.2), Judgement::Right);
        assert_eq!(judge("20.00", 10.5), Judgement::Outdated);
        assert_eq!(judge("21.00", 10.5), Judgement::Right);
        assert_eq!(judge("21.00", 9.0), Judgement::Outdated);
    }

    #[test]
    fn a_value_that_comes_back_is_right_again() {
        let (mut truth, start) = truth();
        truth.note(1, "temperature_c", "20.00", at(start, 20.0));
        assert_eq!(truth.judge(1, "temperature_c", "20.00", at(start, 15.0)), Judgement::Outdated);
        assert_eq!(truth.judge(1, "temperature_c", "20.00", at(start, 25.0)), Judgement::Right);
    }

    #[test]
    fn what_nobody_knows_is_not_judged() {
        let (truth, start) = truth();
        assert_eq!(truth.judge(2, "temperature_c", "20.00", start), Judgement::NotKnown);
        assert_eq!(truth.ever(1, "humidity", "1"), Judgement::NotKnown);
    }

    #[test]
    fn words_and_switches_are_compared_as_they_are() {
        let (mut truth, start) = truth();
        truth.note(1, "pir1", "true", start);
        assert_eq!(truth.is_now(1, "pir1", "true"), Judgement::Right);
        assert_eq!(truth.judge(1, "pir1", "false", start), Judgement::Wrong);
    }
}
