//! What a user can ask for, and how it is carried out.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Duration;

use jiff::Timestamp;

use super::console::{RawCommand, Script};
use super::observer::LIMITS;
use super::{Bench, DEFAULT_INTERVAL, LineState, Module, RecordingId, ScanState, Severity};
use crate::bus::{BusCommand, ItemSet, LineAddress, ScanPlan, Target, Tuning};
use crate::protocol::LineSettings;
use crate::record::Destination;
use crate::sim::Faults;

/// What a user asks for.
#[derive(Debug, Clone)]
pub enum Action {
    /// Look again which ports there are.
    RefreshPorts,
    /// Open a line; the one that was open is closed.
    Connect {
        line: LineAddress,
        settings: LineSettings,
    },
    Disconnect,
    /// How patient the line is from now on, and others that are opened later.
    Tune(Tuning),
    /// What goes wrong on the simulated line from now on.
    SetFaults(Faults),
    /// Search a line for modules, opening it first if it is not open.
    Scan {
        line: LineAddress,
        settings: LineSettings,
        plan: ScanPlan,
    },
    PauseScan(bool),
    CancelScan,
    /// Show a module, and poll it from now on.
    Show(Target),
    /// Poll a module so often; zero is as fast as the line allows.
    SetInterval(Target, Duration),
    /// Poll only these live items of a module; `None` is all of them.
    ChoosePolled(Target, Option<BTreeSet<String>>),
    /// Stop polling a module; its last values stay.
    StopPolling(Target),
    /// Forget a module.
    Remove(Target),
    /// Poll every module whose model is known, or none.
    PollAll(bool),
    /// Ask one place whether the module that was known there is there now.
    LookFor(Target),
    /// Ask for these items once.
    Read(Target, Vec<String>),
    /// Change an item, to be written later; the text is judged by the item.
    Stage(Target, String, String),
    /// Take back the change of one item, or of all.
    Revert(Target, Option<String>),
    /// Take back what was staged or reverted last.
    Undo(Target),
    /// Do again what was undone last.
    Redo(Target),
    /// Write the changes of these items.
    Write(Target, Vec<String>),
    /// Change an item and write it at once, as a switch does.
    Set(Target, String, String),
    /// Carry out an action of the definition.
    Act(Target, String),
    /// Send Host OK after each period, which may not be longer than the watchdog's timeout.
    StartHostOk(Target, Duration),
    StopHostOk(Target),
    /// Send a command as it is, once.
    SendRaw(Target, RawCommand),
    /// Send a command as it is, again and again after each period.
    RepeatRaw(Target, RawCommand, Duration),
    /// End what repeats and the script of a module.
    StopRaw(Target),
    /// Run a script from its first line; the one that runs is stopped.
    RunScript(Target, Script),
    /// Forget the exchanges of a module.
    ClearExchanges(Target),
    /// Begin to write what needs INIT mode, step by step.
    BeginInit(Target),
    /// The user has done what the present step asks for.
    ContinueInit,
    /// Stop looking, and turn switch and power once more.
    BackInInit,
    LeaveInit,
    /// Turn a switch of a simulated module, or its power off and on.
    Simulated(Target, Simulated),
    /// Add a module definition from a file to the user's own; it counts at once. Refused if another one of this model is
    /// there.
    AddDefinition(PathBuf),
    /// The same, in place of the one that is there.
    ReplaceDefinition(PathBuf),
    /// Tell something that happened in the window itself.
    Notify(Severity, String),
    /// Tell that a file was written, so that its folder can be shown.
    TellOfFile(String, PathBuf),
    ClearNotices,
    /// Record from now on.
    Record(Destination),
    StopRecording,
    /// Open a recording to look at it.
    OpenRecording(PathBuf),
    CloseRecording(RecordingId),
    /// A remark about a time.
    AddNote(Timestamp, String),
    /// Forget what passed the line so far.
    ClearTraffic,
    /// Ask a module the same so many times, to see whether it answers the same.
    TestConsistency(Target, u32),
    StopTest,
}

/// What a person would do with the hands, for modules that are simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simulated {
    /// DIP 4.
    Init(bool),
    PowerCycle,
}

impl Bench {
    pub fn apply(&mut self, action: Action) {
        match action {
            Action::RefreshPorts => self.look_for_ports(),
            Action::Connect { line, settings } => self.connect(line, settings),
            Action::Disconnect => self.disconnect(),
            Action::Tune(tuning) => self.tune(tuning),
            Action::SetFaults(faults) => self.set_faults(faults),
            Action::Scan { line, settings, plan } => self.start_scan(line, settings, plan),
            Action::PauseScan(paused) => self.send(BusCommand::PauseScan(paused)),
            Action::CancelScan => self.send(BusCommand::CancelScan),
            Action::Show(target) => self.show(target),
            Action::SetInterval(target, interval) => self.watch(target, interval),
            Action::ChoosePolled(target, items) => self.choose_polled(target, items),
            Action::StopPolling(target) => self.stop_polling(target),
            Action::Remove(target) => self.remove(target),
            Action::PollAll(on) => self.poll_all(on),
            Action::LookFor(target) => self.look_for(target),
            Action::Read(target, ids) => self.read(target, ids),
            Action::Stage(target, id, text) => self.on_module(&target, |module| module.stage(&id, &text)),
            Action::Revert(target, id) => self.on_module(&target, |module| module.revert(id.as_deref())),
            Action::Undo(target) => self.on_module(&target, Module::undo),
            Action::Redo(target) => self.on_module(&target, Module::redo),
            Action::Write(target, ids) => self.write(target, &ids),
            Action::Set(target, id, text) => {
                self.on_module(&target, |module| module.stage(&id, &text));
                self.write(target, &[id]);
            }
            Action::Act(target, action) => self.act(target, action),
            Action::StartHostOk(target, period) => self.start_host_ok(target, period),
            Action::StopHostOk(target) => self.stop_host_ok(target),
            Action::SendRaw(target, command) => self.send_raw(target, command),
            Action::RepeatRaw(target, command, period) => {
                self.on_module(&target, |module| module.console.repeat(command, period));
            }
            Action::StopRaw(target) => self.on_module(&target, |module| module.console.stop()),
            Action::RunScript(target, script) => {
                self.on_module(&target, |module| module.console.run(script, target.checksum));
            }
            Action::ClearExchanges(target) => self.on_module(&target, |module| module.console.clear()),
            Action::BeginInit(target) => self.begin_init(target),
            Action::ContinueInit => self.continue_init(),
            Action::BackInInit => self.back_in_init(),
            Action::LeaveInit => self.leave_init(),
            Action::Simulated(target, what) => self.do_simulated(&target, what),
            Action::AddDefinition(path) => self.add_definition(&path, false),
            Action::ReplaceDefinition(path) => self.add_definition(&path, true),
            Action::Notify(severity, text) => self.notify(severity, text),
            Action::TellOfFile(text, path) => self.tell(Severity::Info, text, Some(path)),
            Action::ClearNotices => self.notices.clear(),
            Action::Record(destination) => self.start_recording(destination),
            Action::StopRecording => self.stop_recording(),
            Action::OpenRecording(path) => self.open_recording(path),
            Action::CloseRecording(id) => self.close_recording(id),
            Action::AddNote(at, text) => self.add_note(at, text),
            Action::ClearTraffic => self.clear_traffic(),
            Action::TestConsistency(target, reads) => self.test_consistency(target, reads),
            Action::StopTest => self.stop_test(),
        }
    }

    pub(super) fn send(&mut self, command: BusCommand) {
        self.try_send(command);
    }

    /// False if the bus does not take the command, which is told.
    pub(super) fn try_send(&mut self, command: BusCommand) -> bool {
        match self.bus.send(command) {
            Ok(()) => true,
            Err(gone) => {
                self.notify(Severity::Error, gone.to_string());
                false
            }
        }
    }

    fn on_module(&mut self, target: &Target, change: impl FnOnce(&mut Module)) {
        if let Some(module) = self.module_mut(target) {
            change(module);
        }
    }

    fn poll_all(&mut self, on: bool) {
        let known = self.modules.iter().filter(|module| module.definition().is_some());
        let others: Vec<Target> =
            known.filter(|module| module.interval.is_some() != on).map(|module| module.target).collect();
        for target in others {
            if on { self.watch(target, DEFAULT_INTERVAL) } else { self.stop_polling(target) }
        }
    }

    fn do_simulated(&mut self, target: &Target, what: Simulated) {
        let Some(LineAddress::Simulated { sim, .. }) = self.line.line() else { return };
        match what {
            Simulated::Init(on) => sim.set_init(target.address, on),
            Simulated::PowerCycle => sim.power_cycle(target.address),
        }
    }

    fn connect(&mut self, line: LineAddress, settings: LineSettings) {
        let id = self.bus.next_id();
        self.pause_all();
        self.modules.clear();
        self.shown = None;
        self.end_left_init();
        self.scan = None;
        self.settings = settings;
        self.changing_line = Some(id);
        self.diagnosis.begin(&line, self.tuning);
        self.line = LineState::Opening { line: line.clone() };
        self.wanted_line = Some(line.clone());
        self.send(BusCommand::Open { id, line, settings });
    }

    fn disconnect(&mut self) {
        let id = self.bus.next_id();
        self.changing_line = Some(id);
        self.send(BusCommand::Close { id });
    }

    fn start_scan(&mut self, line: LineAddress, settings: LineSettings, plan: ScanPlan) {
        if self.line.line().is_some_and(|lost| lost.to_string() == line.to_string())
            && let Some(loss) = self.line.loss()
        {
            return self.notify(Severity::Error, format!("It cannot be scanned now: {loss}"));
        }
        // A line that is still being opened is open by the time the scan is taken.
        let same = self.line.line().is_some_and(|open| open.to_string() == line.to_string());
        if !same {
            self.connect(line, settings);
        }
        let id = self.bus.next_id();
        self.scan = Some(ScanState::Running { id, progress: None, found: 0 });
        self.send(BusCommand::Scan { id, plan });
    }

    pub(super) fn look_for(&mut self, target: Target) {
        let id = self.bus.next_id();
        if self.try_send(BusCommand::Identify { id, target }) {
            self.looking.insert(id);
        }
    }

    fn show(&mut self, target: Target) {
        self.shown = Some(target);
        if self.module(&target).is_some_and(|module| module.interval.is_none()) {
            self.watch(target, DEFAULT_INTERVAL);
        }
    }

    pub(super) fn watch(&mut self, target: Target, interval: Duration) {
        if matches!(self.line, LineState::Closed) {
            return;
        }
        let id = self.bus.next_id();
        let Some(module) = self.module_mut(&target) else { return };
        let Some(definition) = module.definition().cloned() else { return };
        module.interval = Some(interval);
        module.last_interval = Some(interval);
        let items = match &module.polled {
            None => ItemSet::Live,
            Some(_) => ItemSet::Named(module.polled_items().into_iter().map(str::to_owned).collect()),
        };
        self.send(BusCommand::Watch { id, target, definition, items, interval });
        self.read_limits(target);
    }

    /// Plots draw the limits beside the readings, so they are asked for once.
    fn read_limits(&mut self, target: Target) {
        let Some(module) = self.module(&target) else { return };
        let is_missing = |id: &&str| {
            module.known(id).is_none() && module.item(id).is_some_and(|item| !item.live && module.has(item))
        };
        let missing = LIMITS.into_iter().filter(is_missing).map(str::to_owned).collect();
        self.read(target, missing);
    }

    fn choose_polled(&mut self, target: Target, items: Option<BTreeSet<String>>) {
        let Some(module) = self.module_mut(&target) else { return };
        module.polled = items;
        if let Some(interval) = module.interval {
            self.watch(target, interval);
        }
    }

    fn stop_polling(&mut self, target: Target) {
        if let Some((module, history)) = self.module_and_history(&target) {
            module.interval = None;
            module.pause(history);
        }
        self.send(BusCommand::Unwatch { target });
    }

    fn remove(&mut self, target: Target) {
        self.forget(target);
        if self.shown == Some(target) {
            self.shown = None;
        }
    }

    /// Ends everything that is under way for a module, and what is known of it.
    pub(super) fn forget(&mut self, target: Target) {
        self.stop_host_ok(target);
        self.send(BusCommand::Unwatch { target });
        if self.init.as_ref().is_some_and(|init| init.module == target) {
            self.end_left_init();
        }
        self.hand_over_news();
        self.modules.retain(|module| module.target != target);
    }

    /// Nothing is measured for now: the lines of all plots have a gap.
    pub(super) fn pause_all(&mut self) {
        self.hand_over_news();
        let Self { modules, history, .. } = self;
        modules.iter_mut().for_each(|module| module.pause(history));
    }
}
