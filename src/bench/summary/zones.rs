//! What the sensor sees, zone by zone.

use crate::bench::Module;
use crate::module::Value;
use crate::picture::{Zone, ZoneState};

/// The zones that the model has and what is to be said of them together; none if it has no sensor. Zones of which the
/// protocol does not tell are not known.
pub fn of(module: &Module) -> (Vec<Zone>, String) {
    let numbers: Vec<u8> = module
        .definition()
        .into_iter()
        .flat_map(|definition| &definition.items)
        .filter_map(|item| item.id.strip_prefix("pir")?.parse().ok())
        .collect();
    let whole = module.item("pir");
    let offered = |id: &str| module.item(id).is_some_and(|item| module.has(item));
    let untold = format!("{} reports no motion", module.target.protocol.label());
    if numbers.is_empty() {
        let zone = Zone { label: "PIR".to_owned(), state: seen(module, "pir") };
        let note = if offered("pir") { String::new() } else { untold };
        return (whole.map(|_| zone).into_iter().collect(), note);
    }
    let zone = |number: &u8| Zone { label: format!("PIR {number}"), state: state(module, *number) };
    let zones: Vec<Zone> = numbers.iter().map(zone).collect();
    let note = match seen(module, "pir") {
        _ if numbers.iter().any(|number| offered(&format!("pir{number}"))) => String::new(),
        _ if !offered("pir") => untold,
        ZoneState::Motion => "any sensor: motion".to_owned(),
        ZoneState::Quiet => "any sensor: quiet".to_owned(),
        ZoneState::Disabled | ZoneState::Unknown => "any sensor: not known".to_owned(),
    };
    (zones, note)
}

fn state(module: &Module, number: u8) -> ZoneState {
    let enabled = module.known(&format!("pir{number}_enabled")).and_then(Value::as_bool);
    if enabled == Some(false) { ZoneState::Disabled } else { seen(module, &format!("pir{number}")) }
}

fn seen(module: &Module, id: &str) -> ZoneState {
    match module.known(id).and_then(Value::as_bool) {
        Some(true) => ZoneState::Motion,
        Some(false) => ZoneState::Quiet,
        None => ZoneState::Unknown,
    }
}
