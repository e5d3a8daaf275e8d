//! What is known of the line or of one module: what was found first, then the numbers behind it.

use std::slice;

use eframe::egui::{Align, Button, Grid, Label, Layout, Rect, RichText, Ui, vec2};

use super::{charts, mark, stations};
use crate::bench::Action;
use crate::diagnosis::{
    Bar, Consistency, DEFAULT_READS, Finding, Judgement, ModuleReport, Report, Severity, SuggestedTimeout,
    TimeoutAdvice, Times, adapter_in_words, noise_in_words,
};
use crate::ui::app::Pass;
use crate::ui::tables::{Sheet, copied_row};
use crate::ui::{theme, widgets, words};

pub fn line(ui: &mut Ui, report: &Report, pass: &mut Pass<'_>) {
    let line = &report.line;
    title(ui, "Line", &line.name, |_| {});
    findings(ui, &line.findings, "Nothing is wrong with the line itself");
    section(ui, "Answer times of all modules");
    charts::histogram(ui, &line.histogram, line.answer_time.as_ref());
    times(ui, line.answer_time.as_ref());
    section(ui, "Counts");
    let share = line.failed as f64 / line.exchanges.max(1) as f64;
    let share = stations::words_of_share((line.exchanges > 0).then_some(share));
    let mut rows = vec![
        ("Exchanges", format!("{} with {}", line.exchanges, modules(report.modules.len()))),
        ("Failed", format!("{} ({share})", line.failed)),
        ("Never answered", never_answered(line.silent_addresses)),
        ("Echo", echo(line.echoes)),
        ("Noise", noise_in_words(line.noisy_answers, line.unasked_bytes)),
    ];
    rows.extend(line.adapter.as_ref().map(|adapter| ("Latency timer", adapter_in_words(adapter))));
    facts(ui, "line facts", &rows);
    timeout(ui, line.suggested_timeout.as_ref(), pass);
}

pub fn module(ui: &mut Ui, module: &ModuleReport, pass: &mut Pass<'_>) {
    title(ui, &module.title(), &words::spoken(&module.target), |ui| test_button(ui, module, pass));
    findings(ui, &module.findings, "Nothing is wrong with this module");
    ui.columns(2, |columns| {
        let [left, right] = columns else { return };
        section(left, "Answer times");
        charts::histogram(left, &module.histogram, module.answer_time.as_ref());
        section(right, "Failed exchanges, the last hour");
        charts::rates(right, &module.rates);
    });
    times(ui, module.answer_time.as_ref());
    section(ui, "Counts");
    let kinds: Vec<String> = module.failures.iter().map(|(kind, count)| format!("{count} {}", kind.label())).collect();
    let failed: u64 = module.failures.values().sum();
    let kinds = if kinds.is_empty() { String::new() } else { format!(": {}", kinds.join(", ")) };
    let rows = [
        ("Exchanges", format!("{}, {} of them refused", module.exchanges, module.refusals)),
        ("Failed", format!("{failed} ({}){kinds}", stations::words_of_share(module.error_rate))),
        ("Asked again", format!("{} at once after a failure", module.repeats)),
        ("Echo", echo(module.echoes)),
        ("Noise", noise_in_words(module.noisy_answers, 0)),
    ];
    facts(ui, "module facts", &rows);
    if let Some(test) = &module.consistency {
        consistency(ui, test);
    }
    timeout(ui, module.suggested_timeout.as_ref(), pass);
}

fn title(ui: &mut Ui, title: &str, below: &str, at_right: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).heading());
        widgets::quiet(ui, below);
        ui.with_layout(Layout::right_to_left(Align::Center), at_right);
    });
}

/// Starts the test, or how far it is.
fn test_button(ui: &mut Ui, module: &ModuleReport, pass: &mut Pass<'_>) {
    let running = pass.bench.consistency_test().filter(|test| test.target() == module.target);
    if let Some(test) = running {
        if ui.button("Stop test").clicked() {
            pass.actions.push(Action::StopTest);
        }
        let (done, wanted) = test.progress();
        widgets::fixed(ui, theme::COUNT_SHORT, Align::Max, &format!("{done} of {wanted}"));
        widgets::progress(ui, test.part(), "Consistency test");
        return;
    }
    let obstacle = pass.bench.test_obstacle();
    let button = ui.add_enabled(obstacle.is_none(), Button::new("Test consistency"));
    let why = "Reads the same 50 times, changing nothing: shows two modules at one address, noise and losses";
    let clicked = button.on_hover_text(why).on_disabled_hover_text(obstacle.unwrap_or_default()).clicked();
    if clicked {
        pass.actions.push(Action::TestConsistency(module.target, DEFAULT_READS));
    }
}

fn section(ui: &mut Ui, text: &str) {
    ui.add_space(theme::GAP);
    widgets::quiet_small(ui, text);
}

fn findings(ui: &mut Ui, findings: &[Finding], none: &str) {
    ui.add_space(theme::UNIT);
    if findings.is_empty() {
        let palette = theme::palette(ui);
        ui.horizontal(|ui| {
            widgets::glyph(ui, widgets::Glyph::Tick, palette.ok);
            ui.label(none);
        });
    }
    for (index, found) in findings.iter().enumerate() {
        let row = finding(ui, found);
        copied_row(ui, row, ui.scope_id().with(("finding", index)), |part| {
            findings_sheet(part.of(slice::from_ref(found), findings))
        });
    }
}

/// Findings as they are copied.
fn findings_sheet(findings: &[Finding]) -> Sheet {
    let mut sheet = Sheet::new(["Severity", "Finding", "Evidence", "Likely cause", "Next step"]);
    for finding in findings {
        let Finding { severity, title, evidence, cause, next_step, .. } = finding;
        sheet.push([severity.word(), title, evidence, cause, next_step]);
    }
    sheet
}

fn finding(ui: &mut Ui, finding: &Finding) -> Rect {
    let palette = theme::palette(ui);
    let (glyph, colour) = mark(Some(finding.severity), palette);
    let row = ui.horizontal_top(|ui| {
        widgets::glyph(ui, glyph, colour);
        ui.vertical(|ui| {
            ui.set_max_width(theme::FINDING_WIDTH.min(ui.available_width()));
            ui.spacing_mut().item_spacing.y = theme::UNIT / 2.0;
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = theme::UNIT;
                ui.label(RichText::new(format!("{}:", finding.severity.word())).color(colour));
                ui.label(RichText::new(finding.title).strong());
                widgets::quiet(ui, &format!("– {}", finding.evidence));
            });
            ui.add(Label::new(RichText::new(format!("Likely cause: {}", finding.cause)).color(palette.quiet)).wrap());
            let next = RichText::new(format!("Next step: {}", finding.next_step));
            // A note asks for nothing.
            let next = if finding.severity == Severity::Note { next.color(palette.quiet) } else { next };
            ui.add(Label::new(next).wrap().selectable(true));
        });
    });
    ui.add_space(theme::GAP);
    row.response.rect
}

const ANSWER_TIMES: &str = "From the end of a request to the first byte of its answer";

/// The four numbers that say most.
fn times(ui: &mut Ui, times: Option<&Times>) {
    let shown = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |ms| format!("{ms:.1} ms"));
    let all = [
        ("min", times.map(|times| times.min_ms)),
        ("median", times.map(|times| times.median_ms)),
        ("99 %", times.map(|times| times.p99_ms)),
        ("max", times.map(|times| times.max_ms)),
    ];
    let row = ui.horizontal_wrapped(|ui| {
        for (name, value) in all {
            widgets::quiet(ui, name);
            let text = shown(value);
            let response = widgets::fixed(ui, theme::ANSWER_TIME, Align::Min, &text);
            widgets::describe(&response, eframe::egui::Role::Label, &format!("{name} {text}"));
            response.on_hover_text(ANSWER_TIMES);
        }
    });
    copied_row(ui, row.response.rect, ui.scope_id().with("times"), |_| {
        let mut sheet = Sheet::new(all.map(|(name, _)| name));
        sheet.push(all.map(|(_, value)| shown(value)));
        sheet
    });
}

fn facts(ui: &mut Ui, id: &str, rows: &[(&str, String)]) {
    let sheet = |rows: &[(&str, String)]| {
        let mut sheet = Sheet::new(["Count", "Value"]);
        rows.iter().for_each(|(name, text)| sheet.push([name, text.as_str()]));
        sheet
    };
    Grid::new(id).num_columns(2).spacing(vec2(theme::GAP_SECTION, theme::UNIT / 2.0)).show(ui, |ui| {
        for row in rows {
            let (name, text) = row;
            let first = widgets::quiet(ui, name).on_hover_text(meaning(name));
            let second = ui.add(Label::new(text.as_str()).wrap());
            copied_row(ui, first.rect.union(second.rect), ui.scope_id().with(name), |part| {
                sheet(part.of(slice::from_ref(row), rows))
            });
            ui.end_row();
        }
    });
}

/// What is counted under this name.
fn meaning(count: &str) -> &'static str {
    match count {
        "Exchanges" => "A request and what came of it; of modules that have answered at least once",
        "Failed" => "No answer, or one that cannot be used",
        "Never answered" => "Asked by a scan, without a module there",
        "Asked again" => "A read whose answer was missing or unusable is asked again at once; a write never is",
        "Echo" => "Some adapters send back what is sent; it is taken away before the answer",
        "Noise" => "Bytes that belong to no answer",
        "Latency timer" => "How long the adapter holds bytes back before it hands them on",
        _ => "",
    }
}

fn echo(echoes: u64) -> String {
    if echoes == 0 { "none seen".to_owned() } else { "the adapter sends back what is sent".to_owned() }
}

fn modules(count: usize) -> String {
    if count == 1 { "1 module".to_owned() } else { format!("{count} modules") }
}

fn never_answered(addresses: u32) -> String {
    match addresses {
        0 => "none".to_owned(),
        1 => "1 address, which counts nowhere else".to_owned(),
        count => format!("{count} addresses, which count nowhere else"),
    }
}

fn consistency(ui: &mut Ui, test: &Consistency) {
    section(ui, "Consistency test");
    let palette = theme::palette(ui);
    let severity = match test.judgement {
        Judgement::Fine => None,
        Judgement::Interrupted => Some(Severity::Note),
        Judgement::Noise | Judgement::Late | Judgement::Lossy | Judgement::Twice => Some(Severity::Warning),
        Judgement::Doubled
        | Judgement::DoubledOrNoise
        | Judgement::SameErrors
        | Judgement::Unreadable
        | Judgement::NoAnswer => Some(Severity::Fault),
    };
    let (glyph, colour) = mark(severity, palette);
    ui.horizontal(|ui| {
        widgets::glyph(ui, glyph, colour);
        ui.add(Label::new(format!("{} – {}", words_first(test.judgement.label()), test.said)).wrap());
    });
}

/// With a capital letter.
fn words_first(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

fn timeout(ui: &mut Ui, suggested: Option<&SuggestedTimeout>, pass: &mut Pass<'_>) {
    section(ui, "Timeout");
    let Some(suggested) = suggested else {
        widgets::quiet(ui, "Ten answers are needed to judge it.");
        return;
    };
    ui.horizontal(|ui| {
        ui.label(suggested.verdict());
        let why = "Waits so long for the first byte of an answer from now on, on this line and those opened later";
        let button = match suggested.advice {
            TimeoutAdvice::Fits => return,
            TimeoutAdvice::Longer => format!("Use {} ms", suggested.milliseconds),
            TimeoutAdvice::CouldBeLowered => format!("Lower to {} ms", suggested.milliseconds),
        };
        if ui.button(button).on_hover_text(why).clicked() {
            pass.settings.timeout_ms = u32::try_from(suggested.milliseconds).unwrap_or(u32::MAX);
            pass.actions.push(Action::Tune(pass.settings.tuning().within_limits()));
        }
    });
    ui.add(Label::new(RichText::new(words_first(&suggested.reason)).color(theme::palette(ui).quiet)).wrap());
}

/// The highest bar.
pub fn highest(bars: &[Bar]) -> u64 {
    bars.iter().map(|bar| bar.count).max().unwrap_or_default()
}
