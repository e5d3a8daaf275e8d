//! What goes wrong between the modules and the reader.
//!
//! `present` is the line at this moment: it lets chance (`damage`) and modules that speak at once (`collision`) spoil
//! bytes, and draws again where `sound` finds a right frame that no module sent.

mod collision;
mod damage;
mod kind;
mod present;
mod sound;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::time::Duration;

pub use kind::{Fault, FaultError, FaultKind, Strength};
pub(super) use present::{Asked, Present};
pub(super) use sound::Code;

/// The faults of a simulated line; none at first.
#[derive(Debug, Clone, PartialEq)]
pub struct Faults {
    strengths: BTreeMap<FaultKind, Strength>,
    /// By how much late answers are late, each by another time in this range.
    pub late_by: RangeInclusive<Duration>,
}

/// How often each fault has struck since the line began.
pub type Injected = BTreeMap<FaultKind, u64>;

impl Default for Faults {
    fn default() -> Self {
        let late_by = Duration::from_millis(250)..=Duration::from_millis(1_500);
        Self { strengths: BTreeMap::new(), late_by }
    }
}

impl Faults {
    /// How strong a fault is; `None` if it is off.
    pub fn get(&self, kind: FaultKind) -> Option<Strength> {
        self.strengths.get(&kind).copied()
    }

    pub fn is_on(&self, kind: FaultKind) -> bool {
        self.strengths.contains_key(&kind)
    }

    /// # Errors
    /// If the fault cannot be so strong.
    pub fn set(&mut self, fault: Fault) -> Result<(), FaultError> {
        self.strengths.insert(fault.kind, fault.kind.admits(fault.strength)?);
        Ok(())
    }

    /// Switches it on as strong as it is by default.
    pub fn switch_on(&mut self, kind: FaultKind) {
        self.strengths.insert(kind, kind.default_strength());
    }

    pub fn switch_off(&mut self, kind: FaultKind) {
        self.strengths.remove(&kind);
    }

    /// For how long after they were switched off the last of what they have caused may still come.
    pub fn outlast(&self) -> Duration {
        if self.is_on(FaultKind::Late) { *self.late_by.end() } else { Duration::ZERO }
    }

    /// Those that are on.
    pub fn iter(&self) -> impl Iterator<Item = Fault> {
        self.strengths.iter().map(|(&kind, &strength)| Fault { kind, strength })
    }
}

/// Of several of one kind the last one counts; what a fault cannot be is left out.
impl FromIterator<Fault> for Faults {
    fn from_iter<I: IntoIterator<Item = Fault>>(faults: I) -> Self {
        let mut all = Self::default();
        for fault in faults {
            // What was read from text can always be.
            let _ = all.set(fault);
        }
        all
    }
}
