//! How much of a line's capacity the program uses, on the simulated line in real time.
//!
//! `cargo bench --bench line_time` prints, for each speed, what a silent address costs against its wire time and
//! listening window, and the period of polls against the shortest that the wire allows: both frames, the module's
//! turnaround and the silence before a Modbus frame. On a machine whose scheduler holds the thread up now and then, the
//! mean shows the machine and the median the program.

use std::sync::Arc;
use std::time::{Duration, Instant};

use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::{Bus, BusCommand, BusEvent, Direction, ItemSet, LineAddress, ScanPlan, Target};
use dcon_bench::module::Catalogue;
use dcon_bench::protocol::{BaudRate, DataFormat, LineSettings, Protocol};
use dcon_bench::sim::{ModuleSpec, Pace, Sim};
use jiff::Timestamp;

const TURNAROUND: Duration = Duration::from_millis(5);

fn settings(bps: u32) -> LineSettings {
    LineSettings { baud_rate: BaudRate::new(bps).expect("a baud rate"), data_format: DataFormat::N81 }
}

fn open(spec: &str) -> (Sim, ModuleSpec) {
    let spec: ModuleSpec = spec.parse().expect("a specification");
    (Sim::new(std::slice::from_ref(&spec), Pace::Real).with_turnaround(TURNAROUND), spec)
}

fn bus(sim: &Sim, settings: LineSettings) -> (Bus, Arc<Catalogue>) {
    let catalogue = Arc::new(Catalogue::built_in().0);
    let bus = Bus::start(catalogue.clone(), || {}).expect("a thread");
    let line = LineAddress::Simulated { label: "bench".into(), sim: sim.clone() };
    let id = bus.next_id();
    bus.send(BusCommand::Open { id, line, settings }).expect("room");
    (bus, catalogue)
}

/// Starts of requests on the line, in order.
fn starts(bus: &Bus, until: impl Fn(&BusEvent, usize) -> bool) -> Vec<Timestamp> {
    let mut starts = Vec::new();
    loop {
        let event = bus.wait_event(Duration::from_secs(60)).expect("a living thread").expect("an event");
        if until(&event, starts.len()) {
            return starts;
        }
        match event {
            BusEvent::Traffic(frame) if frame.direction == Direction::Sent => starts.push(frame.at),
            BusEvent::Read { values, .. } => assert!(values.iter().all(|answer| answer.result.is_ok())),
            _ => {}
        }
    }
}

/// Median and mean of the times between.
fn periods(starts: &[Timestamp]) -> (f64, f64) {
    let mut periods: Vec<f64> = starts.windows(2).map(|pair| pair[1].duration_since(pair[0]).as_secs_f64()).collect();
    periods.sort_by(f64::total_cmp);
    (periods[periods.len() / 2], periods.iter().sum::<f64>() / periods.len() as f64)
}

/// Median and mean cost of a silent address, and what its wire time and window are.
fn silent_address(bps: u32, protocol: Protocol) -> (f64, f64, f64) {
    let (sim, _) = open("pir-234@1");
    let (bus, _) = bus(&sim, settings(bps));
    let plan = ScanPlan {
        addresses: (200..240).collect(),
        baud_rates: vec![settings(bps).baud_rate],
        protocols: vec![protocol],
        ..ScanPlan::quick()
    };
    let ideal = plan.cost(&plan.targets()[0]).as_secs_f64();
    let id = bus.next_id();
    bus.send(BusCommand::Scan { id, plan }).expect("room");
    let (median, mean) = periods(&starts(&bus, |event, _| matches!(event, BusEvent::ScanEnded { .. })));
    (median, mean, ideal)
}

/// Median and mean period of polls of five registers, and the shortest that the wire allows.
fn polls(bps: u32) -> (f64, f64, f64) {
    let (sim, spec) = open(&format!("pir-234@1:modbus_rtu:{bps}"));
    let (bus, catalogue) = bus(&sim, spec.settings);
    let definition = catalogue.get("pir-234").expect("a definition");
    let target = Target { address: 1, protocol: Protocol::ModbusRtu, settings: spec.settings, checksum: false };
    let names = ["temperature_c", "temperature_f", "humidity", "dew_point_c", "dew_point_f"];
    let items = ItemSet::Named(names.map(str::to_owned).to_vec());
    let id = bus.next_id();
    bus.send(BusCommand::Watch { id, target, definition, items, interval: Duration::ZERO }).expect("room");
    let (median, mean) = periods(&starts(&bus, |_, count| count > if bps < 9600 { 20 } else { 200 }));
    let line = spec.settings;
    let shortest = line.wire_time(8) + line.wire_time(15) + TURNAROUND + line.frame_silence();
    (median, mean, shortest.as_secs_f64())
}

/// Without waiting: what one transaction costs the processor, the simulated module's share included.
fn processor_time() -> Duration {
    let spec: ModuleSpec = "pir-234@1".parse().expect("a specification");
    let sim = Sim::new(std::slice::from_ref(&spec), Pace::Skip);
    let line = LineAddress::Simulated { label: "bench".into(), sim };
    let mut dialogue = Dialogue::open(&line, spec.settings, Box::new(|_| {})).expect("a line");
    let target = Target { address: 1, protocol: Protocol::ModbusRtu, settings: spec.settings, checksum: false };
    let query = dcon_bench::protocol::Query::ReadHoldingRegisters { first: 0, count: 5 };
    let rounds = 20_000;
    let started = Instant::now();
    for _ in 0..rounds {
        use dcon_bench::module::Ask;
        dialogue.with(target, dcon_bench::bus::Patience::POLL).ask(&query).expect("an answer");
    }
    started.elapsed() / rounds
}

fn main() {
    println!("cost of a silent address: ms, and what it is above wire time and window");
    println!("{:>8}  {:<11} {:>9} {:>9} {:>9}   {:>8} {:>8}", "baud", "protocol", "ideal", "median", "mean", "", "");
    for bps in [1200, 9600, 115_200] {
        for protocol in Protocol::SERIAL {
            let (median, mean, ideal) = silent_address(bps, protocol);
            let [above_median, above_mean] = [median, mean].map(|time| (time / ideal - 1.0) * 100.0);
            let [ideal, median, mean] = [ideal, median, mean].map(|time| time * 1e3);
            let protocol = protocol.label();
            println!(
                "{bps:>8}  {protocol:<11} {ideal:>9.2} {median:>9.2} {mean:>9.2}   {above_median:>6.2} % {above_mean:>6.2} %"
            );
        }
    }
    println!("\npolls of five registers, turnaround {TURNAROUND:?}: ms, and the share of the wire's limit");
    println!("{:>8}  {:>9} {:>9} {:>9}   {:>8} {:>8}", "baud", "shortest", "median", "mean", "", "");
    for bps in [1200, 9600, 19_200, 115_200] {
        let (median, mean, shortest) = polls(bps);
        let [share_median, share_mean] = [median, mean].map(|time| shortest / time * 100.0);
        let [shortest, median, mean] = [shortest, median, mean].map(|time| time * 1e3);
        println!("{bps:>8}  {shortest:>9.2} {median:>9.2} {mean:>9.2}   {share_median:>6.2} % {share_mean:>6.2} %");
    }
    println!("\nprocessor time of a transaction, simulated module included: {:.2?}", processor_time());
}
