//! The report for people, in lines of plain text.

use std::fmt::{self, Write};

use super::{Bar, LineReport, ModuleReport, Report, Times};
use crate::diagnosis::findings::{Finding, Severity};

/// The longest bar of a histogram, in characters.
const LONGEST_BAR: u64 = 40;
/// Bars of a histogram at most.
const MOST_ROWS: usize = 12;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Diagnosis of {} – {}, {:.0}\n", self.line.name, self.program, self.made_at)?;
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
        let word = |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
        match (faults, warnings) {
            (0, 0) if self.modules.is_empty() => "No module has answered yet.".to_owned(),
            (0, 0) => "Nothing is wrong.".to_owned(),
            _ => format!("{} and {} need attention.", word(faults, "fault"), word(warnings, "warning")),
        }
    }
}

fn line(f: &mut fmt::Formatter<'_>, report: &LineReport) -> fmt::Result {
    writeln!(f, "Line")?;
    fact(f, "Exchanges", &failed_of(report.failed, report.exchanges))?;
    if let Some(times) = &report.answer_time {
        fact(f, "Answer time", &said(times))?;
    }
    if report.silent_addresses > 0 {
        fact(f, "Silent", &format!("{} addresses never answered, and count nowhere else", report.silent_addresses))?;
    }
    fact(f, "Echo", if report.echoes > 0 { "the adapter echoes" } else { "none seen" })?;
    fact(f, "Noise", &noise(report.noisy_answers, Some(report.unasked_bytes)))?;
    if let Some(adapter) = &report.adapter {
        let timer =
            adapter.latency_timer_ms.map_or_else(|| "not told by the system".to_owned(), |ms| format!("{ms} ms"));
        fact(f, "Latency timer", &timer)?;
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
    if report.refusals > 0 || report.repeats > 0 {
        fact(f, "Refused", &format!("{}, asked again at once: {}", report.refusals, report.repeats))?;
    }
    fact(f, "Noise", &noise(report.noisy_answers, None))?;
    if let Some(test) = &report.consistency {
        fact(f, "Consistency", &format!("{} – {}", test.judgement.label(), test.said))?;
    }
    if let Some(timeout) = &report.suggested_timeout {
        fact(f, "Timeout", &format!("{} ms suggested: {}", timeout.milliseconds, timeout.reason))?;
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
    let share = failed as f64 / all.max(1) as f64 * 100.0;
    format!("{all}, {failed} of them failed ({share:.1} %)")
}

fn said(times: &Times) -> String {
    let Times { min_ms, median_ms, p99_ms, max_ms, .. } = times;
    format!("min {min_ms:.1} ms, median {median_ms:.1} ms, 99 % {p99_ms:.1} ms, max {max_ms:.1} ms")
}

fn noise(noisy: u64, unasked: Option<u64>) -> String {
    match (noisy, unasked.unwrap_or_default()) {
        (0, 0) => "none seen".to_owned(),
        (noisy, 0) => format!("stray bytes around {noisy} answers"),
        (noisy, unasked) => format!("stray bytes around {noisy} answers, {unasked} bytes nobody asked for"),
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
