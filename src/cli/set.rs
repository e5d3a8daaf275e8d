//! `set`: new values, each written once, read back and reported.

use clap::Args;

use super::line_args::{LineArgs, ModuleArgs};
use super::parse::Assignment;
use super::session::Module;
use super::stop::Stop;
use super::{Outcome, names, output};
use crate::bus::{ItemSet, Target, Values};
use crate::module::{Applies, Item, Value, WriteError, moves_to};

/// Options of `set`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Write parameters, read them back and report",
    long_about = "Write parameters, one after the other in the order given, read each back and report what the module then \
                  says. If any differs from what was asked for, the exit code is 1.\n\nAll names and values are checked \
                  before anything is written: switches take true or false (also on/off, 1/0), lists take one of their \
                  words, numbers are decimal in the parameter's unit. Nothing is ever written to a module that is not \
                  identified, and no write is repeated.\n\nA new address is in force at once: it is refused if something \
                  answers there already, and what follows is written to the new address. Baud rate, data format, checksum \
                  and protocol can be changed only in INIT mode and take effect after a power cycle.",
    after_help = "Examples:\n  dcon-bench set --port /dev/ttyUSB0 --address 1 pir_on_time=33 buzzer_on_pir=off\n  dcon-bench \
                  set --port COM3 --address 1 address=5 alarm_limit=45.5 alarm_mode=latched\n  dcon-bench set --tcp \
                  192.168.255.1 --address 1 temperature_offset=-1.25"
)]
pub struct SetArgs {
    /// Names of parameters with their new values
    #[arg(required = true, value_name = "NAME=VALUE")]
    values: Vec<Assignment>,
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    module: ModuleArgs,
}

pub fn run(args: &SetArgs) -> Outcome {
    refuse_repeated(&args.values)?;
    let mut module = Module::open(&args.line, &args.module, |definition, protocol| {
        let check = |new: &Assignment| names::new_value(definition, protocol, &new.name, &new.value).map(|_| ());
        args.values.iter().try_for_each(check)
    })?;
    let definition = module.definition.clone();
    let mut changes = Vec::new();
    for new in &args.values {
        changes.push(names::new_value(&definition, module.target.protocol, &new.name, &new.value)?);
    }
    let ids = changes.iter().map(|(item, _)| item.id.clone()).collect();
    let old = module.session.read(module.target, &definition, ItemSet::Named(ids))?;
    let mut all_taken = true;
    for (item, value) in &changes {
        all_taken &= change(&mut module, item, value, &old)?;
    }
    if all_taken { Ok(()) } else { Err(Stop::Reported) }
}

fn refuse_repeated(values: &[Assignment]) -> Outcome {
    let mut seen = std::collections::BTreeSet::new();
    match values.iter().find(|new| !seen.insert(new.name.as_str())) {
        Some(new) => Err(Stop::usage(format!("{} is given twice", new.name))),
        None => Ok(()),
    }
}

/// Writes one value and reports. False if the module does not hold it now.
fn change(module: &mut Module, item: &Item, value: &Value, old: &Values) -> Outcome<bool> {
    let result = module.session.write(module.target, &module.definition, item, value.clone())?;
    let taken = result.is_ok();
    match &result {
        Ok(new) => output::line(&report(item, old, new))?,
        // The definition knows what a module refuses.
        Err(error @ WriteError::Refused { .. }) => output::error(&format!("{error}\n{}: {}", item.label, item.help)),
        Err(error) => output::error(&error.to_string()),
    }
    if let Some(address) = moves_to(item, value) {
        follow(module, address, &result)?;
    }
    Ok(taken)
}

fn report(item: &Item, old: &Values, new: &Value) -> String {
    let old = old.iter().find(|answer| answer.id == item.id).and_then(|answer| answer.result.as_ref().ok());
    let old = old.map_or_else(|| "–".to_owned(), ToString::to_string);
    let unit = if item.unit.is_empty() { String::new() } else { format!(" {}", item.unit) };
    let when = if item.applies == Applies::Init { "  (takes effect after a power cycle)" } else { "" };
    format!("{}: {old} -> {new}{unit}{when}", item.id)
}

/// Finds the module again after its address was written.
fn follow(module: &mut Module, address: u8, result: &Result<Value, WriteError>) -> Outcome {
    match result {
        Ok(_) => {
            module.target.address = address;
            return Ok(());
        }
        Err(WriteError::NotVerified { .. } | WriteError::Unknown { .. } | WriteError::Differs { .. }) => {}
        Err(_) => return Ok(()),
    }
    for place in [Target { address, ..module.target }, module.target] {
        if module.session.identify(place)?.is_ok() {
            output::message(&format!("The module answers at {place} (with DIP 2 OFF the switches rule its address)"));
            module.target = place;
            return Ok(());
        }
    }
    Err(Stop::failed("the module answers neither at its old nor at its new address – nothing more was written"))
}
