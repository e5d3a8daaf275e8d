//! Names that users type: checked against the definitions, with the nearest name where there is none.

use super::Outcome;
use super::stop::Stop;
use crate::module::{Action, Catalogue, Definition, Item, Value, check_write};
use crate::protocol::Protocol;

/// Why a definition does not serve a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// It has no such name; these are the names it has.
    Unknown { what: &'static str, name: String, known: Vec<String> },
    /// It has, but not in this way.
    Refused(String),
}

impl From<Refusal> for Stop {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Refused(reason) => Self::Usage(reason),
            Refusal::Unknown { what, name, known } => Self::Usage(unknown(what, &name, &known)),
        }
    }
}

/// The item `name` of `definition`, if `protocol` offers it.
pub fn item<'a>(definition: &'a Definition, protocol: Protocol, name: &str) -> Result<&'a Item, Refusal> {
    let item = definition.item(name).ok_or_else(|| Refusal::Unknown {
        what: "parameter or reading",
        name: name.to_owned(),
        known: definition.items_over(protocol).map(|item| item.id.clone()).collect(),
    })?;
    if item.is_offered(protocol) { Ok(item) } else { Err(not_offered(protocol, name)) }
}

/// The item `name` and the value that `text` means for it, if both can be written over `protocol`.
pub fn new_value<'a>(
    definition: &'a Definition,
    protocol: Protocol,
    name: &str,
    text: &str,
) -> Result<(&'a Item, Value), Refusal> {
    let item = item(definition, protocol, name)?;
    let value = item.parse(text).map_err(|error| Refusal::Refused(error.to_string()))?;
    check_write(definition, protocol, item, &value).map_err(|error| Refusal::Refused(error.to_string()))?;
    Ok((item, value))
}

/// The action `name` of `definition`, if `protocol` offers it.
pub fn action<'a>(definition: &'a Definition, protocol: Protocol, name: &str) -> Result<&'a Action, Refusal> {
    let action = definition.action(name).ok_or_else(|| Refusal::Unknown {
        what: "action",
        name: name.to_owned(),
        known: definition.actions.iter().filter(|action| action.is_offered(protocol)).map(|a| a.id.clone()).collect(),
    })?;
    if action.is_offered(protocol) { Ok(action) } else { Err(not_offered(protocol, name)) }
}

fn not_offered(protocol: Protocol, name: &str) -> Refusal {
    Refusal::Refused(format!("{name} is not offered over {}", protocol.label()))
}

/// Whether `check` passes for some definition; if for none, the reason of one that has the name.
pub fn some_definition(catalogue: &Catalogue, check: impl Fn(&Definition) -> Result<(), Refusal>) -> Outcome {
    let mut reason = None;
    for definition in catalogue.iter() {
        let Err(refusal) = check(definition) else { return Ok(()) };
        reason = Some(match (reason, refusal) {
            (None, refusal) => refusal,
            (Some(Refusal::Unknown { what, name, known: mut names }), Refusal::Unknown { known, name: other, .. })
                if name == other =>
            {
                names.extend(known.into_iter().filter(|name| !names.contains(name)).collect::<Vec<_>>());
                Refusal::Unknown { what, name, known: names }
            }
            // This one has what the other lacks, and so came further.
            (Some(Refusal::Unknown { name: lacked, known: names, .. }), Refusal::Unknown { what, name, known })
                if known.contains(&lacked) && !names.contains(&name) =>
            {
                Refusal::Unknown { what, name, known }
            }
            (Some(Refusal::Unknown { .. }), refusal @ Refusal::Refused(_)) => refusal,
            (Some(first), _) => first,
        });
    }
    reason.map_or(Ok(()), |refusal| Err(refusal.into()))
}

/// So many names are still read where the one that was meant is told already.
const MOST_LISTED: usize = 20;

fn unknown(what: &str, name: &str, known: &[String]) -> String {
    let nearest = nearest(name, known);
    let hint = if nearest.is_empty() { String::new() } else { format!(" – did you mean {}?", nearest.join(" or ")) };
    let all = match hint.is_empty() || known.len() <= MOST_LISTED {
        true => format!("\nThere are: {}", known.join(", ")),
        false => String::new(),
    };
    format!("there is no {what} \"{name}\" here{hint}{all}")
}

/// The known names that are most like `name`, at most three.
fn nearest<'a>(name: &str, known: &'a [String]) -> Vec<&'a str> {
    let name = name.to_ascii_lowercase().replace('-', "_");
    let most = name.chars().count().div_ceil(3);
    let mut near: Vec<(usize, &str)> = known
        .iter()
        .map(|known| (if known.contains(&name) && name.len() > 2 { 1 } else { distance(&name, known) }, known.as_str()))
        .filter(|(distance, _)| *distance <= most)
        .collect();
    near.sort();
    near.into_iter().take(3).map(|(_, name)| name).collect()
}

/// How many characters have to be added, removed or changed to make one of the other.
fn distance(one: &str, other: &str) -> usize {
    let mut row: Vec<usize> = (0..=other.chars().count()).collect();
    for (i, a) in one.chars().enumerate() {
        let mut next = vec![i.saturating_add(1)];
        for ((b, above_left), above) in other.chars().zip(row.iter()).zip(row.iter().skip(1)) {
            let left = next.last().copied().unwrap_or_default();
            let changed = above_left.saturating_add(usize::from(a != b));
            next.push(changed.min(above.saturating_add(1)).min(left.saturating_add(1)));
        }
        row = next;
    }
    row.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_of_names_is_that_of_levenshtein() {
        for (one, other, expected) in [("", "", 0), ("", "abc", 3), ("kitten", "sitting", 3), ("do0", "do1", 1)] {
            assert_eq!(distance(one, other), expected, "{one} {other}");
            assert_eq!(distance(other, one), expected, "{other} {one}");
        }
    }

    #[test]
    fn a_mistyped_name_finds_the_one_that_was_meant() {
        let (catalogue, _) = Catalogue::built_in();
        let known: Vec<String> =
            catalogue.get("pir-234").unwrap().items_over(Protocol::Dcon).map(|item| item.id.clone()).collect();
        assert_eq!(nearest("temprature_c", &known).first(), Some(&"temperature_c"));
        assert_eq!(nearest("pir-on-time", &known).first(), Some(&"pir_on_time"));
        assert!(nearest("xyzzyxyzzy", &known).is_empty());
    }

    #[test]
    fn what_one_definition_offers_is_not_refused_before_the_module_is_known() {
        let (catalogue, _) = Catalogue::built_in();
        let lux = |definition: &Definition| item(definition, Protocol::Dcon, "lux_level").map(|_| ());
        assert_eq!(some_definition(&catalogue, lux), Ok(()));
        let checksum = |definition: &Definition| item(definition, Protocol::ModbusRtu, "checksum").map(|_| ());
        let Err(Stop::Usage(reason)) = some_definition(&catalogue, checksum) else { panic!() };
        assert!(reason.starts_with("checksum is not offered over Modbus RTU"), "{reason}");
        let range = |definition: &Definition| new_value(definition, Protocol::ModbusRtu, "address", "0").map(|_| ());
        let Err(Stop::Usage(reason)) = some_definition(&catalogue, range) else { panic!() };
        assert!(reason.contains("1 to 247"), "{reason}");
    }
}
