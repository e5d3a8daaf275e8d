//! The bus thread from outside: commands in, events out, on simulated lines.

use std::sync::Arc;
use std::time::{Duration, Instant};

use dcon_bench::bus::{
    Bus, BusCommand, BusEvent, Direction, ItemSet, LineAddress, RawRequest, ScanPlan, ScanSummary, Target,
};
use dcon_bench::module::{Catalogue, Definition, Identified, Value};
use dcon_bench::protocol::{BaudRate, DataFormat, Failure, LineSettings, Protocol};
use dcon_bench::sim::{DEMO, ModuleSpec, Pace, Sim};

/// Longer than anything here takes; only a hang reaches it.
const LIMIT: Duration = Duration::from_secs(60);

struct Line {
    bus: Bus,
    sim: Sim,
    catalogue: Arc<Catalogue>,
}

impl Line {
    fn open(specs: &[&str]) -> Self {
        let specs: Vec<ModuleSpec> = specs.iter().map(|spec| spec.parse().expect("a specification")).collect();
        let sim = Sim::new(&specs, Pace::Skip);
        let catalogue = Arc::new(Catalogue::built_in().0);
        let bus = Bus::start(catalogue.clone(), || {}).expect("a thread");
        let line = LineAddress::Simulated { label: "test".into(), sim: sim.clone() };
        let id = bus.next_id();
        bus.send(BusCommand::Open { id, line, settings: LineSettings::default() }).expect("room");
        let this = Self { bus, sim, catalogue };
        this.until(|event| matches!(event, BusEvent::Opened { .. }).then_some(()));
        this
    }

    fn definition(&self, id: &str) -> Arc<Definition> {
        self.catalogue.get(id).expect("a definition")
    }

    /// Waits for the first event of which `pick` makes something.
    fn until<T>(&self, mut pick: impl FnMut(&BusEvent) -> Option<T>) -> T {
        let deadline = Instant::now() + LIMIT;
        while Instant::now() < deadline {
            if let Some(event) = self.bus.wait_event(Duration::from_secs(1)).expect("a living thread")
                && let Some(found) = pick(&event)
            {
                return found;
            }
        }
        panic!("the event did not come within {LIMIT:?}");
    }

    fn scan(&self, plan: ScanPlan) -> (Vec<(Target, Identified)>, ScanSummary) {
        let id = self.bus.next_id();
        self.bus.send(BusCommand::Scan { id, plan }).expect("room");
        let mut found = Vec::new();
        let summary = self.until(|event| match event {
            BusEvent::Found { target, identified, .. } => {
                found.push((*target, identified.clone()));
                None
            }
            BusEvent::ScanEnded { summary, .. } => Some(summary.clone()),
            _ => None,
        });
        (found, summary)
    }

    fn read(&self, target: Target, definition: &Arc<Definition>, name: &str) -> Result<Value, Failure> {
        let id = self.bus.next_id();
        let items = ItemSet::Named(vec![name.into()]);
        self.bus.send(BusCommand::Read { id, target, definition: definition.clone(), items }).expect("room");
        self.until(|event| match event {
            BusEvent::Read { id: answered, values, .. } if *answered == id => values.first().map(|(_, v)| v.clone()),
            _ => None,
        })
    }
}

fn target(spec: &str) -> Target {
    let spec: ModuleSpec = spec.parse().expect("a specification");
    Target { address: spec.address, protocol: spec.protocol, settings: spec.settings, checksum: spec.checksum }
}

fn models(found: &[(Target, Identified)]) -> Vec<(u8, String)> {
    let mut models: Vec<_> = found.iter().map(|(target, who)| (target.address, who.model().to_owned())).collect();
    models.sort();
    models
}

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
fn a_watched_module_is_read_again_and_again_until_it_is_let_go() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let id = line.bus.next_id();
    let interval = Duration::from_millis(1);
    line.bus.send(BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval }).expect("room");
    line.sim.set_temperature(1, 24.99);
    let mut readings = 0;
    line.until(|event| match event {
        BusEvent::Read { values, .. } => {
            readings += 1;
            let warm = values
                .iter()
                .any(|(id, v)| id == "temperature_c" && v.as_ref().is_ok_and(|v| v.to_string() == "24.99"));
            (readings > 5 && warm).then_some(())
        }
        _ => None,
    });
    line.bus.send(BusCommand::Unwatch { target }).expect("room");
    let temperature = line.read(target, &line.definition("pir-234"), "temperature_c");
    assert_eq!(temperature.expect("a value").to_string(), "24.99");
    let after = line.sim.requests();
    line.read(target, &line.definition("pir-234"), "humidity").expect("a value");
    assert_eq!(line.sim.requests(), after + 1, "nothing but what was asked for is sent");
}

#[test]
fn a_write_changes_the_module_and_is_told_as_the_module_then_says() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let value = definition.item("pir_on_time").expect("an item").parse("66").expect("a value");
    let id = line.bus.next_id();
    let item = "pir_on_time".to_owned();
    line.bus.send(BusCommand::Write { id, target, definition, item, value: value.clone() }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert_eq!(result, Ok(value));
    assert_eq!(line.sim.setting(1, "pir_on_time").as_deref(), Some("66"));
}

#[test]
fn a_write_that_stays_without_answer_is_sent_once_and_its_outcome_is_said_to_be_unknown() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let id = line.bus.next_id();
    line.bus.send(BusCommand::Identify { id, target }).expect("room");
    line.until(|event| matches!(event, BusEvent::Identified { .. }).then_some(()));
    line.sim.set_dead(1, true);
    let before = line.sim.requests();
    let value = definition.item("pir_on_time").expect("an item").parse("66").expect("a value");
    let id = line.bus.next_id();
    let item = "pir_on_time".to_owned();
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    let mut writes = 0;
    let result = line.until(|event| match event {
        BusEvent::Traffic(frame) => {
            writes += u32::from(frame.direction == Direction::Sent && frame.bytes.get(1) == Some(&6));
            None
        }
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    let error = result.expect_err("nobody answered").to_string();
    assert!(error.contains("not known"), "{error}");
    assert_eq!(writes, 1);
    assert!(line.sim.requests() > before);
}

#[test]
fn nothing_is_written_to_a_module_of_another_model() {
    let line = Line::open(&["pir-130@1"]);
    let (target, definition) = (target("pir-130@1"), line.definition("pir-234"));
    let value = definition.item("pir_on_time").expect("an item").parse("66").expect("a value");
    let before = line.sim.setting(1, "pir_on_time");
    let (id, item) = (line.bus.next_id(), "pir_on_time".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert!(result.expect_err("another model").to_string().contains("pir-130, not pir-234"));
    assert_eq!(line.sim.setting(1, "pir_on_time"), before);
}

#[test]
fn a_module_is_not_moved_to_an_address_where_another_answers() {
    let line = Line::open(&["pir-234@1", "pir-130@2"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let value = definition.item("address").expect("an item").parse("2").expect("a value");
    let (id, item) = (line.bus.next_id(), "address".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    let result = line.until(|event| match event {
        BusEvent::Written { result, .. } => Some(result.clone()),
        _ => None,
    });
    assert!(result.expect_err("it is taken").to_string().contains("already"));
    assert_eq!(line.sim.setting(1, "address").as_deref(), Some("1"));
}

#[test]
fn a_watch_follows_its_module_to_a_new_address() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let (id, interval) = (line.bus.next_id(), Duration::from_millis(1));
    let items = ItemSet::Live;
    let watch = BusCommand::Watch { id, target, definition: definition.clone(), items, interval };
    line.bus.send(watch).expect("room");
    line.until(|event| matches!(event, BusEvent::Read { .. }).then_some(()));
    let value = definition.item("address").expect("an item").parse("9").expect("a value");
    let (id, item) = (line.bus.next_id(), "address".to_owned());
    line.bus.send(BusCommand::Write { id, target, definition, item, value }).expect("room");
    line.until(|event| match event {
        BusEvent::Read { target, values, .. } if target.address == 9 => {
            values.iter().all(|(_, v)| v.is_ok()).then_some(())
        }
        _ => None,
    });
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

#[test]
fn an_unused_line_shows_no_transactions_a_second() {
    let line = Line::open(&["pir-234@1"]);
    line.read(target("pir-234@1"), &line.definition("pir-234"), "humidity").expect("a value");
    let rate = |event: &BusEvent| match event {
        BusEvent::Statistics(statistics) => Some(statistics.transactions_per_second),
        _ => None,
    };
    assert!(line.until(rate) > 0.0);
    assert_eq!(line.until(rate), 0.0);
}

#[test]
fn a_pulled_adapter_is_told_and_polling_goes_on_when_it_returns() {
    let line = Line::open(&["pir-234@1"]);
    let (target, definition) = (target("pir-234@1"), line.definition("pir-234"));
    let id = line.bus.next_id();
    let interval = Duration::from_millis(5);
    line.bus.send(BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval }).expect("room");
    line.until(|event| matches!(event, BusEvent::Read { .. }).then_some(()));
    line.sim.unplug();
    line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
    line.sim.plug();
    line.until(|event| matches!(event, BusEvent::LineRestored).then_some(()));
    line.until(|event| match event {
        BusEvent::Read { values, .. } => values.iter().all(|(_, value)| value.is_ok()).then_some(()),
        _ => None,
    });
}

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
fn a_1200_bps_exchange_does_not_time_out() {
    let line = Line::open(&["pir-234@1:dcon:1200"]);
    let value = line.read(target("pir-234@1:dcon:1200"), &line.definition("pir-234"), "alarm_limit");
    assert!(value.is_ok(), "{value:?}");
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

/// A PIR-234's Ethernet side, and a bus thread that has it open.
fn over_tcp(specs: &[&str]) -> (Line, dcon_bench::sim::TcpServer) {
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

fn by_net_id(address: u8) -> Target {
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
    line.until(|event| matches!(event, BusEvent::LineRestored).then_some(()));
    assert!(line.read(by_net_id(1), &definition, "humidity").is_ok());
}

fn raw_modbus(line: &Line, bytes: &[u8]) -> Result<Vec<u8>, Failure> {
    let (id, request) = (line.bus.next_id(), RawRequest::Modbus { bytes: bytes.to_vec() });
    line.bus.send(BusCommand::Raw { id, request, settings: LineSettings::default() }).expect("room");
    line.until(|event| match event {
        BusEvent::RawAnswer { id: answered, result } if *answered == id => Some(result.clone()),
        _ => None,
    })
}

#[test]
fn raw_modbus_bytes_pass_over_tcp_and_refusals_come_back_as_their_bytes() {
    let (line, _server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    assert_eq!(raw_modbus(&line, &[1, 3, 0x01, 0xE2, 0, 2]), Ok(vec![1, 3, 4, 0x02, 0x34, 0x50, 0x49]));
    assert_eq!(raw_modbus(&line, &[1, 6, 0x02, 0x00, 0, 8]), Ok(vec![1, 6, 0x02, 0x00, 0, 8]));
    assert_eq!(line.sim.setting(1, "pir_on_time").as_deref(), Some("131"));
    assert_eq!(raw_modbus(&line, &[1, 3, 0xFF, 0x00, 0, 1]), Ok(vec![1, 0x83, 2]));
    assert_eq!(raw_modbus(&line, &[1, 0x41, 7]), Ok(vec![1, 0xC1, 1]), "a function that nobody knows");
    assert!(matches!(raw_modbus(&line, &[1, 0x83, 2]), Err(Failure::NotOffered(_))));
    assert!(matches!(raw_modbus(&line, &[1]), Err(Failure::NotOffered(_))));
    assert!(line.read(by_net_id(1), &line.definition("pir-234"), "humidity").is_ok(), "the line is still good");
}

#[test]
fn a_raw_dcon_command_over_tcp_is_refused_with_the_reason() {
    let (line, _server) = over_tcp(&["pir-234@1:modbus_rtu:9600"]);
    assert!(matches!(raw_dcon(&line, "$01M", false), Err(Failure::NotOffered(reason)) if reason.contains("serial")));
}

fn raw_dcon(line: &Line, text: &str, checksum: bool) -> Result<Vec<u8>, Failure> {
    let (id, request) = (line.bus.next_id(), RawRequest::Dcon { text: text.into(), checksum });
    line.bus.send(BusCommand::Raw { id, request, settings: LineSettings::default() }).expect("room");
    line.until(|event| match event {
        BusEvent::RawAnswer { id: answered, result } if *answered == id => Some(result.clone()),
        _ => None,
    })
}

#[test]
fn raw_refusals_and_wrong_checksums_on_a_serial_line_are_visible_as_bytes() {
    let line = Line::open(&["pir-234@2:dcon", "pir-234@3:modbus_rtu"]);
    assert_eq!(raw_dcon(&line, "@02DO0F", false), Ok(b"?02".to_vec()));
    let exception = raw_modbus(&line, &[3, 3, 0xFF, 0, 0, 1]).expect("an answer");
    assert_eq!(exception[..3], [3, 0x83, 2]);
    let line = Line::open(&["pir-234@2:dcon:checksum"]);
    assert_eq!(raw_dcon(&line, "$02M", true), Ok(b"!02PIR23407".to_vec()));
    assert_eq!(raw_dcon(&line, "$02MD3", false), Ok(b"!02PIR23407".to_vec()), "a checksum typed by hand");
    let line = Line::open(&["pir-234@2:dcon"]);
    // With its checksum $025BB, the question for the reset status is another command to a module that expects none.
    let answer = raw_dcon(&line, "$025", true);
    let Err(Failure::Garbled { reason, bytes }) = answer else { panic!("a checksum was missing: {answer:?}") };
    assert!(reason.contains("wrong checksum") && bytes.get(1..3) == Some(b"02"), "{reason} {bytes:?}");
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

#[cfg(unix)]
mod through_the_serial_driver {
    use super::*;
    use dcon_bench::bus::ProblemKind;
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
        assert_eq!(problem.kind, ProblemKind::Busy, "{problem}");
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
            BusEvent::Read { values, .. } => values.iter().all(|(_, value)| value.is_ok()).then_some(()),
            _ => None,
        };
        line.until(read);
        drop(server);
        line.until(|event| matches!(event, BusEvent::LineLost { .. }).then_some(()));
        let _returned = PtyServer::open(&sim, Some(&name)).expect("a pseudo-terminal");
        line.until(|event| matches!(event, BusEvent::LineRestored).then_some(()));
        line.until(read);
    }
}
