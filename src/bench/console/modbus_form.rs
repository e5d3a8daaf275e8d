//! A Modbus request by function and register, checked against the limits of the standard before it is sent.

use super::register_table::{RegisterEntry, Space, describe_registers};
use crate::protocol::hex;

/// Coils or discrete inputs that one read may ask for (Modbus application protocol 1.1b3, 6.1 and 6.2).
const MOST_BITS_READ: u16 = 2_000;
/// Registers that one read may ask for (6.3 and 6.4).
const MOST_WORDS_READ: u16 = 125;
/// Coils that one write may set (6.11).
const MOST_BITS_WRITTEN: u16 = 1_968;
/// Registers that one write may set (6.12).
const MOST_WORDS_WRITTEN: u16 = 123;
/// Data bytes behind the function (4.1).
const MOST_DATA: usize = 252;

/// The functions of the form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FormFunction {
    ReadCoils,
    ReadDiscreteInputs,
    #[default]
    ReadHoldingRegisters,
    ReadInputRegisters,
    WriteCoil,
    WriteRegister,
    WriteCoils,
    WriteRegisters,
    /// Any other, with its data as bytes.
    Custom,
}

impl FormFunction {
    pub const ALL: [Self; 9] = [
        Self::ReadCoils,
        Self::ReadDiscreteInputs,
        Self::ReadHoldingRegisters,
        Self::ReadInputRegisters,
        Self::WriteCoil,
        Self::WriteRegister,
        Self::WriteCoils,
        Self::WriteRegisters,
        Self::Custom,
    ];

    /// The function code; `None` for [`Self::Custom`].
    pub fn code(self) -> Option<u8> {
        match self {
            Self::ReadCoils => Some(1),
            Self::ReadDiscreteInputs => Some(2),
            Self::ReadHoldingRegisters => Some(3),
            Self::ReadInputRegisters => Some(4),
            Self::WriteCoil => Some(5),
            Self::WriteRegister => Some(6),
            Self::WriteCoils => Some(15),
            Self::WriteRegisters => Some(16),
            Self::Custom => None,
        }
    }

    pub fn label(self) -> &'static str {
        match self {
            Self::ReadCoils => "1 Read coils",
            Self::ReadDiscreteInputs => "2 Read discrete inputs",
            Self::ReadHoldingRegisters => "3 Read registers",
            Self::ReadInputRegisters => "4 Read input registers",
            Self::WriteCoil => "5 Write a coil",
            Self::WriteRegister => "6 Write a register",
            Self::WriteCoils => "15 Write coils",
            Self::WriteRegisters => "16 Write registers",
            Self::Custom => "Other function",
        }
    }

    /// Where it reads or writes; `None` for [`Self::Custom`].
    pub fn space(self) -> Option<Space> {
        match self {
            Self::ReadCoils | Self::WriteCoil | Self::WriteCoils => Some(Space::Coils),
            Self::ReadDiscreteInputs => Some(Space::DiscreteInputs),
            Self::ReadHoldingRegisters | Self::WriteRegister | Self::WriteRegisters => Some(Space::HoldingRegisters),
            Self::ReadInputRegisters => Some(Space::InputRegisters),
            Self::Custom => None,
        }
    }

    /// Takes a count and no values.
    pub fn is_read(self) -> bool {
        self.code().is_some_and(|code| code <= 4)
    }

    /// Takes values.
    pub fn is_write(self) -> bool {
        self.code().is_some_and(|code| code > 4)
    }

    /// How many coils or registers one request may have.
    pub fn most(self) -> u16 {
        match self {
            Self::ReadCoils | Self::ReadDiscreteInputs => MOST_BITS_READ,
            Self::ReadHoldingRegisters | Self::ReadInputRegisters => MOST_WORDS_READ,
            Self::WriteCoil | Self::WriteRegister => 1,
            Self::WriteCoils => MOST_BITS_WRITTEN,
            Self::WriteRegisters => MOST_WORDS_WRITTEN,
            Self::Custom => 0,
        }
    }
}

/// How the first coil or register is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Numbering {
    /// From 1, as the manuals do.
    #[default]
    Register,
    /// From 0, as on the wire.
    Wire,
}

/// The fields of the form as they are typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModbusForm {
    pub function: FormFunction,
    pub numbering: Numbering,
    /// The first coil or register: decimal, or hexadecimal as 0x1E5 or 1E5h.
    pub first: String,
    /// How many to read.
    pub count: String,
    /// What to write, separated by spaces or commas: 0 or 1 and on or off for coils; numbers for registers.
    pub values: String,
    /// The function code of [`FormFunction::Custom`], hexadecimal.
    pub custom_code: String,
    /// Its data bytes, hexadecimal.
    pub custom_data: String,
}

impl Default for ModbusForm {
    fn default() -> Self {
        Self {
            function: FormFunction::default(),
            numbering: Numbering::default(),
            first: "1".to_owned(),
            count: "1".to_owned(),
            values: String::new(),
            custom_code: "46".to_owned(),
            custom_data: "00".to_owned(),
        }
    }
}

impl ModbusForm {
    /// A form that reads all of `entry`.
    pub fn reading(entry: &RegisterEntry) -> Self {
        let function = match entry.space {
            Space::Coils => FormFunction::ReadCoils,
            Space::DiscreteInputs => FormFunction::ReadDiscreteInputs,
            Space::HoldingRegisters => FormFunction::ReadHoldingRegisters,
            Space::InputRegisters => FormFunction::ReadInputRegisters,
        };
        Self { function, first: entry.number.to_string(), count: entry.count.to_string(), ..Self::default() }
    }

    /// Address, function and data of the request. `Err` says which field is wrong and what it takes.
    pub fn request(&self, address: u8) -> Result<Vec<u8>, String> {
        let Some(code) = self.function.code() else { return self.custom_request(address) };
        let mut request = vec![address, code];
        request.extend(self.first_on_wire()?.to_be_bytes());
        match self.function {
            FormFunction::WriteCoil => {
                let on = self.only(&self.coils()?)?;
                request.extend([if on { 0xFF } else { 0 }, 0]);
            }
            FormFunction::WriteRegister => request.extend(self.only(&self.words()?)?.to_be_bytes()),
            FormFunction::WriteCoils => {
                let coils = self.coils()?;
                request.extend(self.checked_count(coils.len())?.to_be_bytes());
                with_length(&mut request, pack(&coils))?;
            }
            FormFunction::WriteRegisters => {
                let words = self.words()?;
                request.extend(self.checked_count(words.len())?.to_be_bytes());
                with_length(&mut request, words.iter().flat_map(|word| word.to_be_bytes()).collect())?;
            }
            _ => request.extend(self.count_to_read()?.to_be_bytes()),
        }
        Ok(request)
    }

    /// Whether the request changes something, as far as is known: only reads surely do not.
    pub fn may_change(&self) -> bool {
        !self.function.is_read()
    }

    /// Changes how the first is counted, keeping which one it is.
    pub fn count_from(&mut self, numbering: Numbering) {
        let wire = self.first_on_wire();
        self.numbering = numbering;
        if let Ok(wire) = wire {
            self.first = match numbering {
                Numbering::Register => u32::from(wire).saturating_add(1).to_string(),
                Numbering::Wire => wire.to_string(),
            };
        }
    }

    /// The first coil or register as it goes on the wire.
    pub fn first_on_wire(&self) -> Result<u16, String> {
        let noun = self.function.space().map_or("register", Space::noun);
        let (low, high) = if self.numbering == Numbering::Register { (1, 65_536) } else { (0, 65_535) };
        let number = parse_number(&self.first).filter(|number| (low..=high).contains(number));
        let number = number.ok_or_else(|| {
            format!("\"{}\" is not a {noun} – use {low} to {high}, or hexadecimal as 0x1E5 or 1E5h", self.first.trim())
        })?;
        u16::try_from(number.saturating_sub(low)).map_err(|error| error.to_string())
    }

    /// What the request reads or writes, with the names that `entries` has there; `None` while it cannot be told.
    pub fn describe(&self, entries: &[RegisterEntry]) -> Option<String> {
        let (space, first) = (self.function.space()?, self.first_on_wire().ok()?);
        let count = match self.function {
            FormFunction::WriteCoil | FormFunction::WriteRegister => 1,
            FormFunction::WriteCoils | FormFunction::WriteRegisters => self.values_typed().count().clamp(1, 65_535),
            _ => usize::from(self.count_to_read().ok()?),
        };
        let described = describe_registers(entries, space, first, u16::try_from(count).unwrap_or(u16::MAX));
        Some(match self.printed_number(space) {
            Some(number) => format!(
                "{described} – the {} that the manual prints as {} is {number}",
                space.noun(),
                self.first.trim()
            ),
            None => described,
        })
    }

    /// Where a number looks like the manuals' 40486: what it stands for.
    fn printed_number(&self, space: Space) -> Option<u32> {
        let base = space.printed_base();
        let typed =
            self.first.trim().parse::<u32>().ok().filter(|_| base > 0 && self.numbering == Numbering::Register)?;
        typed.checked_sub(base).filter(|number| (1..10_000).contains(number))
    }

    fn custom_request(&self, address: u8) -> Result<Vec<u8>, String> {
        let code = self.custom_code.trim();
        let digits = code.strip_prefix("0x").or_else(|| code.strip_suffix(['h', 'H'])).unwrap_or(code);
        let known = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let function = u8::from_str_radix(digits, 16).ok().filter(|value| known && (0x01..=0x7F).contains(value));
        let function = function.ok_or_else(|| format!("\"{code}\" is not a function – use 01 to 7F, hexadecimal"))?;
        let data = hex::parse(&self.custom_data)?;
        if data.len() > MOST_DATA {
            return Err(format!("{} bytes of data are too many – a request has at most {MOST_DATA}", data.len()));
        }
        Ok([vec![address, function], data].concat())
    }

    fn count_to_read(&self) -> Result<u16, String> {
        let noun = self.function.space().map_or("register", Space::noun);
        let count = parse_number(&self.count).and_then(|count| usize::try_from(count).ok());
        let count = count.ok_or_else(|| {
            format!("\"{}\" is not how many to read – use 1 to {} {noun}s", self.count.trim(), self.function.most())
        })?;
        self.checked_count(count)
    }

    /// `count` where the standard and the end of the space allow it.
    fn checked_count(&self, count: usize) -> Result<u16, String> {
        let noun = self.function.space().map_or("register", Space::noun);
        let most = self.function.most();
        let does = if self.function.is_read() { "reads" } else { "writes" };
        let fitting = u16::try_from(count).ok().filter(|count| (1..=most).contains(count));
        let fitting = fitting.ok_or_else(|| match count {
            0 if self.function.is_read() => format!("nothing would be read – use 1 to {most} {noun}s"),
            0 => format!("there is no value – write 1 to {most}, separated by spaces"),
            _ => format!("{count} {noun}s are too many – one request {does} at most {most}: split it"),
        })?;
        let after = u32::from(self.first_on_wire()?).saturating_add(u32::from(fitting));
        if after > 65_536 {
            return Err(format!("the range goes beyond the last {noun}, 65536 – use fewer or begin lower"));
        }
        Ok(fitting)
    }

    fn only<T: Copy>(&self, values: &[T]) -> Result<T, String> {
        match values {
            [value] => Ok(*value),
            [] => Err("there is no value – write one".to_owned()),
            many => Err(format!("{} values are too many – this function writes one", many.len())),
        }
    }

    fn values_typed(&self) -> impl Iterator<Item = &str> {
        let separator = |character: char| character.is_whitespace() || character == ',' || character == ';';
        self.values.split(separator).filter(|word| !word.is_empty())
    }

    fn coils(&self) -> Result<Vec<bool>, String> {
        let coil = |word: &str| match word.to_ascii_lowercase().as_str() {
            "1" | "on" | "true" => Ok(true),
            "0" | "off" | "false" => Ok(false),
            _ => Err(format!("\"{word}\" is not the state of a coil – use 0 or 1, off or on")),
        };
        self.values_typed().map(coil).collect()
    }

    fn words(&self) -> Result<Vec<u16>, String> {
        let word = |text: &str| {
            let negative = text.starts_with('-').then(|| text.parse::<i16>().ok()).flatten().map(i16::cast_unsigned);
            let positive = || parse_number(text).and_then(|number| u16::try_from(number).ok());
            negative.or_else(positive).ok_or_else(|| {
                format!(
                    "\"{text}\" does not fit a register – use 0 to 65535, -32768 to -1, or hexadecimal as 0x1F or 1Fh"
                )
            })
        };
        self.values_typed().map(word).collect()
    }
}

fn with_length(request: &mut Vec<u8>, bytes: Vec<u8>) -> Result<(), String> {
    request.push(u8::try_from(bytes.len()).map_err(|error| error.to_string())?);
    request.extend(bytes);
    Ok(())
}

/// Eight coils a byte, the first in the lowest bit.
fn pack(coils: &[bool]) -> Vec<u8> {
    let byte = |eight: &[bool]| eight.iter().rev().fold(0u8, |byte, on| (byte << 1) | u8::from(*on));
    coils.chunks(8).map(byte).collect()
}

/// Decimal, or hexadecimal as `0x1E5` or `1E5h`.
fn parse_number(text: &str) -> Option<u32> {
    let text = text.trim();
    let prefixed = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let hexadecimal = prefixed.or_else(|| text.strip_suffix(['h', 'H']));
    let digits = hexadecimal.unwrap_or(text);
    let radix = if hexadecimal.is_some() { 16 } else { 10 };
    digits.chars().all(|digit| digit.is_digit(radix)).then(|| u32::from_str_radix(digits, radix).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::console::register_table;
    use crate::module::Catalogue;
    use crate::protocol::{Protocol, modbus};
    use proptest::prelude::*;

    fn form(function: FormFunction, first: &str, count: &str, values: &str) -> ModbusForm {
        let (first, count, values) = (first.to_owned(), count.to_owned(), values.to_owned());
        ModbusForm { function, first, count, values, ..ModbusForm::default() }
    }

    fn request(function: FormFunction, first: &str, count: &str, values: &str) -> Result<String, String> {
        form(function, first, count, values).request(1).map(|bytes| hex::spaced(&bytes))
    }

    #[test]
    fn every_function_makes_the_request_of_the_standard() {
        use FormFunction as F;
        for (function, first, count, values, expected) in [
            (F::ReadCoils, "1", "10", "", "01 01 00 00 00 0A"),
            (F::ReadDiscreteInputs, "197", "22", "", "01 02 00 C4 00 16"),
            (F::ReadHoldingRegisters, "486", "1", "", "01 03 01 E5 00 01"),
            (F::ReadInputRegisters, "1E6h", "0x7D", "", "01 04 01 E5 00 7D"),
            (F::WriteCoil, "173", "", "on", "01 05 00 AC FF 00"),
            (F::WriteCoil, "1", "", "0", "01 05 00 00 00 00"),
            (F::WriteRegister, "2", "", "-2", "01 06 00 01 FF FE"),
            (F::WriteCoils, "20", "", "1 0 1 1 0 0 1 1, 1 0", "01 0F 00 13 00 0A 02 CD 01"),
            (F::WriteRegisters, "2", "", "0x000A; 258", "01 10 00 01 00 02 04 00 0A 01 02"),
            (F::ReadHoldingRegisters, "65536", "1", "", "01 03 FF FF 00 01"),
        ] {
            assert_eq!(request(function, first, count, values), Ok(expected.to_owned()), "{function:?}");
        }
        let custom = ModbusForm { function: F::Custom, custom_data: "05 00".into(), ..ModbusForm::default() };
        assert_eq!(custom.request(7), Ok(vec![7, 0x46, 5, 0]));
    }

    #[test]
    fn what_the_standard_does_not_allow_is_told_with_what_it_allows() {
        use FormFunction as F;
        let many = "1 ".repeat(1_969);
        for (function, first, count, values, expected) in [
            (F::ReadCoils, "1", "2001", "", "2001 coils are too many – one request reads at most 2000"),
            (F::ReadHoldingRegisters, "1", "126", "", "reads at most 125"),
            (F::ReadHoldingRegisters, "1", "0", "", "nothing would be read"),
            (F::ReadHoldingRegisters, "1", "", "", "1 to 125 registers"),
            (F::ReadHoldingRegisters, "0", "1", "", "use 1 to 65536"),
            (F::ReadHoldingRegisters, "65537", "1", "", "use 1 to 65536"),
            (F::ReadHoldingRegisters, "x", "1", "", "\"x\" is not a register"),
            (F::ReadHoldingRegisters, "65536", "2", "", "beyond the last register"),
            (F::WriteCoils, "1", "", many.as_str(), "writes at most 1968"),
            (F::WriteRegisters, "1", "", &many[..2 * 124], "writes at most 123"),
            (F::WriteRegisters, "1", "", "", "there is no value"),
            (F::WriteRegister, "1", "", "1 2", "2 values are too many"),
            (F::WriteRegister, "1", "", "65536", "\"65536\" does not fit a register"),
            (F::WriteRegister, "1", "", "-32769", "does not fit a register"),
            (F::WriteCoil, "1", "", "2", "off or on"),
            (F::WriteCoil, "1", "", "", "there is no value"),
        ] {
            let reason = request(function, first, count, values).unwrap_err();
            assert!(reason.contains(expected), "{function:?} {first} {count}: {reason}");
        }
        for (code, data, expected) in
            [("80", "", "01 to 7F"), ("", "", "01 to 7F"), ("+1", "", "01 to 7F"), ("46", "0", "\"0\"")]
        {
            let form = ModbusForm {
                function: F::Custom,
                custom_code: code.into(),
                custom_data: data.into(),
                ..ModbusForm::default()
            };
            let reason = form.request(1).unwrap_err();
            assert!(reason.contains(expected), "{code} {data}: {reason}");
        }
    }

    #[test]
    fn both_numberings_name_the_same_register() {
        let mut form = form(FormFunction::ReadHoldingRegisters, "486", "1", "");
        let request = form.request(1);
        form.count_from(Numbering::Wire);
        assert_eq!((form.first.as_str(), form.request(1)), ("485", request.clone()));
        form.count_from(Numbering::Register);
        assert_eq!((form.first.as_str(), form.request(1)), ("486", request));
        form.first = "?".into();
        form.count_from(Numbering::Wire);
        assert_eq!(form.first, "?", "what is no number is left alone");
    }

    #[test]
    fn the_form_says_what_stands_at_its_registers() {
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        let table = register_table(&definition, Protocol::ModbusRtu);
        let describe = |function, first, count, values| form(function, first, count, values).describe(&table);
        let read = describe(FormFunction::ReadHoldingRegisters, "486", "1", "");
        assert_eq!(read.as_deref(), Some("register 486 = wire 485 (01E5h): baud_rate, data_format"));
        let written = describe(FormFunction::WriteRegisters, "485", "", "1 6").unwrap();
        assert!(written.ends_with("485 address, 486 baud_rate + data_format"), "{written}");
        let printed = describe(FormFunction::ReadHoldingRegisters, "40486", "1", "").unwrap();
        assert!(printed.contains("no name known") && printed.contains("prints as 40486 is 486"), "{printed}");
        assert_eq!(describe(FormFunction::Custom, "1", "1", ""), None);
        assert_eq!(describe(FormFunction::ReadCoils, "", "1", ""), None);
    }

    #[test]
    fn an_entry_of_the_table_fills_the_form() {
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        for entry in register_table(&definition, Protocol::ModbusTcp) {
            let form = ModbusForm::reading(&entry);
            let request = form.request(1).unwrap();
            assert_eq!(request[2..4], entry.wire().to_be_bytes());
            assert!(form.describe(std::slice::from_ref(&entry)).unwrap().contains(&entry.items[0]));
            assert!(!form.may_change());
        }
    }

    proptest! {
        #[test]
        fn whatever_is_typed_makes_a_request_of_right_length_or_a_reason(
            which in 0usize..9, first in "[0-9xh -]{0,6}", count in "[0-9xh ]{0,5}", values in "[0-9a-fonx,; -]{0,40}", text: String
        ) {
            let mut form = form(FormFunction::ALL[which], &first, &count, &values);
            form.custom_data = text.clone();
            if let Ok(request) = form.request(1) {
                prop_assert!(request.len() >= 2 && request.len() <= 254);
                if form.function.is_read() {
                    prop_assert!(matches!(modbus::answer_length(&request, &[1, request[1]]), modbus::AnswerLength::Bytes(length) if length <= 256));
                }
            }
            form.first = text.clone();
            form.count = text.clone();
            form.values = text;
            let _ = form.request(1);
            let _ = form.describe(&[]);
            form.count_from(Numbering::Wire);
        }
    }
}
