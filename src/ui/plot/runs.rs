//! States over time.

/// A time during which a state stood still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Seconds since 1970 UTC.
    pub from: f64,
    pub to: f64,
    pub value: f64,
}

impl Run {
    pub fn is_on(&self) -> bool {
        self.value >= 0.5
    }
}

/// Joins samples that are alike; each holds until the next.
pub fn runs(stretch: &[[f64; 2]]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for [at, value] in stretch {
        if let Some(last) = runs.last_mut() {
            last.to = *at;
        }
        if runs.last().is_none_or(|last| last.value != *value) {
            runs.push(Run { from: *at, to: *at, value: *value });
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_samples_are_one_run_that_lasts_until_the_next() {
        let samples = [[1.0, 0.0], [2.0, 0.0], [3.0, 1.0], [4.0, 1.0], [5.0, 0.0]];
        let expected = [
            Run { from: 1.0, to: 3.0, value: 0.0 },
            Run { from: 3.0, to: 5.0, value: 1.0 },
            Run { from: 5.0, to: 5.0, value: 0.0 },
        ];
        assert_eq!(runs(&samples), expected);
        assert_eq!(runs(&[]), []);
        assert!(expected[1].is_on() && !expected[2].is_on());
    }
}
