//! What is asked of a line to learn what is wrong with it.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use crate::bench::traffic::TrafficLog;
use crate::bus::{BusCommand, BusEvent, RequestId, ScanPlan, ScanProgress, ScanSummary, Target, Tuning};
use crate::cli::line_args::LineArgs;
use crate::cli::session::Session;
use crate::cli::signals::Interrupt;
use crate::cli::terminal::TerminalLine;
use crate::cli::{Outcome, Stop};
use crate::diagnosis::{ConsistencyTest, Diagnosis, Report};
use crate::module::Identified;
use crate::protocol::{BaudRate, Failure, LineSettings};

/// How long an interrupt may remain unnoticed.
const LOOK_UP_EVERY: Duration = Duration::from_millis(50);
/// The bus thread tells of every frame; when it has been quiet for so long, it is stuck.
const LONGEST_QUIET: Duration = Duration::from_secs(60);
/// A cancelled scan ends after one question.
const LONGEST_END: Duration = Duration::from_secs(5);
/// Faster than this nobody can read.
const SHOW_EVERY: Duration = Duration::from_millis(100);

/// A line that is being looked at.
pub struct Examination {
    pub diagnosis: Diagnosis,
    pub traffic: TrafficLog,
    /// How the modules found call themselves.
    names: BTreeMap<Target, String>,
    interrupt: Interrupt,
    terminal: TerminalLine,
    tuning: Tuning,
    /// Why nothing more is asked.
    stopped: Option<String>,
}

impl Examination {
    /// Nothing was asked yet; it ends early when it is interrupted.
    pub fn new(interrupt: Interrupt, tuning: Tuning) -> Self {
        let mut diagnosis = Diagnosis::default();
        diagnosis.note_tuning(tuning);
        Self {
            diagnosis,
            traffic: TrafficLog::default(),
            names: BTreeMap::new(),
            interrupt,
            terminal: TerminalLine::new(SHOW_EVERY),
            tuning,
            stopped: None,
        }
    }

    /// What is known when nothing more is asked.
    pub fn report(&mut self, line: &str, at: Timestamp) -> Report {
        self.terminal.clear();
        let report = self.diagnosis.report(at, line, |target| self.names.get(target).cloned());
        Report { stopped_early: self.stopped.clone(), ..report }
    }

    /// Tells the user what is done now.
    pub fn tell(&mut self, text: &str) {
        self.terminal.message(text);
    }

    fn is_stopped(&mut self) -> bool {
        if self.stopped.is_none() && self.interrupt.came() {
            self.stopped = Some("it was interrupted".to_owned());
        }
        self.stopped.is_some()
    }

    /// Sends a command and takes events until `pick` makes something of one of them; `None` if it is interrupted.
    fn ask<T>(
        &mut self,
        session: &Session,
        command: impl FnOnce(RequestId) -> BusCommand,
        mut pick: impl FnMut(&mut Self, RequestId, BusEvent) -> Option<T>,
    ) -> Outcome<Option<T>> {
        if self.is_stopped() {
            return Ok(None);
        }
        let id = session.send(command)?;
        let mut heard = Instant::now();
        loop {
            match session.event(LOOK_UP_EVERY)? {
                Some(event) => {
                    heard = Instant::now();
                    if let Some(found) = self.sort(id, event, &mut pick) {
                        return Ok(Some(found));
                    }
                }
                None if heard.elapsed() > LONGEST_QUIET => {
                    return Err(Stop::failed("the line's thread does not answer any more"));
                }
                None => {}
            }
            if self.is_stopped() {
                return self.leave(session, id, pick);
            }
        }
    }

    fn sort<T>(
        &mut self,
        id: RequestId,
        event: BusEvent,
        pick: &mut impl FnMut(&mut Self, RequestId, BusEvent) -> Option<T>,
    ) -> Option<T> {
        if let BusEvent::Traffic(frame) = &event {
            self.diagnosis.take(frame);
            self.traffic.push(frame.clone());
        }
        pick(self, id, event)
    }

    /// Ends what is under way; what it brings until then counts.
    fn leave<T>(
        &mut self,
        session: &Session,
        id: RequestId,
        mut pick: impl FnMut(&mut Self, RequestId, BusEvent) -> Option<T>,
    ) -> Outcome<Option<T>> {
        session.send(|_| BusCommand::CancelScan)?;
        let until = Instant::now().checked_add(LONGEST_END);
        while until.is_some_and(|until| Instant::now() < until) {
            let Some(event) = session.event(LOOK_UP_EVERY)? else { continue };
            if let Some(found) = self.sort(id, event, &mut pick) {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// Asks at each of these until a module answers.
    pub fn find(&mut self, session: &Session, places: &[Target]) -> Outcome<Option<Target>> {
        for &target in places {
            if self.is_stopped() {
                return Ok(None);
            }
            self.tell(&format!("Looking for a module at {target}"));
            let result = self.ask(
                session,
                |id| BusCommand::Identify { id, target },
                |_, id, event| match event {
                    BusEvent::Identified { id: of, result, .. } if of == id => Some(result),
                    _ => None,
                },
            )?;
            match result {
                Some(Ok(identified)) => {
                    self.note_name(target, &identified);
                    return Ok(Some(target));
                }
                Some(Err(Failure::LineLost(reason))) => {
                    self.lose(&reason);
                    return Ok(None);
                }
                _ => {}
            }
            // Somebody is there who cannot be read: the test tells more.
            if self.diagnosis.station(&target).is_some() {
                return Ok(Some(target));
            }
        }
        self.find_slow(session, places)
    }

    /// Asks once more at each, and listens longer than the timeout: somebody may be there whose answers come too late.
    fn find_slow(&mut self, session: &Session, places: &[Target]) -> Outcome<Option<Target>> {
        for &target in places {
            let test = &mut ConsistencyTest::new(target, 1, self.tuning);
            self.read_once(session, test)?;
            if self.diagnosis.station(&target).is_some() {
                return Ok(Some(target));
            }
        }
        Ok(None)
    }

    /// Looks where modules are out of the box, and at other speeds if nobody is there.
    pub fn search(&mut self, session: &Session, line: &LineArgs) -> Outcome<Vec<Target>> {
        let base = if line.is_tcp() { ScanPlan::tcp() } else { ScanPlan::quick() };
        let settings = line.settings();
        let window = line.given_timeout().map_or(base.window, |timeout| timeout.max(base.window));
        let plan =
            ScanPlan { baud_rates: vec![settings.baud_rate], data_formats: vec![settings.data_format], window, ..base };
        self.tell(&searching(&plan, line, settings));
        let found = self.scan(session, plan.clone())?;
        if !found.is_empty() || line.is_tcp() || self.is_stopped() {
            return Ok(found);
        }
        let others: Vec<BaudRate> = BaudRate::ALL.into_iter().filter(|rate| *rate != settings.baud_rate).collect();
        let plan = ScanPlan { baud_rates: others, stop_at_first: true, ..plan };
        let seconds = plan.duration().as_secs();
        self.tell(&format!("Nothing answers at {settings}; the other speeds are tried, which takes about {seconds} s"));
        self.scan(session, plan)
    }

    /// Asks everywhere in `plan`.
    fn scan(&mut self, session: &Session, plan: ScanPlan) -> Outcome<Vec<Target>> {
        let mut found = Vec::new();
        let summary: Option<ScanSummary> = self.ask(
            session,
            |id| BusCommand::Scan { id, plan },
            |this, id, event| match event {
                BusEvent::Found { id: of, target, identified } if of == id => {
                    this.note_name(target, &identified);
                    this.tell(&format!("Found {}", this.named(&target)));
                    found.push(target);
                    None
                }
                BusEvent::ScanProgress { id: of, progress } if of == id => {
                    let ScanProgress { done, total, at, .. } = progress;
                    this.terminal.show(|| format!("{done} of {total}: {at}"));
                    None
                }
                BusEvent::ScanEnded { id: of, summary } if of == id => Some(summary),
                _ => None,
            },
        )?;
        if let Some(reason) = summary.and_then(|summary| summary.lost) {
            self.lose(&reason);
        }
        Ok(found)
    }

    /// What was heard before is told.
    fn lose(&mut self, reason: &str) {
        self.stopped.get_or_insert_with(|| format!("the line was lost ({reason})"));
    }

    fn note_name(&mut self, target: Target, identified: &Identified) {
        let label = identified.definition.as_ref().map_or("Unknown module", |definition| definition.label.as_str());
        self.names.insert(target, label.to_owned());
    }

    fn named(&self, target: &Target) -> String {
        self.names.get(target).map_or_else(|| target.to_string(), |name| format!("{name} at {target}"))
    }

    /// One read of a test. False if it was interrupted.
    fn read_once(&mut self, session: &Session, test: &mut ConsistencyTest) -> Outcome<bool> {
        let (request, settings) = (test.request(), test.target().settings);
        let answer = self.ask(
            session,
            |id| BusCommand::Raw { id, request, settings },
            |_, id, event| match event {
                BusEvent::RawAnswer { id: of, result } if of == id => Some(result),
                BusEvent::Traffic(frame) => {
                    test.take(&frame);
                    None
                }
                _ => None,
            },
        )?;
        let Some(answer) = answer else { return Ok(false) };
        if let Err(Failure::LineLost(reason)) = &answer {
            self.lose(reason);
        }
        test.answered(&answer);
        Ok(true)
    }

    /// Asks `target` the same many times.
    pub fn test(&mut self, session: &Session, target: Target, reads: u32) -> Outcome {
        if self.is_stopped() {
            return Ok(());
        }
        let mut test = ConsistencyTest::new(target, reads, self.tuning);
        let name = self.named(&target);
        self.tell(&format!("Reading the same of {name} {} times", test.progress().1));
        while !test.is_done() {
            if !self.read_once(session, &mut test)? {
                break;
            }
            let (done, wanted) = test.progress();
            self.terminal.show(|| format!("{done} of {wanted}"));
        }
        if test.progress().0 > 0 {
            self.diagnosis.note_test(test.outcome());
        }
        Ok(())
    }
}

fn searching(plan: &ScanPlan, line: &LineArgs, settings: LineSettings) -> String {
    if line.is_tcp() {
        return "Looking for a module at NetID 1".to_owned();
    }
    let places = plan.targets().len();
    format!("Looking for modules at 1 and 160 to 191, in both protocols at {settings}: {places} places")
}
