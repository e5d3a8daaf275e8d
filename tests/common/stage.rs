//! A bench whose bus is played by the test, so that every value and every time is the same in each run.
//!
//! The values come from simulated modules, through the real conversation; only the times are made up.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::Duration;

use dcon_bench::bench::{Action, Bench};
use dcon_bench::bus::dialogue::Dialogue;
use dcon_bench::bus::{Answer, Bus, BusCommand, BusEvent, ItemSet, LineAddress, Patience, Target, Values};
use dcon_bench::module::{Catalogue, Definition, Identified, identify, present_options, read_items};
use dcon_bench::protocol::LineSettings;
use dcon_bench::sim::{ModuleSpec, Pace, Sim};
use jiff::Timestamp;

/// The present of every test: 2 March 2026, 09:30 UTC.
pub fn now() -> Timestamp {
    Timestamp::from_second(1_772_443_800).unwrap()
}

/// How long ago settings were read.
const READ_AGO: Duration = Duration::from_secs(4);

pub struct Stage {
    pub sim: Sim,
    commands: Receiver<BusCommand>,
    events: SyncSender<BusEvent>,
    catalogue: Arc<Catalogue>,
    dialogue: Dialogue,
    modules: Vec<(Target, Identified)>,
    next_id: u64,
}

impl Stage {
    /// A bench on an open simulated line with these modules, all found; answered until nothing is asked any more.
    pub fn new(specs: &[&str]) -> (Bench, Self) {
        let specs: Vec<ModuleSpec> = specs.iter().map(|spec| spec.parse().unwrap()).collect();
        let sim = Sim::new(&specs, Pace::Skip);
        let line = LineAddress::Simulated { label: "Simulated line".to_owned(), sim: sim.clone() };
        let catalogue = Arc::new(Catalogue::built_in().0);
        let (bus, commands, events) = Bus::detached();
        let mut bench = Bench::new(bus, catalogue.clone(), &[]).with_clock(now);
        let dialogue = Dialogue::open(&line, LineSettings::default(), Box::new(|_| {})).unwrap();
        let mut stage = Self { sim, commands, events, catalogue, dialogue, modules: Vec::new(), next_id: 1_000_000 };
        bench.apply(Action::Connect { line, settings: LineSettings::default() });
        stage.play(&mut bench);
        for spec in specs {
            stage.find(&mut bench, &spec);
        }
        (bench, stage)
    }

    fn find(&mut self, bench: &mut Bench, spec: &ModuleSpec) {
        let target =
            Target { address: spec.address, protocol: spec.protocol, settings: spec.settings, checksum: spec.checksum };
        self.sim.set_temperature(spec.address, 24.99);
        self.sim.set_humidity(spec.address, 61.2);
        self.sim.set_motion(spec.address, 0, false);
        let mut speaker = self.dialogue.with(target, Patience::CONVERSATION);
        let identified = identify(&self.catalogue, target.protocol, target.address, &mut speaker).unwrap();
        self.modules.push((target, identified.clone()));
        bench.take(BusEvent::Found { id: self.id(), target, identified });
    }

    fn id(&mut self) -> dcon_bench::bus::RequestId {
        self.next_id += 1;
        dcon_bench::bus::RequestId(self.next_id)
    }

    pub fn targets(&self) -> Vec<Target> {
        self.modules.iter().map(|(target, _)| *target).collect()
    }

    fn definition(&self, target: &Target) -> Option<Arc<Definition>> {
        self.modules.iter().find(|(known, _)| known == target).and_then(|(_, found)| found.definition.clone())
    }

    /// Polls a module once a second until now, for so many seconds, while its air and its visitors change.
    pub fn live(&mut self, bench: &mut Bench, target: Target, seconds: u32) {
        let Some(definition) = self.definition(&target) else { return };
        bench.apply(Action::SetInterval(target, Duration::from_secs(1)));
        for second in 0..=seconds {
            let phase = f64::from(second) / 9.0;
            self.sim.set_temperature(target.address, 24.5 + phase.sin() * 0.6);
            self.sim.set_humidity(target.address, 60.0 + (phase * 0.7).cos() * 2.5);
            self.sim.set_motion(target.address, 1, second % 40 > 25);
            self.sim.set_motion(target.address, 3, second % 25 > 18);
            self.sim.advance(Duration::from_secs(1));
            let parts = self.parts(target, &definition);
            let ids = definition.live_ids(target.protocol, &parts).into_iter().map(str::to_owned).collect();
            let at = now() - Duration::from_secs(u64::from(seconds - second));
            let values = self.values(target, &definition, ids, at);
            let id = self.id();
            bench.take(BusEvent::Read { id, target, at, values });
        }
        bench.apply(Action::StopPolling(target));
    }

    fn parts(&mut self, target: Target, definition: &Definition) -> Vec<String> {
        let mut speaker = self.dialogue.with(target, Patience::CONVERSATION);
        present_options(definition, target.protocol, &mut speaker).unwrap()
    }

    /// What the module says, all of it at the made-up time.
    fn values(&mut self, target: Target, definition: &Arc<Definition>, ids: Vec<String>, at: Timestamp) -> Values {
        let mut speaker = self.dialogue.with(target, Patience::CONVERSATION);
        let ids = ids.iter().map(String::as_str);
        let values = read_items(definition, target.protocol, target.address, ids, &mut speaker);
        values.into_iter().map(|answer| Answer { at, ..answer }).collect()
    }

    /// Does what the bench has asked for. True if there was anything.
    pub fn play(&mut self, bench: &mut Bench) -> bool {
        let commands: Vec<BusCommand> = self.commands.try_iter().collect();
        for command in &commands {
            if let Some(event) = self.answer(command) {
                bench.take(event);
            }
        }
        !commands.is_empty()
    }

    /// Does what the bench of a window has asked for; the answers wait until the window takes them in.
    pub fn play_into_window(&mut self) -> bool {
        let commands: Vec<BusCommand> = self.commands.try_iter().collect();
        for command in &commands {
            if let Some(event) = self.answer(command) {
                self.events.send(event).unwrap();
            }
        }
        !commands.is_empty()
    }

    fn answer(&mut self, command: &BusCommand) -> Option<BusEvent> {
        let at = now() - READ_AGO;
        match command {
            BusCommand::Open { id, line, .. } => Some(BusEvent::Opened { id: *id, line: line.to_string() }),
            BusCommand::Watch { target, definition, .. } => {
                Some(BusEvent::Parts { target: *target, present: self.parts(*target, definition) })
            }
            BusCommand::Read { id, target, definition, items: ItemSet::Named(ids) } => {
                let values = self.values(*target, definition, ids.clone(), at);
                Some(BusEvent::Read { id: *id, target: *target, at, values })
            }
            _ => None,
        }
    }
}
