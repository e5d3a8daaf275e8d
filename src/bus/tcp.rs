//! Modbus TCP to one module, through `tokio-modbus`' own client.
//!
//! After any error or timeout the connection is dropped and made anew: a late answer would otherwise block the client
//! for good. The PIR-234 cuts idle connections after 180 s (manual 3.5.2), which is healed in the same way.

use std::io;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use jiff::Timestamp;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::runtime::Runtime;
use tokio_modbus::client::{Client, Context as ModbusContext, tcp};
use tokio_modbus::prelude::SlaveContext;
use tokio_modbus::{ProtocolError, Request, Slave};

use super::codec;
use super::tap::{Clock, Exchange, Tap, Verdict};
use crate::protocol::{Failure, LineSettings, Protocol, Query, Reply};

/// A connection that was idle for longer may have been cut by the module unnoticed (its idle timeout is 5 s at least), and
/// a write must not find that out.
const FRESH: Duration = Duration::from_secs(2);
const CONNECT_LIMIT: Duration = Duration::from_secs(3);
/// Address, function and data of the longest request (Modbus application protocol 1.1b3, 4.1).
const LONGEST_REQUEST: usize = 254;
/// Transaction, protocol and length; the unit, which is the address, follows.
const HEADER: usize = 6;
/// On a network an answer takes longer than on a wire; this is added to every window.
pub const NETWORK_ALLOWANCE: Duration = Duration::from_millis(800);

pub struct TcpLink {
    host: String,
    port: u16,
    client: Option<ModbusContext>,
    tap: Arc<Mutex<TimedTap>>,
    answer_time: Option<Duration>,
    last_used: Instant,
}

/// Collects what passes the stream into frames.
struct TimedTap {
    clock: Clock,
    tap: Tap,
    /// The module that is asked.
    unit: u8,
    /// When the request was handed over; `None` if none was since the last answer.
    sent: Option<Instant>,
    /// What has come back on it, and when the last of it.
    received: Vec<u8>,
    last_byte: Instant,
    /// When the last exchange was over; `None` if there was no connection for it.
    ended: Option<Instant>,
}

impl TimedTap {
    fn new(tap: Tap) -> Self {
        let now = Instant::now();
        Self {
            clock: Clock::starting(now, Timestamp::now()),
            tap,
            unit: 0,
            sent: None,
            received: Vec::new(),
            last_byte: now,
            ended: None,
        }
    }

    fn exchange(&self) -> Exchange {
        Exchange {
            protocol: Protocol::ModbusTcp,
            settings: LineSettings::default(),
            address: Some(self.unit),
            checksum: false,
        }
    }

    fn begin(&mut self, unit: u8) {
        self.clock.follow(Instant::now(), Timestamp::now());
        self.unit = unit;
        self.sent = None;
        self.ended = None;
        self.received.clear();
    }

    fn sent(&mut self, bytes: &[u8]) {
        let now = Instant::now();
        self.sent = Some(now);
        let frame = self.exchange().request(self.clock.stamp(now), bytes.to_vec(), Duration::ZERO);
        (self.tap)(frame);
    }

    fn received(&mut self, bytes: &[u8]) {
        self.received.extend_from_slice(bytes);
        self.last_byte = Instant::now();
    }

    /// Tells what came back. A gateway's word that nobody answered is a refusal here: the bytes say so.
    fn end(&mut self, failure: Option<&Failure>) {
        let ended = if self.received.is_empty() { Instant::now() } else { self.last_byte };
        self.ended = Some(ended);
        let Some(sent) = self.sent.take() else { return };
        let bytes = std::mem::take(&mut self.received);
        let verdict = match failure {
            Some(Failure::Silent) if bytes.get(7).is_some_and(|function| function & 0x80 != 0) => Verdict::Refusal,
            Some(Failure::Silent) if !bytes.is_empty() => Verdict::Broken("the answer was cut short".to_owned()),
            Some(failure) => self.exchange().verdict(Err(failure)),
            None => Verdict::Answer,
        };
        let took = ended.saturating_duration_since(sent);
        let frame = self.exchange().answer(self.clock.stamp(ended), bytes, took, verdict);
        (self.tap)(frame);
    }
}

impl TcpLink {
    pub fn connect(runtime: &Runtime, host: &str, port: u16, tap: Tap) -> Result<Self, String> {
        let tap = Arc::new(Mutex::new(TimedTap::new(tap)));
        let mut link =
            Self { host: host.to_owned(), port, client: None, tap, answer_time: None, last_used: Instant::now() };
        link.client = Some(link.open(runtime)?);
        Ok(link)
    }

    pub fn timestamp(&self) -> Timestamp {
        self.tap().clock.stamp(Instant::now())
    }

    /// Stamps nothing earlier than `floor` from now on.
    pub fn not_before(&mut self, floor: Timestamp) {
        self.tap().clock.not_before(floor, Instant::now());
    }

    /// When the last byte of the last answer had arrived, or when the wait for it was given up.
    pub fn ended_at(&self) -> Timestamp {
        let tap = self.tap();
        tap.clock.stamp(tap.ended.unwrap_or_else(Instant::now))
    }

    fn tap(&self) -> MutexGuard<'_, TimedTap> {
        self.tap.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn answer_time(&self) -> Option<Duration> {
        self.answer_time
    }

    fn open(&self, runtime: &Runtime) -> Result<ModbusContext, String> {
        let tap = self.tap.clone();
        runtime.block_on(async {
            let connecting = TcpStream::connect((self.host.as_str(), self.port));
            let stream = match tokio::time::timeout(CONNECT_LIMIT, connecting).await {
                Ok(Ok(stream)) => stream,
                Ok(Err(error)) => return Err(words_of(&error)),
                Err(_) => return Err(format!("no answer within {} s", CONNECT_LIMIT.as_secs())),
            };
            if let Err(error) = stream.set_nodelay(true) {
                log::debug!("no-delay could not be set: {error}");
            }
            Ok(tcp::attach(Tapped { stream, tap }))
        })
    }

    /// Asks once; a read whose connection turns out to be cut is asked again on a new one.
    pub fn ask(&mut self, runtime: &Runtime, unit: u8, query: &Query, window: Duration) -> Result<Reply, Failure> {
        if query.is_write() && self.last_used.elapsed() > FRESH {
            self.client = None;
        }
        let reply = self.ask_once(runtime, unit, query, window);
        self.last_used = Instant::now();
        match reply {
            Err(Failure::LineLost(_)) if !query.is_write() => self.ask_once(runtime, unit, query, window),
            reply => reply,
        }
    }

    fn ask_once(&mut self, runtime: &Runtime, unit: u8, query: &Query, window: Duration) -> Result<Reply, Failure> {
        let request = codec::request_of(query)?;
        let mut client = self.take_client(runtime, unit)?;
        let started = Instant::now();
        let answered =
            runtime.block_on(async { tokio::time::timeout(window + NETWORK_ALLOWANCE, client.call(request)).await });
        let reply = match answered {
            Ok(Err(tokio_modbus::Error::Transport(error))) => Err(failure_of(&error)),
            Ok(answered) => {
                self.answer_time = Some(started.elapsed());
                let reply = gateway_silence(codec::reply_of(query, answered));
                if reply.is_ok() || reply.as_ref().is_err_and(Failure::is_refusal) {
                    self.client = Some(client);
                }
                reply
            }
            Err(_) => Err(Failure::Silent),
        };
        self.tap().end(reply.as_ref().err());
        reply
    }

    /// Sends address, function and data once and returns the answer from its address on, exceptions included.
    pub fn raw(&mut self, runtime: &Runtime, bytes: &[u8], window: Duration) -> Result<Vec<u8>, Failure> {
        let (unit, request) = match bytes {
            [unit, function @ 0x01..=0x7F, data @ ..] if bytes.len() <= LONGEST_REQUEST => {
                (*unit, Request::Custom(*function, data.to_vec().into()))
            }
            _ => {
                let reason =
                    "a Modbus TCP request is an address, a function from 01 to 7F and at most 252 bytes of data";
                return Err(Failure::NotOffered(reason.to_owned()));
            }
        };
        if self.last_used.elapsed() > FRESH {
            self.client = None;
        }
        let mut client = self.take_client(runtime, unit)?;
        let started = Instant::now();
        let answered =
            runtime.block_on(async { tokio::time::timeout(window + NETWORK_ALLOWANCE, client.call(request)).await });
        let heard = self.tap().received.clone();
        self.last_used = Instant::now();
        let outcome = match answered {
            Ok(Err(tokio_modbus::Error::Transport(error))) => Err(failure_of(&error)),
            // The header was that of the request; whether it is the function, the codec cannot tell here: for it one that
            // it was given as bytes is never one that it knows.
            Ok(Ok(_) | Err(tokio_modbus::Error::Protocol(ProtocolError::FunctionCodeMismatch { .. })))
                if answers(&heard, bytes) =>
            {
                self.answer_time = Some(started.elapsed());
                self.client = Some(client);
                Ok(heard.get(HEADER..).unwrap_or_default().to_vec())
            }
            Ok(_) => Err(Failure::Garbled { reason: "the answer is that to another request".to_owned(), bytes: heard }),
            Err(_) if heard.is_empty() => Err(Failure::Silent),
            Err(_) => Err(Failure::Cut { bytes: heard }),
        };
        self.tap().end(outcome.as_ref().err());
        outcome
    }

    fn take_client(&mut self, runtime: &Runtime, unit: u8) -> Result<ModbusContext, Failure> {
        self.tap().begin(unit);
        let mut client = match self.client.take() {
            Some(client) => client,
            None => self.open(runtime).map_err(Failure::LineLost)?,
        };
        client.set_slave(Slave(unit));
        Ok(client)
    }
}

/// Whether `frame` is of the module and function of `request`; an exception has the highest bit set.
fn answers(frame: &[u8], request: &[u8]) -> bool {
    let (Some([unit, function, ..]), [asked, wanted, ..]) = (frame.get(HEADER..), request) else { return false };
    unit == asked && function & 0x7F == *wanted
}

/// A gateway that says so for an absent module: nobody answered.
fn gateway_silence(reply: Result<Reply, Failure>) -> Result<Reply, Failure> {
    match reply {
        Err(Failure::Exception { code: 0x0A | 0x0B }) => Err(Failure::Silent),
        reply => reply,
    }
}

/// In words that say what happened; an answer that cannot be decoded is no loss of the line.
fn failure_of(error: &io::Error) -> Failure {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::InvalidData | Kind::InvalidInput => {
            Failure::Garbled { reason: format!("the answer cannot be decoded: {error}"), bytes: Vec::new() }
        }
        _ => Failure::LineLost(words_of(error)),
    }
}

fn words_of(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::UnexpectedEof
        | Kind::BrokenPipe
        | Kind::ConnectionReset
        | Kind::ConnectionAborted
        | Kind::NotConnected => "the module closed the connection".to_owned(),
        Kind::ConnectionRefused => "nothing listens at this port".to_owned(),
        Kind::HostUnreachable | Kind::NetworkUnreachable => "there is no way to this address".to_owned(),
        Kind::TimedOut => "no answer in time".to_owned(),
        _ => match error.to_string() {
            text if text.contains("lookup") => "the name is not known".to_owned(),
            text if text.contains("remaining on stream") => "the module closed the connection".to_owned(),
            text => text,
        },
    }
}

/// A stream whose bytes pass the tap.
#[derive(Debug)]
struct Tapped {
    stream: TcpStream,
    tap: Arc<Mutex<TimedTap>>,
}

impl std::fmt::Debug for TimedTap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("TimedTap")
    }
}

impl Tapped {
    fn tap(&self) -> MutexGuard<'_, TimedTap> {
        self.tap.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl AsyncRead for Tapped {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buffer: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let outcome = Pin::new(&mut self.stream).poll_read(cx, buffer);
        let bytes = buffer.filled().get(before..).unwrap_or_default();
        if !bytes.is_empty() {
            self.tap().received(bytes);
        }
        outcome
    }
}

impl AsyncWrite for Tapped {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let outcome = Pin::new(&mut self.stream).poll_write(cx, bytes);
        if let Poll::Ready(Ok(count)) = outcome {
            self.tap().sent(bytes.get(..count).unwrap_or_default());
        }
        outcome
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
