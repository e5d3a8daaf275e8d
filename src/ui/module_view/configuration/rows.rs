//! The lines of the form that need more than a field, and what is to be known of addresses and INIT mode.

use eframe::egui::{Align, Button, Role, Ui, WidgetInfo, vec2};

use super::super::form;
use crate::bench::{Action, Module};
use crate::module::{Applies, Item, Kind, Value};
use crate::ui::app::Pass;
use crate::ui::{theme, widgets, words};

/// One line; nothing if the module does not have the item.
pub fn show(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, id: &str) {
    let Some(item) = module.item(id).filter(|item| module.has(item)) else { return };
    ui.horizontal(|ui| {
        form::label(ui, module, item, theme::CONFIGURATION_LABEL);
        if item.on_request {
            on_request(ui, module, pass, item);
        } else {
            form::editor(ui, module, pass, item, theme::CONFIGURATION_EDITOR);
            unit(ui, module, item);
        }
        form::state(ui, module, pass, item);
    });
}

fn unit(ui: &mut Ui, module: &Module, item: &Item) {
    if is_address(item) {
        return other_notation(ui, module, item);
    }
    let colour = theme::palette(ui).quiet;
    widgets::fixed_coloured(ui, theme::CONFIGURATION_UNIT, Align::Min, &item.unit, colour);
}

fn is_address(item: &Item) -> bool {
    item.id == "address" && matches!(item.kind, Kind::Number { .. })
}

/// The address as it was not typed: in hexadecimal after decimal digits, in decimal after hexadecimal ones.
fn other_notation(ui: &mut Ui, module: &Module, item: &Item) {
    let typed_decimal = module.edit(&item.id).is_none_or(|edit| edit.text.trim().bytes().all(|b| b.is_ascii_digit()));
    let valid = module.edit(&item.id).is_none_or(|edit| edit.value.is_ok());
    let address = match module.wanted(&item.id) {
        Some(Value::Number(number)) if valid => u8::try_from(number.raw).ok(),
        _ => None,
    };
    let text = match address {
        Some(address) if typed_decimal => format!("= {address:02X}h"),
        Some(address) => format!("= {address}"),
        None => String::new(),
    };
    let colour = theme::palette(ui).quiet;
    let response = widgets::fixed_coloured(ui, theme::CONFIGURATION_UNIT, Align::Min, &text, colour);
    widgets::describe(&response, Role::Label, &format!("{} {text}", item.label));
    response.on_hover_text("Decimal (5) or hexadecimal (0x05, 05h)");
}

/// A value that changes by being read: it is asked for with a button only.
fn on_request(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, item: &Item) {
    let text = match module.known(&item.id) {
        Some(Value::Bool(true)) => "yes".to_owned(),
        Some(Value::Bool(false)) => "no".to_owned(),
        Some(value) => item.bare_text(value),
        None => words::UNKNOWN.to_owned(),
    };
    let room = theme::CONFIGURATION_EDITOR + theme::GAP + theme::CONFIGURATION_UNIT;
    let value = room - theme::READ_AND_CLEAR - theme::GAP;
    let response = widgets::fixed(ui, value, Align::Min, &text);
    widgets::describe(&response, Role::Label, &format!("{} {text}", item.label));
    let obstacle = pass.bench.line().obstacle();
    let idle = !module.is_being_read(&item.id) && obstacle.is_none();
    let button = Button::new("Read and clear").min_size(vec2(theme::READ_AND_CLEAR, theme::CONTROL_HEIGHT));
    let response = ui.add_enabled(idle, button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, idle, format!("Read {}", item.label)));
    let response = response.on_disabled_hover_text(obstacle.unwrap_or("It is being read"));
    if response
        .on_hover_text("Reading clears it: the next answer is no until the module is switched on again")
        .clicked()
    {
        pass.actions.push(Action::Read(module.target, vec![item.id.clone()]));
    }
}

/// One line for INIT mode, one for addresses; their room is always kept.
pub fn notes(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>, items: &[&Item]) {
    ui.add_space(theme::GAP);
    if items.iter().any(|item| item.applies == Applies::Init && !item.read_only) {
        init_note(ui, module, pass);
    }
    if items.iter().any(|item| is_address(item) && !item.read_only) {
        let colour = theme::palette(ui).quiet;
        let text = "A new address is asked first and has to stay silent; the program follows the module.";
        let width = ui.available_width();
        widgets::fixed_coloured(ui, width, Align::Min, text, colour).on_hover_text(text);
    }
}

fn init_note(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let palette = theme::palette(ui);
    let changed = module.edited_for_init().len();
    ui.horizontal(|ui| {
        let text = match changed {
            0 => "(INIT): written in INIT mode only, in force after a power cycle.".to_owned(),
            1 => "1 change is written in INIT mode only.".to_owned(),
            many => format!("{many} changes are written in INIT mode only."),
        };
        let button = if changed == 0 { 0.0 } else { theme::CHANGE_IN_INIT + theme::GAP };
        let width = (ui.available_width() - button).min(theme::TEXT_WIDTH);
        if changed > 0 {
            let wide = ui.painter().layout_no_wrap(text.clone(), theme::body(), palette.text).size().x;
            widgets::fixed_coloured(ui, width.min(wide + theme::GAP), Align::Min, &text, palette.text);
            change_in_init(ui, module, pass);
        } else {
            widgets::fixed_coloured(ui, width, Align::Min, &text, palette.quiet).on_hover_text(&text);
        }
    });
}

fn change_in_init(ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
    let edited = module.edited_for_init();
    let wrong = edited.iter().any(|id| module.edit(id).is_some_and(|edit| edit.value.is_err()));
    let obstacle = pass.bench.line().obstacle();
    let button = Button::new("Change in INIT mode…").min_size(vec2(theme::CHANGE_IN_INIT, theme::CONTROL_HEIGHT));
    let response = ui
        .add_enabled(!wrong && obstacle.is_none(), button)
        .on_hover_text("Step by step: INIT mode on, power, write, INIT mode off, power, find the module again")
        .on_disabled_hover_text(obstacle.unwrap_or("One of these values is not allowed"));
    if response.clicked() {
        pass.actions.push(Action::BeginInit(module.target));
    }
}
