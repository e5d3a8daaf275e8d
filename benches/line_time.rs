//! How much of a line's capacity the program uses, on the simulated line in real time.
//!
//! `cargo bench --bench line_time` prints, for each speed, what a silent address costs against its wire time and
//! listening window, and the period of polls against the shortest that the wire allows: both frames, the module's
//! turnaround and the silence before a Modbus frame. On a machine whose scheduler holds the thread up now and then, the
//! mean shows the machine and the median the program.
//!
//! Then polls of the live items of whole modules, side by side: the share of the wire's capacity that they use as fast as
//! the line allows, how exactly a poll once a second is kept, and what one dead module costs the others.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::{Answer, Bus, BusCommand, BusEvent, Direction, Frame, ItemSet, LineAddress, ScanPlan, Target};
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

/// PIR-234s with addresses from 1 on, their live items polled at an interval.
struct Polling {
    bus: Bus,
    settings: LineSettings,
}

/// What was seen of a time of polling.
#[derive(Default)]
struct Seen {
    /// Times of the temperature's answers, by module.
    answers: BTreeMap<u8, Vec<Timestamp>>,
    /// The shortest time that the wire allows for the exchanges seen.
    shortest: Duration,
    began: Option<Timestamp>,
    ended: Option<Timestamp>,
}

impl Polling {
    fn begin(bps: u32, modules: u8, dead: Option<u8>, interval: Duration) -> Self {
        let settings = settings(bps);
        let spec = |address| format!("pir-234@{address}:modbus_rtu:{bps}").parse().expect("a specification");
        let specs: Vec<ModuleSpec> = (1..=modules).map(spec).collect();
        let sim = Sim::new(&specs, Pace::Real).with_turnaround(TURNAROUND);
        dead.into_iter().for_each(|address| sim.set_dead(address, true));
        let (bus, catalogue) = bus(&sim, settings);
        let definition = catalogue.get("pir-234").expect("a definition");
        for address in 1..=modules {
            let target = Target { address, protocol: Protocol::ModbusRtu, settings, checksum: false };
            let (id, definition) = (bus.next_id(), definition.clone());
            let watch = BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval };
            bus.send(watch).expect("room");
        }
        Self { bus, settings }
    }

    fn look(&self, time: Duration) -> Seen {
        let mut seen = Seen::default();
        let end = Instant::now() + time;
        while Instant::now() < end {
            match self.bus.wait_event(Duration::from_millis(50)).expect("a living thread") {
                Some(BusEvent::Traffic(frame)) => seen.frame(&frame, self.settings),
                Some(BusEvent::Read { target, values, .. }) => {
                    let taken = |answer: &&Answer| answer.id == "temperature_c" && answer.result.is_ok();
                    let times = values.iter().filter(taken).map(|answer| answer.at);
                    seen.answers.entry(target.address).or_default().extend(times);
                }
                _ => {}
            }
        }
        seen
    }
}

impl Seen {
    /// Counts from one request to another, so that both belong to whole exchanges.
    fn frame(&mut self, frame: &Frame, settings: LineSettings) {
        let wire = settings.wire_time(frame.bytes.len());
        match frame.direction {
            Direction::Sent => {
                self.began.get_or_insert(frame.at);
                self.ended = Some(frame.at);
            }
            Direction::Received if self.began.is_none() => return,
            Direction::Received => self.shortest += TURNAROUND + settings.frame_silence(),
        }
        self.shortest += wire;
    }

    /// Shortest time by time taken.
    fn share(&self, settings: LineSettings) -> f64 {
        let (Some(began), Some(ended)) = (self.began, self.ended) else { return 0.0 };
        // The last request was counted, its time was not.
        let shortest = self.shortest.saturating_sub(settings.wire_time(8));
        shortest.as_secs_f64() / ended.duration_since(began).as_secs_f64()
    }

    /// Polls of one living module in a second, in the mean of them all.
    fn rate(&self, time: Duration) -> f64 {
        let living: Vec<usize> = self.answers.values().map(Vec::len).filter(|count| *count > 0).collect();
        living.iter().sum::<usize>() as f64 / living.len() as f64 / time.as_secs_f64()
    }

    /// The longest time between two answers of one module, in seconds.
    fn longest_gap(&self) -> f64 {
        let gaps = self.answers.values().flat_map(|times| times.windows(2));
        gaps.map(|pair| pair[1].duration_since(pair[0]).as_secs_f64()).fold(0.0, f64::max)
    }

    /// How far answers were from their plan, in seconds, sorted. A module's plan is the rhythm that fits it best.
    fn jitter(&self, interval: Duration) -> Vec<f64> {
        let mut all = Vec::new();
        for times in self.answers.values() {
            let Some(first) = times.first() else { continue };
            let off = |(turn, at): (usize, &Timestamp)| {
                at.duration_since(*first).as_secs_f64() - interval.as_secs_f64() * turn as f64
            };
            let mut offs: Vec<f64> = times.iter().enumerate().map(off).collect();
            offs.sort_by(f64::total_cmp);
            let middle = offs[offs.len() / 2];
            all.extend(offs.iter().map(|off| (off - middle).abs()));
        }
        all.sort_by(f64::total_cmp);
        all
    }
}

fn print_shares() {
    println!("\nlive items of PIR-234s as fast as the line allows: share of the wire's capacity");
    println!("{:>8}  {:>8} {:>10} {:>9}", "baud", "modules", "polls/s", "share");
    for (bps, modules) in [(9600, 1), (9600, 4), (115_200, 1), (115_200, 4)] {
        let time = Duration::from_secs(3);
        let polling = Polling::begin(bps, modules, None, Duration::ZERO);
        let seen = polling.look(time);
        let share = seen.share(settings(bps)) * 100.0;
        println!("{bps:>8}  {modules:>8} {:>10.2} {share:>7.2} %", seen.rate(time) * f64::from(modules));
    }
}

fn print_jitter() {
    let interval = Duration::from_secs(1);
    let polling = Polling::begin(9600, 4, None, interval);
    // At the beginning each module is asked once for its optional parts.
    polling.look(Duration::from_secs(2));
    let time = Duration::from_secs(24);
    let machine = std::thread::spawn(move || lateness(time));
    let jitter = polling.look(time).jitter(interval);
    let machine = machine.join().expect("a thread that ended well");
    println!("\nlive items of four PIR-234s once a second at 9600: how far from their plan answers were, ms");
    println!("{:>24} {:>8} {:>8} {:>8}", "", "median", "99 %", "max");
    for (name, late) in [("answers", jitter), ("the machine's sleepers", machine)] {
        let [median, most, max] = [50, 99, 100].map(|percent| late[(late.len() - 1) * percent / 100] * 1e3);
        println!("{name:>24} {median:>8.3} {most:>8.3} {max:>8.3}");
    }
}

/// How late the machine wakes sleepers, in seconds, sorted: the part that no program can do anything about.
fn lateness(time: Duration) -> Vec<f64> {
    let nap = Duration::from_millis(5);
    let end = Instant::now() + time;
    let mut all = Vec::new();
    while Instant::now() < end {
        let asleep = Instant::now();
        std::thread::sleep(nap);
        all.push(asleep.elapsed().saturating_sub(nap).as_secs_f64());
    }
    all.sort_by(f64::total_cmp);
    all
}

fn print_cost_of_a_dead_module() {
    println!(
        "\nthree living PIR-234s as fast as a line of 9600 allows: polls of each in a second, longest wait for one"
    );
    println!("{:>16}  {:>8} {:>12}", "", "polls/s", "longest, ms");
    for (name, modules, seconds) in [("alone", 3, 6), ("with a dead one", 4, 24)] {
        let time = Duration::from_secs(seconds);
        let seen = Polling::begin(9600, modules, (modules == 4).then_some(4), Duration::ZERO).look(time);
        println!("{name:>16}  {:>8.3} {:>12.1}", seen.rate(time), seen.longest_gap() * 1e3);
    }
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
        dialogue.with(target, dcon_bench::bus::Patience::CONVERSATION).ask(&query).expect("an answer");
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
    print_shares();
    print_jitter();
    print_cost_of_a_dead_module();
    println!("\nprocessor time of a transaction, simulated module included: {:.2?}", processor_time());
}
