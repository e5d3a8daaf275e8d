//! `watch`: readings again and again.

use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use jiff::Timestamp;
use jiff::tz::TimeZone;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::line_args::{LineArgs, ModuleArgs};
use super::session::Module;
use super::signals::Interrupt;
use super::stop::Stop;
use super::{Outcome, output, parse};
use crate::bus::{Answer, BusCommand, BusEvent, ItemSet, Values};
use crate::module::Definition;

/// How long an interrupt may remain unnoticed.
const LOOK_UP_EVERY: Duration = Duration::from_millis(50);

/// Options of `watch`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Read a module again and again",
    long_about = "Read what changes in a module again and again, and print one line for each set of readings.\n\nA module \
                  that stays silent is reported on standard error and asked again. Ends after --count sets, or at an \
                  interrupt (Ctrl-C); the exit code is 1 only if none of --count sets brought a value.",
    after_help = "Examples:\n  dcon-bench watch --port /dev/ttyUSB0 --address 1\n  dcon-bench watch --port COM3 --address 1 \
                  --interval 0 --count 1000 --json > readings.jsonl"
)]
pub struct WatchArgs {
    /// Time from one set to the next; 0 is as fast as the line allows
    #[arg(long, value_name = "DURATION", default_value = "1s", value_parser = parse::interval)]
    interval: Duration,
    /// End after so many sets
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: Option<u64>,
    /// Print one object a line, with the time and the readings by name
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    module: ModuleArgs,
}

pub fn run(args: &WatchArgs) -> Outcome {
    let interrupt = Interrupt::catch()?;
    let module = Module::open(&args.line, &args.module, |_, _| Ok(()))?;
    let (target, definition, interval) = (module.target, module.definition.clone(), args.interval);
    if definition.live_items(target.protocol).next().is_none() {
        return Err(Stop::failed(format!("{} has no readings over {}", definition.label, target.protocol.label())));
    }
    if !definition.optional.is_empty() {
        // Now it is known which optional parts there are, so that the first set lacks none.
        module.session.read(target, &definition, ItemSet::Live)?;
    }
    let mut printer = Printer::new(definition.clone(), args.json);
    let watch = |id| BusCommand::Watch { id, target, definition, items: ItemSet::Live, interval };
    let id = module.session.send(watch)?;
    let (mut sets, mut good_sets) = (0u64, 0u64);
    while !interrupt.came() && args.count.is_none_or(|count| sets < count) {
        match module.session.event(LOOK_UP_EVERY)? {
            Some(BusEvent::Read { id: of, at, values, .. }) if of == id => {
                sets = sets.saturating_add(1);
                good_sets = good_sets.saturating_add(u64::from(values.iter().any(|answer| answer.result.is_ok())));
                printer.print(at, &values)?;
            }
            Some(BusEvent::LineLost { reason }) => {
                output::message(&format!("the line was lost: {reason} – waiting for it to come back"));
            }
            Some(BusEvent::LineRestored { line }) => output::message(&format!("the line is back: {line}")),
            _ => {}
        }
    }
    if good_sets == 0 && args.count.is_some_and(|count| sets >= count) { Err(Stop::Reported) } else { Ok(()) }
}

/// Prints sets of readings, and what is wrong with them when that changes.
struct Printer {
    definition: Arc<Definition>,
    json: bool,
    zone: TimeZone,
    /// What was last said to be missing.
    missing: Vec<String>,
    /// Of each column so far.
    widths: Vec<usize>,
}

impl Printer {
    fn new(definition: Arc<Definition>, json: bool) -> Self {
        Self { definition, json, zone: TimeZone::system(), missing: Vec::new(), widths: Vec::new() }
    }

    fn print(&mut self, at: Timestamp, values: &Values) -> Outcome {
        let time = at.to_zoned(self.zone.clone());
        if self.json {
            let time = time.strftime("%Y-%m-%dT%H:%M:%S%.3f%:z").to_string();
            output::json(&SetObject { time, values })?;
        } else if values.iter().any(|answer| answer.result.is_ok()) {
            let columns = self.columns(values);
            output::line(&format!("{}  {columns}", time.strftime("%H:%M:%S%.3f")))?;
        }
        let missing = output::missing(values);
        if missing != self.missing {
            let clock = time.strftime("%H:%M:%S%.3f");
            missing.iter().for_each(|reason| output::message(&format!("{clock}  {reason}")));
            if missing.is_empty() {
                output::message(&format!("{clock}  everything answers again"));
            }
            self.missing = missing;
        }
        Ok(())
    }

    /// `temperature_c=22.51 °C  humidity=43.20 %`, each as wide as it ever was.
    fn columns(&mut self, values: &Values) -> String {
        self.widths.resize(values.len().max(self.widths.len()), 0);
        let mut columns = String::new();
        for (Answer { id, result, .. }, width) in values.iter().zip(&mut self.widths) {
            let value = result.as_ref().map_or_else(|_| "–".to_owned(), ToString::to_string);
            let unit = self.definition.item(id).map(|item| item.unit.as_str()).unwrap_or_default();
            let column = format!("{id}={value} {unit}").trim_end().to_owned();
            *width = (*width).max(column.chars().count());
            let width = *width;
            columns.push_str(&format!("{column:width$}  "));
        }
        columns.trim_end().to_owned()
    }
}

/// One set of readings in JSON.
struct SetObject<'a> {
    time: String,
    values: &'a Values,
}

impl Serialize for SetObject<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len().saturating_add(1)))?;
        map.serialize_entry("time", &self.time)?;
        for Answer { id, result, .. } in self.values {
            map.serialize_entry(id, &result.as_ref().ok())?;
        }
        map.end()
    }
}
