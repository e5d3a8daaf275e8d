//! The modules on the line and the time they live in.

use std::time::{Duration, Instant};

use crate::protocol::LineSettings;

use super::device::Device;
use super::faults::Present;
use super::guest::{Guest, Seat};
use super::spec::ModuleSpec;

/// Modules have been on for a minute when the world begins, so that their start-up times are over.
const AGE_AT_START: Duration = Duration::from_secs(60);
/// As far as the clock can be moved in one go.
const LONGEST_JUMP: Duration = Duration::from_secs(10 * 365 * 86_400);

/// Whether time has to be waited for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Waits as long as a real wire would.
    Real,
    /// Lets the line's clock jump instead of waiting.
    Skip,
}

/// How a frame came over the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Carrier {
    /// With this speed and format.
    Line(LineSettings),
    /// With this speed in bits per second; the format cannot be seen, as on a pseudo-terminal.
    #[cfg(unix)]
    Speed(u32),
}

impl Carrier {
    fn matches(self, settings: LineSettings) -> bool {
        match self {
            Self::Line(line) => line == settings,
            #[cfg(unix)]
            Self::Speed(bps) => bps == settings.baud_rate.bps(),
        }
    }
}

/// What a module puts on the wire, `delay` after the last bit of the request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    pub delay: Duration,
    pub bytes: Vec<u8>,
}

#[derive(Debug)]
pub(super) struct World {
    pub pace: Pace,
    pub faults: Present,
    /// Time a module needs before its response delay begins.
    pub turnaround: Duration,
    pub requests: u64,
    devices: Vec<Device>,
    seats: Vec<Seat>,
    epoch: Instant,
    skipped: Duration,
}

impl World {
    pub fn new(specs: &[ModuleSpec], pace: Pace) -> Self {
        let mut world = Self {
            pace,
            faults: Present::default(),
            turnaround: Duration::from_millis(5),
            requests: 0,
            devices: specs.iter().map(Device::new).collect(),
            seats: Vec::new(),
            epoch: Instant::now(),
            skipped: Duration::ZERO,
        };
        world.live(world.now());
        world
    }

    /// The clock of the line and of the modules.
    pub fn now(&self) -> Instant {
        let now = Instant::now();
        now.checked_add(self.skipped).unwrap_or(now)
    }

    pub fn skip(&mut self, time: Duration) {
        let skipped = self.skipped.saturating_add(time.min(LONGEST_JUMP));
        // Beyond what the clock can show, time stands still.
        if Instant::now().checked_add(skipped).is_some() {
            self.skipped = skipped;
        }
    }

    fn age(&self, at: Instant) -> Duration {
        at.saturating_duration_since(self.epoch).saturating_add(AGE_AT_START)
    }

    /// Brings all modules up to date.
    pub fn live(&mut self, now: Instant) {
        let age = self.age(now);
        for device in &mut self.devices {
            device.advance_to(age);
        }
        for seat in &mut self.seats {
            seat.guest.live(age);
        }
    }

    /// One more module on the line.
    pub fn join(&mut self, guest: Box<dyn Guest>) {
        self.seats.push(Seat { guest, dead: false });
        self.live(self.now());
    }

    /// All guests at `address`, up to date.
    pub fn seats_at(&mut self, address: u8) -> impl Iterator<Item = &mut Seat> {
        self.live(self.now());
        self.seats.iter_mut().filter(move |seat| seat.guest.address() == address)
    }

    /// All modules at `address`, up to date.
    fn at(&mut self, address: u8) -> impl Iterator<Item = &mut Device> {
        self.live(self.now());
        self.devices.iter_mut().filter(move |device| device.comms.address() == address)
    }

    /// The first module at `address`, up to date.
    pub fn module(&mut self, address: u8) -> Option<&Device> {
        self.at(address).next().map(|device| &*device)
    }

    /// Changes every module at `address`, with what follows from it at once.
    pub fn change(&mut self, address: u8, change: impl Fn(&mut Device)) {
        for device in self.at(address) {
            change(device);
            device.advance_to(Duration::ZERO);
        }
    }

    /// What is answered to a frame whose last bit passes at `now`.
    pub fn hear(&mut self, frame: &[u8], carrier: Carrier, now: Instant) -> Vec<Answer> {
        self.requests = self.requests.saturating_add(1);
        self.live(now);
        let turnaround = self.turnaround;
        let reachable = |device: &&mut Device| !device.dead && carrier.matches(device.comms.in_force().settings);
        let answers = self.devices.iter_mut().filter(reachable).filter_map(|device| {
            let bytes = device.hear(frame)?;
            Some(Answer { delay: turnaround.saturating_add(device.comms.response_delay()), bytes })
        });
        let present = |seat: &&mut Seat| !seat.dead && carrier.matches(seat.guest.settings());
        let guests = self.seats.iter_mut().filter(present).filter_map(|seat| {
            let bytes = seat.guest.hear(frame)?;
            Some(Answer { delay: turnaround.saturating_add(seat.guest.response_delay()), bytes })
        });
        self.faults.on_the_wire(answers.chain(guests).collect())
    }

    /// The answer of the module with this unit identifier to a Modbus request over Ethernet, if there is one.
    pub fn hear_tcp(&mut self, unit: u8, pdu: &[u8]) -> Option<Vec<u8>> {
        self.requests = self.requests.saturating_add(1);
        self.live(self.now());
        let reachable =
            |device: &&mut Device| !device.dead && device.model.has_ethernet() && device.ethernet.net_id() == unit;
        self.devices.iter_mut().find(reachable).map(|device| device.hear_tcp(pdu))
    }
}
