//! One adapter on the simulated line, with the time that bytes take on the wire.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::bus::line::{Line, LineLost, sleep_until};
use crate::protocol::LineSettings;

use super::handle::Sim;
use super::world::{Carrier, Pace};

/// Bytes a 16550 gathers before it wakes its reader.
pub(super) const FIFO_TRIGGER: usize = 14;
/// Characters of silence after which a 16550 hands over fewer.
const FIFO_SILENCE: usize = 4;
/// How long a wait can miss that the clock was moved or the adapter unplugged.
const LONGEST_NAP: Duration = Duration::from_millis(20);

/// A [`Line`] to the modules of a [`Sim`]; each has its own receive buffer and settings.
#[derive(Debug)]
pub struct SimLine {
    sim: Sim,
    settings: LineSettings,
    /// Bytes by the time their last bit has arrived, in order.
    incoming: VecDeque<(Instant, u8)>,
    /// When the last bit of what was sent has left.
    sent: Instant,
}

impl SimLine {
    pub(super) fn new(sim: Sim) -> Self {
        let sent = sim.world().now();
        Self { sim, settings: LineSettings::default(), incoming: VecDeque::new(), sent }
    }

    fn check_plug(&mut self) -> Result<(), LineLost> {
        if self.sim.world().faults.unplugged {
            self.incoming.clear();
            return Err(LineLost::new("the simulated adapter is unplugged"));
        }
        Ok(())
    }

    /// Bytes follow each other at the speed of the line from `start` on, among those already under way.
    fn expect(&mut self, start: Instant, bytes: &[u8]) {
        let arrivals = bytes.iter().enumerate().map(|(index, &byte)| {
            let time = self.settings.wire_time(index.saturating_add(1));
            (start.checked_add(time).unwrap_or(start), byte)
        });
        self.incoming.extend(arrivals);
        self.incoming.make_contiguous().sort_by_key(|&(arrival, _)| arrival);
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
        loop {
            self.check_plug()?;
            let left = {
                let mut world = self.sim.world();
                let left = instant.saturating_duration_since(world.now());
                if world.pace == Pace::Skip {
                    world.skip(left);
                    return Ok(());
                }
                left
            };
            if left.is_zero() {
                return Ok(());
            }
            let now = Instant::now();
            sleep_until(now.checked_add(left.min(LONGEST_NAP)).unwrap_or(now));
        }
    }
}

impl Line for SimLine {
    fn configure(&mut self, settings: LineSettings) -> Result<(), LineLost> {
        self.purge()?;
        self.settings = settings;
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        self.check_plug()?;
        let (start, end, echo, answers) = {
            let mut world = self.sim.world();
            let start = world.now().max(self.sent);
            let end = start.checked_add(self.settings.wire_time(bytes.len())).unwrap_or(start);
            let answers = world.hear(bytes, Carrier::Line(self.settings), end);
            (start, end, world.faults.echo, answers)
        };
        self.sent = end;
        if echo {
            self.expect(start, bytes);
        }
        for answer in answers {
            self.expect(end.checked_add(answer.delay).unwrap_or(end), &answer.bytes);
        }
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

    fn wait_until(&mut self, instant: Instant) {
        // A lost line shows itself at the next call that can say so.
        let _ = self.pass(instant);
    }
}
