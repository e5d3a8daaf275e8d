//! Picks the window or the command line.

// Whoever starts the window from the desktop sees no console beside it.
#![cfg_attr(feature = "window", windows_subsystem = "windows")]

#[cfg(all(windows, feature = "window"))]
mod console;

use std::process::ExitCode;

use clap::Parser;
use dcon_bench::cli::{self, Cli};

/// What the log tells unless RUST_LOG says otherwise. Of a renderer that cannot be used the window tells in one line, for
/// which the libraries need many.
const LOG: &str = "warn,arboard=error,eframe::native::glow_integration=error,eframe::native::run=off,egui_wgpu=error,\
                   wgpu_hal::vulkan::instance=off,winit=error";

fn main() -> ExitCode {
    #[cfg(all(windows, feature = "window"))]
    console::attach();
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or(LOG)).init();
    let cli = Cli::parse();
    match cli.command {
        Some(command) => cli::run(command),
        None => window(&cli),
    }
}

#[cfg(feature = "window")]
fn window(cli: &Cli) -> ExitCode {
    #[cfg(windows)]
    console::leave();
    dcon_bench::ui::run(cli.demo, &cli.fault, cli.renderer)
}

#[cfg(not(feature = "window"))]
fn window(_cli: &Cli) -> ExitCode {
    eprintln!("error: this program was built without its window – `dcon-bench --help` lists the commands");
    ExitCode::from(2)
}
