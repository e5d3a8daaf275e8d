//! Histories made up for tests.

use crate::record::{History, ModuleInfo, SeriesId, SeriesInfo, SeriesKind};

pub fn series(history: &mut History, address: u8, item: &str, kind: SeriesKind) -> SeriesId {
    let info = ModuleInfo {
        address,
        label: "PIR-234".to_owned(),
        line: "COM3".to_owned(),
        protocol: "modbus_rtu".to_owned(),
        ..ModuleInfo::default()
    };
    let module = history.module(info);
    let unit = if item.contains("humidity") { "%" } else { "°C" };
    let unit = if matches!(kind, SeriesKind::Switch) { "" } else { unit };
    history.series_for(SeriesInfo {
        module,
        item: item.to_owned(),
        label: item.to_owned(),
        unit: unit.to_owned(),
        kind,
    })
}
