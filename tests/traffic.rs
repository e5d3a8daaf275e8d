//! What the tap tells of each exchange, on simulated lines.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use dcon_bench::bench::traffic::TrafficLog;
use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::line::{Line, LineLost};
use dcon_bench::bus::transaction::Wire;
use dcon_bench::bus::{Direction, Frame, LineAddress, Patience, RawRequest, Target, Verdict};
use dcon_bench::module::Ask;
use dcon_bench::protocol::{Failure, LineSettings, Protocol, Query};
use dcon_bench::sim::{ModuleSpec, Pace, Sim, SimLine, TcpServer};

const WINDOW: Duration = Duration::from_millis(60);

type Frames = Arc<Mutex<Vec<Frame>>>;

fn simulated(spec: &str) -> Sim {
    let spec: ModuleSpec = spec.parse().expect("a specification");
    Sim::new(&[spec], Pace::Skip)
}

fn tapped(line: impl Line + 'static) -> (Dialogue, Frames) {
    let frames = Frames::default();
    let seen = frames.clone();
    let tap = Box::new(move |frame| seen.lock().expect("a lock").push(frame));
    let wire = Wire::new(Box::new(line), LineSettings::default(), tap).expect("a line");
    (Dialogue::on_wire(wire).expect("a dialogue"), frames)
}

fn dcon(text: &str) -> RawRequest {
    RawRequest::Dcon { text: text.to_owned(), checksum: false }
}

fn rtu(bytes: &[u8]) -> RawRequest {
    RawRequest::Modbus { bytes: bytes.to_vec() }
}

fn taken(frames: &Frames) -> Vec<Frame> {
    std::mem::take(&mut *frames.lock().expect("a lock"))
}

#[test]
fn a_request_takes_its_wire_time_and_an_answer_counts_from_the_requests_end() {
    let (mut dialogue, frames) = tapped(simulated("pir-234@1:modbus_rtu").line());
    dialogue.raw(&rtu(&[1, 4, 0, 0, 0, 5]), WINDOW).expect("an answer");
    let frames = taken(&frames);
    let [request, answer] = frames.as_slice() else { panic!("{frames:?}") };
    assert_eq!(request.verdict, Verdict::Request);
    assert_eq!(request.took, Duration::from_nanos(80 * 1_000_000_000 / 9_600));
    assert_eq!((request.protocol, request.address, request.direction), (Protocol::ModbusRtu, Some(1), Direction::Sent));
    assert_eq!((answer.verdict.clone(), answer.address), (Verdict::Answer, Some(1)));
    assert!(answer.took >= LineSettings::default().wire_time(15), "{:?}", answer.took);
    let between = Duration::try_from(answer.at.duration_since(request.at)).expect("a time");
    assert_eq!(between, request.took + answer.took);
}

#[test]
fn silence_is_a_frame_without_bytes_that_lasts_until_giving_up() {
    let (mut dialogue, frames) = tapped(simulated("pir-234@1:dcon").line());
    assert_eq!(dialogue.raw(&dcon("$02M"), WINDOW), Err(Failure::Silent));
    let frames = taken(&frames);
    let [_, silence] = frames.as_slice() else { panic!("{frames:?}") };
    assert_eq!((silence.verdict.clone(), silence.bytes.as_slice()), (Verdict::Silent, &b""[..]));
    assert_eq!((silence.direction, silence.address), (Direction::Received, Some(2)));
    // The simulated clock runs on while the program computes.
    assert!((WINDOW..WINDOW * 2).contains(&silence.took), "{:?}", silence.took);
}

#[test]
fn refusals_are_told_apart_from_answers_in_both_protocols() {
    let (mut dialogue, frames) = tapped(simulated("pir-234@1:modbus_rtu").line());
    dialogue.raw(&rtu(&[1, 3, 0x77, 0, 0, 1]), WINDOW).expect("an exception");
    let (mut other, more) = tapped(simulated("pir-234@1:dcon").line());
    other.raw(&dcon("~01RDFF"), WINDOW).expect("a refusal");
    for frames in [taken(&frames), taken(&more)] {
        assert_eq!(frames.last().map(|frame| frame.verdict.clone()), Some(Verdict::Refusal), "{frames:?}");
    }
}

/// Spoils the last byte of what comes back.
struct Spoiling(SimLine);

impl Line for Spoiling {
    fn configure(&mut self, settings: LineSettings) -> Result<(), LineLost> {
        self.0.configure(settings)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        self.0.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        let count = self.0.receive(buffer, deadline)?;
        if let Some(last) = count.checked_sub(1) {
            buffer[last] ^= 0x10;
        }
        Ok(count)
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.0.purge()
    }

    fn look(&mut self) -> Result<(), LineLost> {
        self.0.look()
    }

    fn now(&self) -> Instant {
        self.0.now()
    }

    fn wait_until(&mut self, instant: Instant) {
        self.0.wait_until(instant);
    }
}

#[test]
fn a_wrong_crc_is_a_broken_answer_with_its_bytes() {
    let (mut dialogue, frames) = tapped(Spoiling(simulated("pir-234@1:modbus_rtu").line()));
    dialogue.raw(&rtu(&[1, 4, 0, 0, 0, 1]), WINDOW).expect_err("a spoiled answer");
    let frames = taken(&frames);
    let broken = frames.last().expect("a frame");
    assert!(matches!(&broken.verdict, Verdict::Broken(reason) if reason.contains("CRC")), "{broken:?}");
    assert_eq!(broken.bytes.len(), 7);
}

#[test]
fn a_broadcast_has_no_address_and_no_answer_is_missed() {
    let (mut dialogue, frames) = tapped(simulated("pir-234@1:dcon").line());
    dialogue.raw(&dcon("~**"), WINDOW).expect("nothing");
    dialogue.raw(&rtu(&[0, 6, 2, 0, 0, 1]), WINDOW).expect("nothing");
    let seen: Vec<_> = taken(&frames).into_iter().map(|frame| (frame.protocol, frame.address, frame.verdict)).collect();
    let expected = [(Protocol::Dcon, None, Verdict::Request), (Protocol::ModbusRtu, None, Verdict::Request)];
    assert_eq!(seen, expected);
}

#[test]
fn an_echo_alone_is_silence_that_shows_the_echo() {
    let sim = simulated("pir-234@1:dcon");
    sim.set_echo(true);
    let (mut dialogue, frames) = tapped(sim.line());
    assert_eq!(dialogue.raw(&dcon("$02M"), WINDOW), Err(Failure::Silent));
    let frames = taken(&frames);
    let silence = frames.last().expect("a frame");
    assert_eq!((silence.verdict.clone(), silence.bytes.as_slice()), (Verdict::Silent, &b"$02M\r"[..]));
}

#[test]
fn answers_in_the_log_find_their_requests() {
    let (mut dialogue, frames) = tapped(simulated("pir-234@1:dcon").line());
    for text in ["$01M", "$02M", "#01", "$012"] {
        let _ = dialogue.raw(&dcon(text), WINDOW);
    }
    let mut log = TrafficLog::default();
    taken(&frames).into_iter().for_each(|frame| log.push(frame));
    assert_eq!(log.len(), 8);
    for seq in [1, 3, 5, 7] {
        assert_eq!(log.request_of(seq).map(|request| request.seq), Some(seq - 1), "{:?}", log.get(seq));
    }
    assert_eq!(log.get(4).and_then(|frame| frame.address), Some(1));
}

#[test]
fn exchanges_over_tcp_are_told_whole_with_their_headers() {
    let spec: ModuleSpec = "pir-234@1:modbus_rtu".parse().expect("a specification");
    let sim = Sim::new(&[spec], Pace::Real);
    let server = TcpServer::bind(&sim, "127.0.0.1:0".parse().expect("an address")).expect("a server");
    let line = LineAddress::tcp(&server.address().to_string()).expect("an address");
    let frames = Frames::default();
    let seen = frames.clone();
    let tap = Box::new(move |frame| seen.lock().expect("a lock").push(frame));
    let mut dialogue = Dialogue::open(&line, LineSettings::default(), tap).expect("an open line");
    let target =
        Target { address: 1, protocol: Protocol::ModbusTcp, settings: LineSettings::default(), checksum: false };
    let mut speaker = dialogue.with(target, Patience::scan(WINDOW));
    speaker.ask(&Query::ReadInputRegisters { first: 0, count: 5 }).expect("an answer");
    speaker.ask(&Query::ReadHoldingRegisters { first: 0x7700, count: 1 }).expect_err("an exception");
    let frames = taken(&frames);
    let verdicts: Vec<_> = frames.iter().map(|frame| frame.verdict.clone()).collect();
    assert_eq!(verdicts, [Verdict::Request, Verdict::Answer, Verdict::Request, Verdict::Refusal]);
    assert_eq!(frames[1].bytes.len(), 7 + 2 + 10);
    assert!(frames.iter().all(|frame| frame.protocol == Protocol::ModbusTcp && frame.address == Some(1)));
    let mut log = TrafficLog::default();
    frames.into_iter().for_each(|frame| log.push(frame));
    assert!(log.request_of(1).is_some() && log.request_of(3).is_some());
}
