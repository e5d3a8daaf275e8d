//! Settings and readings of a module as a table that is copied.

use eframe::egui::Response;

use super::tabs;
use crate::bench::Module;
use crate::module::Item;
use crate::ui::tables::{Part, Sheet, copied};

const HEADER: [&str; 7] = ["Name", "Value", "Unit", "Not written", "Factory", "Read (UTC)", "Id"];

/// Lets the row of an item be copied, or all items of its tab.
pub fn copies(response: &Response, module: &Module, item: &Item) {
    copied(response, |part| match part {
        Part::Row => sheet(module, [item]),
        Part::Table => sheet(module, tabs::items(module, &item.tab)),
    });
}

/// All that the module has.
pub fn whole(module: &Module) -> Sheet {
    let all = module.definition().into_iter().flat_map(|definition| &definition.items);
    sheet(module, all.filter(|item| module.has(item)))
}

/// Values as they were read last, and what waits to be written.
pub fn sheet<'a>(module: &Module, items: impl IntoIterator<Item = &'a Item>) -> Sheet {
    let mut sheet = Sheet::new(HEADER);
    for item in items {
        let value = module.known(&item.id).map(|value| item.bare_text(value)).unwrap_or_default();
        let edit = module.edit(&item.id).map(|edit| edit.text.clone()).unwrap_or_default();
        let factory = item.factory.as_ref().map(|value| item.bare_text(value)).unwrap_or_default();
        let read = module.reading(&item.id).and_then(|reading| reading.at);
        let read = read.map(|at| format!("{at:.3}")).unwrap_or_default();
        sheet.push([&item.label, &value, &item.unit, &edit, &factory, &read, &item.id]);
    }
    sheet
}
