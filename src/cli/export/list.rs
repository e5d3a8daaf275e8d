//! What a recording has: modules, series, and the time they cover.

use jiff::tz::TimeZone;

use super::super::Outcome;
use super::super::output::{self, Table};
use crate::record::{History, MOST_EVENTS, Micros, ModuleInfo, Series, micros, module_names, timestamp};

pub fn print(history: &History, zone: &TimeZone) -> Outcome {
    let names = module_names(history);
    let name = |id| names.get(&id).map(String::as_str).unwrap_or_default();
    output::line("Modules")?;
    let mut table = Table::default();
    for (id, info) in history.modules() {
        table.row([name(id), &info.line, &speech(info), &info.name, &info.firmware]);
    }
    table.print()?;
    output::line("\nSeries")?;
    let mut table = Table::default();
    for (_, series) in history.series() {
        let Series { info, trend } = series;
        let first = trend.first().map(|first| time(micros(first), zone)).unwrap_or_default();
        let last = trend.last_sample().map(|last| time(last.at, zone)).unwrap_or_default();
        let (selector, count) = (format!("{}/{}", name(info.module), info.item), format!("{} samples", trend.len()));
        table.row([&selector, &info.label, &info.unit, &count, &first, &last]);
    }
    table.print()?;
    let events = events(history);
    match history.span().map(|span| span.map(|at| time(at, zone))) {
        Some([first, last]) => output::line(&format!("\nFrom {first} to {last}, {events}")),
        None => output::line(&format!("\nNo samples, {events}")),
    }
}

/// A history has the newest events only, and this one may not have all.
pub fn is_cut(history: &History) -> bool {
    history.events().len() >= MOST_EVENTS
}

/// `17 events`
pub fn events(history: &History) -> String {
    let (count, more) = (history.events().len(), if is_cut(history) { " or more" } else { "" });
    format!("{count}{more} events")
}

/// How the module is spoken to, such as `dcon 9600 n81 checksum`.
fn speech(info: &ModuleInfo) -> String {
    let ModuleInfo { protocol, baud_rate, data_format, checksum, .. } = info;
    let mut words = vec![protocol.clone()];
    words.extend(baud_rate.map(|rate| rate.to_string()));
    words.extend(data_format.clone());
    words.extend(checksum.then(|| "checksum".to_owned()));
    words.join(" ")
}

/// `2026-03-02T10:30:00+01:00`
pub fn time(at: Micros, zone: &TimeZone) -> String {
    timestamp(at).to_zoned(zone.clone()).strftime("%Y-%m-%dT%H:%M:%S%:z").to_string()
}
