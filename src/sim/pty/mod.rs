//! The simulated line behind a pseudo-terminal, so that any program can open it as a serial port.

mod framing;

use std::collections::VecDeque;
use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::OptionalActions;
use tokio::net::unix::pipe;
use tokio::runtime::Runtime;

use crate::protocol::{BaudRate, LineSettings};

use super::faults::FaultKind;
use super::handle::Sim;
use super::line::FIFO_TRIGGER;
use super::world::{Carrier, Reply};

/// How long a server takes at most to notice that it shall stop.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);
/// Operating systems deliver in lumps, so a pause that ends a frame is longer here than on the wire.
const LEAST_SILENCE: Duration = Duration::from_millis(20);

/// Lumps that wait at most; late answers pile up where nobody waits for them.
const MOST_OUTGOING: usize = 1_024;

/// More than any request has (Modbus over serial line 1.02, 2.5.1).
const LONGEST_REQUEST: usize = 256;

/// Serves a simulated line on a pseudo-terminal, at the speed a real one would have, until dropped.
///
/// Modules hear only what comes at their speed; the data format cannot be seen on a pseudo-terminal.
#[derive(Debug)]
pub struct PtyServer {
    path: PathBuf,
    link: Option<PathBuf>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl PtyServer {
    /// Opens a new pseudo-terminal, and makes `link` a symbolic link to it. A link that is there already is replaced,
    /// any other file is left alone and an error.
    pub fn open(sim: &Sim, link: Option<&Path>) -> io::Result<Self> {
        let master = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        rustix::pty::grantpt(&master)?;
        rustix::pty::unlockpt(&master)?;
        let path = PathBuf::from(OsStr::from_bytes(rustix::pty::ptsname(&master, Vec::new())?.as_bytes()));
        let slave = open_raw(&path)?;
        let flags = rustix::fs::fcntl_getfl(&master)?;
        rustix::fs::fcntl_setfl(&master, flags | OFlags::NONBLOCK)?;

        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
        let master = {
            let _context = runtime.enter();
            // To tokio anything is a pipe that can be read and polled.
            pipe::Receiver::from_file_unchecked(File::from(master))?
        };
        let link = link.map(Path::to_owned);
        if let Some(link) = &link {
            replace_link(&path, link)?;
        }
        let stop = Arc::new(AtomicBool::new(false));
        let talk = Talk::new(sim.clone(), master, slave);
        let mut server = Self { path, link, stop, thread: None };
        server.thread = Some(server.spawn(runtime, talk)?);
        Ok(server)
    }

    /// The terminal to open as a serial port.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn spawn(&self, runtime: Runtime, mut talk: Talk) -> io::Result<JoinHandle<()>> {
        let stop = Arc::clone(&self.stop);
        std::thread::Builder::new().name("sim-pty".to_owned()).spawn(move || {
            if let Err(error) = runtime.block_on(talk.serve(&stop)) {
                log::error!("simulated line: {error}");
            }
        })
    }
}

impl Drop for PtyServer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // It has logged its own failure.
            let _ = thread.join();
        }
        if let Some(link) = &self.link
            && std::fs::read_link(link).is_ok_and(|target| target == self.path)
        {
            let _ = std::fs::remove_file(link);
        }
    }
}

/// Opens the slave side without line editing. While it stays open, the master survives clients that come and go.
fn open_raw(path: &Path) -> io::Result<OwnedFd> {
    let slave = rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
    let mut settings = rustix::termios::tcgetattr(&slave)?;
    settings.make_raw();
    settings.set_speed(BaudRate::B9600.bps())?;
    rustix::termios::tcsetattr(&slave, OptionalActions::Now, &settings)?;
    Ok(slave)
}

fn replace_link(path: &Path, link: &Path) -> io::Result<()> {
    if std::fs::symlink_metadata(link).is_ok_and(|found| found.file_type().is_symlink()) {
        std::fs::remove_file(link)?;
    }
    std::os::unix::fs::symlink(path, link)
}

/// The conversation with whoever has opened the slave.
struct Talk {
    sim: Sim,
    master: pipe::Receiver,
    _slave: OwnedFd,
    /// What has come in and is no whole request yet.
    heard: Vec<u8>,
    last_heard: Instant,
    /// When the last bit of what was heard would have passed on a wire.
    sent: Instant,
    /// What goes out, in lumps as a receive FIFO makes them, by the time of their last bit.
    outgoing: VecDeque<(Instant, Vec<u8>)>,
}

impl Talk {
    fn new(sim: Sim, master: pipe::Receiver, slave: OwnedFd) -> Self {
        let now = Instant::now();
        Self { sim, master, _slave: slave, heard: Vec::new(), last_heard: now, sent: now, outgoing: VecDeque::new() }
    }

    async fn serve(&mut self, stop: &AtomicBool) -> io::Result<()> {
        while !stop.load(Ordering::Relaxed) {
            let next = tokio::time::Instant::from_std(self.next_event());
            if let Ok(readable) = tokio::time::timeout_at(next, self.master.readable()).await {
                readable?;
                let mut buffer = [0; 512];
                match self.master.try_read(&mut buffer) {
                    Ok(count) => self.listen(buffer.get(..count).unwrap_or_default())?,
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => (),
                    Err(error) => return Err(error),
                }
            }
            self.end_with_silence()?;
            self.say_what_is_due();
        }
        Ok(())
    }

    fn next_event(&self) -> Instant {
        let silence = (!self.heard.is_empty()).then(|| self.silent_at()).flatten();
        let due = self.outgoing.front().map(|&(due, _)| due);
        let latest = Instant::now() + LONGEST_SLEEP;
        [silence, due].into_iter().flatten().fold(latest, Instant::min)
    }

    /// When what was heard ends for lack of more.
    fn silent_at(&self) -> Option<Instant> {
        let settings = self.speed().map(at_speed).unwrap_or_default();
        self.last_heard.checked_add(settings.frame_silence().max(LEAST_SILENCE))
    }

    fn listen(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.heard.extend(bytes);
        self.last_heard = Instant::now();
        while let Some(length) = framing::complete(&self.heard) {
            let frame: Vec<u8> = self.heard.drain(..length).collect();
            self.hear(&frame)?;
        }
        Ok(())
    }

    fn end_with_silence(&mut self) -> io::Result<()> {
        let silent = || self.silent_at().is_none_or(|silent| silent <= Instant::now());
        if self.heard.len() > LONGEST_REQUEST || !self.heard.is_empty() && silent() {
            let frame = std::mem::take(&mut self.heard);
            self.hear(&frame)?;
        }
        Ok(())
    }

    /// The master shows the settings of the slave; the client has set them.
    fn speed(&self) -> io::Result<u32> {
        Ok(rustix::termios::tcgetattr(&self.master)?.output_speed())
    }

    fn hear(&mut self, frame: &[u8]) -> io::Result<()> {
        let speed = self.speed()?;
        let settings = at_speed(speed);
        let now = Instant::now();
        let start = now.max(self.sent);
        let end = start + settings.wire_time(frame.len());
        let Reply { echo, answers } = {
            let mut world = self.sim.world();
            if world.faults.is_unplugged() {
                world.faults.strike(FaultKind::Unplugged);
                return Ok(());
            }
            let heard = world.now() + (end - now);
            world.hear(frame, Carrier::Speed(speed), heard)
        };
        self.sent = end;
        self.say(start, settings, &echo);
        for answer in answers {
            self.say(end.checked_add(answer.delay).unwrap_or(end), settings, &answer.bytes);
        }
        Ok(())
    }

    /// Behind all that is under way: modules and adapters that are late keep the order.
    fn say(&mut self, start: Instant, settings: LineSettings, bytes: &[u8]) {
        let start = self.outgoing.back().map_or(start, |&(last, _)| start.max(last));
        let mut sent = 0_usize;
        for lump in bytes.chunks(FIFO_TRIGGER) {
            if self.outgoing.len() >= MOST_OUTGOING {
                break;
            }
            sent = sent.saturating_add(lump.len());
            let due = start.checked_add(settings.wire_time(sent)).unwrap_or(start);
            self.outgoing.push_back((due, lump.to_vec()));
        }
    }

    fn say_what_is_due(&mut self) {
        let now = Instant::now();
        while let Some((_, lump)) = self.outgoing.pop_front_if(|(due, _)| *due <= now) {
            // Nobody reads and the terminal's buffer is full: on a wire the bytes would be gone, too.
            if let Err(error) = rustix::io::write(&self.master, &lump) {
                log::debug!("simulated line: {} bytes lost: {error}", lump.len());
            }
        }
    }
}

/// A speed that no module has takes as long as the default one; nobody will answer anyhow.
fn at_speed(bps: u32) -> LineSettings {
    LineSettings { baud_rate: BaudRate::new(bps).unwrap_or_default(), ..LineSettings::default() }
}
