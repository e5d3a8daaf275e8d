//! Every parameter of every definition, written and read back against the simulated modules, whose own state is then
//! looked at. The list comes from the definitions, so that none can be forgotten.

use std::sync::Arc;

#[cfg(unix)]
use dcon_bench::bus::LineAddress;
use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::transaction::Wire;
use dcon_bench::bus::{Patience, Target};
use dcon_bench::module::{
    Applies, Catalogue, Definition, Identified, Item, ItemKind, Kind, Value, identify, present_options, read_items,
    run_action, write_item,
};
#[cfg(unix)]
use dcon_bench::protocol::{BaudRate, Failure};
use dcon_bench::protocol::{LineSettings, Protocol};
use dcon_bench::sim::{ModuleSpec, Pace, Sim};
#[cfg(unix)]
use {dcon_bench::sim::PtyServer, std::time::Duration};

/// What lies between the program and the simulated module.
#[derive(Clone, Copy)]
enum Way {
    /// The simulated line itself, whose time passes without waiting.
    InMemory,
    /// The operating system's serial driver, in real time.
    #[cfg(unix)]
    PseudoTerminal,
}

/// A module on a simulated line of its own, and a conversation with it.
struct Bench {
    sim: Sim,
    dialogue: Dialogue,
    target: Target,
    definition: Arc<Definition>,
    #[cfg(unix)]
    _server: Option<PtyServer>,
}

impl Bench {
    fn open(spec: &str) -> Self {
        Self::open_over(Way::InMemory, spec)
    }

    fn open_over(way: Way, spec: &str) -> Self {
        let parsed: ModuleSpec = spec.parse().expect("a module specification");
        let specs = std::slice::from_ref(&parsed);
        let (sim, mut dialogue);
        #[cfg(unix)]
        let mut server = None;
        match way {
            Way::InMemory => {
                sim = Sim::new(specs, Pace::Skip);
                let wire = Wire::new(Box::new(sim.line()), parsed.settings, Box::new(|_| {})).expect("a line");
                dialogue = Dialogue::on_wire(wire).expect("a dialogue");
            }
            #[cfg(unix)]
            Way::PseudoTerminal => {
                sim = Sim::new(specs, Pace::Real).with_turnaround(Duration::from_micros(500));
                let pty = PtyServer::open(&sim, None).expect("a pseudo-terminal");
                let port = LineAddress::Serial { port: pty.path().display().to_string() };
                // Opened at another speed, so that the first question changes it in place.
                dialogue = Dialogue::open(&port, LineSettings::default(), Box::new(|_| {})).expect("an open port");
                server = Some(pty);
            }
        }
        let target = Target {
            address: parsed.address,
            protocol: parsed.protocol,
            settings: parsed.settings,
            checksum: parsed.checksum,
        };
        let found = identified(&mut dialogue, target);
        let definition = found.definition.unwrap_or_else(|| panic!("{spec} is not recognised: {}", found.said));
        Self {
            sim,
            dialogue,
            target,
            definition,
            #[cfg(unix)]
            _server: server,
        }
    }

    fn items(&mut self) -> Vec<Item> {
        let protocol = self.target.protocol;
        let options = present_options(
            &self.definition.clone(),
            protocol,
            &mut self.dialogue.with(self.target, Patience::CONVERSATION),
        )
        .expect("an answer to every probe");
        let here = |item: &&Item| item.optional.as_ref().is_none_or(|part| options.contains(part));
        self.definition.items_over(protocol).filter(here).cloned().collect()
    }

    fn read(&mut self, id: &str) -> Value {
        let mut speaker = self.dialogue.with(self.target, Patience::CONVERSATION);
        let mut values = read_items(&self.definition, self.target.protocol, self.target.address, [id], &mut speaker);
        let answer = values.pop().unwrap_or_else(|| panic!("{id} is not offered"));
        answer.result.unwrap_or_else(|failure| panic!("{id} over {}: {failure}", self.target))
    }

    fn write(&mut self, item: &Item, value: &Value) -> Value {
        let mut speaker = self.dialogue.with(self.target, Patience::CONVERSATION);
        write_item(&self.definition, self.target.protocol, self.target.address, item, value, &mut speaker)
            .unwrap_or_else(|error| panic!("{} = {value} over {}: {error}", item.id, self.target))
    }
}

fn identified(dialogue: &mut Dialogue, target: Target) -> Identified {
    let (catalogue, errors) = Catalogue::built_in();
    assert_eq!(errors, []);
    identify(&catalogue, target.protocol, target.address, &mut dialogue.with(target, Patience::CONVERSATION))
        .unwrap_or_else(|failure| panic!("{target}: {failure}"))
}

/// Values worth trying: all of a list, the ends and a middle of a range.
fn samples(item: &Item, protocol: Protocol) -> Vec<Value> {
    let texts: Vec<String> = match &item.kind {
        Kind::Bool => vec!["true".into(), "false".into()],
        Kind::Choice(choices) => choices.iter().map(|choice| choice.word.clone()).collect(),
        Kind::Number { .. } if item.id == "wdt_timeout_count" => vec!["0".into()],
        Kind::Number { min, max, also } => {
            let middle = dcon_bench::module::Fixed::new((min.raw + max.raw) / 3, min.decimals);
            let highest = match (protocol.is_modbus(), item.id.as_str()) {
                (true, "alarm_limit") => "655.35".to_owned(),
                _ => max.to_string(),
            };
            let mut all = vec![min.to_string(), middle.to_string(), highest];
            all.extend(also.iter().map(ToString::to_string));
            all
        }
        Kind::Text { .. } => vec!["dcon bench".into()],
        Kind::Ipv4 => vec!["10.1.2.3".into()],
    };
    texts.iter().map(|text| item.parse(text).unwrap_or_else(|error| panic!("{error}"))).collect()
}

/// Relays obey only if they follow commands, and a watchdog needs its time before it can be enabled.
fn prepare(bench: &mut Bench, item: &Item) {
    if matches!(item.id.as_str(), "do0" | "do1") {
        for source in ["do0_source", "do1_source"] {
            let source = bench.definition.item(source).expect("a source").clone();
            bench.write(&source, &Value::Choice("command".into()));
        }
    }
    if item.id == "wdt_enabled" {
        let timeout = bench.definition.item("wdt_timeout").expect("a timeout").clone();
        bench.write(&timeout, &timeout.parse("25.5").expect("a value"));
    }
    if item.applies == Applies::Init {
        bench.sim.set_init(bench.target.address, true);
    }
}

fn every_parameter_round_trips(spec: &str) {
    every_parameter_round_trips_over(Way::InMemory, spec);
}

fn every_parameter_round_trips_over(way: Way, spec: &str) {
    let mut written = 0;
    let items = Bench::open_over(way, spec).items();
    for item in items.iter().filter(|item| !item.read_only && item.id != "address") {
        // A module of its own for each, so that a changed speed or protocol cannot disturb the next.
        let mut bench = Bench::open_over(way, spec);
        prepare(&mut bench, item);
        for value in samples(item, bench.target.protocol) {
            assert_eq!(bench.write(item, &value), value, "{} over {}", item.id, bench.target);
            // Wi-Fi settings are in force only after `wifi_apply`; they have a test of their own.
            if item.optional.as_deref() != Some("wifi") {
                let state = bench.sim.setting(bench.target.address, &item.id);
                assert_eq!(state, Some(value.to_string()), "{} as the module has it", item.id);
            }
            written += 1;
        }
    }
    assert!(written > 20, "{spec}");
    for item in items.iter().filter(|item| item.read_only) {
        Bench::open_over(way, spec).read(&item.id);
    }
}

#[test]
fn every_parameter_of_the_pir_234_round_trips_over_dcon() {
    every_parameter_round_trips("pir-234@1:dcon:9600");
}

#[test]
fn every_parameter_of_the_pir_234_round_trips_over_dcon_with_checksum() {
    every_parameter_round_trips("pir-234@1:dcon:115200:checksum");
}

#[test]
fn every_parameter_of_the_pir_234_round_trips_over_modbus_rtu() {
    every_parameter_round_trips("pir-234@1:modbus_rtu:9600");
}

#[test]
fn every_wifi_parameter_of_the_pir_234_wf_round_trips_over_modbus_rtu() {
    let ids: Vec<_> = Bench::open("pir-234-wf@1:modbus_rtu:115200").items().into_iter().map(|item| item.id).collect();
    assert!(ids.iter().filter(|id| id.starts_with("wifi_")).count() >= 15, "{ids:?}");
    every_parameter_round_trips("pir-234-wf@1:modbus_rtu:115200");
}

#[test]
fn wifi_settings_are_in_force_after_they_were_applied() {
    let mut bench = Bench::open("pir-234-wf@1:modbus_rtu");
    let mode = bench.definition.item("wifi_mode").expect("a mode").clone();
    let before = bench.sim.setting(1, "wifi_642");
    bench.write(&mode, &Value::Choice("station".into()));
    assert_eq!(bench.sim.setting(1, "wifi_642"), before);
    let definition = bench.definition.clone();
    let apply = definition.action("wifi_apply").expect("an action");
    run_action(apply, Protocol::ModbusRtu, 1, &mut bench.dialogue.with(bench.target, Patience::CONVERSATION))
        .expect("to be applied");
    assert_eq!(bench.sim.setting(1, "wifi_642").as_deref(), Some("0"));
}

#[test]
fn every_parameter_of_the_pir_130_round_trips_over_dcon() {
    every_parameter_round_trips("pir-130@1:dcon:1200");
}

#[test]
fn every_parameter_of_the_pir_130_round_trips_over_dcon_with_checksum() {
    every_parameter_round_trips("pir-130@1:dcon:9600:checksum");
}

#[test]
fn every_parameter_of_the_pir_130_round_trips_over_modbus_rtu() {
    every_parameter_round_trips("pir-130@1:modbus_rtu:19200:e81");
}

#[test]
fn every_parameter_of_the_pir_230_round_trips_over_dcon() {
    every_parameter_round_trips("pir-230@1:dcon:9600");
}

#[cfg(unix)]
#[test]
fn every_parameter_round_trips_through_the_serial_driver_over_modbus_rtu() {
    every_parameter_round_trips_over(Way::PseudoTerminal, "pir-234@1:modbus_rtu:115200");
    every_parameter_round_trips_over(Way::PseudoTerminal, "pir-130@0xA0:modbus_rtu:57600");
}

#[cfg(unix)]
#[test]
fn every_parameter_round_trips_through_the_serial_driver_over_dcon() {
    every_parameter_round_trips_over(Way::PseudoTerminal, "pir-234@1:dcon:115200");
    every_parameter_round_trips_over(Way::PseudoTerminal, "pir-130@0xA0:dcon:38400");
}

#[cfg(unix)]
#[test]
fn every_parameter_round_trips_through_the_serial_driver_over_dcon_with_checksum() {
    every_parameter_round_trips_over(Way::PseudoTerminal, "pir-234@1:dcon:115200:checksum");
    every_parameter_round_trips_over(Way::PseudoTerminal, "pir-130@0xA0:dcon:115200:checksum");
}

/// The other seven speeds are silence to a module, and the port goes through all of them in place.
#[cfg(unix)]
#[test]
fn one_open_port_reaches_modules_at_every_speed() {
    let specs: Vec<String> =
        BaudRate::ALL.iter().enumerate().map(|(i, rate)| format!("pir-234@{}:modbus_rtu:{rate}", i + 1)).collect();
    let parsed: Vec<ModuleSpec> = specs.iter().map(|spec| spec.parse().expect("a specification")).collect();
    let sim = Sim::new(&parsed, Pace::Real);
    let pty = PtyServer::open(&sim, None).expect("a pseudo-terminal");
    let port = LineAddress::Serial { port: pty.path().display().to_string() };
    let mut dialogue = Dialogue::open(&port, LineSettings::default(), Box::new(|_| {})).expect("an open port");
    for spec in &parsed {
        let (address, protocol, settings) = (spec.address, spec.protocol, spec.settings);
        let target = Target { address, protocol, settings, checksum: false };
        assert_eq!(identified(&mut dialogue, target).model(), "pir-234", "{target}");
        let wrong = BaudRate::ALL[(usize::from(address)) % 8];
        let deaf = Target { settings: LineSettings { baud_rate: wrong, ..settings }, ..target };
        let (catalogue, _) = Catalogue::built_in();
        let mut speaker = dialogue.with(deaf, Patience::scan(Duration::from_millis(60)));
        assert_eq!(identify(&catalogue, protocol, address, &mut speaker).map(|_| ()), Err(Failure::Silent));
    }
}

#[test]
fn a_module_that_was_given_another_address_is_read_back_there() {
    for spec in ["pir-234@1:dcon", "pir-234@1:modbus_rtu", "pir-130@1:dcon:checksum", "pir-130@1:modbus_rtu"] {
        let mut bench = Bench::open(spec);
        let address = bench.definition.item("address").expect("an address").clone();
        let wanted = address.parse("0x2A").expect("a value");
        assert_eq!(bench.write(&address, &wanted), wanted, "{spec}");
        bench.target.address = 0x2A;
        assert_eq!(identified(&mut bench.dialogue, bench.target).model(), bench.definition.id);
    }
}

#[test]
fn init_settings_are_refused_without_init_with_a_hint_and_apply_after_a_power_cycle() {
    for spec in ["pir-234@1:dcon", "pir-130@1:modbus_rtu"] {
        let mut bench = Bench::open(spec);
        let speed = bench.definition.item("baud_rate").expect("a speed").clone();
        let wanted = Value::Choice("19200".into());
        let mut speaker = bench.dialogue.with(bench.target, Patience::CONVERSATION);
        let refused =
            write_item(&bench.definition, bench.target.protocol, 1, &speed, &wanted, &mut speaker).unwrap_err();
        assert!(refused.to_string().contains("INIT"), "{refused}");
        bench.sim.set_init(1, true);
        assert_eq!(bench.write(&speed, &wanted), wanted);
        assert_eq!(bench.read("baud_rate"), wanted, "still at the old speed");
        bench.sim.power_cycle(1);
        bench.target.settings = LineSettings { baud_rate: "19200".parse().expect("a rate"), ..bench.target.settings };
        assert_eq!(identified(&mut bench.dialogue, bench.target).model(), bench.definition.id);
    }
}

#[test]
fn every_action_is_understood_by_the_modules_that_have_it() {
    for spec in ["pir-234@1:dcon", "pir-234@1:modbus_rtu", "pir-130@1:dcon", "pir-130@1:modbus_rtu"] {
        let mut bench = Bench::open(spec);
        let definition = bench.definition.clone();
        let offered = definition.actions.iter().filter(|action| action.is_offered(bench.target.protocol));
        for action in offered.filter(|action| action.optional.is_none()) {
            let mut speaker = bench.dialogue.with(bench.target, Patience::CONVERSATION);
            run_action(action, bench.target.protocol, 1, &mut speaker)
                .unwrap_or_else(|error| panic!("{} over {}: {error}", action.id, bench.target));
        }
    }
}

#[test]
fn readings_agree_with_what_the_module_measures() {
    for spec in ["pir-234@1:dcon", "pir-234@1:modbus_rtu"] {
        let mut bench = Bench::open(spec);
        bench.sim.set_temperature(1, -12.34);
        bench.sim.set_humidity(1, 64.69);
        bench.sim.advance(std::time::Duration::from_secs(60));
        assert_eq!(bench.read("temperature_c").to_string(), "-12.34");
        assert_eq!(bench.read("temperature_f").to_string(), "9.79");
        assert_eq!(bench.read("humidity").to_string(), "64.69");
    }
}

#[test]
fn motion_is_seen_in_both_protocols_on_both_models() {
    for spec in ["pir-234@1:dcon", "pir-234@1:modbus_rtu", "pir-130@1:dcon", "pir-130@1:modbus_rtu"] {
        let mut bench = Bench::open(spec);
        if bench.definition.item("pir").is_none_or(|item| !item.is_offered(bench.target.protocol)) {
            continue;
        }
        for moving in [true, false] {
            bench.sim.set_motion(1, 0, moving);
            bench.sim.advance(std::time::Duration::from_secs(10_000));
            assert_eq!(bench.read("pir"), Value::Bool(moving), "{spec}");
        }
    }
}

#[test]
fn the_definitions_name_every_reading_as_such() {
    let (catalogue, _) = Catalogue::built_in();
    for definition in catalogue.iter() {
        for item in definition.items.iter().filter(|item| item.item_kind == ItemKind::Reading) {
            assert!(item.read_only, "{}: {}", definition.id, item.id);
        }
        assert!(definition.items.iter().all(|item| !item.label.is_empty() && !item.help.is_empty()));
    }
}
