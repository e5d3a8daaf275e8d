//! What the user chose for the window itself, kept between starts in `settings.toml`.
//!
//! Here is what there is to choose, in `valid` what of it is possible; `table` turns it into TOML and back, `file` keeps it on the
//! disk, `menu` changes some of it.

mod file;
mod menu;
mod recent;
mod table;
mod valid;

use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::time::Duration;

use eframe::egui::{self, ThemePreference};
use serde::{Deserialize, Serialize, Serializer};

pub use file::{Opened, SettingsFile, open};
pub use menu::{menu, zoom_by};
pub use recent::{MOST as RECENT_PORTS, Now, Place, RecentLine};

use crate::bus::{LineAddress, PortInfo, Tuning};
use crate::protocol::LineSettings;
use crate::record::Keeping;

/// The span of the plot when the program is new, in seconds.
const DEFAULT_SPAN: f64 = 60.0;
/// Shortest and longest span of the plot, in seconds.
pub const SPANS: RangeInclusive<f64> = 2.0..=86_400.0;
/// Spans to choose from, in seconds.
pub const NAMED_SPANS: [f64; 4] = [60.0, 300.0, 900.0, 3_600.0];
/// How large everything in the window can be drawn.
const ZOOMS: RangeInclusive<f32> = 0.8..=3.0;
/// Series of the trends remembered.
const TREND_SERIES: usize = 500;
/// Commands remembered.
pub const HISTORY: usize = 200;
/// Scripts remembered, each as a whole.
const SCRIPTS: usize = 20;
/// Least size of one file of a recording, and of all files that need not be kept, in megabytes.
pub const LEAST_FILE_MEGABYTES: u32 = 10;
pub const MOST_MEGABYTES: u32 = 100_000_000;
/// Bytes of a megabyte.
pub const MEGABYTE: u64 = 1_000_000;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ThemeChoice {
    #[default]
    System,
    Dark,
    Light,
}

impl ThemeChoice {
    const ALL: [(Self, &'static str); 3] =
        [(Self::System, "As the system"), (Self::Dark, "Dark"), (Self::Light, "Light")];

    fn preference(self) -> ThemePreference {
        match self {
            Self::System => ThemePreference::System,
            Self::Dark => ThemePreference::Dark,
            Self::Light => ThemePreference::Light,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TemperatureUnit {
    #[default]
    Celsius,
    Fahrenheit,
}

impl TemperatureUnit {
    pub const ALL: [Self; 2] = [Self::Celsius, Self::Fahrenheit];

    pub fn symbol(self) -> &'static str {
        match self {
            Self::Celsius => "°C",
            Self::Fahrenheit => "°F",
        }
    }

    /// What choosing it does.
    pub fn means(self) -> &'static str {
        match self {
            Self::Celsius => "Shows temperatures in degrees Celsius",
            Self::Fahrenheit => "Shows temperatures in degrees Fahrenheit",
        }
    }
}

/// Which line the selector stands at.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LineChoice {
    /// The first port there is.
    #[default]
    FirstPort,
    Port(String),
    Tcp,
    Simulated,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    pub theme: ThemeChoice,
    #[serde(serialize_with = "in_thousandths")]
    pub zoom: f32,
    pub temperature: TemperatureUnit,
    /// Of the plot, in seconds. Only one of [`NAMED_SPANS`] is kept.
    pub span: f64,
    /// Whether the strips of switches are drawn below the plots.
    pub strips: bool,
    /// Series that are not drawn, by stem.
    pub hidden: BTreeSet<String>,
    /// Trends tell times in UTC, not in local time.
    pub utc: bool,
    /// What the live trends show, one series an entry, as the trends write it; empty until the user has chosen.
    pub trend_series: Vec<String>,
    pub line: LineChoice,
    /// A port that the system does not list.
    pub other_port: String,
    /// Of Modbus TCP.
    pub host: String,
    pub line_settings: LineSettings,
    /// Lines that were opened, the latest first.
    pub recent_ports: Vec<RecentLine>,
    /// Scripts that were run, the latest first.
    pub recent_scripts: Vec<String>,
    /// Commands that were typed, the latest first, each once.
    pub command_history: Vec<String>,
    /// How the window is divided, in the words of whoever divides it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layout: Option<String>,
    /// The tab of a module that was shown last; empty for the first.
    pub tab: String,
    /// Whether a recording begins by itself when the first module is polled.
    pub record: bool,
    /// Where recordings go; empty for the program's own folder.
    pub recording_folder: String,
    /// After so much a new file is begun.
    pub recording_file_megabytes: u32,
    /// Of all files together; the oldest are removed. 0 keeps all.
    pub recording_total_megabytes: u32,
    /// Days after which a file is removed. 0 keeps all.
    pub recording_days: u32,
    /// How long an answer is waited for.
    pub timeout_ms: u32,
    /// How often a read is asked again.
    pub repeats: u8,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            zoom: 1.0,
            temperature: TemperatureUnit::default(),
            span: DEFAULT_SPAN,
            strips: true,
            hidden: BTreeSet::new(),
            utc: false,
            trend_series: Vec::new(),
            line: LineChoice::default(),
            other_port: String::new(),
            // The module's own address as it leaves the factory (PIR-234 manual 3.1).
            host: "192.168.255.1".to_owned(),
            line_settings: LineSettings::default(),
            recent_ports: Vec::new(),
            recent_scripts: Vec::new(),
            command_history: Vec::new(),
            layout: None,
            tab: String::new(),
            record: true,
            recording_folder: String::new(),
            recording_file_megabytes: 1_000,
            recording_total_megabytes: 10_000,
            recording_days: 0,
            timeout_ms: milliseconds(Tuning::default().timeout),
            repeats: Tuning::default().repeats,
        }
    }
}

impl Settings {
    /// How patient lines are.
    pub fn tuning(&self) -> Tuning {
        Tuning { timeout: Duration::from_millis(self.timeout_ms.into()), repeats: self.repeats }
    }

    /// The line `before` is there under another name now; who stands at it goes along.
    pub fn follow_line(&mut self, before: &LineAddress, now: &LineAddress) {
        if let (LineAddress::Serial { port: before }, LineAddress::Serial { port: now }) = (before, now)
            && self.line != LineChoice::Tcp
            && self.line != LineChoice::Simulated
            && !matches!(&self.line, LineChoice::Port(chosen) if chosen != before)
        {
            self.line = LineChoice::Port(now.clone());
        }
    }

    /// When recordings begin a new file, and when old ones are removed.
    pub fn keeping(&self) -> Keeping {
        let bytes = |megabytes: u32| u64::from(megabytes).saturating_mul(MEGABYTE);
        Keeping {
            file_size: bytes(self.recording_file_megabytes),
            total_size: (self.recording_total_megabytes > 0).then(|| bytes(self.recording_total_megabytes)),
            days: (self.recording_days > 0).then_some(self.recording_days),
        }
    }

    /// A span that was zoomed to belongs to what was looked at then, and is not kept.
    fn has_named_span(&self) -> bool {
        NAMED_SPANS.contains(&self.span)
    }

    /// Puts theme and zoom in force at the start.
    pub fn apply(&self, ctx: &egui::Context) {
        ctx.set_theme(self.theme.preference());
        ctx.set_zoom_factor(self.zoom);
    }

    /// The keyboard zooms too (Ctrl with plus and minus), so what is in force is looked up.
    pub fn note_zoom(&mut self, ctx: &egui::Context) {
        self.zoom = ctx.zoom_factor().clamp(*ZOOMS.start(), *ZOOMS.end());
        if self.zoom != ctx.zoom_factor() {
            ctx.set_zoom_factor(self.zoom);
        }
    }

    /// Remembers a line that was opened with these settings; `present` are the ports that are there.
    pub fn note_line(&mut self, line: &LineAddress, settings: LineSettings, present: &[PortInfo]) {
        let Some(recent) = RecentLine::of(line, settings, present) else { return };
        let recent = recent.known_from(&self.recent_ports, present);
        if self.recent_ports.first() == Some(&recent) {
            return;
        }
        self.recent_ports.retain(|other| !recent.replaces(other));
        self.recent_ports.insert(0, recent);
        self.recent_ports.truncate(RECENT_PORTS);
    }

    pub fn note_script(&mut self, script: impl Into<String>) {
        put_first(&mut self.recent_scripts, script.into(), SCRIPTS);
    }

    pub fn note_command(&mut self, command: impl Into<String>) {
        put_first(&mut self.command_history, command.into(), HISTORY);
    }
}

fn milliseconds(time: Duration) -> u32 {
    u32::try_from(time.as_millis()).unwrap_or(u32::MAX)
}

fn put_first(list: &mut Vec<String>, entry: String, limit: usize) {
    if list.first() == Some(&entry) {
        return;
    }
    list.retain(|other| *other != entry);
    list.insert(0, entry);
    tidy(list, limit);
}

/// At most `limit` entries, each once, none empty.
fn tidy(list: &mut Vec<String>, limit: usize) {
    let mut seen = BTreeSet::new();
    list.retain(|entry| !entry.trim().is_empty() && seen.len() < limit && seen.insert(entry.clone()));
}

/// So that 1.1 stands in the file as 1.1: what the window computes is not as exact as what a file can hold.
fn in_thousandths<S: Serializer>(zoom: &f32, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64((f64::from(*zoom) * 1_000.0).round() / 1_000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_came_back_under_another_name_is_the_chosen_one_if_it_was_before() {
        let line = |name: &str| LineAddress::Serial { port: name.to_owned() };
        let follow = |choice: LineChoice| {
            let mut settings = Settings { line: choice, ..Settings::default() };
            settings.follow_line(&line("COM3"), &line("COM7"));
            settings.line
        };
        let port = |name: &str| LineChoice::Port(name.to_owned());
        assert_eq!(follow(port("COM3")), port("COM7"));
        assert_eq!(follow(LineChoice::FirstPort), port("COM7"));
        for other in [port("COM4"), LineChoice::Tcp, LineChoice::Simulated] {
            assert_eq!(follow(other.clone()), other);
        }
    }

    #[test]
    fn the_line_opened_last_stands_first_and_the_ninth_is_forgotten() {
        let mut settings = Settings::default();
        let mut note = |line: &LineAddress| settings.note_line(line, LineSettings::default(), &[]);
        for number in 0..9 {
            note(&LineAddress::Serial { port: format!("COM{number}") });
        }
        note(&LineAddress::Serial { port: "COM4".to_owned() });
        note(&LineAddress::demo());
        let names: Vec<&str> = settings.recent_ports.iter().map(RecentLine::name).collect();
        assert_eq!(names, ["COM4", "COM8", "COM7", "COM6", "COM5", "COM3", "COM2", "COM1"]);
    }

    #[test]
    fn a_command_typed_again_stands_once_and_two_hundred_are_remembered() {
        let mut settings = Settings::default();
        for number in 0..300 {
            settings.note_command(format!("$01{number}"));
        }
        settings.note_command("$01299");
        settings.note_command("$01150");
        settings.note_command("  ");
        assert_eq!(settings.command_history.len(), HISTORY);
        assert_eq!(settings.command_history[..2], ["$01150", "$01299"]);
        settings.note_script("warm_up.txt");
        assert_eq!(settings.recent_scripts, ["warm_up.txt"]);
    }
}
