//! The simulated wire: time, faults and what several modules do to each other.

use std::time::{Duration, Instant};

use dcon_bench::bus::line::{Line, LineLost};
use dcon_bench::protocol::{BaudRate, DataFormat, LineSettings};
use dcon_bench::sim::{DEMO, ModuleSpec, Pace, Sim, SimLine};

fn world(specs: &[&str]) -> (Sim, SimLine) {
    let specs: Vec<_> = specs.iter().map(|spec| spec.parse().unwrap()).collect();
    let sim = Sim::new(&specs, Pace::Skip);
    let line = sim.line();
    (sim, line)
}

/// One `receive` that may take up to `wait`.
fn receive(line: &mut SimLine, wait: Duration) -> Vec<u8> {
    let mut buffer = [0; 256];
    let deadline = line.now() + wait;
    let count = line.receive(&mut buffer, deadline).unwrap();
    buffer[..count].to_vec()
}

fn receive_all(line: &mut SimLine) -> Vec<u8> {
    let mut all = Vec::new();
    loop {
        match receive(line, ms(300)) {
            some if some.is_empty() => return all,
            some => all.extend(some),
        }
    }
}

fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// The skipping clock also runs by itself, a little.
#[track_caller]
fn assert_about(elapsed: Duration, expected: Duration) {
    assert!(elapsed >= expected && elapsed < expected + ms(20), "{elapsed:?} is not about {expected:?}");
}

#[test]
fn an_answer_takes_its_wire_time_the_turnaround_and_the_response_delay() {
    let (_, mut line) = world(&["pir-130@1:dcon:1200"]);
    let slow = LineSettings { baud_rate: BaudRate::new(1200).unwrap(), data_format: DataFormat::N81 };
    line.configure(slow).unwrap();
    line.send(b"~01RD1E\r").unwrap();
    assert_eq!(receive_all(&mut line), b"!01\r");
    let start = line.now();
    line.send(b"$01M\r").unwrap();
    assert_eq!(receive(&mut line, ms(500)), b"!01PIR130\r");
    assert_about(line.now() - start, slow.wire_time(5 + 10) + ms(5) + ms(30));
}

#[test]
fn bytes_come_in_lumps_of_a_receive_fifo() {
    let (sim, mut line) = world(&["pir-234@1:dcon"]);
    sim.set_temperature(1, 30.0);
    sim.set_humidity(1, 50.0);
    line.send(b"#01\r").unwrap();
    assert_eq!(receive(&mut line, ms(200)), b">+030.00+086.0");
    assert_eq!(receive(&mut line, ms(200)), b"0+050.00\r");
}

#[test]
fn a_deadline_cuts_a_lump_short_and_a_past_one_gives_what_is_there() {
    let (_, mut line) = world(&["pir-130@1:dcon"]);
    let start = line.now();
    line.send(b"$01M\r").unwrap();
    let settings = LineSettings::default();
    let mut buffer = [0; 64];
    let third = start + settings.wire_time(5 + 3) + ms(6);
    let count = line.receive(&mut buffer, third).unwrap();
    assert!((3..=5).contains(&count), "{count}");
    line.wait_until(start + ms(100));
    let count = count + line.receive(&mut buffer[count..], start).unwrap();
    assert_eq!(&buffer[..count], b"!01PIR130\r");
    assert_eq!(line.receive(&mut buffer, start).unwrap(), 0);
}

#[test]
fn a_purge_drops_what_has_arrived_and_not_what_is_late() {
    let (sim, mut line) = world(&["pir-130@1:dcon"]);
    line.send(b"$01M\r").unwrap();
    sim.advance(ms(100));
    line.purge().unwrap();
    assert_eq!(receive_all(&mut line), b"");
    line.send(b"$01M\r").unwrap();
    line.purge().unwrap();
    assert_eq!(receive_all(&mut line), b"!01PIR130\r");
}

#[test]
fn a_late_answer_comes_before_the_answer_to_the_next_request() {
    let (sim, line) = world(&["pir-130@1:dcon", "pir-234@2:dcon"]);
    let sim = sim.with_turnaround(ms(50));
    drop(line);
    let mut line = sim.line();
    line.send(b"$01M\r").unwrap();
    assert_eq!(receive(&mut line, ms(30)), b"");
    line.send(b"$02M\r").unwrap();
    assert_eq!(receive_all(&mut line), b"!01PIR130\r!02PIR234\r");
}

#[test]
fn a_module_hears_only_its_own_speed_and_format() {
    let (sim, mut line) = world(&["pir-130@1:dcon:19200:e81"]);
    for (bps, data_format, answered) in
        [(9600, DataFormat::E81, false), (19_200, DataFormat::N81, false), (19_200, DataFormat::E81, true)]
    {
        line.configure(LineSettings { baud_rate: BaudRate::new(bps).unwrap(), data_format }).unwrap();
        line.send(b"$01M\r").unwrap();
        assert_eq!(!receive_all(&mut line).is_empty(), answered, "{bps} {data_format}");
    }
    assert_eq!(sim.requests(), 3);
}

#[test]
fn an_echo_comes_first() {
    let (sim, mut line) = world(&["pir-130@1:dcon"]);
    sim.set_echo(true);
    line.send(b"$01M\r").unwrap();
    assert_eq!(receive_all(&mut line), b"$01M\r!01PIR130\r");
}

#[test]
fn noise_surrounds_each_answer() {
    let (sim, mut line) = world(&["pir-130@1:dcon"]);
    sim.set_noise(&[0x00], &[0xFF, 0xFF]);
    line.send(b"$01M\r").unwrap();
    assert_eq!(receive_all(&mut line), b"\x00!01PIR130\r\xff\xff");
    line.send(b"$02M\r").unwrap();
    assert_eq!(receive_all(&mut line), b"");
}

#[test]
fn a_dead_module_is_silent_until_it_lives_again() {
    let (sim, mut line) = world(&["pir-130@1:dcon"]);
    sim.set_dead(1, true);
    line.send(b"~01RD1E\r").unwrap();
    assert_eq!(receive_all(&mut line), b"");
    sim.set_dead(1, false);
    line.send(b"~01RD\r").unwrap();
    assert_eq!(receive_all(&mut line), b"!0100\r");
}

#[test]
fn two_modules_at_one_address_spoil_each_others_answer() {
    let (_, mut line) = world(&["pir-130@1:dcon", "pir-234@1:dcon"]);
    line.send(b"$01M\r").unwrap();
    let answer = receive_all(&mut line);
    assert!(answer.starts_with(b"!01PIR") && answer != b"!01PIR130\r" && answer != b"!01PIR234\r", "{answer:?}");
}

#[test]
fn an_unplugged_adapter_is_lost_for_every_call() {
    let (sim, mut line) = world(&["pir-130@1:dcon"]);
    line.send(b"$01M\r").unwrap();
    sim.unplug();
    let lost = |result: Result<(), LineLost>| assert!(result.unwrap_err().to_string().contains("unplugged"));
    lost(line.send(b"$01M\r"));
    lost(line.purge());
    lost(line.configure(LineSettings::default()));
    let deadline = line.now() + ms(10);
    lost(line.receive(&mut [0; 8], deadline).map(drop));
    sim.plug();
    assert_eq!(receive_all(&mut line), b"", "what was under way is lost");
    line.send(b"$01M\r").unwrap();
    assert_eq!(receive_all(&mut line), b"!01PIR130\r");
}

#[test]
fn a_skipping_clock_does_not_wait() {
    let (_, mut line) = world(&["pir-130@1:dcon"]);
    let (real, simulated) = (Instant::now(), line.now());
    line.wait_until(simulated + Duration::from_secs(3600));
    assert_eq!(receive(&mut line, Duration::from_secs(3600)), b"");
    assert!(line.now() - simulated >= Duration::from_secs(7200));
    assert!(real.elapsed() < Duration::from_secs(5));
}

#[test]
fn a_real_clock_waits() {
    let spec: ModuleSpec = "pir-130@1:dcon".parse().unwrap();
    let mut line = Sim::new(&[spec], Pace::Real).line();
    let start = Instant::now();
    line.send(b"$01M\r").unwrap();
    assert_eq!(receive(&mut line, ms(500)), b"!01PIR130\r");
    let least = LineSettings::default().wire_time(15) + ms(5);
    assert!(start.elapsed() >= least, "{:?}", start.elapsed());
}

#[test]
fn the_demo_has_the_modules_it_says() {
    let sim = Sim::demo();
    for text in DEMO {
        let spec: ModuleSpec = text.parse().unwrap();
        assert_eq!(sim.setting(spec.address, "address"), Some(spec.address.to_string()), "{text}");
    }
}
