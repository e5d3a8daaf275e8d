//! Export readings: the dialog that asks which, of what time, and how.

use std::collections::BTreeSet;

use eframe::egui::{self, Button, ScrollArea, TextEdit, Ui};
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::choice::{estimate, parse_time, time_text};
use super::running::Plan;
use super::{InPlots, Wanted};
use crate::bench::RecordingId;
use crate::record::{Format, History, Micros, Rows, SeriesId, column_name, micros, module_names};
use crate::ui::tables::grouped;
use crate::ui::{modal, theme, widgets, words};

/// Answers of one poll come within this time, in microseconds.
const POLL_TIME: Micros = 500_000;

/// Which series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Which {
    InPlots,
    All,
    Chosen,
}

/// Of what time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum When {
    InView,
    BetweenCursors,
    Everything,
    Typed,
}

/// Without an end where there is `None`.
type Span = [Option<Micros>; 2];

pub struct Form {
    recording: Option<RecordingId>,
    name: String,
    plots: InPlots,
    which: Which,
    chosen: BTreeSet<SeriesId>,
    when: When,
    /// From and to, as they are typed.
    typed: [String; 2],
    format: Format,
    rows: Rows,
    utc: bool,
    /// What was estimated last, and of what.
    estimate: Option<(Vec<SeriesId>, Span, u64)>,
}

/// What became of the dialog.
pub enum Answer {
    /// It is still open.
    None,
    Save(Plan),
    Cancel,
}

impl Form {
    pub fn new(Wanted { recording, name, plots }: Wanted, utc: bool) -> Self {
        let zone = words::zone(utc);
        let typed = plots.view.unwrap_or_default().map(|at| time_text(micros(at), &zone));
        Self {
            recording,
            name,
            which: if plots.series.is_empty() { Which::All } else { Which::InPlots },
            chosen: plots.series.iter().copied().collect(),
            when: if plots.view.is_some() { When::InView } else { When::Everything },
            plots,
            typed,
            format: Format::Csv,
            rows: Rows::PerTime,
            utc,
            estimate: None,
        }
    }

    pub fn recording(&self) -> Option<RecordingId> {
        self.recording
    }

    pub fn show(&mut self, ctx: &egui::Context, history: &History, now: Timestamp) -> Answer {
        let mut answer = Answer::None;
        let modal = modal::show(ctx, "export readings", theme::EXPORT_WIDTH, |ui| {
            ui.heading("Export readings");
            widgets::section(ui, "Readings");
            self.readings(ui, history);
            widgets::section(ui, "Time");
            self.times(ui);
            widgets::section(ui, "File");
            self.file(ui);
            ui.add_space(theme::GAP);
            let series = self.series(history);
            let span = self.span();
            widgets::quiet(ui, &self.extent(history, &series, &span));
            ui.add_space(theme::UNIT);
            ui.horizontal(|ui| {
                let obstacle = match &span {
                    Err(reason) => Some(reason.clone()),
                    Ok(_) if series.is_empty() => Some("No reading is chosen".to_owned()),
                    Ok(_) => None,
                };
                let save = ui.add_enabled(obstacle.is_none(), Button::new("Save…"));
                let save = save.on_hover_text("Asks for a place, then writes the file");
                if save.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked()
                    && let Ok(span) = &span
                {
                    answer = Answer::Save(self.plan(series.clone(), *span, now));
                }
                if ui.button("Cancel").clicked() {
                    answer = Answer::Cancel;
                }
            });
        });
        if matches!(answer, Answer::None) && modal.should_close() { Answer::Cancel } else { answer }
    }

    fn readings(&mut self, ui: &mut Ui, history: &History) {
        let in_plots = self.plots.series.len();
        ui.add_enabled_ui(in_plots > 0, |ui| {
            ui.radio_value(&mut self.which, Which::InPlots, format!("Those in the plots ({in_plots})"))
                .on_hover_text("What the plots show at present")
                .on_disabled_hover_text("The plots show no reading");
        });
        ui.radio_value(&mut self.which, Which::All, format!("All ({})", history.series().len()))
            .on_hover_text("Every reading of every module");
        ui.radio_value(&mut self.which, Which::Chosen, format!("Chosen here ({})", self.chosen.len()))
            .on_hover_text("Those that are ticked in a list");
        if self.which == Which::Chosen {
            let names = module_names(history);
            ScrollArea::vertical().max_height(theme::EXPORT_LIST).auto_shrink([false, true]).show(ui, |ui| {
                for (id, series) in history.series() {
                    let mut is_chosen = self.chosen.contains(&id);
                    let name = names.get(&series.info.module).map_or("", String::as_str);
                    if ui.checkbox(&mut is_chosen, column_name(name, &series.info)).changed() {
                        if is_chosen {
                            self.chosen.insert(id)
                        } else {
                            self.chosen.remove(&id)
                        };
                    }
                }
            });
        }
    }

    fn times(&mut self, ui: &mut Ui) {
        let zone = words::zone(self.utc);
        let told = |span: Option<[f64; 2]>| {
            span.map_or_else(String::new, |span| {
                let [from, to] = sorted(span).map(|at| time_text(at, &zone));
                format!("  {from} – {to}")
            })
        };
        let (view, cursors) = (self.plots.view, self.plots.cursors);
        for (span, when, text, means, missing) in [
            (view, When::InView, "The span in view", "The time that the plots show", "The plots show nothing"),
            (
                cursors,
                When::BetweenCursors,
                "Between the cursors",
                "The time from cursor A to cursor B",
                "No cursors are set in the plots",
            ),
        ] {
            ui.add_enabled_ui(span.is_some(), |ui| {
                ui.horizontal(|ui| {
                    let radio = ui.radio_value(&mut self.when, when, text);
                    radio.on_hover_text(means).on_disabled_hover_text(missing);
                    widgets::quiet(ui, &told(span));
                });
            });
        }
        ui.radio_value(&mut self.when, When::Everything, "Everything")
            .on_hover_text("From the first sample to the last");
        ui.horizontal(|ui| {
            ui.radio_value(&mut self.when, When::Typed, "From").on_hover_text("The time that is typed here");
            let [from, to] = &mut self.typed;
            let mut is_typed = time_field(ui, from, "From");
            ui.label("to");
            is_typed |= time_field(ui, to, "To");
            if is_typed {
                self.when = When::Typed;
            }
        });
    }

    fn file(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            for format in Format::ALL {
                ui.radio_value(&mut self.format, format, format.label()).on_hover_text(means(format));
            }
        });
        ui.horizontal(|ui| {
            ui.radio_value(&mut self.rows, Rows::PerTime, "One row for each time")
                .on_hover_text("A column for each reading; it is empty where there is no sample at that very time");
            ui.radio_value(&mut self.rows, Rows::Within(POLL_TIME), "One row for each poll")
                .on_hover_text("Answers of one poll have times of their own; those within half a second share a row");
            ui.radio_value(&mut self.rows, Rows::PerSample, "One row for each sample")
                .on_hover_text("Time, reading and value; nothing is empty");
        });
        let before = self.utc;
        ui.add_enabled_ui(self.format != Format::Parquet, |ui| {
            ui.horizontal(|ui| {
                let reason = "Parquet holds times in UTC";
                let local = ui.radio_value(&mut self.utc, false, "Local time with its offset");
                local.on_hover_text("As the clock on the wall, such as 14:05:09+02:00").on_disabled_hover_text(reason);
                let utc = ui.radio_value(&mut self.utc, true, "UTC");
                utc.on_hover_text("The same for everybody, and without summer time").on_disabled_hover_text(reason);
            });
        });
        if self.utc != before {
            self.tell_typed_in(&words::zone(before), &words::zone(self.utc));
        }
    }

    /// The typed times stay the same moments.
    fn tell_typed_in(&mut self, before: &TimeZone, now: &TimeZone) {
        for text in &mut self.typed {
            if let Ok(at) = parse_time(text, before) {
                *text = time_text(at, now);
            }
        }
    }

    fn series(&self, history: &History) -> Vec<SeriesId> {
        match self.which {
            Which::InPlots => self.plots.series.clone(),
            Which::All => history.series().map(|(id, _)| id).collect(),
            Which::Chosen => self.chosen.iter().copied().collect(),
        }
    }

    fn span(&self) -> Result<Span, String> {
        let both = |span: Option<[f64; 2]>| span.map_or([None, None], |span| sorted(span).map(Some));
        match self.when {
            When::InView => Ok(both(self.plots.view)),
            When::BetweenCursors => Ok(both(self.plots.cursors)),
            When::Everything => Ok([None, None]),
            When::Typed => {
                let zone = words::zone(self.utc);
                let [from, to] = &self.typed;
                let (from, to) = (parse_time(from, &zone)?, parse_time(to, &zone)?);
                if from > to {
                    return Err("It ends before it begins – exchange the two times".to_owned());
                }
                Ok([Some(from), Some(to)])
            }
        }
    }

    /// About how much it is, or why that cannot be said.
    fn extent(&mut self, history: &History, series: &[SeriesId], span: &Result<Span, String>) -> String {
        let span = match span {
            Ok(span) => *span,
            Err(reason) => return reason.clone(),
        };
        let samples = match &self.estimate {
            Some((of, within, samples)) if of == series && *within == span => *samples,
            _ => {
                let samples = estimate(history, series, span);
                self.estimate = Some((series.to_vec(), span, samples));
                samples
            }
        };
        let samples = grouped(usize::try_from(samples).unwrap_or(usize::MAX));
        format!("About {samples} samples of {}", words::counted(series.len(), "reading"))
    }

    fn plan(&self, series: Vec<SeriesId>, span: Span, now: Timestamp) -> Plan {
        Plan {
            name: format!("{}-readings-{}.{}", self.name, words::for_file(now), self.format.word()),
            recording: self.recording,
            series,
            span,
            format: self.format,
            rows: self.rows,
            zone: words::zone(self.utc),
        }
    }
}

/// True if something was typed.
fn time_field(ui: &mut Ui, text: &mut String, name: &str) -> bool {
    let response = ui.add(TextEdit::singleline(text).desired_width(theme::MOMENT_FIELD));
    widgets::name_field(&response, name, text);
    response.on_hover_text("Date and time, such as 2026-03-02 09:30:00").changed()
}

/// Who reads a format.
fn means(format: Format) -> &'static str {
    match format {
        Format::Csv => "For spreadsheets",
        Format::JsonLines => "One object a line, for programs",
        Format::Parquet => "Small and typed, for data analysis",
    }
}

fn sorted([one, other]: [f64; 2]) -> [Micros; 2] {
    [micros(one.min(other)), micros(one.max(other))]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(plots: InPlots) -> Form {
        Form::new(Wanted { recording: None, name: "dcon-bench".to_owned(), plots }, true)
    }

    #[test]
    fn what_the_plots_show_is_proposed() {
        let plots = InPlots { series: vec![SeriesId(3)], view: Some([10.0, 20.0]), cursors: Some([15.0, 12.0]) };
        let mut form = form(plots);
        assert_eq!(form.series(&History::default()), [SeriesId(3)]);
        assert_eq!(form.span(), Ok([Some(10_000_000), Some(20_000_000)]));
        form.when = When::BetweenCursors;
        assert_eq!(form.span(), Ok([Some(12_000_000), Some(15_000_000)]));
        form.when = When::Typed;
        assert_eq!(form.span(), Ok([Some(10_000_000), Some(20_000_000)]));
        form.typed.swap(0, 1);
        assert!(form.span().unwrap_err().contains("ends before it begins"));
    }

    #[test]
    fn without_plots_everything_is_proposed() {
        let form = form(InPlots::default());
        assert_eq!((form.which, form.span()), (Which::All, Ok([None, None])));
        let plan = form.plan(Vec::new(), [None, None], Timestamp::UNIX_EPOCH);
        assert!(plan.name.starts_with("dcon-bench-readings-") && plan.name.ends_with(".csv"));
    }

    #[test]
    fn typed_times_stay_the_same_moments_in_another_zone() {
        let mut form = form(InPlots { view: Some([0.0, 60.0]), ..InPlots::default() });
        let east = TimeZone::fixed(jiff::tz::offset(2));
        form.tell_typed_in(&TimeZone::UTC, &east);
        assert_eq!(form.typed, ["1970-01-01 02:00:00", "1970-01-01 02:01:00"]);
    }
}
