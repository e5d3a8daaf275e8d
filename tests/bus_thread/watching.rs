//! Polls, and what becomes of them when the adapter is pulled.

use dcon_bench::bus::{BusCommand, BusEvent, ItemSet};
use std::time::Duration;

use crate::harness::*;

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
            let warm = values.iter().any(|answer| {
                answer.id == "temperature_c" && answer.result.as_ref().is_ok_and(|v| v.to_string() == "24.99")
            });
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
            values.iter().all(|answer| answer.result.is_ok()).then_some(())
        }
        _ => None,
    });
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
        BusEvent::Read { values, .. } => values.iter().all(|answer| answer.result.is_ok()).then_some(()),
        _ => None,
    });
}
