//! The command reference of a model as Markdown, made from its definition alone: every command with its fields, every coil
//! and register, and of what is in them the name, range, unit, access, meaning and section of the manual.

use std::fmt::Write;

use super::markdown::{code, escaped};
use crate::bench::console::{ReferenceEntry, ReferenceField, RegisterEntry, Space, reference, register_table};
use crate::bench::tab_label;
use crate::module::definition::ModbusAccess;
use crate::module::{Access, Action, Applies, Bits, Definition, Fixed, Item, Kind, ModbusPlace};
use crate::protocol::Protocol;

/// The commands of a model: what goes over DCON, and Modbus functions of its own.
pub fn commands(definition: &Definition) -> String {
    let mut text = format!("# {}: commands\n\n", escaped(&definition.label));
    if definition.commands.is_empty() {
        text.push_str("The definition of this model names no commands.\n");
        return text;
    }
    let _ = writeln!(
        text,
        "From the {}; section numbers are those of the manual. `AA` is the address in two hexadecimal digits. A checksum, \
         where it is enabled, and the carriage return at the end are not shown. `?AA` is the answer to what is refused.\n",
        escaped(&definition.manual)
    );
    for entry in reference(definition) {
        command(&mut text, definition, &entry);
    }
    text
}

fn command(text: &mut String, definition: &Definition, entry: &ReferenceEntry) {
    let _ = writeln!(text, "## {}\n", escaped(&entry.title));
    let function = entry.function.map_or_else(String::new, |function| format!("Modbus function {function:02X}h with "));
    for (word, syntax) in [("Read", &entry.syntax_read), ("Write", &entry.syntax_write)] {
        if let Some(syntax) = syntax {
            let _ = writeln!(text, "- **{word}:** {function}{}", code(syntax));
        }
    }
    if !entry.answers.is_empty() {
        let answers: Vec<String> = entry.answers.iter().map(|answer| code(answer)).collect();
        let _ = writeln!(text, "- **Answer:** {}", answers.join(" or "));
    }
    if entry.broadcast {
        text.push_str("- **Broadcast:** every module of the line hears it, none answers\n");
    }
    for field in &entry.fields {
        let _ = writeln!(text, "- **Field:** {} – {}", code(&field.name), escaped(&field_words(field)));
    }
    for id in &entry.items {
        if let Some(item) = definition.item(id) {
            let _ = writeln!(text, "- **{}** ({}): {}", escaped(&item.label), code(id), item_words(item));
        } else if let Some(action) = definition.action(id) {
            let _ = writeln!(text, "- **{}** ({}): {}", escaped(&action.label), code(id), escaped(&action.help));
        }
    }
    if !entry.note.is_empty() {
        let _ = writeln!(text, "- **Note:** {}", escaped(&entry.note));
    }
    if !entry.source.is_empty() {
        let _ = writeln!(text, "- **Manual:** {}", escaped(&entry.source));
    }
    text.push('\n');
}

/// What a field takes, with the codes that have a meaning.
fn field_words(field: &ReferenceField) -> String {
    let mut words = if field.hint.is_empty() { field.form() } else { field.hint.clone() };
    let whole = field.choices.iter().map(|choice| (choice.code.clone(), choice.meaning.as_str()));
    if let Some(codes) = codes(whole) {
        let _ = write!(words, "; {codes}");
    }
    for part in &field.parts {
        // That 1 is yes goes without saying.
        let usual =
            part.choices.iter().all(|(number, meaning)| meaning.ends_with(if *number == 1 { ": yes" } else { ": no" }));
        if let Some(codes) = codes(part.choices.iter().map(|(number, meaning)| (number.to_string(), meaning.as_str())))
            && !usual
        {
            let _ = write!(words, "; {}: {codes}", part.label);
        }
    }
    words
}

/// `0 = no, 1 = yes`, without the name of what it is about.
fn codes<'a>(choices: impl Iterator<Item = (String, &'a str)>) -> Option<String> {
    let one = |(code, meaning): (String, &str)| {
        format!("{code} = {}", meaning.rsplit_once(": ").map_or(meaning, |(_, value)| value))
    };
    let all: Vec<String> = choices.map(one).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

/// Values, access and meaning.
fn item_words(item: &Item) -> String {
    let factory = item.factory.as_ref().map(|value| format!("factory setting {}", item.text(value)));
    let facts: Vec<String> =
        [Some(item.allowed()), Some(access_words(item).to_owned()), factory].into_iter().flatten().collect();
    format!("{}. {}", escaped(&facts.join("; ")), escaped(&item.help))
}

fn access_words(item: &Item) -> &'static str {
    match (item.read_only, item.applies) {
        (true, _) => "read only",
        (false, Applies::Now) => "read and write",
        (false, Applies::Init) => "read and write, in INIT mode only",
    }
}

fn bits_words(bits: Bits) -> String {
    if bits.low == bits.high { format!("bit {}", bits.low) } else { format!("bits {} to {}", bits.low, bits.high) }
}

/// The coils and registers of a model.
pub fn registers(definition: &Definition) -> String {
    let mut text = format!("# {}: registers\n\n", escaped(&definition.label));
    let mut entries = register_table(definition, Protocol::ModbusRtu);
    for entry in register_table(definition, Protocol::ModbusTcp) {
        let same = |known: &RegisterEntry| {
            (known.space, known.number, known.count) == (entry.space, entry.number, entry.count)
        };
        match entries.iter_mut().find(|known| same(known)) {
            Some(known) => {
                known.items.extend(entry.items.into_iter().filter(|id| !known.items.contains(id)).collect::<Vec<_>>())
            }
            None => entries.push(entry),
        }
    }
    entries.sort_by_key(|entry| (entry.space, entry.number, entry.count));
    if entries.is_empty() {
        text.push_str("The definition of this model names no coils or registers.\n");
        return text;
    }
    let _ = writeln!(
        text,
        "From the {}; section numbers are those of the manual. Numbers count from 1 within their kind, as in the manual, which \
         may put a digit before them for the kind or function; the number on the wire, in hexadecimal digits, is one less. R can be \
         read, W can be written.\n",
        escaped(&definition.manual)
    );
    for (space, title, functions) in SPACES {
        let mut own = entries.iter().filter(|entry| entry.space == space).peekable();
        if own.peek().is_some() {
            let _ = writeln!(text, "## {title}\n\n{functions}\n\n{HEAD}");
            own.for_each(|entry| rows(&mut text, definition, entry));
            text.push('\n');
        }
    }
    text
}

/// Name of each kind, and the functions that reach it.
const SPACES: [(Space, &str, &str); 4] = [
    (Space::Coils, "Coils", "Read by function 01, written by 05 and 15 (0Fh)."),
    (Space::DiscreteInputs, "Discrete inputs", "Read by function 02."),
    (Space::HoldingRegisters, "Holding registers", "Read by function 03, written by 06 and 16 (10h)."),
    (Space::InputRegisters, "Input registers", "Read by function 04."),
];

const HEAD: &str = "| Number | Wire | Name | Values | Access | Meaning | Manual |\n|---|---|---|---|---|---|---|";

/// One row for each item that is there.
fn rows(text: &mut String, definition: &Definition, entry: &RegisterEntry) {
    for id in &entry.items {
        if let Some(item) = definition.item(id) {
            for access in item.accesses.iter().filter_map(|access| at(access, entry)) {
                item_row(text, entry, item, access);
            }
        } else if let Some(action) = definition.action(id) {
            action_row(text, entry, action);
        }
    }
}

/// The way to an item if it leads to this place.
fn at<'a>(access: &'a Access, entry: &RegisterEntry) -> Option<&'a ModbusAccess> {
    let Access::Modbus(access) = access else { return None };
    let there = match access.place {
        ModbusPlace::Coils { first, count } => (Space::Coils, first, count),
        ModbusPlace::Holding { first, count } => (Space::HoldingRegisters, first, count),
        ModbusPlace::Input { first, count } => (Space::InputRegisters, first, count),
    };
    (there == (entry.space, entry.number, entry.count)).then_some(access)
}

fn item_row(text: &mut String, entry: &RegisterEntry, item: &Item, access: &ModbusAccess) {
    let mut number = numbers(entry);
    if let Some(bits) = access.bits {
        let _ = write!(number, ", {}", bits_words(bits));
    }
    let writable = !item.read_only && entry.space != Space::InputRegisters;
    let init = if writable && item.applies == Applies::Init { ", INIT only" } else { "" };
    let values = values_at(item, access);
    let reach = reach(access.over_rtu, access.over_tcp);
    let access = format!("{}{init}{reach}", if writable { "R/W" } else { "R" });
    let name = format!("{} ({})", escaped(&item.label), code(&item.id));
    row(text, [&number, &wire(entry), &name, &escaped(&values), &access, &escaped(&item.help), &escaped(&item.source)]);
}

/// What an item takes at this place, and how that stands there.
fn values_at(item: &Item, access: &ModbusAccess) -> String {
    let mut values = item.allowed();
    match access.range {
        Some((least, most)) if least == most => drop(write!(values, "; takes {least} only")),
        Some((least, most)) => drop(write!(values, "; here {least} to {most}")),
        None => {}
    }
    let signed = if access.signed { ", signed" } else { "" };
    match &item.kind {
        Kind::Number { min, .. } if min.decimals > 0 => {
            let _ = write!(values, "; as a number of {} {}{signed}", Fixed::new(1, min.decimals), item.unit);
        }
        Kind::Number { .. } => values.push_str(signed),
        Kind::Choice(choices) => {
            let codes: Vec<String> =
                choices.iter().filter_map(|choice| choice.modbus.first()).map(u32::to_string).collect();
            let _ = write!(values, "; as {}", codes.join(", "));
        }
        Kind::Bool if access.inverted => values.push_str("; 0 is true"),
        Kind::Bool | Kind::Text { .. } | Kind::Ipv4 => {}
    }
    values
}

fn action_row(text: &mut String, entry: &RegisterEntry, action: &Action) {
    let name = format!("{} ({})", escaped(&action.label), code(&action.id));
    let access = format!("W{}", reach(action.over_rtu, action.over_tcp));
    row(text, [&numbers(entry), &wire(entry), &name, "1", &access, &escaped(&action.help), &escaped(&action.source)]);
}

fn row(text: &mut String, cells: [&str; 7]) {
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}

fn numbers(entry: &RegisterEntry) -> String {
    let last = entry.number.saturating_add(entry.count.saturating_sub(1));
    if last == entry.number { entry.number.to_string() } else { format!("{}–{last}", entry.number) }
}

fn wire(entry: &RegisterEntry) -> String {
    format!("{:04X}", entry.wire())
}

fn reach(over_rtu: bool, over_tcp: bool) -> &'static str {
    match (over_rtu, over_tcp) {
        (true, false) => ", RTU only",
        (false, true) => ", TCP only",
        _ => "",
    }
}

/// Both for those who read it elsewhere, under one title.
pub fn whole(definition: &Definition) -> String {
    let part = |text: String, title: &str| {
        let below = text.split_once('\n').map_or("", |(_, below)| below).replace("\n## ", "\n### ");
        format!("## {title}\n{below}")
    };
    let identity = &definition.identity.dcon_names;
    let tabs = tabs(definition);
    let told = if identity.is_empty() { String::new() } else { format!("It calls itself {}. ", identity.join(" or ")) };
    format!(
        "# {}\n\n{}Its tabs: {}.\n\n{}{}",
        escaped(&definition.label),
        escaped(&told),
        escaped(&tabs),
        part(commands(definition), "Commands"),
        part(registers(definition), "Registers")
    )
}

fn tabs(definition: &Definition) -> String {
    let mut labels: Vec<&str> = Vec::new();
    for item in &definition.items {
        let label = tab_label(&item.tab);
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels.join(", ")
}
