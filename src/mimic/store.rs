//! What a module holds and shows, item by item.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

use crate::module::{Applies, Definition, Fixed, Item, Kind, Value};
use crate::sim::Placing;

/// What a text is where the definition tells nothing: short, so that it fits everywhere.
const ANY_TEXT: &str = "text";
/// Reads the same as DCON text and as a version word (0x0100).
const FIRMWARE: &str = "1.0";
const ANY_MAC: &str = "00-0D-E0-00-00-01";
const ANY_IPV4: &str = "192.168.255.1";

/// Why a value is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// Outside its range, or no value of its kind.
    Value,
    /// It can be changed in INIT mode only.
    InitOff,
}

/// A value on its way into the store: the item's id and what it shall hold.
pub(super) type Change = (String, Value);

#[derive(Debug, Clone)]
pub(super) struct Store {
    pub definition: Arc<Definition>,
    pub init: bool,
    values: BTreeMap<String, Value>,
    /// Text of the fields of commands as they were last written, by command and field: for what no item names.
    fields: BTreeMap<(usize, String), String>,
    now: Duration,
}

impl Store {
    /// Factory values where the definition tells them, otherwise something plausible in range.
    pub fn new(definition: Arc<Definition>, placing: Placing) -> Self {
        let mut values: BTreeMap<String, Value> = BTreeMap::new();
        for item in definition.items.iter().filter(|item| !drifts(item)) {
            let value = item.factory.clone().unwrap_or_else(|| plausible(&definition, item));
            values.insert(item.id.clone(), value);
        }
        let mut store = Self { definition, init: placing.init, values, fields: BTreeMap::new(), now: Duration::ZERO };
        let Placing { address, protocol, settings, checksum, .. } = placing;
        for (id, text) in [
            ("address", address.to_string()),
            ("protocol", protocol.to_string()),
            ("baud_rate", settings.baud_rate.to_string()),
            ("data_format", settings.data_format.to_string()),
            ("checksum", checksum.to_string()),
        ] {
            store.set_text(id, &text);
        }
        store.power_on();
        store
    }

    pub fn live(&mut self, now: Duration) {
        self.now = self.now.max(now);
    }

    pub fn power_on(&mut self) {
        self.set_text("reset_status", "true");
    }

    /// What `item` holds or shows now.
    pub fn value(&self, item: &Item) -> Value {
        match (self.values.get(&item.id), item.id.as_str(), &item.kind) {
            (Some(_), "init_mode", Kind::Bool) => Value::Bool(self.init),
            (Some(value), _, _) => value.clone(),
            (None, _, Kind::Number { .. }) => self.drifting(item),
            (None, _, _) => Value::Bool(self.toggling(item)),
        }
    }

    pub fn value_of(&self, id: &str) -> Option<Value> {
        self.definition.item(id).map(|item| self.value(item))
    }

    /// Holds `text` from now on, as a test or the specification wants it; false if that is no value of the item.
    pub fn set_text(&mut self, id: &str, text: &str) -> bool {
        let value = self.definition.item(id).and_then(|item| item.parse_any(text));
        value.is_some_and(|value| {
            self.values.insert(id.to_owned(), value);
            true
        })
    }

    /// Whether the module would take `value`.
    pub fn judge(&self, item: &Item, value: &Value) -> Result<(), Refusal> {
        if item.parse_any(&value.to_string()).as_ref() != Some(value) {
            return Err(Refusal::Value);
        }
        if item.applies == Applies::Init && !self.init && self.value(item) != *value {
            return Err(Refusal::InitOff);
        }
        Ok(())
    }

    pub fn apply(&mut self, changes: Vec<Change>) {
        self.values.extend(changes);
    }

    pub fn field(&self, command: usize, field: &str) -> Option<&str> {
        self.fields.get(&(command, field.to_owned())).map(String::as_str)
    }

    pub fn keep_field(&mut self, command: usize, field: String, text: String) {
        self.fields.insert((command, field), text);
    }

    /// What reading has cleared.
    pub fn was_read(&mut self, id: &str) {
        if let Some(item) = self.definition.item(id)
            && item.on_request
            && item.read_only
            && item.kind == Kind::Bool
        {
            self.values.insert(id.to_owned(), Value::Bool(false));
        }
    }

    /// Runs slowly around its middle, within its range, the same at every run.
    fn drifting(&self, item: &Item) -> Value {
        let Kind::Number { min, max, .. } = &item.kind else { return Value::Bool(false) };
        let (middle, swing) = course(item, *min, *max);
        let (phase, period) = rhythm(item);
        let turns = self.now.as_secs_f64() / period + phase;
        Value::Number(within(middle + swing * (TAU * turns).sin(), *min, *max))
    }

    /// True for a tenth of the time.
    fn toggling(&self, item: &Item) -> bool {
        let (phase, period) = rhythm(item);
        (self.now.as_secs_f64() / period + phase).fract() > 0.9
    }
}

/// Whether it shows what it measures, instead of holding what was written.
fn drifts(item: &Item) -> bool {
    item.live && item.read_only && matches!(item.kind, Kind::Number { .. } | Kind::Bool)
}

fn plausible(definition: &Definition, item: &Item) -> Value {
    match &item.kind {
        Kind::Bool => Value::Bool(false),
        Kind::Number { min, max, .. } if item.read_only => Value::Number(latched(item, *min, *max)),
        Kind::Number { min, max, .. } => Value::Number(within(0.0, *min, *max)),
        Kind::Choice(choices) => Value::Choice(choices.first().map(|choice| choice.word.clone()).unwrap_or_default()),
        Kind::Text { max_length } => Value::Text(text(definition, item).chars().take(*max_length).collect()),
        Kind::Ipv4 => Value::Text(ANY_IPV4.to_owned()),
    }
}

fn text(definition: &Definition, item: &Item) -> String {
    let identity = &definition.identity;
    let name = identity.dcon_names.first().or_else(|| identity.words.first().map(|words| &words.name));
    match item.id.as_str() {
        "name" => name.cloned().unwrap_or_else(|| definition.label.clone()),
        "firmware" => FIRMWARE.to_owned(),
        id if id.contains("mac") => ANY_MAC.to_owned(),
        _ => ANY_TEXT.to_owned(),
    }
}

/// The ends of the course for latched values, `…_high` and `…_low`; its middle for any other.
fn latched(item: &Item, min: Fixed, max: Fixed) -> Fixed {
    let (middle, swing) = course(item, min, max);
    let sign = if item.id.ends_with("_high") {
        1.0
    } else if item.id.ends_with("_low") {
        -1.0
    } else {
        0.0
    };
    within(middle + sign * swing, min, max)
}

/// Middle and swing, as a room has them.
fn course(item: &Item, min: Fixed, max: Fixed) -> (f64, f64) {
    let dew = item.id.contains("dew");
    match item.unit.as_str() {
        "°C" if dew => (9.5, 0.8),
        "°F" if dew => (49.1, 1.4),
        "°C" => (22.0, 1.5),
        "°F" => (71.6, 2.7),
        "%" => (45.0, 4.0),
        "ppm" => (620.0, 90.0),
        _ if item.live => ((min.to_f64() + max.to_f64()) / 2.0, (max.to_f64() - min.to_f64()) / 20.0),
        _ => (0.0, 0.0),
    }
}

fn within(number: f64, min: Fixed, max: Fixed) -> Fixed {
    let Fixed { raw, decimals } = Fixed::from_f64(number, min.decimals);
    Fixed { raw: raw.max(min.raw).min(max.raw), decimals }
}

/// Where in its period an item is at first, 0 to 1, and the period in seconds. Degrees of both scales go together.
fn rhythm(item: &Item) -> (f64, f64) {
    let base = item.id.strip_suffix("_f").or_else(|| item.id.strip_suffix("_c")).unwrap_or(&item.id);
    let hash = base.bytes().fold(17u32, |hash, byte| hash.wrapping_mul(31).wrapping_add(u32::from(byte)));
    (f64::from(hash % 1000) / 1000.0, 240.0 + f64::from(hash / 1000 % 240))
}
