//! The handle by which the window and the command line use the bus thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError};
use std::thread::JoinHandle;
use std::time::Duration;

use super::message::{BusCommand, BusEvent, RequestId};
use super::ports::{ListPorts, ports};
use super::worker::Worker;
use crate::module::Catalogue;

/// Commands that may wait; more means that someone sends without looking.
const COMMAND_ROOM: usize = 256;
/// Events that may wait; when it is full the thread waits too, except with traffic, which it counts as missed.
const EVENT_ROOM: usize = 4096;

/// Given to the thread to end by itself: more than an exchange takes.
const LONGEST_END: Duration = Duration::from_millis(400);

/// The bus thread does not take commands: it has ended, or too many are waiting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BusGone {
    #[error("the bus thread has ended – restart the program")]
    Ended,
    #[error("too many requests are waiting for the line – wait until some are done")]
    Full,
}

/// The bus thread, seen from outside. Dropping it ends the thread and closes the line; a thread that is held up by the
/// system ends later by itself.
pub struct Bus {
    commands: Option<SyncSender<BusCommand>>,
    events: Option<Receiver<BusEvent>>,
    next_id: AtomicU64,
    thread: Option<Running>,
    /// A scan is to end at once.
    hurry: Arc<AtomicBool>,
}

struct Running {
    thread: JoinHandle<()>,
    /// Hangs up when the thread has ended.
    ended: Receiver<()>,
}

impl Bus {
    /// Starts the thread; `wake` is called after events were sent, at most once for a batch.
    pub fn start(catalogue: Arc<Catalogue>, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_with_ports(catalogue, wake, Box::new(ports))
    }

    /// As [`Self::start`], for someone who knows which ports there are.
    pub fn start_with_ports(
        catalogue: Arc<Catalogue>,
        wake: impl Fn() + Send + 'static,
        list_ports: ListPorts,
    ) -> std::io::Result<Self> {
        let (commands, command_queue) = mpsc::sync_channel(COMMAND_ROOM);
        let (event_queue, events) = mpsc::sync_channel(EVENT_ROOM);
        let hurry = Arc::<AtomicBool>::default();
        let worker = Worker::new(catalogue, command_queue, event_queue, Box::new(wake), list_ports, hurry.clone());
        let (alive, ended) = mpsc::channel();
        let thread = std::thread::Builder::new().name("bus".to_owned()).spawn(move || {
            let _alive: Sender<()> = alive;
            worker.run();
        })?;
        let thread = Some(Running { thread, ended });
        Ok(Self { commands: Some(commands), events: Some(events), next_id: AtomicU64::new(1), thread, hurry })
    }

    /// A handle without a thread: whoever holds the other ends plays the bus, at times of its own choice.
    pub fn detached() -> (Self, Receiver<BusCommand>, SyncSender<BusEvent>) {
        let (commands, command_queue) = mpsc::sync_channel(COMMAND_ROOM);
        let (event_queue, events) = mpsc::sync_channel(EVENT_ROOM);
        let (next_id, hurry) = (AtomicU64::new(1), Arc::default());
        let bus = Self { commands: Some(commands), events: Some(events), next_id, thread: None, hurry };
        (bus, command_queue, event_queue)
    }

    /// A number that no other request has.
    pub fn next_id(&self) -> RequestId {
        RequestId(self.next_id.fetch_add(1, Ordering::Relaxed))
    }

    pub fn send(&self, command: BusCommand) -> Result<(), BusGone> {
        let commands = self.commands.as_ref().ok_or(BusGone::Ended)?;
        let hurried = matches!(command, BusCommand::CancelScan | BusCommand::Open { .. } | BusCommand::Close { .. });
        if hurried {
            self.hurry.store(true, Ordering::Relaxed);
        }
        commands.try_send(command).map_err(|error| {
            if hurried {
                // Nobody will take it, and so nobody will have been in a hurry.
                self.hurry.store(false, Ordering::Relaxed);
            }
            match error {
                TrySendError::Full(_) => BusGone::Full,
                TrySendError::Disconnected(_) => BusGone::Ended,
            }
        })
    }

    /// The next event, if one is waiting.
    pub fn try_event(&self) -> Option<BusEvent> {
        self.events.as_ref()?.try_recv().ok()
    }

    /// Waits for the next event; `Ok(None)` when none came in time.
    pub fn wait_event(&self, limit: Duration) -> Result<Option<BusEvent>, BusGone> {
        match self.events.as_ref().ok_or(BusGone::Ended)?.recv_timeout(limit) {
            Ok(event) => Ok(Some(event)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(BusGone::Ended),
        }
    }
}

impl Drop for Bus {
    fn drop(&mut self) {
        self.hurry.store(true, Ordering::Relaxed);
        // Without both ends the thread can neither wait for a command nor for room for an event.
        self.commands = None;
        self.events = None;
        let Some(Running { thread, ended }) = self.thread.take() else { return };
        // A port that takes no bytes, or a host name that nobody resolves, must not hold up the end of the program.
        if ended.recv_timeout(LONGEST_END) == Err(RecvTimeoutError::Timeout) {
            log::warn!("the line is still busy and is left alone");
        } else if thread.join().is_err() {
            log::error!("the bus thread had panicked");
        }
    }
}
