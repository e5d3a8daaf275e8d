//! The diagnosis as it is told: as an object for programs and as text for people.

mod text;

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::Serialize;

use super::findings::{self, Finding, Severity};
use super::histogram::{Bar, Histogram, Times};
use super::outcome::FailureKind;
use super::rates::{Rates, Slot};
use super::station::Station;
use super::timeout::{SuggestedTimeout, suggest};
use super::{Consistency, Diagnosis};
use crate::bus::Target;
pub use text::{adapter_in_words, noise_in_words};

/// Bars of a histogram at most.
pub const MOST_BARS: usize = 16;

/// A place on the line and what is counted of it.
type Place<'a> = (&'a Target, &'a Station);

/// Everything that is known of a line and its modules at one moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    pub made_at: Timestamp,
    pub program: String,
    /// Why the line was not looked at as long as was wanted; `None` if it was.
    pub stopped_early: Option<String>,
    pub line: LineReport,
    /// Those that answered, and places from which bytes came that cannot be read.
    pub modules: Vec<ModuleReport>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LineReport {
    pub name: String,
    pub findings: Vec<Finding>,
    pub requests: u64,
    /// Exchanges with modules that have answered at least once, and how many of these failed.
    pub exchanges: u64,
    pub failed: u64,
    pub answer_time: Option<Times>,
    pub histogram: Vec<Bar>,
    pub echoes: u64,
    pub noisy_answers: u64,
    pub unasked_bytes: u64,
    pub losses: u64,
    /// Addresses that never answered; they count nowhere else.
    pub silent_addresses: u32,
    pub adapter: Option<Adapter>,
    /// The timeout and the repeats in use.
    pub timeout_ms: u64,
    pub repeats: u8,
    pub suggested_timeout: Option<SuggestedTimeout>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Adapter {
    pub port: String,
    /// `None` where the system does not tell.
    pub latency_timer_ms: Option<u32>,
    /// Empty where nothing needs to be changed.
    pub how_to_change: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModuleReport {
    #[serde(flatten)]
    pub target: Target,
    /// As people call it; empty if it is not known.
    pub name: String,
    pub findings: Vec<Finding>,
    pub exchanges: u64,
    pub answers: u64,
    pub refusals: u64,
    /// By kind; those that did not occur are left out.
    pub failures: BTreeMap<FailureKind, u64>,
    /// The part of all exchanges that failed, 0 to 1; `None` if it never answered.
    pub error_rate: Option<f64>,
    pub repeats: u64,
    pub echoes: u64,
    pub noisy_answers: u64,
    pub answer_time: Option<Times>,
    pub histogram: Vec<Bar>,
    /// The last hour, in slots of ten seconds.
    pub rates: Vec<Slot>,
    pub suggested_timeout: Option<SuggestedTimeout>,
    pub consistency: Option<Consistency>,
}

impl Diagnosis {
    /// What is known `at` this moment of the line called `line`; `name` tells what people call a module.
    pub fn report(&self, at: Timestamp, line: &str, name: impl Fn(&Target) -> Option<String>) -> Report {
        let program = crate::version::named();
        let (heard, mut unread) = self.places();
        // One is told as a module is; several are told together.
        let first = unread.first().map(|(target, _)| target.address);
        let several = unread.iter().any(|(target, _)| Some(target.address) != first);
        let single = if several { Vec::new() } else { std::mem::take(&mut unread) };
        let shown = heard.into_iter().chain(single);
        let module = |(target, station)| self.module_report(target, station, at, name(target).unwrap_or_default());
        let mut modules: Vec<ModuleReport> = shown.map(module).collect();
        modules.sort_by_key(|module| module.target);
        Report { made_at: at, program, stopped_early: None, line: self.line_report(line, at, &unread), modules }
    }

    /// Those that were heard or tested, and those from which only unreadable bytes came; without places whose address
    /// answers at another speed or in another protocol, where what cannot be read says nothing.
    fn places(&self) -> (Vec<Place<'_>>, Vec<Place<'_>>) {
        let answers = |target: &Target| {
            self.stations().any(|(other, station)| other.address == target.address && station.is_heard())
        };
        let shown = self.stations().filter(|(target, station)| station.is_heard() || !answers(target));
        shown.partition(|(target, station)| station.is_heard() || self.test(target).is_some())
    }

    fn line_report(&self, name: &str, at: Timestamp, unread: &[Place<'_>]) -> LineReport {
        let facts = self.line();
        let heard = || self.stations().map(|(_, station)| station).filter(|station| station.is_heard());
        let mut times = Histogram::default();
        heard().for_each(|station| times.merge(&station.times));
        let late = self.stations().filter(|(_, station)| station.is_heard());
        let late = late.map(|(target, station)| self.late_at(target, station)).sum();
        let tuning = self.tuning();
        LineReport {
            name: name.to_owned(),
            findings: findings::of_line(self, at, unread),
            requests: facts.requests,
            exchanges: heard().map(Station::asked).sum(),
            failed: heard().map(Station::all_failures).sum(),
            answer_time: times.times(),
            histogram: times.bars(MOST_BARS),
            echoes: facts.echoes,
            noisy_answers: facts.noisy,
            unasked_bytes: facts.unasked_bytes,
            losses: facts.losses.count,
            silent_addresses: facts.silent_addresses(),
            adapter: self.adapter().map(|timer| Adapter {
                port: timer.port.clone(),
                latency_timer_ms: timer.milliseconds,
                how_to_change: if timer.is_slow() { timer.how_to_change() } else { String::new() },
            }),
            timeout_ms: u64::try_from(tuning.timeout.as_millis()).unwrap_or(u64::MAX),
            repeats: tuning.repeats,
            suggested_timeout: suggest(&times, self.waiting(), late),
        }
    }

    fn module_report(&self, target: &Target, station: &Station, at: Timestamp, name: String) -> ModuleReport {
        let test = self.test(target);
        let findings = if station.is_heard() {
            findings::of_module(target, station, test, at)
        } else {
            findings::of_unread(target, station, test)
        };
        let counted = FailureKind::ALL.map(|kind| (kind, station.failures(kind)));
        ModuleReport {
            target: *target,
            name,
            findings,
            exchanges: station.asked(),
            answers: station.answers,
            refusals: station.refused(),
            failures: counted.into_iter().filter(|(_, count)| *count > 0).collect(),
            error_rate: station.is_heard().then(|| station.error_rate()),
            repeats: station.repeats,
            echoes: station.echoes,
            noisy_answers: station.noisy.count,
            answer_time: station.times.times(),
            histogram: station.times.bars(MOST_BARS),
            rates: Rates::slots(&station.rates).collect(),
            suggested_timeout: suggest(&station.times, self.waiting(), self.late_at(target, station)),
            consistency: test.cloned(),
        }
    }

    /// Answers of a module that came too late.
    fn late_at(&self, target: &Target, station: &Station) -> u64 {
        station.late_with(self.test(target))
    }
}

impl Report {
    /// All findings, those of the line first.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.line.findings.iter().chain(self.modules.iter().flat_map(|module| &module.findings))
    }

    /// The worst that was found.
    pub fn worst(&self) -> Option<Severity> {
        self.findings().map(|finding| finding.severity).max()
    }

    /// Whether something should be seen to; notes are not.
    pub fn is_wrong(&self) -> bool {
        self.worst().is_some_and(|worst| worst > Severity::Note)
    }
}

impl ModuleReport {
    /// What people call it, or its address.
    pub fn title(&self) -> String {
        match self.name.as_str() {
            "" => format!("Address {}", self.target.address),
            name => format!("{name} @{}", self.target.address),
        }
    }

    pub fn worst(&self) -> Option<Severity> {
        self.findings.iter().map(|finding| finding.severity).max()
    }
}
