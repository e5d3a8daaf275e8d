//! `soak`.

use clap::Args;

use super::{Outcome, Stop};

/// Options of `soak`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Run the whole program on a simulated line with every fault in turn",
    after_help = "Examples:\n  dcon-bench soak --duration 2min"
)]
pub struct SoakArgs {}

pub fn run(_args: &SoakArgs) -> Outcome {
    Err(Stop::failed("not there yet"))
}
