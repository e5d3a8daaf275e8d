//! The line itself: times, traffic, ports that are not there.

use dcon_bench::bus::{Bus, BusCommand, BusEvent, Direction, ItemSet, LineAddress, RawRequest};
use dcon_bench::module::Catalogue;
use dcon_bench::protocol::LineSettings;
use dcon_bench::sim::{Pace, Sim};
use std::sync::Arc;
use std::time::Duration;

use crate::harness::*;

#[test]
fn bytes_pass_the_tap_in_order_with_their_times() {
    let line = Line::open(&["pir-130@2:dcon"]);
    let id = line.bus.next_id();
    let request = RawRequest::Dcon { text: "$02M".into(), checksum: false };
    line.bus.send(BusCommand::Raw { id, request, settings: LineSettings::default() }).expect("room");
    let mut frames = Vec::new();
    let answer = line.until(|event| match event {
        BusEvent::Traffic(frame) => {
            frames.push(frame.clone());
            None
        }
        BusEvent::RawAnswer { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert_eq!(answer, Ok(b"!02PIR130".to_vec()));
    let seen: Vec<_> = frames.iter().map(|frame| (frame.direction, frame.bytes.as_slice())).collect();
    assert_eq!(seen, [(Direction::Sent, &b"$02M\r"[..]), (Direction::Received, &b"!02PIR130\r"[..])]);
    assert!(frames[0].at < frames[1].at);
}

#[test]
fn a_line_is_closed_without_waiting_for_what_is_only_read() {
    let spec = "pir-234@1:dcon:1200";
    let line = Line::open_at(Pace::Real, &[spec]);
    for _ in 0..3 {
        let (id, definition) = (line.bus.next_id(), line.definition("pir-234"));
        line.bus.send(BusCommand::Read { id, target: target(spec), definition, items: ItemSet::All }).expect("room");
    }
    line.until(|event| matches!(event, BusEvent::Traffic(_)).then_some(()));
    let id = line.bus.next_id();
    line.bus.send(BusCommand::Close { id }).expect("room");
    line.until(|event| match event {
        BusEvent::Read { values, .. } => panic!("{values:?} were waited for"),
        BusEvent::Closed { .. } => Some(()),
        _ => None,
    });
}

#[test]
fn a_1200_bps_exchange_does_not_time_out() {
    let line = Line::open(&["pir-234@1:dcon:1200"]);
    let value = line.read(target("pir-234@1:dcon:1200"), &line.definition("pir-234"), "alarm_limit");
    assert!(value.is_ok(), "{value:?}");
}

#[test]
fn a_line_opened_later_tells_no_earlier_times_than_the_one_before() {
    let line = Line::open(&["pir-234@1"]);
    let read = || {
        let (id, definition, items) = (line.bus.next_id(), line.definition("pir-234"), ItemSet::Live);
        line.bus.send(BusCommand::Read { id, target: target("pir-234@1"), definition, items }).expect("room");
        line.until(|event| match event {
            BusEvent::Read { values, .. } => Some((values[0].result.is_ok(), values[0].at)),
            _ => None,
        })
    };
    // To the next line, whose clock shows the time of day, this is as if the system's clock had been put back.
    line.sim.advance(Duration::from_secs(3_600));
    let (_, before) = read();
    let sim = Sim::new(&["pir-234@1".parse().expect("a specification")], Pace::Skip);
    let (id, next) = (line.bus.next_id(), LineAddress::Simulated { label: "next".into(), sim });
    line.bus.send(BusCommand::Open { id, line: next, settings: LineSettings::default() }).expect("room");
    let (answered, after) = read();
    assert!(answered && after > before, "{before} {after}");
}

#[test]
fn a_port_that_is_not_there_is_told_with_what_to_do() {
    let bus = Bus::start(Arc::new(Catalogue::built_in().0), || {}).expect("a thread");
    let id = bus.next_id();
    let line = LineAddress::Serial { port: "/dev/no-such-port".into() };
    bus.send(BusCommand::Open { id, line, settings: LineSettings::default() }).expect("room");
    let event = bus.wait_event(LIMIT).expect("a living thread").expect("an event");
    let BusEvent::OpenFailed { problem, .. } = event else { panic!("{event:?}") };
    assert!(problem.to_string().contains("There is no port /dev/no-such-port"), "{problem}");
}

#[cfg(unix)]
mod through_the_serial_driver {
    use super::*;
    use std::sync::Mutex;

    use dcon_bench::bus::{PortInfo, ProblemKind, UsbIdentity};
    use dcon_bench::sim::PtyServer;

    fn bus_on(port: &std::path::Path) -> (Bus, BusEvent) {
        let bus = Bus::start(Arc::new(Catalogue::built_in().0), || {}).expect("a thread");
        let line = LineAddress::Serial { port: port.display().to_string() };
        let id = bus.next_id();
        bus.send(BusCommand::Open { id, line, settings: LineSettings::default() }).expect("room");
        let event = bus.wait_event(LIMIT).expect("a living thread").expect("an event");
        (bus, event)
    }

    fn simulated(spec: &str) -> Sim {
        Sim::new(&[spec.parse().expect("a specification")], Pace::Real)
    }

    #[test]
    fn a_port_that_another_program_holds_is_told_to_be_busy() {
        let server = PtyServer::open(&simulated("pir-234@1"), None).expect("a pseudo-terminal");
        let (_holder, opened) = bus_on(server.path());
        assert!(matches!(opened, BusEvent::Opened { .. }), "{opened:?}");
        let (_second, refused) = bus_on(server.path());
        let BusEvent::OpenFailed { problem, .. } = refused else { panic!("{refused:?}") };
        assert!(matches!(problem.kind, ProblemKind::Busy { .. }), "{problem}");
        let this_program = format!("(process {})", std::process::id());
        assert!(!cfg!(target_os = "linux") || problem.to_string().contains(&this_program), "{problem}");
    }

    #[test]
    fn a_port_that_vanishes_under_its_name_is_taken_up_again_when_it_returns() {
        let folder = tempfile::tempdir().expect("a folder");
        let name = folder.path().join("adapter");
        let sim = simulated("pir-234@1:modbus_rtu:9600");
        let server = PtyServer::open(&sim, Some(&name)).expect("a pseudo-terminal");
        let (bus, opened) = bus_on(&name);
        assert!(matches!(opened, BusEvent::Opened { .. }), "{opened:?}");
        let line = Line { bus, sim: sim.clone(), catalogue: Arc::new(Catalogue::built_in().0) };
        let (id, target, definition) = (line.bus.next_id(), target("pir-234@1"), line.definition("pir-234"));
        let interval = Duration::from_millis(20);
        let watch = BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval };
        line.bus.send(watch).expect("room");
        let read = |event: &BusEvent| match event {
            BusEvent::Read { values, .. } => values.iter().all(|answer| answer.result.is_ok()).then_some(()),
            _ => None,
        };
        line.until(read);
        drop(server);
        line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
        let _returned = PtyServer::open(&sim, Some(&name)).expect("a pseudo-terminal");
        line.until(|event| matches!(event, BusEvent::LineRestored { .. }).then_some(()));
        line.until(read);
    }

    fn adapter(path: &std::path::Path, serial: &str) -> PortInfo {
        let serial = Some(serial.to_owned());
        let usb = Some(UsbIdentity { vendor: 0x0403, product: 0x6001, serial, interface: None });
        PortInfo { name: path.display().to_string(), description: String::new(), problem: None, usb }
    }

    #[test]
    fn an_adapter_that_returns_under_another_name_is_found_and_one_that_has_its_old_name_is_left_alone() {
        let (sim, other) = (simulated("pir-234@1:modbus_rtu:9600"), simulated("pir-234@1:modbus_rtu:9600"));
        let folder = tempfile::tempdir().expect("a folder");
        let (old, new) = (folder.path().join("USB0"), folder.path().join("USB1"));
        let server = PtyServer::open(&sim, Some(&old)).expect("a pseudo-terminal");
        let present = Arc::new(Mutex::new(vec![adapter(&old, "A1")]));
        let list = present.clone();
        let list = Box::new(move || list.lock().expect("no panic").clone());
        let catalogue = Arc::new(Catalogue::built_in().0);
        let bus = Bus::start_with_ports(catalogue.clone(), || {}, list).expect("a thread");
        let (line, settings, id) =
            (LineAddress::Serial { port: old.display().to_string() }, LineSettings::default(), bus.next_id());
        bus.send(BusCommand::Open { id, line, settings }).expect("room");
        let line = Line { bus, sim: sim.clone(), catalogue };
        line.until(|event| matches!(event, BusEvent::Opened { .. }).then_some(()));

        drop(server);
        let _stranger = PtyServer::open(&other, Some(&old)).expect("a pseudo-terminal");
        *present.lock().expect("no panic") = vec![adapter(&old, "B2")];
        line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
        let _returned = PtyServer::open(&sim, Some(&new)).expect("a pseudo-terminal");
        present.lock().expect("no panic").push(adapter(&new, "A1"));
        let restored = line.until(|event| match event {
            BusEvent::LineRestored { line } => Some(line.to_string()),
            _ => None,
        });
        assert_eq!(restored, new.display().to_string());
        assert_eq!(other.requests(), 0, "nothing was sent to the other adapter");
        let definition = line.definition("pir-234");
        assert!(line.read(target("pir-234@1"), &definition, "temperature_c").is_ok());
    }
}
