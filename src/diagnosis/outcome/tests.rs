//! The kinds, from what the bus says on bytes that were really received.

use std::collections::VecDeque;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use super::*;
use crate::bus::dialogue::Dialogue;
use crate::bus::line::{Line, LineLost};
use crate::bus::transaction::Wire;
use crate::bus::{Direction, Patience, Target};
use crate::module::Ask;
use crate::protocol::{AnswerFrom, Failure, LineSettings, Query, dcon, modbus};

/// A line that answers each request with the next of these; it is lost when none is left.
struct Scripted {
    now: Instant,
    answers: VecDeque<Vec<u8>>,
    incoming: Vec<u8>,
}

impl Line for Scripted {
    fn configure(&mut self, _: LineSettings) -> Result<(), LineLost> {
        Ok(())
    }

    fn send(&mut self, _: &[u8]) -> Result<(), LineLost> {
        self.incoming = self.answers.pop_front().unwrap_or_default();
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        if self.incoming == b"lost" {
            return Err(LineLost::new("it was unplugged"));
        }
        let count = self.incoming.len().min(buffer.len());
        buffer.iter_mut().zip(self.incoming.drain(..count)).for_each(|(to, byte)| *to = byte);
        if count == 0 {
            self.now = self.now.max(deadline);
        }
        Ok(count)
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.incoming.clear();
        Ok(())
    }

    fn look(&mut self) -> Result<(), LineLost> {
        Ok(())
    }

    fn now(&self) -> Instant {
        self.now
    }

    fn wait_until(&mut self, instant: Instant) {
        self.now = self.now.max(instant);
    }
}

/// What the last of these answers is told to be, and in which words.
fn told(target: Target, query: &Query, answers: &[&[u8]]) -> (Outcome, Verdict) {
    let answers: VecDeque<_> = answers.iter().map(|answer| answer.to_vec()).collect();
    let count = answers.len();
    let line = Scripted { now: Instant::now(), answers, incoming: Vec::new() };
    let (send, frames) = mpsc::channel();
    let wire = Wire::new(Box::new(line), target.settings, Box::new(move |frame| drop(send.send(frame)))).unwrap();
    let mut dialogue = Dialogue::on_wire(wire).unwrap();
    let patience = Patience { window: Duration::from_millis(60), after_silence: 0, after_garbage: 0, after_change: 0 };
    for _ in 0..count {
        let _ = dialogue.with(target, patience).ask(query);
    }
    let received = frames.try_iter().filter(|frame| frame.direction == Direction::Received);
    let frame = received.last().unwrap();
    (Outcome::of(&frame).unwrap(), frame.verdict)
}

fn rtu(answers: &[&[u8]]) -> (Outcome, Verdict) {
    let target =
        Target { address: 1, protocol: Protocol::ModbusRtu, settings: LineSettings::default(), checksum: false };
    told(target, &Query::ReadHoldingRegisters { first: 0x1E0, count: 1 }, answers)
}

fn dcon(text: &str, checksum: bool, answers: &[&[u8]]) -> (Outcome, Verdict) {
    let target = Target { address: 1, protocol: Protocol::Dcon, settings: LineSettings::default(), checksum };
    let query = Query::Dcon { text: text.to_owned(), from: AnswerFrom::Addresses(vec![1]), write: false };
    told(target, &query, answers)
}

fn failed(kind: FailureKind) -> Outcome {
    Outcome::Failed(kind)
}

#[test]
fn what_the_bus_says_of_modbus_answers_is_known() {
    let good = modbus::with_crc(&[1, 3, 2, 0, 7]);
    let [mut wrong, twice] = [good.clone(), good.repeat(2)];
    wrong[4] ^= 1;
    let echo = [modbus::with_crc(&[1, 3, 1, 0xE0, 0, 1]), good.clone()].concat();
    let cases: [(&[&[u8]], Outcome); 12] = [
        (&[&good], Outcome::Answer),
        (&[&twice], Outcome::Answer),
        (&[&modbus::with_crc(&[1, 0x83, 2])], Outcome::Refusal(RefusalKind::Exception(2))),
        (&[b""], failed(FailureKind::NoAnswer)),
        (&[&good[..4]], failed(FailureKind::CutShort)),
        (&[&good[..1]], failed(FailureKind::CutShort)),
        (&[&wrong], failed(FailureKind::WrongCheck)),
        (&[&modbus::with_crc(&[2, 3, 2, 0, 7])], failed(FailureKind::WrongAddress)),
        (&[&modbus::with_crc(&[1, 4, 2, 0, 7])], failed(FailureKind::Garbage)),
        (&[&[0, 0xFF]], failed(FailureKind::StrayBytes)),
        (&[&[0x81, 0x92, 0x33, 0x44, 0x55]], failed(FailureKind::Garbage)),
        (&[&echo, &wrong], failed(FailureKind::Collision)),
    ];
    for (answers, outcome) in cases {
        let (found, verdict) = rtu(answers);
        assert_eq!(found, outcome, "{verdict:?} on {answers:02X?}");
    }
}

#[test]
fn an_answer_that_is_too_long_is_not_cut_short() {
    let long = modbus::with_crc(&[1, 3, 4, 0, 7, 0, 8]);
    let error = modbus::check_answer(&modbus::with_crc(&[1, 3, 1, 0xE0, 0, 1]), &long).unwrap_err().to_string();
    assert_eq!(FailureKind::of_reason(&error), FailureKind::Garbage, "{error}");
    let short = modbus::with_crc(&[1, 3, 2, 0, 7]);
    let error = modbus::check_answer(&modbus::with_crc(&[1, 3, 1, 0xE0, 0, 2]), &short).unwrap_err().to_string();
    assert_eq!(FailureKind::of_reason(&error), FailureKind::CutShort, "{error}");
}

#[test]
fn what_the_bus_says_of_dcon_answers_is_known() {
    for (checksum, answer, outcome) in [
        (false, &b"!01PIR234\r"[..], Outcome::Answer),
        (false, b"?01\r", Outcome::Refusal(RefusalKind::Dcon)),
        (false, b"!\r", failed(FailureKind::Other)),
        (false, b"", failed(FailureKind::NoAnswer)),
        (false, b"!01PIR", failed(FailureKind::CutShort)),
        (true, b"!1\r", failed(FailureKind::CutShort)),
        (true, b"!01PIR234\r", failed(FailureKind::WrongCheck)),
        (false, b"!02PIR130\r", failed(FailureKind::WrongAddress)),
        (false, b"\x80\xF0\x1C", failed(FailureKind::Garbage)),
        (false, b"!01\x02IR\r", failed(FailureKind::Garbage)),
        (false, b"\xFF\x00", failed(FailureKind::StrayBytes)),
        (false, b"lost", Outcome::LineLost),
    ] {
        let (found, verdict) = dcon("$01M", checksum, &[answer]);
        assert_eq!(found, outcome, "{verdict:?} on {answer:02X?}");
    }
    let (found, verdict) = dcon("@01DO01", false, &[b"!\r"]);
    assert_eq!(found, Outcome::Refusal(RefusalKind::Ignored), "{verdict:?}");
    let (found, verdict) = dcon("$01M", false, &[b"$01M\r!01PIR234\r", b"$0qM\r"]);
    assert_eq!(found, failed(FailureKind::Collision), "{verdict:?}");
}

#[test]
fn every_error_of_the_protocols_is_known() {
    use crate::protocol::dcon::FrameError as Dcon;
    use crate::protocol::modbus::AnswerError as Modbus;
    let wrong = Dcon::Checksum { found: "00".to_owned(), expected: "B7".to_owned() };
    for (reason, kind) in [
        (Dcon::Empty.to_string(), FailureKind::Garbage),
        (Dcon::Delimiter(7).to_string(), FailureKind::Garbage),
        (Dcon::NotText(7).to_string(), FailureKind::Garbage),
        (Dcon::ChecksumMissing.to_string(), FailureKind::CutShort),
        (wrong.to_string(), FailureKind::WrongCheck),
        (Modbus::Short(3).to_string(), FailureKind::CutShort),
        (Modbus::Crc { found: 1, expected: 2 }.to_string(), FailureKind::WrongCheck),
        (Modbus::Address { found: 2, expected: 1 }.to_string(), FailureKind::WrongAddress),
        (Modbus::Function { found: 2, expected: 1 }.to_string(), FailureKind::Garbage),
        (Modbus::Length { found: 7, expected: 9 }.to_string(), FailureKind::CutShort),
        (Modbus::Length { found: 9, expected: 7 }.to_string(), FailureKind::Garbage),
    ] {
        assert_eq!(FailureKind::of_reason(&reason), kind, "{reason}");
    }
    assert!(dcon::decode(b"", false).is_err());
}

#[test]
fn words_that_are_not_known_are_another_kind() {
    for reason in ["", "the wait for an answer that is late was cut short", "it was said with a wrong CRC: indeed"] {
        assert_eq!(FailureKind::of_reason(reason), FailureKind::Other, "{reason}");
    }
    assert!(Failure::LineLost(String::new()).to_string().starts_with("the line was lost"));
}
