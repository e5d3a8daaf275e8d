//! Modules and values as they stand in JSON, on the command line and in saved files.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::bus::{Target, Values};
use crate::module::{Identified, Value};
use crate::protocol::{BaudRate, DataFormat, Protocol};

/// A found module in JSON.
#[derive(Debug, Serialize)]
pub struct ModuleObject<'a> {
    pub(super) address: u8,
    pub(super) protocol: Protocol,
    pub(super) baud_rate: BaudRate,
    pub(super) data_format: DataFormat,
    pub(super) checksum: bool,
    pub(super) model: &'a str,
    pub(super) name: &'a str,
    pub(super) firmware: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) said: Option<&'a str>,
}

impl<'a> ModuleObject<'a> {
    pub fn new(target: &Target, identified: &'a Identified) -> Self {
        Self {
            address: target.address,
            protocol: target.protocol,
            baud_rate: target.settings.baud_rate,
            data_format: target.settings.data_format,
            checksum: target.checksum,
            model: identified.model(),
            name: &identified.name,
            firmware: &identified.firmware,
            said: identified.definition.is_none().then_some(&identified.said),
        }
    }
}

/// An object in JSON whose names keep their order.
#[derive(Debug)]
pub struct InOrder<'a, V>(pub Vec<(&'a str, V)>);

/// Values by name in JSON, in their order; those that could not be read are null.
pub type ValuesObject<'a> = InOrder<'a, Option<&'a Value>>;

impl<'a> ValuesObject<'a> {
    pub fn new(values: &'a Values) -> Self {
        Self::of(values, |_| true)
    }

    /// Those with an id that is `wanted`.
    pub fn of(values: &'a Values, wanted: impl Fn(&str) -> bool) -> Self {
        let wanted = values.iter().filter(|answer| wanted(&answer.id));
        Self(wanted.map(|answer| (answer.id.as_str(), answer.result.as_ref().ok())).collect())
    }
}

impl<V: Serialize> Serialize for InOrder<'_, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (id, value) in &self.0 {
            map.serialize_entry(id, value)?;
        }
        map.end()
    }
}
