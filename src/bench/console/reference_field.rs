//! The fields of a module's commands: what stands in them, as far as the items that use them tell.

use crate::module::{
    Access, Bits, Choice, Command, CommandAccess, Definition, Encoding, Field, FillFrom, Fixed, Item, Kind, Template,
    Value, raw_of_value,
};
use crate::protocol::Protocol;

/// Decimals of DCON data, `+ddd.dd` (PIR-234 manual 5.32), where no item tells another number.
const DECIMALS: u8 = 2;
/// Digits before the point of DCON data.
const WHOLE_DIGITS: usize = 3;

/// A field of a command or of its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceField {
    /// The letter, or the word in brackets.
    pub name: String,
    /// Characters; `None` if it takes the rest.
    pub width: Option<usize>,
    pub kind: Field,
    /// What it takes or tells, in words.
    pub hint: String,
    /// The texts that have a meaning, if they are known.
    pub choices: Vec<FieldChoice>,
    /// What its bits are, if several items share it.
    pub parts: Vec<FieldPart>,
    pub default: Option<FieldDefault>,
    /// Has to be filled in to write.
    pub in_write: bool,
    /// The module tells it.
    pub in_answer: bool,
    /// Decimals of a decimal field.
    decimals: u8,
}

/// A text of a field and what it means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldChoice {
    pub code: String,
    pub meaning: String,
}

/// Some bits of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldPart {
    /// Id of the item.
    pub item: String,
    pub label: String,
    pub bits: Bits,
    /// The numbers that have a meaning, before they are put in place.
    pub choices: Vec<(u64, String)>,
    /// What it takes, in words.
    pub allowed: String,
}

/// What stands in a field unless something else is wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FieldDefault {
    /// The module's address.
    Address,
    /// Always this.
    Constant(String),
    /// What the module has from the factory. A suggestion only: it is never filled in by itself.
    Factory(String),
}

impl FieldDefault {
    /// The text for a module at `address`.
    pub fn text(&self, address: u8) -> String {
        match self {
            Self::Address => format!("{address:02X}"),
            Self::Constant(text) | Self::Factory(text) => text.clone(),
        }
    }
}

impl FieldPart {
    /// The number in `text`, the hexadecimal text of the whole field.
    pub fn take(&self, text: &str) -> Option<u64> {
        u64::from_str_radix(text.trim(), 16).ok().map(|word| self.bits.take(word))
    }

    /// `text`, the hexadecimal text of the whole field, with `number` in this part; other parts stay.
    pub fn put(&self, text: &str, number: u64) -> Option<String> {
        let text = text.trim();
        let (word, width) = (u64::from_str_radix(text, 16).ok()?, text.len());
        Some(format!("{:0width$X}", self.bits.put(word, number)))
    }
}

impl ReferenceField {
    /// The text as it goes into the command. `Err` says which form the field has.
    pub fn check(&self, typed: &str) -> Result<String, String> {
        let name = &self.name;
        let typed = if self.kind == Field::Text { typed } else { typed.trim() };
        if typed.is_empty() {
            return Err(format!("{name} is missing – write {}", self.form()));
        }
        match self.kind {
            Field::Hex => {
                let fits = self.width.is_none_or(|width| width == typed.len());
                if fits && typed.bytes().all(|byte| byte.is_ascii_hexdigit()) {
                    return Ok(typed.to_ascii_uppercase());
                }
                Err(format!("\"{typed}\" does not fit {name} – write {}", self.form()))
            }
            Field::Decimal if is_dcon_data(typed, self.decimals) => Ok(typed.to_owned()),
            Field::Decimal => {
                let meant = Fixed::parse(typed, self.decimals).map(Fixed::to_dcon);
                let form = meant.filter(|meant| is_dcon_data(meant, self.decimals)).unwrap_or_else(|| self.form());
                Err(format!("\"{typed}\" does not fit {name} – write {form}"))
            }
            Field::Text => {
                let fits = self.width.is_none_or(|width| width == typed.len());
                if fits && typed.bytes().all(|byte| (b' '..=b'~').contains(&byte)) {
                    return Ok(typed.to_owned());
                }
                Err(format!("\"{typed}\" does not fit {name} – write {}", self.form()))
            }
        }
    }

    /// The form of its text, in words.
    pub fn form(&self) -> String {
        match (self.kind, self.width) {
            (Field::Hex, Some(1)) => "1 hexadecimal digit such as A".to_owned(),
            (Field::Hex, Some(width)) => format!("{width} hexadecimal digits such as {:0width$X}", 0xA),
            (Field::Hex, None) => "hexadecimal digits".to_owned(),
            (Field::Decimal, _) => {
                format!("a signed number such as {}", Fixed::from_f64(25.0, self.decimals).to_dcon())
            }
            (Field::Text, Some(1)) => "1 character".to_owned(),
            (Field::Text, Some(width)) => format!("{width} characters"),
            (Field::Text, None) => "text".to_owned(),
        }
    }
}

/// One or more numbers as `+030.00`.
fn is_dcon_data(text: &str, decimals: u8) -> bool {
    let decimals = usize::from(decimals);
    let number = |number: &str| {
        number.split_once('.').is_some_and(|(whole, fraction)| {
            whole.len() == WHOLE_DIGITS
                && fraction.len() == decimals
                && whole.bytes().chain(fraction.bytes()).all(|byte| byte.is_ascii_digit())
        })
    };
    text.strip_prefix(['+', '-']).is_some_and(|numbers| numbers.split(['+', '-']).all(number))
}

/// All fields of the command at `index`, those to fill in first.
pub fn fields_of(definition: &Definition, index: usize, command: &Command) -> Vec<ReferenceField> {
    let templates = || command.write.iter().chain(&command.answers);
    let mut names: Vec<&str> = Vec::new();
    for name in templates().flat_map(Template::field_names) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.into_iter().map(|name| field(definition, index, command, name)).collect()
}

fn field(definition: &Definition, index: usize, command: &Command, name: &str) -> ReferenceField {
    let mut templates = command.write.iter().chain(&command.answers);
    let has = |template: &Template| template.field_names().any(|known| known == name);
    let filled_from = command.filled_from.get(name);
    // The write may call by another letter what the answer tells.
    let other_name = match filled_from {
        Some(FillFrom::Field(other)) => Some(other.as_str()),
        _ => None,
    };
    let users = users(definition, index, name, other_name);
    let width = templates.find(|template| has(template)).and_then(|template| template.width(name));
    let whole = users.iter().find(|(_, access)| access.bits.is_none() && access.index.is_none());
    let mut field = ReferenceField {
        name: name.to_owned(),
        width,
        kind: command.fields.get(name).copied().unwrap_or(Field::Text),
        hint: String::new(),
        choices: whole.map(|(item, access)| choices(item, access, width)).unwrap_or_default(),
        parts: users.iter().filter_map(|(item, access)| part(item, access)).collect(),
        default: None,
        in_write: command.write.as_ref().is_some_and(has),
        in_answer: command.answers.iter().any(has),
        decimals: users.iter().find_map(|(item, _)| decimals(item)).unwrap_or(DECIMALS),
    };
    if field.in_write && field.choices.is_empty() && field.parts.is_empty() {
        field.choices = choices_of_own_commands(definition, command, name);
    }
    field.default = match filled_from {
        Some(FillFrom::Address) => Some(FieldDefault::Address),
        Some(FillFrom::Text(text)) => Some(FieldDefault::Constant(text.clone())),
        _ => whole.filter(|_| field.in_write).and_then(|(item, access)| factory(item, access, &field)),
    };
    field.hint = hint(&field, filled_from, &users);
    field
}

/// The items that are found in a field.
fn users<'a>(
    definition: &'a Definition,
    index: usize,
    name: &str,
    other_name: Option<&str>,
) -> Vec<(&'a Item, &'a CommandAccess)> {
    let uses = |access: &&CommandAccess| {
        access.command == index && (access.field == name || Some(access.field.as_str()) == other_name)
    };
    let of = |item: &'a Item| {
        let accesses = item.accesses.iter().filter_map(|access| match access {
            Access::Command(access) => Some(access),
            Access::Modbus(_) => None,
        });
        accesses.filter(uses).map(move |access| (item, access))
    };
    definition.items.iter().flat_map(of).collect()
}

fn decimals(item: &Item) -> Option<u8> {
    if let Kind::Number { min, .. } = &item.kind { Some(min.decimals) } else { None }
}

fn codes(choice: &Choice, protocol: Protocol) -> &[u32] {
    if protocol == Protocol::Dcon { &choice.dcon } else { &choice.modbus }
}

/// Numbers and what they mean, of an item with a list of values.
fn meanings(item: &Item, access: &CommandAccess) -> Vec<(u64, String)> {
    if access.encoding != Encoding::Plain {
        return Vec::new();
    }
    let unit = if item.unit.is_empty() { String::new() } else { format!(" {}", item.unit) };
    match &item.kind {
        Kind::Choice(choices) => choices
            .iter()
            .flat_map(|choice| codes(choice, access.protocol).iter().map(move |code| (code, &choice.label)))
            .map(|(code, label)| (u64::from(*code), format!("{label}{unit}")))
            .collect(),
        Kind::Bool => {
            let word = |set: bool| if set != access.inverted { "yes" } else { "no" };
            [(0, false), (1, true)].map(|(code, set)| (code, format!("{}: {}", item.label, word(set)))).into()
        }
        _ => Vec::new(),
    }
}

fn choices(item: &Item, access: &CommandAccess, width: Option<usize>) -> Vec<FieldChoice> {
    let width = width.unwrap_or(1);
    let choice = |(code, meaning)| FieldChoice { code: format!("{code:0width$X}"), meaning };
    meanings(item, access).into_iter().map(choice).collect()
}

fn part(item: &Item, access: &CommandAccess) -> Option<FieldPart> {
    let bits = access.bits?;
    let (item_id, label) = (item.id.clone(), item.label.clone());
    Some(FieldPart { item: item_id, label, bits, choices: meanings(item, access), allowed: item.allowed() })
}

/// What values and actions that have a command of their own tell of its field: `@AAEAM` of the M in `@AAEAT`.
fn choices_of_own_commands(definition: &Definition, command: &Command, name: &str) -> Vec<FieldChoice> {
    let Some(write) = command.write.as_ref().filter(|write| write.field_names().count() == 1) else {
        return Vec::new();
    };
    let code =
        |template: &Template| if is_listed(definition, template) { None } else { filled_in(write, template, name) };
    let of_item = |item: &Item| match &item.kind {
        Kind::Choice(choices) => choices
            .iter()
            .filter_map(|choice| {
                let code = choice.dcon_write.as_ref().and_then(code)?;
                Some(FieldChoice { code, meaning: format!("{}: {}", item.label, choice.label) })
            })
            .collect::<Vec<_>>(),
        _ => Vec::new(),
    };
    let of_actions = definition.actions.iter().filter_map(|action| {
        let code = action.dcon.as_ref().and_then(code)?;
        Some(FieldChoice { code, meaning: action.label.clone() })
    });
    definition.items.iter().flat_map(of_item).chain(of_actions).collect()
}

/// Whether `template` itself is a command of the list.
fn is_listed(definition: &Definition, template: &Template) -> bool {
    let same = |known: &Template| known.source() == template.source();
    definition.commands.iter().any(|command| command.read.iter().chain(&command.write).any(same))
}

/// What `template`, a command without fields, has in the field `name` of `command`; `None` if it is another command.
pub fn filled_in(command: &Template, template: &Template, name: &str) -> Option<String> {
    let address = 1;
    let text = template.fill(address, &[].into()).ok()?;
    command.read(address, &text)?.remove(name)
}

fn factory(item: &Item, access: &CommandAccess, field: &ReferenceField) -> Option<FieldDefault> {
    let value = item.factory.as_ref().filter(|_| access.encoding == Encoding::Plain)?;
    let text = match (field.kind, value) {
        (Field::Decimal, Value::Number(number)) => number.to_dcon(),
        (Field::Hex, value) => {
            let code = raw_of_value(item, value, access.protocol, access.inverted).ok()?;
            let width = field.width?;
            format!("{:0width$X}", u64::try_from(code).ok()?)
        }
        _ => return None,
    };
    field.check(&text).ok().map(FieldDefault::Factory)
}

fn hint(field: &ReferenceField, filled_from: Option<&FillFrom>, users: &[(&Item, &CommandAccess)]) -> String {
    let form = field.form();
    match filled_from {
        Some(FillFrom::Address) => return format!("the module's address: {form}"),
        Some(FillFrom::Text(constant)) => return format!("always {constant}"),
        _ => {}
    }
    let of_user = |(item, access): &(&Item, &CommandAccess)| {
        let label = &item.label;
        match (&item.kind, access.bits) {
            (_, Some(bits)) if bits.low == bits.high => format!("bit {}: {label}", bits.low),
            (_, Some(bits)) => format!("bits {} to {}: {label}", bits.low, bits.high),
            (Kind::Number { min, .. }, None) if field.kind == Field::Hex && min.decimals > 0 => {
                let step = Fixed::new(1, min.decimals);
                format!("{label}, {}, as a number of {step} {}", item.allowed(), item.unit)
            }
            (Kind::Number { .. }, None) => format!("{label}, {}", item.allowed()),
            _ => label.clone(),
        }
    };
    let told: Vec<String> = users.iter().map(of_user).collect();
    if told.is_empty() { form } else { format!("{} – {form}", told.join("; ")) }
}
