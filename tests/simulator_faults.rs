//! Faults of the simulated line: each can be seen, is counted, ends, and never makes a right frame that nobody sent.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use dcon_bench::bus::line::{Line, LineLost};
use dcon_bench::protocol::{BaudRate, LineSettings, dcon, modbus};
use dcon_bench::sim::{Fault, FaultKind, Faults, ModuleSpec, Pace, Sim, SimLine, Strength};
use proptest::prelude::*;

const SPECS: [&str; 3] = ["pir-234@1:modbus_rtu", "pir-130@0xA0:dcon:checksum", "pir-234@0xA3:dcon"];

fn world(pace: Pace) -> (Sim, SimLine) {
    let specs: Vec<ModuleSpec> = SPECS.iter().map(|spec| spec.parse().unwrap()).collect();
    let sim = Sim::new(&specs, pace);
    for address in [1, 0xA0, 0xA3] {
        sim.set_temperature(address, 30.0);
        sim.set_humidity(address, 50.0);
    }
    let line = sim.line();
    (sim, line)
}

fn read() -> Vec<u8> {
    modbus::with_crc(&[1, 4, 0, 0, 0, 5])
}

/// What comes within two seconds.
fn ask(line: &mut SimLine, request: &[u8]) -> Result<Vec<u8>, LineLost> {
    line.purge()?;
    line.send(request)?;
    let until = line.now() + Duration::from_secs(2);
    let (mut all, mut buffer) = (Vec::new(), [0; 256]);
    while line.now() < until {
        let count = line.receive(&mut buffer, until)?;
        all.extend(&buffer[..count]);
    }
    Ok(all)
}

fn with(sim: &Sim, faults: &[&str]) {
    sim.set_faults(faults.iter().map(|fault| fault.parse::<Fault>().unwrap()).collect());
}

fn strong(kind: FaultKind) -> Fault {
    let strength = match kind.default_strength() {
        Strength::Rate(_) => {
            Strength::Rate(if kind.label().contains("bytes") || kind == FaultKind::Flipped { 0.3 } else { 1.0 })
        }
        other => other,
    };
    Fault { kind, strength }
}

#[test]
fn each_fault_can_be_seen_is_counted_and_ends() {
    for kind in FaultKind::ALL {
        let (sim, mut line) = world(Pace::Skip);
        let right = ask(&mut line, &read()).unwrap();
        assert_eq!(right.len(), 15);
        assert!(sim.injected().is_empty());

        sim.set_faults([strong(kind)].into_iter().collect());
        let before = line.now();
        line.purge().ok();
        let sent = line.send(&read());
        let mut first = [0; 1];
        let until = line.now() + Duration::from_millis(200);
        let soon = line.receive(&mut first, until);
        let took = line.now() - before;
        let heard = ask(&mut line, &read());
        let wrong = match kind {
            FaultKind::Late => sent.is_ok() && soon == Ok(0) && took >= Duration::from_millis(200),
            FaultKind::BlockedWrite => sent.is_err(),
            FaultKind::Unplugged | FaultKind::Renamed => heard.is_err(),
            FaultKind::ClockJump => line.wall().duration_since(jiff::Timestamp::now()).as_secs() >= 3_590,
            _ => heard.as_ref().is_ok_and(|heard| *heard != right),
        };
        assert!(wrong, "{kind:?}: {heard:?}");
        let injected = sim.injected();
        assert!(injected.get(&kind).is_some_and(|&count| count > 0), "{kind:?}: {injected:?}");
        assert_eq!(injected.len(), 1, "{kind:?}: {injected:?}");

        sim.set_faults(Faults::default());
        line.wait_until(line.now() + Duration::from_secs(2));
        let count = sim.injected();
        assert_eq!(ask(&mut line, &read()), Ok(right), "{kind:?}");
        assert!(line.wall().duration_since(jiff::Timestamp::now()).as_secs() < 10);
        assert_eq!(sim.injected(), count, "{kind:?}");
    }
}

#[test]
fn what_an_answer_looks_like_under_each_fault() {
    let (sim, mut line) = world(Pace::Skip);
    let right = ask(&mut line, &read()).unwrap();
    with(&sim, &["echo"]);
    assert_eq!(ask(&mut line, &read()).unwrap(), [read(), right.clone()].concat());
    with(&sim, &["partial_echo"]);
    let heard = ask(&mut line, &read()).unwrap();
    let echo = heard.strip_suffix(right.as_slice()).unwrap();
    assert!(read().starts_with(echo) && (1..8).contains(&echo.len()));
    with(&sim, &["doubled=100%"]);
    assert_eq!(ask(&mut line, &read()).unwrap(), right.repeat(2));
    with(&sim, &["cut=100%"]);
    let heard = ask(&mut line, &read()).unwrap();
    assert!(right.starts_with(&heard) && (1..15).contains(&heard.len()));
    with(&sim, &["wrong_address=100%"]);
    let heard = ask(&mut line, &read()).unwrap();
    assert_eq!(modbus::with_crc(&heard[..13]), heard);
    assert!(heard[0] != 1 && heard[1..13] == right[1..13]);
    let heard = ask(&mut line, b"$A3M\r").unwrap();
    assert!(heard.starts_with(b"!") && !heard.starts_with(b"!A3") && heard.ends_with(b"PIR234\r"));
    assert_eq!(ask(&mut line, b"#A3\r").unwrap()[0], b'>');
    let heard = ask(&mut line, &dcon::encode("$A0M", true)).unwrap();
    assert!(!heard.starts_with(b"!A0") && dcon::decode(&heard, true).is_ok());
    with(&sim, &["wrong_checksum=100%"]);
    let heard = ask(&mut line, &read()).unwrap();
    assert!(heard[..13] == right[..13] && heard[13..] != right[13..]);
    assert_eq!(ask(&mut line, b"$A3M\r").unwrap(), b"!A3PIR234\r");
    assert!(dcon::decode(&ask(&mut line, &dcon::encode("$A0M", true)).unwrap(), true).is_err());
    with(&sim, &["noise=100%"]);
    let heard = ask(&mut line, &read()).unwrap();
    assert!(heard.len() > 15 && heard.windows(15).any(|part| part == right));
}

#[test]
fn twins_collide_or_answer_one_after_the_other() {
    let (sim, mut line) = world(Pace::Skip);
    let right = ask(&mut line, &read()).unwrap();
    with(&sim, &["twin=1"]);
    for _ in 0..200 {
        let heard = ask(&mut line, &read()).unwrap();
        assert!(!heard.windows(15).any(|part| part == right), "{heard:02X?}");
    }
    let name = ask(&mut line, b"$A3M\r").unwrap();
    assert_eq!(name, b"!A3PIR234\r");

    let specs: Vec<ModuleSpec> = vec!["pir-234@1:modbus_rtu:115200".parse().unwrap()];
    let sim = Sim::new(&specs, Pace::Skip);
    let mut line = sim.line();
    line.configure(LineSettings { baud_rate: BaudRate::new(115_200).unwrap(), ..LineSettings::default() }).unwrap();
    with(&sim, &["twin=1"]);
    let apart = (0..50).map(|_| ask(&mut line, &read()).unwrap()).filter(|heard| heard.len() == 30).count();
    assert!(apart > 0);
}

#[test]
fn a_wrong_speed_concerns_that_speed_only() {
    let (sim, mut line) = world(Pace::Skip);
    with(&sim, &["wrong_speed=19200"]);
    assert_eq!(ask(&mut line, &read()).unwrap().len(), 15);
    line.configure(LineSettings { baud_rate: BaudRate::new(19_200).unwrap(), ..LineSettings::default() }).unwrap();
    assert!(!ask(&mut line, b"?").unwrap().is_empty());
}

#[test]
fn an_adapter_comes_back_under_another_name() {
    let (sim, mut line) = world(Pace::Skip);
    assert_eq!(sim.adapters()[0].name, "SIM1");
    with(&sim, &["renamed"]);
    assert_eq!(sim.adapters()[0].name, "SIM2");
    assert!(line.look().is_err() && line.send(b"$A3M\r").is_err());
    assert!(sim.line_on("SIM1").is_err());
    let mut new = sim.line_on("SIM2").unwrap();
    assert_eq!(ask(&mut new, b"$A3M\r").unwrap(), b"!A3PIR234\r");
    assert!(sim.line().look().is_ok());
    with(&sim, &["unplugged"]);
    assert!(sim.adapters().is_empty() && sim.line_on("SIM1").is_err() && sim.line().look().is_err());
    with(&sim, &[]);
    assert!(line.look().is_ok() && new.look().is_err());
    assert_eq!(sim.injected()[&FaultKind::Renamed], 3);
}

#[test]
fn a_blocked_write_goes_on_as_soon_as_the_port_takes_bytes_again() {
    let (sim, mut line) = world(Pace::Real);
    with(&sim, &["blocked_write"]);
    let writer = std::thread::spawn(move || {
        let sent = line.send(b"$A3M\r");
        (sent, Instant::now())
    });
    while sim.injected().is_empty() {
        std::thread::yield_now();
    }
    let freed = Instant::now();
    with(&sim, &[]);
    let (sent, at) = writer.join().unwrap();
    assert_eq!(sent, Ok(()));
    assert!(at - freed < Duration::from_millis(500));
}

#[test]
fn a_blocked_write_gives_up_after_two_seconds_of_the_line() {
    let (sim, mut line) = world(Pace::Skip);
    with(&sim, &["blocked_write"]);
    let start = line.now();
    assert!(line.send(b"$A3M\r").unwrap_err().reason.contains("takes no bytes"));
    assert!(line.now() - start >= Duration::from_secs(2));
}

#[test]
fn nobody_in_a_hurry_waits_for_a_blocked_write() {
    let (sim, mut line) = world(Pace::Real);
    with(&sim, &["blocked_write"]);
    line.hurry_by(Arc::new(AtomicBool::new(true)));
    let start = line.now();
    assert!(line.send(b"$A3M\r").unwrap_err().reason.contains("takes no bytes"));
    assert!(line.now() - start < Duration::from_secs(1));
}

#[test]
fn the_same_seed_does_the_same_damage() {
    let heard = |seed| {
        let (sim, mut line) = world(Pace::Skip);
        let sim = sim.with_seed(seed);
        with(&sim, &["flipped=5%", "lost=5%", "inserted=5%", "noise=50%", "cut=20%", "doubled=20%"]);
        (0..30).map(|_| ask(&mut line, &read()).unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(heard(5), heard(5));
    assert_ne!(heard(5), heard(6));
}

#[test]
fn a_fault_in_words_reads_back_and_a_wrong_word_says_what_is_allowed() {
    for kind in FaultKind::ALL {
        let fault = strong(kind);
        assert_eq!(fault.to_string().parse(), Ok(fault));
        assert_eq!(kind.word().parse(), Ok(Fault { kind, strength: kind.default_strength() }));
    }
    for (text, hint) in [
        ("flippd", "flipped, lost"),
        ("echo=1", "on or off"),
        ("flipped=200%", "up to 100%"),
        ("flipped=NaN", "up to 100%"),
        ("twin=A3", "0xA3"),
        ("wrong_speed=300", "9600"),
        ("clock_jump=99999999999", "ten years"),
    ] {
        let error = text.parse::<Fault>().unwrap_err().to_string();
        assert!(error.contains(hint), "{text}: {error}");
    }
}

/// Every frame with a right CRC that a reader could find.
fn rtu_frames(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let spans = (0..bytes.len())
        .filter(|&start| bytes[start] == 1)
        .flat_map(move |start| (start + 4..=bytes.len()).map(move |end| (start, end)));
    spans.map(|(start, end)| &bytes[start..end]).filter(|frame| modbus::with_crc(&frame[..frame.len() - 2]) == *frame)
}

/// Every frame with a right checksum that a reader could find.
fn dcon_frames(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let starts = (0..bytes.len()).filter(|&start| b"!?>".contains(&bytes[start]));
    let frames =
        starts.filter_map(|start| Some(&bytes[start..=start + bytes[start..].iter().position(|&byte| byte == b'\r')?]));
    frames.filter(|frame| dcon::decode(frame, true).is_ok())
}

#[test]
fn no_damage_makes_a_right_frame_that_nobody_sent() {
    let (sim, mut line) = world(Pace::Skip);
    let request = dcon::encode("$A0M", true);
    let (rtu, text) = (ask(&mut line, &read()).unwrap(), ask(&mut line, &request).unwrap());
    with(
        &sim,
        &[
            "flipped=10%",
            "lost=3%",
            "inserted=10%",
            "noise=50%",
            "cut=20%",
            "doubled=20%",
            "wrong_checksum=20%",
            "partial_echo",
        ],
    );
    let mut damaged = 0;
    for round in 0..6_000 {
        let heard = ask(&mut line, &read()).unwrap();
        damaged += usize::from(heard != rtu);
        assert!(rtu_frames(&heard).all(|frame| frame == rtu || frame == read()), "{round}: {heard:02X?}");
        let heard = ask(&mut line, &request).unwrap();
        assert!(dcon_frames(&heard).all(|frame| frame == text), "{round}: {}", heard.escape_ascii());
    }
    assert!(damaged > 5_000);
}

#[test]
fn no_damage_to_a_request_makes_another_right_one() {
    let (sim, mut line) = world(Pace::Skip);
    with(&sim, &["flipped=20%", "inserted=10%"]);
    let write = modbus::with_crc(&[1, 6, 2, 0, 0, 10]);
    let changed = dcon::encode("~A0RD05", true);
    for _ in 0..3_000 {
        ask(&mut line, &write).unwrap();
        ask(&mut line, &changed).unwrap();
    }
    assert!(["0", "5"].contains(&sim.setting(0xA0, "response_delay").unwrap().as_str()));
}

fn any_fault() -> impl Strategy<Value = Fault> {
    let kind = prop::sample::select(&FaultKind::ALL[..]);
    (kind, 0.0..=1.0, any::<u8>(), prop::sample::select(&BaudRate::ALL[..]), -300_000_000_i64..300_000_000).prop_map(
        |(kind, rate, address, speed, seconds)| {
            let strength = match kind.default_strength() {
                Strength::On => Strength::On,
                Strength::Rate(_) => Strength::Rate(rate),
                Strength::Address(_) => Strength::Address(if address < 128 { 1 } else { address }),
                Strength::Speed(_) => Strength::Speed(speed),
                Strength::Seconds(_) => Strength::Seconds(seconds),
            };
            Fault { kind, strength }
        },
    )
}

fn any_request() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..40),
        Just(read()),
        Just(modbus::with_crc(&[1, 4, 0, 0, 0, 125])),
        Just(b"#A3\r".to_vec()),
        Just(dcon::encode("$A0M", true)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn no_mixture_of_faults_makes_it_panic_or_send_without_end(
        faults in prop::collection::vec(any_fault(), 0..8),
        requests in prop::collection::vec(any_request(), 1..12),
        seed: u64,
    ) {
        let (sim, mut line) = world(Pace::Skip);
        let sim = sim.with_seed(seed);
        let faults: Faults = faults.into_iter().collect();
        sim.set_faults(faults.clone());
        prop_assert_eq!(sim.faults(), faults);
        let mut buffer = [0; 256];
        for request in requests {
            let _ = line.send(&request);
            let until = line.now() + Duration::from_millis(100);
            let _ = line.receive(&mut buffer, until);
            let _ = line.wall();
        }
        sim.set_faults(Faults::default());
        line.wait_until(line.now() + Duration::from_secs(60));
        let mut left = 0;
        loop {
            let now = line.now();
            match line.receive(&mut buffer, now) {
                Ok(0) | Err(_) => break,
                Ok(count) => left += count,
            }
        }
        prop_assert!(left <= 16_384);
    }
}
