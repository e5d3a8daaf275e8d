//! What a tooltip tells of an item, from its definition: what it means, its values, how it is reached and where the
//! manual speaks of it.

use crate::bench::Module;
use crate::module::{Access, Applies, CommandAccess, Definition, Item, Kind, ModbusPlace};

/// Help, values, factory value, the commands and registers behind it, and where that is written.
pub fn explanation(module: &Module, item: &Item) -> String {
    let mut lines = vec![item.help.clone()];
    match (item.read_only, &item.kind) {
        (false, _) => lines.push(format!("Values: {}", item.allowed())),
        (true, Kind::Number { .. }) => lines.push(format!("Range: {}", item.allowed())),
        (true, _) => {}
    }
    match &item.factory {
        Some(factory) => lines.push(format!("Factory: {}", item.text(factory))),
        None if !item.is_reading() && !item.read_only => lines.push("Factory: the manual does not tell".to_owned()),
        None => {}
    }
    if item.applies == Applies::Init {
        lines.push("Written in INIT mode only, in force after a power cycle".to_owned());
    }
    if let Some(definition) = module.definition() {
        let commands: Vec<String> = item.accesses.iter().filter_map(|access| command(definition, access)).collect();
        lines.extend((!commands.is_empty()).then(|| format!("Command: {}", commands.join("; "))));
    }
    let places: Vec<String> = item.accesses.iter().filter_map(place).collect();
    lines.extend((!places.is_empty()).then(|| format!("Modbus: {}", places.join(", "))));
    lines.push(format!("Name: {}   Manual: {}", item.id, item.source));
    lines.join("\n")
}

/// `$AARV, written by $AAWV (DCON)`.
fn command(definition: &Definition, access: &Access) -> Option<String> {
    let Access::Command(CommandAccess { command, protocol, .. }) = access else { return None };
    let command = definition.commands.get(*command)?;
    let [read, write] = [&command.read, &command.write].map(|template| template.as_ref().map(|known| known.source()));
    let syntax = match (read, write) {
        (Some(read), Some(write)) => format!("{read}, written by {write}"),
        (Some(only), None) | (None, Some(only)) => only.to_owned(),
        (None, None) => return None,
    };
    Some(match command.function {
        Some(function) => format!("function {function:02X}h {syntax}"),
        None => format!("{syntax} ({})", protocol.label()),
    })
}

/// `register 486 (wire 485)`.
fn place(access: &Access) -> Option<String> {
    let Access::Modbus(access) = access else { return None };
    let (space, first, count) = match access.place {
        ModbusPlace::Coils { first, count } => ("coil", first, count),
        ModbusPlace::Holding { first, count } => ("register", first, count),
        ModbusPlace::Input { first, count } => ("input register", first, count),
    };
    let wire = first.saturating_sub(1);
    Some(match count {
        1 => format!("{space} {first} (wire {wire})"),
        _ => format!("{space}s {first} to {} (wire {wire})", first.saturating_add(count).saturating_sub(1)),
    })
}
