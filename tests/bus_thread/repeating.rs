//! Actions that are repeated, such as Host OK.

use std::time::Duration;

use dcon_bench::bus::{BusCommand, BusEvent, RequestId, Target};
use dcon_bench::sim::Pace;

use crate::harness::*;

const PERIOD: Duration = Duration::from_millis(50);

fn repeat(line: &Line, target: Target) -> RequestId {
    let id = line.bus.next_id();
    let (definition, action) = (line.definition("pir-234"), "host_ok".to_owned());
    line.bus.send(BusCommand::Repeat { id, target, definition, action, period: PERIOD }).expect("room");
    id
}

fn stop(line: &Line, target: Target) {
    line.bus.send(BusCommand::StopRepeating { target, action: "host_ok".to_owned() }).expect("room");
    // Everything that was under way is over once a later question is answered.
    line.read(target, &line.definition("pir-234"), "name").unwrap();
}

fn sent(line: &Line, repeated: RequestId) {
    line.until(|event| match event {
        BusEvent::Acted { id, result, .. } if *id == repeated => {
            assert_eq!(*result, Ok(()));
            Some(())
        }
        _ => None,
    });
}

fn write(line: &Line, target: Target, item: &str, text: &str) {
    let definition = line.definition("pir-234");
    let (id, value) = (line.bus.next_id(), definition.item(item).unwrap().parse(text).unwrap());
    line.bus.send(BusCommand::Write { id, target, definition, item: item.into(), value }).expect("room");
    line.until(|event| matches!(event, BusEvent::Written { result: Ok(_), .. }).then_some(()));
}

#[test]
fn a_repeated_action_is_sent_until_it_is_stopped_and_not_once_more() {
    let spec = "pir-234@1:dcon:9600";
    let line = Line::open(&[spec]);
    let id = repeat(&line, target(spec));
    (0..3).for_each(|_| sent(&line, id));
    stop(&line, target(spec));
    let heard = line.sim.requests();
    line.read(target(spec), &line.definition("pir-234"), "name").unwrap();
    assert_eq!(line.sim.requests(), heard + 1);
}

#[test]
fn a_repetition_that_takes_longer_than_its_period_leaves_the_line_to_others() {
    let line = Line::open_at(Pace::Real, &["pir-234@1:dcon:9600", "pir-234@2:dcon:9600"]);
    line.sim.set_dead(1, true);
    let id = repeat(&line, target("pir-234@1:dcon:9600"));
    line.until(|event| matches!(event, BusEvent::Acted { id: of, result: Err(_), .. } if *of == id).then_some(()));
    let name = line.read(target("pir-234@2:dcon:9600"), &line.definition("pir-234"), "name");
    assert!(name.is_ok(), "{name:?}");
}

#[test]
fn a_repeated_action_keeps_the_host_watchdog_from_tripping() {
    let spec = "pir-234@1:dcon:9600";
    let line = Line::open(&[spec]);
    let target = target(spec);
    write(&line, target, "wdt_timeout", "5.0");
    write(&line, target, "wdt_enabled", "true");
    let id = repeat(&line, target);
    for _ in 0..4 {
        // The second one was sent after the time had passed.
        (0..2).for_each(|_| sent(&line, id));
        line.sim.advance(Duration::from_secs(3));
    }
    assert_eq!(line.sim.setting(1, "wdt_tripped").as_deref(), Some("false"));
    stop(&line, target);
    line.sim.advance(Duration::from_secs(6));
    assert_eq!(line.sim.setting(1, "wdt_tripped").as_deref(), Some("true"));
}

#[test]
fn a_repetition_follows_its_module_to_a_new_address() {
    let spec = "pir-234@1:dcon:9600";
    let line = Line::open(&[spec]);
    let repeated = repeat(&line, target(spec));
    sent(&line, repeated);
    write(&line, target(spec), "address", "9");
    line.until(|event| match event {
        BusEvent::Acted { id, target, .. } if *id == repeated => (target.address == 9).then_some(()),
        _ => None,
    });
}
