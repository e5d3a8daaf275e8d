//! What Modbus needs beside `tokio-modbus`: where an RTU answer ends, and whether it is the one asked for.
//!
//! `tokio-modbus` encodes requests and decodes answers, but it cannot frame a serial stream safely (it knows neither
//! echoes nor function 0x46), so the transaction hands it one whole, verified answer at a time.

/// Set in the function code of an exception.
const EXCEPTION: u8 = 0x80;
/// Address, function, exception code, CRC.
const EXCEPTION_LENGTH: usize = 5;
/// Read/write module settings (PIR-130 manual 3.10).
pub const MODULE_SETTINGS: u8 = 0x46;

/// How many bytes an answer has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnswerLength {
    /// So many, address and CRC included.
    Bytes(usize),
    /// More has to arrive before it is known.
    NotYetKnown,
    /// The function is not known: the answer ends with silence.
    UntilSilence,
    /// What arrived cannot be the answer to this request.
    Mismatch,
}

/// An answer that must not be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AnswerError {
    #[error("the answer has {0} bytes, too few for a Modbus frame")]
    Short(usize),
    #[error("wrong CRC: {found:04X} was received, {expected:04X} is right")]
    Crc { found: u16, expected: u16 },
    #[error("the answer comes from address {found} instead of {expected}")]
    Address { found: u8, expected: u8 },
    #[error("the answer is for function 0x{found:02X} instead of 0x{expected:02X}")]
    Function { found: u8, expected: u8 },
    #[error("the answer has {found} bytes instead of {expected}")]
    Length { found: usize, expected: usize },
    #[error("the answer is for number {found} on the wire instead of {expected}")]
    OfAnother { found: u16, expected: u16 },
}

/// CRC-16/MODBUS; on the wire its low byte comes first.
pub fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, &byte| {
        (0..8).fold(crc ^ u16::from(byte), |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xA001 } else { crc >> 1 })
    })
}

/// `bytes` followed by their CRC.
pub fn with_crc(bytes: &[u8]) -> Vec<u8> {
    let mut frame = bytes.to_vec();
    frame.extend(crc(bytes).to_le_bytes());
    frame
}

/// How long the answer to `request` is, judged by what has been `received` of it so far. Both start at the address.
pub fn answer_length(request: &[u8], received: &[u8]) -> AnswerLength {
    let (Some(&address), Some(&function)) = (request.first(), request.get(1)) else { return AnswerLength::Mismatch };
    match received {
        [] => return AnswerLength::NotYetKnown,
        [from, ..] if *from != address => return AnswerLength::Mismatch,
        [_] => return AnswerLength::NotYetKnown,
        [_, answered, ..] if *answered == function | EXCEPTION => return AnswerLength::Bytes(EXCEPTION_LENGTH),
        [_, answered, ..] if *answered != function => return AnswerLength::Mismatch,
        _ => {}
    }
    let quantity = usize::from(u16_at(request, 4));
    match function {
        0x01 | 0x02 => AnswerLength::Bytes(5 + quantity.div_ceil(8)),
        0x03 | 0x04 => AnswerLength::Bytes(5 + 2 * quantity),
        0x05 | 0x06 | 0x0F | 0x10 => AnswerLength::Bytes(8),
        MODULE_SETTINGS => settings_answer_length(request.get(2).copied()),
        _ => AnswerLength::UntilSilence,
    }
}

/// PIR-130 manual 3.10.1 to 3.10.5.
fn settings_answer_length(sub_function: Option<u8>) -> AnswerLength {
    match sub_function {
        Some(0x00 | 0x04) => AnswerLength::Bytes(9),
        Some(0x05 | 0x06) => AnswerLength::Bytes(13),
        Some(0x20) => AnswerLength::Bytes(8),
        _ => AnswerLength::UntilSilence,
    }
}

/// Whether `answer` is a whole answer to `request`, exceptions included.
pub fn check_answer(request: &[u8], answer: &[u8]) -> Result<(), AnswerError> {
    let short = || AnswerError::Short(answer.len());
    let body_length = answer.len().checked_sub(2).filter(|length| *length >= 2).ok_or_else(short)?;
    let (body, found) = answer.split_at_checked(body_length).ok_or_else(short)?;
    let found = u16_at(found, 0).swap_bytes();
    let expected = crc(body);
    if found != expected {
        return Err(AnswerError::Crc { found, expected });
    }
    let at = |bytes: &[u8], index: usize| bytes.get(index).copied().unwrap_or_default();
    if at(body, 0) != at(request, 0) {
        return Err(AnswerError::Address { found: at(body, 0), expected: at(request, 0) });
    }
    if at(body, 1) & !EXCEPTION != at(request, 1) {
        return Err(AnswerError::Function { found: at(body, 1), expected: at(request, 1) });
    }
    let writes = matches!(at(body, 1), 0x05 | 0x06 | 0x0F | 0x10) && body.len() >= 6;
    if writes && u16_at(body, 2) != u16_at(request, 2) {
        return Err(AnswerError::OfAnother { found: u16_at(body, 2), expected: u16_at(request, 2) });
    }
    let reads = matches!(at(body, 1), 0x01..=0x04);
    let announced = usize::from(at(body, 2)).saturating_add(5);
    match answer_length(request, answer) {
        AnswerLength::Bytes(expected) if expected != answer.len() => {
            Err(AnswerError::Length { found: answer.len(), expected })
        }
        AnswerLength::Bytes(expected) if reads && announced != expected => {
            Err(AnswerError::Length { found: announced, expected })
        }
        _ => Ok(()),
    }
}

/// Big-endian word at `at`; missing bytes count as zero.
fn u16_at(bytes: &[u8], at: usize) -> u16 {
    let byte = |index: usize| bytes.get(index).copied().unwrap_or_default();
    u16::from_be_bytes([byte(at), byte(at.saturating_add(1))])
}

/// What an exception code means and what to do about it.
pub fn exception_text(code: u8) -> &'static str {
    match code {
        0x01 => "illegal function: the module does not know this function",
        0x02 => "illegal data address: the module has no such register or coil",
        0x03 => "illegal data value: the value is out of range, or not allowed in the present state",
        0x04 => "device failure: the module could not carry the command out",
        0x05 => "acknowledge: the module needs longer to answer",
        0x06 => "busy: try again",
        0x0A => "gateway path unavailable",
        0x0B => "the gateway's target did not answer",
        _ => "an exception code that the Modbus standard does not list",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::hex;
    use proptest::prelude::*;

    fn vectors() -> Vec<(String, Vec<u8>, Vec<u8>)> {
        include_str!("../../tests/vectors/modbus-rtu.csv")
            .lines()
            .skip(1)
            .map(|row| {
                let mut cells = row.rsplitn(3, ',');
                let response = hex::parse(cells.next().unwrap()).unwrap();
                let request = hex::parse(cells.next().unwrap()).unwrap();
                (cells.next().unwrap().to_owned(), request, response)
            })
            .collect()
    }

    #[test]
    fn every_published_frame_has_the_crc_we_compute() {
        let rows = vectors();
        assert!(rows.len() > 10);
        for (purpose, request, response) in rows {
            for frame in [request, response].into_iter().filter(|frame| !frame.is_empty()) {
                assert_eq!(with_crc(&frame[..frame.len() - 2]), frame, "{purpose}");
            }
        }
    }

    #[test]
    fn every_published_exchange_is_accepted_and_its_length_known_from_the_first_bytes() {
        let exchanges: Vec<_> = vectors().into_iter().filter(|(_, q, a)| !q.is_empty() && !a.is_empty()).collect();
        assert!(exchanges.len() > 3);
        for (purpose, request, response) in exchanges {
            assert_eq!(check_answer(&request, &response), Ok(()), "{purpose}");
            assert_eq!(answer_length(&request, &response[..2]), AnswerLength::Bytes(response.len()), "{purpose}");
        }
    }

    #[test]
    fn stored_settings_over_function_46_have_thirteen_bytes() {
        let request = with_crc(&[1, 0x46, 0x05, 0]);
        let answer = hex::parse("01 46 05 00 06 00 00 00 01 00 00 E8 43").unwrap();
        assert_eq!(check_answer(&request, &answer), Ok(()));
    }

    #[test]
    fn a_refusal_of_function_46_is_an_answer() {
        let request = with_crc(&[1, 0x46, 0x07]);
        assert_eq!(check_answer(&request, &hex::parse("01 C6 02 F2 61").unwrap()), Ok(()));
    }

    #[test]
    fn an_answer_from_elsewhere_or_of_another_shape_is_refused() {
        let request = with_crc(&[1, 3, 0, 0, 0, 1]);
        let answer = |bytes: &[u8]| check_answer(&request, &with_crc(bytes));
        assert_eq!(answer(&[2, 3, 2, 0, 0]), Err(AnswerError::Address { found: 2, expected: 1 }));
        assert_eq!(answer(&[1, 4, 2, 0, 0]), Err(AnswerError::Function { found: 4, expected: 3 }));
        assert_eq!(answer(&[1, 3, 4, 0, 0, 0, 0]), Err(AnswerError::Length { found: 9, expected: 7 }));
        assert!(matches!(check_answer(&request, &[1, 3, 2, 0, 0, 1, 2]), Err(AnswerError::Crc { .. })));
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_checks_panic(request: Vec<u8>, answer: Vec<u8>) {
            let _ = check_answer(&request, &answer);
            let _ = answer_length(&request, &answer);
        }

        #[test]
        fn one_flipped_bit_is_always_noticed(words in prop::collection::vec(any::<u16>(), 1..20), bit in 0usize..320) {
            let request = with_crc(&[1, 3, 0, 0, 0, words.len() as u8]);
            let mut body = vec![1, 3, words.len() as u8 * 2];
            body.extend(words.iter().flat_map(|word| word.to_be_bytes()));
            let mut answer = with_crc(&body);
            prop_assert_eq!(check_answer(&request, &answer), Ok(()));
            let bit = bit % (answer.len() * 8);
            answer[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(check_answer(&request, &answer).is_err());
        }
    }
}
