//! The switches of every model as tables, made from the definitions.

use std::fmt::Write;

use super::markdown::escaped;
use crate::module::{Catalogue, Definition};

const BEGIN: &str = include_str!("../../assets/help/switches.md");

pub fn article(catalogue: &Catalogue) -> String {
    let mut text = BEGIN.to_owned();
    for definition in catalogue.iter() {
        model(&mut text, definition);
    }
    text
}

fn model(text: &mut String, definition: &Definition) {
    let layout = &definition.switch_layout;
    if layout.banks.is_empty() && layout.rotary.is_none() {
        return;
    }
    let _ = writeln!(
        text,
        "\n## {}\n\n| Switch | What | ON and OFF | Meaning |\n|---|---|---|---|",
        escaped(&definition.label)
    );
    for bank in &layout.banks {
        for group in &bank.groups {
            let positions = if group.first == group.last {
                group.first.to_string()
            } else {
                format!("{} to {}", group.first, group.last)
            };
            for (index, row) in group.rows.iter().enumerate() {
                // What does not change is said once.
                let (switch, label) = match index {
                    0 => (format!("{} {positions}", bank.name), group.label.as_str()),
                    _ => (String::new(), ""),
                };
                let set: Vec<&str> = row.set.iter().map(|on| if *on { "ON" } else { "OFF" }).collect();
                let factory = if row.factory { " (factory setting)" } else { "" };
                let (switch, label, means) = (escaped(&switch), escaped(label), escaped(&row.means));
                let _ = writeln!(text, "| {switch} | {label} | {} | {means}{factory} |", set.join(" "));
            }
        }
    }
    if let Some(rotary) = &layout.rotary {
        let _ = writeln!(text, "| {} | Address | 0 to F | {} |", escaped(&rotary.label), escaped(&rotary.help));
    }
}
