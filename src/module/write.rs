//! Writing one item, and carrying out actions. Neither ever repeats a write.

use std::sync::Arc;

use super::access;
use super::definition::{Access, Action, Applies, CommandAccess, Definition, Item, Kind, ModbusAccess, ModbusPlace};
use super::notation::{Fields, Template};
use super::read::read_items;
use super::value::{Fixed, Value, ValueError};
use super::{Ask, Field, identify};
use crate::protocol::{AnswerFrom, Failure, Protocol, Query, Reply, hex};

/// Why a value does not stand in the module, or why it is not known whether it does.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum WriteError {
    #[error(transparent)]
    Value(#[from] ValueError),
    #[error("{id} is not offered over {protocol}")]
    NotOffered { id: String, protocol: Protocol },
    #[error("{id} was not written: the module here is {found}, not {expected} – scan the line again")]
    OtherModule { id: String, expected: String, found: String },
    #[error(
        "{id} was not written: another module answers at address {address} already – give that one another address first"
    )]
    AddressTaken { id: String, address: u8 },
    #[error("{id} was not written: its present state could not be read first: {failure}")]
    ReadFirst { id: String, failure: Failure },
    #[error("{id} was not written: {failure}")]
    NotSent { id: String, failure: Failure },
    #[error("{id} was refused: {failure}{hint}")]
    Refused { id: String, failure: Failure, hint: &'static str },
    #[error("{id}: it is not known whether the value was taken: {failure}; reading back gave {read_back}")]
    Unknown { id: String, failure: Failure, read_back: String },
    #[error("{id} was written as {wanted}, but the module now says {found}{hint}")]
    Differs { id: String, wanted: Value, found: Value, hint: &'static str },
    #[error("{id} was acknowledged, but could not be read back: {failure}")]
    NotVerified { id: String, failure: Failure },
}

impl WriteError {
    /// What the line or the module did, where that is the reason.
    pub fn failure(&self) -> Option<&Failure> {
        match self {
            Self::ReadFirst { failure, .. }
            | Self::NotSent { failure, .. }
            | Self::Refused { failure, .. }
            | Self::NotVerified { failure, .. } => Some(failure),
            // What was read back tells more than the failure before it.
            Self::Unknown { .. }
            | Self::Value(_)
            | Self::NotOffered { .. }
            | Self::Differs { .. }
            | Self::OtherModule { .. }
            | Self::AddressTaken { .. } => None,
        }
    }
}

/// Writes `value` and reads it back; the result is what the module then says.
///
/// A multi-field command is read first and sent back with one field changed. Before a module is given another address,
/// that address is asked whether somebody answers there.
pub fn write_item(
    definition: &Arc<Definition>,
    protocol: Protocol,
    address: u8,
    item: &Item,
    value: &Value,
    ask: &mut dyn Ask,
) -> Result<Value, WriteError> {
    if item.read_only {
        return Err(ValueError::ReadOnly { id: item.id.clone() }.into());
    }
    // A NetID counts within one connection: nobody else can have it.
    if let Some(new) = moves_to(item, value).filter(|new| *new != address && item.id == "address") {
        no_one_at(new, address, protocol, item, ask)?;
    }
    let outcome = send(definition, protocol, address, item, value, ask)?;
    let moved = moves_to(item, value).filter(|_| outcome.is_ok());
    if let Some(address) = moved {
        ask.follow(address);
    }
    let address = moved.unwrap_or(address);
    let mut read_back = || read_back(definition, protocol, address, item, ask);
    match outcome {
        Ok(_) => match read_back() {
            Ok(found) if found == *value => Ok(found),
            Ok(found) => {
                let (id, wanted) = (item.id.clone(), value.clone());
                Err(WriteError::Differs { id, wanted, found, hint: differs_hint(item) })
            }
            Err(failure) => Err(WriteError::NotVerified { id: item.id.clone(), failure }),
        },
        Err(failure @ Failure::NotSent(_)) => Err(WriteError::NotSent { id: item.id.clone(), failure }),
        Err(failure) if failure.is_refusal() => {
            Err(WriteError::Refused { id: item.id.clone(), failure, hint: refused_hint(item) })
        }
        Err(failure) => match read_back() {
            Ok(found) if found == *value => Ok(found),
            other => {
                let read_back = other.map_or_else(|failure| failure.to_string(), |found| found.to_string());
                Err(WriteError::Unknown { id: item.id.clone(), failure, read_back })
            }
        },
    }
}

/// Two modules at one address can be told apart only by taking one off the line.
fn no_one_at(new: u8, present: u8, protocol: Protocol, item: &Item, ask: &mut dyn Ask) -> Result<(), WriteError> {
    ask.follow(new);
    let answer = ask.ask(&identify::first_question(protocol, new));
    ask.follow(present);
    match answer {
        Err(Failure::Silent) => Ok(()),
        Err(failure @ Failure::LineLost(_)) => Err(WriteError::ReadFirst { id: item.id.clone(), failure }),
        _ => Err(WriteError::AddressTaken { id: item.id.clone(), address: new }),
    }
}

/// Sends the write once; by the item's next way only if the module does not know the first one at all.
fn send(
    definition: &Definition,
    protocol: Protocol,
    address: u8,
    item: &Item,
    value: &Value,
    ask: &mut dyn Ask,
) -> Result<Result<Reply, Failure>, WriteError> {
    let mut last = Err(WriteError::NotOffered { id: item.id.clone(), protocol });
    for access in item.accesses.iter().filter(|access| access.serves(protocol)) {
        let query = match access {
            Access::Command(access) => command_write(definition, item, access, address, value, ask),
            Access::Modbus(access) => modbus_write(item, access, protocol, value, ask),
        };
        last = match query {
            Ok(query) => Ok(ask.ask(&query)),
            Err(WriteError::ReadFirst { id, failure }) if is_unknown_way(&failure) => {
                Err(WriteError::ReadFirst { id, failure })
            }
            Err(error) => return Err(error),
        };
        if !matches!(&last, Ok(Err(failure)) if is_unknown_way(failure)) && last.is_ok() {
            return last;
        }
    }
    last
}

/// Illegal function or address: the module did nothing.
fn is_unknown_way(failure: &Failure) -> bool {
    matches!(failure, Failure::Exception { code: 1 | 2 })
}

fn refused_hint(item: &Item) -> &'static str {
    match item.applies {
        Applies::Init => " – it can be changed only in INIT mode, after a power cycle",
        Applies::Now => "",
    }
}

fn differs_hint(item: &Item) -> &'static str {
    match item.applies {
        Applies::Init => refused_hint(item),
        Applies::Now => " – its switches may rule (hardware configuration)",
    }
}

/// The address to which a module answers once `value` stands in `item`; `None` if it stays where it is. That is its
/// `address`, or over TCP its `net_id` (a gateway passes the address on, and a module has only one of the two there).
pub fn moves_to(item: &Item, value: &Value) -> Option<u8> {
    match value {
        Value::Number(Fixed { raw, .. }) if matches!(item.id.as_str(), "address" | "net_id") => u8::try_from(*raw).ok(),
        _ => None,
    }
}

/// Whether `protocol` can carry `value` to `item`, judged without asking the module; [`write_item`] would refuse
/// the same before it sends the write.
pub fn check_write(definition: &Definition, protocol: Protocol, item: &Item, value: &Value) -> Result<(), WriteError> {
    if item.read_only {
        return Err(ValueError::ReadOnly { id: item.id.clone() }.into());
    }
    let not_offered = || WriteError::NotOffered { id: item.id.clone(), protocol };
    match item.accesses.iter().find(|access| access.serves(protocol)).ok_or_else(not_offered)? {
        Access::Command(_) if own_command(item, value).is_some() => Ok(()),
        Access::Command(access) => {
            let command = definition.commands.get(access.command).ok_or_else(not_offered)?;
            let template = command.write.as_ref().ok_or_else(not_offered)?;
            written_field(command, template, &access.field).map(|_| ()).ok_or_else(not_offered)
        }
        Access::Modbus(access) => check_place(item, access, protocol, value),
    }
}

fn check_place(item: &Item, access: &ModbusAccess, protocol: Protocol, value: &Value) -> Result<(), WriteError> {
    let raw = || access::raw_of_value(item, value, protocol, access.inverted);
    match (access.place, &item.kind) {
        (ModbusPlace::Input { .. }, _) => Err(ValueError::ReadOnly { id: item.id.clone() }.into()),
        (ModbusPlace::Coils { .. }, _) => Ok(raw().map(|_| ())?),
        (ModbusPlace::Holding { count: 1, .. }, _) => word(item, access, protocol, value, raw()?).map(|_| ()),
        (ModbusPlace::Holding { count, .. }, Kind::Text { .. } | Kind::Ipv4) => {
            Ok(access::words_of_text(item, access.encoding, count, value).map(|_| ())?)
        }
        (ModbusPlace::Holding { .. }, _) => Err(WriteError::NotOffered { id: item.id.clone(), protocol }),
    }
}

fn read_back(
    definition: &Arc<Definition>,
    protocol: Protocol,
    address: u8,
    item: &Item,
    ask: &mut dyn Ask,
) -> Result<Value, Failure> {
    let mut results = read_items(definition, protocol, address, [item.id.as_str()], ask);
    results.pop().map_or(Err(Failure::Silent), |answer| answer.result)
}

fn command_write(
    definition: &Definition,
    item: &Item,
    access: &CommandAccess,
    address: u8,
    value: &Value,
    ask: &mut dyn Ask,
) -> Result<Query, WriteError> {
    if let Some(template) = own_command(item, value) {
        return dcon_query(&item.id, template, address, &Fields::new(), vec![address]);
    }
    let not_offered = || WriteError::NotOffered { id: item.id.clone(), protocol: access.protocol };
    let command = definition.commands.get(access.command).ok_or_else(not_offered)?;
    let template = command.write.as_ref().ok_or_else(not_offered)?;
    let target = written_field(command, template, &access.field).ok_or_else(not_offered)?;
    let alone = access.bits.is_none() && template.field_names().all(|name| name == target);
    let mut fields = Fields::new();
    if !alone {
        let query = access::read_query(command, address).ok_or_else(not_offered)?;
        let read = ask_certainly(&query, ask).and_then(|reply| access::read_fields(command, address, &reply));
        fields = read.map_err(|failure| WriteError::ReadFirst { id: item.id.clone(), failure })?;
    }
    let text =
        field_text(item, access, template.width(&target), &fields, &target, value, command.fields.get(&access.field))?;
    fields.insert(target, text);
    let mut from = vec![address];
    from.extend(moves_to(item, value));
    match command.function {
        None => dcon_query(&item.id, template, address, &fields, from),
        Some(function) => {
            let text = template.fill(address, &fields).map_err(|_| not_offered())?;
            Ok(Query::Custom { function, data: hex::parse(&text).map_err(|_| not_offered())?, write: true })
        }
    }
}

/// A command that sets just this value (`@AADA`).
fn own_command<'a>(item: &'a Item, value: &Value) -> Option<&'a Template> {
    let (Kind::Choice(choices), Value::Choice(word)) = (&item.kind, value) else { return None };
    choices.iter().find(|choice| choice.word == *word)?.dcon_write.as_ref()
}

/// The write's name for the field that the answer calls `field`.
pub(crate) fn written_field(command: &super::Command, template: &Template, field: &str) -> Option<String> {
    let named = template.field_names().find(|name| *name == field).map(str::to_owned);
    named.or_else(|| {
        let mut names = template.field_names();
        let renamed = names.find(|name| {
            matches!(command.filled_from.get(*name), Some(super::definition::FillFrom::Field(from)) if from == field)
        });
        renamed.map(str::to_owned)
    })
}

/// The text of the write's field `target` with `value` in it; the other bits keep what `fields` has.
pub(crate) fn field_text(
    item: &Item,
    access: &CommandAccess,
    width: Option<usize>,
    fields: &Fields,
    target: &str,
    value: &Value,
    kind: Option<&Field>,
) -> Result<String, WriteError> {
    if let (Some(Field::Decimal), Value::Number(number)) = (kind, value) {
        return Ok(number.to_dcon());
    }
    if matches!(kind, Some(Field::Text)) {
        return Ok(value.to_string());
    }
    let raw = access::raw_of_value(item, value, access.protocol, access.inverted)?;
    let raw = u64::try_from(raw).map_err(|_| item.not_allowed(&value.to_string()))?;
    let present = fields.get(target).or_else(|| fields.get(&access.field));
    let present = present.and_then(|text| u64::from_str_radix(text, 16).ok()).unwrap_or(0);
    let raw = access.bits.map_or(raw, |bits| bits.put(present, raw));
    let width = width.unwrap_or(2);
    let text = format!("{raw:0width$X}");
    if text.len() == width { Ok(text) } else { Err(item.not_allowed(&value.to_string()).into()) }
}

fn dcon_query(id: &str, template: &Template, address: u8, fields: &Fields, from: Vec<u8>) -> Result<Query, WriteError> {
    let not_offered = |_| WriteError::NotOffered { id: id.to_owned(), protocol: Protocol::Dcon };
    let text = template.fill(address, fields).map_err(not_offered)?;
    let from = if template.has_address() { AnswerFrom::Addresses(from) } else { AnswerFrom::Nobody };
    Ok(Query::Dcon { text, from, write: true })
}

fn modbus_write(
    item: &Item,
    access: &ModbusAccess,
    protocol: Protocol,
    value: &Value,
    ask: &mut dyn Ask,
) -> Result<Query, WriteError> {
    let raw = || access::raw_of_value(item, value, protocol, access.inverted);
    match access.place {
        ModbusPlace::Input { .. } => Err(ValueError::ReadOnly { id: item.id.clone() }.into()),
        ModbusPlace::Coils { first, count: 1 } => Ok(Query::WriteCoil { at: first.saturating_sub(1), on: raw()? != 0 }),
        ModbusPlace::Coils { first, count } => {
            let raw = raw()?;
            let values = (0..count).map(|bit| raw.checked_shr(u32::from(bit)).unwrap_or(0) & 1 == 1).collect();
            Ok(Query::WriteCoils { first: first.saturating_sub(1), values })
        }
        ModbusPlace::Holding { first, count: 1 } => {
            let raw = word(item, access, protocol, value, raw()?)?;
            let value = match access.bits {
                None => raw,
                Some(bits) => {
                    let present = present_word(item, access.place, ask)?;
                    u16::try_from(bits.put(u64::from(present), u64::from(raw)) & 0xFFFF).unwrap_or(raw)
                }
            };
            Ok(Query::WriteRegister { at: first.saturating_sub(1), value })
        }
        ModbusPlace::Holding { first, count } => {
            let values = match item.kind {
                Kind::Text { .. } | Kind::Ipv4 => access::words_of_text(item, access.encoding, count, value)?,
                _ => return Err(WriteError::NotOffered { id: item.id.clone(), protocol }),
            };
            Ok(Query::WriteRegisters { first: first.saturating_sub(1), values })
        }
    }
}

/// The register word of a raw number, if it fits sixteen bits.
pub(crate) fn word(
    item: &Item,
    access: &ModbusAccess,
    protocol: Protocol,
    value: &Value,
    raw: i64,
) -> Result<u16, WriteError> {
    let (low, high) = access.range.unwrap_or(if access.signed { (-32_768, 32_767) } else { (0, 65_535) });
    let in_range = (low..=high).contains(&raw);
    let fits = if access.signed { i16::try_from(raw).ok().map(i16::cast_unsigned) } else { u16::try_from(raw).ok() };
    let fits = fits.filter(|_| in_range);
    fits.ok_or_else(|| {
        let decimals = if let Kind::Number { min, .. } = &item.kind { min.decimals } else { 0 };
        WriteError::Value(ValueError::DoesNotFit {
            id: item.id.clone(),
            given: value.to_string(),
            protocol: protocol.label().to_owned(),
            allowed: format!("{} to {} {}", Fixed::new(low, decimals), Fixed::new(high, decimals), item.unit)
                .trim_end()
                .to_owned(),
        })
    })
}

fn present_word(item: &Item, place: ModbusPlace, ask: &mut dyn Ask) -> Result<u16, WriteError> {
    let failed = |failure| WriteError::ReadFirst { id: item.id.clone(), failure };
    match ask_certainly(&access::place_query(place), ask).map_err(failed)? {
        Reply::Words(words) if words.len() == 1 => Ok(words.first().copied().unwrap_or_default()),
        other => Err(failed(Failure::UnknownShape { answer: format!("{other:?}") })),
    }
}

/// Asks for what a write leaves as it is. After an answer too many the line is listened to more carefully, so that asking once
/// more helps.
fn ask_certainly(query: &Query, ask: &mut dyn Ask) -> Result<Reply, Failure> {
    let reply = ask.ask(query)?;
    if ask.certain().is_ok() {
        return Ok(reply);
    }
    let reply = ask.ask(query)?;
    ask.certain().map(|()| reply)
}

/// Carries out an action once.
pub fn run_action(action: &Action, protocol: Protocol, address: u8, ask: &mut dyn Ask) -> Result<(), WriteError> {
    let not_offered = || WriteError::NotOffered { id: action.id.clone(), protocol };
    if !action.is_offered(protocol) {
        return Err(not_offered());
    }
    let query = match (protocol, &action.dcon, action.modbus) {
        (Protocol::Dcon, Some(template), _) => {
            dcon_query(&action.id, template, address, &Fields::new(), vec![address])?
        }
        (_, _, Some(ModbusPlace::Coils { first, .. })) => Query::WriteCoil { at: first.saturating_sub(1), on: true },
        (_, _, Some(ModbusPlace::Holding { first, .. })) => {
            Query::WriteRegister { at: first.saturating_sub(1), value: 1 }
        }
        _ => return Err(not_offered()),
    };
    match ask.ask(&query) {
        Ok(_) => Ok(()),
        Err(failure) if failure.is_refusal() => Err(WriteError::Refused { id: action.id.clone(), failure, hint: "" }),
        Err(failure) => {
            let read_back = "nothing: an action has no state of its own".to_owned();
            Err(WriteError::Unknown { id: action.id.clone(), failure, read_back })
        }
    }
}
