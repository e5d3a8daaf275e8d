//! The line as a whole: what is known of it, its loss and its return, how patient it is, and what a simulated one does
//! wrong.

use super::{Bench, Module, Presence, Reading, Severity, Topic};
use crate::bus::{BusCommand, LineAddress, Obstacle, Tuning};
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
        /// Why it cannot be taken up although its adapter is there.
        obstacle: Option<Obstacle>,
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
            Self::Lost { line, reason, obstacle } => Some(match Cause::of(line, reason, obstacle.as_ref()) {
                Cause::Network => "The line is lost: check the cable and the module's power",
                Cause::Blocked => {
                    "The line is lost: switch flow control off, or unplug the adapter and plug it in again"
                }
                Cause::Barred(_) => "The line is lost: its adapter is there but cannot be taken up, see the notices",
                Cause::Unplugged => "The line is lost: plug the adapter in again",
            }),
            Self::Opening { .. } | Self::Open { .. } => None,
        }
    }

    /// Why the line is lost, and how it comes back; `None` while it is not.
    pub fn loss(&self) -> Option<String> {
        match self {
            Self::Lost { line, reason, obstacle } => Some(told(line, reason, obstacle.as_ref())),
            _ => None,
        }
    }
}

/// What a loss comes from, as far as is known: each has another way out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cause<'a> {
    Network,
    /// The adapter is there and takes nothing.
    Blocked,
    /// The adapter is there and cannot be opened.
    Barred(&'a Obstacle),
    Unplugged,
}

impl<'a> Cause<'a> {
    fn of(line: &LineAddress, reason: &str, obstacle: Option<&'a Obstacle>) -> Self {
        match obstacle {
            _ if line.is_tcp() => Self::Network,
            Some(obstacle) => Self::Barred(obstacle),
            // Only what is written to a serial port can run into a timeout there.
            None if reason.contains("takes no bytes") || reason.contains("timed out") => Self::Blocked,
            None => Self::Unplugged,
        }
    }
}

/// What happened to a lost line, and what to do about it.
fn told(line: &LineAddress, reason: &str, obstacle: Option<&Obstacle>) -> String {
    match Cause::of(line, reason, obstacle) {
        Cause::Network => format!(
            "{line} is gone ({reason}) – check the cable and the module's power; it is connected again by itself"
        ),
        Cause::Blocked => format!(
            "{line} is lost ({reason}) – its flow control or driver holds bytes back: switch flow control off, unplug \
             and replug the adapter, or restart the program that shares a virtual port; it is taken up again by itself"
        ),
        Cause::Barred(obstacle) => told_barred(line, obstacle),
        Cause::Unplugged => format!("{line} is gone ({reason}) – plug the adapter in again, it is taken up by itself"),
    }
}

/// Both obstacles say what to do; a problem names its line.
fn told_barred(line: &LineAddress, obstacle: &Obstacle) -> String {
    match obstacle {
        Obstacle::NotOpened(problem) => format!("{problem}; it is tried again by itself"),
        Obstacle::WithoutPort(adapter) => {
            format!("{line} cannot be taken up again: {adapter}; it is tried again by itself")
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
            self.diagnosis.known.note_tuning(tuning);
        }
    }

    /// Lines that were taken up again under another name, with both names, until the window has taken note.
    pub fn take_renamed(&mut self) -> Vec<(LineAddress, LineAddress)> {
        std::mem::take(&mut self.renamed)
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
        self.look_for_ports();
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
        self.notify_of(Topic::LineLost, told(&line, &reason, None));
        self.note_line(EventKind::Lost, format!("{line} is gone ({reason})"));
        self.pause_all();
        self.modules.iter_mut().for_each(|module| module.line_is_lost(&reason));
        self.look_for_ports();
        self.line = LineState::Lost { line, reason, obstacle: None };
    }

    /// The adapter of the lost line is there again and cannot be taken up: why, told once for each loss.
    pub(super) fn line_is_still_lost(&mut self, obstacle: Obstacle) {
        let LineState::Lost { line, obstacle: known, .. } = &mut self.line else { return };
        let text = told_barred(line, &obstacle);
        *known = Some(obstacle);
        let mut since = self.notices.iter().rev().take_while(|notice| notice.topic != Topic::LineLost);
        if !since.any(|notice| notice.topic == Topic::StillLost && notice.text == text) {
            self.notify_of(Topic::StillLost, text);
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Action;
    use crate::bus::{Bus, LineProblem, NoPort, ProblemKind, WithoutPort};
    use crate::module::Catalogue;
    use crate::protocol::LineSettings;

    fn port() -> LineAddress {
        LineAddress::Serial { port: "/dev/ttyUSB0".to_owned() }
    }

    fn not_opened(kind: ProblemKind) -> Obstacle {
        Obstacle::NotOpened(LineProblem { line: port().to_string(), kind })
    }

    fn with_open_line() -> Bench {
        let (bus, ..) = Bus::detached();
        let mut bench = Bench::new(bus, Catalogue::built_in().0.into(), &[]);
        bench.line = LineState::Open { line: port() };
        bench
    }

    fn texts(bench: &Bench, topic: Topic) -> Vec<&str> {
        bench.notices().filter(|notice| notice.topic == topic).map(|notice| notice.text.as_str()).collect()
    }

    #[test]
    fn what_to_do_about_a_loss_follows_its_reason() {
        assert!(told(&port(), "it was unplugged", None).contains("plug the adapter in again"));
        let network = LineAddress::tcp("192.168.0.9").unwrap();
        assert!(told(&network, "the connection timed out", None).contains("check the cable"));
        for reason in ["the port takes no bytes", "Operation timed out"] {
            let text = told(&port(), reason, None);
            assert!(text.contains("switch flow control off") && !text.contains("plug the adapter in again"), "{text}");
            let state = LineState::Lost { line: port(), reason: reason.to_owned(), obstacle: None };
            assert!(state.obstacle().unwrap().contains("flow control"));
        }
    }

    #[test]
    fn a_scan_of_a_lost_line_tells_why_it_is_lost() {
        let scan = |line: LineAddress, reason: &str, obstacle: Option<Obstacle>| {
            let mut bench = with_open_line();
            bench.line = LineState::Open { line: line.clone() };
            bench.line_is_lost(reason.to_owned());
            if let Some(obstacle) = obstacle {
                bench.line_is_still_lost(obstacle);
            }
            let plan = crate::bus::ScanPlan::quick();
            bench.apply(Action::Scan { line, settings: LineSettings::default(), plan });
            assert!(!bench.is_scanning());
            bench.notices().last().unwrap().text.clone()
        };
        let told = scan(port(), "it was unplugged", None);
        assert!(told.starts_with("It cannot be scanned now: /dev/ttyUSB0 is gone (it was unplugged)"), "{told}");
        let told = scan(port(), "it was unplugged", Some(not_opened(ProblemKind::PermissionDenied)));
        assert!(told.contains("ermission") && !told.contains("plug the adapter in"), "{told}");
        let told = scan(port(), "the port takes no bytes", None);
        assert!(told.contains("switch flow control off"), "{told}");
        let told = scan(LineAddress::tcp("192.168.0.9").unwrap(), "the module closed the connection", None);
        assert!(told.contains("check the cable") && !told.contains("adapter"), "{told}");
    }

    #[test]
    fn a_dash_in_a_reason_is_no_obstacle() {
        let text = told(&port(), "read error 5 – EIO", None);
        assert!(text.contains("plug the adapter in again"), "{text}");
    }

    #[test]
    fn why_an_adapter_that_is_there_is_not_taken_up_is_told_once_for_each_loss() {
        let mut bench = with_open_line();
        bench.line_is_still_lost(not_opened(ProblemKind::PermissionDenied));
        assert!(texts(&bench, Topic::StillLost).is_empty());
        bench.line_is_lost("it was unplugged".to_owned());
        let busy = not_opened(ProblemKind::Busy { by: None });
        let driver =
            WithoutPort { maker: "WCH", vendor: 0x1A86, product: 0x7523, reason: NoPort::NoDriver { driver: "ch341" } };
        for obstacle in [busy.clone(), Obstacle::WithoutPort(driver), busy.clone()] {
            bench.line_is_still_lost(obstacle);
        }
        let told = texts(&bench, Topic::StillLost);
        assert_eq!(told.len(), 2, "{told:?}");
        assert_eq!(
            told[0],
            "/dev/ttyUSB0 is in use by another program – close that program and try again; it is tried again by itself"
        );
        assert!(
            told[1].starts_with("/dev/ttyUSB0 cannot be taken up again: An adapter of WCH (1a86:7523)"),
            "{told:?}"
        );
        assert!(told[1].contains("sudo modprobe ch341"), "{told:?}");
        assert!(matches!(bench.line(), LineState::Lost { obstacle, .. } if *obstacle == Some(busy.clone())));
        assert!(bench.line().obstacle().unwrap().contains("cannot be taken up"));
        bench.line_is_restored(port());
        bench.line_is_lost("it was unplugged".to_owned());
        bench.line_is_still_lost(busy);
        assert_eq!(texts(&bench, Topic::StillLost).len(), 3);
    }

    #[test]
    fn a_loss_is_told_for_as_long_as_it_lasts() {
        let mut bench = with_open_line();
        bench.line_is_lost("it was unplugged".to_owned());
        assert!(Topic::LineLost.holds(bench.line()) && Topic::StillLost.holds(bench.line()));
        bench.line_is_restored(port());
        assert!(!Topic::LineLost.holds(bench.line()) && !Topic::NotOpened.holds(bench.line()));
        assert!(Topic::NotOpened.holds(&LineState::Closed));
    }
}
