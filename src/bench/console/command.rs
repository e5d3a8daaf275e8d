//! One command as a person types it, and what of it goes on the wire.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::bus::RawRequest;
use crate::protocol::{dcon, hex, modbus};

/// Address, function and data of the longest Modbus request (Modbus application protocol 1.1b3, 4.1).
const LONGEST_MODBUS: usize = 254;
/// The word before the bytes of a Modbus request.
const HEX: &str = "hex";

/// A command to send as it is.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RawCommand {
    /// A DCON command with its address; the checksum, if wanted, and the CR are added.
    Dcon { text: String, checksum: bool },
    /// Address, function and data of a Modbus request; CRC or header are added.
    Modbus { bytes: Vec<u8> },
}

impl RawCommand {
    /// Reads `$01M`, or `hex 01 03 00 00 00 05`. `checksum` says whether DCON commands carry one. `Err` says what is
    /// wrong and what to write instead.
    pub fn parse(text: &str, checksum: bool) -> Result<Self, String> {
        let text = text.trim();
        if let Some(bytes) = after_word(text, HEX) {
            return Self::parse_bytes(bytes);
        }
        let Some(first) = text.chars().next() else {
            return Err("there is nothing to send – write a command".to_owned());
        };
        if let Some(strange) = text.chars().find(|character| !(' '..='~').contains(character)) {
            return Err(format!("\"{strange}\" is not a character of DCON – use letters, digits and signs of ASCII"));
        }
        if !is_command_delimiter(first) {
            return Err(missing_delimiter(text));
        }
        if text.len() < 2 {
            return Err(format!("{text} is only a delimiter – write a command such as $01M"));
        }
        Ok(Self::Dcon { text: text.to_owned(), checksum })
    }

    /// Reads the bytes of a Modbus request, address first.
    pub fn parse_bytes(text: &str) -> Result<Self, String> {
        let bytes = hex::parse(text)?;
        match bytes.len() {
            0 | 1 => {
                Err("a Modbus request has at least an address and a function – write for example 01 03 00 00 00 05"
                    .to_owned())
            }
            2..=LONGEST_MODBUS => Ok(Self::Modbus { bytes }),
            many => Err(format!("{many} bytes are too many – a Modbus request has at most {LONGEST_MODBUS}")),
        }
    }

    /// The bytes of a serial line: DCON text, checksum and CR, or a Modbus request and its CRC.
    pub fn on_wire(&self) -> Vec<u8> {
        match self {
            Self::Dcon { text, checksum } => dcon::encode(text, *checksum),
            Self::Modbus { bytes } => modbus::with_crc(bytes),
        }
    }

    /// [`Self::on_wire`] for reading: `$01MD2\r` or `01 03 00 00 00 05 85 C9`.
    pub fn preview(&self) -> String {
        let bytes = self.on_wire();
        match self {
            Self::Dcon { .. } => hex::escaped(&bytes),
            Self::Modbus { .. } => hex::spaced(&bytes),
        }
    }

    /// The two characters or bytes that are added against errors: the DCON checksum or the CRC, low byte first.
    pub fn check_value(&self) -> Option<String> {
        match self {
            Self::Dcon { checksum: false, .. } => None,
            Self::Dcon { text, .. } => Some(format!("{:02X}", dcon::checksum(text.as_bytes()))),
            Self::Modbus { bytes } => Some(hex::spaced(&modbus::crc(bytes).to_le_bytes())),
        }
    }

    /// Whether no module answers it on a serial line: `~**`, or Modbus address 0.
    pub fn is_broadcast(&self) -> bool {
        match self {
            Self::Dcon { text, .. } => text.contains("**"),
            Self::Modbus { bytes } => bytes.first() == Some(&0),
        }
    }

    /// An answer as it is read by people: DCON as text, Modbus as bytes.
    pub fn show_answer(&self, answer: &[u8]) -> String {
        match self {
            _ if answer.is_empty() => "nothing".to_owned(),
            Self::Dcon { .. } => hex::escaped(answer),
            Self::Modbus { .. } => hex::spaced(answer),
        }
    }

    /// `answer` without what only guards it: the checksum, if the command carries one, or the CRC of a serial line.
    pub fn without_check<'a>(&self, answer: &'a [u8]) -> &'a [u8] {
        let Some((body, check)) = answer.len().checked_sub(2).and_then(|at| answer.split_at_checked(at)) else {
            return answer;
        };
        let guarded = match self {
            Self::Dcon { checksum, .. } => *checksum && check == format!("{:02X}", dcon::checksum(body)).as_bytes(),
            Self::Modbus { .. } => check == modbus::crc(body).to_le_bytes(),
        };
        if guarded { body } else { answer }
    }
}

impl fmt::Display for RawCommand {
    /// As it can be typed again.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dcon { text, .. } => f.write_str(text),
            Self::Modbus { bytes } => write!(f, "{HEX} {}", hex::spaced(bytes)),
        }
    }
}

impl From<RawCommand> for RawRequest {
    fn from(command: RawCommand) -> Self {
        match command {
            RawCommand::Dcon { text, checksum } => Self::Dcon { text, checksum },
            RawCommand::Modbus { bytes } => Self::Modbus { bytes },
        }
    }
}

impl From<RawRequest> for RawCommand {
    fn from(request: RawRequest) -> Self {
        match request {
            RawRequest::Dcon { text, checksum } => Self::Dcon { text, checksum },
            RawRequest::Modbus { bytes } => Self::Modbus { bytes },
        }
    }
}

/// Something about a typed command that may not be meant so. It can be sent all the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hint {
    pub text: String,
    /// The line that is probably meant.
    pub better: Option<String>,
}

impl Hint {
    fn new(text: impl Into<String>, better: impl Into<Option<String>>) -> Self {
        Self { text: text.into(), better: better.into() }
    }
}

/// Looks at a line before it is sent. `checksum` says whether DCON commands get one.
pub fn check_typed(text: &str, checksum: bool) -> Vec<Hint> {
    let text = text.trim();
    if text.is_empty() {
        return Vec::new();
    }
    if let Some(bytes) = after_word(text, HEX) {
        return check_bytes(bytes).into_iter().collect();
    }
    if let Some(line) = without_carriage_return(text) {
        return vec![Hint::new("The carriage return is added by itself – leave it out", line)];
    }
    if !text.starts_with(is_command_delimiter) {
        let better = looks_like_bytes(text).then(|| format!("{HEX} {text}"));
        return vec![Hint::new(sentence(&missing_delimiter(text)), better)];
    }
    [address_hint(text), case_hint(text), checksum_hint(text, checksum)].into_iter().flatten().collect()
}

fn check_bytes(text: &str) -> Option<Hint> {
    let bytes = match hex::parse(text) {
        Ok(bytes) => bytes,
        Err(reason) => return Some(Hint::new(sentence(&reason), None)),
    };
    let (body, crc) = bytes.len().checked_sub(2).and_then(|at| bytes.split_at_checked(at))?;
    if body.len() < 2 || crc != modbus::crc(body).to_le_bytes() {
        return None;
    }
    let text = format!("{} is the CRC of the bytes before it and would be sent twice – leave it out", hex::spaced(crc));
    Some(Hint::new(text, format!("{HEX} {}", hex::spaced(body))))
}

fn without_carriage_return(text: &str) -> Option<String> {
    let endings = ["\\r\\n", "\\r", "\\n", "<CR>", "<cr>", "(CR)", "(cr)", "[CR]"];
    endings.iter().find_map(|ending| text.strip_suffix(ending)).map(|line| line.trim_end().to_owned())
}

fn address_hint(text: &str) -> Option<Hint> {
    let address = text.get(1..3).unwrap_or_default();
    let is_address = address.len() == 2 && address.bytes().all(|byte| byte.is_ascii_hexdigit());
    let hint = "An address of two hexadecimal digits follows the delimiter, 0A for 10 – write for example $01M";
    (!is_address && address != "**").then(|| Hint::new(hint, None))
}

fn case_hint(text: &str) -> Option<Hint> {
    let hint = "Modules know capital letters only, also in hexadecimal digits – a name may have small ones";
    text.bytes().any(|byte| byte.is_ascii_lowercase()).then(|| Hint::new(hint, text.to_ascii_uppercase()))
}

/// `$01FCB` is `$01F` with its checksum, and with the checksum switched on it would get a second one.
fn checksum_hint(text: &str, checksum: bool) -> Option<Hint> {
    let (body, typed) = text.len().checked_sub(2).and_then(|at| text.split_at_checked(at))?;
    // Delimiter and address at least.
    if body.len() < 3 || typed != format!("{:02X}", dcon::checksum(body.as_bytes())) {
        return None;
    }
    Some(if checksum {
        Hint::new(format!("{typed} is the checksum of {body} and would be sent twice – leave it out"), body.to_owned())
    } else {
        let text = format!("{typed} is the checksum of {body} – switch the checksum on instead, or leave it out");
        Hint::new(text, body.to_owned())
    })
}

fn missing_delimiter(text: &str) -> String {
    if text.bytes().next().is_some_and(|byte| dcon::ANSWER_DELIMITERS.contains(&byte)) {
        return format!("{text} looks like an answer – a command begins with one of $ # % @ ~");
    }
    if looks_like_bytes(text) {
        return format!("a DCON command begins with one of $ # % @ ~ – for Modbus write {HEX} {text}");
    }
    "a DCON command begins with one of $ # % @ ~ – write for example $01M".to_owned()
}

/// At least two bytes in hexadecimal digits.
fn looks_like_bytes(text: &str) -> bool {
    hex::parse(text).is_ok_and(|bytes| bytes.len() >= 2)
}

fn is_command_delimiter(character: char) -> bool {
    u8::try_from(character).is_ok_and(|byte| dcon::COMMAND_DELIMITERS.contains(&byte))
}

/// What follows `word` and white space, if `text` begins so; in capitals or not.
pub(super) fn after_word<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let (first, rest) = text.split_at_checked(word.len())?;
    let ends = rest.is_empty() || rest.starts_with(char::is_whitespace);
    (ends && first.eq_ignore_ascii_case(word)).then(|| rest.trim())
}

/// With a capital at its beginning.
fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map(|first| first.to_uppercase().chain(characters).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn hints(text: &str, checksum: bool) -> Vec<String> {
        check_typed(text, checksum).into_iter().map(|hint| hint.text).collect()
    }

    fn better(text: &str, checksum: bool) -> Vec<Option<String>> {
        check_typed(text, checksum).into_iter().map(|hint| hint.better).collect()
    }

    #[test]
    fn the_preview_shows_what_exactly_goes_on_the_wire() {
        assert_eq!(RawCommand::parse("$01M", false).unwrap().preview(), "$01M\\r");
        let with_checksum = RawCommand::parse(" $01F ", true).unwrap();
        assert_eq!(with_checksum.preview(), "$01FCB\\r");
        assert_eq!(with_checksum.check_value().as_deref(), Some("CB"));
        let modbus = RawCommand::parse("hex 01 03 0000 0005", true).unwrap();
        assert_eq!(modbus.preview(), "01 03 00 00 00 05 85 C9");
        assert_eq!(modbus.check_value().as_deref(), Some("85 C9"));
    }

    #[test]
    fn a_command_reads_back_as_it_is_shown() {
        for command in ["$01M", "~**", "hex 01 03 00 00 00 05"] {
            assert_eq!(RawCommand::parse(command, false).unwrap().to_string(), command);
        }
    }

    #[test]
    fn commands_and_requests_of_the_bus_are_the_same() {
        for command in ["$01M", "hex 01 03 00 00 00 05"] {
            let command = RawCommand::parse(command, true).unwrap();
            assert_eq!(RawCommand::from(RawRequest::from(command.clone())), command);
        }
    }

    #[test]
    fn what_cannot_be_sent_is_refused_with_what_to_write() {
        for (text, expected) in [
            ("", "nothing to send"),
            ("$", "only a delimiter"),
            ("01M", "$ # % @ ~"),
            ("!01PIR234", "looks like an answer"),
            ("01 03 00 00 00 05", "for Modbus write hex 01 03"),
            ("$01ü", "ASCII"),
            ("hex", "at least an address"),
            ("hex 01", "at least an address"),
            ("hex 01 3", "\"3\""),
        ] {
            let reason = RawCommand::parse(text, false).unwrap_err();
            assert!(reason.contains(expected), "{text}: {reason}");
        }
        let long = format!("hex {}", "00 ".repeat(255));
        assert!(RawCommand::parse(&long, false).unwrap_err().contains("at most 254"));
    }

    #[test]
    fn a_checksum_typed_by_hand_is_told() {
        assert!(hints("$01FCB", true)[0].contains("sent twice"));
        assert_eq!(better("$01FCB", true), [Some("$01F".to_owned())]);
        assert!(hints("$01FCB", false)[0].contains("switch the checksum on"));
        assert!(hints("hex 01 03 00 00 00 05 85 C9", false)[0].contains("CRC"));
        assert_eq!(better("hex 0103000000 05 85C9", false), [Some("hex 01 03 00 00 00 05".to_owned())]);
    }

    #[test]
    fn lower_case_a_missing_address_and_a_missing_delimiter_are_told() {
        assert_eq!(better("$0am", false), [Some("$0AM".to_owned())]);
        assert!(hints("$1M", false)[0].contains("two hexadecimal digits"));
        assert!(hints("01M", false)[0].starts_with("A DCON command begins"));
        assert_eq!(better("01 03 00 00 00 05", false), [Some("hex 01 03 00 00 00 05".to_owned())]);
        assert_eq!(better("$01M\\r", false), [Some("$01M".to_owned())]);
    }

    #[test]
    fn a_right_command_gets_no_hint() {
        for text in ["", "$01M", "~**", "@A0DI", "#01", "~01RD1E", "hex 01 03 00 00 00 05"] {
            for checksum in [false, true] {
                assert_eq!(hints(text, checksum), Vec::<String>::new(), "{text}");
            }
        }
    }

    #[test]
    fn checksum_and_crc_are_taken_off_an_answer_only_where_they_are_right() {
        let dcon = |checksum| RawCommand::Dcon { text: "$02M".into(), checksum };
        assert_eq!(dcon(true).without_check(b"!02PIR13002"), b"!02PIR130");
        assert_eq!(dcon(true).without_check(b"!02PIR13003"), b"!02PIR13003");
        assert_eq!(dcon(false).without_check(b"!02PIR13002"), b"!02PIR13002");
        let request = RawCommand::Modbus { bytes: vec![1, 3, 0, 0, 0, 1] };
        let answer = modbus::with_crc(&[1, 3, 2, 0, 7]);
        assert_eq!(request.without_check(&answer), [1, 3, 2, 0, 7]);
        assert_eq!(request.without_check(&[1, 3, 2, 0, 7]), [1, 3, 2, 0, 7]);
        assert_eq!(request.without_check(&[1]), [1]);
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text: String, checksum: bool) {
            let _ = check_typed(&text, checksum);
            if let Ok(command) = RawCommand::parse(&text, checksum) {
                prop_assert_eq!(RawCommand::parse(&command.to_string(), checksum), Ok(command));
            }
        }

        #[test]
        fn nothing_that_looks_like_a_command_makes_it_panic(text in "(hex )?[$#%@~]?[0-9A-Fa-f* ü]{0,12}", checksum: bool) {
            let _ = check_typed(&text, checksum);
            let _ = RawCommand::parse(&text, checksum);
        }
    }
}
