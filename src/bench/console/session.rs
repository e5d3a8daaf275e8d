//! What runs on a module's console: single commands, one that repeats, and a script. The bench sends what is due.

use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::command::RawCommand;
use super::exchange::{ExchangeLog, RepeatPlan};
use super::script::Script;
use super::script_run::{ScriptRun, Step};
use crate::bench::Bench;
use crate::bus::{BusCommand, Direction, RequestId, Target};
use crate::protocol::Failure;

/// How far back the frames of an answer are looked for.
const FRAMES_LOOKED_AT: usize = 64;

/// What was sent to a module as it was typed, and what goes on sending.
#[derive(Debug, Clone, Default)]
pub struct Console {
    log: ExchangeLog,
    repeating: Option<Repeating>,
    running: Option<Running>,
}

/// A command that repeats.
#[derive(Debug, Clone)]
pub struct Repeating {
    pub plan: RepeatPlan,
    /// The request that is under way.
    awaited: Option<RequestId>,
    /// It sends no more; its counts stay to be seen.
    stopped: bool,
}

/// A script, under way or at its end.
#[derive(Debug, Clone)]
pub struct Running {
    pub run: ScriptRun,
    awaited: Option<RequestId>,
    /// How it ended: `Err` with the line, 1-based, and the reason. `None` while it runs.
    pub ended: Option<Result<(), (usize, String)>>,
}

/// Something to send for a module.
struct Due {
    command: RawCommand,
    /// The line of the script that wants it; a repetition has none.
    line: Option<usize>,
    for_script: bool,
}

impl Console {
    /// What was sent, oldest first.
    pub fn log(&self) -> &ExchangeLog {
        &self.log
    }

    /// The command that repeats, or the last that did.
    pub fn repeating(&self) -> Option<&Repeating> {
        self.repeating.as_ref()
    }

    /// The script that runs, or the last that did.
    pub fn running(&self) -> Option<&Running> {
        self.running.as_ref()
    }

    pub fn is_repeating(&self) -> bool {
        self.repeating.as_ref().is_some_and(|repeating| !repeating.stopped)
    }

    pub fn is_running(&self) -> bool {
        self.running.as_ref().is_some_and(|running| running.ended.is_none())
    }

    pub(in crate::bench) fn repeat(&mut self, command: RawCommand, period: Duration) {
        self.repeating = Some(Repeating { plan: RepeatPlan::new(command, period), awaited: None, stopped: false });
    }

    pub(in crate::bench) fn run(&mut self, script: Script, checksum: bool) {
        self.running = Some(Running { run: ScriptRun::new(script, checksum), awaited: None, ended: None });
    }

    /// Ends what repeats and what runs; answers that are under way are still taken.
    pub(in crate::bench) fn stop(&mut self) {
        if let Some(repeating) = &mut self.repeating {
            repeating.stopped = true;
        }
        self.end_script("it was stopped");
    }

    pub(in crate::bench) fn clear(&mut self) {
        self.log.clear();
    }

    /// Nothing is answered any more.
    pub(in crate::bench) fn line_closed(&mut self) {
        self.stop();
        self.log.give_up(&Failure::LineLost("it was closed".to_owned()));
    }

    fn end_script(&mut self, reason: &str) {
        if let Some(running) = self.running.as_mut().filter(|running| running.ended.is_none()) {
            let line = running.run.current_line().unwrap_or_default();
            running.ended = Some(Err((line, reason.to_owned())));
        }
    }

    /// What has to be sent at `now`, and when to look again.
    fn due(&mut self, now: Instant) -> (Vec<Due>, Option<Instant>) {
        let (mut due, mut again) = (Vec::new(), None);
        if let Some(repeating) = self.repeating.as_mut().filter(|repeating| !repeating.stopped) {
            if repeating.plan.due(now) {
                due.push(Due { command: repeating.plan.command.clone(), line: None, for_script: false });
            } else {
                again = repeating.plan.next_at();
            }
        }
        let (step, wake) = self.script_step(now);
        due.extend(step);
        (due, [again, wake].into_iter().flatten().min())
    }

    fn script_step(&mut self, now: Instant) -> (Option<Due>, Option<Instant>) {
        let Some(running) = self.running.as_mut().filter(|running| running.ended.is_none()) else {
            return (None, None);
        };
        let met = running.run.met();
        let step = running.run.next(now);
        if running.run.met() > met {
            self.log.judge(Ok(()));
        }
        match step {
            Step::Send(command) => {
                let line = running.run.current_line();
                (Some(Due { command, line, for_script: true }), None)
            }
            Step::WaitUntil(until) => (None, Some(until)),
            Step::WaitForAnswer => (None, None),
            Step::Done => {
                running.ended = Some(Ok(()));
                (None, None)
            }
            Step::Failed { line, reason } => {
                self.log.judge(Err(format!("line {line}: {reason}")));
                running.ended = Some(Err((line, reason)));
                (None, None)
            }
        }
    }

    fn note_sent(&mut self, id: RequestId, at: Timestamp, now: Instant, due: Due) {
        if due.for_script {
            self.log.sent_by_script(id, at, due.command, due.line);
            if let Some(running) = &mut self.running {
                running.awaited = Some(id);
            }
        } else {
            self.log.sent(id, at, due.command);
            if let Some(repeating) = &mut self.repeating {
                repeating.plan.note_sent(now);
                repeating.awaited = Some(id);
            }
        }
    }

    fn answered(&mut self, id: RequestId, at: Timestamp, result: Result<Vec<u8>, Failure>) {
        if let Some(repeating) = self.repeating.as_mut().filter(|repeating| repeating.awaited == Some(id)) {
            repeating.awaited = None;
            repeating.plan.note_answered(&result);
            // The line is taken up again by itself; what was sent to it before may not be wanted any more.
            repeating.stopped |= matches!(result, Err(Failure::LineLost(_) | Failure::NotOffered(_)));
        }
        if let Some(running) = self.running.as_mut().filter(|running| running.awaited == Some(id)) {
            running.awaited = None;
            running.run.answered(result.clone());
        }
        self.log.answered(id, at, result);
    }
}

impl Bench {
    /// Sends what repeats and what scripts want at `now`. Returns when it wants to be called again; an answer that comes
    /// earlier is a reason too.
    pub fn tick(&mut self, now: Instant) -> Option<Instant> {
        if self.changing_line.is_some() || !self.line.is_open() {
            return None;
        }
        let mut again: Option<Instant> = None;
        let targets: Vec<Target> = self.modules.iter().map(|module| module.target).collect();
        for target in targets {
            let Some(module) = self.module_mut(&target) else { continue };
            let (due, wake) = module.console.due(now);
            again = again.into_iter().chain(wake).min();
            for one in due {
                self.send_due(target, now, one);
            }
        }
        again
    }

    fn send_due(&mut self, target: Target, now: Instant, due: Due) {
        let (id, at) = (self.bus.next_id(), self.now());
        let request = due.command.clone().into();
        if let Some(module) = self.module_mut(&target) {
            module.console.note_sent(id, at, now, due);
        }
        if !self.try_send(BusCommand::Raw { id, request, settings: target.settings }) {
            self.raw_answer(id, Err(not_taken()));
        }
    }

    pub(in crate::bench) fn send_raw(&mut self, target: Target, command: RawCommand) {
        let (id, at) = (self.bus.next_id(), self.now());
        let request = command.clone().into();
        let Some(module) = self.module_mut(&target) else { return };
        module.console.log.sent(id, at, command);
        if !self.try_send(BusCommand::Raw { id, request, settings: target.settings }) {
            self.raw_answer(id, Err(not_taken()));
        }
    }

    /// The answer to request `id`, of whichever module it was sent to.
    pub(in crate::bench) fn raw_answer(&mut self, id: RequestId, result: Result<Vec<u8>, Failure>) {
        let of = |module: &&super::super::Module| module.console.log.waiting(id).is_some();
        let Some(module) = self.modules.iter().find(of) else { return };
        let (target, sent) = (module.target, module.console.log.waiting(id).map(|exchange| exchange.sent.clone()));
        let times = sent.and_then(|sent| self.times_of(&sent));
        let now = self.now();
        let Some(module) = self.module_mut(&target) else { return };
        let answered_at = match times {
            Some((sent_at, received_at)) => {
                module.console.log.correct_time(id, sent_at);
                received_at.unwrap_or_else(|| now.max(sent_at))
            }
            None => now,
        };
        module.console.answered(id, answered_at, result);
    }

    /// When the last frame that `sent` became went out, and when the answer behind it had arrived.
    fn times_of(&self, sent: &RawCommand) -> Option<(Timestamp, Option<Timestamp>)> {
        let wire = sent.on_wire();
        let is_it = |bytes: &[u8]| match sent {
            RawCommand::Modbus { bytes: body } => bytes == wire || bytes.ends_with(body),
            RawCommand::Dcon { .. } => bytes == wire,
        };
        let mut answer = None;
        for frame in self.traffic.iter().rev().take(FRAMES_LOOKED_AT) {
            match frame.direction {
                Direction::Sent if is_it(frame.bytes) => return Some((frame.at, answer)),
                Direction::Sent => answer = None,
                Direction::Received => answer = Some(frame.at),
            }
        }
        None
    }
}

fn not_taken() -> Failure {
    Failure::NotOffered("the command was not taken, see the notices".to_owned())
}
