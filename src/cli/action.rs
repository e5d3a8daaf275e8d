//! `action`: something to do that has no value.

use clap::Args;

use super::line_args::{LineArgs, ModuleArgs};
use super::session::Module;
use super::{Outcome, names, output};
use crate::module::Definition;
use crate::protocol::Protocol;

/// Options of `action`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Carry out an action, such as clearing the alarm",
    long_about = "Carry out an action, once. Which there are depends on the module: an unknown name lists them.\n\nActions \
                  that interrupt the module's work, such as reboot, need --yes.",
    after_help = "Examples:\n  dcon-bench action --port /dev/ttyUSB0 --address 1 clear_alarm\n  dcon-bench action --port \
                  COM3 --address 1 clear_high_latch:temperature_c\n  dcon-bench action --tcp 192.168.255.1 --address 1 \
                  reboot --yes"
)]
pub struct ActionArgs {
    /// Name of the action
    #[arg(value_name = "NAME")]
    name: String,
    /// Do it without asking, where an action needs to be confirmed
    #[arg(long)]
    yes: bool,
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    module: ModuleArgs,
}

pub fn run(args: &ActionArgs) -> Outcome {
    let module = Module::open(&args.line, &args.module, |definition, protocol| check(args, definition, protocol))?;
    module.session.act(module.target, &module.definition, &args.name)??;
    let broadcast = module.target.protocol == Protocol::Dcon
        && module.definition.action(&args.name).is_some_and(|action| action.is_broadcast());
    let done = if broadcast { "sent to every module of the line, none of which answers" } else { "done" };
    output::line(&format!("{}: {done}", args.name))
}

fn check(args: &ActionArgs, definition: &Definition, protocol: Protocol) -> Result<(), names::Refusal> {
    let action = names::action(definition, protocol, &args.name)?;
    if action.confirm && !args.yes {
        let reason = format!("{} has to be confirmed with --yes: {}", action.id, action.help);
        return Err(names::Refusal::Refused(reason));
    }
    Ok(())
}
