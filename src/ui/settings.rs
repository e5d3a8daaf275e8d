//! What the user chose for the window itself, kept between starts, and the menu that changes it.
//!
//! Whatever was stored reads as a valid value: what is missing or wrong has its default.

use std::collections::BTreeSet;

use eframe::egui::{self, ThemePreference};
use serde::{Deserialize, Serialize};

use super::widgets;
use crate::protocol::LineSettings;

const KEY: &str = "view";
/// The span of the plot when the program is new, in seconds.
const DEFAULT_SPAN: f64 = 60.0;
/// Shortest and longest span of the plot, in seconds.
pub const SPANS: std::ops::RangeInclusive<f64> = 2.0..=86_400.0;
/// Spans to choose from, in seconds.
pub const NAMED_SPANS: [f64; 4] = [60.0, 300.0, 900.0, 3_600.0];
const ZOOMS: std::ops::RangeInclusive<f32> = 0.5..=3.0;
const ZOOM_STEP: f32 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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
}

/// Which line the selector stands at.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
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
    pub zoom: f32,
    pub temperature: TemperatureUnit,
    /// Of the plot, in seconds.
    pub span: f64,
    /// Whether the strips of switches are drawn below the plots.
    pub strips: bool,
    /// Series that are not drawn, by stem.
    pub hidden: BTreeSet<String>,
    pub line: LineChoice,
    /// A port that the system does not list.
    pub other_port: String,
    /// Of Modbus TCP.
    pub host: String,
    pub line_settings: LineSettings,
    /// The tab of a module that was looked at last.
    pub tab: String,
    /// Where the tabs are, as the window wrote it down.
    pub layout: Option<String>,
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
            line: LineChoice::default(),
            other_port: String::new(),
            // The module's own address as it leaves the factory (PIR-234 manual 3.1).
            host: "192.168.255.1".to_owned(),
            line_settings: LineSettings::default(),
            tab: String::new(),
            layout: None,
        }
    }
}

impl Settings {
    pub fn load(storage: Option<&dyn eframe::Storage>) -> Self {
        let stored: Option<Self> = storage.and_then(|storage| eframe::get_value(storage, KEY));
        stored.unwrap_or_default().made_valid()
    }

    pub fn save(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEY, self);
    }

    fn made_valid(self) -> Self {
        let default = Self::default();
        let finite = |number: f64, otherwise: f64| if number.is_finite() { number } else { otherwise };
        Self {
            zoom: finite(self.zoom.into(), 1.0) as f32,
            // A span that was zoomed to belongs to what was looked at then.
            span: if NAMED_SPANS.contains(&self.span) { self.span } else { default.span },
            ..self
        }
        .with_zoom_in_range()
    }

    fn with_zoom_in_range(mut self) -> Self {
        self.zoom = self.zoom.clamp(*ZOOMS.start(), *ZOOMS.end());
        self
    }

    /// Puts theme and zoom in force at the start.
    pub fn apply(&self, ctx: &egui::Context) {
        ctx.set_theme(self.theme.preference());
        ctx.set_zoom_factor(self.zoom);
    }

    /// The keyboard zooms too (Ctrl with plus and minus), so what is in force is looked up.
    pub fn note_zoom(&mut self, ctx: &egui::Context) {
        self.zoom = ctx.zoom_factor();
    }
}

/// The menu at the right end of the top row.
pub fn menu(ui: &mut egui::Ui, settings: &mut Settings) {
    widgets::menu(ui, "View", "View", |ui| {
        widgets::section(ui, "Theme");
        for (choice, name) in ThemeChoice::ALL {
            if ui.radio_value(&mut settings.theme, choice, name).changed() {
                ui.ctx().set_theme(choice.preference());
            }
        }
        widgets::section(ui, "Temperatures");
        for unit in TemperatureUnit::ALL {
            ui.radio_value(&mut settings.temperature, unit, unit.symbol());
        }
        widgets::section(ui, "Size");
        ui.horizontal(zoom_buttons);
    });
}

fn zoom_buttons(ui: &mut egui::Ui) {
    let zoom = ui.ctx().zoom_factor();
    let mut wanted = None;
    if ui.button("Smaller").on_hover_text("Ctrl and minus").clicked() {
        wanted = Some(zoom - ZOOM_STEP);
    }
    ui.label(format!("{:.0} %", zoom * 100.0));
    if ui.button("Larger").on_hover_text("Ctrl and plus").clicked() {
        wanted = Some(zoom + ZOOM_STEP);
    }
    if ui.button("Reset").on_hover_text("Ctrl and 0").clicked() {
        wanted = Some(1.0);
    }
    if let Some(wanted) = wanted {
        ui.ctx().set_zoom_factor(wanted.clamp(*ZOOMS.start(), *ZOOMS.end()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_from_an_old_file_becomes_a_valid_value() {
        let broken = Settings { zoom: f32::NAN, span: f64::INFINITY, ..Settings::default() };
        assert_eq!(broken.made_valid(), Settings::default());
        let extreme = Settings { zoom: 40.0, span: 0.0, ..Settings::default() }.made_valid();
        assert_eq!((extreme.zoom, extreme.span), (3.0, DEFAULT_SPAN));
    }

    #[test]
    fn what_is_missing_has_its_default() {
        let read: Settings = serde_json::from_str(r#"{ "temperature": "Fahrenheit", "gone": 1 }"#).unwrap();
        assert_eq!(read, Settings { temperature: TemperatureUnit::Fahrenheit, ..Settings::default() });
    }
}
