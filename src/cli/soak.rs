//! `soak`: the whole program on a bad line for as long as one likes.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::signals::Interrupt;
use super::{Outcome, Stop, output, parse};
use crate::bench::objects::InOrder;
use crate::soak::{self, Options, Report, SoakError};

/// Options of `soak`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Run the whole program on a simulated line with every fault in turn",
    long_about = "Poll 16 simulated modules, record them and draw the window off screen, while every fault of the line \
                  strikes in turn and several of them together, and watch whether everything holds: no wrong value, no panic, \
                  no standstill, no growing memory, and a line that recovers by itself.\n\nOne line for each phase goes to \
                  standard error. At the end, or at an interrupt (Ctrl-C), a table tells what was done, what was noticed and \
                  what did not hold; the exit code is 1 if anything did not. Two minutes are enough for every fault.",
    after_help = "Examples:\n  dcon-bench soak\n  dcon-bench soak --duration 1h --json > soak.json\n  dcon-bench soak \
                  --duration 10min --seed 7 --out soak.sqlite"
)]
pub struct SoakArgs {
    /// End after this time
    #[arg(long, value_name = "DURATION", default_value = "2min", value_parser = parse::soak_time)]
    duration: Duration,
    /// Decides the order and the strength of the faults
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Keep the recording
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the table as one object
    #[arg(long)]
    json: bool,
}

pub fn run(args: &SoakArgs) -> Outcome {
    let SoakArgs { duration, seed, ref out, json } = *args;
    if let Some(out) = out.as_ref().filter(|out| out.exists()) {
        return Err(Stop::usage(format!("{} is there already: choose another name", out.display())));
    }
    let interrupt = Interrupt::catch()?;
    let options = Options { duration, seed, out: out.clone() };
    let report = soak::run(&options, &mut output::message, &|| interrupt.came())?;
    print(&report, json)?;
    report.details().iter().for_each(|text| output::message(text));
    let failures = report.failures();
    failures.iter().for_each(|text| output::error(text));
    if failures.is_empty() { Ok(()) } else { Err(Stop::Reported) }
}

fn print(report: &Report, json: bool) -> Outcome {
    let rows = report.rows();
    if json {
        return output::json(&InOrder(rows.iter().map(|row| (row.key.as_str(), &row.value)).collect()));
    }
    let mut table = output::Table::default();
    rows.iter().for_each(|row| table.row([&row.label, &row.text]));
    table.print()
}

impl From<SoakError> for Stop {
    fn from(error: SoakError) -> Self {
        Self::failed(error.to_string())
    }
}
