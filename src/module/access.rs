//! Between values and the raw fields, bits and words of a protocol.

use super::definition::{
    Bits, Choice, Command, CommandAccess, Definition, Encoding, Field, FillFrom, Item, Kind, ModbusAccess, ModbusPlace,
};
use super::notation::{ANSWERED_FROM, Fields, INIT_ADDRESS, Template};
use super::value::{Fixed, Value, ValueError};
use crate::protocol::{AnswerFrom, Failure, Protocol, Query, Reply, hex};

/// The question that reads `command` from the module at `address`; `None` if the command cannot be read.
pub fn read_query(command: &Command, address: u8) -> Option<Query> {
    let text = command.read.as_ref()?.fill(address, &Fields::new()).ok()?;
    Some(match command.function {
        Some(function) => Query::Custom { function, data: hex::parse(&text).ok()?, write: false },
        None => {
            let from_address = command.answers.iter().all(|answer| answer.has_address());
            let from = if from_address { answer_from(address) } else { AnswerFrom::Anyone };
            Query::Dcon { text, from, write: false }
        }
    })
}

/// Who may answer a question to `address`. In INIT mode modules may answer at 00 with their stored address.
pub fn answer_from(address: u8) -> AnswerFrom {
    if address == INIT_ADDRESS { AnswerFrom::Anyone } else { AnswerFrom::Addresses(vec![address]) }
}

/// The question that reads `place`.
pub fn place_query(place: ModbusPlace) -> Query {
    match place {
        ModbusPlace::Coils { first, count } => Query::ReadCoils { first: first.saturating_sub(1), count },
        ModbusPlace::Holding { first, count } => Query::ReadHoldingRegisters { first: first.saturating_sub(1), count },
        ModbusPlace::Input { first, count } => Query::ReadInputRegisters { first: first.saturating_sub(1), count },
    }
}

/// The fields of a command's answer, of whichever of its shapes fits, completed from the address and constants.
pub fn read_fields(command: &Command, address: u8, reply: &Reply) -> Result<Fields, Failure> {
    let text = match reply {
        Reply::Text(text) => text.trim_end().to_owned(),
        Reply::Bytes(bytes) => hex::spaced(bytes).replace(' ', ""),
        other => return Err(Failure::UnknownShape { answer: format!("{other:?}") }),
    };
    let found = fitting(command, &command.answers, address, &text);
    let (_, mut fields) = found.ok_or(Failure::UnknownShape { answer: text })?;
    for (name, from) in &command.filled_from {
        let value = match from {
            FillFrom::Address => stored_address(address, &fields),
            FillFrom::Text(constant) => Some(constant.clone()),
            FillFrom::Field(other) => fields.get(other).cloned(),
        };
        if let (false, Some(value)) = (fields.contains_key(name), value) {
            fields.insert(name.clone(), value);
        }
    }
    Ok(fields)
}

/// The first of a command's shapes that `text` has, with its fields.
pub fn fitting<'a>(
    command: &Command,
    shapes: impl IntoIterator<Item = &'a Template>,
    address: u8,
    text: &str,
) -> Option<(&'a Template, Fields)> {
    let fits = |fields: &Fields| fits(command, fields);
    shapes.into_iter().find_map(|shape| Some((shape, shape.read(address, text).filter(fits)?)))
}

/// Whether each field holds what the command declares it to hold.
pub fn fits(command: &Command, fields: &Fields) -> bool {
    fields.iter().all(|(name, value)| match command.fields.get(name) {
        Some(Field::Hex) => value.bytes().all(|byte| byte.is_ascii_hexdigit()),
        Some(Field::Decimal) => !decimals_of(value).is_empty(),
        _ => true,
    })
}

/// The address that a module keeps: the one it was asked at, except in INIT mode, where it is asked at 00 and only its
/// answer can tell.
fn stored_address(asked: u8, fields: &Fields) -> Option<String> {
    match fields.get(ANSWERED_FROM) {
        Some(answered) if asked == INIT_ADDRESS => (answered != "00").then(|| answered.clone()),
        _ => Some(format!("{asked:02X}")),
    }
}

/// The numbers of DCON data: `+030.00+086.00` → `+030.00`, `+086.00`. Empty if it is anything else.
fn decimals_of(data: &str) -> Vec<&str> {
    let mut numbers = Vec::new();
    let mut rest = data.trim();
    while !rest.is_empty() {
        let Some(signless) = rest.strip_prefix(['+', '-']) else { return Vec::new() };
        let length = signless.find(['+', '-']).unwrap_or(signless.len()).saturating_add(1);
        let Some((number, after)) = rest.split_at_checked(length) else { return Vec::new() };
        if Fixed::parse(number, 6).is_none() {
            return Vec::new();
        }
        numbers.push(number);
        rest = after;
    }
    numbers
}

/// The value of `item` in the fields of a command's answer.
pub fn value_in_fields(
    definition: &Definition,
    item: &Item,
    access: &CommandAccess,
    command: &Command,
    fields: &Fields,
) -> Result<Value, Failure> {
    let text = fields.get(&access.field).map(String::as_str);
    let text = text.ok_or_else(|| Failure::NotOffered(format!("the module did not send {}", item.id)))?;
    let strange = || Failure::UnknownShape { answer: text.to_owned() };
    match command.fields.get(&access.field) {
        Some(Field::Hex) if access.encoding != Encoding::Plain => {
            let bytes = hex::parse(text).map_err(|_| strange())?;
            Ok(Value::Text(text_of(definition, access.encoding, &bytes)))
        }
        Some(Field::Hex) => {
            let raw = u64::from_str_radix(text, 16).map_err(|_| strange())?;
            value_of_raw(item, access.protocol, access.bits, access.inverted, raw).ok_or_else(strange)
        }
        Some(Field::Decimal) => {
            let numbers = decimals_of(text);
            let number = numbers.get(access.index.unwrap_or(0));
            let number = number.ok_or_else(|| Failure::NotOffered(format!("the module did not send {}", item.id)))?;
            match &item.kind {
                Kind::Number { min, .. } => Fixed::parse(number, min.decimals).map(Value::Number).ok_or_else(strange),
                _ => item.parse_any(number).ok_or_else(strange),
            }
        }
        _ => Ok(Value::Text(text.trim().to_owned())),
    }
}

/// The value of `item` in a range of coils or registers that begins at 0-based `start`.
pub fn value_in_reply(
    definition: &Definition,
    item: &Item,
    access: &ModbusAccess,
    start: u16,
    reply: &Reply,
) -> Result<Value, Failure> {
    let (first, count) = numbers_of(access.place);
    let from = usize::from(first.saturating_sub(1).saturating_sub(start));
    let to = from.saturating_add(usize::from(count));
    let short = || Failure::UnknownShape { answer: format!("{reply:?}") };
    match reply {
        Reply::Bits(bits) => {
            let bits = bits.get(from..to).ok_or_else(short)?;
            let raw = bits.iter().rev().fold(0, |raw, bit| (raw << 1) | u64::from(*bit));
            value_of_raw(item, Protocol::ModbusRtu, access.bits, access.inverted, raw).ok_or_else(short)
        }
        Reply::Words(words) => value_of_words(definition, item, access, words.get(from..to).ok_or_else(short)?),
        _ => Err(short()),
    }
}

fn value_of_words(
    definition: &Definition,
    item: &Item,
    access: &ModbusAccess,
    words: &[u16],
) -> Result<Value, Failure> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
    let strange = || Failure::UnknownShape { answer: hex::spaced(&bytes) };
    match &item.kind {
        Kind::Ipv4 => match bytes.as_slice() {
            [a, b, c, d] => Ok(Value::Text(std::net::Ipv4Addr::new(*a, *b, *c, *d).to_string())),
            _ => Err(strange()),
        },
        Kind::Text { .. } => Ok(Value::Text(match access.encoding {
            Encoding::Name => name_of_words(definition, words),
            Encoding::Version => version_of_words(words),
            encoding => text_of(definition, encoding, &bytes),
        })),
        Kind::Number { min, .. } if access.signed => {
            let raw = words.first().map(|word| i64::from(word.cast_signed())).ok_or_else(strange)?;
            Ok(Value::Number(Fixed::new(raw, min.decimals)))
        }
        _ => {
            let raw = words.iter().fold(0u64, |raw, word| (raw << 16) | u64::from(*word));
            value_of_raw(item, Protocol::ModbusRtu, access.bits, access.inverted, raw).ok_or_else(strange)
        }
    }
}

fn value_of_raw(item: &Item, protocol: Protocol, bits: Option<Bits>, inverted: bool, raw: u64) -> Option<Value> {
    let raw = bits.map_or(raw, |bits| bits.take(raw));
    match &item.kind {
        Kind::Bool => Some(Value::Bool((raw != 0) != inverted)),
        Kind::Number { min, .. } => Some(Value::Number(Fixed::new(i64::try_from(raw).ok()?, min.decimals))),
        Kind::Choice(choices) => {
            let code = u32::try_from(raw).ok()?;
            let choice = choices.iter().find(|choice| codes(choice, protocol).contains(&code))?;
            Some(Value::Choice(choice.word.clone()))
        }
        Kind::Text { .. } | Kind::Ipv4 => Some(Value::Text(format!("{raw:X}"))),
    }
}

fn codes(choice: &Choice, protocol: Protocol) -> &[u32] {
    if protocol == Protocol::Dcon { &choice.dcon } else { &choice.modbus }
}

/// First 1-based number and count.
pub fn numbers_of(place: ModbusPlace) -> (u16, u16) {
    match place {
        ModbusPlace::Coils { first, count }
        | ModbusPlace::Holding { first, count }
        | ModbusPlace::Input { first, count } => (first, count),
    }
}

/// The name that registers 40483 and 40484 stand for, or the words themselves.
pub fn name_of_words(definition: &Definition, words: &[u16]) -> String {
    let known = definition.identity.words.iter().find(|known| words == [known.low, known.high]);
    known.map_or_else(|| raw_words(words), |known| known.name.clone())
}

/// Words as `0x0234 0x5049`.
pub fn raw_words(words: &[u16]) -> String {
    words.iter().map(|word| format!("0x{word:04X}")).collect::<Vec<_>>().join(" ")
}

/// The firmware registers, low word first: 0x0B28 is `B2.8` (as the vendor's utility shows 0B28), 0x0100 is `1.0`.
pub fn version_of_words(words: &[u16]) -> String {
    match words {
        [low, high, ..] if *high != 0 => format!("{high:04X}{low:04X}"),
        [low, ..] => {
            let nibble = |shift: u16| low.checked_shr(u32::from(shift)).unwrap_or(0) & 0xF;
            if nibble(12) == 0 && nibble(8) >= 0xA {
                format!("{:X}{:X}.{:X}", nibble(8), nibble(4), nibble(0))
            } else {
                format!("{:X}.{:X}", low >> 8, low & 0xFF)
            }
        }
        [] => String::new(),
    }
}

fn text_of(definition: &Definition, encoding: Encoding, bytes: &[u8]) -> String {
    match encoding {
        Encoding::Plain => printable(bytes),
        Encoding::Counted => {
            let length = bytes.first().copied().unwrap_or(0);
            printable(&bytes.iter().skip(1).take(usize::from(length)).copied().collect::<Vec<_>>())
        }
        Encoding::Mac => hex::spaced(bytes).replace(' ', "-"),
        Encoding::Version => bytes.iter().map(|byte| format!("{byte:X}")).collect::<Vec<_>>().join("."),
        Encoding::Name => {
            let known = definition.identity.bytes.iter().find(|known| known.bytes == bytes);
            known.map_or_else(|| hex::spaced(bytes), |known| known.name.clone())
        }
    }
}

fn printable(bytes: &[u8]) -> String {
    bytes.iter().take_while(|byte| **byte != 0).map(|byte| char::from(*byte)).collect()
}

/// The raw number that stands for `value`, before bits are put in place. `Err` if the protocol has none.
pub fn raw_of_value(item: &Item, value: &Value, protocol: Protocol, inverted: bool) -> Result<i64, ValueError> {
    let refused = || item.not_allowed(&value.to_string());
    match (&item.kind, value) {
        (Kind::Bool, Value::Bool(on)) => Ok(i64::from(*on != inverted)),
        (Kind::Number { .. }, Value::Number(number)) => Ok(number.raw),
        (Kind::Choice(choices), Value::Choice(word)) => {
            let choice = choices.iter().find(|choice| choice.word == *word).ok_or_else(refused)?;
            codes(choice, protocol).first().map(|code| i64::from(*code)).ok_or_else(refused)
        }
        _ => Err(refused()),
    }
}

/// The words that stand for a text or an address.
pub fn words_of_text(item: &Item, encoding: Encoding, count: u16, value: &Value) -> Result<Vec<u16>, ValueError> {
    let text = value.to_string();
    let refused = || item.not_allowed(&text);
    let mut bytes = match &item.kind {
        Kind::Ipv4 => text.parse::<std::net::Ipv4Addr>().map_err(|_| refused())?.octets().to_vec(),
        _ if encoding == Encoding::Counted => {
            let length = u8::try_from(text.len()).map_err(|_| refused())?;
            std::iter::once(length).chain(text.bytes()).collect()
        }
        _ => text.clone().into_bytes(),
    };
    let room = usize::from(count).saturating_mul(2);
    if bytes.len() > room {
        return Err(refused());
    }
    bytes.resize(room, 0);
    Ok(bytes.chunks_exact(2).map(|pair| pair.iter().fold(0, |word, byte| (word << 8) | u16::from(*byte))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dcon_data_is_split_at_its_signs() {
        assert_eq!(decimals_of("+030.00+086.00-050.00"), ["+030.00", "+086.00", "-050.00"]);
        assert!(decimals_of("030.00").is_empty());
        assert!(decimals_of("+03x").is_empty());
        assert!(decimals_of("++").is_empty());
    }

    #[test]
    fn firmware_words_read_as_the_vendor_shows_them() {
        assert_eq!(version_of_words(&[0x0B28, 0]), "B2.8");
        assert_eq!(version_of_words(&[0x0100, 0]), "1.0");
        assert_eq!(version_of_words(&[0x0028, 0x0B00]), "0B000028");
    }
}
