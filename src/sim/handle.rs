//! The handle by which a program and its tests hold the simulated world.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::line::LineLost;

use super::DEMO;
use super::device::Device;
use super::ethernet::ResetCause;
use super::faults::{Faults, Injected};
use super::guest::Guest;
use super::line::SimLine;
use super::settings;
use super::spec::ModuleSpec;
use super::world::{Pace, World};

/// The adapter through which a program reaches the line, as an operating system would list it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// What to open; it can change when the adapter is plugged in anew.
    pub name: String,
    /// USB numbers of maker and product, and the serial number, which stay.
    pub vendor: u16,
    pub product: u16,
    pub serial: String,
}

/// A handle on simulated modules, their clock and the faults of their line; clones share one world.
///
/// Modules are named by the address they answer at; where several have the same, all of them are meant.
#[derive(Debug, Clone)]
pub struct Sim {
    world: Arc<Mutex<World>>,
}

impl Sim {
    /// A line with these modules, which have been on for a minute.
    pub fn new(specs: &[ModuleSpec], pace: Pace) -> Self {
        Self { world: Arc::new(Mutex::new(World::new(specs, pace))) }
    }

    /// The modules of [`DEMO`] in real time.
    pub fn demo() -> Self {
        let specs: Vec<ModuleSpec> = DEMO.iter().filter_map(|text| text.parse().ok()).collect();
        Self::new(&specs, Pace::Real)
    }

    /// Adds a module that is made elsewhere; it too has been on for a minute when the line begins.
    pub fn join(&self, guest: Box<dyn Guest>) {
        self.world().join(guest);
    }

    /// The line through the adapter that is there now, or was, at 9600 N81 at first.
    pub fn line(&self) -> SimLine {
        let name = self.adapter_name();
        SimLine::new(self.clone(), name)
    }

    /// The line through the adapter `name`, at 9600 N81 at first.
    ///
    /// # Errors
    /// If no adapter of this name is plugged in.
    pub fn line_on(&self, name: &str) -> Result<SimLine, LineLost> {
        match self.adapters().into_iter().find(|adapter| adapter.name == name) {
            Some(_) => Ok(SimLine::new(self.clone(), self.adapter_name())),
            None => Err(LineLost::new(format!("no simulated adapter {name} is plugged in"))),
        }
    }

    /// What chance does to the line is the same again with the same seed and the same requests.
    pub fn with_seed(self, seed: u64) -> Self {
        self.world().faults.seed(seed);
        self
    }

    /// The time a module needs to answer, to which its response delay is added; 5 ms unless told.
    pub fn with_turnaround(self, turnaround: Duration) -> Self {
        self.world().turnaround = turnaround;
        self
    }

    /// Moves the clock of line and modules forward, by ten years at most.
    pub fn advance(&self, time: Duration) {
        let mut world = self.world();
        world.skip(time);
        let now = world.now();
        world.live(now);
    }

    /// Switches off and on again: what is stored comes into force.
    pub fn power_cycle(&self, address: u8) {
        self.change(address, |device| device.power_cycle(ResetCause::PowerOn));
        self.world().seats_at(address).for_each(|seat| seat.guest.power_cycle());
    }

    /// DIP 4: in INIT mode speed, format, checksum and protocol can be stored.
    pub fn set_init(&self, address: u8, on: bool) {
        self.change(address, |device| device.comms.init = on);
        self.world().seats_at(address).for_each(|seat| seat.guest.set_init(on));
    }

    /// Freezes the air of a module at this temperature in °C; the module adds its offset.
    pub fn set_temperature(&self, address: u8, celsius: f64) {
        self.change(address, |device| device.climate.freeze_temperature(celsius));
    }

    /// Freezes the air of a module at this relative humidity in %; the module adds its offset.
    pub fn set_humidity(&self, address: u8, percent: f64) {
        self.change(address, |device| device.climate.freeze_humidity(percent));
    }

    /// Ends the visitors' play at a module and says what one sensor sees: 1 to 4 as `pir1` to `pir4`, or 0 for all.
    pub fn set_motion(&self, address: u8, sensor: usize, seen: bool) {
        self.change(address, |device| device.motion.say(sensor, seen));
    }

    /// A dead module hears and answers nothing.
    pub fn set_dead(&self, address: u8, dead: bool) {
        self.change(address, |device| device.dead = dead);
        self.world().seats_at(address).for_each(|seat| seat.dead = dead);
    }

    /// The adapters that are plugged in.
    pub fn adapters(&self) -> Vec<Adapter> {
        let faults = &self.world().faults;
        if faults.is_unplugged() {
            return Vec::new();
        }
        let name = faults.adapter_name().to_owned();
        vec![Adapter { name, vendor: 0x0403, product: 0x6001, serial: "SIM00001".to_owned() }]
    }

    fn adapter_name(&self) -> &'static str {
        self.world().faults.adapter_name()
    }

    /// What goes wrong on the line at present.
    pub fn faults(&self) -> Faults {
        self.world().faults.faults.clone()
    }

    /// What goes wrong from now on; what was under way stays as it is.
    pub fn set_faults(&self, faults: Faults) {
        self.world().faults.set(faults);
    }

    /// How often each fault has struck since the line began.
    pub fn injected(&self) -> Injected {
        self.world().faults.injected.clone()
    }

    /// The adapter hears itself: every sent byte comes back first.
    pub fn set_echo(&self, echo: bool) {
        self.world().faults.echo = echo;
    }

    /// Stray bytes around each answer.
    pub fn set_noise(&self, bytes_before: &[u8], bytes_after: &[u8]) {
        let faults = &mut self.world().faults;
        faults.noise_before = bytes_before.to_vec();
        faults.noise_after = bytes_after.to_vec();
    }

    /// From now on every call of a line fails.
    pub fn unplug(&self) {
        self.world().faults.unplugged = true;
    }

    /// Lines work again; what was under way is lost.
    pub fn plug(&self) {
        self.world().faults.unplugged = false;
    }

    /// What a module has stored, or shows, by the public name of a parameter or reading, in its public form; nothing
    /// if it has no such.
    pub fn setting(&self, address: u8, name: &str) -> Option<String> {
        let mut world = self.world();
        match world.module(address) {
            Some(device) => settings::read(device, name),
            None => world.seats_at(address).next()?.guest.value(name),
        }
    }

    /// Lets every guest at `address` hold or show `value` from now on, in its public form; false if one cannot, or if
    /// there is none.
    pub fn set_value(&self, address: u8, name: &str, value: &str) -> bool {
        let mut world = self.world();
        let taken: Vec<bool> = world.seats_at(address).map(|seat| seat.guest.set_value(name, value)).collect();
        !taken.is_empty() && taken.into_iter().all(|taken| taken)
    }

    /// Frames heard on the line so far, whether or not a module understood them.
    pub fn requests(&self) -> u64 {
        self.world().requests
    }

    fn change(&self, address: u8, change: impl Fn(&mut Device)) {
        self.world().change(address, change);
    }

    /// The world, even if a thread that held it has panicked: it is whole between any two steps.
    pub(super) fn world(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
