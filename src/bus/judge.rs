//! Decides what bytes that came back on a request are: the answer, an echo, noise, or not enough yet. Pure.

use super::name::is_name;
use crate::protocol::modbus::{self, AnswerLength};
use crate::protocol::{AnswerFrom, Failure, Protocol, dcon};

/// What may come back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Expected {
    Dcon {
        checksum: bool,
        from: AnswerFrom,
        content: Content,
    },
    Rtu {
        address: u8,
    },
    /// A broadcast: nobody answers.
    Nothing {
        protocol: Protocol,
        checksum: bool,
    },
}

/// What an answer has to say to be the one that is awaited. Whatever else the module says is passed over.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Content {
    #[default]
    Any,
    /// A name. It should be this one; another shows that another module answers.
    Name(Vec<u8>),
    /// Anything but these answers, which are owed to other questions.
    NoneOf(Vec<Vec<u8>>),
}

impl Content {
    fn admits(&self, answer: &[u8]) -> bool {
        match self {
            Self::Any => true,
            Self::Name(_) => is_name(answer),
            Self::NoneOf(others) => others.iter().all(|other| other != answer),
        }
    }
}

impl Expected {
    /// Whether the answer can say this.
    pub fn admits(&self, answer: &[u8]) -> bool {
        self.content().is_none_or(|content| content.admits(answer))
    }

    /// Whether something that the module may say is passed over.
    pub fn is_choosy(&self) -> bool {
        self.content().is_some_and(|content| *content != Content::Any)
    }

    fn content(&self) -> Option<&Content> {
        match self {
            Self::Dcon { content, .. } => Some(content),
            _ => None,
        }
    }

    /// The module that is asked, if there is only one.
    pub fn address(&self) -> Option<u8> {
        match self {
            Self::Rtu { address } => Some(*address),
            Self::Dcon { from: AnswerFrom::Addresses(addresses), .. } => addresses.first().copied(),
            _ => None,
        }
    }

    /// The language of the exchange, and whether it carries DCON checksums.
    pub fn language(&self) -> (Protocol, bool) {
        match self {
            Self::Dcon { checksum, .. } => (Protocol::Dcon, *checksum),
            Self::Rtu { .. } => (Protocol::ModbusRtu, false),
            Self::Nothing { protocol, checksum } => (*protocol, *checksum),
        }
    }
}

/// What the bytes are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// The whole, verified answer. `noise`: there are other bytes around it; `surplus`: some of them are more than the
    /// 00 and FF of a line without bias, so they may be an answer to something else.
    Answer { bytes: Vec<u8>, echo: bool, noise: bool, surplus: bool },
    /// Only an echo or stray bytes so far: the answer has not begun.
    NothingYet,
    /// What is there is an answer to another question, so the module has not come to this one yet.
    PassedOver,
    /// It has begun; more has to come.
    More,
    /// It will not become an answer any more.
    Failed(Failure),
}

/// Judges what has arrived while more may still come.
pub fn so_far(request: &[u8], expected: &Expected, received: &[u8], echoes: bool) -> Verdict {
    let (rest, echo) = without_echo(request, expected, received, echoes);
    if rest.is_empty() {
        return Verdict::NothingYet;
    }
    // A prefix of the request is an echo in the making; nothing else can be said yet.
    if !echo && rest.len() < request.len() && request.starts_with(rest) {
        return Verdict::NothingYet;
    }
    let found = match expected {
        Expected::Dcon { checksum, from, content } => find_dcon(request, rest, *checksum, from, content),
        Expected::Rtu { .. } => find_rtu(request, rest),
        Expected::Nothing { .. } => None,
    };
    match found {
        Some(bytes) => {
            let is_dcon = matches!(expected, Expected::Dcon { .. });
            let terminator = usize::from(is_dcon);
            // The last byte of a CRC may be 0A, and is no line feed.
            let heard = if is_dcon { trim_line_feed(rest) } else { rest };
            let noise = bytes.len().saturating_add(terminator) != heard.len();
            let meant = |bytes: &[u8]| bytes.iter().filter(|byte| !is_noise(**byte)).count();
            let surplus = meant(rest) > meant(&bytes).saturating_add(terminator);
            Verdict::Answer { bytes, echo, noise, surplus }
        }
        None if rest.iter().all(|byte| is_noise(*byte)) => Verdict::NothingYet,
        None if expected.is_choosy() && trim_line_feed(rest).ends_with(&[dcon::CR]) => Verdict::PassedOver,
        None => Verdict::More,
    }
}

/// Judges what has arrived when nothing more came in time.
pub fn after_silence(request: &[u8], expected: &Expected, received: &[u8], echoes: bool) -> Verdict {
    let (rest, echo) = without_echo(request, expected, received, echoes);
    if rest.is_empty() {
        return Verdict::Failed(Failure::Silent);
    }
    let start = rest.iter().position(|byte| !is_noise(*byte)).unwrap_or(rest.len());
    let meant = rest.get(start..).unwrap_or_default();
    if meant.is_empty() {
        let reason = "only stray bytes came back: line noise".to_owned();
        return Verdict::Failed(Failure::Garbled { reason, bytes: rest.to_vec() });
    }
    if echoes && !echo {
        return Verdict::Failed(Failure::Collision { bytes: rest.to_vec() });
    }
    match expected {
        Expected::Rtu { .. } => after_silence_rtu(request, meant, echo),
        Expected::Dcon { checksum, from, content } => Verdict::Failed(dcon_failure(meant, *checksum, from, content)),
        Expected::Nothing { .. } => Verdict::Failed(Failure::Silent),
    }
}

fn after_silence_rtu(request: &[u8], meant: &[u8], echo: bool) -> Verdict {
    let checked = modbus::check_answer(request, meant);
    match (modbus::answer_length(request, meant), checked) {
        (AnswerLength::UntilSilence, Ok(())) => {
            Verdict::Answer { bytes: meant.to_vec(), echo, noise: false, surplus: false }
        }
        (AnswerLength::Bytes(length), _) if meant.len() < length => {
            Verdict::Failed(Failure::Cut { bytes: meant.to_vec() })
        }
        (AnswerLength::NotYetKnown, _) => Verdict::Failed(Failure::Cut { bytes: meant.to_vec() }),
        (_, checked) => {
            let reason = checked.err().map_or_else(|| "unexpected bytes".to_owned(), |error| error.to_string());
            Verdict::Failed(Failure::Garbled { reason, bytes: meant.to_vec() })
        }
    }
}

fn dcon_failure(meant: &[u8], checksum: bool, from: &AnswerFrom, content: &Content) -> Failure {
    let bytes = meant.to_vec();
    let Some(range) = dcon::find_answer(meant) else {
        let begun = meant.first().is_some_and(|byte| dcon::ANSWER_DELIMITERS.contains(byte));
        let reason = "no DCON answer is in it".to_owned();
        return if begun { Failure::Cut { bytes } } else { Failure::Garbled { reason, bytes } };
    };
    let frame = meant.get(range).unwrap_or_default();
    let reason = match dcon::decode(frame, checksum) {
        Err(error) => error.to_string(),
        Ok(answer) if is_from(&answer, from) && !content.admits(frame) => {
            "the answer belongs to another question".to_owned()
        }
        Ok(dcon::Answer::Ignored) => "only commands for outputs are answered by a lone !".to_owned(),
        Ok(answer) => match from {
            AnswerFrom::Addresses(addresses) => {
                let asked: Vec<_> = addresses.iter().map(|address| format!("{address:02X}h")).collect();
                format!("{} does not come from address {}", answer.to_text(), asked.join(" or "))
            }
            _ => "unexpected bytes".to_owned(),
        },
    };
    Failure::Garbled { reason, bytes }
}

/// Takes off the echo of the request, if there is one.
///
/// Some answers equal their request: those to a Modbus write of one value, or to a loopback test. There an echo is taken
/// off only on a line that was seen to echo before; every module is identified before it is written to, which shows it.
fn without_echo<'a>(request: &[u8], expected: &Expected, received: &'a [u8], echoes: bool) -> (&'a [u8], bool) {
    match received.strip_prefix(request) {
        Some(rest) if echoes || shows_echo(request, expected) => (rest, true),
        _ => (received, false),
    }
}

/// Whether an echo can be told from the answer to this request.
pub fn shows_echo(request: &[u8], expected: &Expected) -> bool {
    let differs = matches!(request.get(1).copied(), Some(0x01..=0x04 | 0x0F | 0x10 | modbus::MODULE_SETTINGS));
    differs || !matches!(expected, Expected::Rtu { .. })
}

fn find_rtu(request: &[u8], rest: &[u8]) -> Option<Vec<u8>> {
    (0..rest.len()).find_map(|start| {
        let candidate = rest.get(start..)?;
        let AnswerLength::Bytes(length) = modbus::answer_length(request, candidate) else { return None };
        let answer = candidate.get(..length)?;
        modbus::check_answer(request, answer).is_ok().then(|| answer.to_vec())
    })
}

/// A stray byte may look like a delimiter, so every delimiter is tried.
fn find_dcon(request: &[u8], rest: &[u8], checksum: bool, from: &AnswerFrom, content: &Content) -> Option<Vec<u8>> {
    let begins = |start: &usize| rest.get(*start).is_some_and(|byte| dcon::ANSWER_DELIMITERS.contains(byte));
    (0..rest.len()).filter(begins).find_map(|start| {
        let candidate = rest.get(start..)?;
        let range = dcon::find_answer(candidate).filter(|range| range.start == 0)?;
        let frame = candidate.get(range)?;
        let right =
            dcon::decode(frame, checksum).is_ok_and(|answer| is_from(&answer, from) && fits(request, &answer, from));
        (right && content.admits(frame)).then(|| frame.to_vec())
    })
}

fn is_from(answer: &dcon::Answer, from: &AnswerFrom) -> bool {
    let text = match answer {
        dcon::Answer::Ignored => return true,
        dcon::Answer::Valid { text, .. } | dcon::Answer::Refused { text } => text,
    };
    match (from, answer) {
        (AnswerFrom::Addresses(addresses), _) => {
            let digits = text.get(..2).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
            let sender = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
            sender.is_some_and(|sender| addresses.contains(&sender))
        }
        _ => true,
    }
}

/// `#` commands are answered by data behind a `>` (PIR-234 manual 5.3), and only commands for outputs are ignored, by a
/// lone `!` that does not tell whose it is.
fn fits(request: &[u8], answer: &dcon::Answer, from: &AnswerFrom) -> bool {
    match answer {
        dcon::Answer::Valid { delimiter: '!', .. } => request.first() != Some(&b'#'),
        dcon::Answer::Ignored => matches!(request.first(), Some(b'#' | b'@')) || *from == AnswerFrom::Anyone,
        _ => true,
    }
}

/// Bytes that a line without bias or termination shows between frames.
pub fn is_noise(byte: u8) -> bool {
    matches!(byte, 0x00 | 0xFF | b'\n')
}

/// Some modules send a line feed behind the CR.
fn trim_line_feed(bytes: &[u8]) -> &[u8] {
    bytes.strip_suffix(b"\n").unwrap_or(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const READ: &[u8] = &[1, 3, 1, 0xE0, 0, 1];

    fn rtu() -> Expected {
        Expected::Rtu { address: 1 }
    }

    fn dcon(checksum: bool) -> Expected {
        Expected::Dcon { checksum, from: AnswerFrom::Addresses(vec![1]), content: Content::Any }
    }

    #[test]
    fn a_crc_that_ends_in_a_line_feed_is_no_noise_and_a_line_feed_behind_it_is() {
        let ends_so = |number: &u16| modbus::with_crc(&[1, 3, 2, (number >> 8) as u8, *number as u8]).ends_with(b"\n");
        let value = (0..=u16::MAX).find(ends_so).unwrap();
        let mut answer = modbus::with_crc(&[1, 3, 2, (value >> 8) as u8, value as u8]);
        let noisy = |bytes: &[u8]| match so_far(&modbus::with_crc(READ), &rtu(), bytes, false) {
            Verdict::Answer { noise, .. } => noise,
            other => panic!("{other:?}"),
        };
        assert!(!noisy(&answer));
        answer.push(b'\n');
        assert!(noisy(&answer));
    }

    fn answer_of(verdict: Verdict) -> Option<Vec<u8>> {
        if let Verdict::Answer { bytes, .. } = verdict { Some(bytes) } else { None }
    }

    #[test]
    fn an_echo_is_taken_off_and_remembered() {
        let request = modbus::with_crc(READ);
        let answer = modbus::with_crc(&[1, 3, 2, 0x0B, 0x28]);
        let both = [request.clone(), answer.clone()].concat();
        assert_eq!(so_far(&request, &rtu(), &request, false), Verdict::NothingYet);
        assert_eq!(
            so_far(&request, &rtu(), &both, false),
            Verdict::Answer { bytes: answer, echo: true, noise: false, surplus: false }
        );
    }

    #[test]
    fn an_echo_alone_is_silence() {
        let verdict = after_silence(b"$01M\r", &dcon(false), b"$01M\r", false);
        assert_eq!(verdict, Verdict::Failed(Failure::Silent));
    }

    #[test]
    fn the_answer_to_a_single_write_is_not_mistaken_for_an_echo() {
        let request = modbus::with_crc(&[1, 6, 2, 0, 0, 10]);
        assert_eq!(answer_of(so_far(&request, &rtu(), &request, false)), Some(request.clone()));
        assert_eq!(so_far(&request, &rtu(), &request, true), Verdict::NothingYet);
        assert_eq!(answer_of(so_far(&request, &rtu(), &request.repeat(2), true)), Some(request));
    }

    #[test]
    fn stray_bytes_around_a_good_answer_are_dropped_and_told() {
        let request = modbus::with_crc(READ);
        let answer = modbus::with_crc(&[1, 3, 2, 0, 7]);
        let noisy = [&[0x00, 0xFF][..], &answer, &[0xFF]].concat();
        assert_eq!(
            so_far(&request, &rtu(), &noisy, false),
            Verdict::Answer { bytes: answer, echo: false, noise: true, surplus: false }
        );
    }

    #[test]
    fn an_answer_of_another_module_is_passed_over() {
        let received = b"!02PIR130\r!01PIR234\r";
        assert_eq!(answer_of(so_far(b"$01M\r", &dcon(false), received, false)), Some(b"!01PIR234".to_vec()));
    }

    #[test]
    fn only_a_command_for_an_output_is_ignored() {
        assert_eq!(answer_of(so_far(b"@01DO01\r", &dcon(false), b"!\r", false)), Some(b"!".to_vec()));
        assert_eq!(so_far(b"$012\r", &dcon(false), b"!\r", false), Verdict::More);
        let late = b"!\r!01400600\r";
        assert_eq!(answer_of(so_far(b"$012\r", &dcon(false), late, false)), Some(b"!01400600".to_vec()));
    }

    #[test]
    fn what_differs_from_the_request_on_an_echoing_line_is_a_collision() {
        let verdict = after_silence(b"$01M\r", &dcon(false), b"$0qM\r", true);
        assert!(matches!(verdict, Verdict::Failed(Failure::Collision { .. })));
    }

    #[test]
    fn an_answer_cut_short_is_told_apart_from_garbage() {
        let request = modbus::with_crc(READ);
        let cut = after_silence(&request, &rtu(), &[1, 3, 2, 0], false);
        assert!(matches!(cut, Verdict::Failed(Failure::Cut { .. })), "{cut:?}");
        let garbage = after_silence(&request, &rtu(), &[0x81, 0x92, 0x33], false);
        assert!(matches!(garbage, Verdict::Failed(Failure::Garbled { .. })), "{garbage:?}");
    }

    #[test]
    fn a_wrong_dcon_checksum_is_never_accepted() {
        assert_eq!(so_far(b"$01MD2\r", &dcon(true), b"!01PIR2344C\r", false), Verdict::More);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic_and_nothing_unverified_is_accepted(received: Vec<u8>, echoes: bool) {
            let request = modbus::with_crc(READ);
            for verdict in [so_far(&request, &rtu(), &received, echoes), after_silence(&request, &rtu(), &received, echoes)] {
                if let Verdict::Answer { bytes, .. } = verdict {
                    prop_assert_eq!(modbus::check_answer(&request, &bytes), Ok(()));
                }
            }
            let _ = so_far(b"$01M\r", &dcon(true), &received, echoes);
            let _ = after_silence(b"$01M\r", &dcon(false), &received, echoes);
        }

        #[test]
        fn an_answer_is_found_however_its_bytes_are_split(cut in 0usize..9, noise in prop::collection::vec(prop_oneof![Just(0u8), Just(0xFF)], 0..4)) {
            let request = modbus::with_crc(READ);
            let answer = [noise, modbus::with_crc(&[1, 3, 2, 0x0B, 0x28])].concat();
            let part = &answer[..cut.min(answer.len() - 1)];
            prop_assert!(answer_of(so_far(&request, &rtu(), part, false)).is_none());
            prop_assert!(answer_of(so_far(&request, &rtu(), &answer, false)).is_some());
        }
    }
}
