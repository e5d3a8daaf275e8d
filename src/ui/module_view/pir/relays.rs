//! The relays as switches: what they are, what they would do on a click, and why they cannot be switched.

use eframe::egui::{
    self, Align, Align2, Button, CursorIcon, Layout, Rect, Response, Role, Sense, Shape, Stroke, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};

use crate::bench::{Action, EditState, ItemState, Module};
use crate::module::{Item, ItemKind, Value};
use crate::ui::app::Pass;
use crate::ui::module_view::explanation::explanation;
use crate::ui::module_view::form;
use crate::ui::module_view::series::{Freshness, Series};
use crate::ui::module_view::watchdog;
use crate::ui::theme::{self, Palette};
use crate::ui::{widgets, words};

/// The source with which an output follows commands.
const COMMAND: &str = "command";
const ACTIVE_STATE: &str = "output_active_state";

/// Why a click on a relay does nothing.
enum Barred {
    /// How it is switched instead.
    ReadOnly(String),
    Tripped,
    /// It follows this source.
    Source(String),
    Busy,
    /// Nothing can be written at present, for this reason.
    Line(&'static str),
}

/// The relays side by side, and below them what frees all of them.
pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, outputs: &[&Series<'_>]) {
    ui.horizontal_wrapped(|ui| {
        for series in outputs {
            relay(ui, module, pass, series);
        }
    });
    if !outputs.is_empty() && outputs.iter().all(|series| !series.item.read_only) && watchdog::has_tripped(module) {
        form::action(ui, module, pass, "clear_watchdog");
    }
}

fn relay(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, series: &Series<'_>) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(theme::RELAY.into(), Sense::hover());
    ui.painter().rect_filled(rect, theme::UNIT, palette.panel);
    let layout = Layout::top_down(Align::Min);
    let mut ui =
        ui.new_child(UiBuilder::new().id_salt(&series.item.id).max_rect(rect.shrink(theme::GAP)).layout(layout));
    let ui = &mut ui;
    let item = series.item;
    let barred = barred(module, item).or_else(|| pass.bench.line().obstacle().map(Barred::Line));
    heading(ui, module, series, pass, palette);
    ui.horizontal(|ui| {
        // A switch that was refused stands where the module says it does.
        let under_way = module.edit(&item.id).is_some_and(crate::bench::Edit::is_being_written);
        let position = if under_way { module.wanted(&item.id) } else { module.known(&item.id) };
        let shown = position.and_then(Value::as_bool);
        let response = switch(ui, item, shown, barred.is_none());
        if response.on_hover_text(explanation(module, item)).clicked() {
            let on = !shown.unwrap_or(false);
            pass.actions.push(Action::Set(module.target, item.id.clone(), on.to_string()));
        }
        contact(ui, module, item);
    });
    reason(ui, module, item, barred.as_ref());
    way_out(ui, module, pass, item, barred.as_ref());
}

/// Name, and how old the state is.
fn heading(ui: &mut Ui, module: &Module, series: &Series<'_>, pass: &Pass<'_>, palette: &Palette) {
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new(series.label).color(palette.text).strong()).on_hover_text(&series.item.help);
        let age = match series.freshness(module, pass.bench.now()) {
            Freshness::Old(age) => format!("{} old", words::age(age)),
            Freshness::Unknown => "not known".to_owned(),
            Freshness::Fresh => String::new(),
        };
        widgets::at_right(ui, |ui| drop(ui.label(egui::RichText::new(age).small().color(palette.old))));
    });
}

/// A slide switch with its position in words.
fn switch(ui: &mut Ui, item: &Item, on: Option<bool>, enabled: bool) -> Response {
    let palette = theme::palette(ui);
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(theme::SWITCH.into(), sense);
    let (track, edge, word) = match on {
        Some(true) => (palette.output, palette.output, "ON"),
        Some(false) => (palette.raised, palette.raised_pressed, "OFF"),
        None => (palette.ground, palette.raised_pressed, words::UNKNOWN),
    };
    let focused = response.hovered() || response.has_focus();
    let edge = if focused && enabled { palette.accent } else { edge };
    let rounding = rect.height() / 2.0;
    ui.painter().rect(rect, rounding, track, Stroke::new(theme::OUTLINE, edge), egui::StrokeKind::Inside);

    let radius = rounding - theme::UNIT;
    let (knob, text) = match on {
        Some(true) => (rect.right() - rounding, rect.with_max_x(rect.right() - 2.0 * rounding)),
        Some(false) => (rect.left() + rounding, rect.with_min_x(rect.left() + 2.0 * rounding)),
        None => (rect.center().x, rect.with_min_x(rect.center().x + radius)),
    };
    let (fill, ink) = match on {
        Some(true) => (palette.ground, palette.ground),
        Some(false) => (palette.quiet, palette.text),
        None => (palette.old, palette.old),
    };
    // A knob that cannot be moved is hollow.
    if enabled {
        ui.painter().circle_filled(pos2(knob, rect.center().y), radius, fill);
    } else {
        let stroke = Stroke::new(theme::OUTLINE, fill);
        ui.painter().circle_stroke(pos2(knob, rect.center().y), radius - theme::OUTLINE / 2.0, stroke);
    }
    widgets::line_in(ui, text.shrink2(vec2(theme::UNIT, 0.0)), Align::Center, word, theme::body(), ink);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Switch, enabled, &item.label);
        info.selected = on;
        info.current_text_value = Some(word.to_owned());
        info
    });
    if enabled { response.on_hover_cursor(CursorIcon::PointingHand) } else { response }
}

/// The contact behind the output, open or closed, and that in words.
fn contact(ui: &mut Ui, module: &Module, item: &Item) {
    let palette = theme::palette(ui);
    let on = module.known(&item.id).and_then(Value::as_bool);
    // A reading tells of the relay itself, an output of the value that it was given.
    let low = item.id != "relay" && active_low(module);
    let active = on.map(|on| on != low);
    let (rect, _) = ui.allocate_exact_size(theme::CONTACT.into(), Sense::hover());
    let ink = if active == Some(true) { palette.output } else { palette.quiet };
    paint_contact(ui, rect, active, Stroke::new(theme::TRACE, ink));
    let text = match active {
        Some(true) => "relay active",
        Some(false) => "relay not active",
        None => "not known",
    };
    let text = if low { format!("{text}\n(inverted)") } else { text.to_owned() };
    ui.label(egui::RichText::new(text).color(palette.quiet)).on_hover_text(match low {
        true => "Output active state is low: OFF makes the relay active",
        false => "Output active state is high, or not told: ON makes the relay active",
    });
}

fn active_low(module: &Module) -> bool {
    matches!(module.known(ACTIVE_STATE), Some(Value::Choice(word)) if word == "low")
}

fn paint_contact(ui: &Ui, rect: Rect, closed: Option<bool>, stroke: Stroke) {
    let y = rect.center().y;
    let [start, left, right, end] = [0.0, 0.28, 0.72, 1.0].map(|part| pos2(rect.left() + rect.width() * part, y));
    let painter = ui.painter();
    painter.line_segment([start, left], stroke);
    painter.line_segment([right, end], stroke);
    let length = right.x - left.x;
    let tip = match closed {
        Some(true) => right,
        _ => pos2(right.x - length * 0.1, y - length * theme::CONTACT_LIFT),
    };
    match closed {
        Some(_) => drop(painter.line_segment([left, tip], stroke)),
        None => painter.extend(Shape::dashed_line(&[left, tip], stroke, theme::UNIT / 2.0, theme::UNIT / 2.0)),
    }
    for end in [left, right] {
        painter.circle_filled(end, theme::CONTACT_POINT, stroke.color);
    }
}

fn barred(module: &Module, item: &Item) -> Option<Barred> {
    if item.read_only || item.item_kind == ItemKind::Reading {
        return Some(Barred::ReadOnly(how_it_is_switched(module)));
    }
    if module.edit(&item.id).is_some_and(|edit| matches!(edit.state, EditState::Writing(_))) {
        return Some(Barred::Busy);
    }
    if watchdog::has_tripped(module) {
        return Some(Barred::Tripped);
    }
    let source = source_of(module, item)?;
    match module.known(&source.id) {
        Some(Value::Choice(word)) if word != COMMAND => {
            module.known(&source.id).map(|value| Barred::Source(source.bare_text(value)))
        }
        _ => None,
    }
}

fn source_of<'a>(module: &'a Module, item: &Item) -> Option<&'a Item> {
    module.item(&format!("{}_source", item.id)).filter(|source| module.has(source))
}

/// As far as the settings are known.
fn how_it_is_switched(module: &Module) -> String {
    let text = |id: &str| module.item(id).and_then(|item| module.known(id).map(|value| item.text(value)));
    let lasting = text("pir_on_time").map(|time| format!(" for {time}")).unwrap_or_default();
    let dark = match text("lux_level").filter(|level| level.ends_with("lux")) {
        Some(level) => format!(", when darker than {level}"),
        None => String::new(),
    };
    format!("Read only: motion switches it on{lasting}{dark}")
}

/// What is to be said of it, in room that is always kept.
fn reason(ui: &mut Ui, module: &Module, item: &Item, barred: Option<&Barred>) {
    let palette = theme::palette(ui);
    let safe = module.known(&format!("{}_safe", item.id)).map(|value| format!(" ({})", item.bare_text(value)));
    let (colour, text) = match (barred, module.state(&item.id)) {
        (_, ItemState::BeingWritten) => (palette.accent, "being written".to_owned()),
        (_, ItemState::Refused(reason)) => (palette.error, format!("Not switched: {reason}")),
        (Some(Barred::Line(reason)), _) => (palette.quiet, (*reason).to_owned()),
        (_, ItemState::Unreadable(failure)) => (palette.error, words::not_read(failure)),
        (Some(Barred::ReadOnly(how)), _) => (palette.quiet, how.clone()),
        (Some(Barred::Tripped), _) => {
            let safe = safe.unwrap_or_default();
            (palette.error, format!("Holds its safe value{safe}: the host watchdog has tripped"))
        }
        (Some(Barred::Source(source)), _) => (palette.text, format!("Follows {source}: commands are refused")),
        _ => (palette.quiet, "Follows commands: a click switches at once".to_owned()),
    };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::RELAY_REASON), Sense::hover());
    let galley = ui.fonts_mut(|fonts| fonts.layout(text.clone(), theme::small(), colour, rect.width()));
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.galley(Align2::LEFT_TOP.align_size_within_rect(galley.size(), rect).min, galley, colour);
    widgets::describe(&response, Role::Label, &format!("{}: {text}", item.label));
    match module.state(&item.id) {
        ItemState::Unreadable(failure) if barred.is_none() => response.on_hover_text(failure.to_string()),
        _ => response.on_hover_text(text),
    };
}

/// The button that lets the next click succeed, if there is one.
fn way_out(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item, barred: Option<&Barred>) {
    if let ItemState::Refused(_) = module.state(&item.id) {
        if named(ui, None, "Dismiss", &format!("Dismiss {}", item.label), "The relay stays as it is") {
            pass.actions.push(Action::Revert(module.target, Some(item.id.clone())));
        }
        return;
    }
    let (Some(Barred::Source(_)), Some(source)) = (barred, source_of(module, item)) else { return };
    if let ItemState::Refused(reason) = module.state(&source.id) {
        widgets::quiet_small(ui, reason);
        return;
    }
    let busy = module.edit(&source.id).is_some_and(|edit| matches!(edit.state, EditState::Writing(_)));
    let help = format!("Sets {} to command and writes it at once", source.label);
    let name = format!("Let commands switch {}", item.label);
    let barred = pass.bench.line().obstacle().or(busy.then_some("It is being written"));
    if named(ui, barred, "Let commands switch it", &name, &help) {
        pass.actions.push(Action::Set(module.target, source.id.clone(), COMMAND.to_owned()));
    }
}

fn named(ui: &mut Ui, barred: Option<&str>, text: &str, name: &str, help: &str) -> bool {
    let enabled = barred.is_none();
    let response = ui.add_enabled(enabled, Button::new(text)).on_hover_text(help);
    let response = response.on_disabled_hover_text(barred.unwrap_or_default());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    response.clicked()
}
