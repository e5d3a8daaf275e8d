//! Takes in what the bus tells.

use super::{Bench, LineState, Module, ScanState, Severity, Statistics};
use crate::bus::{BusEvent, RequestId, ScanSummary, Target};
use crate::module::Identified;

/// Events taken in at once, so that a flood cannot hold up the window; the rest waits for the next frame.
const MOST_AT_ONCE: usize = 2_000;

impl Bench {
    /// Takes in the events that are waiting. True if anything changed.
    pub fn drain(&mut self) -> bool {
        let mut changed = self.pump_recordings();
        changed |= self.take_ports();
        for _ in 0..MOST_AT_ONCE {
            let Some(event) = self.bus.try_event() else { break };
            self.take(event);
            changed = true;
        }
        self.hand_over_news();
        changed
    }

    /// Takes in one event.
    pub fn take(&mut self, event: BusEvent) {
        if let Some(awaited) = self.changing_line {
            return self.take_while_changing(awaited, event);
        }
        match event {
            BusEvent::LineLost { reason } => self.line_is_lost(reason),
            BusEvent::StillLost { obstacle } => self.line_is_still_lost(obstacle),
            BusEvent::LineRestored { line } => self.line_is_restored(line),
            BusEvent::ScanProgress { id, progress } => {
                if let Some(ScanState::Running { progress: shown, .. }) = self.running_scan(id) {
                    *shown = Some(progress);
                }
            }
            BusEvent::Found { id, target, identified } => self.found(id, target, identified),
            BusEvent::ScanEnded { id, summary } => self.scan_ended(id, summary),
            BusEvent::Read { id, target, at, values } => {
                if let Some((module, history)) = self.module_and_history(&target) {
                    module.take(history, id, at, values);
                }
            }
            BusEvent::Reading { target, values, .. } => {
                if let Some((module, history)) = self.module_and_history(&target) {
                    module.take_so_far(history, values);
                }
            }
            BusEvent::Parts { target, present } => {
                if let Some(module) = self.module_mut(&target) {
                    module.parts = Some(present);
                }
            }
            BusEvent::Written { id, target, item, at, result } => self.written(id, target, &item, at, result),
            BusEvent::Acted { id, target, action, at, result } => self.acted(id, target, &action, at, result),
            BusEvent::Identified { id, target, result } if self.looking.remove(&id) => match result {
                Ok(identified) => self.found(id, target, identified),
                Err(failure) => self.notify(Severity::Warning, format!("Nobody answers at {target}: {failure}")),
            },
            BusEvent::Identified { id, target, result } => self.identified(id, target, result),
            BusEvent::Traffic(frame) => {
                self.diagnosis.take(&frame);
                self.traffic.push(frame);
            }
            BusEvent::Statistics(statistics) => self.statistics = statistics,
            BusEvent::RawAnswer { id, result } => {
                if !self.take_test_answer(id, &result) {
                    self.raw_answer(id, result);
                }
            }
            BusEvent::Opened { .. } | BusEvent::OpenFailed { .. } | BusEvent::Closed { .. } => {}
        }
    }

    /// Until the line is the one that was asked for, everything else speaks of the line before.
    fn take_while_changing(&mut self, awaited: RequestId, event: BusEvent) {
        match event {
            BusEvent::Opened { id, .. } if id == awaited => self.line_is_open(),
            BusEvent::OpenFailed { id, problem, .. } if id == awaited => {
                self.line = LineState::Closed;
                self.scan = None;
                self.notify_of(super::Topic::NotOpened, problem.to_string());
                self.note_problem(problem);
            }
            BusEvent::Closed { id } if id == awaited => {
                self.line = LineState::Closed;
                self.stop_test();
                self.pause_all();
                self.statistics = Statistics::default();
                self.end_left_init();
                self.modules.iter_mut().for_each(Module::forget_requests);
            }
            BusEvent::ScanEnded { id, summary } => return self.scan_ended(id, summary),
            _ => return,
        }
        self.changing_line = None;
    }

    fn running_scan(&mut self, id: RequestId) -> Option<&mut ScanState> {
        self.scan.as_mut().filter(|scan| matches!(scan, ScanState::Running { id: running, .. } if *running == id))
    }

    fn line_is_open(&mut self) {
        if let Some(line) = self.line.line().cloned() {
            self.statistics = Statistics::default();
            self.line = LineState::Open { line };
            self.note_adapter();
            self.look_for_ports();
        }
    }

    /// A module found again keeps its history.
    fn found(&mut self, id: RequestId, target: Target, identified: Identified) {
        if let Some(ScanState::Running { found, .. }) = self.running_scan(id) {
            *found = found.saturating_add(1);
        }
        let at = self.now();
        match self.module_mut(&target) {
            Some(module) if module.identified.model() == identified.model() => {
                module.identified = identified;
                return self.describe(target);
            }
            // Another module stands there now: nothing that was known of the one before is true of it.
            Some(_) => self.forget(target),
            None => {}
        }
        let mut module = Module::new(id, target, identified, at);
        let line = self.line.line().map(ToString::to_string).unwrap_or_default();
        module.observe(&mut self.history, &line);
        self.modules.push(module);
    }

    /// What the history says of a module that moved or was identified anew.
    pub(super) fn describe(&mut self, target: Target) {
        let line = self.line.line().map(ToString::to_string).unwrap_or_default();
        if let Some((module, history)) = self.module_and_history(&target) {
            module.describe(history, &line);
        }
    }

    fn scan_ended(&mut self, id: RequestId, summary: ScanSummary) {
        if self.running_scan(id).is_some() {
            self.scan = Some(ScanState::Ended(summary));
        }
    }
}
