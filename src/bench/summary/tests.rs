use std::sync::Arc;

use super::*;
use crate::bench::Reading;
use crate::module::{Catalogue, Definition, Identified};
use crate::protocol::{Failure, LineSettings};

/// 2 March 2026, 09:30 UTC.
fn now() -> Timestamp {
    Timestamp::from_second(1_772_443_800).unwrap()
}

fn definition(model: &str) -> Arc<Definition> {
    Catalogue::built_in().0.get(model).unwrap()
}

fn module_of(definition: Arc<Definition>, address: u8, protocol: Protocol) -> Module {
    let target = Target { address, protocol, settings: LineSettings::default(), checksum: false };
    let identified = Identified {
        name: "PIR & <234>".to_owned(),
        firmware: "B2.8".to_owned(),
        said: String::new(),
        definition: Some(definition),
    };
    Module::new(crate::bus::RequestId(0), target, identified, now())
}

fn hold(module: &mut Module, id: &str, text: &str) {
    let item = module.item(id).unwrap();
    let value = item.parse_any(text).unwrap_or_else(|| panic!("{id} cannot be {text}"));
    let at = now() - std::time::Duration::from_secs(4);
    module.readings.insert(id.to_owned(), Reading { value: Some(value), at: Some(at), ..Reading::default() });
}

/// A PIR-234 at address 1 with some values, one of them not the factory's and one that cannot be read.
fn pir_234() -> Module {
    let mut module = module_of(definition("pir-234"), 1, Protocol::ModbusRtu);
    let values = [
        ("address", "1"),
        ("pir_on_time", "33"),
        ("pir1_enabled", "true"),
        ("pir2_enabled", "false"),
        ("pir1", "true"),
        ("temperature_c", "24.99"),
    ];
    values.into_iter().for_each(|(id, text)| hold(&mut module, id, text));
    let refused = Reading { problem: Some(Failure::Exception { code: 2 }), ..Reading::default() };
    module.readings.insert("alarm_limit".to_owned(), refused);
    module
}

fn summary() -> Summary {
    Summary::of(&pir_234(), now())
}

fn entry<'a>(summary: &'a Summary, id: &str) -> &'a Entry {
    summary.entries().find(|entry| entry.id == id).unwrap_or_else(|| panic!("no {id}"))
}

#[test]
fn what_is_not_the_factory_setting_is_marked_and_what_is_not_known_is_not() {
    let summary = summary();
    assert!(!entry(&summary, "address").differs);
    let on_time = entry(&summary, "pir_on_time");
    assert_eq!((on_time.text.as_str(), on_time.factory_text.as_str(), on_time.differs), ("33", "6", true));
    assert!(entry(&summary, "pir2_enabled").differs);
    assert!(!entry(&summary, "pir3_enabled").differs);
    assert_eq!(summary.differing(), 2);
    assert_eq!(summary.comparison(), "2 settings differ from factory (4 compared)");
}

#[test]
fn a_value_that_is_missing_is_a_dash_with_the_reason() {
    let summary = summary();
    for (id, reason) in [
        ("alarm_limit", "exception 2"),
        ("pir3_enabled", "not read yet"),
        ("reset_status", "not read: reading changes it"),
    ] {
        let entry = entry(&summary, id);
        assert_eq!((entry.text.as_str(), &entry.value), (UNKNOWN, &None), "{id}");
        assert!(entry.problem.as_deref().is_some_and(|problem| problem.starts_with(reason)), "{entry:?}");
    }
    assert_eq!(entry(&summary, "address").problem, None);
}

#[test]
fn a_secret_is_left_out_of_every_report() {
    let mut module = module_of(definition("pir-234"), 1, Protocol::ModbusTcp);
    module.parts = Some(vec!["wifi".to_owned()]);
    hold(&mut module, "wifi_wpa_password", "hush-hush");
    let summary = Summary::of(&module, now());
    assert_eq!(entry(&summary, "wifi_wpa_password").problem.as_deref(), Some("secret, so it is left out"));
    for report in [summary.to_text(), summary.to_html(), summary.to_json().unwrap()] {
        assert!(!report.contains("hush-hush"));
    }
}

#[test]
fn a_word_among_numbers_has_no_unit() {
    let mut module = module_of(definition("pir-130"), 1, Protocol::Dcon);
    hold(&mut module, "lux_level", "disabled");
    let word = Summary::of(&module, now());
    assert_eq!(entry(&word, "lux_level").unit, "");
    hold(&mut module, "lux_level", "500");
    assert_eq!(entry(&Summary::of(&module, now()), "lux_level").unit, "lux");
}

#[test]
fn groups_are_the_tabs_and_have_only_what_the_protocol_offers() {
    let labels = |model: &str, protocol: Protocol| -> Vec<String> {
        let summary = Summary::of(&module_of(definition(model), 1, protocol), now());
        summary.groups.iter().map(|group| group.label.clone()).collect()
    };
    assert_eq!(labels("pir-130", Protocol::Dcon), ["Configuration", "AI", "PIR / Relay"]);
    assert_eq!(labels("pir-234", Protocol::ModbusRtu), ["Configuration", "AI", "PIR / Relay", "Host WDT"]);
    assert!(labels("pir-234", Protocol::ModbusTcp).contains(&"Network".to_owned()));
    let dcon = Summary::of(&module_of(definition("pir-234"), 1, Protocol::Dcon), now());
    assert!(dcon.entries().any(|entry| entry.id == "checksum"));
    assert!(summary().entries().all(|entry| entry.id != "checksum"));
}

#[test]
fn the_pictures_show_switches_and_zones() {
    let summary = summary();
    let states: Vec<_> = summary.zones.iter().map(|zone| zone.state.word()).collect();
    assert_eq!(states, ["motion", "off", "–", "–"]);
    assert!(summary.switch_picture().is_some() && summary.face_picture().is_some());
    let one = Summary::of(&module_of(definition("pir-130"), 160, Protocol::Dcon), now());
    assert_eq!(one.zones.len(), 1);
    let none = Summary::of(&module_of(definition("dl-302"), 1, Protocol::ModbusRtu), now());
    assert!(none.face_picture().is_none());
}

#[test]
fn text_has_aligned_columns_and_a_mark_at_what_differs() {
    let text = text::text(&summary(), &TimeZone::UTC);
    let line = |start: &str| {
        let found = text.lines().find(|line| line.trim_start_matches(['*', ' ']).starts_with(start));
        found.unwrap_or_else(|| panic!("no {start} in\n{text}"))
    };
    assert!(text.starts_with("PIR-234 at address 1 (01h)\n==========================\n"), "{text}");
    assert_eq!(line("Drawn up").trim_start_matches("Drawn up").trim(), "2026-03-02 09:30:00 +00:00");
    let on_time = pir_234().item("pir_on_time").unwrap().label.clone();
    let row = line(&on_time);
    assert!(row.starts_with("* ") && row.ends_with("09:29:56  differs from factory"), "{row}");
    let column = |line: &str, text: &str| line.find(text).map(|at| line[..at].chars().count());
    let head = line("PIR / Relay");
    assert_eq!(column(row, "33"), column(head, "Value"), "{text}");
    assert_eq!(column(row, "6  "), column(head, "Factory"), "{text}");
    assert_eq!(column(row, "09:29:56"), column(head, "Read"), "{text}");
    assert!(line("DIP 1 ").contains("Protocol") || text.contains("DIP 1"), "{text}");
    assert!(text.lines().all(|line| !line.ends_with(' ')));
}

/// Names of the elements that are open at the end; text between them may not hold `<`.
fn open_elements(html: &str) -> Vec<&str> {
    let mut open = Vec::new();
    for tag in html.split('<').skip(1).map(|rest| rest.split('>').next().unwrap()) {
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "<{tag}>");
        } else if !tag.ends_with('/') && !tag.starts_with('!') && !["meta", "col", "br"].contains(&name) {
            open.push(name);
        }
    }
    open
}

#[test]
fn html_is_whole_escaped_and_needs_nothing_from_elsewhere() {
    let html = html::html(&summary(), &TimeZone::UTC);
    assert_eq!(open_elements(&html), Vec::<&str>::new());
    assert_eq!(html.matches("<svg").count(), 2);
    assert!(html.contains("PIR &amp; &lt;234&gt;") && !html.contains("<234>"));
    for outside in ["http", "<link", "<script", "src=", "url(", "@import"] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert_eq!(html.matches("<tr class=\"differs\">").count(), 2);
    assert!(html.contains("prefers-color-scheme: dark") && html.contains("@page"));
    for entry in summary().entries() {
        assert!(html.contains(&format!("<td>{}</td>", crate::picture::escaped(&entry.label))), "{}", entry.label);
    }
}

#[test]
fn json_agrees_with_what_the_module_said() {
    let summary = summary();
    let json: serde_json::Value = serde_json::from_str(&summary.to_json().unwrap()).unwrap();
    assert_eq!(json["module"]["address"], 1);
    assert_eq!(json["module"]["protocol"], "modbus_rtu");
    assert_eq!(json["module"]["model"], "pir-234");
    assert_eq!(json["settings"]["pir_on_time"], 33);
    assert_eq!(json["settings"]["pir2_enabled"], false);
    assert_eq!(json["readings"]["temperature_c"], 24.99);
    assert_eq!(json["settings"]["alarm_limit"], serde_json::Value::Null);
    assert!(json["problems"]["alarm_limit"].as_str().unwrap().starts_with("exception 2"));
    assert_eq!(json["times"]["pir_on_time"], "2026-03-02T09:29:56Z");
    assert_eq!(json["factory"]["pir_on_time"], 6);
    let differs: Vec<_> = json["differs_from_factory"].as_array().unwrap().iter().collect();
    assert!(differs.len() == 2 && differs.contains(&&serde_json::json!("pir_on_time")), "{differs:?}");
    for entry in summary.entries() {
        let places = [(entry.is_setting, "settings"), (entry.is_reading, "readings")];
        for (there, place) in places {
            assert_eq!(json[place].get(&entry.id).is_some(), there, "{} in {place}", entry.id);
            if there {
                assert_eq!(json[place][&entry.id], serde_json::to_value(&entry.value).unwrap(), "{}", entry.id);
            }
        }
    }
}

#[test]
fn a_summary_is_plain_data() {
    let value = serde_json::to_value(summary()).unwrap();
    assert_eq!(value["groups"][0]["entries"][0]["id"], "name");
    assert_eq!(value["target"]["baud_rate"], 9600);
}
