//! What chance does to bytes and answers, drawn from one generator.

use std::ops::RangeInclusive;
use std::time::Duration;

use crate::protocol::LineSettings;

use super::super::world::Answer;
use super::super::{dcon, modbus};
use super::sound::Code;
use super::{FaultKind, Faults, Injected, Strength};

/// Most 00 or FF on each side of an answer.
const MOST_NOISE: usize = 3;
/// Between an answer and the same again, in milliseconds.
const PAUSES_MS: RangeInclusive<u64> = 1..=30;
/// Least and most bytes that a module of another speed seems to answer.
const GARBAGE: RangeInclusive<usize> = 3..=20;

/// One try at damage, with what has struck in it.
pub struct Damage<'a> {
    pub faults: &'a Faults,
    pub random: &'a mut fastrand::Rng,
    pub struck: Injected,
    /// Right frames that faults put on the line on purpose.
    pub made: Vec<Vec<u8>>,
}

impl<'a> Damage<'a> {
    pub fn new(faults: &'a Faults, random: &'a mut fastrand::Rng) -> Self {
        Self { faults, random, struck: Injected::new(), made: Vec::new() }
    }

    fn happens(&mut self, kind: FaultKind) -> bool {
        match self.faults.get(kind) {
            Some(Strength::Rate(rate)) => self.random.f64() < rate,
            _ => false,
        }
    }

    fn strike(&mut self, kind: FaultKind) {
        let count = self.struck.entry(kind).or_default();
        *count = count.saturating_add(1);
    }

    /// Flips, loses and inserts, each byte by chance.
    pub fn bytes(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut damaged = Vec::with_capacity(bytes.len());
        for &byte in bytes {
            if self.happens(FaultKind::Inserted) {
                self.strike(FaultKind::Inserted);
                damaged.push(self.random.u8(..));
            }
            if self.happens(FaultKind::Lost) {
                self.strike(FaultKind::Lost);
            } else if self.happens(FaultKind::Flipped) {
                self.strike(FaultKind::Flipped);
                damaged.push(byte ^ 1 << self.random.u8(..8));
            } else {
                damaged.push(byte);
            }
        }
        damaged
    }

    /// What the reader gets of one answer; `request` is what was asked.
    pub fn answer(&mut self, answer: &Answer, request: &[u8], code: Code, settings: LineSettings) -> Vec<Answer> {
        let mut bytes = answer.bytes.clone();
        let mut delay = answer.delay;
        if self.happens(FaultKind::Late) {
            self.strike(FaultKind::Late);
            delay = delay.saturating_add(self.lateness());
        }
        if self.happens(FaultKind::WrongAddress)
            && let Some(wrong) = self.wrong_address(&bytes, request, code)
        {
            self.strike(FaultKind::WrongAddress);
            self.made.push(wrong.clone());
            bytes = wrong;
        }
        if self.happens(FaultKind::WrongChecksum) && self.spoil_checksum(&mut bytes, code) {
            self.strike(FaultKind::WrongChecksum);
        }
        let twice = self.happens(FaultKind::Doubled);
        let again = bytes.clone();
        if self.happens(FaultKind::Cut) && bytes.len() > 1 {
            self.strike(FaultKind::Cut);
            bytes.truncate(self.random.usize(1..bytes.len()));
        }
        let first = self.on_its_way(&bytes, delay);
        let mut answers = vec![first];
        if twice {
            self.strike(FaultKind::Doubled);
            let pause = if self.random.bool() { 0 } else { self.random.u64(PAUSES_MS) };
            let length = answers.iter().map(|answer| answer.bytes.len()).sum();
            let delay = delay.saturating_add(settings.wire_time(length)).saturating_add(Duration::from_millis(pause));
            answers.push(self.on_its_way(&again, delay));
        }
        answers
    }

    fn on_its_way(&mut self, bytes: &[u8], delay: Duration) -> Answer {
        let mut bytes = self.bytes(bytes);
        if self.happens(FaultKind::Noise) {
            self.strike(FaultKind::Noise);
            let (before, after) = match self.random.u8(..3) {
                0 => (self.noise(), Vec::new()),
                1 => (Vec::new(), self.noise()),
                _ => (self.noise(), self.noise()),
            };
            bytes = [before, bytes, after].concat();
        }
        Answer { delay, bytes }
    }

    fn noise(&mut self) -> Vec<u8> {
        (0..self.random.usize(1..=MOST_NOISE)).map(|_| if self.random.bool() { 0xFF } else { 0x00 }).collect()
    }

    fn lateness(&mut self) -> Duration {
        let (least, most) = (*self.faults.late_by.start(), *self.faults.late_by.end());
        let span = most.saturating_sub(least);
        least.saturating_add(span.mul_f64(self.random.f64().clamp(0.0, 1.0)).min(span))
    }

    /// The same answer from another module, with a right checksum or CRC; nothing if there is no address in it.
    fn wrong_address(&mut self, bytes: &[u8], request: &[u8], code: Code) -> Option<Vec<u8>> {
        if let Code::Rtu(address) = code {
            let [_, rest @ ..] = modbus::checked(bytes)? else { return None };
            let others: Vec<u8> = (1..=247).filter(|&other| other != address).collect();
            let wrong = self.random.choice(others)?;
            return Some(modbus::sealed([&[wrong], rest].concat()));
        }
        let ends = if code == Code::Summed { 3 } else { 1 };
        let text = bytes.get(..bytes.len().checked_sub(ends)?)?;
        let (head, rest) = text.split_at_checked(3)?;
        let [delimiter @ (b'!' | b'?'), address @ ..] = head else { return None };
        if request.get(1..3) != Some(address) {
            return None;
        }
        // Not one that the request names elsewhere: a module may answer from an address that it was given.
        let named = |other: &String| request.windows(2).any(|pair| pair == other.as_bytes());
        let others = (0..=u8::MAX).map(|other| format!("{other:02X}")).filter(|other| !named(other));
        let wrong = self.random.choice(others.collect::<Vec<_>>())?;
        let mut text = [&[*delimiter], wrong.as_bytes(), rest].concat();
        if code == Code::Summed {
            text.extend(format!("{:02X}", dcon::sum(&text)).into_bytes());
        }
        text.push(b'\r');
        Some(text)
    }

    /// False if there is nothing to spoil.
    fn spoil_checksum(&mut self, bytes: &mut [u8], code: Code) -> bool {
        let (count, end) = match code {
            Code::Rtu(_) => (2, bytes.len()),
            Code::Summed => (2, bytes.len().saturating_sub(1)),
            Code::Open => return false,
        };
        let Some(check) = end.checked_sub(count).and_then(|start| bytes.get_mut(start..end)) else { return false };
        let right = check.to_vec();
        while check == right {
            let wrong = self.random.u16(..);
            let wrong = if code == Code::Summed {
                format!("{:02X}", wrong & 0xFF).into_bytes()
            } else {
                wrong.to_le_bytes().to_vec()
            };
            check.copy_from_slice(&wrong);
        }
        true
    }

    /// What a module of another speed says.
    pub fn garbage(&mut self) -> Vec<u8> {
        (0..self.random.usize(GARBAGE)).map(|_| self.random.u8(..)).collect()
    }
}
