//! Modbus TCP through the bus thread.

use dcon_bench::bus::{Bus, BusCommand, BusEvent, LineAddress, ScanPlan, Target};
use dcon_bench::module::Catalogue;
use dcon_bench::protocol::{LineSettings, Protocol};
use dcon_bench::sim::{ModuleSpec, Pace, Sim};
use std::sync::Arc;

use crate::harness::*;

/// A PIR-234's Ethernet side, and a bus thread that has it open.
pub fn over_tcp(specs: &[&str]) -> (Line, dcon_bench::sim::TcpServer) {
    let specs: Vec<ModuleSpec> = specs.iter().map(|spec| spec.parse().expect("a specification")).collect();
    let sim = Sim::new(&specs, Pace::Real);
    let server = dcon_bench::sim::TcpServer::bind(&sim, "127.0.0.1:0".parse().expect("an address")).expect("a server");
    let catalogue = Arc::new(Catalogue::built_in().0);
    let bus = Bus::start(catalogue.clone(), || {}).expect("a thread");
    let line = LineAddress::tcp(&server.address().to_string()).expect("an address");
    let id = bus.next_id();
    bus.send(BusCommand::Open { id, line, settings: LineSettings::default() }).expect("room");
    let line = Line { bus, sim, catalogue };
    line.until(|event| matches!(event, BusEvent::Opened { .. }).then_some(()));
    (line, server)
}

pub fn by_net_id(address: u8) -> Target {
    Target { address, protocol: Protocol::ModbusTcp, settings: LineSettings::default(), checksum: false }
}

#[test]
fn a_pir_234_is_found_read_and_written_over_modbus_tcp() {
    let (line, _server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    let (found, _) = line.scan(ScanPlan::tcp());
    assert_eq!(models(&found), [(1, "pir-234".to_owned())]);
    assert_eq!(found[0].1.firmware, "B2.8");
    line.sim.set_temperature(1, 21.5);
    let definition = line.definition("pir-234");
    let temperature = line.read(by_net_id(1), &definition, "temperature_c").expect("a value");
    assert_eq!(temperature.to_string(), "21.50");
    let value = definition.item("pir_on_time").expect("an item").parse("131").expect("a value");
    let (id, item) = (line.bus.next_id(), "pir_on_time".to_owned());
    line.bus.send(BusCommand::Write { id, target: by_net_id(1), definition, item, value }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert!(result.is_ok(), "{result:?}");
    assert_eq!(line.sim.setting(1, "pir_on_time").as_deref(), Some("131"));
}

#[test]
fn a_net_id_that_stays_silent_does_not_spoil_the_next_question_over_tcp() {
    let (line, _server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    let definition = line.definition("pir-234");
    assert!(line.read(by_net_id(9), &definition, "humidity").is_err());
    assert!(line.read(by_net_id(1), &definition, "humidity").is_ok());
}

#[test]
fn a_connection_that_was_cut_is_made_again() {
    let (line, server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    let (address, definition) = (server.address(), line.definition("pir-234"));
    assert!(line.read(by_net_id(1), &definition, "humidity").is_ok());
    drop(server);
    assert!(line.read(by_net_id(1), &definition, "humidity").is_err());
    let _server = dcon_bench::sim::TcpServer::bind(&line.sim, address).expect("the same port");
    line.until(|event| matches!(event, BusEvent::LineRestored { .. }).then_some(()));
    assert!(line.read(by_net_id(1), &definition, "humidity").is_ok());
}

#[test]
fn a_host_that_is_not_reached_is_told_with_what_to_check() {
    let bus = Bus::start(Arc::new(Catalogue::built_in().0), || {}).expect("a thread");
    let unused = std::net::TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("an address");
    let id = bus.next_id();
    let line = LineAddress::tcp(&unused.to_string()).expect("an address");
    bus.send(BusCommand::Open { id, line, settings: LineSettings::default() }).expect("room");
    let event = bus.wait_event(LIMIT).expect("a living thread").expect("an event");
    let BusEvent::OpenFailed { problem, .. } = event else { panic!("{event:?}") };
    assert!(problem.to_string().contains("check the cable"), "{problem}");
}
