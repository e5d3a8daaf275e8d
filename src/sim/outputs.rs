//! The relays and the buzzer, and what switches them.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::motion::Sensors;
use super::refusal::Refusal;

/// Seconds of the PIR output ON time by code (PIR-234 manual 5.14, PIR-130 manual 2.14).
pub(super) const ON_TIMES_S: [u16; 16] = [2, 4, 6, 8, 16, 33, 49, 66, 131, 262, 393, 524, 1049, 2097, 3146, 4194];
/// Milliseconds (PIR-234 manual 5.10, PIR-130 manual 2.10).
pub(super) const ACTIVE_DELAYS: RangeInclusive<u16> = 0..=3000;
/// Seconds (PIR-234 manual 5.1, `$AALCDHH`).
pub(super) const OFF_TIMES: RangeInclusive<u16> = 0..=30;

/// From a sensor that sees someone to the PIR output.
#[derive(Debug, Clone)]
pub(super) struct Trigger {
    on_time_code: u16,
    active_delay_ms: u16,
    off_time_s: u16,
    /// Bit 0 for sensor 1.
    enabled: u16,
    sensors: Sensors,
    last_seen: Option<Duration>,
}

impl Trigger {
    pub fn new(off_time_s: u16) -> Self {
        Self {
            on_time_code: 2,
            active_delay_ms: 0,
            off_time_s,
            enabled: 0x0F,
            sensors: Sensors::default(),
            last_seen: None,
        }
    }

    pub fn power_on(&mut self) {
        self.sensors = Sensors::default();
        self.last_seen = None;
    }

    /// `uptime` since power-on. The manuals leave the two start-up times open; here the sensors are blind for the off
    /// time, and the output follows them only after the active delay.
    pub fn live(&mut self, seen: Sensors, now: Duration, uptime: Duration) {
        let awake = uptime >= Duration::from_secs(u64::from(self.off_time_s));
        for (index, (sensor, seen)) in self.sensors.iter_mut().zip(seen).enumerate() {
            *sensor = awake && seen && self.enabled >> index & 1 == 1;
        }
        if self.any() && uptime >= Duration::from_millis(u64::from(self.active_delay_ms)) {
            self.last_seen = Some(now);
        }
    }

    /// What an enabled sensor, 0 to 3, sees now.
    pub fn sensor(&self, index: usize) -> bool {
        self.sensors.get(index).copied().unwrap_or_default()
    }

    /// Whether any enabled sensor sees someone now.
    pub fn any(&self) -> bool {
        self.sensors.contains(&true)
    }

    /// The PIR output: on while someone is seen and for the ON time after.
    pub fn output(&self, now: Duration) -> bool {
        let on_time = Duration::from_secs(u64::from(self.on_time_s()));
        self.last_seen.is_some_and(|seen| now < seen.saturating_add(on_time))
    }

    pub fn on_time_s(&self) -> u16 {
        ON_TIMES_S.get(usize::from(self.on_time_code)).copied().unwrap_or_default()
    }

    pub fn on_time_code(&self) -> u16 {
        self.on_time_code
    }

    pub fn set_on_time_code(&mut self, code: u16) -> Result<(), Refusal> {
        self.on_time_code = Refusal::unless_within(code, 0..=0x0F)?;
        Ok(())
    }

    pub fn active_delay_ms(&self) -> u16 {
        self.active_delay_ms
    }

    pub fn set_active_delay(&mut self, milliseconds: u16) -> Result<(), Refusal> {
        self.active_delay_ms = Refusal::unless_within(milliseconds, ACTIVE_DELAYS)?;
        Ok(())
    }

    pub fn off_time_s(&self) -> u16 {
        self.off_time_s
    }

    pub fn set_off_time(&mut self, seconds: u16) -> Result<(), Refusal> {
        self.off_time_s = Refusal::unless_within(seconds, OFF_TIMES)?;
        Ok(())
    }

    pub fn enabled(&self) -> u16 {
        self.enabled
    }

    pub fn set_enabled(&mut self, mask: u16) -> Result<(), Refusal> {
        self.enabled = Refusal::unless_within(mask, 0..=0x0F)?;
        Ok(())
    }
}

/// What switches an output (PIR-234 manual 5.1, `$AALC9C0NN`; registers 521 and 522).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    Command,
    Pir,
    Temperature,
}

impl Source {
    pub fn from_code(code: u16) -> Result<Self, Refusal> {
        match code {
            0 => Ok(Self::Command),
            1 => Ok(Self::Pir),
            2 => Ok(Self::Temperature),
            _ => Err(Refusal::Value),
        }
    }

    pub fn code(self) -> u16 {
        match self {
            Self::Command => 0,
            Self::Pir => 1,
            Self::Temperature => 2,
        }
    }
}

/// One relay. A PIR-130 has one that follows its sensor, a PIR-234 has two.
#[derive(Debug, Clone)]
pub(super) struct Output {
    source: Source,
    state: bool,
    pub power_on: bool,
    pub safe: bool,
}

impl Output {
    pub fn new() -> Self {
        Self { source: Source::Pir, state: false, power_on: false, safe: false }
    }

    pub fn source(&self) -> Source {
        self.source
    }

    /// An output that is handed over to commands keeps its state.
    pub fn set_source(&mut self, source: Source) {
        self.source = source;
    }

    pub fn state(&self) -> bool {
        self.state
    }

    /// By `@AADO0V` or a coil.
    pub fn command(&mut self, on: bool) {
        self.state = on;
    }

    pub fn live(&mut self, tripped: bool, pir: bool, alarm: bool) {
        self.state = match self.source {
            _ if tripped => self.safe,
            Source::Command => self.state,
            Source::Pir => pir,
            Source::Temperature => alarm,
        };
    }
}

/// Sounds while the PIR sees someone, if enabled; a command overrules that until the next visit.
#[derive(Debug, Clone, Default)]
pub(super) struct Buzzer {
    pub on_pir: bool,
    commanded: Option<bool>,
    triggered: bool,
}

impl Buzzer {
    pub fn live(&mut self, triggered: bool) {
        if triggered && !self.triggered && self.on_pir {
            self.commanded = None;
        }
        self.triggered = triggered;
    }

    pub fn sounds(&self) -> bool {
        self.commanded.unwrap_or(self.on_pir && self.triggered)
    }

    /// Coil 274 of the PIR-234.
    pub fn command(&mut self, on: bool) {
        self.commanded = Some(on);
    }

    pub fn power_on(&mut self) {
        self.commanded = None;
        self.triggered = false;
    }
}
