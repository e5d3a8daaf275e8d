//! Picks the window or the command line.

use std::process::ExitCode;

use clap::Parser;
use dcon_bench::cli::{self, Cli};
use dcon_bench::ui;

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn")).init();
    let Cli { demo, command } = Cli::parse();
    match command {
        Some(command) => cli::run(command),
        None => ui::run(demo),
    }
}
