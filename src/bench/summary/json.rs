//! The summary as JSON, in the shape of `show --json` and with the times.

use jiff::Timestamp;
use serde::Serialize;

use super::{Entry, Summary};
use crate::bench::objects::{InOrder, ModuleObject, ValuesObject};

#[derive(Serialize)]
struct Object<'a> {
    module: ModuleObject<'a>,
    manual: &'a str,
    at: Timestamp,
    settings: ValuesObject<'a>,
    readings: ValuesObject<'a>,
    /// When each value was read.
    times: InOrder<'a, Timestamp>,
    /// Factory settings that the manual tells.
    factory: ValuesObject<'a>,
    differs_from_factory: Vec<&'a str>,
    /// Why values are missing or old.
    problems: InOrder<'a, &'a str>,
}

pub fn json(summary: &Summary) -> serde_json::Result<String> {
    let target = &summary.target;
    let values = |wanted: fn(&Entry) -> bool| {
        let wanted = summary.entries().filter(move |entry| wanted(entry));
        InOrder(wanted.map(|entry| (entry.id.as_str(), entry.value.as_ref())).collect())
    };
    let factory = summary.entries().filter(|entry| entry.factory.is_some());
    let object = Object {
        module: ModuleObject {
            address: target.address,
            protocol: target.protocol,
            baud_rate: target.settings.baud_rate,
            data_format: target.settings.data_format,
            checksum: target.checksum,
            model: &summary.model,
            name: &summary.name,
            firmware: &summary.firmware,
            said: None,
        },
        manual: &summary.manual,
        at: summary.at,
        settings: values(|entry| entry.is_setting),
        readings: values(|entry| entry.is_reading),
        times: InOrder(summary.entries().filter_map(|entry| Some((entry.id.as_str(), entry.at?))).collect()),
        factory: InOrder(factory.map(|entry| (entry.id.as_str(), entry.factory.as_ref())).collect()),
        differs_from_factory: summary.entries().filter(|entry| entry.differs).map(|entry| entry.id.as_str()).collect(),
        problems: InOrder(
            summary.entries().filter_map(|entry| Some((entry.id.as_str(), entry.problem.as_deref()?))).collect(),
        ),
    };
    Ok(serde_json::to_string_pretty(&object)? + "\n")
}
