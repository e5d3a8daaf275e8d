//! The sensor as seen from below, with what each of its zones sees.

use eframe::egui::{Align, Ui, pos2};

use crate::bench::{Action, EditState, Module};
use crate::module::Value;
use crate::picture::{Zone, ZoneState, sensor_face};
use crate::ui::app::Pass;
use crate::ui::module_view::series::{Freshness, Series};
use crate::ui::picture::{self, Look};
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

/// `3` for `pir3`, which is a zone of its own.
pub fn zone_of(id: &str) -> Option<u8> {
    id.strip_prefix("pir")?.parse().ok()
}

/// A zone as it is drawn, and the setting that turns it off, where there is one.
struct Part {
    zone: Zone,
    enabled: Option<String>,
}

pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, series: &[Series<'_>]) {
    let now = pass.bench.now();
    let parts = parts(module, series, now);
    let whole = series.iter().find(|series| series.item.id == "pir");
    let note = note(module, whole, series, now);
    let zones: Vec<Zone> = parts.iter().map(|part| part.zone.clone()).collect();
    let clicks: Vec<Option<String>> = parts.iter().map(|part| click_words(module, part)).collect();
    let look = Look {
        width: theme::FACE_WIDTH,
        name: &format!("Sensor: {}", told(&zones, &note)),
        faded: is_old(module, series, now),
        clicks: &clicks,
    };
    let spots = picture::show(ui, &sensor_face(&zones, &note), &look);
    for (part, spot) in parts.iter().zip(&spots) {
        let Some(enabled) = &part.enabled else { continue };
        if spot.clicked() {
            let on = module.wanted(enabled).and_then(Value::as_bool).unwrap_or(true);
            pass.actions.push(Action::Stage(module.target, enabled.clone(), (!on).to_string()));
        }
        if module.edit(enabled).is_some_and(|edit| matches!(edit.state, EditState::Staged)) {
            let corner = pos2(spot.rect.right() - theme::GLYPH / 2.0, spot.rect.top() + theme::GLYPH / 2.0);
            let palette = theme::palette(ui);
            ui.painter().circle_filled(corner, theme::GLYPH * 0.75, palette.ground);
            widgets::paint_glyph(ui.painter(), Glyph::Edited, corner, theme::GLYPH, palette.accent);
        }
    }
    if clicks.iter().any(Option::is_some) {
        let colour = theme::palette(ui).quiet;
        let hint = "Click a zone to enable or disable it";
        widgets::fixed_coloured(ui, theme::FACE_WIDTH, Align::Center, hint, colour);
    }
}

/// The zones that the model has, whether or not the protocol tells of each; a model without any is one zone.
fn parts(module: &Module, series: &[Series<'_>], now: jiff::Timestamp) -> Vec<Part> {
    let items = module.definition().into_iter().flat_map(|definition| &definition.items);
    let zones = items.filter_map(|item| zone_of(&item.id).map(|number| (item, number)));
    let parts: Vec<Part> = zones
        .map(|(item, number)| {
            let enabled = format!("pir{number}_enabled");
            let there = module.item(&enabled).is_some_and(|item| module.has(item));
            let off = module.known(&enabled).and_then(Value::as_bool) == Some(false);
            let seen = series.iter().find(|series| series.item.id == item.id);
            let state = if off { ZoneState::Disabled } else { seen_state(module, seen, now) };
            Part { zone: Zone { label: format!("PIR {number}"), state }, enabled: there.then_some(enabled) }
        })
        .collect();
    if !parts.is_empty() {
        return parts;
    }
    let whole = series.iter().find(|series| series.item.id == "pir");
    vec![Part { zone: Zone { label: "PIR".to_owned(), state: seen_state(module, whole, now) }, enabled: None }]
}

fn seen_state(module: &Module, series: Option<&Series<'_>>, now: jiff::Timestamp) -> ZoneState {
    let Some(series) = series else { return ZoneState::Unknown };
    let value = series.reading.and_then(|reading| reading.value.as_ref()).and_then(Value::as_bool);
    match (value, series.freshness(module, now)) {
        (_, Freshness::Unknown) | (None, _) => ZoneState::Unknown,
        (Some(true), _) => ZoneState::Motion,
        (Some(false), _) => ZoneState::Quiet,
    }
}

/// What has to be said of the picture as a whole.
fn note(module: &Module, whole: Option<&Series<'_>>, series: &[Series<'_>], now: jiff::Timestamp) -> String {
    let zoned = series.iter().any(|series| zone_of(&series.item.id).is_some());
    let protocol = module.target.protocol.label();
    match whole {
        _ if zoned => match oldest(module, series, now) {
            Some(age) => format!("{} old", words::age(age)),
            None => String::new(),
        },
        Some(whole) => match seen_state(module, Some(whole), now) {
            ZoneState::Motion => "any sensor: motion".to_owned(),
            ZoneState::Quiet => "any sensor: quiet".to_owned(),
            _ => "any sensor: not known".to_owned(),
        },
        None => format!("{protocol} reports no motion"),
    }
}

fn oldest(module: &Module, series: &[Series<'_>], now: jiff::Timestamp) -> Option<std::time::Duration> {
    let ages = series.iter().filter(|series| zone_of(&series.item.id).is_some() || series.item.id == "pir");
    ages.filter_map(|series| match series.freshness(module, now) {
        Freshness::Old(age) => Some(age),
        _ => None,
    })
    .max()
}

fn is_old(module: &Module, series: &[Series<'_>], now: jiff::Timestamp) -> bool {
    oldest(module, series, now).is_some()
}

/// `PIR 1 motion, PIR 2 quiet, any sensor: motion`.
fn told(zones: &[Zone], note: &str) -> String {
    let mut parts: Vec<String> = zones
        .iter()
        .map(|zone| match zone.state {
            ZoneState::Unknown => format!("{} not known", zone.label),
            state => format!("{} {}", zone.label, state.word()),
        })
        .collect();
    parts.extend((!note.is_empty()).then(|| note.to_owned()));
    parts.join(", ")
}

fn click_words(module: &Module, part: &Part) -> Option<String> {
    let enabled = part.enabled.as_ref()?;
    let known = module.wanted(enabled).and_then(Value::as_bool)?;
    let word = if known { "disable" } else { "enable" };
    Some(format!("Click to {word} it; the change is written with Write"))
}
