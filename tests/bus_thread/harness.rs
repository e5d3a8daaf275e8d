//! A bus thread on a simulated line, and how the tests talk to it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use dcon_bench::bus::{Bus, BusCommand, BusEvent, ItemSet, LineAddress, ScanPlan, ScanSummary, Target};
use dcon_bench::module::{Catalogue, Definition, Identified, Value};
use dcon_bench::protocol::{Failure, LineSettings};
use dcon_bench::sim::{ModuleSpec, Pace, Sim};

/// Longer than anything here takes; only a hang reaches it.
pub const LIMIT: Duration = Duration::from_secs(60);

pub struct Line {
    pub bus: Bus,
    pub sim: Sim,
    pub catalogue: Arc<Catalogue>,
}

impl Line {
    pub fn open(specs: &[&str]) -> Self {
        Self::open_at(Pace::Skip, specs)
    }

    pub fn open_at(pace: Pace, specs: &[&str]) -> Self {
        let specs: Vec<ModuleSpec> = specs.iter().map(|spec| spec.parse().expect("a specification")).collect();
        let sim = Sim::new(&specs, pace);
        let catalogue = Arc::new(Catalogue::built_in().0);
        let bus = Bus::start(catalogue.clone(), || {}).expect("a thread");
        let line = LineAddress::Simulated { label: "test".into(), sim: sim.clone() };
        let id = bus.next_id();
        bus.send(BusCommand::Open { id, line, settings: LineSettings::default() }).expect("room");
        let this = Self { bus, sim, catalogue };
        this.until(|event| matches!(event, BusEvent::Opened { .. }).then_some(()));
        this
    }

    pub fn definition(&self, id: &str) -> Arc<Definition> {
        self.catalogue.get(id).expect("a definition")
    }

    /// Waits for the first event of which `pick` makes something.
    pub fn until<T>(&self, mut pick: impl FnMut(&BusEvent) -> Option<T>) -> T {
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

    pub fn scan(&self, plan: ScanPlan) -> (Vec<(Target, Identified)>, ScanSummary) {
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

    pub fn read(&self, target: Target, definition: &Arc<Definition>, name: &str) -> Result<Value, Failure> {
        let id = self.bus.next_id();
        let items = ItemSet::Named(vec![name.into()]);
        self.bus.send(BusCommand::Read { id, target, definition: definition.clone(), items }).expect("room");
        self.until(|event| match event {
            BusEvent::Read { id: answered, values, .. } if *answered == id => {
                values.first().map(|answer| answer.result.clone())
            }
            _ => None,
        })
    }
}

pub fn target(spec: &str) -> Target {
    let spec: ModuleSpec = spec.parse().expect("a specification");
    Target { address: spec.address, protocol: spec.protocol, settings: spec.settings, checksum: spec.checksum }
}

pub fn models(found: &[(Target, Identified)]) -> Vec<(u8, String)> {
    let mut models: Vec<_> = found.iter().map(|(target, who)| (target.address, who.model().to_owned())).collect();
    models.sort();
    models
}
