//! `export`: takes a recording away in other formats.

mod list;
mod moment;
mod select;

use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use jiff::tz::TimeZone;

use super::signals::Interrupt;
use super::stop::Stop;
use super::terminal::TerminalLine;
use super::{Outcome, output, parse};
use crate::record::{
    EventRows, Export, ExportError, ExportJob, Format, History, MOST_EVENTS, Micros, Progress, Recording, Rows, Source,
    micros_of,
};
use moment::Moment;

/// How long an interrupt may remain unnoticed.
const LOOK_UP_EVERY: Duration = Duration::from_millis(50);
const SHOW_EVERY: Duration = Duration::from_millis(200);

/// Options of `export`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Take a recording away as CSV, JSON Lines or Parquet",
    long_about = "Take a recording away as CSV, JSON Lines or Parquet: to standard output, or to a file that has its name \
                  only once it is whole. The recording may grow meanwhile.\n\nThe first column is the time, in ISO 8601 \
                  with the offset of the local zone (--utc: of UTC; Parquet has UTC always). With --rows time, which is the \
                  default, there is one row for each time and a column for each series, named by module, series and unit; \
                  as the answers of one poll come one after another, --within 500ms lets them share a row. With --rows \
                  sample there is one row for each sample, whose last column says whether samples are missing before it. \
                  Numbers have the digits that the module sent.\n\nA time for --from and --to is a date and time with \
                  or without an offset, a day, a time of the recording's last day, or a duration back from its end such as \
                  -1h; both ends are included.",
    after_help = "Examples:\n  dcon-bench export hall.sqlite --within 500ms > hall.csv\n  dcon-bench export hall.sqlite --out hall.parquet \
                  --from -24h\n  dcon-bench export hall.sqlite --series temperature_c,1/humidity --from 2026-03-02T08:00 --to \
                  2026-03-02T18:00 --utc\n  dcon-bench export hall.sqlite --events --format jsonl\n  dcon-bench export \
                  hall.sqlite --list"
)]
pub struct ExportArgs {
    /// The recording
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// csv, jsonl or parquet [default: by the ending of --out; csv for .txt and without one]
    #[arg(long, value_parser = format)]
    format: Option<Format>,
    /// Write this file instead of standard output; one that is there is replaced when the new one is whole
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Leave out what is earlier
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    from: Option<Moment>,
    /// Leave out what is later
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    to: Option<Moment>,
    /// Only these series: SERIES, or MODULE/SERIES with the module's name or address; * stands for anything
    #[arg(long, value_name = "SERIES", value_delimiter = ',')]
    series: Vec<String>,
    /// time: one row for each time; sample: one row for each sample
    #[arg(long, value_name = "KIND", value_parser = rows, default_value = "time")]
    rows: Rows,
    /// Put what was measured up to so much later into the same row: the answers of one poll come one after another
    #[arg(long, value_name = "DURATION", value_parser = parse::interval)]
    within: Option<Duration>,
    /// Times in UTC, also those of --from and --to
    #[arg(long)]
    utc: bool,
    /// What happened instead of what was measured (csv or jsonl)
    #[arg(long, conflicts_with_all = ["series", "rows", "within"])]
    events: bool,
    /// Only tell which modules and series there are, with the time they cover
    #[arg(long, conflicts_with_all = ["out", "format", "events", "series", "from", "to", "rows", "within"])]
    list: bool,
}

fn format(text: &str) -> Result<Format, String> {
    Format::by_word(text).ok_or_else(|| format!("\"{text}\" is not a format: use csv, jsonl or parquet"))
}

/// The ending of a file that may be CSV as well.
const TEXT: &str = "txt";

fn rows(text: &str) -> Result<Rows, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "time" => Ok(Rows::PerTime),
        "sample" => Ok(Rows::PerSample),
        _ => Err(format!("\"{text}\" is not a kind of rows: use time or sample")),
    }
}

pub fn run(args: &ExportArgs) -> Outcome {
    let format = args.format();
    args.check(format)?;
    let interrupt = Interrupt::catch()?;
    let mut recording = Recording::open(&args.file).map_err(|error| Stop::failed(error.to_string()))?;
    let history = recording.load().map_err(|error| Stop::failed(error.to_string()))?;
    let zone = if args.utc { TimeZone::UTC } else { TimeZone::system() };
    if args.list {
        return list::print(&history, &zone);
    }
    let [from, to] = args.range(&history, &zone)?;
    let what = if args.events {
        if let Some(first) = left_out_before(&history, from) {
            let first = list::time(first, &zone);
            output::warning(&format!(
                "only the newest {MOST_EVENTS} events are exported, and none before {first}; older ones, if there are any, \
                 are in the recording's table events, which programs for SQLite read"
            ));
        }
        What::Events(EventRows::new(&history, &[], from, to))
    } else {
        let series = select::series(&history, &args.series)?;
        What::Samples(Source::new(&history, &series, from, to, Some(Box::new(recording))), args.rows())
    };
    match &args.out {
        Some(path) => to_file(path, what, format, zone, &interrupt),
        None => to_standard_output(what, format, &zone, &interrupt),
    }
}

/// What is written.
enum What {
    Samples(Source, Rows),
    Events(EventRows),
}

impl ExportArgs {
    fn format(&self) -> Format {
        let by_ending = self.out.as_deref().and_then(Format::of_path);
        self.format.or(by_ending).unwrap_or(Format::Csv)
    }

    fn rows(&self) -> Rows {
        match (self.rows, self.within) {
            (Rows::PerTime, Some(width)) => Rows::Within(Micros::try_from(width.as_micros()).unwrap_or(Micros::MAX)),
            (rows, _) => rows,
        }
    }

    fn check(&self, format: Format) -> Outcome {
        if self.rows == Rows::PerSample && self.within.is_some() {
            return Err(Stop::usage("--within is about rows of several samples: leave out --rows sample"));
        }
        if self.events && format == Format::Parquet {
            return Err(Stop::usage("events are written as csv or jsonl: choose one with --format"));
        }
        if format == Format::Parquet && self.out.is_none() && io::stdout().is_terminal() {
            return Err(Stop::usage("Parquet is not for terminals: give --out FILE, or send the output elsewhere"));
        }
        let Some(out) = &self.out else { return Ok(()) };
        if out.is_dir() {
            return Err(Stop::usage(format!("{} is a folder: add the name of a file", out.display())));
        }
        if let (Ok(out), Ok(file)) = (out.canonicalize(), self.file.canonicalize())
            && out == file
        {
            return Err(Stop::usage("--out is the recording itself: choose another name"));
        }
        let unknown = out.extension().filter(|ending| Format::of_path(out).is_none() && *ending != TEXT);
        if let (None, Some(ending)) = (self.format, unknown) {
            let endings = Format::ALL.map(Format::word).join(", ");
            let ending = ending.to_string_lossy();
            let text =
                format!("\"{ending}\" is not the ending of a format: use one of {endings}, or choose with --format");
            return Err(Stop::usage(text));
        }
        Ok(())
    }

    /// First and last time that is meant, where one was given.
    fn range(&self, history: &History, zone: &TimeZone) -> Outcome<[Option<Micros>; 2]> {
        let last_event = history.events().back().map(|event| micros_of(event.at));
        let end = history.span().map(|[_, last]| last).max(last_event).unwrap_or_default();
        let from = self.from.as_ref().map(|from| from.first(end, zone));
        let to = self.to.as_ref().map(|to| to.last(end, zone));
        if let (Some(from), Some(to)) = (from, to)
            && from > to
        {
            let [from, to] = [from, to].map(|at| list::time(at, zone));
            return Err(Stop::usage(format!("--from is later than --to: {from} and {to}")));
        }
        if let Some([first, last]) = history.span().filter(|_| !self.events)
            && (from.is_some_and(|from| from > last) || to.is_some_and(|to| to < first))
        {
            let [first, last] = [first, last].map(|at| list::time(at, zone));
            output::warning(&format!("the recording has nothing there: it goes from {first} to {last}"));
        }
        Ok([from, to])
    }
}

/// The time of the oldest event that was loaded, if there may be older ones that are meant too: a history has the newest
/// [`MOST_EVENTS`] only.
fn left_out_before(history: &History, from: Option<Micros>) -> Option<Micros> {
    let first = history.events().front().map(|event| micros_of(event.at))?;
    (list::is_cut(history) && from.is_none_or(|from| from <= first)).then_some(first)
}

fn to_standard_output(what: What, format: Format, zone: &TimeZone, interrupt: &Interrupt) -> Outcome {
    let go_on = |_: Progress| if interrupt.came() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let mut out = io::stdout();
    let done = match what {
        What::Samples(source, rows) => Export::run(source, format, rows, zone, &mut out, go_on),
        What::Events(events) => Export::run_events(events, format, zone, &mut out, go_on),
    };
    done?;
    Ok(out.flush()?)
}

fn to_file(path: &Path, what: What, format: Format, zone: TimeZone, interrupt: &Interrupt) -> Outcome {
    let (tell, woken) = std::sync::mpsc::sync_channel(1);
    let wake = move || {
        // One that waits is as good as many.
        let _ = tell.try_send(());
    };
    let path_of_job = path.to_owned();
    let job = match what {
        What::Samples(source, rows) => ExportJob::start(path_of_job, source, format, rows, zone, wake),
        What::Events(events) => ExportJob::start_events(path_of_job, events, format, zone, wake),
    };
    let job = job.map_err(|error| Stop::failed(format!("the export could not be started: {error}")))?;
    let mut line = TerminalLine::new(SHOW_EVERY);
    let outcome = loop {
        if let Some(outcome) = job.outcome() {
            break outcome;
        }
        if interrupt.came() {
            job.cancel();
        }
        let Progress { rows, part } = job.progress();
        line.show(|| format!("{:3.0} %  {rows} rows", part * 100.0));
        // Woken or not: it is looked again.
        let _ = woken.recv_timeout(LOOK_UP_EVERY);
    };
    line.clear();
    match outcome {
        Ok(Progress { rows, .. }) => output::line(&format!("{}: {rows} rows", path.display())),
        Err(ExportError::Write(error)) => {
            Err(Stop::failed(format!("{} could not be written: {error} – choose another place", path.display())))
        }
        Err(error) => Err(error.into()),
    }
}

impl From<ExportError> for Stop {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Write(error) => error.into(),
            ExportError::Stopped => Self::failed("the export was stopped before its end"),
            error => Self::failed(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Event, EventKind, timestamp};

    #[test]
    fn events_that_may_be_left_out_are_told_of_unless_the_time_asked_for_is_later() {
        let mut history = History::default();
        let add = |history: &mut History, count| {
            for at in 0..count {
                let event =
                    Event { at: timestamp(at), module: None, kind: EventKind::Note, text: String::new(), change: None };
                history.add_event(event);
            }
        };
        let most = i64::try_from(MOST_EVENTS).unwrap();
        add(&mut history, most - 1);
        assert_eq!((left_out_before(&history, None), list::events(&history)), (None, "199999 events".to_owned()));
        add(&mut history, 1);
        assert_eq!(list::events(&history), "200000 or more events");
        let cut = [None, Some(0), Some(1)].map(|from| left_out_before(&history, from));
        assert_eq!(cut, [Some(0), Some(0), None]);
    }
}
