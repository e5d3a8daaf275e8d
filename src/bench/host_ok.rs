//! Sending Host OK again and again, so that a host watchdog does not trip.

use std::time::Duration;

use jiff::Timestamp;

use super::{Bench, Module, Severity};
use crate::bus::{BusCommand, RequestId, Target};
use crate::module::{Value, WriteError};

/// The action that restarts the watchdog's time.
pub const HOST_OK: &str = "host_ok";
/// Periods to choose from are this part of the timeout at the most, so that one lost message does no harm.
const SAFE_SHARE: u32 = 3;

/// Host OK as it is sent at present.
#[derive(Debug, Clone, PartialEq)]
pub struct HostOk {
    pub(super) id: RequestId,
    pub period: Duration,
    /// When the last one went out.
    pub last: Option<Timestamp>,
    pub sent: u64,
    /// Why the last attempt failed.
    pub problem: Option<String>,
}

impl Module {
    /// The host watchdog's timeout as the module told it.
    pub fn watchdog_timeout(&self) -> Option<Duration> {
        match self.known("wdt_timeout") {
            Some(Value::Number(seconds)) => Duration::try_from_secs_f64(seconds.to_f64()).ok(),
            _ => None,
        }
    }

    /// A period that keeps the watchdog quiet even if two messages in a row are lost.
    pub fn safe_host_ok_period(&self) -> Option<Duration> {
        self.watchdog_timeout().and_then(|timeout| timeout.checked_div(SAFE_SHARE))
    }

    /// Whether the module would act on its relays if Host OK stopped.
    pub fn watchdog_counts(&self) -> bool {
        self.known("wdt_enabled").and_then(Value::as_bool).unwrap_or(false)
    }

    /// When the watchdog trips unless it hears something: after the last Host OK that this program sent.
    pub fn trips_at(&self) -> Option<Timestamp> {
        let last = self.host_ok.as_ref()?.last?;
        let timeout = self.watchdog_timeout().filter(|_| self.watchdog_counts())?;
        last.checked_add(timeout).ok()
    }
}

impl Bench {
    /// Sends Host OK now and after each `period`, which may not be longer than the timeout.
    pub(super) fn start_host_ok(&mut self, target: Target, period: Duration) {
        let id = self.bus.next_id();
        let Some(module) = self.module_mut(&target) else { return };
        let Some(definition) = module.definition().cloned() else { return };
        let Some(timeout) = module.watchdog_timeout() else {
            let text = "Host OK is not sent: the watchdog's timeout is not known – read it again first";
            return self.notify(Severity::Error, text.to_owned());
        };
        if period > timeout {
            let text = format!(
                "Host OK every {:.1} s would come too late: the watchdog trips after {:.1} s – choose a shorter period",
                period.as_secs_f64(),
                timeout.as_secs_f64()
            );
            return self.notify(Severity::Error, text);
        }
        let host_ok = HostOk { id, period, last: None, sent: 0, problem: None };
        if self.try_send(BusCommand::Repeat { id, target, definition, action: HOST_OK.to_owned(), period })
            && let Some(module) = self.module_mut(&target)
        {
            module.host_ok = Some(host_ok);
        }
    }

    pub(super) fn stop_host_ok(&mut self, target: Target) {
        let Some(module) = self.module_mut(&target) else { return };
        if module.host_ok.take().is_none() {
            return;
        }
        self.send(BusCommand::StopRepeating { target, action: HOST_OK.to_owned() });
    }
}

impl Module {
    /// Notes a Host OK of the repetition. False if `id` is not of it.
    pub(super) fn host_ok_sent(&mut self, id: RequestId, at: Timestamp, result: &Result<(), WriteError>) -> bool {
        let Some(host_ok) = self.host_ok.as_mut().filter(|host_ok| host_ok.id == id) else { return false };
        match result {
            Ok(()) => {
                host_ok.last = Some(at);
                host_ok.sent = host_ok.sent.saturating_add(1);
                host_ok.problem = None;
            }
            Err(error) => host_ok.problem = Some(error.to_string()),
        }
        true
    }
}
