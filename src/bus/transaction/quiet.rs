//! The pauses between exchanges: nothing is sent into what others are saying, and what nobody asked for is dropped, but noted.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::shape::Shape;
use super::{MOST_BYTES, MOST_SETTLING, SETTLE, Spoken, WARY_QUIET, Wire};
use crate::bus::judge::{self, Expected};
use crate::bus::line::LineLost;
use crate::bus::tap::Exchange;
use crate::protocol::Failure;

/// How long a line is distrusted after an answer too many.
const WARY_FOR: Duration = Duration::from_secs(1);
/// How long a wait for a late answer goes on before it is looked whether somebody is in a hurry.
const LATE_SLICE: Duration = Duration::from_millis(20);

impl Wire {
    pub(super) fn become_wary(&mut self) {
        self.wary_until = self.line.now().checked_add(WARY_FOR);
    }

    /// Waits until a request may be sent without running into anything.
    pub(super) fn become_quiet(&mut self, request: &[u8], expected: &Expected) -> Result<(), LineLost> {
        let wary = self.is_wary(request, expected);
        if self.disturbed {
            return self.settle(expected, if wary { WARY_QUIET } else { SETTLE });
        }
        let silence = match expected {
            _ if wary => WARY_QUIET,
            Expected::Rtu { .. } => self.settings.frame_silence(),
            _ => Duration::ZERO,
        };
        self.line.wait_until(self.last_activity + silence);
        let mut buffer = [0; 256];
        let count = self.line.receive(&mut buffer, self.line.now())?;
        if count > 0 {
            self.last_activity = self.line.now();
            self.settle_after(buffer.get(..count).unwrap_or_default().to_vec(), expected, SETTLE)?;
        }
        Ok(())
    }

    /// Whether a second answer to the question before is to be expected that could be taken for one to this.
    pub(super) fn is_wary(&self, request: &[u8], expected: &Expected) -> bool {
        let lately = self.wary_until.is_some_and(|until| self.line.now() < until);
        let shape = Shape::of_request(request, expected);
        let before = self.answered.as_ref().map(|(before, _)| *before);
        lately && before.zip(shape).is_some_and(|(before, shape)| before.could_answer(shape))
    }

    /// Waits for an answer that is late, until `until` at most; whatever comes is dropped as a whole.
    pub(super) fn wait_for_late(&mut self, until: Instant, expected: &Expected) -> Result<(), Failure> {
        let mut buffer = [0; 256];
        loop {
            if self.hurry.load(Ordering::Relaxed) {
                return Err(Failure::Silent);
            }
            let slice = until.min(self.line.now() + LATE_SLICE);
            let count = self.line.receive(&mut buffer, slice)?;
            if count > 0 {
                self.last_activity = self.line.now();
                let bytes = buffer.get(..count).unwrap_or_default().to_vec();
                return Ok(self.settle_after(bytes, expected, SETTLE)?);
            }
            self.line.wait_until(slice);
            if slice >= until {
                return Ok(());
            }
        }
    }

    /// The echo of what nobody answers: exactly these bytes are taken off.
    pub(super) fn take_off_echo(
        &mut self,
        request: &[u8],
        expected: &Expected,
        exchange: Exchange,
        spoken: &Spoken,
    ) -> Result<(), LineLost> {
        let (mut heard, mut buffer) = (Vec::new(), [0; 256]);
        let deadline = self.line.now() + SETTLE;
        while heard.len() < request.len() {
            let count = self.line.receive(&mut buffer, deadline)?;
            if count == 0 {
                break;
            }
            self.last_activity = self.line.now();
            heard.extend(buffer.iter().take(count));
        }
        match heard.strip_prefix(request) {
            Some(rest) => {
                let rest = rest.to_vec();
                self.tell_answer(exchange, request, request.to_vec(), spoken);
                self.note_unasked(rest, expected);
            }
            None => self.note_unasked(heard, expected),
        }
        Ok(())
    }

    /// Bytes that belong to no request: perhaps an answer that was late, perhaps one too many.
    pub(super) fn note_unasked(&mut self, mut bytes: Vec<u8>, expected: &Expected) {
        if bytes.is_empty() {
            return;
        }
        self.debts.seen(&bytes, self.line.now());
        if bytes.iter().any(|byte| !judge::is_noise(*byte)) {
            self.become_wary();
            self.spoil_doubtful();
        }
        bytes.truncate(MOST_BYTES);
        let (protocol, checksum) = expected.language();
        let exchange = Exchange { protocol, settings: self.settings, address: None, checksum };
        (self.tap)(exchange.unasked(self.clock.stamp(self.last_activity), bytes));
    }

    /// Drops everything until the line has been quiet for `quiet` or 3.5 characters.
    pub(super) fn settle(&mut self, expected: &Expected, quiet: Duration) -> Result<(), LineLost> {
        self.settle_after(Vec::new(), expected, quiet)
    }

    /// As [`Self::settle`], when these bytes were dropped already.
    pub(super) fn settle_after(
        &mut self,
        mut dropped: Vec<u8>,
        expected: &Expected,
        quiet: Duration,
    ) -> Result<(), LineLost> {
        let quiet = quiet.max(self.settings.frame_silence());
        let give_up = self.line.now() + MOST_SETTLING;
        let mut buffer = [0; 256];
        loop {
            let deadline = self.last_activity + quiet;
            let count = self.line.receive(&mut buffer, deadline)?;
            if count == 0 {
                break;
            }
            self.last_activity = self.line.now();
            dropped.extend(buffer.iter().take(count));
            if self.last_activity > give_up {
                break;
            }
        }
        self.note_unasked(dropped, expected);
        self.disturbed = false;
        Ok(())
    }
}
