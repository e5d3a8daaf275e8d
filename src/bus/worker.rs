//! The bus thread: takes commands, decides what is asked next, and tells what came of it.
//!
//! Order of urgency: writes, reads and other single requests, polls, then the scan, which also gets its turn after
//! each poll so that neither starves the other.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError};
use std::time::{Duration, Instant};

use super::dialogue::{Dialogue, Speaker};
use super::message::{BusCommand, BusEvent, ItemSet, RequestId, Statistics};
use super::scan::{Scan, ScanStep};
use super::tap::Tap;
use super::target::{LineAddress, Patience, Target};
use super::watch::{Watch, Watches};
use crate::module::{Catalogue, Definition, ReadPlan, WriteError, identify, present_options, run_action, write_item};
use crate::protocol::{Failure, LineSettings};

/// How often a lost port is tried again.
const REOPEN_EVERY: Duration = Duration::from_secs(1);
const STATISTICS_EVERY: Duration = Duration::from_millis(500);

/// A line that is open, or was and is to be taken up again.
struct OpenLine {
    address: LineAddress,
    settings: LineSettings,
    /// `None` while the port is gone.
    dialogue: Option<Dialogue>,
    reopen_at: Instant,
}

fn not_offered(id: &str, target: Target) -> WriteError {
    WriteError::NotOffered { id: id.to_owned(), protocol: target.protocol }
}

pub struct Worker {
    catalogue: Arc<Catalogue>,
    commands: Receiver<BusCommand>,
    events: SyncSender<BusEvent>,
    wake: Box<dyn Fn() + Send>,
    unannounced: bool,
    ended: bool,
    line: Option<OpenLine>,
    urgent: VecDeque<BusCommand>,
    reads: VecDeque<BusCommand>,
    watches: Watches,
    scan: Option<(RequestId, Scan)>,
    /// Which optional parts a module has, asked once.
    options: HashMap<Target, Vec<String>>,
    frames_missed: Arc<AtomicU64>,
    told: (Instant, u64),
}

impl Worker {
    pub fn new(
        catalogue: Arc<Catalogue>,
        commands: Receiver<BusCommand>,
        events: SyncSender<BusEvent>,
        wake: Box<dyn Fn() + Send>,
    ) -> Self {
        Self {
            catalogue,
            commands,
            events,
            wake,
            unannounced: false,
            ended: false,
            line: None,
            urgent: VecDeque::new(),
            reads: VecDeque::new(),
            watches: Watches::default(),
            scan: None,
            options: HashMap::new(),
            frames_missed: Arc::default(),
            told: (Instant::now(), 0),
        }
    }

    pub fn run(mut self) {
        while !self.ended {
            self.take_commands();
            self.reopen();
            if let Some(command) = self.urgent.pop_front().or_else(|| self.reads.pop_front()) {
                self.carry_out(command);
            } else if !self.poll() & !self.scan_step() {
                self.announce();
                self.wait();
            }
            self.tell_statistics();
            self.announce();
        }
    }

    /// Puts what has arrived into its queue, without waiting.
    fn take_commands(&mut self) {
        loop {
            match self.commands.try_recv() {
                Ok(command) => self.sort_in(command),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.ended = true;
                    return;
                }
            }
        }
    }

    /// Sleeps until a command comes or something is due.
    fn wait(&mut self) {
        let now = Instant::now();
        let open = self.line.as_ref().is_some_and(|line| line.dialogue.is_some());
        let poll = self.watches.next_due().filter(|_| open);
        let reopen = self.line.as_ref().filter(|line| line.dialogue.is_none()).map(|line| line.reopen_at);
        let statistics = self.statistics_due().then_some(self.told.0 + STATISTICS_EVERY);
        let until = [poll, reopen, statistics].into_iter().flatten().min();
        let received = match until {
            Some(until) => self.commands.recv_timeout(until.saturating_duration_since(now)),
            None => self.commands.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match received {
            Ok(command) => self.sort_in(command),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => self.ended = true,
        }
    }

    fn sort_in(&mut self, command: BusCommand) {
        match command {
            BusCommand::Write { .. } | BusCommand::Act { .. } => self.urgent.push_back(command),
            BusCommand::PauseScan(paused) => self.pause_scan(paused),
            BusCommand::CancelScan => self.end_scan(true),
            BusCommand::Unwatch { target } => self.watches.remove(&target),
            other => self.reads.push_back(other),
        }
    }

    fn carry_out(&mut self, command: BusCommand) {
        match command {
            BusCommand::Open { id, line, settings } => self.open(id, line, settings),
            BusCommand::Close { id } => self.close(id),
            BusCommand::Scan { id, plan } => {
                self.end_scan(true);
                self.scan = Some((id, Scan::new(plan)));
                self.tell_progress();
            }
            BusCommand::Identify { id, target } => {
                let catalogue = self.catalogue.clone();
                let result = self.dialogue().and_then(|dialogue| {
                    let mut speaker = dialogue.with(target, Patience::CONVERSATION);
                    identify(&catalogue, target.protocol, target.address, &mut speaker)
                });
                self.note_loss(result.as_ref().err().cloned());
                self.tell(BusEvent::Identified { id, target, result });
            }
            BusCommand::Read { id, target, definition, items } => self.read(id, target, &definition, &items),
            BusCommand::Watch { id, target, definition, items, interval } => {
                let plan = self.plan(target, &definition, &items);
                self.watches.add(Watch::new(id, target, plan, interval));
            }
            BusCommand::Write { id, target, definition, item, value } => {
                let result = self.change(target, &item, |speaker| {
                    let known = definition.item(&item).ok_or_else(|| not_offered(&item, target))?;
                    write_item(&definition, target.protocol, target.address, known, &value, speaker)
                });
                let at = self.timestamp();
                self.tell(BusEvent::Written { id, target, item, at, result });
            }
            BusCommand::Act { id, target, definition, action } => {
                let result = self.change(target, &action, |speaker| {
                    let known = definition.action(&action).ok_or_else(|| not_offered(&action, target))?;
                    run_action(known, target.protocol, target.address, speaker)
                });
                let at = self.timestamp();
                self.tell(BusEvent::Acted { id, target, action, at, result });
            }
            BusCommand::Raw { id, request, settings } => {
                let result = self.dialogue().and_then(|dialogue| {
                    dialogue.configure(settings)?;
                    dialogue.raw(&request, Patience::WRITE_WINDOW)
                });
                self.note_loss(result.as_ref().err().cloned());
                self.tell(BusEvent::RawAnswer { id, result });
            }
            BusCommand::PauseScan(_) | BusCommand::CancelScan | BusCommand::Unwatch { .. } => self.sort_in(command),
        }
    }

    fn open(&mut self, id: RequestId, address: LineAddress, settings: LineSettings) {
        self.forget_line();
        let line = address.to_string();
        match Dialogue::open(&address, settings, self.tap()) {
            Ok(dialogue) => {
                self.line = Some(OpenLine { address, settings, dialogue: Some(dialogue), reopen_at: Instant::now() });
                self.told = (Instant::now(), 0);
                self.tell(BusEvent::Opened { id, line });
            }
            Err(problem) => self.tell(BusEvent::OpenFailed { id, line, problem }),
        }
    }

    fn close(&mut self, id: RequestId) {
        self.forget_line();
        self.tell(BusEvent::Closed { id });
    }

    fn forget_line(&mut self) {
        self.end_scan(true);
        self.line = None;
        self.watches.clear();
        self.options.clear();
    }

    /// Frames are told as they come; when nobody takes them they are counted instead of holding up the line.
    fn tap(&self) -> Tap {
        let (events, missed) = (self.events.clone(), self.frames_missed.clone());
        Box::new(move |frame| {
            if events.try_send(BusEvent::Traffic(frame)).is_err() {
                missed.fetch_add(1, Ordering::Relaxed);
            }
        })
    }

    fn dialogue(&mut self) -> Result<&mut Dialogue, Failure> {
        let line = self.line.as_mut().ok_or_else(|| Failure::LineLost("no line is open".to_owned()))?;
        let name = &line.address;
        line.dialogue.as_mut().ok_or_else(|| Failure::LineLost(format!("{name} is not there")))
    }

    /// Lets `change` write to a module, if there is a line.
    fn change<T>(
        &mut self,
        target: Target,
        id: &str,
        change: impl FnOnce(&mut Speaker<'_>) -> Result<T, WriteError>,
    ) -> Result<T, WriteError> {
        let result = match self.dialogue() {
            Ok(dialogue) => change(&mut dialogue.with(target, Patience::CONVERSATION)),
            Err(failure) => Err(WriteError::ReadFirst { id: id.to_owned(), failure }),
        };
        let lost = result.as_ref().err().and_then(WriteError::failure).cloned();
        self.note_loss(lost);
        result
    }

    fn timestamp(&mut self) -> jiff::Timestamp {
        self.dialogue().map(|dialogue| dialogue.timestamp()).unwrap_or_else(|_| jiff::Timestamp::now())
    }

    /// What to read of `target`; asks once which optional parts it has.
    fn plan(&mut self, target: Target, definition: &Arc<Definition>, items: &ItemSet) -> ReadPlan {
        if let ItemSet::Named(ids) = items {
            return ReadPlan::new(definition, target.protocol, ids.iter().map(String::as_str));
        }
        if !self.options.contains_key(&target)
            && let Ok(dialogue) = self.dialogue()
        {
            let mut speaker = dialogue.with(target, Patience::CONVERSATION);
            let present = present_options(definition, target.protocol, &mut speaker);
            self.options.insert(target, present);
        }
        let present = self.options.get(&target).cloned().unwrap_or_default();
        let ids = match items {
            ItemSet::All => definition.readable_ids(target.protocol, &present),
            _ => definition.live_ids(target.protocol, &present),
        };
        ReadPlan::new(definition, target.protocol, ids)
    }

    fn read(&mut self, id: RequestId, target: Target, definition: &Arc<Definition>, items: &ItemSet) {
        let mut plan = self.plan(target, definition, items);
        self.read_plan(id, target, &mut plan, Patience::CONVERSATION);
    }

    fn read_plan(&mut self, id: RequestId, target: Target, plan: &mut ReadPlan, patience: Patience) {
        let values = match self.dialogue() {
            Ok(dialogue) => plan.run(target.address, &mut dialogue.with(target, patience)),
            Err(failure) => plan.all_failed(&failure),
        };
        let lost = values.iter().find_map(|(_, result)| match result {
            Err(failure @ Failure::LineLost(_)) => Some(failure.clone()),
            _ => None,
        });
        let at = self.timestamp();
        self.note_loss(lost);
        self.tell(BusEvent::Read { id, target, at, values });
    }

    /// Polls the module whose turn it is. False if none is due.
    fn poll(&mut self) -> bool {
        if self.line.as_ref().is_none_or(|line| line.dialogue.is_none()) {
            return false;
        }
        let Some(watch) = self.watches.take_due(Instant::now()) else { return false };
        let (id, target, mut plan) = (watch.id, watch.target, watch.plan.clone());
        self.read_plan(id, target, &mut plan, Patience::POLL);
        self.watches.learned(&target, plan);
        true
    }

    /// Asks at the next address of the scan. False if there is nothing to scan.
    fn scan_step(&mut self) -> bool {
        let catalogue = self.catalogue.clone();
        let Some((id, scan)) = self.scan.as_mut().filter(|(_, scan)| !scan.paused) else { return false };
        let id = *id;
        let dialogue = self.line.as_mut().and_then(|line| line.dialogue.as_mut());
        let step = dialogue.map_or(ScanStep::Ended, |dialogue| scan.step(&catalogue, dialogue));
        let over = matches!(step, ScanStep::Ended) || scan.progress().is_none();
        if let ScanStep::Found(target, identified) = step {
            self.tell(BusEvent::Found { id, target, identified: *identified });
        }
        self.tell_progress();
        if over {
            self.end_scan(false);
        }
        true
    }

    fn pause_scan(&mut self, paused: bool) {
        if let Some((_, scan)) = &mut self.scan {
            scan.paused = paused;
            self.tell_progress();
        }
    }

    fn end_scan(&mut self, cancelled: bool) {
        if let Some((id, scan)) = self.scan.take() {
            let summary = scan.end(cancelled);
            self.note_loss(summary.lost.clone().map(Failure::LineLost));
            self.tell(BusEvent::ScanEnded { id, summary });
        }
    }

    fn tell_progress(&mut self) {
        if let Some((id, scan)) = &self.scan
            && let Some(progress) = scan.progress()
        {
            let id = *id;
            self.tell(BusEvent::ScanProgress { id, progress });
        }
    }

    /// Gives the port up if the failure says that it is gone, and plans to take it up again.
    fn note_loss(&mut self, failure: Option<Failure>) {
        let Some(Failure::LineLost(reason)) = failure else { return };
        let Some(line) = self.line.as_mut().filter(|line| line.dialogue.is_some()) else { return };
        line.dialogue = None;
        line.reopen_at = Instant::now() + REOPEN_EVERY;
        self.tell(BusEvent::LineLost { reason });
    }

    fn reopen(&mut self) {
        let tap = self.tap();
        let Some(line) = &mut self.line else { return };
        if line.dialogue.is_some() || line.reopen_at > Instant::now() {
            return;
        }
        match Dialogue::open(&line.address, line.settings, tap) {
            Ok(dialogue) => {
                line.dialogue = Some(dialogue);
                self.tell(BusEvent::LineRestored);
            }
            Err(problem) => {
                log::debug!("{problem}");
                line.reopen_at = Instant::now() + REOPEN_EVERY;
            }
        }
    }

    /// Whether there are exchanges that were not told yet.
    fn statistics_due(&self) -> bool {
        let dialogue = self.line.as_ref().and_then(|line| line.dialogue.as_ref());
        dialogue.is_some_and(|dialogue| dialogue.counts().transactions != self.told.1)
    }

    fn tell_statistics(&mut self) {
        let elapsed = self.told.0.elapsed();
        if elapsed < STATISTICS_EVERY || !self.statistics_due() {
            return;
        }
        let Ok(dialogue) = self.dialogue() else { return };
        let counts = dialogue.counts();
        let since = counts.transactions.saturating_sub(self.told.1);
        self.told = (Instant::now(), counts.transactions);
        let transactions_per_second = since as f32 / elapsed.as_secs_f32();
        let frames_missed = self.frames_missed.load(Ordering::Relaxed);
        self.tell(BusEvent::Statistics(Statistics { transactions_per_second, frames_missed, ..counts }));
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
