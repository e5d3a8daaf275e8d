//! How long to wait for an answer, as the answers so far suggest.

use std::time::Duration;

use serde::Serialize;

use super::histogram::Histogram;
use crate::bus::Tuning;

/// Fewer answers than this suggest nothing.
const LEAST_ANSWERS: u64 = 10;
/// The slowest of a hundred answers may be slower by this half another time.
const MARGIN: f64 = 1.5;
/// Of the computer that runs the program, in milliseconds.
const SYSTEM_MS: f64 = 10.0;
/// What an adapter can add to an answer where the system does not tell, in milliseconds.
const USUAL_LATENCY_MS: f64 = 16.0;
const STEP_MS: f64 = 10.0;

/// A timeout with the reason for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SuggestedTimeout {
    pub milliseconds: u64,
    pub reason: String,
}

impl SuggestedTimeout {
    pub fn timeout(&self) -> Duration {
        Duration::from_millis(self.milliseconds)
    }
}

/// What to wait for answers that took such times. `latency_ms` is the adapter's latency timer, if it is known; `lost` are
/// answers that did not come, so that the slowest may be among them.
pub fn suggest(times: &Histogram, latency_ms: Option<u32>, lost: u64) -> Option<SuggestedTimeout> {
    let known = times.times().filter(|times| times.count >= LEAST_ANSWERS)?;
    let latency = latency_ms.map_or(USUAL_LATENCY_MS, f64::from);
    let calm = known.p99_ms * MARGIN + latency + SYSTEM_MS;
    let is_lossy = lost.saturating_mul(100) >= known.count;
    let needed = if is_lossy { calm.max(known.max_ms * 2.0) } else { calm };
    let rounded = Duration::from_secs_f64((needed / STEP_MS).ceil() * STEP_MS / 1000.0);
    let timeout = rounded.clamp(*Tuning::TIMEOUTS.start(), *Tuning::TIMEOUTS.end());
    let adapter = match latency_ms {
        Some(latency) => format!("{latency} ms for the adapter's latency timer"),
        None => format!("{USUAL_LATENCY_MS} ms for an adapter whose latency timer is not known"),
    };
    let lossy = if is_lossy {
        format!("; at least twice the slowest answer, because {lost} did not come at all")
    } else {
        String::new()
    };
    let reason = format!(
        "99 of 100 answers began within {:.1} ms; half as much again, {adapter} and {SYSTEM_MS} ms for the computer{lossy}",
        known.p99_ms
    );
    Some(SuggestedTimeout { milliseconds: u64::try_from(timeout.as_millis()).unwrap_or(u64::MAX), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(milliseconds: &[u64]) -> Histogram {
        let mut histogram = Histogram::default();
        milliseconds.iter().for_each(|time| histogram.add(Duration::from_millis(*time)));
        histogram
    }

    #[test]
    fn it_grows_with_the_slowest_answers_and_the_adapter() {
        let suggested = |times: &[u64], latency, lost| suggest(&of(times), latency, lost).map(|it| it.milliseconds);
        assert_eq!(suggested(&[10; 100], Some(1), 0), Some(30));
        assert_eq!(suggested(&[10; 100], None, 0), Some(50));
        assert_eq!(suggested(&[10; 100], Some(16), 0), Some(50));
        assert_eq!(suggested(&[180; 100], Some(1), 50), Some(360));
        assert_eq!(suggested(&[1; 100], Some(1), 0), Some(20), "never less than the least that can be set");
        assert_eq!(suggested(&[9_000; 100], Some(1), 0), Some(5_000));
    }

    #[test]
    fn a_few_answers_suggest_nothing() {
        assert_eq!(suggest(&of(&[10; 9]), None, 0), None);
    }

    #[test]
    fn the_reason_is_told() {
        let reason = suggest(&of(&[20; 50]), Some(16), 5).unwrap().reason;
        for words in ["99 of 100 answers began within 20.0 ms", "16 ms for the adapter", "because 5 did not come"] {
            assert!(reason.contains(words), "{reason}");
        }
    }
}
