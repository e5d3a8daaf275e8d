//! `get`: a few values by name.

use clap::Args;

use super::line_args::{LineArgs, ModuleArgs};
use super::output::{self, Table, ValuesObject};
use super::session::Module;
use super::stop::Stop;
use super::{Outcome, names};
use crate::bus::{Answer, ItemSet};

/// Options of `get`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Read parameters and readings by name",
    long_about = "Read parameters and readings by name; `show` lists the names in its last column.\n\nA value that could \
                  not be read is shown as – (null in JSON) with the reason on standard error, and makes the exit code 1. \
                  reset_status is cleared by reading it.",
    after_help = "Examples:\n  dcon-bench get --port /dev/ttyUSB0 --address 1 temperature_c humidity\n  dcon-bench get \
                  --tcp 192.168.255.1 --address 1 alarm_limit --json"
)]
pub struct GetArgs {
    /// Names of parameters and readings
    #[arg(required = true, value_name = "NAME")]
    names: Vec<String>,
    /// Print one object with a value for each name
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    module: ModuleArgs,
}

pub fn run(args: &GetArgs) -> Outcome {
    let module = Module::open(&args.line, &args.module, |definition, protocol| {
        args.names.iter().try_for_each(|name| names::item(definition, protocol, name).map(|_| ()))
    })?;
    let mut wanted = args.names.clone();
    let mut seen = std::collections::BTreeSet::new();
    wanted.retain(|name| seen.insert(name.clone()));
    let values = module.session.read(module.target, &module.definition, ItemSet::Named(wanted))?;
    if args.json {
        output::json(&ValuesObject::new(&values))?;
    } else {
        let mut table = Table::default();
        for Answer { id, result, .. } in &values {
            if let Some(item) = module.definition.item(id) {
                output::value_row(&mut table, item, result.as_ref().ok());
            }
        }
        table.print()?;
    }
    output::report_missing(&values);
    if values.iter().all(|answer| answer.result.is_ok()) { Ok(()) } else { Err(Stop::Reported) }
}
