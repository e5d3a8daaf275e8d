//! `diagnose`: what is wrong with a line or a module, with the evidence and the next step.

mod examination;

use std::path::{Path, PathBuf};

use clap::Args;
use jiff::Timestamp;

use super::line_args::{LineArgs, ModuleWord};
use super::output;
use super::session::{self, Session};
use super::signals::Interrupt;
use super::{Outcome, Stop};
use crate::bench::traffic::{FrameRef, TrafficLog, explain_frame};
use crate::bus::{LatencyTimer, LineAddress, Target, Tuning, ports};
use crate::diagnosis::bundle::{Bundle, Traffic, gather, last_frames};
use crate::diagnosis::{DEFAULT_READS, READS, Report};
use crate::protocol::Protocol;
use crate::record::check_writable;
use examination::Examination;

/// Options of `diagnose`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Find out what is wrong with a line or a module",
    long_about = "Find out what is wrong with a line or a module, with questions that change nothing.\n\nEach module is asked \
                  the same many times: from the answers, their times and what failed, it tells two modules at one address \
                  from noise and from a timeout that is too short. Without --address, modules are looked for first where \
                  they are out of the box: at 1 and 160 to 191, in both protocols. If nothing answers there, the other \
                  speeds are tried. What it is doing is told on standard error.\n\nEach read is listened for half a second, \
                  or for --timeout if that is longer; what answers after --timeout is told as too late, and of what fails \
                  it is told whether --repeats would have helped.\n\nAn interrupt (Ctrl-C) ends it early: what was heard \
                  until then is told, and the bundle written. The exit code is 0 when nothing is wrong, 1 when something \
                  needs attention or it was ended early.",
    after_help = "Examples:\n  dcon-bench diagnose --port /dev/ttyUSB0\n  dcon-bench diagnose --port /dev/ttyUSB0 --address 1\n  \
                  dcon-bench diagnose --port COM3 --address 1 --address 163:dcon --reads 200 --json\n  dcon-bench diagnose \
                  --port COM3 --bundle for-support.zip"
)]
pub struct DiagnoseArgs {
    /// Module to test, may be repeated: its address, with protocol, speed, format and checksum where they are not those of
    /// the line
    #[arg(long, value_name = "N[:dcon][:9600][:n81][:checksum]")]
    address: Vec<ModuleWord>,
    /// How often each module is asked the same
    #[arg(long, value_name = "N", default_value_t = DEFAULT_READS, value_parser = reads)]
    reads: u32,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
    /// Write a zip for asking others for help: report, versions, settings, ports and the last traffic
    #[arg(long, value_name = "FILE.zip")]
    bundle: Option<PathBuf>,
    #[command(flatten)]
    line: LineArgs,
}

fn reads(text: &str) -> Result<u32, String> {
    let wrong = || format!("\"{text}\" is not a number from {} to {}", READS.start(), READS.end());
    text.trim().parse().ok().filter(|reads| READS.contains(reads)).ok_or_else(wrong)
}

pub fn run(args: &DiagnoseArgs) -> Outcome {
    let places = places(args)?;
    args.bundle.as_deref().map_or(Ok(()), check_bundle)?;
    let mut examination = Examination::new(Interrupt::catch()?, args.line.tuning());
    let catalogue = session::catalogue();
    let line = args.line.address();
    examination.diagnosis.note_adapter(adapter(&line));
    examination.tell(&opening(args, &line));
    match Session::try_open(&args.line, &catalogue)? {
        Err(problem) => examination.diagnosis.note_problem(problem),
        Ok(session) => examine(&mut examination, &session, args, &places)?,
    }
    let report = examination.report(&line.to_string(), Timestamp::now());
    if args.json {
        output::json(&report)?;
    } else {
        output::line(report.to_string().trim_end())?;
    }
    if let Some(path) = &args.bundle {
        let bundle = bundle(report.clone(), &examination.traffic)?;
        let written = bundle.write(path);
        written.map_err(|error| Stop::failed(format!("{} could not be written: {error}", path.display())))?;
        output::message(&format!("{} written; look through it before you pass it on", path.display()));
    }
    let is_wrong = report.is_wrong() || report.modules.is_empty() || report.stopped_early.is_some();
    if is_wrong { Err(Stop::Reported) } else { Ok(()) }
}

/// Before anything is asked: whether the bundle can be written at the end.
fn check_bundle(path: &Path) -> Outcome {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(Stop::usage(format!("there is no folder {} – make it, or choose another", folder.display())));
    }
    if path.is_dir() {
        return Err(Stop::usage(format!("{} is a folder: add the name of a file", path.display())));
    }
    check_writable(path).map_err(|error| {
        Stop::failed(format!("{} cannot be written ({error}) – choose another place for the bundle", path.display()))
    })
}

fn opening(args: &DiagnoseArgs, line: &LineAddress) -> String {
    let settings = if args.line.is_tcp() { String::new() } else { format!(" at {}", args.line.settings()) };
    let Tuning { timeout, repeats } = args.line.tuning();
    let timeout = timeout.as_millis();
    format!("Opening {line}{settings}; timeout {timeout} ms, repeats {repeats}")
}

/// Each module to test, in the protocols in which it may answer.
fn places(args: &DiagnoseArgs) -> Outcome<Vec<Vec<Target>>> {
    let protocols = |word: &ModuleWord| match word.protocol {
        Some(protocol) => vec![protocol],
        None if args.line.is_tcp() => vec![Protocol::ModbusTcp],
        None if word.checksum => vec![Protocol::Dcon],
        // Modbus has no module at 0 and above 247.
        None if !(1..=247).contains(&word.address) => vec![Protocol::Dcon],
        None => Protocol::SERIAL.to_vec(),
    };
    let place =
        |word: &ModuleWord, protocol| ModuleWord { protocol: Some(protocol), ..word.clone() }.target(&args.line);
    let targets = |word: &ModuleWord| protocols(word).into_iter().map(|protocol| place(word, protocol)).collect();
    args.address.iter().map(targets).collect()
}

fn examine(examination: &mut Examination, session: &Session, args: &DiagnoseArgs, places: &[Vec<Target>]) -> Outcome {
    let mut found = Vec::new();
    for place in places {
        found.extend(examination.find(session, place)?);
    }
    if places.is_empty() {
        found = examination.search(session, &args.line)?;
    }
    for target in found {
        examination.test(session, target, args.reads)?;
    }
    Ok(())
}

fn adapter(line: &LineAddress) -> Option<LatencyTimer> {
    match line {
        LineAddress::Serial { port } => LatencyTimer::of_port(port, &ports()),
        _ => None,
    }
}

fn bundle(report: Report, log: &TrafficLog) -> Outcome<Bundle> {
    let mut traffic = Traffic::new(&report.line.name)?;
    let explain = |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| explain_frame(frame, request, None).summary;
    log.add_to_bundle(last_frames(log.first_seq()..log.next_seq()), &explain, &mut traffic)?;
    Ok(gather(report, ports(), traffic)?)
}
