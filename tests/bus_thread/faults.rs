//! What must hold on a line that goes wrong, whatever goes wrong on it.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use dcon_bench::bus::{BusCommand, BusEvent, ItemSet, Target, Values};
use dcon_bench::module::Value;
use dcon_bench::sim::{Fault, FaultKind, Faults};

use crate::harness::*;

/// Modules in every language that shows damage, each at a temperature of its own.
const MODULES: [&str; 5] = [
    "pir-234@1",
    "pir-234@2",
    "pir-234@0xA3:dcon:checksum",
    "pir-234@0xA4:dcon:checksum",
    "pir-130@0x12:dcon:checksum",
];

fn temperature(target: &Target) -> f64 {
    10.0 + f64::from(target.address) / 8.0
}

fn line() -> (Line, Vec<Target>) {
    let line = Line::open(&MODULES);
    let targets: Vec<Target> = MODULES.iter().map(|spec| target(spec)).collect();
    for target in &targets {
        line.sim.set_temperature(target.address, temperature(target));
        line.sim.set_humidity(target.address, 50.0);
        line.sim.set_motion(target.address, 0, false);
    }
    (line, targets)
}

fn identify_and_watch(line: &Line, targets: &[Target]) {
    for target in targets {
        let id = line.bus.next_id();
        line.bus.send(BusCommand::Identify { id, target: *target }).expect("room");
        line.until(|event| matches!(event, BusEvent::Identified { id: of, .. } if *of == id).then_some(()));
        let model = if target.address == 0x12 { "pir-130" } else { "pir-234" };
        let (id, definition) = (line.bus.next_id(), line.definition(model));
        let interval = Duration::from_millis(50);
        let watch = BusCommand::Watch { id, target: *target, definition, items: ItemSet::Live, interval };
        line.bus.send(watch).expect("room");
    }
}

/// What a module says when nothing is wrong.
type Truth = BTreeMap<(Target, String), Value>;

fn learn(line: &Line, targets: &[Target]) -> Truth {
    let mut truth = Truth::new();
    let mut heard: Vec<Target> = Vec::new();
    line.until(|event| {
        if let BusEvent::Read { target, values, .. } = event {
            for answer in values {
                let value = answer.result.clone().expect("a value on a healthy line");
                truth.insert((*target, answer.id.clone()), value);
            }
            heard.push(*target);
        }
        // Twice each: the second time with its optional parts.
        targets.iter().all(|target| heard.iter().filter(|at| *at == target).count() >= 3).then_some(())
    });
    truth
}

/// Values of an event, if it has any.
fn told(event: &BusEvent) -> Option<(Target, &Values)> {
    match event {
        BusEvent::Read { target, values, .. } | BusEvent::Reading { target, values, .. } => Some((*target, values)),
        _ => None,
    }
}

fn faults(all: &[&str]) -> Faults {
    let mut faults = Faults::default();
    for text in all {
        faults.set(text.parse::<Fault>().expect("a fault")).expect("a strength");
    }
    faults
}

/// Frames shown before a value that is wrong.
const MOST_SHOWN: usize = 60;

/// Polls with `faults` on, and returns how many values came; each has to be what its own module says.
fn poll_with(line: &Line, truth: &Truth, all: Faults, polls: usize) -> usize {
    let name: Vec<String> = all.iter().map(|fault| fault.to_string()).collect();
    let twin = all.is_on(FaultKind::Twin);
    let kinds: Vec<FaultKind> = all.iter().map(|fault| fault.kind).collect();
    let before = line.sim.injected();
    line.sim.set_faults(all);
    // What is told at first was asked before.
    let all_struck = || {
        let now = line.sim.injected();
        kinds.iter().all(|kind| now.get(kind) > before.get(kind))
    };
    let (mut seen, mut values_seen) = (0, 0);
    let mut frames: VecDeque<String> = VecDeque::new();
    line.until(|event| {
        if let BusEvent::Traffic(frame) = event {
            let bytes = frame.bytes.escape_ascii();
            frames.push_back(format!("{:.3} {:?} {:?} {bytes}", frame.at, frame.direction, frame.verdict));
            if frames.len() > MOST_SHOWN {
                frames.pop_front();
            }
        }
        if let Some((target, values)) = told(event) {
            seen += usize::from(matches!(event, BusEvent::Read { .. }));
            for answer in values {
                let Ok(value) = &answer.result else { continue };
                values_seen += 1;
                // The second of two modules at an address is a module, too.
                if !(twin && target.address == 1) {
                    let right = truth.get(&(target, answer.id.clone()));
                    assert_eq!(Some(value), right, "{name:?}: {target} {} after {frames:#?}", answer.id);
                }
            }
        }
        (seen >= polls && all_struck() || matches!(event, BusEvent::LineLost { .. })).then_some(())
    });
    values_seen
}

/// Until every module has told all its values again.
fn recover(line: &Line, targets: &[Target], truth: &Truth) {
    line.sim.set_faults(Faults::default());
    let mut well: Vec<Target> = Vec::new();
    line.until(|event| {
        if let BusEvent::Read { target, values, .. } = event
            && values.iter().all(|answer| answer.result.as_ref().ok() == truth.get(&(*target, answer.id.clone())))
            && !well.contains(target)
        {
            well.push(*target);
        }
        (well.len() == targets.len()).then_some(())
    });
}

#[test]
fn no_fault_makes_a_value_out_of_what_no_module_said_and_every_module_is_back_after_it() {
    let (line, targets) = line();
    identify_and_watch(&line, &targets);
    let truth = learn(&line, &targets);
    for kind in FaultKind::ALL {
        let mut all = Faults::default();
        all.switch_on(kind);
        poll_with(&line, &truth, all, 25);
        recover(&line, &targets, &truth);
        assert!(line.sim.injected().get(&kind).is_some_and(|count| *count > 0), "{kind:?} did not strike");
    }
}

#[test]
fn no_mixture_of_faults_makes_a_value_out_of_what_no_module_said() {
    let (line, targets) = line();
    identify_and_watch(&line, &targets);
    let truth = learn(&line, &targets);
    for mixture in [
        &["late=50%", "doubled=50%"][..],
        &["doubled=30%", "lost=2%"],
        &["flipped=2%", "lost=2%", "inserted=2%", "noise=30%"],
        &["echo", "late=30%", "wrong_address=20%", "cut=20%"],
        &["partial_echo", "doubled=100%"],
        &["late=100%"],
        &["wrong_checksum=40%", "late=40%", "doubled=40%", "echo"],
        &["twin=1", "late=20%", "doubled=20%", "clock_jump=-86400"],
    ] {
        poll_with(&line, &truth, faults(mixture), 50);
        recover(&line, &targets, &truth);
    }
}

#[test]
fn a_line_that_doubles_every_answer_brings_values() {
    let (line, targets) = line();
    identify_and_watch(&line, &targets);
    let truth = learn(&line, &targets);
    line.sim.set_faults(faults(&["doubled=100%"]));
    // What was told before this answer was asked before the fault.
    let (id, target) = (line.bus.next_id(), targets[0]);
    line.bus.send(BusCommand::Identify { id, target }).expect("room");
    line.until(|event| matches!(event, BusEvent::Identified { id: of, .. } if *of == id).then_some(()));
    let mut well: Vec<Target> = Vec::new();
    line.until(|event| {
        if let BusEvent::Read { target, values, .. } = event
            && values.iter().all(|answer| answer.result.as_ref().ok() == truth.get(&(*target, answer.id.clone())))
            && !well.contains(target)
        {
            well.push(*target);
        }
        (well.len() == targets.len()).then_some(())
    });
    assert!(line.sim.injected().get(&FaultKind::Doubled).is_some_and(|count| *count > 30));
}

#[test]
fn light_noise_is_seen_in_the_statistics_only() {
    let (line, targets) = line();
    identify_and_watch(&line, &targets);
    let truth = learn(&line, &targets);
    line.sim.set_faults(faults(&["flipped=0.05%", "lost=0.02%", "noise=1%"]));
    let (mut polls, mut missing) = (0, 0);
    line.until(|event| {
        if let BusEvent::Read { values, .. } = event {
            polls += 1;
            missing += usize::from(values.iter().any(|answer| answer.result.is_err()));
        }
        (polls >= 500).then_some(())
    });
    assert_eq!(missing, 0, "polls without a value, of {polls}");
    let repeats = line.until(|event| match event {
        BusEvent::Statistics(statistics) if statistics.repeats > 0 => Some(statistics.repeats),
        _ => None,
    });
    assert!(repeats > 0);
    recover(&line, &targets, &truth);
}

#[test]
fn a_line_of_late_answers_loses_some_values_of_a_module_and_not_all_that_follow() {
    for spec in ["pir-234@1", "pir-234@0xA3:dcon:checksum", "pir-234@0xA3:dcon"] {
        let (brought, wanted) = read_from_late_line(spec);
        assert!(brought * 2 > wanted, "{spec}: {brought} of {wanted}");
    }
}

/// Values that came, and that were asked for, when one answer in five is late.
fn read_from_late_line(spec: &str) -> (usize, usize) {
    let line = Line::open(&[spec]);
    let (target, definition) = (target(spec), line.definition("pir-234"));
    line.sim.set_faults(faults(&["late=20%"]));
    let (mut brought, mut wanted) = (0, 0);
    for _ in 0..10 {
        let (id, definition) = (line.bus.next_id(), definition.clone());
        line.bus.send(BusCommand::Read { id, target, definition, items: ItemSet::All }).expect("room");
        let values = line.until(|event| match event {
            BusEvent::Read { id: of, values, .. } if *of == id => Some(values.clone()),
            _ => None,
        });
        let good = values.iter().filter(|answer| answer.result.is_ok()).count();
        // Whoever does not answer the first question is taken for absent.
        if good > 0 {
            (brought, wanted) = (brought + good, wanted + values.len());
        }
    }
    (brought, wanted)
}
