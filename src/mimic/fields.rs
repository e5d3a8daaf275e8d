//! Between the items of a module and the fields of its commands, from the module's side.

use super::store::{Change, Refusal, Store};
use super::texts;
use crate::module::definition::{Command, CommandAccess, Encoding, FillFrom};
use crate::module::notation::{ANSWERED_FROM, Fields, Template};
use crate::module::write::{field_text, written_field};
use crate::module::{Access, Field, Item, Kind, Value, access};
use crate::protocol::hex;

/// What a command makes of a message that has its shape.
pub(super) enum Heard {
    /// The answer of a read, address included.
    Answer(String),
    /// The values and fields that a write brings.
    Write(Result<Vec<Change>, Refusal>),
}

/// What the commands of one protocol, or of one non-standard function, make of `text`; nothing if none has its shape.
pub(super) fn hear(store: &mut Store, function: Option<u8>, address: u8, text: &str) -> Option<Heard> {
    let definition = store.definition.clone();
    let commands = || definition.commands.iter().enumerate().filter(|(_, command)| command.function == function);
    let asks = |template: &Template| template.fill(address, &Fields::new()).is_ok_and(|question| question == text);
    if let Some((index, command)) = commands().find(|(_, command)| command.read.as_ref().is_some_and(asks)) {
        let answer = answer(store, index, command, address)?;
        for (item, _) in items(&definition.items, index) {
            store.was_read(&item.id);
        }
        return Some(Heard::Answer(answer));
    }
    for (index, command) in commands() {
        let Some(template) = &command.write else { continue };
        let fields = template.read(address, text).filter(|fields| access::fits(command, fields));
        if let Some(fields) = fields {
            return Some(Heard::Write(write(store, index, command, template, &fields)));
        }
    }
    None
}

/// The items that a command carries.
fn items(all: &[Item], command: usize) -> impl Iterator<Item = (&Item, &CommandAccess)> {
    all.iter().flat_map(move |item| {
        item.accesses.iter().filter_map(move |access| match access {
            Access::Command(access) if access.command == command => Some((item, access)),
            _ => None,
        })
    })
}

/// The first shape of the answer, filled.
fn answer(store: &Store, index: usize, command: &Command, address: u8) -> Option<String> {
    let template = command.answers.first()?;
    let mut fields = Fields::new();
    for name in template.field_names() {
        fields.insert(name.to_owned(), unnamed(store, index, command, template, name, address));
    }
    let mut numbers: Vec<(String, usize, String)> = Vec::new();
    for (item, access) in items(&store.definition.items, index) {
        if template.field_names().all(|name| name != access.field) {
            continue;
        }
        let value = store.value(item);
        if let (Some(Field::Decimal), text) = (command.fields.get(&access.field), decimal(&value)) {
            numbers.push((access.field.clone(), access.index.unwrap_or(0), text));
        } else if let Some(text) = text_of(store, command, template, item, access, &value, &fields) {
            fields.insert(access.field.clone(), text);
        }
    }
    for name in template.field_names() {
        let last = numbers.iter().filter(|(field, ..)| field == name).map(|(_, at, _)| *at).max();
        if let Some(last) = last.filter(|last| *last < 64) {
            let at = |place: usize| numbers.iter().find(|(field, at, _)| field == name && *at == place);
            let all = (0..=last).map(|place| at(place).map_or("+000.00", |(_, _, text)| text.as_str()));
            fields.insert(name.to_owned(), all.collect());
        }
    }
    template.fill(address, &fields).ok()
}

/// What stands in a field, or in those of its bits, that no item names.
fn unnamed(store: &Store, index: usize, command: &Command, template: &Template, name: &str, address: u8) -> String {
    let width = template.width(name);
    let fits = |text: &&str| width.is_none_or(|width| width == text.len());
    if let Some(text) = store.field(index, name).filter(fits) {
        return text.to_owned();
    }
    match command.filled_from.get(name) {
        Some(FillFrom::Text(constant)) if fits(&constant.as_str()) => constant.clone(),
        Some(FillFrom::Address) if width == Some(2) => format!("{address:02X}"),
        _ => match (command.fields.get(name), width) {
            (Some(Field::Decimal), None) => "+000.00".to_owned(),
            (_, width) => "0".repeat(width.unwrap_or(2)),
        },
    }
}

fn decimal(value: &Value) -> String {
    match value {
        Value::Number(number) => number.to_dcon(),
        Value::Bool(on) => format!("+{}", u8::from(*on)),
        other => format!("+{other}"),
    }
}

fn text_of(
    store: &Store,
    command: &Command,
    template: &Template,
    item: &Item,
    access: &CommandAccess,
    value: &Value,
    fields: &Fields,
) -> Option<String> {
    let kind = command.fields.get(&access.field);
    let width = template.width(&access.field);
    match (kind, &item.kind) {
        (Some(Field::Hex), Kind::Text { .. }) => {
            let plain = access.encoding == Encoding::Plain;
            let bytes = texts::bytes(&store.definition, access.encoding, false, &value.to_string());
            let text = hex::spaced(&bytes).replace(' ', "");
            let wide = width.unwrap_or(text.len());
            (!plain).then(|| text.chars().chain(std::iter::repeat('0')).take(wide).collect())
        }
        // Written texts have the width of their field.
        (Some(Field::Text), _) => {
            let text = value.to_string();
            let wide = width.unwrap_or(text.len());
            Some(text.chars().chain(std::iter::repeat(' ')).take(wide).collect())
        }
        _ => field_text(item, access, width, fields, &access.field, value, kind).ok(),
    }
}

/// What a write changes, all or nothing. Fields are kept as they came where that is more than the items tell.
fn write(
    store: &mut Store,
    index: usize,
    command: &Command,
    template: &Template,
    fields: &Fields,
) -> Result<Vec<Change>, Refusal> {
    let definition = store.definition.clone();
    let mut changes = Vec::new();
    for (item, access) in items(&definition.items, index).filter(|(item, _)| !item.read_only) {
        let written = written_field(command, template, &access.field).and_then(|name| fields.get(&name));
        let Some(text) = written else { continue };
        let own = Fields::from([(access.field.clone(), text.clone())]);
        let value = access::value_in_fields(&definition, item, access, command, &own).map_err(|_| Refusal::Value)?;
        store.judge(item, &value)?;
        changes.push((item.id.clone(), value));
    }
    for (name, text) in fields.iter().filter(|(name, _)| *name != ANSWERED_FROM) {
        let read_as = match command.filled_from.get(name) {
            Some(FillFrom::Field(other)) => other,
            _ => name,
        };
        store.keep_field(index, read_as.clone(), text.clone());
    }
    Ok(changes)
}
