//! Picks the window or the command line.

// Whoever starts the window from the desktop sees no console beside it.
#![cfg_attr(feature = "window", windows_subsystem = "windows")]

#[cfg(all(windows, feature = "window"))]
mod console;

use std::process::ExitCode;

use clap::Parser;
use dcon_bench::cli::{self, Cli};
use dcon_bench::sim::Fault;

fn main() -> ExitCode {
    #[cfg(all(windows, feature = "window"))]
    console::attach();
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn")).init();
    let Cli { demo, fault, command } = Cli::parse();
    match command {
        Some(command) => cli::run(command),
        None => window(demo, &fault),
    }
}

#[cfg(feature = "window")]
fn window(demo: bool, faults: &[Fault]) -> ExitCode {
    #[cfg(windows)]
    console::leave();
    dcon_bench::ui::run(demo, faults)
}

#[cfg(not(feature = "window"))]
fn window(_demo: bool, _faults: &[Fault]) -> ExitCode {
    eprintln!("error: this program was built without its window – `dcon-bench --help` lists the commands");
    ExitCode::from(2)
}
