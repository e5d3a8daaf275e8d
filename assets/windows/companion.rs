//! `dcon-bench.com`: starts `dcon-bench.exe` beside it with the same arguments, standard handles and exit code, and waits.
//!
//! A shell does not wait for a program with a window, so its output would come after the next prompt; and where both
//! stand side by side, `dcon-bench` means this one. Compiled by itself: `rustc --target x86_64-pc-windows-gnu companion.rs`.

use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicBool, Ordering};

#[link(name = "kernel32")]
unsafe extern "system" {
    fn SetConsoleCtrlHandler(handler: extern "system" fn(u32) -> i32, add: i32) -> i32;
}

const CTRL_BREAK: u32 = 1;
const CANNOT_START: u8 = 1;

static WAITING: AtomicBool = AtomicBool::new(false);

/// Ctrl-C and Ctrl-Break reach the program too, which ends by them as it sees fit; this one waits for that. It does so once:
/// a window does not hear them, so the second gives the shell back.
extern "system" fn on_signal(signal: u32) -> i32 {
    i32::from(signal <= CTRL_BREAK && !WAITING.swap(true, Ordering::Relaxed))
}

fn main() -> ExitCode {
    // SAFETY: the handler has the type that Windows calls, and lives as long as the program.
    unsafe { SetConsoleCtrlHandler(on_signal, 1) };
    match run() {
        // Windows ends with 32 bits.
        Ok(code) => std::process::exit(code),
        Err(reason) => {
            eprintln!("error: {reason} – keep dcon-bench.com and dcon-bench.exe in one folder");
            ExitCode::from(CANNOT_START)
        }
    }
}

fn run() -> Result<i32, String> {
    let own = std::env::current_exe().map_err(|error| format!("the program's own folder is not known: {error}"))?;
    let program = own.with_extension("exe");
    let status = Command::new(&program)
        .args(std::env::args_os().skip(1))
        .status()
        .map_err(|error| format!("{} could not be started: {error}", program.display()))?;
    Ok(status.code().unwrap_or(1))
}
