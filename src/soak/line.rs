//! The simulated line: sixteen modules whose values are unmistakable.

use std::time::{Duration, Instant};

use super::ear::Ear;
use super::truth::Truth;
use crate::bus::{LineAddress, Target};
use crate::protocol::{LineSettings, Protocol};
use crate::sim::{ModuleSpec, Pace, Sim};

/// Both models and their older sister, in every language. Most at the same speed, because every change of speed costs 20 ms
/// and all of them are to be polled once a second.
const MODULES: [&str; 16] = [
    "pir-234@1:modbus_rtu:115200",
    "pir-234@2:modbus_rtu:115200",
    "pir-234@3:modbus_rtu:115200",
    "pir-130@4:modbus_rtu:115200",
    "pir-130@5:modbus_rtu:115200",
    "pir-230@6:modbus_rtu:115200",
    "pir-234@7:dcon:115200:checksum",
    "pir-130@8:dcon:115200:checksum",
    "pir-230@9:dcon:115200:checksum",
    "pir-234@10:dcon:115200:checksum",
    "pir-130@0xA0:dcon:115200",
    "pir-234@0xA1:dcon:115200",
    "pir-130@0xA2:dcon:115200",
    "pir-230@0xA3:modbus_rtu:115200",
    "pir-234@0xB0:modbus_rtu:38400",
    "pir-130@0xB1:modbus_rtu:9600",
];
/// What a simulated module can be asked for that the program polls or draws.
const KNOWN: [&str; 20] = [
    "temperature_c",
    "temperature_f",
    "humidity",
    "dew_point_c",
    "dew_point_f",
    "pir",
    "pir1",
    "pir2",
    "pir3",
    "pir4",
    "do0",
    "do1",
    "relay",
    "buzzer",
    "alarm_active",
    "alarm_mode",
    "alarm_limit",
    "wdt_tripped",
    "wdt_enabled",
    "reset_cause",
];
/// Modules answer soon, so that all of them are polled once a second.
const TURNAROUND: Duration = Duration::from_millis(2);
/// Whatever follows motion and temperature with a delay has come to rest.
const REST: Duration = Duration::from_secs(3_600);
/// Different airs that a module can have; with 16 modules they fill 5 to 95 degrees and per cent in steps of 0.01.
const AIRS: u64 = 560;
/// Has no common divisor with [`AIRS`], so that airs that follow each other differ in many digits.
const STRIDE: u64 = 191;
/// Temperature and humidity of a module are never alike.
const APART: u64 = 280;

/// The line and what is known of it from outside the program.
pub struct Line {
    pub sim: Sim,
    pub targets: Vec<Target>,
    pub ear: Ear,
    air: u64,
}

impl Line {
    /// All modules frozen to their first values, and at rest.
    pub fn new(truth: &mut Truth, seed: u64) -> Self {
        let specs: Vec<ModuleSpec> = MODULES.iter().filter_map(|text| text.parse().ok()).collect();
        let sim = Sim::new(&specs, Pace::Real).with_turnaround(TURNAROUND).with_seed(seed);
        let targets: Vec<Target> = specs.iter().map(target).collect();
        let ear = Ear::default();
        sim.join(Box::new(ear.guest(main_settings(&targets))));
        for (slot, target) in targets.iter().enumerate() {
            // Every other module sees somebody, at another sensor each time.
            sim.set_motion(target.address, 0, false);
            if slot % 2 == 1 {
                sim.set_motion(target.address, slot % 4, true);
            }
        }
        let line = Self { sim, targets, ear, air: 0 };
        line.freeze();
        line.sim.advance(REST);
        line.tell(truth, Instant::now());
        line
    }

    pub fn address(&self) -> LineAddress {
        LineAddress::Simulated { label: "Simulated line".to_owned(), sim: self.sim.clone() }
    }

    /// The speed and format of most.
    pub fn settings(&self) -> LineSettings {
        main_settings(&self.targets)
    }

    /// Gives every module another temperature and humidity, which none of the others has.
    pub fn change(&mut self, truth: &mut Truth) {
        self.air = self.air.wrapping_add(1);
        let before = Instant::now();
        self.freeze();
        self.tell(truth, before);
    }

    fn freeze(&self) {
        for (slot, target) in (0..).zip(&self.targets) {
            self.sim.set_temperature(target.address, air(slot, self.air));
            self.sim.set_humidity(target.address, air(slot, self.air.wrapping_add(APART)));
        }
    }

    /// What the modules themselves say that they have since `since`.
    fn tell(&self, truth: &mut Truth, since: Instant) {
        for target in &self.targets {
            for name in KNOWN {
                if let Some(value) = self.sim.setting(target.address, name) {
                    truth.note(target.address, name, &value, since);
                }
            }
        }
    }
}

/// Whether a wrong byte in an answer shows.
pub fn is_checked(target: &Target) -> bool {
    target.checksum || target.protocol.is_modbus()
}

fn main_settings(targets: &[Target]) -> LineSettings {
    targets.first().map(|target| target.settings).unwrap_or_default()
}

fn target(spec: &ModuleSpec) -> Target {
    let ModuleSpec { address, protocol, settings, checksum, .. } = *spec;
    Target { address, protocol, settings, checksum: checksum && protocol == Protocol::Dcon }
}

/// Degrees or per cent, from 5 to 95.
fn air(slot: u64, number: u64) -> f64 {
    let place = (number % AIRS * STRIDE) % AIRS;
    (500 + place * 16 + slot) as f64 / 100.0
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn no_module_ever_has_the_air_of_another() {
        let mut all = BTreeSet::new();
        for slot in 0..16 {
            for number in 0..AIRS {
                let value = air(slot, number);
                assert!((5.0..=95.0).contains(&value));
                assert!(all.insert((value * 100.0).round() as i64), "{slot} {number}");
            }
        }
    }

    #[test]
    fn the_modules_say_themselves_what_they_have() {
        let mut truth = Truth::default();
        let line = Line::new(&mut truth, 1);
        assert_eq!(line.targets.len(), 16);
        assert_eq!(line.targets.iter().map(|target| target.address).collect::<BTreeSet<_>>().len(), 16);
        assert_eq!(truth.now(1, "temperature_c").as_deref(), Some("5"));
        assert_eq!(truth.now(2, "pir1").as_deref(), Some("true"));
        assert_eq!(truth.now(1, "pir1").as_deref(), Some("false"));
    }

    #[test]
    fn after_a_change_every_module_has_another_temperature() {
        let mut truth = Truth::default();
        let mut line = Line::new(&mut truth, 1);
        let before = truth.now(1, "temperature_c");
        line.change(&mut truth);
        assert_ne!(truth.now(1, "temperature_c"), before);
    }
}
