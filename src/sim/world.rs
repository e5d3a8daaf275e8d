//! The modules on the line and the time they live in.

use std::time::{Duration, Instant};

#[cfg(unix)]
use crate::protocol::BaudRate;
use crate::protocol::{LineSettings, Protocol};

use super::device::Device;
use super::faults::{Asked, Code, FaultKind, Present};
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

    fn bps(self) -> u32 {
        match self {
            Self::Line(line) => line.baud_rate.bps(),
            #[cfg(unix)]
            Self::Speed(bps) => bps,
        }
    }

    /// How long characters take. A speed that no module has is as fast as the default one; nobody will answer anyhow.
    fn settings(self) -> LineSettings {
        match self {
            Self::Line(line) => line,
            #[cfg(unix)]
            Self::Speed(bps) => {
                LineSettings { baud_rate: BaudRate::new(bps).unwrap_or_default(), ..LineSettings::default() }
            }
        }
    }
}

/// What a module puts on the wire, `delay` after the last bit of the request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    pub delay: Duration,
    pub bytes: Vec<u8>,
}

/// What comes back of one request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Reply {
    /// From the first bit of the request on.
    pub echo: Vec<u8>,
    pub answers: Vec<Answer>,
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

    /// What comes back of a frame whose last bit passes at `now`.
    pub fn hear(&mut self, frame: &[u8], carrier: Carrier, now: Instant) -> Reply {
        self.requests = self.requests.saturating_add(1);
        self.live(now);
        let echo = self.faults.echo_of(frame);
        let mut asked = Asked { request: frame, code: Code::of(frame), settings: carrier.settings() };
        if let Some(bytes) = self.faults.garbage(asked, carrier.bps(), &echo) {
            return Reply { echo, answers: vec![Answer { delay: self.turnaround, bytes }] };
        }
        let heard = self.faults.heard(asked);
        let Said { answers, twins, code } = self.answers(&heard, carrier, asked.code);
        asked.code = code;
        let answers = self.faults.on_the_wire(answers, asked, &echo, twins);
        Reply { echo, answers }
    }

    /// What the modules say, still undamaged.
    fn answers(&mut self, frame: &[u8], carrier: Carrier, asked: Code) -> Said {
        let (turnaround, twin) = (self.turnaround, self.faults.twin());
        let mut said = Said { answers: Vec::new(), twins: false, code: asked };
        for device in self.devices.iter_mut().filter(|device| !device.dead) {
            let language = device.comms.in_force();
            if !carrier.matches(language.settings) {
                continue;
            }
            let second = (twin == Some(device.comms.address())).then(|| device.twin());
            let Some(bytes) = device.hear(frame) else { continue };
            if language.protocol == Protocol::Dcon {
                said.code = if language.checksum { Code::Summed } else { Code::Open };
            }
            let delay = turnaround.saturating_add(device.comms.response_delay());
            said.answers.push(Answer { delay, bytes });
            if let Some(bytes) = second.and_then(|mut second| second.hear(frame)) {
                said.second(&mut self.faults, delay, bytes);
            }
        }
        for seat in self.seats.iter_mut().filter(|seat| !seat.dead && carrier.matches(seat.guest.settings())) {
            let at_twin = twin == Some(seat.guest.address());
            let Some(bytes) = seat.guest.hear(frame) else { continue };
            let delay = turnaround.saturating_add(seat.guest.response_delay());
            said.answers.push(Answer { delay, bytes: bytes.clone() });
            // A guest cannot be taken twice: its twin sees what it sees.
            if at_twin {
                said.second(&mut self.faults, delay, bytes);
            }
        }
        said
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

/// What the modules say to one request.
struct Said {
    answers: Vec<Answer>,
    /// A second module is among them.
    twins: bool,
    code: Code,
}

impl Said {
    fn second(&mut self, faults: &mut Present, delay: Duration, bytes: Vec<u8>) {
        faults.strike(FaultKind::Twin);
        self.twins = true;
        self.answers.push(Answer { delay: faults.jittered(delay), bytes });
    }
}
