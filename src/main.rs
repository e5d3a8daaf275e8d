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

#[cfg(feature = "window")]
fn window(demo: bool) -> ExitCode {
    dcon_bench::ui::run(demo)
}

#[cfg(not(feature = "window"))]
fn window(_demo: bool) -> ExitCode {
    eprintln!("error: this program was built without its window – `dcon-bench --help` lists the commands");
    ExitCode::from(2)
}
