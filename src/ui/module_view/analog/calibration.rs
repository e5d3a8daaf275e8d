//! Offsets from a reference instrument: what it shows, less what the module reads, is added to the present offset.

use std::collections::BTreeMap;

use eframe::egui::{Align, Button, Color32, Key, Layout, Role, Sense, TextEdit, Ui, UiBuilder, WidgetInfo, vec2};

use super::super::series::{Freshness, Series, series_of};
use super::super::temperature;
use crate::bench::{Action, Bench, Edit, Module};
use crate::module::{Fixed, Item, Kind, Value};
use crate::ui::app::Pass;
use crate::ui::settings::TemperatureUnit;
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};
use crate::ui::words;

/// No instrument shows more; it keeps the sums far from what a number can hold.
const MOST: f64 = 1e6;

/// What was typed for each offset, by its id.
#[derive(Default)]
pub struct Calibration {
    typed: BTreeMap<String, String>,
}

/// The live reading that an offset is added to, in the offset's unit.
pub fn measured<'a>(bench: &'a Bench, module: &'a Module, offset: &Item) -> Option<Series<'a>> {
    let stem = offset.id.strip_suffix("_offset").filter(|_| !offset.read_only)?;
    let series = TemperatureUnit::ALL.into_iter().flat_map(|unit| series_of(bench.history(), module, unit));
    series.into_iter().find(|one| one.is_number() && one.stem == stem && one.unit == offset.unit)
}

impl Calibration {
    /// The line beneath an offset: the reference, and what follows from it. Enter stages it, Esc empties the field.
    pub fn row(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, offset: &Item) {
        let Some(series) = measured(pass.bench, module, offset) else { return };
        let unit = reference_unit(offset, pass.settings.temperature);
        let typed = self.typed.entry(offset.id.clone()).or_default();
        ui.horizontal(|ui| {
            let palette = theme::palette(ui);
            widgets::fixed_coloured(ui, theme::FORM_LABEL, Align::Min, "The reference shows", palette.quiet)
                .on_hover_text(REFERENCE);
            let entered = field(ui, offset, typed);
            widgets::fixed_coloured(ui, theme::FORM_UNIT, Align::Min, unit, palette.quiet);
            let outcome = outcome(module, pass, offset, &series, typed, unit);
            told(ui, offset, &outcome);
            let writing = module.edit(&offset.id).is_some_and(Edit::is_being_written);
            let ready = outcome.as_ref().ok().filter(|_| !writing);
            let button = Button::new("Use").min_size(vec2(theme::USE_WIDTH, theme::CONTROL_HEIGHT));
            let button = ui.add_enabled(ready.is_some(), button);
            button.widget_info(|| {
                WidgetInfo::labeled(Role::Button, ready.is_some(), format!("Use for {}", offset.label))
            });
            let clicked =
                button.on_hover_text("Puts the result into the offset above, to be written (Enter)").clicked();
            if let Some(sum) = ready.filter(|_| clicked || entered) {
                pass.actions.push(Action::Stage(module.target, offset.id.clone(), sum.fitted.to_string()));
            }
        });
    }
}

/// A temperature is typed in the chosen unit, everything else in the offset's own.
fn reference_unit(offset: &Item, chosen: TemperatureUnit) -> &str {
    match temperature::converted(0.0, chosen.symbol(), &offset.unit) {
        Some(_) => chosen.symbol(),
        None => &offset.unit,
    }
}

const REFERENCE: &str = "What a reference instrument shows beside the module; the offset that makes the reading the same follows \
                         from it";

/// True if Enter was pressed in it.
fn field(ui: &mut Ui, offset: &Item, typed: &mut String) -> bool {
    let (cell, _) = ui.allocate_exact_size(vec2(theme::FORM_EDITOR, theme::CONTROL_HEIGHT), Sense::hover());
    let layout = Layout::left_to_right(Align::Center);
    let mut ui = ui.new_child(UiBuilder::new().max_rect(cell).layout(layout).id_salt(("reference", &offset.id)));
    let edit = TextEdit::singleline(typed)
        .desired_width(theme::FORM_EDITOR - theme::FIELD_MARGIN)
        .align(eframe::egui::Align2::RIGHT_CENTER);
    let response = ui.add(edit);
    widgets::name_field(&response, &format!("Reference for {}", offset.label), typed);
    let response = response.on_hover_text(REFERENCE);
    let (escaped, entered) = ui.input(|input| (input.key_pressed(Key::Escape), input.key_pressed(Key::Enter)));
    if response.lost_focus() && escaped {
        typed.clear();
    }
    response.lost_focus() && entered
}

/// Why there is no result.
enum NoResult {
    /// Nothing was typed.
    Idle,
    Refused(String),
}

fn outcome(
    module: &Module,
    pass: &Pass<'_>,
    offset: &Item,
    series: &Series<'_>,
    typed: &str,
    unit: &str,
) -> Result<Sum, NoResult> {
    if typed.trim().is_empty() {
        return Err(NoResult::Idle);
    }
    let refused = |text: &str| NoResult::Refused(text.to_owned());
    let reference = typed.trim().parse::<f64>().ok().filter(|number| number.abs() < MOST);
    let reference = reference.ok_or_else(|| refused("not a number – use one such as 25.3"))?;
    let (Some(Value::Number(present)), Some(at)) = (module.known(&offset.id), read_at(module, &offset.id)) else {
        return Err(refused("the present offset is not known – read it first"));
    };
    let reading = match (series.freshness(module, pass.bench.now()), series.reading.and_then(|one| one.value.as_ref()))
    {
        (Freshness::Fresh, Some(Value::Number(reading))) => reading,
        (Freshness::Old(age), _) => {
            return Err(NoResult::Refused(format!("the reading is {} old – it has to be polled", words::age(age))));
        }
        _ => return Err(refused("the reading is not known – it has to be polled")),
    };
    // A reading from before the offset was written still contains the offset before.
    if read_at(module, &series.item.id) < Some(at) {
        return Err(refused("waiting for a reading with the present offset"));
    }
    Sum::new(offset, *present, *reading, reference, unit).ok_or_else(|| refused("the numbers do not fit together"))
}

fn read_at(module: &Module, id: &str) -> Option<jiff::Timestamp> {
    module.reading(id).and_then(|reading| reading.at)
}

/// A new offset and how it comes about, all in the unit and decimals of the offset.
#[derive(Debug, PartialEq)]
struct Sum {
    present: Fixed,
    reference: Fixed,
    reading: Fixed,
    result: Fixed,
    /// The result, or the end of the range that it exceeds.
    fitted: Fixed,
    unit: String,
    /// The reference was typed in another unit.
    converted: bool,
}

impl Sum {
    fn new(offset: &Item, present: Fixed, reading: Fixed, reference: f64, unit: &str) -> Option<Self> {
        let Kind::Number { min, max, .. } = &offset.kind else { return None };
        let decimals = min.decimals;
        let same = |number: Fixed| Fixed::from_f64(number.to_f64(), decimals);
        let (present, reading) = (same(present), same(reading));
        let reference = Fixed::from_f64(temperature::converted(reference, unit, &offset.unit)?, decimals);
        let raw = present.raw.checked_add(reference.raw.checked_sub(reading.raw)?)?;
        let fitted = Fixed::new(raw.max(min.raw).min(max.raw), decimals);
        let (unit, converted) = (offset.unit.clone(), unit != offset.unit);
        Some(Self { present, reference, reading, result: Fixed::new(raw, decimals), fitted, unit, converted })
    }

    /// `0.00 + (25.30 − 24.99) = 0.31 °C`.
    fn text(&self) -> String {
        let Self { present, reference, reading, result, fitted, unit, converted } = self;
        let converted = if *converted { format!("= {reference} {unit}; ") } else { String::new() };
        let sum = format!("{converted}{present} + ({reference} − {}) = {result} {unit}", term(*reading));
        if result == fitted { sum } else { format!("{sum}, limited to {fitted}") }
    }
}

/// A negative number after an operator stands in brackets.
fn term(number: Fixed) -> String {
    if number.raw < 0 { format!("({number})") } else { number.to_string() }
}

fn told(ui: &mut Ui, offset: &Item, outcome: &Result<Sum, NoResult>) {
    let palette = theme::palette(ui);
    let (glyph, colour, text): (Option<Glyph>, Color32, String) = match outcome {
        Ok(sum) if sum.result != sum.fitted => (Some(Glyph::Outline), palette.warning, sum.text()),
        Ok(sum) => (None, palette.text, sum.text()),
        Err(NoResult::Refused(reason)) => (Some(Glyph::Cross), palette.error, reason.clone()),
        Err(NoResult::Idle) => (None, palette.old, "computes the offset from a reference".to_owned()),
    };
    let others = theme::USE_WIDTH + theme::GLYPH + 3.0 * theme::GAP;
    let width = (ui.available_width() - others).clamp(0.0, theme::FORM_STATE);
    match glyph {
        Some(glyph) => drop(widgets::glyph(ui, glyph, colour)),
        None => drop(ui.allocate_exact_size(vec2(theme::GLYPH, theme::CONTROL_HEIGHT), Sense::hover())),
    }
    let response = widgets::fixed_coloured(ui, width, Align::Min, &text, colour);
    widgets::describe(&response, Role::Label, &format!("Reference for {}: {text}", offset.label));
    response.on_hover_text(&text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::module::Catalogue;

    fn sum(present: i64, reading: i64, reference: f64, unit: &str) -> Sum {
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        let offset = definition.item("temperature_offset").unwrap();
        Sum::new(offset, Fixed::new(present, 2), Fixed::new(reading, 2), reference, unit).unwrap()
    }

    #[test]
    fn the_difference_to_the_reference_is_added_to_the_present_offset() {
        let sum = sum(20, 2_499, 25.3, "°C");
        assert_eq!(sum.fitted, Fixed::new(51, 2));
        assert_eq!(sum.text(), "0.20 + (25.30 − 24.99) = 0.51 °C");
    }

    #[test]
    fn a_reference_in_fahrenheit_gives_an_offset_in_celsius() {
        let sum = sum(0, 2_499, 75.0, "°F");
        assert_eq!(sum.fitted, Fixed::new(-110, 2));
        assert_eq!(sum.text(), "= 23.89 °C; 0.00 + (23.89 − 24.99) = -1.10 °C");
    }

    #[test]
    fn an_offset_beyond_the_range_ends_at_its_limit() {
        let sum = sum(9_000, -2_000, 20.0, "°C");
        assert_eq!(sum.fitted, Fixed::new(10_000, 2));
        assert_eq!(sum.text(), "90.00 + (20.00 − (-20.00)) = 130.00 °C, limited to 100.00");
    }
}
