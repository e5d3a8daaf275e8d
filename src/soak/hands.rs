//! A user at work while the line is bad: scans that are cancelled, and settings that are written.

use std::time::{Duration, Instant};

use super::ear::Ear;
use super::limits::{MOST_CANCEL, MOST_WRITE};
use super::line::Line;
use super::program::Program;
use crate::bench::{Action, EditState};
use crate::bus::{ScanPlan, Target};
use crate::protocol::Protocol;
use crate::sim::{FaultKind, Faults, Sim, Strength};

/// A setting that has no influence on what is polled, in milliseconds.
const ITEM: &str = "pir_active_delay";
const VALUES: std::ops::Range<u16> = 1..3_000;
/// A scan goes on for so long before it is cancelled.
const SCAN_FOR: Duration = Duration::from_millis(300);
/// Where nobody is.
const NOBODY: std::ops::RangeInclusive<u8> = 200..=247;

/// What came of it.
#[derive(Debug, Clone, Default)]
pub struct Done {
    pub scans: u64,
    pub longest_cancel: Duration,
    pub writes: u64,
    pub taken: u64,
    pub refused: u64,
    /// Said not to be known.
    pub unknown: u64,
    pub longest_write: Duration,
    /// Writes that the module heard more than once.
    pub doubled: u64,
    /// What must not be, in words.
    pub failures: Vec<String>,
}

enum Scan {
    Running(Instant),
    Cancelled(Instant),
}

struct Write {
    target: Target,
    value: String,
    began: Instant,
    /// Writes that the module had heard before.
    heard: u64,
    /// Another module was at the same address meanwhile.
    shared: bool,
    ended: bool,
}

/// What the user has begun.
pub struct Hands {
    random: fastrand::Rng,
    scan: Option<Scan>,
    write: Option<Write>,
    pub done: Done,
}

impl Hands {
    pub fn new(seed: u64) -> Self {
        Self { random: fastrand::Rng::with_seed(seed), scan: None, write: None, done: Done::default() }
    }

    /// Begins a search where nobody is. Nothing happens while the line is gone: the program refuses it.
    pub fn begin_scan(&mut self, program: &mut Program, line: &Line, now: Instant) {
        if self.scan.is_some() || !program.bench().line().is_open() || program.bench().is_scanning() {
            return;
        }
        let settings = line.settings();
        let plan = ScanPlan {
            addresses: NOBODY.collect(),
            baud_rates: vec![settings.baud_rate],
            protocols: vec![Protocol::ModbusRtu],
            ..ScanPlan::quick()
        };
        program.apply(Action::Scan { line: line.address(), settings, plan });
        self.scan = Some(Scan::Running(now));
    }

    /// Writes a new value to one of the modules whose writes are heard.
    pub fn begin_write(&mut self, program: &mut Program, line: &Line, faults: &Faults, now: Instant) {
        let settings = line.settings();
        let heard = |target: &&Target| target.protocol == Protocol::ModbusRtu && target.settings == settings;
        let targets: Vec<Target> = line.targets.iter().filter(heard).copied().collect();
        let Some(target) = self.random.choice(targets).filter(|_| self.write.is_none()) else { return };
        let value = self.random.u16(VALUES).to_string();
        let heard = line.ear.writes(target.address);
        program.apply(Action::Set(target, ITEM.to_owned(), value.clone()));
        let shared = faults.get(FaultKind::Twin) == Some(Strength::Address(target.address));
        self.write = Some(Write { target, value, began: now, heard, shared, ended: false });
        self.done.writes = self.done.writes.saturating_add(1);
    }

    /// Looks after each picture how far things are.
    pub fn look(&mut self, program: &mut Program, line: &Line, now: Instant) {
        self.look_at_scan(program, now);
        self.look_at_write(program, &line.sim, now);
    }

    fn look_at_scan(&mut self, program: &mut Program, now: Instant) {
        let running = program.bench().is_scanning();
        match self.scan {
            Some(Scan::Running(_)) if !running => self.scan = None,
            Some(Scan::Running(since)) if now.saturating_duration_since(since) >= SCAN_FOR => {
                program.apply(Action::CancelScan);
                self.scan = Some(Scan::Cancelled(now));
            }
            Some(Scan::Cancelled(since)) => {
                let took = now.saturating_duration_since(since);
                if running && took < MOST_CANCEL.saturating_mul(10) {
                    return;
                }
                self.scan = None;
                self.done.scans = self.done.scans.saturating_add(1);
                self.done.longest_cancel = self.done.longest_cancel.max(took);
                if took > MOST_CANCEL {
                    self.done.failures.push(format!("a scan ended {took:.1?} after it was cancelled"));
                }
            }
            _ => {}
        }
    }

    fn look_at_write(&mut self, program: &mut Program, sim: &Sim, now: Instant) {
        let Some(write) = self.write.as_mut().filter(|write| !write.ended) else { return };
        let edit = program.bench().module(&write.target).and_then(|module| module.edit(ITEM));
        let outcome = match edit.map(|edit| &edit.state) {
            None => Outcome::Taken,
            Some(EditState::Refused(reason)) => Outcome::of(reason),
            Some(EditState::Staged | EditState::Writing(_)) => {
                let took = now.saturating_duration_since(write.began);
                if took > MOST_WRITE {
                    write.ended = true;
                    let text = format!("a write to {} had no outcome after {took:.1?}", write.target);
                    self.done.failures.push(text);
                }
                return;
            }
        };
        write.ended = true;
        let took = now.saturating_duration_since(write.began);
        let holds = sim.setting(write.target.address, ITEM).as_deref() == Some(write.value.as_str());
        if outcome.contradicts(holds) && !write.shared {
            let Write { target, value, .. } = write;
            let text = format!("{target}: {ITEM} = {value} was said to be {outcome:?}, but the module says otherwise");
            self.done.failures.push(text);
        }
        let target = write.target;
        self.done.longest_write = self.done.longest_write.max(took);
        let count = match outcome {
            Outcome::Taken => &mut self.done.taken,
            Outcome::Refused => &mut self.done.refused,
            Outcome::Unknown => &mut self.done.unknown,
        };
        *count = count.saturating_add(1);
        program.apply(Action::Revert(target, Some(ITEM.to_owned())));
    }

    /// At the end of a phase: whatever was still on its way has arrived.
    pub fn settle(&mut self, ear: &Ear) {
        if let Some(write) = self.write.take_if(|write| write.ended) {
            let heard = ear.writes(write.target.address).saturating_sub(write.heard);
            if heard > 1 {
                self.done.doubled = self.done.doubled.saturating_add(1);
                self.done.failures.push(format!("one write to {} was heard {heard} times", write.target));
            }
        }
    }
}

/// What the program says of a write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Taken,
    /// The module holds what it held before.
    Refused,
    Unknown,
}

impl Outcome {
    fn of(reason: &str) -> Self {
        let certain = ["was not written", "was refused"].iter().any(|words| reason.contains(words));
        if certain { Self::Refused } else { Self::Unknown }
    }

    fn contradicts(self, holds: bool) -> bool {
        match self {
            Self::Taken => !holds,
            Self::Refused => holds,
            Self::Unknown => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::module::WriteError;
    use crate::protocol::Failure;

    #[test]
    fn what_the_program_says_of_a_write_is_held_against_the_module() {
        let id = || ITEM.to_owned();
        let failure = || Failure::Silent;
        let not_written = WriteError::ReadFirst { id: id(), failure: failure() }.to_string();
        let unknown =
            WriteError::Unknown { id: id(), failure: failure(), read_back: "no answer".to_owned() }.to_string();
        assert_eq!(Outcome::of(&not_written), Outcome::Refused);
        assert_eq!(Outcome::of(&unknown), Outcome::Unknown);
        assert!(Outcome::Refused.contradicts(true) && Outcome::Taken.contradicts(false));
        assert!(!Outcome::Unknown.contradicts(true) && !Outcome::Unknown.contradicts(false));
    }
}
