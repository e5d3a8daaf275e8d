//! Settings as a TOML table, value by value: one that cannot be used does not lose the others, and what is not known
//! here stays as it was.

use serde::de::Error as _;
use toml::{Table, Value};

use super::Settings;

/// The version of the file that this program writes.
pub const VERSION: i64 = 1;
const VERSION_KEY: &str = "version";
/// So much of a reason is shown; it may quote the file.
const REASON_LENGTH: usize = 160;

/// The version that `table` says of itself, this one if it says none.
pub fn version(table: &Table) -> i64 {
    table.get(VERSION_KEY).and_then(Value::as_integer).unwrap_or(VERSION)
}

/// Reads what can be used, and says what cannot.
pub fn read(table: &Table) -> (Settings, Vec<String>) {
    let mut warnings = Vec::new();
    if table.get(VERSION_KEY).is_some_and(|value| !value.is_integer()) {
        warnings.push(format!("\"{VERSION_KEY}\" is not a whole number – {VERSION} is taken"));
    }
    let mut usable = Table::new();
    for (key, default) in schema() {
        let Some(value) = table.get(&key) else { continue };
        let attempt = |value: Value| attempt(&key, value);
        match (default, value) {
            (Value::Table(defaults), Value::Table(inner)) => {
                let read = inner_table(&key, defaults, inner, attempt, &mut warnings);
                usable.insert(key.clone(), Value::Table(read));
            }
            (Value::Array(_), Value::Array(items)) => {
                let read: Vec<Value> =
                    items.iter().filter(|item| attempt(Value::Array(vec![(*item).clone()])).is_ok()).cloned().collect();
                let unusable = items.len().saturating_sub(read.len());
                if unusable > 0 {
                    warnings
                        .push(format!("{unusable} of {} entries of \"{key}\" cannot be used – left out", items.len()));
                }
                usable.insert(key.clone(), Value::Array(read));
            }
            _ => match attempt(value.clone()) {
                Ok(()) => drop(usable.insert(key.clone(), value.clone())),
                Err(error) => warnings.push(unusable_words(&key, &error)),
            },
        }
    }
    let mut settings: Settings = usable.try_into().unwrap_or_else(|error| {
        warnings.push(unusable_words("all", &error));
        Settings::default()
    });
    settings.make_valid(&mut warnings);
    (settings, warnings)
}

/// Reads a table within the table, such as speed and data format, value by value.
fn inner_table(
    name: &str,
    defaults: Table,
    inner: &Table,
    attempt: impl Fn(Value) -> Result<(), toml::de::Error>,
    warnings: &mut Vec<String>,
) -> Table {
    let mut read = defaults.clone();
    for key in defaults.keys() {
        let Some(value) = inner.get(key) else { continue };
        let mut candidate = read.clone();
        candidate.insert(key.clone(), value.clone());
        match attempt(Value::Table(candidate.clone())) {
            Ok(()) => read = candidate,
            Err(error) => warnings.push(unusable_words(&format!("{name}.{key}"), &error)),
        }
    }
    read
}

fn attempt(key: &str, value: Value) -> Result<(), toml::de::Error> {
    let alone = Table::from_iter([(key.to_owned(), value)]);
    alone.try_into::<Settings>().map(drop)
}

fn unusable_words(name: &str, error: &toml::de::Error) -> String {
    let reason =
        error.message().replace("expected f32", "expected a number").replace("expected f64", "expected a number");
    let reason: String = reason.chars().take(REASON_LENGTH).collect();
    format!("\"{name}\" cannot be used ({reason}) – the default is used")
}

/// Every key there is, with a value of its kind.
fn schema() -> Table {
    let full = Settings { layout: Some(String::new()), ..Settings::default() };
    table_of(&full).unwrap_or_default()
}

fn table_of(settings: &Settings) -> Result<Table, toml::de::Error> {
    Table::try_from(settings).map_err(toml::de::Error::custom)
}

/// Puts into `table` what changed from `before` to `now`, everything if there is no `before`; all else stays as it is.
pub fn overlay(table: &mut Table, before: Option<&Settings>, now: &Settings) -> Result<(), toml::de::Error> {
    let before = before.map(table_of).transpose()?.unwrap_or_default();
    let now = table_of(now)?;
    let schema = schema();
    for (key, value) in &now {
        let kind = schema.get(key);
        match (table.get_mut(key), before.get(key), value, kind) {
            (_, Some(before), value, _) if before == value => {}
            (Some(Value::Table(inner)), Some(Value::Table(before)), Value::Table(value), Some(Value::Table(_))) => {
                let changed = value.iter().filter(|(key, value)| before.get(*key) != Some(*value));
                inner.extend(changed.map(|(key, value)| (key.clone(), value.clone())));
            }
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
    for key in before.keys().filter(|key| !now.contains_key(*key)) {
        table.remove(key);
    }
    table.insert(VERSION_KEY.to_owned(), Value::Integer(VERSION));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{LineChoice, RecentLine, TemperatureUnit, ThemeChoice};
    use super::*;
    use crate::protocol::{BaudRate, DataFormat, LineSettings};

    fn read_text(text: &str) -> (Settings, Vec<String>) {
        read(&text.parse().unwrap())
    }

    fn all_different() -> Settings {
        let texts = |text: &str| vec![text.to_owned(), "ö \"quoted\"\nsecond line".to_owned()];
        Settings {
            theme: ThemeChoice::Light,
            zoom: 1.3,
            temperature: TemperatureUnit::Fahrenheit,
            span: 900.0,
            strips: false,
            hidden: ["dew_point".to_owned()].into(),
            utc: true,
            trend_series: texts("0 left humidity dcon@7 COM9"),
            line: LineChoice::Port("/dev/ttyUSB0".to_owned()),
            other_port: "COM12".to_owned(),
            host: "bench:1502".to_owned(),
            line_settings: LineSettings { baud_rate: BaudRate::new(115_200).unwrap(), data_format: DataFormat::O81 },
            recent_ports: texts("COM3").iter().map(|text| text.as_str().into()).collect(),
            recent_scripts: texts("a.txt"),
            command_history: texts("$01M"),
            layout: Some("(root: Some(1),\n tiles: {\"a\": 'b'})".to_owned()),
            tab: "log".to_owned(),
            record: false,
            recording_folder: "/data/bench".to_owned(),
            recording_file_megabytes: 50,
            recording_total_megabytes: 5_000,
            recording_days: 30,
            timeout_ms: 350,
            repeats: 1,
        }
    }

    #[test]
    fn everything_reads_back_as_it_was_written() {
        for settings in [Settings::default(), all_different()] {
            let mut table = Table::new();
            overlay(&mut table, None, &settings).unwrap();
            let text = toml::to_string_pretty(&table).unwrap();
            assert_eq!(read_text(&text), (settings, Vec::new()), "{text}");
        }
    }

    #[test]
    fn one_wrong_value_does_not_lose_the_others() {
        let mut right = Table::new();
        overlay(&mut right, None, &all_different()).unwrap();
        let keys: Vec<String> = right.keys().filter(|key| *key != VERSION_KEY).cloned().collect();
        assert_eq!(keys.len(), 24);
        for wrong in keys {
            let mut table = right.clone();
            let is_switch = right[&wrong].is_bool();
            let nonsense = if is_switch { Value::Integer(5) } else { Value::Boolean(true) };
            table.insert(wrong.clone(), nonsense);
            let (read, warnings) = read(&table);
            assert_eq!(warnings.len(), 1, "{wrong}: {warnings:?}");
            assert!(warnings[0].contains(&format!("\"{wrong}\" cannot be used")), "{warnings:?}");
            let mut expected = Table::try_from(all_different()).unwrap();
            expected.remove(&wrong);
            assert_eq!(read, expected.try_into().unwrap(), "{wrong}");
        }
    }

    #[test]
    fn a_wrong_speed_leaves_the_data_format_and_a_wrong_entry_the_list() {
        let text =
            "recent_ports = ['COM3', 5, 'COM4']\n[line_settings]\nbaud_rate = 9601\ndata_format = 'e81'\nparity = 'x'";
        let (read, warnings) = read_text(text);
        assert_eq!(read.line_settings, LineSettings { baud_rate: BaudRate::B9600, data_format: DataFormat::E81 });
        assert_eq!(read.recent_ports, ["COM3", "COM4"].map(RecentLine::from));
        assert!(warnings.iter().any(|text| text.contains("line_settings.baud_rate") && text.contains("9601")));
        assert!(warnings.iter().any(|text| text.contains("1 of 3 entries of \"recent_ports\"")), "{warnings:?}");
        assert_eq!(warnings.len(), 2);
    }

    #[test]
    fn what_is_missing_has_its_default_and_what_is_unknown_is_no_mistake() {
        let (read, warnings) = read_text("temperature = 'fahrenheit'\ngone = 1\nzoom = 2\n[also.gone]\nx = 1");
        let expected = Settings { temperature: TemperatureUnit::Fahrenheit, zoom: 2.0, ..Settings::default() };
        assert_eq!((read, warnings.len()), (expected, 0));
    }

    #[test]
    fn only_what_changed_is_put_into_the_table() {
        let text = "zoom = 'big'\nfuture = [1, 2]\nlayout = 'old'\nversion = 'x'\n[line_settings]\nbaud_rate = 1200\nparity = 'x'\n[more]\ny = 1";
        let mut table: Table = text.parse().unwrap();
        let before = read(&table).0;
        let mut now = Settings { theme: ThemeChoice::Dark, layout: None, ..before.clone() };
        now.line_settings.data_format = DataFormat::N82;
        overlay(&mut table, Some(&before), &now).unwrap();
        let expected = "zoom = 'big'\nfuture = [1, 2]\ntheme = 'dark'\nversion = 1\n[line_settings]\nbaud_rate = 1200\ndata_format = 'n82'\nparity = 'x'\n[more]\ny = 1";
        assert_eq!(table, expected.parse().unwrap());
    }
}
