//! Names by which modules and series are told apart outside the program.

use std::collections::BTreeMap;

use crate::record::history::History;
use crate::record::objects::{ModuleId, ModuleInfo, SeriesInfo};

/// A unique name for each module of a history: `PIR-234@1`, with the protocol where two would have the same
/// (`PIR-234@1:dcon`), with the line and at last a number where that does not suffice.
pub fn module_names(history: &History) -> BTreeMap<ModuleId, String> {
    let modules: Vec<(ModuleId, &ModuleInfo)> = history.modules().collect();
    let longer: [fn(&ModuleInfo) -> String; 3] = [
        ToString::to_string,
        |info| format!("{info}:{}", info.protocol),
        |info| format!("{info}:{}:{}", info.protocol, info.line),
    ];
    let mut names = BTreeMap::new();
    for (id, info) in &modules {
        let is_unique = |name: fn(&ModuleInfo) -> String| {
            modules.iter().filter(|(_, other)| name(other) == name(info)).count() == 1
        };
        let name = longer.into_iter().find(|name| is_unique(*name)).map(|name| name(info));
        names.insert(*id, name.unwrap_or_else(|| format!("{}#{}", longer[2](info), id.0.saturating_add(1))));
    }
    names
}

/// A series with its unit, as headers name it: `PIR-234@1 temperature_c [°C]`.
pub fn column_name(module: &str, series: &SeriesInfo) -> String {
    match series.unit.as_str() {
        "" => format!("{module} {}", series.item),
        unit => format!("{module} {} [{unit}]", series.item),
    }
}
