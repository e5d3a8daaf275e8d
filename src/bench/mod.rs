//! The program's state: the line, the modules found on it and what they last said. Actions come in from the user,
//! events from the bus; the window only draws what stands here.

mod actions;
pub mod console;
mod diagnosis;
mod edits;
mod events;
pub mod files;
mod host_ok;
mod init;
mod journal;
mod line;
mod module;
mod notice;
pub mod objects;
mod observer;
mod ports;
mod recording;
pub mod summary;
mod switch_kind;
mod tab_names;
pub mod traffic;
mod undo;
mod writing;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

pub use actions::{Action, Simulated};
pub use edits::{Edit, EditState, ItemState};
pub use host_ok::{HOST_OK, HostOk};
pub use init::{InitChange, InitProcedure, InitStep};
pub use journal::{Entry, EntryKind, Journal};
pub use line::LineState;
pub use module::{Module, Presence, Reading};
pub use notice::{Notice, Severity, Topic};
pub use observer::{Observer, module_info, silence};
pub use recording::RecordingId;
pub use switch_kind::SwitchKind;
pub use tab_names::{tab_label, tab_place};
use traffic::{FrameRef, TrafficLog};

use crate::bus::{Bus, LineAddress, RequestId, ScanProgress, ScanSummary, Statistics, Target, Tuning};
use crate::module::{Catalogue, Explanation, FileError};
use crate::protocol::LineSettings;
use crate::record::{Destination, History, Viewer};

const NOTICES_KEPT: usize = 200;
/// How often an opened module is polled unless told otherwise.
pub const DEFAULT_INTERVAL: Duration = Duration::from_secs(1);

/// The scan under way, or how the last one ended.
#[derive(Debug, Clone)]
pub enum ScanState {
    Running { id: RequestId, progress: Option<ScanProgress>, found: usize },
    Ended(ScanSummary),
}

/// Everything the window shows.
pub struct Bench {
    bus: Bus,
    catalogue: Arc<Catalogue>,
    /// Where the user's own definitions are kept.
    definitions: Option<PathBuf>,
    ports: ports::Ports,
    line: LineState,
    /// The line that was asked for last, whether or not it is open.
    wanted_line: Option<LineAddress>,
    /// Lines that came back under another name, until the window has taken note.
    renamed: Vec<(LineAddress, LineAddress)>,
    tuning: Tuning,
    settings: LineSettings,
    /// The request that opens or closes the line, until it is answered; what comes before is of the line before.
    changing_line: Option<RequestId>,
    scan: Option<ScanState>,
    modules: Vec<Module>,
    /// The module in view.
    shown: Option<Target>,
    statistics: Statistics,
    traffic: TrafficLog,
    diagnosis: diagnosis::LiveDiagnosis,
    notices: VecDeque<Notice>,
    notices_told: u64,
    /// The guided change of what needs INIT mode.
    init: Option<InitProcedure>,
    /// Modules that were given another address or setting, until the window has taken note.
    moves: Vec<(Target, Target)>,
    clock: fn() -> Timestamp,
    /// Questions whether a module is where it was known to be.
    looking: BTreeSet<RequestId>,
    history: History,
    recording: Option<recording::Recording>,
    /// A recording that begins when the one before is closed.
    starting: Option<Destination>,
    /// What was recorded since the start.
    shelf: recording::Shelf,
    opened: BTreeMap<RecordingId, Viewer>,
    /// Called by threads when there is something new to show.
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Bench {
    pub fn new(bus: Bus, catalogue: Arc<Catalogue>, faulty_files: &[FileError]) -> Self {
        let mut bench = Self {
            bus,
            catalogue,
            definitions: crate::folders::definitions(),
            ports: ports::Ports::default(),
            line: LineState::default(),
            wanted_line: None,
            renamed: Vec::new(),
            tuning: Tuning::default(),
            settings: LineSettings::default(),
            changing_line: None,
            scan: None,
            modules: Vec::new(),
            shown: None,
            statistics: Statistics::default(),
            traffic: TrafficLog::default(),
            diagnosis: diagnosis::LiveDiagnosis::default(),
            notices: VecDeque::new(),
            notices_told: 0,
            init: None,
            moves: Vec::new(),
            clock: Timestamp::now,
            looking: BTreeSet::new(),
            history: History::default(),
            recording: None,
            starting: None,
            shelf: recording::Shelf::default(),
            opened: BTreeMap::new(),
            wake: Arc::new(|| {}),
        };
        bench.tell_faulty(faulty_files);
        bench
    }

    /// Tells which definition files were left out, or do not do what they seem to.
    fn tell_faulty(&mut self, files: &[FileError]) {
        for error in files {
            self.notify(Severity::Warning, format!("Module definition {error}"));
        }
    }

    /// Replaces the clock that ages are told by.
    pub fn with_clock(mut self, clock: fn() -> Timestamp) -> Self {
        self.clock = clock;
        self
    }

    /// Lets threads that work for the bench call `wake` when there is something new to show.
    pub fn with_wake(mut self, wake: impl Fn() + Send + Sync + 'static) -> Self {
        self.wake = Arc::new(wake);
        self.ports.wake_with(self.wake.clone());
        self
    }

    pub fn now(&self) -> Timestamp {
        (self.clock)()
    }

    /// The guided change of what needs INIT mode, while it is under way.
    pub fn init(&self) -> Option<&InitProcedure> {
        self.init.as_ref().filter(|init| !init.is_left())
    }

    /// Modules that are reached in another way than before, since this was last asked.
    pub fn take_moves(&mut self) -> Vec<(Target, Target)> {
        std::mem::take(&mut self.moves)
    }

    pub fn catalogue(&self) -> &Catalogue {
        &self.catalogue
    }

    pub fn line(&self) -> &LineState {
        &self.line
    }

    /// Speed and format with which the line was opened last.
    pub fn settings(&self) -> LineSettings {
        self.settings
    }

    pub fn scan(&self) -> Option<&ScanState> {
        self.scan.as_ref()
    }

    pub fn is_scanning(&self) -> bool {
        matches!(self.scan, Some(ScanState::Running { .. }))
    }

    /// In the order in which they were found.
    pub fn modules(&self) -> &[Module] {
        &self.modules
    }

    pub fn module(&self, target: &Target) -> Option<&Module> {
        self.modules.iter().find(|module| module.target == *target)
    }

    pub fn shown(&self) -> Option<&Module> {
        self.shown.as_ref().and_then(|target| self.module(target))
    }

    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// What passed the line.
    pub fn traffic(&self) -> &TrafficLog {
        &self.traffic
    }

    pub fn clear_traffic(&mut self) {
        self.traffic.clear();
    }

    /// What a frame means, by the definition of the module that was found at its address.
    pub fn explain_frame(&self, frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>) -> Explanation {
        let at =
            |module: &&Module| Some(module.target.address) == frame.address && module.target.protocol == frame.protocol;
        let definition = self.modules.iter().find(at).and_then(Module::definition);
        traffic::explain_frame(frame, request, definition.map(|definition| &**definition))
    }

    /// What the user should know, oldest first.
    pub fn notices(&self) -> impl DoubleEndedIterator<Item = &Notice> {
        self.notices.iter()
    }

    fn notify(&mut self, severity: Severity, text: String) {
        self.tell(severity, text, None);
    }

    /// Tells of something that went wrong, for as long as `topic` holds.
    fn notify_of(&mut self, topic: Topic, text: String) {
        self.keep_notice(Severity::Error, topic, text, None);
    }

    fn tell(&mut self, severity: Severity, text: String, file: Option<PathBuf>) {
        self.keep_notice(severity, Topic::Other, text, file);
    }

    fn keep_notice(&mut self, severity: Severity, topic: Topic, text: String, file: Option<PathBuf>) {
        if self.notices.len() >= NOTICES_KEPT {
            self.notices.pop_front();
        }
        let (number, at) = (self.notices_told, self.now());
        self.notices_told = number.saturating_add(1);
        self.notices.push_back(Notice { number, at, severity, topic, text, file });
    }

    fn module_and_history(&mut self, target: &Target) -> Option<(&mut Module, &mut History)> {
        let module = self.modules.iter_mut().find(|module| module.target == *target)?;
        Some((module, &mut self.history))
    }

    fn module_mut(&mut self, target: &Target) -> Option<&mut Module> {
        self.modules.iter_mut().find(|module| module.target == *target)
    }
}
