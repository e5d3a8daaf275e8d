//! The report for people, in lines of plain text.

use std::fmt::{self, Write};

use super::{Adapter, Bar, LineReport, ModuleReport, Report, Times};
use crate::diagnosis::findings::{Finding, Severity, plural};

/// The longest bar of a histogram, in characters.
const LONGEST_BAR: u64 = 40;
/// Bars of a histogram at most.
const MOST_ROWS: usize = 12;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Diagnosis of {} – {}, {:.0}\n", self.line.name, self.program, self.made_at)?;
        if let Some(reason) = &self.stopped_early {
            writeln!(f, "Stopped early: {reason}. This is what was heard until then.\n")?;
        }
        line(f, &self.line)?;
        for report in &self.modules {
            f.write_char('\n')?;
            module(f, report)?;
        }
        writeln!(f, "\n{}", self.conclusion())
    }
}

impl Report {
    /// Everything in one sentence.
    pub fn conclusion(&self) -> String {
        let count = |severity| self.findings().filter(|finding| finding.severity == severity).count();
        let (faults, warnings) = (count(Severity::Fault), count(Severity::Warning));
        let counted = [(faults, "fault", "faults"), (warnings, "warning", "warnings")];
        let words: Vec<String> = counted
            .into_iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, one, many)| plural(u64::try_from(count).unwrap_or(u64::MAX), one, many))
            .collect();
        match faults.saturating_add(warnings) {
            0 if self.modules.is_empty() => "No module has answered yet.".to_owned(),
            0 if self.stopped_early.is_some() => "Nothing was wrong until it was stopped.".to_owned(),
            0 => "Nothing is wrong.".to_owned(),
            1 => format!("{} needs attention.", words.concat()),
            _ => format!("{} need attention.", words.join(" and ")),
        }
    }
}

fn line(f: &mut fmt::Formatter<'_>, report: &LineReport) -> fmt::Result {
    writeln!(f, "Line")?;
    fact(f, "Exchanges", &failed_of(report.failed, report.exchanges))?;
    fact(f, "Patience", &patience(report))?;
    if let Some(times) = &report.answer_time {
        fact(f, "Answer time", &said(times))?;
    }
    match report.silent_addresses {
        0 => {}
        1 => fact(f, "Silent", "1 address never answered, and counts nowhere else")?,
        count => fact(f, "Silent", &format!("{count} addresses never answered, and count nowhere else"))?,
    }
    fact(f, "Echo", if report.echoes > 0 { "the adapter echoes" } else { "none seen" })?;
    fact(f, "Noise", &noise_in_words(report.noisy_answers, report.unasked_bytes))?;
    if let Some(adapter) = &report.adapter {
        fact(f, "Latency timer", &adapter_in_words(adapter))?;
    }
    findings(f, &report.findings)
}

fn module(f: &mut fmt::Formatter<'_>, report: &ModuleReport) -> fmt::Result {
    let name = if report.name.is_empty() { String::new() } else { format!("{} at ", report.name) };
    writeln!(f, "{name}{}", report.target)?;
    fact(f, "Exchanges", &failed_of(report.failures.values().sum(), report.exchanges))?;
    if !report.failures.is_empty() {
        let kinds: Vec<_> = report.failures.iter().map(|(kind, count)| format!("{count} {}", kind.label())).collect();
        fact(f, "Failures", &kinds.join(", "))?;
    }
    if report.refusals > 0 {
        fact(f, "Refused", &plural(report.refusals, "request", "requests"))?;
    }
    if report.repeats > 0 {
        fact(f, "Asked again", &plural(report.repeats, "time, at once", "times, at once"))?;
    }
    fact(f, "Noise", &noise_in_words(report.noisy_answers, 0))?;
    if let Some(test) = &report.consistency {
        fact(f, "Consistency", &format!("{} – {}", test.judgement.label(), test.said))?;
    }
    if let Some(timeout) = &report.suggested_timeout {
        fact(f, "Timeout", &format!("{}: {}", timeout.verdict(), timeout.reason))?;
    }
    if let Some(times) = &report.answer_time {
        fact(f, "Answer time", &said(times))?;
        histogram(f, &report.histogram)?;
    }
    findings(f, &report.findings)
}

fn fact(f: &mut fmt::Formatter<'_>, name: &str, text: &str) -> fmt::Result {
    writeln!(f, "  {name:<14} {text}")
}

fn failed_of(failed: u64, all: u64) -> String {
    match (all, failed) {
        (0, _) => "none".to_owned(),
        (_, 0) => format!("{all}, none of them failed"),
        _ => {
            let share = failed as f64 / all.max(1) as f64 * 100.0;
            format!("{all}, {failed} of them failed ({share:.1} %)")
        }
    }
}

fn patience(report: &LineReport) -> String {
    let repeats = match report.repeats {
        0 => "no read is asked again".to_owned(),
        1 => "a read is asked again once".to_owned(),
        repeats => format!("a read is asked again at most {repeats} times"),
    };
    format!("timeout {} ms, {repeats}", report.timeout_ms)
}

/// The adapter's latency timer.
pub fn adapter_in_words(adapter: &Adapter) -> String {
    adapter.latency_timer_ms.map_or_else(|| "not told by the system".to_owned(), |ms| format!("{ms} ms"))
}

fn said(times: &Times) -> String {
    let Times { min_ms, median_ms, p99_ms, max_ms, .. } = times;
    format!("min {min_ms:.1} ms, median {median_ms:.1} ms, 99 % {p99_ms:.1} ms, max {max_ms:.1} ms")
}

/// Answers with stray bytes around them, and bytes that nobody asked for; only what there is.
pub fn noise_in_words(noisy: u64, unasked: u64) -> String {
    let around = || format!("stray bytes around {}", plural(noisy, "answer", "answers"));
    let beside = || plural(unasked, "byte that nobody asked for", "bytes that nobody asked for");
    match (noisy, unasked) {
        (0, 0) => "none seen".to_owned(),
        (_, 0) => around(),
        (0, _) => beside(),
        _ => format!("{}, {}", around(), beside()),
    }
}

fn histogram(f: &mut fmt::Formatter<'_>, bars: &[Bar]) -> fmt::Result {
    let most = bars.iter().map(|bar| bar.count).max().unwrap_or_default().max(1);
    let width = bars.len().div_ceil(MOST_ROWS).max(1);
    for row in bars.chunks(width) {
        let (Some(first), Some(last)) = (row.first(), row.last()) else { continue };
        let count: u64 = row.iter().map(|bar| bar.count).sum();
        let length = count.saturating_mul(LONGEST_BAR).div_ceil(most).min(LONGEST_BAR);
        let bar = "\u{2588}".repeat(usize::try_from(length).unwrap_or_default());
        let text = format!("    {:>7.1} – {:>7.1} ms  {count:>6}  {bar}", first.from_ms, last.to_ms);
        writeln!(f, "{}", text.trim_end())?;
    }
    Ok(())
}

fn findings(f: &mut fmt::Formatter<'_>, findings: &[Finding]) -> fmt::Result {
    for Finding { severity, title, evidence, cause, next_step, .. } in findings {
        writeln!(f, "  {}: {title} – {evidence}", severity.word())?;
        writeln!(f, "    Likely cause: {cause}")?;
        writeln!(f, "    Next step: {next_step}")?;
    }
    Ok(())
}
