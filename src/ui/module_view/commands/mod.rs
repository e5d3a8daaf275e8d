//! Commands: what is sent and answered as it is. A command line with its exchanges; beside it, or in its place where
//! room is short, the reference of the module's commands, raw Modbus and scripts.

mod console;
mod exchanges;
mod fields;
mod modbus_form;
mod reference;
mod script;
mod sending;

use std::sync::Arc;

use eframe::egui::{Rect, ScrollArea, Ui, UiBuilder, vec2};

use crate::bench::Module;
use crate::bench::console::{RawCommand, ReferenceEntry, RegisterEntry, reference, register_table};
use crate::module::Definition;
use crate::ui::app::Pass;
use crate::ui::{theme, widgets};
use console::CommandLine;
use exchanges::Exchanges;
use modbus_form::ModbusPage;
use reference::ReferencePage;
use script::ScriptPage;

/// What stands beside the console, or in its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Page {
    Console,
    Reference,
    Modbus,
    Script,
}

impl Page {
    fn means(self) -> &'static str {
        match self {
            Self::Console => "A command as it is typed, and what was exchanged",
            Self::Reference => "The commands of the manual, with a form that fills each in",
            Self::Modbus => "Modbus requests by function and register, and what lives in each register",
            Self::Script => "Several commands one after the other, with pauses and repetitions",
        }
    }

    const ALL: [(Self, &'static str); 4] = [
        (Self::Console, "Console"),
        (Self::Reference, "Reference"),
        (Self::Modbus, "Modbus"),
        (Self::Script, "Script"),
    ];
}

/// What a page wants of the console.
enum Wish {
    /// Put this into the command line.
    Line(String),
    Send(RawCommand),
}

/// What the definition tells of the module's commands and registers.
struct Known {
    definition: Arc<Definition>,
    entries: Vec<ReferenceEntry>,
    registers: Vec<RegisterEntry>,
}

/// What the tab remembers between frames.
#[derive(Default)]
pub struct Commands {
    page: Option<Page>,
    known: Option<Known>,
    line: CommandLine,
    exchanges: Exchanges,
    reference: ReferencePage,
    modbus: ModbusPage,
    script: ScriptPage,
}

impl Commands {
    pub fn show(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        self.know(module);
        let wide = ui.available_width() >= theme::COMMANDS_WIDE;
        let page = self.page(module, wide);
        if wide {
            let room = ui.available_rect_before_wrap();
            let (left, right) = room.split_left_right_at_x(room.right() - theme::COMMANDS_SIDE);
            inside(ui, left.with_max_x(left.right() - theme::GAP_SECTION), "console", |ui| {
                self.console(ui, module, pass);
            });
            inside(ui, right, "beside", |ui| {
                self.chips(ui, page, &Page::ALL[1..]);
                self.beside(ui, page, true, module, pass);
            });
            return;
        }
        self.chips(ui, page, &Page::ALL);
        if page == Page::Console {
            return self.console(ui, module, pass);
        }
        let room = ui.available_rect_before_wrap();
        let (upper, lower) = room.split_top_bottom_at_y(room.bottom() - theme::COMMANDS_BELOW.min(room.height() / 2.0));
        inside(ui, upper.with_max_y(upper.bottom() - theme::GAP), "above", |ui| {
            self.beside(ui, page, false, module, pass);
        });
        inside(ui, lower, "below", |ui| self.exchanges.show(ui, module, pass));
    }

    fn know(&mut self, module: &Module) {
        let Some(definition) = module.definition() else { return };
        let same = |known: &Known| Arc::ptr_eq(&known.definition, definition);
        if !self.known.as_ref().is_some_and(same) {
            self.known = Some(Known {
                definition: definition.clone(),
                entries: reference(definition),
                registers: register_table(definition, sending::modbus_of(module)),
            });
        }
    }

    /// A module that speaks Modbus is asked by function and register first, one that speaks DCON by its commands.
    fn page(&self, module: &Module, wide: bool) -> Page {
        let modbus = module.target.protocol.is_modbus();
        let first = if modbus { Page::Modbus } else { Page::Console };
        match self.page.unwrap_or(first) {
            Page::Console if wide && modbus => Page::Modbus,
            Page::Console if wide => Page::Reference,
            page => page,
        }
    }

    fn chips(&mut self, ui: &mut Ui, page: Page, pages: &[(Page, &str)]) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = theme::UNIT;
            for (other, label) in pages {
                if widgets::chip(ui, *other == page, label, &format!("{label} page"), other.means()) {
                    self.page = Some(*other);
                }
            }
        });
        ui.add_space(theme::UNIT);
    }

    fn console(&mut self, ui: &mut Ui, module: &Module, pass: &mut Pass<'_>) {
        self.line.show(ui, module, pass);
        ui.add_space(theme::GAP);
        self.exchanges.show(ui, module, pass);
    }

    fn beside(&mut self, ui: &mut Ui, page: Page, wide: bool, module: &Module, pass: &mut Pass<'_>) {
        let Some(known) = &self.known else { return };
        let wish = match page {
            Page::Console => None,
            Page::Reference => self.reference.show(ui, module, pass, &known.entries),
            Page::Modbus => self.modbus.show(ui, module, pass, &known.registers),
            Page::Script => {
                self.script.show(ui, module, pass);
                None
            }
        };
        match wish {
            Some(Wish::Line(line)) => {
                self.line.put(line);
                if !wide {
                    self.page = Some(Page::Console);
                }
            }
            Some(Wish::Send(command)) => sending::send(module, pass, command),
            None => {}
        }
    }
}

/// Draws into a part of the room.
fn inside(ui: &mut Ui, rect: Rect, name: &str, contents: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(rect).id_salt(name), contents);
}

/// A list that takes what room is left.
fn scrolled(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().id_salt(name).auto_shrink(false).show(ui, |ui| {
        // The bar lies over the right edge.
        ui.set_max_width(ui.available_width() - theme::GAP);
        contents(ui);
    });
}

/// A line of the window's usual height.
fn line_size(ui: &Ui) -> eframe::egui::Vec2 {
    vec2(ui.available_width(), theme::CONTROL_HEIGHT)
}
