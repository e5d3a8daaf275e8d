//! The window while the line goes wrong: it goes on drawing, shows nothing that no module sent, and does what it is
//! told.

use std::collections::BTreeSet;

use dcon_bench::bench::{Action, Bench, LineState, ScanState};
use dcon_bench::bus::{Bus, BusEvent, LineAddress, Statistics};
use dcon_bench::module::Catalogue;
use dcon_bench::sim::{FaultKind, Faults, Pace, Sim};
use dcon_bench::ui::{App, Settings, Start};
use eframe::egui::accesskit::Role;

use crate::harness::*;

const MODULES: [(&str, u8, f64); 2] =
    [("pir-234@1:modbus_rtu:9600", 1, 21.5), ("pir-234@0xA0:modbus_rtu:9600", 0xA0, -3.25)];
/// Frames with a fault on.
const FRAMES: usize = 60;

/// Two modules with unmistakable temperatures, both polled and answering.
fn polled() -> (Sim, Window) {
    let specs = MODULES.map(|(spec, ..)| spec);
    let sim = sim(&specs, Pace::Skip);
    for (_, address, celsius) in MODULES {
        sim.set_temperature(address, celsius);
    }
    let mut window = window(&sim);
    open(&mut window, "PIR-234, address 1");
    window.state_mut().apply(Action::PollAll(true));
    until(&mut window, "all are read", all_fresh);
    (sim, window)
}

fn temperature(window: &Window, address: u8) -> Option<f64> {
    let module = window.state().bench().modules().iter().find(|module| module.target.address == address)?;
    module.known("temperature_c")?.as_f64()
}

/// Every module has told its temperature in its last answer.
fn all_fresh(window: &Window) -> bool {
    let modules = window.state().bench().modules();
    modules.len() == MODULES.len()
        && modules.iter().all(|module| {
            module.reading("temperature_c").is_some_and(|reading| reading.value.is_some() && reading.problem.is_none())
        })
}

/// What was shown and kept is what the modules have.
#[track_caller]
fn assert_true_values(window: &Window, when: &str) {
    let bench = window.state().bench();
    for (_, address, celsius) in MODULES {
        if let Some(shown) = temperature(window, address) {
            assert_eq!(shown, celsius, "address {address}, {when}");
        }
        let module = bench.modules().iter().find(|module| module.target.address == address);
        let trend = module.and_then(|module| module.trend(bench.history(), "temperature_c"));
        let columns = trend.into_iter().flat_map(|trend| trend.blocks()).filter_map(|block| block.samples.as_ref());
        let kept: BTreeSet<i64> = columns.flat_map(|columns| columns.iter()).map(|sample| sample.value).collect();
        let hundredths = (celsius * 100.0).round() as i64;
        assert!(kept.iter().all(|value| *value == hundredths), "address {address}, {when}: {kept:?}");
    }
}

fn with(kinds: &[FaultKind]) -> Faults {
    let mut faults = Faults::default();
    kinds.iter().for_each(|kind| faults.switch_on(*kind));
    faults
}

/// A second module at the same address has values of its own, which nothing tells from the first one's.
fn keeps_values(kinds: &[FaultKind]) -> bool {
    !kinds.contains(&FaultKind::Twin)
}

/// Lets the line go wrong for some frames, then mends it.
#[track_caller]
fn suffer(sim: &Sim, window: &mut Window, kinds: &[FaultKind]) {
    let when = format!("{kinds:?}");
    sim.set_faults(with(kinds));
    for _ in 0..FRAMES {
        window.step();
        if keeps_values(kinds) {
            assert_true_values(window, &when);
        }
    }
    sim.set_faults(Faults::default());
    let last: Vec<_> = times(window);
    until(window, &format!("fresh again after {when}"), |window| {
        window.state().bench().line().is_open()
            && all_fresh(window)
            && times(window).iter().zip(&last).all(|(now, last)| now > last)
    });
}

/// When each module told its temperature last.
fn times(window: &Window) -> Vec<Option<jiff::Timestamp>> {
    let at = |module: &dcon_bench::bench::Module| module.reading("temperature_c").and_then(|reading| reading.at);
    window.state().bench().modules().iter().map(at).collect()
}

#[test]
fn each_fault_in_turn_leaves_the_window_alive_and_true_and_ends_without_trace() {
    for kind in FaultKind::ALL {
        let (sim, mut window) = polled();
        suffer(&sim, &mut window, &[kind]);
    }
}

#[test]
fn mixtures_of_faults_leave_the_window_alive_and_true() {
    use FaultKind::*;
    let mixtures: [&[FaultKind]; 3] = [
        &[Flipped, Lost, Inserted, Noise],
        &[Late, Doubled, WrongAddress, Echo],
        &[Cut, WrongChecksum, PartialEcho, Late],
    ];
    for kinds in mixtures {
        let (sim, mut window) = polled();
        suffer(&sim, &mut window, kinds);
    }
}

#[test]
fn a_scan_over_a_bad_line_is_stopped_by_its_button() {
    use FaultKind::*;
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Real);
    let mut window = window(&sim);
    click(&mut window, Role::Button, "Scan options");
    click(&mut window, Role::MenuItem, "Full scan");
    until(&mut window, "it runs", |window| {
        matches!(window.state().bench().scan(), Some(ScanState::Running { progress: Some(_), .. }))
    });
    sim.set_faults(with(&[Noise, Late, Doubled, Inserted]));
    click(&mut window, Role::Button, "Stop");
    until(&mut window, "it ends", scan_ended);
    window.step();
    assert!(shows(&window, "Stopped after") || shows(&window, "Line lost after"));
}

#[test]
fn a_line_that_blocks_or_babbles_can_be_closed_and_the_window_be_left() {
    use FaultKind::*;
    for kinds in [&[BlockedWrite][..], &[Noise, Inserted, Doubled], &[Unplugged], &[Late, PartialEcho]] {
        let (sim, mut window) = polled();
        sim.set_faults(with(kinds));
        (0..5).for_each(|_| window.step());
        window.state_mut().apply(Action::Disconnect);
        until(&mut window, "it is closed", |window| matches!(window.state().bench().line(), LineState::Closed));
        // The bus thread ends with the window, or this test never does.
        let (sim, mut window) = polled();
        sim.set_faults(with(kinds));
        (0..5).for_each(|_| window.step());
        drop(window);
    }
}

#[test]
fn a_flood_of_events_is_taken_in_over_several_frames() {
    const FLOOD: u64 = 100_000;
    /// Far more than a line brings between two frames, and little enough to draw in time.
    const MOST_A_FRAME: u64 = 10_000;
    let (bus, _commands, events) = Bus::detached();
    let mut window = window_of(move |ctx| {
        let bench = Bench::new(bus, Catalogue::built_in().0.into(), &[]);
        App::new(ctx, bench, Start { simulated: LineAddress::demo(), demo: false, settings: Settings::default() })
    });
    let flood = std::thread::spawn(move || {
        for transactions in 1..=FLOOD {
            let statistics = Statistics { transactions, ..Statistics::default() };
            events.send(BusEvent::Statistics(statistics)).unwrap();
        }
    });
    let (mut taken, mut most) = (0, 0);
    while taken < FLOOD {
        window.step();
        let now = window.state().bench().statistics().transactions;
        most = most.max(now - taken);
        taken = now;
    }
    flood.join().unwrap();
    assert!(most <= MOST_A_FRAME, "{most} events were taken in before one frame");
}
