//! The command line: one file per subcommand, each of which opens a line, holds a conversation and prints what came of it.
//!
//! The contract: results go to standard output, everything else to standard error; the exit code is 0 on success, 1 when
//! the line or a module refused or stayed silent, 2 for wrong usage. Standard output that was closed ends quietly with 0.

mod action;
mod capture;
mod completions;
mod diagnose;
mod export;
mod get;
mod licences;
mod line_args;
mod manpage;
mod names;
mod output;
mod parse;
mod ports;
mod record;
mod reference;
mod replay;
mod scan;
mod send;
mod session;
mod set;
mod show;
mod signals;
mod simulate;
mod soak;
mod stop;
mod terminal;
mod watch;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use stop::Stop;

#[cfg(feature = "window")]
use crate::renderer::Renderer;
use crate::sim::Fault;

/// The whole command line. Without a subcommand the window opens.
#[derive(Debug, Parser)]
#[command(
    name = "dcon-bench",
    version = crate::version::WITH_COMMIT,
    about = "Commissioning bench for ICP DAS PIR-130 and PIR-234 modules on RS-485 and Ethernet",
    long_about = "Commissioning bench for ICP DAS PIR-130 and PIR-234 modules, and others that a definition file describes, \
                  on RS-485 (DCON, Modbus RTU) and Ethernet (Modbus TCP).\n\nWithout a command the window opens. Results go \
                  to standard output, progress and messages to standard error.",
    after_help = EXIT_CODES,
    after_long_help = format!("{EXIT_CODES}\n\n{EXAMPLES}"),
    args_conflicts_with_subcommands = true,
    disable_help_subcommand = true
)]
pub struct Cli {
    /// Open the window with a simulated line, so that everything can be tried without a module
    #[arg(long)]
    pub demo: bool,
    /// Let the simulated line go wrong from the start, such as late=20% or echo; repeatable. `dcon-bench simulate --help`
    /// lists the kinds
    #[arg(long, value_name = "KIND[=STRENGTH]", requires = "demo")]
    pub fault: Vec<Fault>,
    /// What to draw the window with; DCON_BENCH_RENDERER says it where this does not [default: auto]
    #[cfg(feature = "window")]
    #[arg(long, overrides_with = "renderer")]
    pub renderer: Option<Renderer>,
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXIT_CODES: &str = "Exit codes: 0 success, 1 the line or a module refused or stayed silent, 2 wrong usage.";

const EXAMPLES: &str = "Examples:
  dcon-bench --demo                                      the window, with simulated modules
  dcon-bench ports                                       which serial ports there are
  dcon-bench scan --port /dev/ttyUSB0                    where a module answers
  dcon-bench show --port COM3 --address 1                everything a module tells
  dcon-bench set --port COM3 --address 1 pir_on_time=33  change a parameter
  dcon-bench watch --tcp 192.168.255.1 --address 1       readings, one line a second
  dcon-bench record --port COM3 1 2:dcon --out hall.sqlite readings of several modules, into a file
  dcon-bench export hall.sqlite --out hall.csv             what was recorded, for other programs";

/// What to do without a window.
#[derive(Debug, Subcommand)]
pub enum Command {
    Ports(ports::PortsArgs),
    Scan(scan::ScanArgs),
    Show(show::ShowArgs),
    Get(get::GetArgs),
    Set(set::SetArgs),
    Action(action::ActionArgs),
    Send(send::SendArgs),
    Watch(watch::WatchArgs),
    Record(record::RecordArgs),
    Export(export::ExportArgs),
    Diagnose(diagnose::DiagnoseArgs),
    Replay(replay::ReplayArgs),
    Simulate(simulate::SimulateArgs),
    Soak(soak::SoakArgs),
    Reference(reference::ReferenceArgs),
    Licences(licences::LicencesArgs),
    Completions(completions::CompletionsArgs),
    Manpage(manpage::ManpageArgs),
}

/// Carries out a subcommand.
pub fn run(command: Command) -> ExitCode {
    let outcome = match command {
        Command::Ports(args) => ports::run(&args),
        Command::Scan(args) => scan::run(&args),
        Command::Show(args) => show::run(&args),
        Command::Get(args) => get::run(&args),
        Command::Set(args) => set::run(&args),
        Command::Action(args) => action::run(&args),
        Command::Send(args) => send::run(&args),
        Command::Watch(args) => watch::run(&args),
        Command::Record(args) => record::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Diagnose(args) => diagnose::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Soak(args) => soak::run(&args),
        Command::Reference(args) => reference::run(&args),
        Command::Licences(args) => licences::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Manpage(args) => manpage::run(&args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(stop) => stop.report(),
    }
}

/// What a subcommand comes to.
type Outcome<T = ()> = Result<T, Stop>;

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_subcommand_has_a_help_text_with_an_example() {
        for command in Cli::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains(&format!("dcon-bench {}", command.get_name())), "{}", command.get_name());
        }
    }
}
