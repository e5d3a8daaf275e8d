//! A run from beginning to end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::hands::Hands;
use super::limits::{FRAME, GIVE_UP_RECOVERY, POLL_PERIOD};
use super::line::Line;
use super::phases::{Phase, Phases};
use super::program::Program;
use super::recorded::read_back;
use super::recovery::Recovery;
use super::report::{Memory, Pictures, Recoveries, Report};
use super::system::{self, Panics};
use super::watch::Watch;
use crate::bench::Action;
use crate::record::Destination;
use crate::sim::Faults;

/// Until all modules are found and read for the first time.
const MOST_START: Duration = Duration::from_secs(30);
/// How often something else is looked at in the window, and how often memory is.
const LOOK_ELSEWHERE_EVERY: Duration = Duration::from_millis(1_500);
const MEMORY_EVERY: Duration = Duration::from_secs(1);
/// How often it is measured what a round takes where nothing is wrong.
const UNDISTURBED_ROUNDS: u32 = 5;
/// A user scans in every so many phases, and writes in all others and those too.
const SCAN_EVERY: u64 = 3;

/// What is run.
#[derive(Debug, Clone)]
pub struct Options {
    pub duration: Duration,
    /// Decides the order and strength of the faults.
    pub seed: u64,
    /// The recording; `None` makes one that is removed at the end.
    pub out: Option<PathBuf>,
}

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
pub enum SoakError {
    #[error("{path} could not be made: {error} – name a recording with --out", path = .path.display())]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("the bus thread could not be started: {0}")]
    Thread(std::io::Error),
}

/// Runs the program for as long as it is asked to, or until `stopped`. `tell` gets one line for each phase.
///
/// # Errors
/// If nothing could be started.
pub fn run(options: &Options, tell: &mut dyn FnMut(&str), stopped: &dyn Fn() -> bool) -> Result<Report, SoakError> {
    let scratch = match options.out {
        Some(_) => None,
        None => Some(Scratch::new()?),
    };
    let file = match (&options.out, &scratch) {
        (Some(out), _) => out.clone(),
        (None, Some(scratch)) => scratch.path.join("soak.sqlite"),
        (None, None) => PathBuf::from("soak.sqlite"),
    };
    let panics = Panics::catch();
    let mut watch = Watch::default();
    let line = Line::new(&mut watch.truth, options.seed);
    let program = Program::start(line.address()).map_err(SoakError::Thread)?;
    let hands = Hands::new(options.seed);
    let report = Report { seed: options.seed, has_window: Program::HAS_WINDOW, ..Report::default() };
    let run = Run {
        options,
        tell,
        stopped,
        line,
        watch,
        hands,
        program,
        report,
        faults: Faults::default(),
        phase: "nothing".to_owned(),
        recovery: None,
        last_end: None,
        looked: Instant::now(),
        measured: Instant::now(),
        broken: false,
    };
    Ok(run.carry_out(&file, &panics))
}

/// A folder that is removed at the end.
struct Scratch {
    path: PathBuf,
}

impl Scratch {
    fn new() -> Result<Self, SoakError> {
        let path = std::env::temp_dir().join(format!("dcon-bench-soak-{}", std::process::id()));
        match std::fs::create_dir_all(&path) {
            Ok(()) => Ok(Self { path }),
            Err(error) => Err(SoakError::Folder { path, error }),
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if let Err(error) = std::fs::remove_dir_all(&self.path) {
            log::warn!("{} could not be removed: {error}", self.path.display());
        }
    }
}

/// A run under way.
struct Run<'a> {
    options: &'a Options,
    tell: &'a mut dyn FnMut(&str),
    stopped: &'a dyn Fn() -> bool,
    line: Line,
    watch: Watch,
    hands: Hands,
    program: Program,
    report: Report,
    faults: Faults,
    /// What goes wrong at present, in words.
    phase: String,
    recovery: Option<Recovery>,
    last_end: Option<(Instant, Duration)>,
    looked: Instant,
    measured: Instant,
    /// A panic came through: nothing more can be asked of the program.
    broken: bool,
}

impl Run<'_> {
    fn carry_out(mut self, file: &Path, panics: &Panics) -> Report {
        let ready = self.start(file);
        let begin = Instant::now();
        if ready {
            self.report.pictures = Pictures::default();
            self.report.memory.start = system::resident();
            self.all_phases(begin);
        }
        self.report.interrupted = (self.stopped)();
        self.report.duration = begin.elapsed();
        self.end(file, panics)
    }

    /// Opens the line, finds all modules, records and polls them. False if that did not come to an end.
    fn start(&mut self, file: &Path) -> bool {
        self.program.apply(Action::Connect { line: self.line.address(), settings: self.line.settings() });
        let opened = self.until(MOST_START, |run| run.program.bench().line().is_open());
        for target in self.line.targets.clone() {
            self.program.apply(Action::LookFor(target));
        }
        let count = self.line.targets.len();
        let found = opened && self.until(MOST_START, |run| run.program.bench().modules().len() >= count);
        self.program.apply(Action::Record(Destination::File(file.to_owned())));
        for target in self.line.targets.clone() {
            self.program.apply(Action::SetInterval(target, POLL_PERIOD));
        }
        let read = found && self.hear_all().is_some();
        for _ in 0..UNDISTURBED_ROUNDS {
            let took = self.hear_all().unwrap_or_default();
            self.report.recoveries.undisturbed = self.report.recoveries.undisturbed.max(took);
        }
        self.report.modules = self.program.bench().modules().len();
        if !read && !(self.stopped)() {
            self.report.troubles.push("not every module was found and read before the first fault".to_owned());
        }
        (self.tell)(&format!("{} modules are polled, {}", self.report.modules, file.display()));
        read
    }

    /// Waits until everything of every module was measured anew; how long that took.
    fn hear_all(&mut self) -> Option<Duration> {
        self.recovery = Some(Recovery::new(Instant::now(), &self.line.targets));
        self.until(MOST_START, |run| run.recovery.as_ref().is_some_and(|all| all.all.is_some()));
        self.recovery.take()?.all.map(|(took, _)| took)
    }

    fn all_phases(&mut self, begin: Instant) {
        let places = self.line.targets.iter().map(|target| (target.address, target.settings.baud_rate)).collect();
        let mut phases = Phases::new(self.options.duration, self.options.seed, places);
        while let Some(phase) = phases.next(begin.elapsed()) {
            self.one_phase(&phase, begin);
            self.report.phases = self.report.phases.saturating_add(1);
            if self.is_over() {
                break;
            }
        }
    }

    fn one_phase(&mut self, phase: &Phase, begin: Instant) {
        let (at, before) = (begin.elapsed(), Counts::of(self));
        self.phase.clone_from(&phase.name);
        let kinds: Vec<_> = phase.faults.iter().map(|fault| fault.kind).collect();
        self.set_faults(phase.faults.clone());
        self.stay(phase.faulty * 2 / 5);
        let now = Instant::now();
        self.hands.begin_write(&mut self.program, &self.line, &phase.faults, now);
        if self.report.phases.is_multiple_of(SCAN_EVERY) {
            self.hands.begin_scan(&mut self.program, &self.line, now);
        }
        self.stay(phase.faulty * 3 / 5);
        self.set_faults(Faults::default());
        self.phase = format!("the recovery from {}", phase.name);
        // New values: whoever shows the old ones now shows what is no longer true.
        self.line.change(&mut self.watch.truth);
        let recovered = self.recover(phase);
        self.hands.settle(&self.line.ear);
        self.phase = "nothing".to_owned();
        for kind in kinds {
            if !self.report.tried.contains(&kind) {
                self.report.tried.push(kind);
            }
        }
        let text = before.told(&Counts::of(self));
        (self.tell)(&format!("{:5} s  {}: {text}, {recovered}", at.as_secs(), phase.name));
    }

    /// Waits until everything is as before, and for a while at least.
    fn recover(&mut self, Phase { faults, name, quiet, .. }: &Phase) -> String {
        let outlast = faults.outlast();
        self.stay(outlast);
        let (since, quiet) = (Instant::now(), quiet.saturating_sub(outlast));
        self.recovery = Some(Recovery::new(since, &self.line.targets));
        self.stay(quiet);
        self.until(GIVE_UP_RECOVERY.saturating_sub(quiet), |run| {
            run.recovery.as_ref().is_some_and(|recovery| recovery.all.is_some())
        });
        let Some(recovery) = self.recovery.take() else { return String::new() };
        let recoveries = &mut self.report.recoveries;
        let line = recovery.line.unwrap_or_else(|| since.elapsed());
        if line > recoveries.line {
            *recoveries = Recoveries { line, line_after: name.clone(), ..recoveries.clone() };
        }
        match recovery.all {
            Some((module, last)) => {
                if module > recoveries.module {
                    *recoveries = Recoveries { module, module_after: name.clone(), ..recoveries.clone() };
                }
                let (line, module, last) = (line.as_secs_f64(), module.as_secs_f64(), last.address);
                format!("the line is back after {line:.1} s, all modules after {module:.1} s (address {last} last)")
            }
            None if (self.stopped)() || self.broken => "not waited for".to_owned(),
            None => {
                let missing: Vec<String> = recovery.missing().map(|target| target.address.to_string()).collect();
                let missing = missing.join(", ");
                recoveries.missed = recoveries.missed.saturating_add(recovery.missing().count() as u64);
                self.watch.tell(format!("not recovered {:.0?} after {name}: {missing}", since.elapsed()));
                format!("not recovered: {missing}")
            }
        }
    }

    fn set_faults(&mut self, faults: Faults) {
        self.watch.note_faults(&faults, Instant::now());
        self.line.sim.set_faults(faults.clone());
        self.faults = faults;
    }

    fn is_over(&self) -> bool {
        self.broken || (self.stopped)()
    }

    /// Goes on for so long.
    fn stay(&mut self, time: Duration) {
        self.until(time, |_| false);
    }

    /// Draws picture after picture until `reached`, but not for longer than `limit`. Whether it was reached.
    fn until(&mut self, limit: Duration, reached: impl Fn(&Self) -> bool) -> bool {
        let begin = Instant::now();
        while !self.is_over() {
            if reached(self) {
                return true;
            }
            if begin.elapsed() >= limit {
                return false;
            }
            self.picture();
        }
        false
    }

    /// One picture, with everything that is looked at after it, and the pause until the next.
    fn picture(&mut self) {
        let start = Instant::now();
        if start.duration_since(self.looked) >= LOOK_ELSEWHERE_EVERY {
            self.looked = start;
            self.program.look_elsewhere();
        }
        let program = &mut self.program;
        self.broken |= catch_unwind(AssertUnwindSafe(|| program.frame())).is_err();
        let end = Instant::now();
        if self.broken {
            self.report.troubles.push(format!("a panic came through during {}", self.phase));
            return;
        }
        self.look(end);
        let pause = FRAME.saturating_sub(start.elapsed());
        self.note_picture(end.duration_since(start), end);
        self.last_end = Some((end, pause));
        std::thread::sleep(pause);
    }

    fn look(&mut self, now: Instant) {
        let bench = self.program.bench();
        self.watch.look(bench, &self.phase, now);
        if let Some(recovery) = &mut self.recovery {
            recovery.look(bench, &self.watch, now);
        }
        self.hands.look(&mut self.program, &self.line, now);
        if now.duration_since(self.measured) >= MEMORY_EVERY {
            self.measured = now;
            let Memory { highest, .. } = &mut self.report.memory;
            *highest = system::resident().max(*highest);
        }
    }

    fn note_picture(&mut self, took: Duration, end: Instant) {
        let pictures = &mut self.report.pictures;
        let waited = system::waited_for_processor();
        let others = waited.saturating_sub(std::mem::replace(&mut pictures.waited, waited));
        if let Some((last, pause)) = self.last_end {
            let stall = end.duration_since(last).saturating_sub(pause);
            pictures.longest_stall = pictures.longest_stall.max(stall);
            pictures.longest_own_stall = pictures.longest_own_stall.max(stall.saturating_sub(others));
        }
        pictures.count = pictures.count.saturating_add(1);
        pictures.longest = pictures.longest.max(took);
    }

    /// Closes everything, reads the recording back and sums up.
    fn end(mut self, file: &Path, panics: &Panics) -> Report {
        self.set_faults(Faults::default());
        if let Some(notice) = self.program.bench().notices().rfind(|notice| notice.text.contains("bus thread")) {
            self.report.troubles.push(notice.text.clone());
        }
        self.check_modules();
        let begin = Instant::now();
        let Self { mut program, mut watch, mut report, line, hands, .. } = self;
        program.end_recording();
        let history = program.bench().history();
        report.samples = history.series().map(|(_, series)| series.trend.len()).sum();
        report.memory.end = system::resident();
        report.memory.highest = report.memory.highest.max(report.memory.end);
        drop(program);
        report.quit = begin.elapsed();
        match read_back(file, &line.targets, &mut watch) {
            Ok(recorded) => report.recorded = Some(recorded),
            Err(error) => report.troubles.push(error.to_string()),
        }
        report.injected = line.sim.injected();
        report.panics = panics.count();
        report.done = hands.done;
        let Watch { statistics, noticed, values, details, .. } = watch;
        Report { statistics, noticed, values, details, ..report }
    }

    /// The same modules as at first, and no others.
    fn check_modules(&mut self) {
        let bench = self.program.bench();
        let strangers = bench.modules().iter().filter(|module| !self.line.targets.contains(&module.target));
        let strangers: Vec<String> = strangers.map(|module| module.target.to_string()).collect();
        let lost = self.line.targets.iter().filter(|target| bench.module(target).is_none());
        let lost: Vec<String> = lost.map(ToString::to_string).collect();
        for (whose, what) in [(strangers, "found that are not there"), (lost, "not listed any more")] {
            if !whose.is_empty() {
                self.report.troubles.push(format!("modules that are {what}: {}", whose.join("; ")));
            }
        }
    }
}

/// What is told of a phase.
struct Counts {
    injected: u64,
    errors: u64,
    repeats: u64,
    wrong: u64,
}

impl Counts {
    fn of(run: &Run<'_>) -> Self {
        let Watch { statistics, values, .. } = &run.watch;
        let injected = run.line.sim.injected().values().fold(0_u64, |sum, count| sum.saturating_add(*count));
        let wrong = values.wrong.saturating_add(values.outdated).saturating_add(values.wrong_without_check);
        Self { injected, errors: statistics.errors, repeats: statistics.repeats, wrong }
    }

    fn told(&self, after: &Self) -> String {
        let more = |before: u64, after: u64| after.saturating_sub(before);
        let wrong = more(self.wrong, after.wrong);
        let wrong = if wrong > 0 { format!(", {wrong} wrong values") } else { String::new() };
        format!(
            "struck {}, errors {}, repeats {}{wrong}",
            more(self.injected, after.injected),
            more(self.errors, after.errors),
            more(self.repeats, after.repeats)
        )
    }
}
