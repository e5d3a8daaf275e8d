//! Searching a line for modules: which questions, in which order, and how long it will take.

use std::time::Duration;

use super::dialogue::Dialogue;
use super::target::{Patience, Target};
use super::transaction::SETTLE as SETTLE_AFTER_CHANGE;
use crate::module::{Catalogue, Identified, identify};
use crate::protocol::{BaudRate, DataFormat, Failure, LineSettings, Protocol};

/// How long a scan listens at an address unless told otherwise: a response delay of 30 ms, a USB adapter's 16 ms.
pub const DEFAULT_WINDOW: Duration = Duration::from_millis(60);
const LONGEST_WINDOW: Duration = Duration::from_secs(60);
/// Addresses of Modbus slaves.
const MODBUS_ADDRESSES: std::ops::RangeInclusive<u8> = 1..=247;
/// Characters of the questions that open an address: `$AAM` with CR, and a read of registers with CRC.
const DCON_CHARACTERS: usize = 5;
const RTU_CHARACTERS: usize = 8;

/// Where a module is looked for: every combination of these.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScanPlan {
    pub addresses: Vec<u8>,
    pub baud_rates: Vec<BaudRate>,
    pub data_formats: Vec<DataFormat>,
    pub protocols: Vec<Protocol>,
    /// DCON only.
    pub checksums: Vec<bool>,
    /// From the end of a question to the first byte of an answer.
    pub window: Duration,
    pub stop_at_first: bool,
}

impl ScanPlan {
    /// Address 1 (factory setting) and those that the DIP and rotary switches give, 160 to 191.
    pub fn likely_addresses() -> Vec<u8> {
        std::iter::once(1).chain(160..=191).collect()
    }

    /// The likely addresses, in both protocols, at the factory speed and format.
    pub fn quick() -> Self {
        Self {
            addresses: Self::likely_addresses(),
            baud_rates: vec![BaudRate::B9600],
            data_formats: vec![DataFormat::N81],
            protocols: Protocol::SERIAL.to_vec(),
            checksums: vec![false],
            window: DEFAULT_WINDOW,
            stop_at_first: false,
        }
    }

    /// Every address at every speed, format, protocol and checksum.
    pub fn full() -> Self {
        Self {
            addresses: (0..=255).collect(),
            baud_rates: BaudRate::ALL.to_vec(),
            data_formats: DataFormat::ALL.to_vec(),
            checksums: vec![false, true],
            ..Self::quick()
        }
    }

    /// Modbus TCP reaches one module or gateway; its NetID is 1 unless changed (PIR-234 manual 3.5.1).
    pub fn tcp() -> Self {
        Self { addresses: vec![1], protocols: vec![Protocol::ModbusTcp], ..Self::quick() }
    }

    /// All places, the likeliest first: likely addresses before others, and for each the factory settings first.
    pub fn targets(&self) -> Vec<Target> {
        let likely = Self::likely_addresses();
        let (first, rest): (Vec<u8>, Vec<u8>) = self.addresses.iter().partition(|address| likely.contains(address));
        let settings = self.settings();
        let mut targets = Vec::new();
        for addresses in [first, rest] {
            for &settings in &settings {
                for (protocol, checksum) in self.languages() {
                    let allowed = |address: &&u8| protocol == Protocol::Dcon || MODBUS_ADDRESSES.contains(address);
                    let target = |&address| Target { address, protocol, settings, checksum };
                    targets.extend(addresses.iter().filter(allowed).map(target));
                }
            }
        }
        targets
    }

    /// Speeds and formats, the factory's first.
    fn settings(&self) -> Vec<LineSettings> {
        let mut all: Vec<LineSettings> = Vec::new();
        for &data_format in &self.data_formats {
            all.extend(self.baud_rates.iter().map(|&baud_rate| LineSettings { baud_rate, data_format }));
        }
        all.sort_by_key(|settings| *settings != LineSettings::default());
        all
    }

    /// Protocols with and without checksum, the likelier first.
    fn languages(&self) -> Vec<(Protocol, bool)> {
        let mut all = Vec::new();
        for &protocol in &self.protocols {
            if protocol == Protocol::Dcon {
                all.extend(self.checksums.iter().map(|&checksum| (protocol, checksum)));
            } else {
                all.push((protocol, false));
            }
        }
        all.sort_by_key(|(protocol, checksum)| (*protocol, *checksum));
        all
    }

    /// What a silent `target` costs: its question on the wire and one listening window; over TCP a network's delay.
    pub fn cost(&self, target: &Target) -> Duration {
        let characters = match target.protocol {
            Protocol::Dcon if target.checksum => DCON_CHARACTERS + 2,
            Protocol::Dcon => DCON_CHARACTERS,
            Protocol::ModbusRtu | Protocol::ModbusTcp => RTU_CHARACTERS,
        };
        match target.protocol {
            Protocol::ModbusTcp => self.window + super::tcp::NETWORK_ALLOWANCE,
            _ => self.window + target.settings.wire_time(characters),
        }
    }

    /// How long the scan takes if nothing answers.
    pub fn duration(&self) -> Duration {
        let targets = self.targets();
        let changes = targets.windows(2).filter(|pair| matches!(pair, [a, b] if a.settings != b.settings)).count();
        let changes = u32::try_from(changes).unwrap_or(u32::MAX);
        let questions: Duration = targets.iter().map(|target| self.cost(target)).sum();
        questions.saturating_add(SETTLE_AFTER_CHANGE.saturating_mul(changes))
    }
}

/// How far a scan is.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanProgress {
    /// Addresses asked, of how many.
    pub done: usize,
    pub total: usize,
    /// Where it is now.
    pub at: Target,
    /// If nothing answers any more.
    pub left: Duration,
    pub paused: bool,
}

/// How a scan ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ScanSummary {
    pub done: usize,
    pub total: usize,
    pub found: usize,
    /// Places where something came back that is no answer: noise, a wrong speed, or two modules at one address.
    pub unreadable: Vec<(Target, String)>,
    pub cancelled: bool,
    /// The line was lost, which ended the scan.
    pub lost: Option<String>,
}

/// How often a module is asked again who it is if it has answered, but not told.
const ASK_WHO_AGAIN: usize = 2;
/// More than so many unreadable places are counted only.
const MOST_UNREADABLE: usize = 64;

/// A scan under way.
pub struct Scan {
    plan: ScanPlan,
    targets: Vec<Target>,
    next: usize,
    left: Duration,
    summary: ScanSummary,
    found: Vec<Target>,
    pub paused: bool,
}

/// What one step of a scan brought.
pub enum ScanStep {
    Nothing,
    Found(Target, Box<Identified>),
    Ended,
}

impl Scan {
    pub fn new(plan: ScanPlan) -> Self {
        let plan = ScanPlan { window: plan.window.min(LONGEST_WINDOW), ..plan };
        let targets = plan.targets();
        let left = plan.duration();
        let summary = ScanSummary { total: targets.len(), ..ScanSummary::default() };
        Self { plan, targets, next: 0, left, summary, found: Vec::new(), paused: false }
    }

    /// `None` when it has ended.
    pub fn progress(&self) -> Option<ScanProgress> {
        let at = *self.targets.get(self.next)?;
        Some(ScanProgress { done: self.next, total: self.targets.len(), at, left: self.left, paused: self.paused })
    }

    /// Asks at the next address.
    pub fn step(&mut self, catalogue: &Catalogue, dialogue: &mut Dialogue) -> ScanStep {
        let Some(&target) = self.targets.get(self.next) else { return ScanStep::Ended };
        if self.is_known(&target) {
            return self.go_on(&target);
        }
        let mut speaker = dialogue.with(target, Patience::scan(self.plan.window)).uncounted();
        let mut outcome = identify(catalogue, target.protocol, target.address, &mut speaker);
        // Who has answered once is asked again who it is, on a line that loses or delays answers.
        for _ in 0..ASK_WHO_AGAIN {
            if outcome.is_ok() || !speaker.is_there() {
                break;
            }
            outcome = identify(catalogue, target.protocol, target.address, &mut speaker);
        }
        // Nothing else is made of these answers, so nothing has to be made certain of them later.
        dialogue.forget_doubts(&target);
        match outcome {
            Ok(identified) => {
                self.summary.found = self.summary.found.saturating_add(1);
                self.found.push(target);
                self.go_on(&target);
                if self.plan.stop_at_first {
                    self.targets.truncate(self.next);
                }
                return ScanStep::Found(target, Box::new(identified));
            }
            Err(Failure::LineLost(reason)) => return self.lose(reason),
            Err(failure) if failure.is_garbage() && self.summary.unreadable.len() < MOST_UNREADABLE => {
                self.summary.unreadable.push((target, failure.to_string()));
            }
            Err(_) => {}
        }
        self.go_on(&target)
    }

    /// The second stop bit of N82 is a pause to a receiver of N81, so a module found with the one answers to the other.
    fn is_known(&self, target: &Target) -> bool {
        let answers = |found: &Target| {
            found.settings.is_read_at(target.settings) && Target { settings: target.settings, ..*found } == *target
        };
        self.found.iter().any(answers)
    }

    fn go_on(&mut self, target: &Target) -> ScanStep {
        self.next = self.next.saturating_add(1);
        self.left = self.left.saturating_sub(self.plan.cost(target));
        if self.next < self.targets.len() { ScanStep::Nothing } else { ScanStep::Ended }
    }

    /// The line has gone: the scan ends here.
    pub fn lose(&mut self, reason: String) -> ScanStep {
        self.summary.lost = Some(reason);
        self.targets.truncate(self.next);
        ScanStep::Ended
    }

    pub fn end(mut self, cancelled: bool) -> ScanSummary {
        self.summary.done = self.next;
        self.summary.cancelled = cancelled;
        self.summary
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_scan_asks_33_addresses_in_both_protocols_modbus_first() {
        let targets = ScanPlan::quick().targets();
        assert_eq!(targets.len(), 66);
        assert_eq!((targets[0].address, targets[0].protocol), (1, Protocol::ModbusRtu));
        assert_eq!((targets[33].address, targets[33].protocol), (1, Protocol::Dcon));
    }

    #[test]
    fn the_full_scan_covers_every_combination_once_and_starts_with_the_likely_ones() {
        let plan = ScanPlan::full();
        let targets = plan.targets();
        assert_eq!(targets.len(), 8 * 4 * (247 + 2 * 256));
        let unique: std::collections::HashSet<_> = targets.iter().collect();
        assert_eq!(unique.len(), targets.len());
        assert_eq!(targets[..33], ScanPlan::quick().targets()[..33]);
        assert!(targets.iter().all(|t| t.protocol == Protocol::Dcon || (1..=247).contains(&t.address)));
    }

    #[test]
    fn a_module_found_without_parity_is_not_looked_for_with_a_second_stop_bit() {
        let mut scan = Scan::new(ScanPlan::full());
        let found = ScanPlan::quick().targets()[0];
        scan.found.push(found);
        let at = |data_format| Target { settings: LineSettings { data_format, ..found.settings }, ..found };
        assert!(scan.is_known(&at(DataFormat::N82)));
        assert!(!scan.is_known(&at(DataFormat::E81)));
        assert!(!scan.is_known(&Target { address: 2, ..at(DataFormat::N82) }));
    }

    #[test]
    fn a_silent_address_costs_its_question_and_one_window() {
        let plan = ScanPlan::quick();
        let target = plan.targets()[33];
        assert_eq!(plan.cost(&target), Duration::from_millis(60) + LineSettings::default().wire_time(5));
    }
}
