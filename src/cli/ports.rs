//! `ports`: the serial ports that are there.

use clap::Args;

use super::Outcome;
use super::output::{self, Table};
use crate::bus::{self, PortInfo};

/// Options of `ports`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "List the serial ports",
    long_about = "List the serial ports that are there, USB adapters first, and why one of them cannot be opened where \
                  that is known.",
    after_help = "Examples:\n  dcon-bench ports\n  dcon-bench ports --json"
)]
pub struct PortsArgs {
    /// Print an array of objects with name, description and problem
    #[arg(long)]
    json: bool,
}

pub fn run(args: &PortsArgs) -> Outcome {
    let ports = bus::ports();
    if ports.is_empty() {
        output::message("There is no serial port – plug in the adapter, or try the simulated line (--demo)");
    }
    for adapter in bus::adapters_without_port() {
        output::message(&adapter.to_string());
    }
    if args.json { output::json(&ports) } else { table(&ports).print() }
}

fn table(ports: &[PortInfo]) -> Table {
    let mut table = Table::default();
    for PortInfo { name, description, problem, .. } in ports {
        table.row([name, description, problem.as_deref().unwrap_or_default()]);
    }
    table
}
