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

/// Values as they were read last, and what waits to be written; of a secret neither, as what is copied is passed on.
pub fn sheet<'a>(module: &Module, items: impl IntoIterator<Item = &'a Item>) -> Sheet {
    let mut sheet = Sheet::new(HEADER);
    for item in items {
        let value = module.known(&item.id).filter(|_| !item.secret);
        let value = value.map(|value| item.bare_text(value)).unwrap_or_default();
        let edit = module.edit(&item.id).filter(|_| !item.secret);
        let edit = edit.map(|edit| edit.text.clone()).unwrap_or_default();
        let factory = item.factory.as_ref().map(|value| item.bare_text(value)).unwrap_or_default();
        let read = module.reading(&item.id).and_then(|reading| reading.at);
        let read = read.map(|at| format!("{at:.3}")).unwrap_or_default();
        sheet.push([&item.label, &value, &item.unit, &edit, &factory, &read, &item.id]);
    }
    sheet
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use jiff::Timestamp;

    use super::*;
    use crate::bench::Reading;
    use crate::bus::{RequestId, Target};
    use crate::module::{Catalogue, Identified};
    use crate::protocol::{LineSettings, Protocol};

    /// A PIR-234 with Wi-Fi whose values were read.
    fn module(values: &[(&str, &str)]) -> Module {
        let definition = Catalogue::built_in().0.get("pir-234");
        let (name, firmware, said) = ("PIR234".to_owned(), "B2.8".to_owned(), String::new());
        let identified = Identified { name, firmware, said, definition };
        let settings = LineSettings::default();
        let target = Target { address: 1, protocol: Protocol::ModbusTcp, settings, checksum: false };
        let mut module = Module::new(RequestId(0), target, identified, Timestamp::UNIX_EPOCH);
        module.parts = Some(vec!["wifi".to_owned()]);
        let read = |(id, text): &(&str, &str)| {
            let value = module.item(id)?.parse_any(text);
            Some(((*id).to_owned(), Reading { value, at: Some(Timestamp::UNIX_EPOCH), ..Reading::default() }))
        };
        let readings: BTreeMap<String, Reading> = values.iter().filter_map(read).collect();
        module.readings.extend(readings);
        module
    }

    #[test]
    fn a_secret_is_not_copied_with_the_table() {
        let module = module(&[("wifi_wpa_password", "hush-hush"), ("pir_on_time", "33")]);
        let text = whole(&module).into_text();
        let row = |id: &str| text.lines().find(|row| row.ends_with(id)).expect("a row of each item").to_owned();
        assert!(row("wifi_wpa_password").starts_with("WPA") && !text.contains("hush-hush"), "{text}");
        assert!(row("pir_on_time").contains("\t33\t"), "{text}");
    }
}
