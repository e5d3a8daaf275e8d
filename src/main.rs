//! Picks the window or the command line.

// Whoever starts the window from the desktop sees no console beside it.
#![cfg_attr(feature = "window", windows_subsystem = "windows")]

#[cfg(all(windows, feature = "window"))]
mod console;

use std::process::ExitCode;

use clap::Parser;
use dcon_bench::cli::{self, Cli};
#[cfg(feature = "window")]
use dcon_bench::errors;

/// What the log tells unless RUST_LOG says otherwise. Of a renderer that cannot be used the window tells in one line, for
/// which the libraries need many.
const LOG: &str = "warn,arboard=error,eframe::native::glow_integration=error,eframe::native::run=off,egui_wgpu=error,\
                   wgpu_hal::vulkan::instance=off,winit=error";

fn main() -> ExitCode {
    #[cfg(all(windows, feature = "window"))]
    console::attach();
    let cli = Cli::parse();
    let mut log = env_logger::Builder::from_env(env_logger::Env::default().default_filter_or(LOG));
    match cli.command {
        Some(command) => {
            log.init();
            cli::run(command)
        }
        None => window(&cli, log),
    }
}

#[cfg(feature = "window")]
fn window(cli: &Cli, mut log: env_logger::Builder) -> ExitCode {
    #[cfg(windows)]
    console::leave();
    if let Some(file) = errors::file().and_then(|path| errors::open(&path).ok()) {
        log.target(env_logger::Target::Pipe(Box::new(file)));
        std::panic::set_hook(Box::new(|panic| log::error!("{panic}")));
    }
    log.init();
    dcon_bench::ui::run(cli.demo, &cli.fault, cli.renderer)
}

#[cfg(not(feature = "window"))]
fn window(_cli: &Cli, _log: env_logger::Builder) -> ExitCode {
    eprintln!("error: this program was built without its window – `dcon-bench --help` lists the commands");
    ExitCode::from(2)
}
