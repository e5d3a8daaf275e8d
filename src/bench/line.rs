//! The line as a whole: what is known of it, its loss and its return, how patient it is, and what a simulated one does
//! wrong.

use super::{Bench, Module, Presence, Reading, Severity};
use crate::bus::{BusCommand, LineAddress, Tuning, adapters_without_port, ports};
use crate::protocol::Failure;
use crate::record::EventKind;
use crate::sim::{Faults, Injected, Sim};

/// What is known of the line.
#[derive(Debug, Clone, Default)]
pub enum LineState {
    #[default]
    Closed,
    Opening {
        line: LineAddress,
    },
    Open {
        line: LineAddress,
    },
    /// The port vanished; it is taken up again when it returns.
    Lost {
        line: LineAddress,
        reason: String,
    },
}

impl LineState {
    pub fn line(&self) -> Option<&LineAddress> {
        match self {
            Self::Closed => None,
            Self::Opening { line } | Self::Open { line } | Self::Lost { line, .. } => Some(line),
        }
    }

    pub fn is_open(&self) -> bool {
        matches!(self, Self::Open { .. })
    }

    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Lost { .. })
    }

    /// Why nothing can be asked or written at present, and what to do about it; `None` if it can.
    pub fn obstacle(&self) -> Option<&'static str> {
        match self {
            Self::Closed => Some("No line is open: scan to open it again"),
            Self::Lost { line, .. } if line.is_tcp() => {
                Some("The line is lost: check the cable and the module's power")
            }
            Self::Lost { .. } => Some("The line is lost: plug the adapter in again"),
            Self::Opening { .. } | Self::Open { .. } => None,
        }
    }
}

impl Bench {
    /// What goes wrong on the simulated line, also on one that would not open; `None` on every other.
    pub fn faults(&self) -> Option<Faults> {
        self.simulated().map(Sim::faults)
    }

    /// How often each fault of the simulated line has struck; nothing on every other.
    pub fn injected(&self) -> Injected {
        self.simulated().map(Sim::injected).unwrap_or_default()
    }

    pub(super) fn set_faults(&mut self, faults: Faults) {
        if let Some(sim) = self.simulated() {
            sim.set_faults(faults);
        }
    }

    /// The line before is remembered, so that a fault that keeps it from opening can be ended.
    fn simulated(&self) -> Option<&Sim> {
        match self.line.line().or(self.wanted_line.as_ref())? {
            LineAddress::Simulated { sim, .. } => Some(sim),
            _ => None,
        }
    }

    /// How patient the line is with its modules.
    pub fn tuning(&self) -> Tuning {
        self.tuning
    }

    pub(super) fn tune(&mut self, tuning: Tuning) {
        let tuning = tuning.within_limits();
        if tuning != self.tuning && self.try_send(BusCommand::Tune(tuning)) {
            self.tuning = tuning;
        }
    }

    /// Lines that were taken up again under another name, with both names, until the window has taken note.
    pub fn take_renamed(&mut self) -> Vec<(LineAddress, LineAddress)> {
        std::mem::take(&mut self.renamed)
    }

    /// What is known of adapters that have no port, as whole sentences.
    pub fn port_hints(&self) -> &[String] {
        &self.port_hints
    }

    pub(super) fn refresh_ports(&mut self) {
        self.ports = ports();
        self.port_hints = adapters_without_port().iter().map(ToString::to_string).collect();
    }

    pub(super) fn line_is_restored(&mut self, line: LineAddress) {
        let Some(before) = self.line.line().cloned() else { return };
        let renamed = before.to_string() != line.to_string();
        let text = match renamed {
            true => format!("{before} is there again as {line}"),
            false => format!("{line} is there again"),
        };
        self.note_line(EventKind::Found, text.clone());
        self.notify(Severity::Info, text);
        self.line = LineState::Open { line: line.clone() };
        self.wanted_line = Some(line.clone());
        self.ports = ports();
        // The poll that was interrupted has told what it had after the loss.
        self.pause_all();
        self.modules.iter_mut().for_each(Module::line_is_restored);
        if renamed {
            let targets: Vec<_> = self.modules.iter().map(|module| module.target).collect();
            targets.into_iter().for_each(|target| self.describe(target));
            self.renamed.push((before, line));
        }
        self.read_what_was_lost();
    }

    /// What could not be read because the line was gone is asked for again, unless it is polled anyway.
    fn read_what_was_lost(&mut self) {
        let all: Vec<_> = self.modules.iter().map(|module| (module.target, module.lost_readings())).collect();
        for (target, ids) in all {
            self.read(target, ids);
        }
    }

    pub(super) fn line_is_lost(&mut self, reason: String) {
        let Some(line) = self.line.line().cloned() else { return };
        let text = if line.is_tcp() {
            format!(
                "{line} is gone ({reason}) – check the cable and the module's power; it is connected again by itself"
            )
        } else {
            format!("{line} is gone ({reason}) – plug the adapter in again, it is taken up by itself")
        };
        self.notify(Severity::Error, text);
        self.note_line(EventKind::Lost, format!("{line} is gone ({reason})"));
        self.pause_all();
        self.modules.iter_mut().for_each(|module| module.line_is_lost(&reason));
        self.ports = ports();
        self.line = LineState::Lost { line, reason };
    }
}

impl Module {
    /// Its last values stay, as old ones.
    fn line_is_lost(&mut self, reason: &str) {
        self.console.stop();
        if let Some(host_ok) = &mut self.host_ok {
            host_ok.problem = Some("the line is lost, so none is sent".to_owned());
        }
        let failure = Failure::LineLost(reason.to_owned());
        let definition = self.definition().cloned();
        let is_live =
            |id: &str| definition.as_ref().and_then(|definition| definition.item(id)).is_some_and(|item| item.live);
        for (_, reading) in self.readings.iter_mut().filter(|(id, _)| is_live(id)) {
            reading.problem = Some(failure.clone());
        }
        self.presence = Presence::Silent { failure };
    }

    /// Whether it is still there is not known until it is asked.
    fn line_is_restored(&mut self) {
        if matches!(self.presence, Presence::Silent { failure: Failure::LineLost(_) }) {
            self.presence = Presence::Found;
        }
    }

    fn lost_readings(&self) -> Vec<String> {
        let polled = if self.interval.is_some() { self.polled_items() } else { Vec::new() };
        let gone = |reading: &Reading| matches!(reading.problem, Some(Failure::LineLost(_)));
        let readings = self.readings.iter().filter(|(id, reading)| gone(reading) && !polled.contains(&id.as_str()));
        readings.map(|(id, _)| id.clone()).collect()
    }
}
