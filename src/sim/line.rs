//! One adapter on the simulated line, with the time that bytes take on the wire.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use jiff::{SignedDuration, Timestamp};

use crate::line::{Line, LineLost, sleep_until};
use crate::protocol::LineSettings;

use super::faults::{Code, FaultKind};
use super::handle::Sim;
use super::world::{Carrier, Pace, Reply};

/// Bytes a 16550 gathers before it wakes its reader.
pub(super) const FIFO_TRIGGER: usize = 14;
/// Characters of silence after which a 16550 hands over fewer.
const FIFO_SILENCE: usize = 4;
/// How long a wait can miss that the clock was moved or the adapter unplugged.
const LONGEST_NAP: Duration = Duration::from_millis(20);
/// How long a port waits that takes no bytes.
const WRITE_TIMEOUT: Duration = Duration::from_secs(2);
/// What a receive buffer holds when nobody reads; what comes then is lost.
const MOST_INCOMING: usize = 16_384;

/// A [`Line`] to the modules of a [`Sim`]; each has its own receive buffer and settings.
#[derive(Debug)]
pub struct SimLine {
    sim: Sim,
    /// Of the adapter that it was opened on.
    name: &'static str,
    settings: LineSettings,
    /// Bytes by the time their last bit has arrived, in order.
    incoming: VecDeque<(Instant, u8)>,
    /// When the last bit of what was sent has left.
    sent: Instant,
    /// Set while nobody waits for a port that takes no bytes.
    hurry: Arc<AtomicBool>,
}

impl SimLine {
    pub(super) fn new(sim: Sim, name: &'static str) -> Self {
        let sent = sim.world().now();
        let (incoming, hurry) = (VecDeque::new(), Arc::default());
        Self { sim, name, settings: LineSettings::default(), incoming, sent, hurry }
    }

    /// Fails if the adapter is gone, which counts as one failed call.
    fn check_plug(&mut self) -> Result<(), LineLost> {
        let mut world = self.sim.world();
        let Some((fault, reason)) = world.faults.cuts_off(self.name) else { return Ok(()) };
        world.faults.strike(fault);
        drop(world);
        self.incoming.clear();
        Err(LineLost::new(reason))
    }

    /// Waits until the port takes bytes.
    fn wait_for_room(&mut self) -> Result<(), LineLost> {
        let blocked = |sim: &Sim| sim.world().faults.faults.is_on(FaultKind::BlockedWrite);
        if !blocked(&self.sim) {
            return Ok(());
        }
        self.sim.world().faults.strike(FaultKind::BlockedWrite);
        let now = self.now();
        let give_up = now.checked_add(WRITE_TIMEOUT).unwrap_or(now);
        loop {
            self.check_plug()?;
            let over = self.nap(give_up);
            if !blocked(&self.sim) {
                return self.check_plug();
            }
            if over || self.hurry.load(Ordering::Relaxed) {
                return Err(LineLost::new("the port takes no bytes"));
            }
        }
    }

    /// Bytes follow each other at the speed of the line from `start` on, behind all that is under way: modules and
    /// adapters that are late keep the order.
    fn expect(&mut self, start: Instant, bytes: &[u8]) {
        let start = self.incoming.back().map_or(start, |&(last, _)| start.max(last));
        let arrivals = bytes.iter().enumerate().map(|(index, &byte)| {
            let time = self.settings.wire_time(index.saturating_add(1));
            (start.checked_add(time).unwrap_or(start), byte)
        });
        let room = MOST_INCOMING.saturating_sub(self.incoming.len());
        self.incoming.extend(arrivals.take(room));
    }

    /// What comes back of a request that takes from `start` to `end`, among what is still under way. Late bytes that
    /// would make a frame with the new ones that nobody sent are lost.
    fn expect_reply(&mut self, request: &[u8], start: Instant, end: Instant, reply: &Reply) {
        let before = self.incoming.clone();
        self.expect_all(start, end, reply);
        let code = Code::of(request);
        let bytes = |incoming: &VecDeque<(Instant, u8)>| incoming.iter().map(|&(_, byte)| byte).collect::<Vec<u8>>();
        if before.is_empty() || code == Code::Open {
            return;
        }
        let both = bytes(&self.incoming);
        self.incoming.clear();
        self.expect_all(start, end, reply);
        let (old, new) = (bytes(&before), bytes(&self.incoming));
        let known: Vec<Vec<u8>> = code.frames(&old).into_iter().chain(code.frames(&new)).map(<[u8]>::to_vec).collect();
        if !code.misleads(&both, &known) {
            self.incoming = before;
            self.expect_all(start, end, reply);
        }
    }

    fn expect_all(&mut self, start: Instant, end: Instant, reply: &Reply) {
        self.expect(start, &reply.echo);
        for answer in &reply.answers {
            self.expect(end.checked_add(answer.delay).unwrap_or(end), &answer.bytes);
        }
    }

    /// When a reader is woken for what is first in the buffer: the FIFO is filled, or its frame has ended.
    fn ready(&self, room: usize) -> Option<Instant> {
        let silence = self.settings.wire_time(FIFO_SILENCE);
        let mut arrivals = self.incoming.iter().map(|&(arrival, _)| arrival).take(FIFO_TRIGGER.min(room));
        let first = arrivals.next()?;
        let contiguous =
            arrivals.try_fold(first, |last, next| if next - last > silence { Err(last) } else { Ok(next) });
        Some(contiguous.unwrap_or_else(|last| last))
    }

    /// Lets the time pass until `instant` or until the adapter is gone.
    fn pass(&mut self, instant: Instant) -> Result<(), LineLost> {
        self.check_plug()?;
        while !self.nap(instant) {
            self.check_plug()?;
        }
        self.check_plug()
    }

    /// Lets a little time pass, at most until `instant`, and says whether it is over; where time need not be waited
    /// for, it is.
    fn nap(&self, instant: Instant) -> bool {
        let left = {
            let mut world = self.sim.world();
            let left = instant.saturating_duration_since(world.now());
            if world.pace == Pace::Skip {
                world.skip(left);
                return true;
            }
            left
        };
        let now = Instant::now();
        sleep_until(now.checked_add(left.min(LONGEST_NAP)).unwrap_or(now));
        left <= LONGEST_NAP
    }
}

impl Line for SimLine {
    fn hurry_by(&mut self, hurry: Arc<AtomicBool>) {
        self.hurry = hurry;
    }

    fn configure(&mut self, settings: LineSettings) -> Result<(), LineLost> {
        self.purge()?;
        self.settings = settings;
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        self.check_plug()?;
        self.wait_for_room()?;
        let (start, end, reply) = {
            let mut world = self.sim.world();
            let start = world.now().max(self.sent);
            let end = start.checked_add(self.settings.wire_time(bytes.len())).unwrap_or(start);
            let reply = world.hear(bytes, Carrier::Line(self.settings), end);
            (start, end, reply)
        };
        self.sent = end;
        self.expect_reply(bytes, start, end, &reply);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        let ready = self.ready(buffer.len()).unwrap_or(deadline);
        self.pass(ready.min(deadline))?;
        let now = self.now();
        let arrived = self.incoming.iter().take_while(|&&(arrival, _)| arrival <= now).count();
        let count = arrived.min(buffer.len());
        for (place, (_, byte)) in buffer.iter_mut().zip(self.incoming.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.check_plug()?;
        let now = self.now();
        self.incoming.retain(|&(arrival, _)| arrival > now);
        Ok(())
    }

    fn look(&mut self) -> Result<(), LineLost> {
        self.check_plug()
    }

    fn now(&self) -> Instant {
        self.sim.world().now()
    }

    fn wall(&self) -> Timestamp {
        let jump = SignedDuration::from_secs(self.sim.world().faults.clock_jump());
        let now = Timestamp::now();
        now.saturating_add(jump).unwrap_or(now)
    }

    fn wait_until(&mut self, instant: Instant) {
        // A lost line shows itself at the next call that can say so.
        while self.sim.world().faults.cuts_off(self.name).is_none() && !self.nap(instant) {}
    }
}
