//! The bus thread: takes commands, decides what is asked next, and tells what came of it.
//!
//! Order of urgency: writes, actions that are repeated, then reads and other single requests, then polls, then the scan, which gets its turn after
//! each poll so that neither starves the other. Between any two questions of a read or poll, commands are looked at
//! again, so that a write waits for one exchange at most.

mod link;
mod queue;
mod raw;
mod requests;
mod scanning;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError};
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::message::{BusCommand, BusEvent, RequestId};
use super::ports::ListPorts;
use super::repeat::Repeats;
use super::scan::Scan;
use super::target::{Patience, Target, Tuning};
use super::watch::Watches;
use crate::module::Catalogue;
use link::OpenLine;
use queue::Queue;
use requests::Reading;

/// How often an open line that nobody uses is looked at, so that a pulled adapter is noticed.
const LOOK_EVERY: Duration = Duration::from_secs(1);

pub struct Worker {
    catalogue: Arc<Catalogue>,
    commands: Receiver<BusCommand>,
    events: SyncSender<BusEvent>,
    wake: Box<dyn Fn() + Send>,
    unannounced: bool,
    tuning: Tuning,
    list_ports: ListPorts,
    /// Set from outside when a scan is to end at once.
    hurry: Arc<AtomicBool>,
    ended: bool,
    line: Option<OpenLine>,
    queue: Queue,
    /// The read or poll under way.
    reading: Option<Reading>,
    watches: Watches,
    repeats: Repeats,
    /// The last thing that was done was a repetition.
    has_repeated: bool,
    scan: Option<(RequestId, Scan)>,
    /// The latest time that was told; no line may begin before it.
    latest: Timestamp,
    /// Which optional parts a module has, asked once.
    options: HashMap<Target, Vec<String>>,
    /// Modules that said what they are since the line was opened, with their model; only these are written to.
    identified: HashSet<(Target, String)>,
}

impl Worker {
    pub fn new(
        catalogue: Arc<Catalogue>,
        commands: Receiver<BusCommand>,
        events: SyncSender<BusEvent>,
        wake: Box<dyn Fn() + Send>,
        list_ports: ListPorts,
        hurry: Arc<AtomicBool>,
    ) -> Self {
        Self {
            catalogue,
            commands,
            events,
            wake,
            unannounced: false,
            tuning: Tuning::default(),
            list_ports,
            hurry,
            ended: false,
            line: None,
            queue: Queue::default(),
            reading: None,
            watches: Watches::default(),
            repeats: Repeats::default(),
            has_repeated: false,
            scan: None,
            latest: Timestamp::MIN,
            options: HashMap::new(),
            identified: HashSet::new(),
        }
    }

    pub fn run(mut self) {
        while !self.ended {
            self.take_commands();
            self.reopen();
            if !self.work() {
                self.announce();
                self.wait();
            }
            self.tell_statistics();
            self.announce();
        }
    }

    /// Does the most urgent thing that there is to do. False if there is none.
    fn work(&mut self) -> bool {
        if let Some(command) = self.queue.urgent() {
            self.carry_out(command);
            return true;
        }
        // One that takes longer than its period leaves the line to others in between.
        let repeats_first = !std::mem::take(&mut self.has_repeated);
        if repeats_first && self.repeat() {
            self.has_repeated = true;
            return true;
        }
        self.read_or_scan() || self.repeat()
    }

    fn read_or_scan(&mut self) -> bool {
        if self.reading.is_some() {
            self.read_on();
            return true;
        }
        if let Some(command) = self.queue.next() {
            self.carry_out(command);
            return true;
        }
        self.scan_step() | self.poll()
    }

    /// Puts what has arrived into the queue, without waiting.
    fn take_commands(&mut self) {
        loop {
            match self.commands.try_recv() {
                Ok(command) => self.take(command),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.ended = true;
                    return;
                }
            }
        }
    }

    fn take(&mut self, command: BusCommand) {
        match command {
            BusCommand::CancelScan => {
                self.hurry.store(false, Ordering::Relaxed);
                self.cancel_scans();
            }
            BusCommand::Unwatch { target } => self.unwatch(&target),
            BusCommand::StopRepeating { target, action } => self.stop_repeating(&target, &action),
            command @ (BusCommand::Open { .. } | BusCommand::Close { .. }) => {
                self.abandon_reads();
                self.queue.push(command);
            }
            BusCommand::PauseScan(paused) if !self.queue.has_scan() => self.pause_scan(paused),
            other => self.queue.push(other),
        }
    }

    /// Sleeps until a command comes or something is due.
    fn wait(&mut self) {
        let open = self.line.as_ref().is_some_and(OpenLine::is_there);
        let (now, line_time) = (Instant::now(), self.line_time());
        let poll = self.watches.next_due().filter(|_| open).map(|due| due.saturating_duration_since(line_time));
        let repeat = self.repeats.next_due().filter(|_| open);
        let look = self.line.as_ref().map(OpenLine::next_look);
        let others = [repeat, look].map(|due| Some(due?.saturating_duration_since(now)));
        let received = match others.into_iter().chain([poll]).flatten().min() {
            Some(left) => self.commands.recv_timeout(left),
            None => self.commands.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match received {
            Ok(command) => self.take(command),
            Err(RecvTimeoutError::Timeout) => self.look_at_line(),
            Err(RecvTimeoutError::Disconnected) => self.ended = true,
        }
    }

    /// For a module that is known to be there.
    fn patience(&self) -> Patience {
        Patience::of(self.tuning)
    }

    fn tell(&mut self, event: BusEvent) {
        self.unannounced = true;
        if self.events.send(event).is_err() {
            self.ended = true;
        }
    }

    fn announce(&mut self) {
        if std::mem::take(&mut self.unannounced) {
            (self.wake)();
        }
    }
}
