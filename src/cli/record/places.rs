//! The modules that are recorded: each is asked what it is, again and again until it says so, and then polled.

use std::sync::Arc;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::super::Outcome;
use super::super::session::{self, Session};
use super::roll::Roll;
use crate::bench::{Observer, module_info, silence};
use crate::bus::{Answer, BusCommand, ItemSet, RequestId, Target, Values};
use crate::module::{Definition, Identified};
use crate::protocol::Failure;
use crate::record::{EventKind, History};

/// Until a module that did not say what it is is asked again: at first, and at most.
const FIRST_PAUSE: Duration = Duration::from_secs(2);
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

pub struct Places {
    all: Vec<Place>,
    /// The line as people see it.
    line: String,
    interval: Duration,
}

struct Place {
    target: Target,
    stage: Stage,
    /// Why it is not polled, as it was last said.
    said: Option<String>,
}

enum Stage {
    /// It is asked what it is when `due`.
    Unknown {
        due: Instant,
        pause: Duration,
    },
    Asked {
        id: RequestId,
        pause: Duration,
    },
    Polled {
        id: RequestId,
        definition: Arc<Definition>,
        observer: Observer,
    },
}

impl Places {
    /// How many modules there are.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    pub fn new(targets: Vec<Target>, line: String, interval: Duration) -> Self {
        let due = Instant::now();
        let place = |target| Place { target, stage: Stage::Unknown { due, pause: FIRST_PAUSE }, said: None };
        Self { all: targets.into_iter().map(place).collect(), line, interval }
    }

    /// Asks the module whose turn it is what it is: one at a time, so that those that answer are polled meanwhile.
    pub fn ask_next(&mut self, session: &Session) -> Outcome {
        if self.all.iter().any(|place| matches!(place.stage, Stage::Asked { .. })) {
            return Ok(());
        }
        let due = |place: &&mut Place| if let Stage::Unknown { due, .. } = place.stage { Some(due) } else { None };
        let next = self.all.iter_mut().filter(|place| due(place).is_some()).min_by_key(due);
        let Some(Place { target, stage, .. }) = next else { return Ok(()) };
        if let Stage::Unknown { due, pause } = *stage
            && due <= Instant::now()
        {
            let target = *target;
            let id = session.send(|id| BusCommand::Identify { id, target })?;
            *stage = Stage::Asked { id, pause };
        }
        Ok(())
    }

    /// Takes in what a module said of itself.
    pub fn identified(
        &mut self,
        session: &Session,
        roll: &mut Roll,
        id: RequestId,
        result: Result<Identified, Failure>,
    ) -> Outcome {
        let Self { all, line, interval } = self;
        let asked = |place: &&mut Place| matches!(place.stage, Stage::Asked { id: of, .. } if of == id);
        let Some(place) = all.iter_mut().find(asked) else { return Ok(()) };
        let target = place.target;
        let reason = match result {
            Ok(identified) => match identified.definition.clone() {
                Some(definition) if definition.live_items(target.protocol).next().is_some() => {
                    return place.poll(session, roll, line, *interval, identified, definition);
                }
                Some(definition) => format!("{} has no readings over {}", definition.label, target.protocol.label()),
                None => session::unknown(&target, &identified),
            },
            // That was said of the line already.
            Err(Failure::LineLost(_)) => {
                place.wait();
                return Ok(());
            }
            Err(failure) => session::not_identified(&target, &failure),
        };
        place.say(roll, reason);
        place.wait();
        Ok(())
    }

    /// Nothing was asked for a while: all lines have a gap from here on.
    pub fn pause(&mut self, history: &mut History) {
        for Place { stage, .. } in &mut self.all {
            if let Stage::Polled { observer, .. } = stage {
                observer.pause(history);
            }
        }
    }

    /// Takes in what a poll brought.
    pub fn take(&mut self, roll: &mut Roll, id: RequestId, at: Timestamp, values: Values) {
        for Place { target, stage, .. } in &mut self.all {
            let Stage::Polled { id: of, definition, observer } = stage else { continue };
            if *of == id {
                let label = format!("{} at {target}", definition.label);
                return take(roll, definition, observer, self.interval, &label, at, values);
            }
        }
    }

    /// Takes in the values that a poll under way has brought.
    pub fn take_so_far(&mut self, roll: &mut Roll, id: RequestId, values: &Values) {
        for Place { stage, .. } in &mut self.all {
            if let Stage::Polled { id: of, definition, observer } = stage
                && *of == id
            {
                values.iter().for_each(|answer| take_answer(roll, definition, observer, self.interval, answer));
            }
        }
    }
}

impl Place {
    /// The module is known now, and polled from here on.
    fn poll(
        &mut self,
        session: &Session,
        roll: &mut Roll,
        line: &str,
        interval: Duration,
        identified: Identified,
        definition: Arc<Definition>,
    ) -> Outcome {
        let (target, watched) = (self.target, definition.clone());
        let watch = |id| BusCommand::Watch { id, target, definition: watched, items: ItemSet::Live, interval };
        let id = session.send(watch)?;
        let observer = Observer::new(&mut roll.history, module_info(line, &target, &identified));
        roll.of_module(observer.id(), Timestamp::now(), EventKind::Found, format!("Found at {target}"));
        if self.said.take().is_some() {
            roll.message(&format!("{} at {target} answers, and is recorded", definition.label));
        }
        self.stage = Stage::Polled { id, definition, observer };
        Ok(())
    }

    /// It is asked again later.
    fn wait(&mut self) {
        let pause = if let Stage::Asked { pause, .. } = self.stage { pause } else { FIRST_PAUSE };
        let due = Instant::now().checked_add(pause).unwrap_or_else(Instant::now);
        self.stage = Stage::Unknown { due, pause: pause.saturating_mul(2).min(LONGEST_PAUSE) };
    }

    /// Why it is not polled, once.
    fn say(&mut self, roll: &mut Roll, reason: String) {
        if self.said.as_ref() != Some(&reason) {
            roll.message(&format!("{reason}; it is asked again now and then"));
            self.said = Some(reason);
        }
    }
}

fn take(
    roll: &mut Roll,
    definition: &Definition,
    observer: &mut Observer,
    interval: Duration,
    label: &str,
    at: Timestamp,
    values: Values,
) {
    let silent = silence(&values);
    let first = values.iter().map(|answer| answer.at).min().unwrap_or(at);
    let when = silent.map_or(first, |(at, _)| at);
    if let Some(entry) = observer.presence(when, silent.map(|(_, failure)| failure)) {
        if !silent.is_some_and(|(_, failure)| matches!(failure, Failure::LineLost(_))) {
            roll.message(&format!("{label}: {}", entry.text));
        }
        roll.history.add_event(entry.to_event(Some(observer.id())));
    }
    values.iter().for_each(|answer| take_answer(roll, definition, observer, interval, answer));
}

fn take_answer(roll: &mut Roll, definition: &Definition, observer: &mut Observer, interval: Duration, answer: &Answer) {
    let Answer { id, at, result } = answer;
    match (result, definition.item(id)) {
        (Err(_), _) => observer.missing(&mut roll.history, id),
        (Ok(value), Some(item)) => {
            if let Some(entry) = observer.value(&mut roll.history, item, *at, value, Some(interval)) {
                roll.history.add_event(entry.to_event(Some(observer.id())));
            }
        }
        (Ok(_), None) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::module::{Catalogue, Value};
    use crate::protocol::{LineSettings, Protocol};
    use crate::record::{ModuleInfo, timestamp};

    #[test]
    fn a_pause_leaves_a_gap_in_the_lines_of_every_polled_module() {
        let mut history = History::default();
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        let targets = [1, 2, 3].map(|address| Target {
            address,
            protocol: Protocol::ModbusRtu,
            settings: LineSettings::default(),
            checksum: false,
        });
        let mut places = Places::new(targets.into(), "COM3".to_owned(), Duration::from_secs(1));
        for (place, address) in places.all.iter_mut().zip([1, 2]) {
            let info = ModuleInfo { address, ..ModuleInfo::default() };
            let (id, observer) = (RequestId(address.into()), Observer::new(&mut history, info));
            place.stage = Stage::Polled { id, definition: definition.clone(), observer };
        }
        for second in 0..3 {
            if second == 2 {
                places.pause(&mut history);
            }
            for place in &mut places.all {
                let Stage::Polled { observer, .. } = &mut place.stage else { continue };
                let (item, at) = (definition.item("pir1").unwrap(), timestamp(second * 1_000_000));
                observer.value(&mut history, item, at, &Value::Bool(false), Some(Duration::from_secs(1)));
            }
        }
        let gaps: Vec<Vec<bool>> = history
            .series()
            .map(|(_, series)| {
                let columns = series.trend.blocks().iter().filter_map(|block| block.samples.as_ref());
                columns.flat_map(|columns| columns.iter()).map(|sample| sample.gap).collect()
            })
            .collect();
        assert_eq!(gaps, [[false, false, true], [false, false, true]]);
    }
}
