//! `licences`: what the program is built from, and under which licences.

use clap::Args;

use super::stop::Stop;
use super::{Outcome, output};
use crate::help::licences;

/// Options of `licences`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Print the licences of the program and of what it is built from",
    long_about = "Print the licences of the program and of every package, font and library in it: first the list, then each \
                  text with the parts that come under it.",
    after_help = "Examples:\n  dcon-bench licences > LICENCES.txt\n  dcon-bench licences --list"
)]
pub struct LicencesArgs {
    /// Only the list: name, version and licence of each part
    #[arg(long)]
    list: bool,
}

pub fn run(args: &LicencesArgs) -> Outcome {
    if args.list {
        let mut table = output::Table::default();
        licences::parts().iter().for_each(|part| table.row([part.name, part.version, part.licence]));
        return table.print();
    }
    let text =
        licences::whole().ok_or_else(|| Stop::failed("the licences in this program are damaged – get it anew"))?;
    output::line(text.trim_end())
}
