//! `show`: everything a module tells.

use clap::Args;
use serde::Serialize;

use super::Outcome;
use super::line_args::{LineArgs, ModuleArgs};
use super::output::{self, ModuleObject, Table, ValuesObject};
use super::session::Module;
use super::stop::Stop;
use crate::bus::{Answer, ItemSet, Values};
use crate::module::{Item, ItemKind};

/// Options of `show`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Show a module's identity, every parameter and every reading",
    long_about = "Show a module's identity, every parameter and every reading.\n\nWhat the protocol does not offer is \
                  left out, and so is what reading would change (reset_status: `get` reads it). A value that the module \
                  refuses to tell is shown as – (null in JSON) with the reason on standard error; a module that falls \
                  silent is an error.",
    after_help = "Examples:\n  dcon-bench show --port /dev/ttyUSB0 --address 1\n  dcon-bench show --port COM3 --baud-rate \
                  19200 --address 0xA0 --protocol dcon --checksum\n  dcon-bench show --tcp 192.168.255.1 --address 1 --json"
)]
pub struct ShowArgs {
    /// Print one object with module, parameters and readings
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    module: ModuleArgs,
}

#[derive(Serialize)]
struct ShowObject<'a> {
    module: ModuleObject<'a>,
    parameters: ValuesObject<'a>,
    readings: ValuesObject<'a>,
}

fn is_parameter(item: &Item) -> bool {
    item.item_kind == ItemKind::Parameter
}

pub fn run(args: &ShowArgs) -> Outcome {
    let module = Module::open(&args.line, &args.module, |_, _| Ok(()))?;
    let values = module.session.read(module.target, &module.definition, ItemSet::All)?;
    if args.json {
        print_object(&module, &values)?
    } else {
        print_tables(&module, &values)?
    }
    output::report_missing(&values);
    let refused = |failure: &crate::protocol::Failure| failure.shows_presence();
    let told_all = values.iter().all(|answer| answer.result.as_ref().err().is_none_or(refused));
    let told_any = values.is_empty() || values.iter().any(|answer| answer.result.is_ok());
    if told_all && told_any { Ok(()) } else { Err(Stop::Reported) }
}

fn print_object(module: &Module, values: &Values) -> Outcome {
    let kind =
        |wanted: fn(&Item) -> bool| ValuesObject::of(values, move |id| module.definition.item(id).is_some_and(wanted));
    output::json(&ShowObject {
        module: ModuleObject::new(&module.target, &module.identified),
        parameters: kind(is_parameter),
        readings: kind(Item::is_reading),
    })
}

fn print_tables(module: &Module, values: &Values) -> Outcome {
    output::line(&output::module_line(&module.target, &module.identified, &module.definition))?;
    print_table("Parameters", module, values, is_parameter)?;
    print_table("Readings", module, values, Item::is_reading)
}

fn print_table(title: &str, module: &Module, values: &Values, wanted: fn(&Item) -> bool) -> Outcome {
    let mut table = Table::default();
    for Answer { id, result, .. } in values {
        if let Some(item) = module.definition.item(id).filter(|item| wanted(item)) {
            output::value_row(&mut table, item, result.as_ref().ok());
        }
    }
    output::line("")?;
    output::line(title)?;
    table.print()
}
