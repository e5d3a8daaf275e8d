//! Scans through the bus thread.

use dcon_bench::bus::{BusCommand, BusEvent, ItemSet, ScanPlan};
use dcon_bench::protocol::{BaudRate, DataFormat, Protocol};
use dcon_bench::sim::DEMO;

use crate::harness::*;

#[test]
fn the_quick_scan_finds_the_likely_modules_and_only_them() {
    let line = Line::open(DEMO);
    let (found, summary) = line.scan(ScanPlan::quick());
    let expected = [(1, "pir-234"), (0xA0, "pir-130"), (0xA3, "pir-234")].map(|(a, m)| (a, m.to_owned()));
    assert_eq!(models(&found), expected);
    assert_eq!((summary.done, summary.total, summary.found), (66, 66, 3));
    assert_eq!(summary.unreadable, []);
}

#[test]
fn a_wide_scan_finds_modules_at_any_speed_format_protocol_and_checksum() {
    let specs = [
        "pir-234@7:modbus_rtu:115200:e81",
        "pir-130@0x12:dcon:19200:checksum",
        "pir-234@200:dcon:1200:n82",
        "unknown@17",
    ];
    let line = Line::open(&specs);
    let plan = ScanPlan {
        addresses: vec![7, 0x12, 17, 200],
        baud_rates: BaudRate::ALL.to_vec(),
        data_formats: DataFormat::ALL.to_vec(),
        checksums: vec![false, true],
        ..ScanPlan::quick()
    };
    let (found, summary) = line.scan(plan);
    let mut targets: Vec<_> = found.iter().map(|(target, _)| *target).collect();
    targets.sort();
    let mut expected: Vec<_> = specs.iter().map(|spec| target(spec)).collect();
    expected.sort();
    assert_eq!(targets, expected);
    assert_eq!(summary.done, 4 * 8 * 4 * 3);
    let stranger = found.iter().find(|(target, _)| target.address == 17).expect("the stranger");
    assert_eq!(stranger.1.model(), "unknown");
    assert!(stranger.1.said.contains("exception 2"), "{}", stranger.1.said);
}

#[test]
fn stop_at_the_first_ends_the_scan_there() {
    let line = Line::open(DEMO);
    let (found, summary) = line.scan(ScanPlan { stop_at_first: true, ..ScanPlan::quick() });
    assert_eq!((found.len(), summary.done), (1, 1));
}

#[test]
fn a_scan_can_be_held_and_cancelled_and_what_was_found_stays() {
    let line = Line::open(DEMO);
    let id = line.bus.next_id();
    line.bus.send(BusCommand::Scan { id, plan: ScanPlan::full() }).expect("room");
    line.until(|event| matches!(event, BusEvent::Found { .. }).then_some(()));
    line.bus.send(BusCommand::PauseScan(true)).expect("room");
    let held = line.until(|event| match event {
        BusEvent::ScanProgress { progress, .. } if progress.paused => Some(progress.done),
        _ => None,
    });
    line.bus.send(BusCommand::PauseScan(false)).expect("room");
    line.until(|event| matches!(event, BusEvent::ScanProgress { progress, .. } if progress.done > held).then_some(()));
    line.bus.send(BusCommand::CancelScan).expect("room");
    let summary = line.until(|event| match event {
        BusEvent::ScanEnded { summary, .. } => Some(summary.clone()),
        _ => None,
    });
    assert!(summary.cancelled && summary.done < summary.total && summary.found >= 1, "{summary:?}");
}

#[test]
fn echo_noise_and_a_dead_module_neither_hide_modules_nor_invent_any() {
    let line = Line::open(&["pir-234@1:modbus_rtu", "pir-130@0xA1:dcon", "pir-130@0xA5:modbus_rtu"]);
    line.sim.set_echo(true);
    line.sim.set_noise(&[0x00, 0xFF], &[0xFF]);
    line.sim.set_dead(0xA5, true);
    let (found, summary) = line.scan(ScanPlan::quick());
    assert_eq!(models(&found), [(1, "pir-234".to_owned()), (0xA1, "pir-130".to_owned())]);
    assert_eq!(summary.done, summary.total);
}

#[test]
fn two_modules_at_one_address_are_reported_as_unreadable_not_as_a_module() {
    let line = Line::open(&["pir-234@1:dcon", "pir-130@1:dcon"]);
    let plan = ScanPlan { addresses: vec![1], protocols: vec![Protocol::Dcon], ..ScanPlan::quick() };
    let (found, summary) = line.scan(plan);
    assert!(found.iter().all(|(_, who)| who.model() == "unknown"), "{found:?}");
    assert!(!summary.unreadable.is_empty() || !found.is_empty(), "{summary:?}");
}

#[test]
fn a_cancelled_scan_that_waited_for_its_turn_never_begins() {
    let line = Line::open(&["pir-234@1"]);
    let (reading, scan) = (line.bus.next_id(), line.bus.next_id());
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    line.bus.send(BusCommand::Read { id: reading, target, definition, items: ItemSet::All }).expect("room");
    line.bus.send(BusCommand::Scan { id: scan, plan: ScanPlan::full() }).expect("room");
    line.bus.send(BusCommand::CancelScan).expect("room");
    let summary = line.until(|event| match event {
        BusEvent::ScanEnded { id, summary } if *id == scan => Some(summary.clone()),
        _ => None,
    });
    assert!(summary.cancelled && summary.done < summary.total.max(1), "{summary:?}");
}

#[test]
fn a_scan_of_a_lost_line_says_that_it_is_lost() {
    let line = Line::open(&["pir-234@1"]);
    line.sim.unplug();
    line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
    let (_, summary) = line.scan(ScanPlan::quick());
    assert!(summary.lost.is_some(), "{summary:?}");
}
