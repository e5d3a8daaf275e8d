//! `diagnose`.

use clap::Args;

use super::{Outcome, Stop};

/// Options of `diagnose`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Find out what is wrong with a line or a module",
    after_help = "Examples:\n  dcon-bench diagnose --port /dev/ttyUSB0 --address 1"
)]
pub struct DiagnoseArgs {}

pub fn run(_args: &DiagnoseArgs) -> Outcome {
    Err(Stop::failed("not there yet"))
}
