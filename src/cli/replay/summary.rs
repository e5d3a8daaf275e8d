//! What a capture comes to.

use std::collections::BTreeMap;

use jiff::{SignedDuration, Timestamp};
use serde::Serialize;

use super::super::{Outcome, output};
use super::trouble;
use crate::bus::{Frame, Verdict};

/// Kinds of errors that are told apart.
const MOST_KINDS: usize = 50;
const OTHER: &str = "other";

/// Counts over a capture.
#[derive(Debug, Default)]
pub(super) struct Summary {
    frames: u64,
    /// Requests on which something came back, or was waited for in vain.
    exchanges: u64,
    first: Option<Timestamp>,
    last: Option<Timestamp>,
    errors: BTreeMap<String, u64>,
}

/// In JSON.
#[derive(Serialize)]
struct SummaryObject<'a> {
    summary: Counts<'a>,
}

#[derive(Serialize)]
struct Counts<'a> {
    frames: u64,
    exchanges: u64,
    seconds: f64,
    errors: &'a BTreeMap<String, u64>,
}

impl Summary {
    pub fn take(&mut self, frame: &Frame, answers: bool) {
        self.frames = self.frames.saturating_add(1);
        self.exchanges = self.exchanges.saturating_add(u64::from(answers));
        self.first.get_or_insert(frame.at);
        self.last = Some(frame.at);
        if let Some(kind) = kind(&frame.verdict) {
            let is_known = self.errors.contains_key(kind) || self.errors.len() < MOST_KINDS;
            let count = self.errors.entry(if is_known { kind } else { OTHER }.to_owned()).or_default();
            *count = count.saturating_add(1);
        }
    }

    pub fn print(&self, json: bool) -> Outcome {
        let Self { frames, exchanges, errors, .. } = self;
        let elapsed = match (self.first, self.last) {
            (Some(first), Some(last)) => last.duration_since(first),
            _ => SignedDuration::ZERO,
        };
        if json {
            let seconds = elapsed.as_secs_f64();
            return output::json(&SummaryObject {
                summary: Counts { frames: *frames, exchanges: *exchanges, seconds, errors },
            });
        }
        output::line("")?;
        output::line(&format!("{frames} frames, {exchanges} exchanges in {:.3} s", elapsed.as_secs_f64()))?;
        if errors.is_empty() {
            return output::line("no errors");
        }
        errors.iter().try_for_each(|(kind, count)| output::line(&format!("{count} × {kind}")))
    }
}

/// What went wrong, without the bytes behind a colon.
fn kind(verdict: &Verdict) -> Option<&str> {
    let trouble = trouble(verdict);
    let kind = trouble.split(':').next().unwrap_or(trouble);
    (!kind.is_empty()).then_some(kind)
}
