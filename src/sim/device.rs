//! One module: its state, and how that changes as time passes. What it answers is in `dcon` and `modbus`.

use std::time::Duration;

use crate::protocol::Protocol;

use super::alarm::{Alarm, Extremes};
use super::climate::{Channels, Climate, Hundredths};
use super::comms::Comms;
use super::ethernet::{Ethernet, ResetCause, Wifi};
use super::motion::Motion;
use super::outputs::{Buzzer, Output, Source, Trigger};
use super::refusal::Refusal;
use super::spec::{Model, ModuleSpec};
use super::watchdog::Watchdog;
use super::{dcon, modbus};

/// How finely the time between two requests is lived through.
const STEP: Duration = Duration::from_millis(250);
/// A long time is lived through in coarser steps, so that a day passes at once.
const MOST_STEPS: u32 = 4_000;
/// Offsets in 0.01 °C and 0.01 %: -100.00 to +100.00 (PIR-234 manual 5.34 and 5.38).
const WIDEST_OFFSET: Hundredths = 10_000;
/// The factory value on the settings page (PIR-234 manual 3.6.2); the PIR-130 has no such time.
const OFF_TIME_ON_START_S: u16 = 6;

/// Has all that any model has; the command tables of the models decide what can be reached.
#[derive(Debug, Clone)]
pub(super) struct Device {
    pub model: Model,
    pub comms: Comms,
    pub climate: Climate,
    pub motion: Motion,
    pub trigger: Trigger,
    pub outputs: [Output; 2],
    pub buzzer: Buzzer,
    pub alarm: Alarm,
    pub extremes: Extremes,
    pub watchdog: Watchdog,
    pub ethernet: Ethernet,
    pub wifi: Option<Wifi>,
    /// An output value of 1 means that the relay is off (PIR-234 manual 5.28, OAS).
    pub active_low: bool,
    /// 0 to 4, and 0 to 9: PIR-130 only.
    pub lux_level: u16,
    pub sensitivity: u16,
    /// Hears and says nothing, as if its wire were cut.
    pub dead: bool,
    temperature_offset: Hundredths,
    humidity_offset: Hundredths,
    channels: Channels,
    reset_unread: bool,
    powered_at: Duration,
    now: Duration,
}

impl Device {
    /// Switched on at time zero.
    pub fn new(spec: &ModuleSpec) -> Self {
        let seed = u64::from(spec.address);
        let off_time = if spec.model == Model::Pir130 { 0 } else { OFF_TIME_ON_START_S };
        let mut device = Self {
            model: spec.model,
            comms: Comms::new(spec),
            climate: Climate::new(seed),
            motion: Motion::new(seed),
            trigger: Trigger::new(off_time),
            outputs: [Output::new(), Output::new()],
            buzzer: Buzzer::default(),
            alarm: Alarm::new(),
            extremes: Extremes::default(),
            watchdog: Watchdog::default(),
            ethernet: Ethernet::new(spec.address),
            wifi: (spec.model == Model::Pir234Wf).then(Wifi::new),
            active_low: false,
            lux_level: 0,
            sensitivity: 0,
            dead: false,
            temperature_offset: 0,
            humidity_offset: 0,
            channels: Channels::default(),
            reset_unread: true,
            powered_at: Duration::ZERO,
            now: Duration::ZERO,
        };
        device.live(Duration::ZERO);
        device
    }

    /// Lives on until `now`; an earlier time only lets the present settings take effect.
    pub fn advance_to(&mut self, now: Duration) {
        let step = STEP.max(now.saturating_sub(self.now) / MOST_STEPS);
        while self.now.saturating_add(step) < now {
            self.live(self.now.saturating_add(step));
        }
        self.live(now.max(self.now));
    }

    fn live(&mut self, now: Duration) {
        self.now = now;
        self.channels = self.climate.channels(now, self.temperature_offset, self.humidity_offset);
        self.extremes.live(&self.channels);
        let [celsius, ..] = self.channels;
        self.alarm.live(celsius);
        self.trigger.live(self.motion.at(now), now, now.saturating_sub(self.powered_at));
        self.buzzer.live(self.trigger.any());
        self.watchdog.live(now);
        let (tripped, pir, alarm) = (self.watchdog.tripped(), self.trigger.output(now), self.alarm.active());
        for output in &mut self.outputs {
            output.live(tripped, pir, alarm);
        }
    }

    /// Off and on again: what is stored comes into force.
    pub fn power_cycle(&mut self, cause: ResetCause) {
        self.powered_at = self.now;
        self.reset_unread = true;
        self.comms.power_on();
        self.trigger.power_on();
        self.buzzer.power_on();
        self.alarm.clear();
        self.extremes = Extremes::default();
        self.ethernet.reset_cause = cause;
        self.watchdog.feed(self.now);
        for output in &mut self.outputs {
            output.command(output.power_on);
        }
        self.live(self.now);
    }

    /// A module of the same kind and settings that hangs elsewhere.
    pub fn twin(&self) -> Self {
        let mut twin = Self { climate: self.climate.elsewhere(), ..self.clone() };
        twin.live(self.now);
        twin
    }

    /// The answer to a frame heard on the wire, if there is one.
    pub fn hear(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let answer = match self.comms.in_force().protocol {
            Protocol::Dcon => dcon::hear(self, frame),
            Protocol::ModbusRtu | Protocol::ModbusTcp => modbus::hear(self, frame),
        };
        self.live(self.now);
        answer
    }

    /// The answer to a Modbus request that came over Ethernet.
    pub fn hear_tcp(&mut self, pdu: &[u8]) -> Vec<u8> {
        let answer = modbus::serve(self, pdu, modbus::Via::Tcp);
        self.live(self.now);
        answer
    }

    pub fn now(&self) -> Duration {
        self.now
    }

    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    pub fn temperature_offset(&self) -> Hundredths {
        self.temperature_offset
    }

    pub fn humidity_offset(&self) -> Hundredths {
        self.humidity_offset
    }

    pub fn set_temperature_offset(&mut self, offset: Hundredths) -> Result<(), Refusal> {
        self.temperature_offset = offset_within_range(offset)?;
        Ok(())
    }

    pub fn set_humidity_offset(&mut self, offset: Hundredths) -> Result<(), Refusal> {
        self.humidity_offset = offset_within_range(offset)?;
        Ok(())
    }

    pub fn set_lux_level(&mut self, code: u16) -> Result<(), Refusal> {
        self.lux_level = Refusal::unless_within(code, 0..=4)?;
        Ok(())
    }

    pub fn set_sensitivity(&mut self, value: u16) -> Result<(), Refusal> {
        self.sensitivity = Refusal::unless_within(value, 0..=9)?;
        Ok(())
    }

    /// `$AA5` and coil 273: true at the first read after power-on.
    pub fn take_reset_status(&mut self) -> bool {
        std::mem::take(&mut self.reset_unread)
    }

    pub fn reset_unread(&self) -> bool {
        self.reset_unread
    }

    /// Output values, bit 0 for DO0.
    pub fn output_bits(&self) -> u8 {
        let [first, second] = &self.outputs;
        u8::from(first.state()) | u8::from(second.state()) << 1
    }

    /// Sets one output by command.
    pub fn command_output(&mut self, index: usize, on: bool) -> Result<(), Refusal> {
        if self.watchdog.tripped() {
            return Err(Refusal::Tripped);
        }
        let output = self.outputs.get_mut(index).ok_or(Refusal::Value)?;
        if output.source() != Source::Command {
            return Err(Refusal::Linked);
        }
        output.command(on);
        Ok(())
    }

    /// `@AADO0V`, both outputs at once. One that is linked to PIR or temperature may be named with its present state
    /// only, and if both are linked there is nothing to command (PIR-234 manual 5.26).
    pub fn command_outputs(&mut self, bits: u16) -> Result<(), Refusal> {
        let bits = Refusal::unless_within(bits, 0..=3)?;
        if self.watchdog.tripped() {
            return Err(Refusal::Tripped);
        }
        let wanted = [bits & 1 != 0, bits & 2 != 0];
        let by_command = |output: &Output| output.source() == Source::Command;
        let pairs = || self.outputs.iter().zip(wanted);
        if !self.outputs.iter().any(by_command) || pairs().any(|(o, on)| !by_command(o) && o.state() != on) {
            return Err(Refusal::Linked);
        }
        for (output, on) in self.outputs.iter_mut().zip(wanted) {
            output.command(on);
        }
        Ok(())
    }
}

fn offset_within_range(offset: Hundredths) -> Result<Hundredths, Refusal> {
    if (-WIDEST_OFFSET..=WIDEST_OFFSET).contains(&offset) { Ok(offset) } else { Err(Refusal::Value) }
}
