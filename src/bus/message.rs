//! What crosses the boundary between the bus thread and everyone else.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

use super::problem::{LineProblem, Obstacle};
use super::scan::{ScanPlan, ScanProgress, ScanSummary};
use super::tap::Frame;
use super::target::{LineAddress, Target, Tuning};
use crate::module::{Catalogue, Definition, Identified, Value, WriteError};
use crate::protocol::{Failure, LineSettings};

pub use crate::module::Answer;

/// Names a request; its answers carry it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RequestId(pub u64);

/// What a read or poll brought, item by item, each with its own time and the reason where there is no value.
pub type Values = Vec<Answer>;

/// Which items of a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ItemSet {
    /// All that the protocol offers and the module has, except those whose reading changes something.
    All,
    /// Those that are polled while a module is watched.
    Live,
    /// These, by id.
    Named(Vec<String>),
}

/// What a raw exchange sends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RawRequest {
    /// A DCON command; checksum and CR are added.
    Dcon { text: String, checksum: bool },
    /// Address, function and data of a Modbus request. A serial line adds the CRC, a network line its header.
    Modbus { bytes: Vec<u8> },
}

/// Asks the bus thread to do something. Every command is answered by the event named with it.
#[derive(Debug, Clone)]
pub enum BusCommand {
    /// Opens a line, closing the one that was open. → [`BusEvent::Opened`] or [`BusEvent::OpenFailed`]
    Open { id: RequestId, line: LineAddress, settings: LineSettings },
    /// Closes the line; what was watched is forgotten. → [`BusEvent::Closed`]
    Close { id: RequestId },
    /// Searches for modules. → [`BusEvent::Found`] for each, [`BusEvent::ScanProgress`], [`BusEvent::ScanEnded`]
    Scan { id: RequestId, plan: ScanPlan },
    /// Holds the running scan, or goes on with it. → [`BusEvent::ScanProgress`]
    PauseScan(bool),
    /// Ends the running scan; what was found stays. → [`BusEvent::ScanEnded`]
    CancelScan,
    /// How patient the line is from now on, and those that are opened later. No event follows.
    Tune(Tuning),
    /// Knows these models from now on. No event follows.
    Know(Arc<Catalogue>),
    /// Asks one module what it is, with reads only. → [`BusEvent::Identified`]
    Identify { id: RequestId, target: Target },
    /// Reads items once. → [`BusEvent::Read`]
    Read { id: RequestId, target: Target, definition: Arc<Definition>, items: ItemSet },
    /// Writes one value and reads it back; never repeated. → [`BusEvent::Written`]
    Write { id: RequestId, target: Target, definition: Arc<Definition>, item: String, value: Value },
    /// Carries out an action once. → [`BusEvent::Acted`]
    Act { id: RequestId, target: Target, definition: Arc<Definition>, action: String },
    /// Carries out an action now and again and again, such as Host OK; an earlier repetition of the same action of the
    /// same module ends. → [`BusEvent::Acted`] each time
    Repeat { id: RequestId, target: Target, definition: Arc<Definition>, action: String, period: Duration },
    /// Ends a repetition. No event follows but those under way.
    StopRepeating { target: Target, action: String },
    /// Sends bytes as they are, once. → [`BusEvent::RawAnswer`]
    Raw { id: RequestId, request: RawRequest, settings: LineSettings },
    /// Reads items again and again; an interval of zero means as fast as the line allows. Polls that were missed are not
    /// caught up. A module that stays silent is asked ever more rarely, but once in 10 s at least, or at its interval if
    /// that is longer. → [`BusEvent::Read`] each time, and [`BusEvent::Reading`] while one takes longer
    Watch { id: RequestId, target: Target, definition: Arc<Definition>, items: ItemSet, interval: Duration },
    /// Ends a watch. No event follows but those under way.
    Unwatch { target: Target },
}

/// Tells what happened on the bus.
#[derive(Debug, Clone)]
pub enum BusEvent {
    Opened {
        id: RequestId,
        line: String,
    },
    OpenFailed {
        id: RequestId,
        line: String,
        problem: LineProblem,
    },
    Closed {
        id: RequestId,
    },
    /// The port vanished while it was open; the thread keeps trying to take it up again.
    LineLost {
        reason: String,
    },
    /// The lost line's adapter is there, but the line cannot be taken up; told when the reason changes.
    StillLost {
        obstacle: Obstacle,
    },
    /// The port is there again, with its settings; perhaps under another name.
    LineRestored {
        line: LineAddress,
    },
    ScanProgress {
        id: RequestId,
        progress: ScanProgress,
    },
    /// A module answered the scan.
    Found {
        id: RequestId,
        target: Target,
        identified: Identified,
    },
    ScanEnded {
        id: RequestId,
        summary: ScanSummary,
    },
    /// Which optional parts a module has, asked once: before all its items are read, or when it has answered a poll.
    Parts {
        target: Target,
        present: Vec<String>,
    },
    Identified {
        id: RequestId,
        target: Target,
        result: Result<Identified, Failure>,
    },
    /// `at` is the end of the whole read; each value has its own time.
    Read {
        id: RequestId,
        target: Target,
        at: Timestamp,
        values: Values,
    },
    /// Values that a poll which takes longer has brought so far; the poll's [`BusEvent::Read`] tells them again.
    Reading {
        id: RequestId,
        target: Target,
        values: Values,
    },
    Written {
        id: RequestId,
        target: Target,
        item: String,
        at: Timestamp,
        result: Result<Value, WriteError>,
    },
    Acted {
        id: RequestId,
        target: Target,
        action: String,
        at: Timestamp,
        result: Result<(), WriteError>,
    },
    /// The answer's bytes as they were verified, refusals included: a DCON answer with its checksum and without its CR,
    /// a Modbus answer from its address on, with its CRC from a serial line. Empty for a broadcast.
    RawAnswer {
        id: RequestId,
        result: Result<Vec<u8>, Failure>,
    },
    /// Bytes passed the tap.
    Traffic(Frame),
    Statistics(Statistics),
}

/// Counts since the line was opened.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statistics {
    pub transactions: u64,
    /// Answers missing or unusable, scans not counted.
    pub errors: u64,
    /// Reads that were asked again.
    pub repeats: u64,
    /// Over the last second or so.
    pub transactions_per_second: f32,
    /// From the end of the last answered request to the answer's first byte.
    pub answer_time: Option<Duration>,
    /// The adapter sends back what is sent.
    pub echo: bool,
    /// Frames that nobody took from the channel in time.
    pub frames_missed: u64,
    /// Errors by kind, for a person.
    pub kinds: BTreeMap<&'static str, u64>,
}
