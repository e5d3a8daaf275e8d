//! What a line does to bytes at this moment.

use std::time::Duration;

use crate::protocol::LineSettings;

use super::super::world::Answer;
use super::collision::collide;
use super::damage::Damage;
use super::sound::Code;
use super::{FaultKind, Faults, Injected, Strength};

/// How often damage is drawn anew that leaves a right checksum or CRC.
const MOST_DRAWS: u32 = 32;
/// Two modules at one address are out of step by up to so many microseconds.
const JITTER_US: i64 = 2_000;
const DEFAULT_SEED: u64 = 1;

/// The faults of the line, what they did so far, and what chance has in store.
#[derive(Debug, Clone)]
pub(in crate::sim) struct Present {
    pub faults: Faults,
    pub injected: Injected,
    /// The adapter hears itself: every sent byte comes back first.
    pub echo: bool,
    /// The adapter is gone.
    pub unplugged: bool,
    /// Stray bytes before and after each answer, as on a line without bias or termination.
    pub noise_before: Vec<u8>,
    pub noise_after: Vec<u8>,
    random: fastrand::Rng,
}

/// What was sent, and on what line.
#[derive(Debug, Clone, Copy)]
pub(in crate::sim) struct Asked<'a> {
    pub request: &'a [u8],
    pub code: Code,
    pub settings: LineSettings,
}

impl Default for Present {
    fn default() -> Self {
        Self {
            faults: Faults::default(),
            injected: Injected::new(),
            echo: false,
            unplugged: false,
            noise_before: Vec::new(),
            noise_after: Vec::new(),
            random: fastrand::Rng::with_seed(DEFAULT_SEED),
        }
    }
}

impl Present {
    pub fn seed(&mut self, seed: u64) {
        self.random = fastrand::Rng::with_seed(seed);
    }

    pub fn set(&mut self, faults: Faults) {
        let jump = |faults: &Faults| faults.get(FaultKind::ClockJump);
        if jump(&faults) != jump(&self.faults) {
            self.strike(FaultKind::ClockJump);
        }
        self.faults = faults;
    }

    pub fn is_unplugged(&self) -> bool {
        self.unplugged || self.faults.is_on(FaultKind::Unplugged)
    }

    /// What the adapter is called, if it is there.
    pub fn adapter_name(&self) -> &'static str {
        if self.faults.is_on(FaultKind::Renamed) { "SIM2" } else { "SIM1" }
    }

    /// The fault that makes a line through the adapter `name` fail, and why it does.
    pub fn cuts_off(&self, name: &str) -> Option<(FaultKind, &'static str)> {
        if self.is_unplugged() {
            Some((FaultKind::Unplugged, "the simulated adapter is unplugged"))
        } else if name != self.adapter_name() {
            Some((FaultKind::Renamed, "the simulated adapter has another name now"))
        } else {
            None
        }
    }

    /// By how many seconds the system's clock is wrong.
    pub fn clock_jump(&self) -> i64 {
        match self.faults.get(FaultKind::ClockJump) {
            Some(Strength::Seconds(seconds)) => seconds,
            _ => 0,
        }
    }

    pub fn strike(&mut self, kind: FaultKind) {
        let count = self.injected.entry(kind).or_default();
        *count = count.saturating_add(1);
    }

    /// What comes back of `request` before any answer.
    pub fn echo_of(&mut self, request: &[u8]) -> Vec<u8> {
        if self.echo || self.faults.is_on(FaultKind::Echo) {
            self.strike(FaultKind::Echo);
            return request.to_vec();
        }
        if !self.faults.is_on(FaultKind::PartialEcho) || request.len() < 2 {
            return Vec::new();
        }
        self.strike(FaultKind::PartialEcho);
        let length = self.random.usize(1..request.len());
        request.get(..length).unwrap_or_default().to_vec()
    }

    /// The nonsense that answers what is sent at this speed, if it is one that no module here has.
    pub fn garbage(&mut self, asked: Asked<'_>, bps: u32, echo: &[u8]) -> Option<Vec<u8>> {
        match self.faults.get(FaultKind::WrongSpeed) {
            Some(Strength::Speed(speed)) if speed.bps() == bps => (),
            _ => return None,
        }
        self.strike(FaultKind::WrongSpeed);
        let sent = [asked.request.to_vec()];
        let drawn = (0..MOST_DRAWS).map(|_| Damage::new(&self.faults, &mut self.random).garbage());
        let harmless = |bytes: &Vec<u8>| !asked.code.misleads(&[echo, bytes].concat(), &sent);
        let garbage: Vec<Vec<u8>> = drawn.filter(harmless).take(1).collect();
        Some(garbage.into_iter().next().unwrap_or_default())
    }

    /// What the modules hear. It is no other right request.
    pub fn heard(&mut self, asked: Asked<'_>) -> Vec<u8> {
        let sent = [asked.request.to_vec()];
        for _ in 0..MOST_DRAWS {
            let mut damage = Damage::new(&self.faults, &mut self.random);
            let heard = damage.bytes(asked.request);
            if !asked.code.misleads(&heard, &sent) && !is_another(&heard, asked) {
                let struck = damage.struck;
                self.count(struck);
                return heard;
            }
        }
        asked.request.to_vec()
    }

    /// The address at which there are two modules.
    pub fn twin(&self) -> Option<u8> {
        match self.faults.get(FaultKind::Twin) {
            Some(Strength::Address(address)) => Some(address),
            _ => None,
        }
    }

    /// When the second module answers if the first does after `delay`.
    pub fn jittered(&mut self, delay: Duration) -> Duration {
        let jitter = self.random.i64(-JITTER_US..=JITTER_US);
        let by = Duration::from_micros(jitter.unsigned_abs());
        if jitter < 0 { delay.saturating_sub(by) } else { delay.saturating_add(by) }
    }

    /// What the reader gets of the answers to one request, after the `echo`; `twins` if a second module is among those
    /// who answer.
    pub fn on_the_wire(&mut self, answers: Vec<Answer>, asked: Asked<'_>, echo: &[u8], twins: bool) -> Vec<Answer> {
        let mut sent: Vec<Vec<u8>> = answers.iter().map(|answer| answer.bytes.clone()).collect();
        sent.push(asked.request.to_vec());
        let heard = collide(answers, asked.settings, asked.code, twins, &mut self.random);
        let answers = self.damaged(&heard, asked, echo, &sent).unwrap_or(heard);
        answers.into_iter().map(|answer| self.with_noise(answer)).collect()
    }

    /// `None` if luck leaves right frames again and again that no module sent.
    fn damaged(&mut self, answers: &[Answer], asked: Asked<'_>, echo: &[u8], sent: &[Vec<u8>]) -> Option<Vec<Answer>> {
        for _ in 0..MOST_DRAWS {
            let mut damage = Damage::new(&self.faults, &mut self.random);
            let draw = |answer| damage.answer(answer, asked.request, asked.code, asked.settings);
            let mut drawn: Vec<Answer> = answers.iter().flat_map(draw).collect();
            drawn.sort_by_key(|answer| answer.delay);
            let (struck, made) = (damage.struck, damage.made);
            let parts = std::iter::once(echo).chain(drawn.iter().map(|answer| answer.bytes.as_slice()));
            let stream = parts.collect::<Vec<_>>().concat();
            if !asked.code.misleads(&stream, &[sent, made.as_slice()].concat()) {
                self.count(struck);
                return Some(drawn);
            }
        }
        None
    }

    fn count(&mut self, struck: Injected) {
        for (kind, times) in struck {
            let count = self.injected.entry(kind).or_default();
            *count = count.saturating_add(times);
        }
    }

    fn with_noise(&self, answer: Answer) -> Answer {
        let bytes = [self.noise_before.as_slice(), &answer.bytes, &self.noise_after].concat();
        Answer { bytes, ..answer }
    }
}

/// Whether damage to a request that is checked made one that is checked by something else, or has another address.
fn is_another(heard: &[u8], asked: Asked<'_>) -> bool {
    heard != asked.request && asked.code != Code::Open && Code::of(heard) != Code::Open
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_surrounds_an_answer() {
        let mut faults = Present { noise_before: vec![0], noise_after: vec![0xFF, 0xFF], ..Present::default() };
        let asked = Asked { request: b"$01M\r", code: Code::Open, settings: LineSettings::default() };
        let answer = |bytes: &[u8]| vec![Answer { delay: Duration::from_millis(5), bytes: bytes.to_vec() }];
        assert_eq!(faults.on_the_wire(answer(b"!"), asked, &[], false), answer(&[0, b'!', 0xFF, 0xFF]));
    }

    #[test]
    fn the_same_seed_draws_the_same_damage() {
        let mut faults = Faults::default();
        [FaultKind::Flipped, FaultKind::Lost, FaultKind::Inserted].into_iter().for_each(|kind| {
            faults.set(super::super::Fault { kind, strength: Strength::Rate(0.3) }).unwrap();
        });
        let asked = Asked { request: b"$01M\r", code: Code::Open, settings: LineSettings::default() };
        let heard = |seed| {
            let mut present = Present { faults: faults.clone(), ..Present::default() };
            present.seed(seed);
            (0..20).map(|_| present.heard(asked)).collect::<Vec<_>>()
        };
        assert_eq!(heard(7), heard(7));
        assert_ne!(heard(7), heard(8));
    }
}
