//! `record`: readings of several modules, into a recording.

mod places;
mod roll;
mod trouble;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use jiff::Timestamp;

use super::line_args::{LineArgs, ModuleWord};
use super::session::{self, Session};
use super::signals::Interrupt;
use super::stop::Stop;
use super::terminal::TerminalLine;
use super::{Outcome, output, parse};
use crate::bus::{BusEvent, Target};
use crate::protocol::{Protocol, parse_address};
use crate::record::{Destination, EventKind, Recorder, Recording};
use places::Places;
use roll::Roll;

/// How long an interrupt may remain unnoticed.
const LOOK_UP_EVERY: Duration = Duration::from_millis(50);
/// More events than may wait at the end.
const MOST_WAITING: usize = 5_000;
/// How often the status line changes.
const SHOW_EVERY: Duration = Duration::from_secs(1);

/// Options of `record`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Record the readings of modules into a file",
    long_about = "Record everything that is polled of one or several modules, and what happens to them, into a recording: \
                  an SQLite file that the window opens and `export` reads, also while it grows. A file that is a recording \
                  already is continued.\n\nA module is its ADDRESS, followed by any of a protocol (modbus_rtu, dcon), a \
                  speed, a data format (n81, n82, e81, o81) and checksum, each after a colon; what is left out is as the \
                  line has it. One that does not answer is asked again now and then, without holding up the others.\n\nWhat \
                  was measured is on the disk within a second. Ends after --duration or at an interrupt (Ctrl-C, SIGTERM), \
                  and then tells how many samples there are; the exit code is 1 if none came until the end of --duration, \
                  or if samples could not be written.",
    after_help = "Examples:\n  dcon-bench record --port /dev/ttyUSB0 1 2 0xA3:dcon --out hall.sqlite\n  dcon-bench record --port \
                  COM3 --baud-rate 19200 1 18:dcon:9600:checksum --interval 500ms --out hall.sqlite\n  dcon-bench record --tcp \
                  192.168.255.1 1 --interval 1s --duration 24h --out day.sqlite"
)]
pub struct RecordArgs {
    /// Modules, such as 1, 0xA3:dcon or 18:dcon:19200:n81:checksum
    #[arg(value_name = "MODULE", required_unless_present = "address")]
    modules: Vec<ModuleWord>,
    /// A module, as the other commands name it
    #[arg(long, value_name = "N", value_parser = parse_address)]
    address: Option<u8>,
    /// Protocol of the module of --address: modbus_rtu or dcon [default: modbus_rtu]
    #[arg(long, value_parser = parse::serial_protocol, conflicts_with = "tcp", requires = "address")]
    protocol: Option<Protocol>,
    /// The module of --address uses checksums (DCON only)
    #[arg(long, conflicts_with = "tcp", requires = "address")]
    checksum: bool,
    /// Time from one set of readings to the next; 0 is as fast as the line allows
    #[arg(long, value_name = "DURATION", default_value = "1s", value_parser = parse::interval)]
    interval: Duration,
    /// The recording
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// End after this time
    #[arg(long, value_name = "DURATION", value_parser = parse::recording_time)]
    duration: Option<Duration>,
    #[command(flatten)]
    line: LineArgs,
}

impl RecordArgs {
    fn targets(&self) -> Outcome<Vec<Target>> {
        let by_option = self.address.map(|address| ModuleWord {
            address,
            protocol: self.protocol,
            checksum: self.checksum,
            ..ModuleWord::default()
        });
        let mut targets: Vec<Target> = Vec::new();
        for module in self.modules.iter().chain(&by_option) {
            let target = module.target(&self.line)?;
            if targets.contains(&target) {
                return Err(Stop::usage(format!("the module at {target} is given twice")));
            }
            targets.push(target);
        }
        Ok(targets)
    }
}

pub fn run(args: &RecordArgs) -> Outcome {
    let targets = args.targets()?;
    check_file(&args.out)?;
    let interrupt = Interrupt::catch()?;
    let session = Session::open(&args.line, &session::catalogue())?;
    let recorder = Recorder::start(Destination::File(args.out.clone()), || {});
    let recorder = recorder.map_err(|error| Stop::failed(format!("the recording could not be started: {error}")))?;
    let mut roll = Roll::new(recorder, TerminalLine::new(SHOW_EVERY));
    let mut places = Places::new(targets, args.line.address().to_string(), args.interval);
    let (begin, count) = (Instant::now(), places.count());
    let modules = if count == 1 { "1 module".to_owned() } else { format!("{count} modules") };
    output::message(&format!("recording {modules} into {} – Ctrl-C ends it", args.out.display()));
    let end = args.duration.and_then(|duration| begin.checked_add(duration));
    let ended = follow(&session, &mut places, &mut roll, &interrupt, end);
    let told = tell_end(roll, args, begin.elapsed(), interrupt.came());
    // What was measured until then is on the disk in any case.
    ended.and(told)
}

/// What is seen at once, before anything is opened; what happens to the file later is told while it is recorded.
fn check_file(path: &Path) -> Outcome {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(Stop::usage(format!("there is no folder {} – make it, or choose another", folder.display())));
    }
    if path.is_dir() {
        return Err(Stop::usage(format!("{} is a folder: add the name of a file", path.display())));
    }
    if path.metadata().is_ok_and(|file| file.len() > 0) {
        Recording::open(path).map_err(|error| Stop::failed(error.to_string()))?;
    }
    Ok(())
}

/// Takes in what the line brings, until the end or an interrupt.
fn follow(
    session: &Session,
    places: &mut Places,
    roll: &mut Roll,
    interrupt: &Interrupt,
    end: Option<Instant>,
) -> Outcome {
    while !interrupt.came() {
        let left = end.map_or(LOOK_UP_EVERY, |end| end.saturating_duration_since(Instant::now()));
        if left.is_zero() {
            break;
        }
        places.ask_next(session)?;
        if let Some(event) = session.event(left.min(LOOK_UP_EVERY))? {
            take(session, places, roll, event)?;
        }
        roll.hand_over();
    }
    // What was measured before the end is recorded too.
    for _ in 0..MOST_WAITING {
        let Some(event) = session.event(Duration::ZERO)? else { break };
        take(session, places, roll, event)?;
    }
    Ok(())
}

fn take(session: &Session, places: &mut Places, roll: &mut Roll, event: BusEvent) -> Outcome {
    match event {
        BusEvent::Read { id, at, values, .. } => places.take(roll, id, at, values),
        BusEvent::Reading { id, values, .. } => places.take_so_far(roll, id, &values),
        BusEvent::Identified { id, result, .. } => places.identified(session, roll, id, result)?,
        BusEvent::LineLost { reason } => {
            let text = format!("The line was lost: {reason}");
            roll.note(Timestamp::now(), EventKind::Lost, text, " – waiting for it to come back");
        }
        BusEvent::LineRestored { .. } => {
            // Not when it was lost: what was answered before that may be told after it.
            places.pause(&mut roll.history);
            roll.note(Timestamp::now(), EventKind::Found, "The line is back".to_owned(), "");
        }
        _ => {}
    }
    Ok(())
}

/// Closes the file and says what is in it.
fn tell_end(roll: Roll, args: &RecordArgs, elapsed: Duration, interrupted: bool) -> Outcome {
    let (samples, status) = roll.finish()?;
    let elapsed = humantime::format_duration(Duration::from_secs(elapsed.as_secs()));
    let file = status.file.as_deref().unwrap_or(&args.out);
    output::line(&format!("{}: {samples} samples in {elapsed}", file.display()))?;
    if status.lost > 0 {
        let reason = status.problem.as_deref().unwrap_or("the file could not take them");
        return Err(Stop::failed(format!("{} samples or events are lost: {reason}", status.lost)));
    }
    if samples == 0 && !interrupted { Err(Stop::Reported) } else { Ok(()) }
}
