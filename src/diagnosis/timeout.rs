//! How long to wait for an answer, as the answers so far suggest.

use std::cmp::Ordering;
use std::time::Duration;

use serde::Serialize;

use super::histogram::Histogram;
use super::medium::Medium;
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

/// What the measured answer times say of the timeout in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeoutAdvice {
    /// A longer one is needed.
    Longer,
    /// The one in use suits.
    Fits,
    /// The one in use is ample, and a shorter one would do.
    CouldBeLowered,
}

/// A timeout with the reason for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SuggestedTimeout {
    pub advice: TimeoutAdvice,
    /// What to set; the one in use where that suits.
    pub milliseconds: u64,
    pub in_use_ms: u64,
    pub reason: String,
}

impl SuggestedTimeout {
    pub fn timeout(&self) -> Duration {
        Duration::from_millis(self.milliseconds)
    }

    /// The one in use, and whether it should be another.
    pub fn verdict(&self) -> String {
        let Self { advice, milliseconds, in_use_ms, .. } = self;
        match advice {
            TimeoutAdvice::Longer => format!("{in_use_ms} ms in use, {milliseconds} ms suggested"),
            TimeoutAdvice::Fits => format!("{in_use_ms} ms in use, which suits"),
            TimeoutAdvice::CouldBeLowered => {
                format!("{in_use_ms} ms in use, which is ample; it could be lowered to {milliseconds} ms")
            }
        }
    }
}

/// How long answers are waited for, and what may add to their times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waiting {
    /// The timeout that is set.
    pub in_use: Duration,
    /// The adapter's latency timer, if it is known.
    pub latency_ms: Option<u32>,
    pub medium: Medium,
}

impl Waiting {
    /// How long an answer may take until it is too late.
    pub fn limit(self) -> Duration {
        self.in_use.saturating_add(self.medium.allowance())
    }

    /// What the adapter may add to an answer in milliseconds, and how that is told.
    fn adapter(self) -> (f64, String) {
        match (self.medium, self.latency_ms) {
            (Medium::Network, _) => (0.0, String::new()),
            (Medium::Wire, Some(latency)) => {
                (f64::from(latency), format!(", {latency} ms for the adapter's latency timer"))
            }
            (Medium::Wire, None) => {
                (USUAL_LATENCY_MS, format!(", {USUAL_LATENCY_MS} ms for an adapter whose latency timer is not known"))
            }
        }
    }
}

/// What the times that answers took say of the timeout. `late` are answers that came when they were not waited for any
/// more: only they show that it is too short, and a shorter one is not thought of then.
pub fn suggest(times: &Histogram, waiting: Waiting, late: u64) -> Option<SuggestedTimeout> {
    let known = times.times().filter(|times| times.count >= LEAST_ANSWERS)?;
    let (latency, adapter) = waiting.adapter();
    let calm = known.p99_ms * MARGIN + latency + SYSTEM_MS;
    let needed = if late > 0 { calm.max(known.max_ms * 2.0) } else { calm };
    let needed = Duration::from_secs_f64((needed / STEP_MS).ceil() * STEP_MS / 1000.0);
    let needed = needed.saturating_sub(waiting.medium.allowance());
    let in_use = waiting.in_use;
    let wanted = if late > 0 { needed.max(in_use.saturating_mul(2)) } else { needed };
    let wanted = wanted.clamp(*Tuning::TIMEOUTS.start(), *Tuning::TIMEOUTS.end());
    let advice = match wanted.cmp(&in_use) {
        Ordering::Greater => TimeoutAdvice::Longer,
        // Over a network every answer is waited for longer than is set, so that less gains nothing.
        Ordering::Less if waiting.medium == Medium::Wire => TimeoutAdvice::CouldBeLowered,
        _ => TimeoutAdvice::Fits,
    };
    let timeout = if advice == TimeoutAdvice::Fits { in_use } else { wanted };
    let came_late = match late {
        0 => String::new(),
        1 => "; at least twice as long as now, because 1 answer came too late".to_owned(),
        late => format!("; at least twice as long as now, because {late} answers came too late"),
    };
    let reason = format!(
        "99 of 100 answers began within {:.1} ms; half as much again{adapter} and {SYSTEM_MS} ms for the computer{came_late}",
        known.p99_ms
    );
    let whole = |time: Duration| u64::try_from(time.as_millis()).unwrap_or(u64::MAX);
    Some(SuggestedTimeout { advice, milliseconds: whole(timeout), in_use_ms: whole(in_use), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(milliseconds: &[u64]) -> Histogram {
        let mut histogram = Histogram::default();
        milliseconds.iter().for_each(|time| histogram.add(Duration::from_millis(*time)));
        histogram
    }

    fn wire(in_use: u64, latency_ms: Option<u32>) -> Waiting {
        Waiting { in_use: Duration::from_millis(in_use), latency_ms, medium: Medium::Wire }
    }

    fn told(times: &[u64], waiting: Waiting, late: u64) -> String {
        suggest(&of(times), waiting, late).unwrap().verdict()
    }

    #[test]
    fn an_ample_timeout_is_called_ample_and_how_far_it_could_be_lowered_grows_with_answers_and_adapter() {
        let lowered = |times: &[u64], latency| told(times, wire(200, latency), 0);
        assert_eq!(lowered(&[10; 100], Some(1)), "200 ms in use, which is ample; it could be lowered to 30 ms");
        assert_eq!(lowered(&[10; 100], None), "200 ms in use, which is ample; it could be lowered to 50 ms");
        assert_eq!(lowered(&[10; 100], Some(16)), "200 ms in use, which is ample; it could be lowered to 50 ms");
        assert!(lowered(&[1; 100], Some(1)).ends_with("lowered to 20 ms"), "never less than the least that can be set");
    }

    #[test]
    fn a_longer_one_is_suggested_where_the_answer_times_come_near_the_one_in_use() {
        assert_eq!(told(&[180; 100], wire(200, Some(1)), 0), "200 ms in use, 290 ms suggested");
        assert_eq!(told(&[9_000; 100], wire(200, Some(1)), 0), "200 ms in use, 5000 ms suggested");
        assert_eq!(told(&[125; 100], wire(200, Some(1)), 0), "200 ms in use, which suits");
    }

    #[test]
    fn answers_that_came_late_ask_for_twice_as_long_and_never_for_less() {
        assert_eq!(told(&[10; 100], wire(200, Some(1)), 3), "200 ms in use, 400 ms suggested");
        let reason = suggest(&of(&[20; 50]), wire(50, Some(16)), 5).unwrap().reason;
        for words in
            ["99 of 100 answers began within 20.0 ms", "16 ms for the adapter", "because 5 answers came too late"]
        {
            assert!(reason.contains(words), "{reason}");
        }
    }

    #[test]
    fn over_a_network_no_adapter_and_no_shorter_timeout_is_thought_of() {
        let network = Waiting { medium: Medium::Network, ..wire(200, None) };
        let suggested = suggest(&of(&[10; 100]), network, 0).unwrap();
        assert_eq!(suggested.advice, TimeoutAdvice::Fits);
        assert!(!suggested.reason.contains("adapter"), "{}", suggested.reason);
        assert_eq!(suggest(&of(&[900; 100]), network, 0).unwrap().milliseconds, 560);
    }

    #[test]
    fn a_few_answers_suggest_nothing() {
        assert_eq!(suggest(&of(&[10; 9]), wire(200, None), 0), None);
    }
}
