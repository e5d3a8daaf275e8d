//! Picks the window or the command line.

use std::process::ExitCode;

use clap::Parser;
use dcon_bench::cli::{self, Cli};

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn")).init();
    let Cli { demo, command } = Cli::parse();
    match command {
        Some(command) => cli::run(command),
        None => window(demo),
    }
}

/// Opens the window.
fn window(_demo: bool) -> ExitCode {
    // Here goes `dcon_bench::ui::run(demo)`.
    eprintln!("error: this build has no window yet – `dcon-bench --help` lists the commands");
    ExitCode::FAILURE
}
