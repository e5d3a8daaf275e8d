//! What is counted of the line as a whole.

use std::collections::{BTreeMap, BTreeSet};

use super::occurrences::Occurrences;
use super::surplus::Surplus;
use crate::bus::{Frame, Target};
use crate::protocol::{LineSettings, Protocol};

/// Silent addresses that somebody insists on, kept at most.
const MOST_INSISTED: usize = 64;

/// Counts of the line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LineFacts {
    /// Requests that were sent.
    pub requests: u64,
    /// Answers behind the echo of their request.
    pub echoes: u64,
    /// Answers with stray bytes around them.
    pub noisy: u64,
    /// Bytes for which nobody had asked.
    pub unasked_bytes: u64,
    /// Times that stray bytes or pieces came for which nobody had asked.
    pub stray: Occurrences,
    /// Whole answers that came after a request had been given up, or beside another answer.
    pub late: Occurrences,
    /// Answers that came a second time, byte for byte.
    pub copies: Occurrences,
    /// Times that only 00 and FF came where nobody ever answered, and from which addresses.
    pub stray_answers: Occurrences,
    stray_at: Addresses,
    /// How often the line was lost.
    pub losses: Occurrences,
    /// Questions to addresses that never answered.
    pub silent_questions: u64,
    /// Addresses that never answered, by protocol.
    silent: BTreeMap<Protocol, Addresses>,
    /// Addresses that answered in some protocol, at some speed.
    heard: Addresses,
    /// Speeds and formats that were tried without an answer.
    silent_settings: BTreeSet<LineSettings>,
    /// Silent addresses that were asked again at once, as nobody does who only searches, with how often.
    insisted: BTreeMap<Target, u64>,
}

/// A set of addresses.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Addresses([u128; 2]);

impl Addresses {
    fn parts(address: u8) -> (usize, u128) {
        (usize::from(address >> 7), 1u128.checked_shl(u32::from(address & 0x7F)).unwrap_or_default())
    }

    fn insert(&mut self, address: u8) {
        let (half, bit) = Self::parts(address);
        if let Some(bits) = self.0.get_mut(half) {
            *bits |= bit;
        }
    }

    fn remove(&mut self, address: u8) {
        let (half, bit) = Self::parts(address);
        if let Some(bits) = self.0.get_mut(half) {
            *bits &= !bit;
        }
    }

    fn contains(self, address: u8) -> bool {
        let (half, bit) = Self::parts(address);
        self.0.get(half).is_some_and(|bits| bits & bit != 0)
    }

    fn without(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        Self([a & !c, b & !d])
    }

    fn union(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        Self([a | c, b | d])
    }

    fn len(self) -> u32 {
        self.0.iter().map(|bits| bits.count_ones()).sum()
    }
}

impl LineFacts {
    pub(super) fn take(&mut self, frame: &Frame, around: Surplus, is_ordinary: bool) {
        self.echoes = self.echoes.saturating_add(u64::from(frame.echo));
        self.noisy = self.noisy.saturating_add(u64::from(around == Surplus::Stray));
        if is_ordinary {
            let all = [&mut self.stray, &mut self.late, &mut self.copies, &mut self.stray_answers, &mut self.losses];
            all.into_iter().for_each(Occurrences::follow);
        }
        if around.is_whole() {
            self.surplus(frame, around);
        }
    }

    /// Bytes that belong to no request; `after_silence` if the last one was given up.
    pub(super) fn take_unasked(&mut self, frame: &Frame, what: Surplus, after_silence: bool) {
        self.unasked_bytes = self.unasked_bytes.saturating_add(frame.bytes.len() as u64);
        let what = match what {
            // What is not noise is the rest of the answer that was waited for, or that answer.
            Surplus::Copy | Surplus::Piece if after_silence => Surplus::Other,
            what => what,
        };
        self.surplus(frame, what);
    }

    fn surplus(&mut self, frame: &Frame, what: Surplus) {
        match what {
            Surplus::Nothing => {}
            Surplus::Copy => self.copies.add(frame.at),
            Surplus::Other => self.late.add(frame.at),
            Surplus::Piece | Surplus::Stray => self.stray.add(frame.at),
        }
    }

    /// Only 00 and FF came where nobody ever answered: nobody is heard.
    pub(super) fn stray_from(&mut self, frame: &Frame, target: &Target) {
        self.stray_answers.add(frame.at);
        self.stray_at.insert(target.address);
        self.silent_at(target);
    }

    /// From how many addresses only 00 and FF came.
    pub fn stray_addresses(&self) -> u32 {
        self.stray_at.len()
    }

    /// Whether anything came from this address, in any protocol, at any speed.
    pub fn is_heard(&self, address: u8) -> bool {
        self.heard.contains(address)
    }

    pub(super) fn silent_at(&mut self, target: &Target) {
        self.silent_questions = self.silent_questions.saturating_add(1);
        self.silent.entry(target.protocol).or_default().insert(target.address);
        self.silent_settings.insert(target.settings);
    }

    pub(super) fn heard_at(&mut self, target: &Target) {
        self.insisted.remove(target);
        self.heard.insert(target.address);
        if let Some(addresses) = self.silent.get_mut(&target.protocol) {
            addresses.remove(target.address);
        }
    }

    pub(super) fn insist(&mut self, target: Target) {
        if self.insisted.len() < MOST_INSISTED || self.insisted.contains_key(&target) {
            let times = self.insisted.entry(target).or_default();
            *times = times.saturating_add(1);
        }
    }

    /// How many addresses never answered, in no protocol and at no speed.
    pub fn silent_addresses(&self) -> u32 {
        let silent = self.silent.values().fold(Addresses::default(), |all, some| all.union(*some));
        silent.without(self.heard).len()
    }

    /// In which protocols silent addresses were asked.
    pub fn silent_protocols(&self) -> Vec<Protocol> {
        self.silent.iter().filter(|(_, addresses)| addresses.len() > 0).map(|(protocol, _)| *protocol).collect()
    }

    /// At which speeds and formats silent addresses were asked.
    pub fn silent_settings(&self) -> impl ExactSizeIterator<Item = &LineSettings> {
        self.silent_settings.iter()
    }

    /// Silent addresses that were asked again at once, with how often they were.
    pub fn insisted(&self) -> impl Iterator<Item = (&Target, u64)> {
        self.insisted.iter().map(|(target, times)| (target, *times))
    }
}
