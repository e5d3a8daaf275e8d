//! Modbus frames, on a serial line and over TCP.

use super::super::definition::Definition;
use super::commands::{self, Form};
use super::danger::{Danger, unknown};
use super::places::{self, Range, Space};
use super::{ExplainedField, Explanation, with_details};
use crate::protocol::modbus::{self, AnswerLength};
use crate::protocol::{Protocol, Reply, hex};

/// Set in the function of an exception.
const EXCEPTION: u8 = 0x80;
/// Transaction, protocol, length and unit: what precedes the function over TCP.
const MBAP: usize = 7;
/// Stray bytes before an answer that are looked past.
const MOST_STRAY: usize = 64;

/// A frame taken apart.
struct Parts<'a> {
    unit: u8,
    function: u8,
    data: &'a [u8],
    /// What stands before the function.
    head: Vec<ExplainedField>,
    /// The CRC.
    tail: Option<ExplainedField>,
    /// What is wrong with what encloses the data.
    fault: Option<&'static str>,
}

impl<'a> Parts<'a> {
    fn of(protocol: Protocol, frame: &'a [u8]) -> Option<Self> {
        if protocol == Protocol::ModbusTcp { Self::of_tcp(frame) } else { Self::of_rtu(frame) }
    }

    fn of_rtu(frame: &'a [u8]) -> Option<Self> {
        let (body, crc) = frame.len().checked_sub(2).and_then(|at| frame.split_at_checked(at))?;
        let [unit, function, data @ ..] = body else { return None };
        let right = modbus::crc(body).to_le_bytes();
        let is_right = crc == right;
        let meaning = if is_right { "right".to_owned() } else { format!("wrong: {} is right", hex::spaced(&right)) };
        Some(Self {
            unit: *unit,
            function: *function,
            data,
            head: vec![ExplainedField::new("address", hex::spaced(&[*unit]), unit.to_string())],
            tail: Some(ExplainedField::new("CRC", hex::spaced(crc), meaning)),
            fault: (!is_right).then_some("wrong CRC"),
        })
    }

    fn of_tcp(frame: &'a [u8]) -> Option<Self> {
        let (header, body) = frame.split_at_checked(MBAP)?;
        let [t0, t1, p0, p1, l0, l1, unit] = header else { return None };
        let [function, data @ ..] = body else { return None };
        let announced = usize::from(u16::from_be_bytes([*l0, *l1]));
        let right = announced == body.len().saturating_add(1);
        let length = if right { String::new() } else { format!("wrong: {} follow", body.len().saturating_add(1)) };
        let transaction = u16::from_be_bytes([*t0, *t1]).to_string();
        let head = vec![
            ExplainedField::new("transaction", hex::spaced(&[*t0, *t1]), transaction),
            ExplainedField::new("protocol", hex::spaced(&[*p0, *p1]), if [*p0, *p1] == [0, 0] { "Modbus" } else { "" }),
            ExplainedField::new("length", hex::spaced(&[*l0, *l1]), length),
            ExplainedField::new("unit", hex::spaced(&[*unit]), unit.to_string()),
        ];
        let fault = (!right).then_some("wrong length");
        Some(Self { unit: *unit, function: *function, data, head, tail: None, fault })
    }

    fn word(&self, at: usize) -> Option<u16> {
        match self.data.get(at..at.checked_add(2)?)? {
            [high, low] => Some(u16::from_be_bytes([*high, *low])),
            _ => None,
        }
    }

    /// The coils or registers that a request of a standard function speaks of.
    fn range(&self) -> Option<Range> {
        let space = match self.function {
            0x01 | 0x02 | 0x05 | 0x0F => Space::Coils,
            0x03 | 0x06 | 0x10 | 0x16 => Space::Holding,
            0x04 => Space::Input,
            _ => return None,
        };
        let single = matches!(self.function, 0x05 | 0x06 | 0x16);
        let count = if single { 1 } else { self.word(2)? };
        Some(Range { space, wire: self.word(0)?, count })
    }

    /// What a request to write carries.
    fn written(&self) -> Option<Reply> {
        let count = usize::from(self.range()?.count);
        match self.function {
            0x05 => Some(Reply::Bits(vec![self.word(2)? != 0])),
            0x06 => Some(Reply::Words(vec![self.word(2)?])),
            0x0F => bits(self.data.get(5..)?, count),
            0x10 => words(self.data.get(5..)?, count),
            _ => None,
        }
    }

    fn function_field(&self) -> ExplainedField {
        ExplainedField::new("function", hex::spaced(&[self.function]), function_name(self.function))
    }

    fn explained(self, summary: String, middle: Vec<ExplainedField>) -> Explanation {
        let function = self.function_field();
        let summary = self.fault.map_or_else(|| summary.clone(), |fault| format!("{summary} ({fault})"));
        let fields = self.head.into_iter().chain([function]).chain(middle).chain(self.tail).collect();
        Explanation { summary, fields, danger: None }
    }

    fn data_field(&self) -> Vec<ExplainedField> {
        let data = (!self.data.is_empty()).then(|| ExplainedField::new("data", hex::spaced(self.data), ""));
        data.into_iter().collect()
    }
}

fn words(bytes: &[u8], count: usize) -> Option<Reply> {
    let words: Vec<u16> =
        bytes.chunks_exact(2).map(|pair| pair.iter().fold(0, |word, byte| (word << 8) | u16::from(*byte))).collect();
    Some(Reply::Words(words.get(..count)?.to_vec()))
}

fn bits(bytes: &[u8], count: usize) -> Option<Reply> {
    let bits: Vec<bool> = bytes.iter().flat_map(|byte| (0..8).map(move |bit| (byte >> bit) & 1 == 1)).collect();
    Some(Reply::Bits(bits.get(..count)?.to_vec()))
}

/// Modbus application protocol 1.1b3, chapter 6.
fn function_name(function: u8) -> &'static str {
    match function & !EXCEPTION {
        0x01 => "read coils",
        0x02 => "read discrete inputs",
        0x03 => "read holding registers",
        0x04 => "read input registers",
        0x05 => "write one coil",
        0x06 => "write one register",
        0x07 => "read exception status",
        0x08 => "diagnostics",
        0x0B => "read event counter",
        0x0C => "read event log",
        0x0F => "write coils",
        0x10 => "write registers",
        0x11 => "read server identification",
        0x14 => "read file record",
        0x15 => "write file record",
        0x16 => "mask write register",
        0x17 => "read and write registers",
        0x18 => "read queue",
        0x2B => "read device identification",
        modbus::MODULE_SETTINGS => "module settings",
        _ => "unknown function",
    }
}

fn is_read(function: u8) -> bool {
    matches!(function, 0x01..=0x04)
}

fn too_short(frame: &[u8]) -> Explanation {
    let field = ExplainedField::new("bytes", hex::spaced(frame), "");
    Explanation { summary: "Too short for a Modbus frame".to_owned(), fields: vec![field], danger: None }
}

fn sentence(function: u8) -> String {
    let name = function_name(function);
    let (first, rest) = name.split_at_checked(1).unwrap_or((name, ""));
    format!("{}{rest}", first.to_uppercase())
}

/// The data bytes as a definition's templates have them.
fn packed(data: &[u8]) -> String {
    hex::spaced(data).replace(' ', "")
}

pub fn request(definition: Option<&Definition>, protocol: Protocol, frame: &[u8]) -> Explanation {
    let Some(parts) = Parts::of(protocol, frame) else { return too_short(frame) };
    match (parts.range(), parts.written()) {
        (Some(range), _) if is_read(parts.function) => {
            let (names, rows) = definition.map(|known| places::names(known, protocol, range)).unwrap_or_default();
            let mut middle = vec![
                ExplainedField::new("first", part(&parts, 0), Range { count: 1, ..range }.label()),
                ExplainedField::new("count", part(&parts, 2), range.count.to_string()),
            ];
            middle.extend(rows);
            parts.explained(with_details(&format!("Read {}", range.label()), &names), middle)
        }
        (Some(range), Some(values)) => {
            let (values, rows) = places::values(definition, protocol, range, &values, true);
            let summary = format!("Write {}", at(range, &values));
            parts.explained(summary, rows)
        }
        _ => custom_request(definition, parts),
    }
}

/// The range with its values, which name it themselves where nothing else is known of it.
fn at(range: Range, values: &[String]) -> String {
    match values {
        [only] if only.starts_with(&range.label()) => only.clone(),
        values => with_details(&range.label(), values),
    }
}

fn part(parts: &Parts<'_>, at: usize) -> String {
    parts.data.get(at..at.saturating_add(2)).map(hex::spaced).unwrap_or_default()
}

fn custom_request(definition: Option<&Definition>, parts: Parts<'_>) -> Explanation {
    let data = packed(parts.data);
    let known = definition.and_then(|known| commands::recognise(known, Some(parts.function), &data));
    match known {
        Some(known) => {
            let mut middle = parts.data_field();
            middle.extend(known.fields);
            parts.explained(with_details(&known.title, &known.values), middle)
        }
        None => {
            let (summary, middle) = (function_and_data(&parts), parts.data_field());
            parts.explained(summary, middle)
        }
    }
}

fn function_and_data(parts: &Parts<'_>) -> String {
    format!("{} (0x{:02X}) {}", sentence(parts.function), parts.function, hex::spaced(parts.data)).trim_end().to_owned()
}

pub fn answer(definition: Option<&Definition>, protocol: Protocol, request: &[u8], received: &[u8]) -> Explanation {
    let frame = if protocol == Protocol::ModbusRtu { own_answer(request, received) } else { Some(received) };
    let Some(frame) = frame else {
        let field = ExplainedField::new("echo", hex::spaced(received), "the request, as the adapter sent it back");
        return Explanation { summary: "No answer, only the echo".to_owned(), fields: vec![field], danger: None };
    };
    let Some(parts) = Parts::of(protocol, frame) else { return too_short(frame) };
    let asked = Parts::of(protocol, request).filter(|asked| asked.function == parts.function & !EXCEPTION);
    if parts.function & EXCEPTION != 0 {
        let code = parts.data.first().copied().unwrap_or_default();
        let text = modbus::exception_text(code);
        let middle = vec![ExplainedField::new("exception", hex::spaced(parts.data), text)];
        return parts.explained(format!("Exception {code}: {text}"), middle);
    }
    match parts.function {
        0x01..=0x04 => read_answer(definition, protocol, asked, parts),
        0x05 | 0x06 | 0x0F | 0x10 | 0x16 => write_answer(definition, protocol, asked, parts),
        _ => custom_answer(definition, asked, parts),
    }
}

/// The answer among the received bytes, without echo and stray bytes; `None` if there is only an echo.
fn own_answer<'a>(request: &[u8], received: &'a [u8]) -> Option<&'a [u8]> {
    let is_right = |frame: &[u8]| modbus::check_answer(request, frame).is_ok();
    let equals_request = matches!(request.get(1), Some(0x05 | 0x06 | 0x08));
    if received == request && !equals_request {
        return None;
    }
    if request.is_empty() || is_right(received) {
        return Some(received);
    }
    let rest = received.strip_prefix(request).filter(|rest| !rest.is_empty()).unwrap_or(received);
    let found = (0..rest.len().min(MOST_STRAY)).find_map(|start| {
        let candidate = rest.get(start..)?;
        let AnswerLength::Bytes(length) = modbus::answer_length(request, candidate) else { return None };
        candidate.get(..length).filter(|frame| is_right(frame))
    });
    Some(found.unwrap_or(rest))
}

fn read_answer(
    definition: Option<&Definition>,
    protocol: Protocol,
    asked: Option<Parts<'_>>,
    parts: Parts<'_>,
) -> Explanation {
    let (announced, data) = match parts.data.split_first() {
        Some((count, data)) => (usize::from(*count), data),
        None => (0, parts.data),
    };
    let count_field = ExplainedField::new("bytes", format!("{announced:02X}"), announced.to_string());
    let of_bits = matches!(parts.function, 0x01 | 0x02);
    let range = asked.and_then(|asked| asked.range());
    let count =
        range.map_or(if of_bits { data.len().saturating_mul(8) } else { data.len() / 2 }, |range| range.count.into());
    let reply = if of_bits { bits(data, count) } else { words(data, count) };
    let whole = announced == data.len();
    match (range, reply) {
        (Some(range), Some(reply)) if whole => {
            let (values, rows) = places::values(definition, protocol, range, &reply, false);
            let middle = std::iter::once(count_field).chain(rows).collect();
            let summary = if values.is_empty() { "No values".to_owned() } else { values.join(", ") };
            parts.explained(summary, middle)
        }
        _ => {
            let summary = if whole { "Values" } else { "Values, not as many as announced" };
            let middle = vec![count_field, ExplainedField::new("data", hex::spaced(data), "")];
            parts.explained(format!("{summary}: {}", hex::spaced(data)), middle)
        }
    }
}

/// An answer to a write repeats the beginning of its request.
fn write_answer(
    definition: Option<&Definition>,
    protocol: Protocol,
    asked: Option<Parts<'_>>,
    parts: Parts<'_>,
) -> Explanation {
    let Some(range) = parts.range() else {
        let (summary, middle) = (function_and_data(&parts), parts.data_field());
        return parts.explained(summary, middle);
    };
    let as_asked = asked.is_none_or(|asked| asked.data.get(..4) == parts.data.get(..4));
    let values = parts.written().map(|values| places::values(definition, protocol, range, &values, true));
    let (values, rows) = values.unwrap_or_default();
    let word = if as_asked { "Confirmed" } else { "Confirmed otherwise than asked" };
    parts.explained(format!("{word}: {}", at(range, &values)), rows)
}

fn custom_answer(definition: Option<&Definition>, asked: Option<Parts<'_>>, parts: Parts<'_>) -> Explanation {
    let raw = function_and_data(&parts);
    let mut middle = parts.data_field();
    let (Some(definition), Some(asked)) = (definition, asked) else { return parts.explained(raw, middle) };
    let Some(known) = commands::recognise(definition, Some(asked.function), &packed(asked.data)) else {
        return parts.explained(raw, middle);
    };
    let data = packed(parts.data);
    let answered = known.command.filter(|_| known.form == Form::Read);
    let answered = answered.and_then(|command| commands::answered(definition, command, parts.unit, &data));
    match answered {
        Some((fields, values)) => {
            middle.extend(fields);
            let summary = if values.is_empty() { raw } else { values.join(", ") };
            parts.explained(summary, middle)
        }
        None if known.form == Form::Write => {
            let summary = format!("Answer to: {} ({})", known.title, hex::spaced(parts.data));
            parts.explained(summary, middle)
        }
        None => parts.explained(format!("An answer of no known shape: {raw}"), middle),
    }
}

/// What the request changes, and for whom.
pub fn danger(definition: Option<&Definition>, protocol: Protocol, frame: &[u8]) -> Option<Danger> {
    let Some(parts) = Parts::of(protocol, frame) else { return Some(unknown(definition, "a frame so short")) };
    if parts.unit == 0 && protocol == Protocol::ModbusRtu {
        return Some(Danger::Broadcast { what: request(definition, protocol, frame).summary });
    }
    match parts.function {
        0x01..=0x04 | 0x07 | 0x0B | 0x0C | 0x11 | 0x14 | 0x18 | 0x2B => None,
        0x05 | 0x06 | 0x0F | 0x10 | 0x16 => {
            Some(Danger::Writes { what: what_is_written(definition, protocol, &parts) })
        }
        0x15 | 0x17 => Some(Danger::Writes { what: sentence(parts.function) }),
        function => {
            let known = definition.and_then(|known| commands::recognise(known, Some(function), &packed(parts.data)));
            match known {
                Some(known) if known.form == Form::Read => None,
                Some(known) => Some(Danger::Writes { what: known.title }),
                None => Some(unknown(definition, &function_and_data(&parts))),
            }
        }
    }
}

fn what_is_written(definition: Option<&Definition>, protocol: Protocol, parts: &Parts<'_>) -> String {
    let Some(range) = parts.range() else { return sentence(parts.function) };
    let labels = definition.map(|definition| places::changed(definition, protocol, range)).unwrap_or_default();
    if labels.is_empty() { range.label() } else { format!("{}, {}", labels.join(", "), range.label()) }
}
