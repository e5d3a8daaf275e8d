//! Everything that is known of a module on one page, compared with its factory settings: for the window, and as a
//! report to hand on.

mod html;
mod json;
mod text;
mod words;
mod zones;

#[cfg(test)]
mod tests;

use jiff::{Timestamp, tz::TimeZone};
use serde::Serialize;

pub(crate) use text::aligned;
pub use words::{UNKNOWN, address, spoken};

use super::module::Module;
use super::tab_names::{tab_label, tab_place};
use crate::bus::Target;
use crate::module::{Item, ItemKind, SwitchPanel, Value};
use crate::picture::{Picture, Zone, sensor_face, switch_picture};
use crate::protocol::Protocol;

/// What was known of a module at a time. Plain data: it does not change when the module does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// `pir-234`: the public name of the model, or `unknown`.
    pub model: String,
    /// The model's name for people.
    pub label: String,
    /// As the module calls itself.
    pub name: String,
    pub firmware: String,
    pub target: Target,
    /// Which manual the definition was written from.
    pub manual: String,
    /// When the summary was drawn up.
    pub at: Timestamp,
    /// When the oldest and the newest of its values were read.
    pub read: Option<(Timestamp, Timestamp)>,
    /// In the order of the tabs.
    pub groups: Vec<Group>,
    /// Where the settings say that the switches stand.
    #[serde(skip)]
    pub switches: SwitchPanel,
    /// What the sensor sees; empty for a module without sensor.
    #[serde(skip)]
    pub zones: Vec<Zone>,
    #[serde(skip)]
    pub zones_note: String,
}

/// What belongs to one tab.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    pub id: String,
    pub label: String,
    pub entries: Vec<Entry>,
}

/// One setting or reading.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    pub id: String,
    pub label: String,
    /// The value for people, without its unit; a dash if it is not known.
    pub text: String,
    /// Empty if it has none, as a word among numbers.
    pub unit: String,
    /// What the module said last.
    pub value: Option<Value>,
    /// The factory setting, where the manual tells it.
    pub factory: Option<Value>,
    /// The same for people; empty where the manual does not tell it.
    pub factory_text: String,
    /// Whether value and factory setting are known and not the same.
    pub differs: bool,
    /// When the value was read.
    pub at: Option<Timestamp>,
    /// Why there is no value, or why the last attempt brought none.
    pub problem: Option<String>,
    /// A setting that is kept.
    pub is_setting: bool,
    /// Something that is measured or that happens; outputs are both.
    pub is_reading: bool,
}

impl Summary {
    /// What is known of `module`; `at` is the present.
    pub fn of(module: &Module, at: Timestamp) -> Self {
        let definition = module.definition();
        let groups = groups(module);
        let times = || groups.iter().flat_map(|group| &group.entries).filter_map(|entry| entry.at);
        let on_wire = module.target.protocol != Protocol::ModbusTcp;
        let known = |id: &str| module.known(id).cloned();
        let address = on_wire.then_some(module.target.address);
        let (zones, zones_note) = zones::of(module);
        Self {
            model: module.identified.model().to_owned(),
            label: module.label().to_owned(),
            name: module.identified.name.clone(),
            firmware: module.identified.firmware.clone(),
            target: module.target,
            manual: definition.map(|definition| definition.manual.clone()).unwrap_or_default(),
            at,
            read: times().min().zip(times().max()),
            groups,
            switches: definition.map(|definition| definition.switches(address, &known)).unwrap_or_default(),
            zones,
            zones_note,
        }
    }

    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.groups.iter().flat_map(|group| &group.entries)
    }

    /// How many settings differ from factory.
    pub fn differing(&self) -> usize {
        self.entries().filter(|entry| entry.differs).count()
    }

    /// How the settings compare with the factory's, in a sentence.
    pub fn comparison(&self) -> String {
        let compared = self.entries().filter(|entry| entry.value.is_some() && entry.factory.is_some()).count();
        match (self.differing(), compared) {
            (_, 0) => "Nothing to compare with factory".to_owned(),
            (0, _) => format!("Nothing differs from factory ({compared} compared)"),
            (1, _) => format!("1 setting differs from factory ({compared} compared)"),
            (many, _) => format!("{many} settings differ from factory ({compared} compared)"),
        }
    }

    /// `46 of 48`: how many values are known.
    pub fn known(&self) -> String {
        let known = self.entries().filter(|entry| entry.value.is_some()).count();
        format!("{known} of {} values", self.entries().count())
    }

    /// The switches; none if the definition describes none.
    pub fn switch_picture(&self) -> Option<Picture> {
        (!self.switches.is_empty()).then(|| switch_picture(&self.switches))
    }

    /// The sensor; none if the module has none.
    pub fn face_picture(&self) -> Option<Picture> {
        (!self.zones.is_empty()).then(|| sensor_face(&self.zones, &self.zones_note))
    }

    /// `pir-234-1-2026-03-02.html`.
    pub fn file_name(&self, extension: &str) -> String {
        let day = self.at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d");
        format!("{}-{}-{day}.{extension}", self.model, self.target.address)
    }

    /// Aligned columns for a font of equal widths, such as in an e-mail.
    pub fn to_text(&self) -> String {
        text::text(self, &TimeZone::system())
    }

    /// One page that needs nothing else, to look at and to print.
    pub fn to_html(&self) -> String {
        html::html(self, &TimeZone::system())
    }

    /// The module, its settings and readings by their ids, as the command line prints them, and when they were read.
    ///
    /// # Errors
    /// What `serde_json` says.
    pub fn to_json(&self) -> serde_json::Result<String> {
        json::json(self)
    }

    /// Facts about the module, each with its name.
    pub(crate) fn facts(&self, zone: &TimeZone) -> Vec<(&'static str, String)> {
        let read = match self.read {
            Some((oldest, newest)) if oldest != newest => {
                let (oldest, newest) = (words::clock(oldest, self.at, zone), words::clock(newest, self.at, zone));
                format!("{}, from {oldest} to {newest}", self.known())
            }
            Some((only, _)) => format!("{}, at {}", self.known(), words::clock(only, self.at, zone)),
            None => "nothing yet".to_owned(),
        };
        vec![
            ("Model", self.label.clone()),
            ("Name", or_dash(&self.name)),
            ("Firmware", or_dash(&self.firmware)),
            ("Address", address(self.target.address)),
            ("Reached by", spoken(&self.target)),
            ("Manual", or_dash(&self.manual)),
            ("Drawn up", words::moment(self.at, zone)),
            ("Read", read),
            ("Factory", self.comparison()),
        ]
    }
}

fn or_dash(text: &str) -> String {
    if text.is_empty() { UNKNOWN.to_owned() } else { text.to_owned() }
}

fn groups(module: &Module) -> Vec<Group> {
    let items = || module.definition().into_iter().flat_map(|definition| &definition.items);
    let mut ids: Vec<&String> = Vec::new();
    for item in items().filter(|item| module.has(item)) {
        if !ids.contains(&&item.tab) {
            ids.push(&item.tab);
        }
    }
    ids.sort_by_key(|id| tab_place(id));
    let group = |id: &String| Group {
        id: id.clone(),
        label: tab_label(id).to_owned(),
        entries: items().filter(|item| item.tab == *id && module.has(item)).map(|item| entry(module, item)).collect(),
    };
    ids.into_iter().map(group).collect()
}

fn entry(module: &Module, item: &Item) -> Entry {
    let value = module.known(&item.id).filter(|_| !item.secret);
    // As in `Item::text`: a word such as "Disabled" has no unit.
    let bare = value.map(|value| item.bare_text(value));
    let has_unit = bare.as_ref().is_none_or(|text| text.parse::<f64>().is_ok());
    let reading = module.reading(&item.id);
    let differs = matches!((value, &item.factory), (Some(value), Some(factory)) if value != factory);
    Entry {
        id: item.id.clone(),
        label: item.label.clone(),
        text: or_dash(&bare.unwrap_or_default()),
        unit: if has_unit { item.unit.clone() } else { String::new() },
        value: value.cloned(),
        factory: item.factory.clone(),
        factory_text: item.factory.as_ref().map(|factory| item.bare_text(factory)).unwrap_or_default(),
        differs,
        at: reading.and_then(|reading| reading.at),
        problem: problem(module, item),
        is_setting: item.item_kind == ItemKind::Parameter,
        is_reading: item.is_reading(),
    }
}

fn problem(module: &Module, item: &Item) -> Option<String> {
    if item.secret {
        return Some("secret, so it is left out".to_owned());
    }
    let reading = module.reading(&item.id);
    if let Some(failure) = reading.and_then(|reading| reading.problem.as_ref()) {
        return Some(failure.to_string());
    }
    let reason = match module.known(&item.id) {
        Some(_) => return None,
        None if module.is_being_read(&item.id) => "being read",
        None if item.on_request => "not read: reading changes it",
        None => "not read yet",
    };
    Some(reason.to_owned())
}
