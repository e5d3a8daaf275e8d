//! `replay`.

use clap::Args;

use super::{Outcome, Stop};

/// Options of `replay`.
#[derive(Debug, Clone, Args)]
#[command(about = "Decode a capture of the traffic again", after_help = "Examples:\n  dcon-bench replay hall.pcapng")]
pub struct ReplayArgs {}

pub fn run(_args: &ReplayArgs) -> Outcome {
    Err(Stop::failed("not there yet"))
}
