//! A conversation with the modules of one line, in whichever protocol each of them speaks.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use jiff::Timestamp;
use tokio::runtime::Runtime;

use super::codec;
use super::judge::{Content, Expected};
use super::line::LineLost;
use super::message::{RawRequest, Statistics};
use super::name::Name;
use super::problem::{LineProblem, ProblemKind};
use super::serial::SerialLine;
use super::tap::{Clock, Tap};
use super::target::{LineAddress, Patience, Target};
use super::tcp::TcpLink;
use super::transaction::{Debts, Wire};
use crate::module::Ask;
use crate::protocol::{AnswerFrom, Failure, LineSettings, Protocol, Query, Reply, dcon, modbus};

/// What stays known of a line that was lost.
pub struct Memory {
    clock: Option<Clock>,
    echoes: bool,
    counts: Statistics,
    names: HashMap<Target, Name>,
    /// Answers that may still come.
    debts: Option<Debts>,
}

/// An open line.
pub struct Dialogue {
    pub(super) link: Link,
    pub(super) runtime: Runtime,
    counts: Statistics,
    /// What DCON modules answered when they were asked for their name.
    pub(super) names: HashMap<Target, Name>,
    /// Set by somebody who wants a scan to end at once.
    hurry: Arc<AtomicBool>,
}

pub(super) enum Link {
    Wire(Box<Wire>),
    Tcp(Box<TcpLink>),
}

impl Dialogue {
    pub fn open(address: &LineAddress, settings: LineSettings, tap: Tap) -> Result<Self, LineProblem> {
        let other = |reason: String| LineProblem { line: address.to_string(), kind: ProblemKind::Other(reason) };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| other(error.to_string()))?;
        let wire = |line, tap| match Wire::new(line, settings, tap) {
            Ok(wire) => Ok(Link::Wire(Box::new(wire))),
            Err(LineLost { reason }) => Err(other(reason)),
        };
        let link = match address {
            LineAddress::Serial { port } => wire(Box::new(SerialLine::open(port, settings)?), tap)?,
            LineAddress::Simulated { sim, .. } => wire(Box::new(sim.line()), tap)?,
            LineAddress::Tcp { host, port } => {
                let link = TcpLink::connect(&runtime, host, *port, tap);
                let not_reached =
                    |reason| LineProblem { line: address.to_string(), kind: ProblemKind::NotReached(reason) };
                Link::Tcp(Box::new(link.map_err(not_reached)?))
            }
        };
        Ok(Self { link, runtime, counts: Statistics::default(), names: HashMap::new(), hurry: Arc::default() })
    }

    /// For someone who has a line already.
    pub fn on_wire(wire: Wire) -> std::io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let link = Link::Wire(Box::new(wire));
        Ok(Self { link, runtime, counts: Statistics::default(), names: HashMap::new(), hurry: Arc::default() })
    }

    /// What is to be remembered when the line is opened anew: its counts, whether it echoes, and its clock, which goes on
    /// even if the system's clock was set meanwhile.
    pub fn into_memory(self) -> Memory {
        let (counts, names) = (self.counts, self.names);
        match self.link {
            Link::Wire(wire) => {
                let (clock, echoes) = (Some(wire.clock()), wire.echoes());
                Memory { clock, echoes, counts, names, debts: Some(wire.into_debts()) }
            }
            Link::Tcp(_) => Memory { clock: None, echoes: false, counts, names, debts: None },
        }
    }

    pub fn remember(&mut self, memory: Memory) {
        self.counts = memory.counts;
        self.names = memory.names;
        if let Link::Wire(wire) = &mut self.link {
            wire.expect_echoes(memory.echoes);
            if let Some(clock) = memory.clock {
                wire.keep_clock(clock);
            }
            if let Some(debts) = memory.debts {
                wire.keep_debts(debts);
            }
        }
    }

    /// Questions of a scan are not asked any more while `hurry` is set.
    pub fn stop_scans_by(&mut self, hurry: Arc<AtomicBool>) {
        if let Link::Wire(wire) = &mut self.link {
            wire.hurry_by(hurry.clone());
        }
        self.hurry = hurry;
    }

    pub(super) fn is_in_a_hurry(&self) -> bool {
        self.hurry.load(Ordering::Relaxed)
    }

    /// Stamps nothing earlier than `floor` from now on, whatever the system's clock shows.
    pub fn not_before(&mut self, floor: Timestamp) {
        match &mut self.link {
            Link::Wire(wire) => wire.not_before(floor),
            Link::Tcp(link) => link.not_before(floor),
        }
    }

    /// Whether the port is still there. A network line tells only when it is used.
    pub fn look(&mut self) -> Result<(), Failure> {
        match &mut self.link {
            Link::Wire(wire) => Ok(wire.look()?),
            Link::Tcp(_) => Ok(()),
        }
    }

    /// UTC by the line's clock.
    pub fn timestamp(&self) -> Timestamp {
        match &self.link {
            Link::Wire(wire) => wire.timestamp(),
            Link::Tcp(link) => link.timestamp(),
        }
    }

    /// When the last byte of the last answer had arrived, or when the wait for it was given up.
    fn answered_at(&self) -> Timestamp {
        match &self.link {
            Link::Wire(wire) => wire.ended_at(),
            Link::Tcp(link) => link.ended_at(),
        }
    }

    /// The line's clock.
    pub fn now(&self) -> Instant {
        match &self.link {
            Link::Wire(wire) => wire.now(),
            Link::Tcp(_) => Instant::now(),
        }
    }

    /// Counts since the line was opened; rates are left to whoever measures time.
    pub fn counts(&self) -> Statistics {
        let mut counts = self.counts.clone();
        match &self.link {
            Link::Wire(wire) => {
                counts.answer_time = wire.answer_time();
                counts.echo = wire.echoes();
            }
            Link::Tcp(link) => counts.answer_time = link.answer_time(),
        }
        counts
    }

    /// Someone to ask questions of one module.
    pub fn with(&mut self, target: Target, patience: Patience) -> Speaker<'_> {
        Speaker { dialogue: self, target, patience, counted: true, changed_settings: false, is_there: true }
    }

    /// Speed and format for what follows. True if they were others before.
    pub fn configure(&mut self, settings: LineSettings) -> Result<bool, Failure> {
        match &mut self.link {
            Link::Wire(wire) => Ok(wire.configure(settings)?),
            Link::Tcp(_) => Ok(false),
        }
    }

    /// Sends bytes once and returns the verified answer, also one that refuses; empty where nobody answers.
    pub fn raw(&mut self, request: &RawRequest, window: Duration) -> Result<Vec<u8>, Failure> {
        let outcome = match (&mut self.link, request) {
            (Link::Wire(wire), request) => {
                let (frame, expected) = raw_frame(request);
                wire.exchange(&frame, &expected, window)
            }
            (Link::Tcp(link), RawRequest::Modbus { bytes }) => link.raw(&self.runtime, bytes, window),
            (Link::Tcp(_), RawRequest::Dcon { .. }) => {
                return Err(Failure::NotOffered("DCON commands are for serial lines".to_owned()));
            }
        };
        self.count(outcome.as_ref().err());
        outcome
    }

    /// One exchange, no repetition.
    fn once(&mut self, target: &Target, query: &Query, window: Duration) -> Result<Reply, Failure> {
        self.come_into_step(target, query, window).map_err(|failure| match query.is_write() {
            true => failure.kept_back(),
            false => failure,
        })?;
        match (&mut self.link, target.protocol) {
            (Link::Tcp(link), _) => link.ask(&self.runtime, target.address, query, window),
            (Link::Wire(_), Protocol::ModbusTcp) => {
                Err(Failure::NotOffered("Modbus TCP needs a network line".to_owned()))
            }
            (Link::Wire(wire), Protocol::Dcon) => {
                let (request, expected) = dcon_frame(query, target.checksum)?;
                let answer = wire.exchange(&request, &expected, window)?;
                self.note_name(target, query, &answer);
                dcon_reply(answer, &expected)
            }
            (Link::Wire(wire), Protocol::ModbusRtu) => {
                let expected = Expected::Rtu { address: target.address };
                codec::transact(&self.runtime, target.address, query, |frame| wire.exchange(frame, &expected, window))
            }
        }
    }

    fn count(&mut self, failure: Option<&Failure>) {
        self.counts.transactions = self.counts.transactions.saturating_add(1);
        let Some(failure) = failure.filter(|failure| !failure.is_refusal()) else { return };
        self.counts.errors = self.counts.errors.saturating_add(1);
        let kind = match failure.root() {
            Failure::Silent => "no answer",
            Failure::Cut { .. } => "cut short",
            Failure::Collision { .. } => "collision",
            Failure::UnknownShape { .. } => "unknown shape",
            Failure::LineLost(_) => "line lost",
            _ => "garbled",
        };
        let count = self.counts.kinds.entry(kind).or_default();
        *count = count.saturating_add(1);
    }
}

/// The bytes of a serial line and what may come back on them.
fn raw_frame(request: &RawRequest) -> (Vec<u8>, Expected) {
    match request {
        RawRequest::Dcon { text, checksum } => {
            let from = if text.contains("**") { AnswerFrom::Nobody } else { AnswerFrom::Anyone };
            (dcon::encode(text, *checksum), dcon_expected(*checksum, &from))
        }
        RawRequest::Modbus { bytes } => {
            let address = bytes.first().copied().unwrap_or_default();
            let expected = match address {
                0 => Expected::Nothing { protocol: Protocol::ModbusRtu, checksum: false },
                address => Expected::Rtu { address },
            };
            (modbus::with_crc(bytes), expected)
        }
    }
}

fn dcon_expected(checksum: bool, from: &AnswerFrom) -> Expected {
    match from {
        AnswerFrom::Nobody => Expected::Nothing { protocol: Protocol::Dcon, checksum },
        from => Expected::Dcon { checksum, from: from.clone(), content: Content::Any },
    }
}

fn dcon_frame(query: &Query, checksum: bool) -> Result<(Vec<u8>, Expected), Failure> {
    match query {
        Query::Dcon { text, from, .. } => Ok((dcon::encode(text, checksum), dcon_expected(checksum, from))),
        _ => Err(Failure::NotOffered("this is not offered over DCON".to_owned())),
    }
}

fn dcon_reply(answer: Vec<u8>, expected: &Expected) -> Result<Reply, Failure> {
    let Expected::Dcon { checksum, .. } = expected else { return Ok(Reply::Done) };
    match dcon::decode(&answer, *checksum) {
        Ok(dcon::Answer::Refused { text }) => Err(Failure::Refused { answer: format!("?{text}") }),
        Ok(dcon::Answer::Ignored) => Err(Failure::Ignored),
        Ok(answer) => Ok(Reply::Text(answer.to_text())),
        Err(error) => Err(Failure::Garbled { reason: error.to_string(), bytes: answer }),
    }
}

/// Asks questions of one module.
pub struct Speaker<'a> {
    dialogue: &'a mut Dialogue,
    target: Target,
    patience: Patience,
    counted: bool,
    changed_settings: bool,
    /// The module has shown that it is there.
    is_there: bool,
}

impl Speaker<'_> {
    /// For scans: leaves failures out of the error statistics, as silence is expected, and ends when it is told to. Once
    /// the module has answered it is asked as patiently as one that is known.
    pub fn uncounted(mut self) -> Self {
        self.counted = false;
        self.is_there = false;
        self
    }

    /// Whether the module has shown that it is there.
    pub fn is_there(&self) -> bool {
        self.is_there
    }

    /// Whether to ask once more, after so many repetitions.
    fn repeats(&self, query: &Query, failure: &Failure, repeated: u8) -> bool {
        // Somebody waits for a scan, or the line, to end.
        if query.is_write() || self.dialogue.is_in_a_hurry() {
            return false;
        }
        match failure {
            Failure::Silent => {
                let more = if self.changed_settings { self.patience.after_change } else { 0 };
                repeated < self.patience.after_silence.saturating_add(more)
            }
            failure if failure.is_garbage() => repeated < self.patience.after_garbage,
            _ => false,
        }
    }
}

impl Ask for Speaker<'_> {
    fn answered_at(&self) -> Timestamp {
        self.dialogue.answered_at()
    }

    fn certain(&mut self) -> Result<(), Failure> {
        self.dialogue.verify(&self.target, self.patience)
    }

    fn follow(&mut self, address: u8) {
        self.target.address = address;
    }

    fn ask(&mut self, query: &Query) -> Result<Reply, Failure> {
        if self.target.protocol != Protocol::ModbusTcp {
            self.changed_settings |= self.dialogue.configure(self.target.settings)?;
        }
        let mut repeated = 0u8;
        let window = if query.is_write() { Patience::WRITE_WINDOW } else { self.patience.window };
        loop {
            if !self.counted && self.dialogue.is_in_a_hurry() {
                return Err(Failure::Silent);
            }
            let outcome = self.dialogue.once(&self.target, query, window);
            self.dialogue.count(outcome.as_ref().err().filter(|_| self.counted));
            let answered = outcome.as_ref().map_or_else(Failure::shows_presence, |_| true);
            if answered && !std::mem::replace(&mut self.is_there, true) {
                let Patience { window, after_silence, after_garbage, .. } = Patience::CONVERSATION;
                self.patience = Patience {
                    window: window.max(self.patience.window),
                    after_silence,
                    after_garbage,
                    ..self.patience
                };
            }
            let Err(failure) = &outcome else {
                self.changed_settings = false;
                return outcome;
            };
            if !self.repeats(query, failure, repeated) {
                self.changed_settings = false;
                return outcome;
            }
            repeated = repeated.saturating_add(1);
            self.dialogue.counts.repeats = self.dialogue.counts.repeats.saturating_add(1);
        }
    }
}
