//! Which command of a definition a text is, and what its fields hold; for DCON and for Modbus functions of the maker's own.

use super::super::access;
use super::super::definition::{Access, Choice, Command, Definition, FillFrom, Item, Kind};
use super::super::notation::{ANSWERED_FROM, Fields, INIT_ADDRESS, Template};
use super::{ExplainedField, named};

/// Whether a command asks or changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Read,
    Write,
}

/// A request that the definition knows.
pub struct Known<'a> {
    pub form: Form,
    /// What it does, for a person.
    pub title: String,
    /// `None` for a command that only sets one value or carries out an action.
    pub command: Option<(usize, &'a Command)>,
    pub fields: Vec<ExplainedField>,
    /// The values that it carries.
    pub values: Vec<String>,
}

/// Finds the command that `text` is: a DCON command without checksum (`function` is `None`), or the data bytes of a Modbus
/// function in hexadecimal. Where a text has the shape of a read and of a write, it is the write.
pub fn recognise<'a>(definition: &'a Definition, function: Option<u8>, text: &str) -> Option<Known<'a>> {
    let address = if function.is_none() { address_of(text) } else { None }.unwrap_or(INIT_ADDRESS);
    let own = || if function.is_none() { own_command(definition, address, text) } else { None };
    let find = |form: Form| {
        let commands = definition.commands.iter().enumerate().filter(|(_, command)| command.function == function);
        commands.into_iter().find_map(|(index, command)| {
            let shape = if form == Form::Write { command.write.as_ref() } else { command.read.as_ref() };
            let (shape, fields) = access::fitting(command, shape, address, text)?;
            Some(known(definition, form, (index, command), shape, fields))
        })
    };
    own().or_else(|| find(Form::Write)).or_else(|| find(Form::Read))
}

/// The address behind a DCON delimiter.
pub fn address_of(text: &str) -> Option<u8> {
    text.get(1..3)
        .filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))
        .and_then(|digits| u8::from_str_radix(digits, 16).ok())
}

/// What the fields of an answer to `command` hold; `None` if it has none of the known shapes.
pub fn answered(
    definition: &Definition,
    (index, command): (usize, &Command),
    address: u8,
    text: &str,
) -> Option<(Vec<ExplainedField>, Vec<String>)> {
    let (shape, fields) = access::fitting(command, &command.answers, address, text)?;
    Some(explained(definition, index, command, shape, &fields))
}

fn known<'a>(
    definition: &'a Definition,
    form: Form,
    (index, command): (usize, &'a Command),
    shape: &Template,
    mut fields: Fields,
) -> Known<'a> {
    // Values are found under the names that the answer to the read gives them.
    for (name, from) in &command.filled_from {
        if let (FillFrom::Field(answered), Some(text)) = (from, fields.get(name).cloned()) {
            fields.entry(answered.clone()).or_insert(text);
        }
    }
    let (fields, values) = explained(definition, index, command, shape, &fields);
    Known { form, title: title(&command.title, form), command: Some((index, command)), fields, values }
}

/// "Read or set the response delay", or "Read the status, or set the outputs", is one of the two.
fn title(both: &str, form: Form) -> String {
    let set = |what: &str| format!("Set {what}");
    match (both.strip_prefix("Read or set "), both.split_once(", or set "), form) {
        (Some(what), _, Form::Read) => format!("Read {what}"),
        (Some(what), _, Form::Write) => set(what),
        (None, Some((read, _)), Form::Read) => read.to_owned(),
        (None, Some((_, what)), Form::Write) => set(what),
        (None, None, _) => both.to_owned(),
    }
}

fn explained(
    definition: &Definition,
    index: usize,
    command: &Command,
    shape: &Template,
    fields: &Fields,
) -> (Vec<ExplainedField>, Vec<String>) {
    let mut explained = Vec::new();
    let mut all = Vec::new();
    for name in std::iter::once(ANSWERED_FROM).chain(shape.field_names()) {
        let Some(raw) = fields.get(name) else { continue };
        if name == ANSWERED_FROM {
            explained.push(address_field(raw));
            continue;
        }
        let values = values(definition, index, command, name, fields);
        let shown = if shape.width(name).is_some() { name.repeat(raw.len()) } else { format!("({name})") };
        explained.push(ExplainedField::new(shown, raw, values.join(", ")));
        all.extend(values);
    }
    (explained, all)
}

/// `AA 2A`: address 42.
pub fn address_field(digits: &str) -> ExplainedField {
    let number = u8::from_str_radix(digits, 16).map(|address| format!("address {address}")).unwrap_or_default();
    ExplainedField::new(ANSWERED_FROM, digits, number)
}

/// The items that live in the field `name`, which a write may call otherwise than the answer to its read.
fn values(definition: &Definition, index: usize, command: &Command, name: &str, fields: &Fields) -> Vec<String> {
    let answered = match command.filled_from.get(name) {
        Some(FillFrom::Field(answered)) => answered.as_str(),
        _ => name,
    };
    let mut found = Vec::new();
    for item in &definition.items {
        for access in &item.accesses {
            let Access::Command(access) = access else { continue };
            if access.command != index || access.field != answered {
                continue;
            }
            if let Ok(value) = access::value_in_fields(definition, item, access, command, fields) {
                found.push(named(item, &value));
            }
        }
    }
    found
}

/// A command that sets one value of one item (`@AADA`), or that carries out an action.
fn own_command<'a>(definition: &Definition, address: u8, text: &str) -> Option<Known<'a>> {
    let fits = |template: Option<&Template>| template.is_some_and(|template| template.read(address, text).is_some());
    let of_item = |item: &Item| {
        let Kind::Choice(choices) = &item.kind else { return None };
        let choice: &Choice = choices.iter().find(|choice| fits(choice.dcon_write.as_ref()))?;
        let value = super::Value::Choice(choice.word.clone());
        Some((item.label.clone(), vec![named(item, &value)]))
    };
    let of_action = || {
        let action = definition.actions.iter().find(|action| fits(action.dcon.as_ref()))?;
        Some((action.label.clone(), Vec::new()))
    };
    let (title, values) = definition.items.iter().find_map(of_item).or_else(of_action)?;
    let fields = text.get(1..3).filter(|_| address_of(text).is_some()).map(address_field);
    Some(Known { form: Form::Write, title, command: None, fields: fields.into_iter().collect(), values })
}
