//! Module definitions: the public vocabulary is complete, and users' files add, override and fail as documented.

use std::collections::BTreeSet;
use std::path::PathBuf;

use dcon_bench::module::{Addition, Catalogue, Kind, Standing};
use dcon_bench::protocol::Protocol;

/// The public names of both models' parameters and readings, by protocol.
const COMMON: &[&str] = &[
    "name",
    "firmware",
    "address",
    "baud_rate",
    "data_format",
    "protocol",
    "response_delay",
    "reset_status",
    "pir_on_time",
    "alarm_mode",
    "alarm_limit",
    "alarm_active",
    "pir_active_delay",
    "buzzer_on_pir",
    "pir",
];
const COMMON_DCON_ONLY: &[&str] = &["checksum", "output_active_state"];
const PIR_130: &[&str] = &["lux_level", "sensitivity", "relay"];
const PIR_234: &[&str] = &[
    "pir1_enabled",
    "pir2_enabled",
    "pir3_enabled",
    "pir4_enabled",
    "pir_off_time_on_start",
    "do0_source",
    "do1_source",
    "do0",
    "do1",
    "do0_power_on",
    "do1_power_on",
    "do0_safe",
    "do1_safe",
    "temperature_offset",
    "humidity_offset",
    "wdt_enabled",
    "wdt_timeout",
    "wdt_tripped",
    "temperature_c",
    "temperature_f",
    "humidity",
    "dew_point_c",
    "dew_point_f",
    "temperature_c_high",
    "temperature_f_high",
    "humidity_high",
    "dew_point_c_high",
    "dew_point_f_high",
    "temperature_c_low",
    "temperature_f_low",
    "humidity_low",
    "dew_point_c_low",
    "dew_point_f_low",
];
const PIR_234_RTU_ONLY: &[&str] = &["wdt_timeout_count"];
const PIR_234_MODBUS_ONLY: &[&str] = &["pir1", "pir2", "pir3", "pir4", "buzzer"];
const PIR_234_TCP_ONLY: &[&str] = &[
    "net_id",
    "reset_cause",
    "ethernet_wdt_timeout",
    "ethernet_wdt_count",
    "tcp_idle_timeout",
    "module_reset_timeout",
];

fn offered(model: &str, protocol: Protocol) -> BTreeSet<String> {
    let definition = Catalogue::built_in().0.get(model).expect("a definition");
    definition.items_over(protocol).map(|item| item.id.clone()).collect()
}

fn missing(model: &str, protocol: Protocol, lists: &[&[&str]]) -> Vec<String> {
    let offered = offered(model, protocol);
    lists.iter().flat_map(|list| list.iter()).filter(|id| !offered.contains(**id)).map(|id| (*id).to_owned()).collect()
}

#[test]
fn every_public_name_is_offered_over_the_protocols_that_have_it() {
    let none: Vec<String> = Vec::new();
    assert_eq!(missing("pir-130", Protocol::Dcon, &[COMMON, COMMON_DCON_ONLY, PIR_130]), none);
    assert_eq!(missing("pir-234", Protocol::Dcon, &[COMMON, COMMON_DCON_ONLY, PIR_234, &["init_mode"]]), none);
    assert_eq!(
        missing("pir-234", Protocol::ModbusRtu, &[COMMON, PIR_234, PIR_234_RTU_ONLY, PIR_234_MODBUS_ONLY]),
        none
    );
    assert_eq!(missing("pir-234", Protocol::ModbusTcp, &[PIR_234_MODBUS_ONLY, PIR_234_TCP_ONLY]), none);
    // The PIR-130's Modbus has no register for the PIR itself.
    let of_130 = missing("pir-130", Protocol::ModbusRtu, &[COMMON, PIR_130, &["temperature_c"]]);
    assert_eq!(of_130, ["pir"]);
}

#[test]
fn what_a_protocol_does_not_have_is_not_offered_over_it() {
    for (model, protocol, absent) in [
        ("pir-234", Protocol::ModbusRtu, "checksum"),
        ("pir-234", Protocol::Dcon, "wdt_timeout_count"),
        ("pir-234", Protocol::Dcon, "net_id"),
        ("pir-234", Protocol::ModbusTcp, "baud_rate"),
        ("pir-234", Protocol::ModbusRtu, "lux_level"),
        ("pir-130", Protocol::ModbusTcp, "no_such_name"),
    ] {
        assert!(!offered(model, protocol).contains(absent), "{model} {protocol} {absent}");
    }
}

#[test]
fn ranges_and_choices_are_those_of_the_manuals() {
    let definition = Catalogue::built_in().0.get("pir-234").expect("a definition");
    for (id, allowed) in [
        ("response_delay", "0 to 30 ms"),
        ("pir_active_delay", "0 to 3000 ms"),
        ("pir_off_time_on_start", "0 to 30 s"),
        ("wdt_timeout", "0.1 to 25.5 s, with at most one decimal"),
        ("temperature_offset", "-100.00 to 100.00 °C, with at most 2 decimals"),
        ("alarm_limit", "0.00 to 999.99 °C, with at most 2 decimals"),
        ("baud_rate", "1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200 bps"),
        ("pir_on_time", "2, 4, 6, 8, 16, 33, 49, 66, 131, 262, 393, 524, 1049, 2097, 3146, 4194 s"),
        ("tcp_idle_timeout", "0 or 5 to 65535 s"),
    ] {
        assert_eq!(definition.item(id).expect("an item").allowed(), allowed, "{id}");
    }
}

#[test]
fn the_pir_230_is_the_pir_234_with_an_identity_of_its_own() {
    let (catalogue, errors) = Catalogue::built_in();
    assert_eq!(errors, []);
    let (parent, child) = (catalogue.get("pir-234").expect("one"), catalogue.get("pir-230").expect("other"));
    assert_eq!(parent.items.len(), child.items.len());
    assert_ne!(parent.identity, child.identity);
}

fn with_user_file(name: &str, text: &str) -> (Catalogue, Vec<String>) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join(name), text).expect("a file");
    let (catalogue, errors) = Catalogue::with_folder(folder.path());
    (catalogue, errors.iter().map(ToString::to_string).collect())
}

const SMALL: &str = r##"
id = "tm-1"
label = "TM-1"
manual = "none"

[[command]]
id = "temperature"
title = "Temperature"
read = "#AA0"
answer = [">(Data)"]
fields = { Data = "decimal" }

[[reading]]
id = "temperature_c"
label = "Temperature"
help = "What it measures."
unit = "°C"
tab = "ai"
type = "number"
range = [-40, 120]
decimals = 2
live = true
dcon = [{ command = "temperature", field = "Data" }]
"##;

#[test]
fn a_users_file_adds_a_model() {
    let (catalogue, errors) = with_user_file("tm-1.toml", SMALL);
    assert_eq!(errors, [""; 0]);
    let definition = catalogue.get("tm-1").expect("the new model");
    assert!(matches!(definition.item("temperature_c").expect("an item").kind, Kind::Number { .. }));
    assert!(catalogue.get("pir-234").is_some());
}

#[test]
fn a_users_file_overrides_one_item_of_a_built_in_model() {
    let text = r#"
id = "pir-130"
label = "PIR-130 of ours"
manual = "ours"
based_on = "pir-130"

[[parameter]]
id = "lux_level"
label = "Light"
help = "Changed."
tab = "pir"
type = "number"
range = [0, 4]
modbus = [{ register = 514 }]
"#;
    let (catalogue, errors) = with_user_file("ours.toml", text);
    assert_eq!(errors, [""; 0]);
    let definition = catalogue.get("pir-130").expect("a definition");
    assert_eq!(definition.label, "PIR-130 of ours");
    assert_eq!(definition.item("lux_level").expect("an item").label, "Light");
    assert!(definition.item("sensitivity").is_some());
}

#[test]
fn a_faulty_file_is_named_with_line_and_reason_and_the_others_load() {
    let cases = [
        (SMALL.replace("label = \"TM-1\"", "label = 7"), "line 3", "string"),
        (SMALL.replace("live = true", "life = true"), "line 22", "life"),
        (SMALL.replace("command = \"temperature\", field", "command = \"heat\", field"), "line 14", "\"heat\""),
        (SMALL.replace("range = [-40, 120]", ""), "line 14", "range"),
        (SMALL.replace("[\">(Data)\"]", "[\">(Data)x\"]"), "line 7", "has to be the end"),
        (SMALL.replace("read = \"#AA0\"", "read = \"AA0\""), "line 7", "must start with"),
        (format!("based_on = \"nothing\"\n{SMALL}"), "line 3", "\"nothing\""),
    ];
    for (text, line, reason) in cases {
        let (catalogue, errors) = with_user_file("broken.toml", &text);
        assert_eq!(errors.len(), 1, "{reason}: {errors:?}");
        let error = &errors[0];
        assert!(error.contains("broken.toml") && error.contains(line) && error.contains(reason), "{error}");
        assert!(catalogue.get("tm-1").is_none());
        assert!(catalogue.get("pir-130").is_some() && catalogue.get("pir-234").is_some());
    }
}

/// A folder for definitions, and a file beside it.
fn folder_and_file(name: &str, text: &str) -> (tempfile::TempDir, PathBuf, PathBuf) {
    let root = tempfile::tempdir().expect("a folder");
    let (folder, path) = (root.path().join("modules"), root.path().join(name));
    std::fs::create_dir(&folder).expect("a folder");
    std::fs::write(&path, text).expect("a file");
    (root, folder, path)
}

#[test]
fn a_definition_is_judged_before_it_is_added_and_its_place_is_named_by_its_id() {
    let (_root, folder, path) = folder_and_file("module.toml", &SMALL.replace("number", "nonsense"));
    assert!(Addition::judge(&folder, &path).expect_err("it is faulty").to_string().contains("line"));
    std::fs::write(&path, SMALL).expect("a file");
    let addition = Addition::judge(&folder, &path).expect("it is good");
    assert_eq!((addition.id.as_str(), addition.standing), ("tm-1", Standing::Nothing));
    assert_eq!(addition.place, folder.join("tm-1.toml"));
    assert_eq!(addition.text, SMALL);
}

#[test]
fn a_definition_that_is_there_already_is_the_same_or_another_one_whatever_its_file_is_called() {
    let (_root, folder, path) = folder_and_file("module.toml", SMALL);
    std::fs::write(folder.join("mine.toml"), SMALL).expect("a file");
    let addition = Addition::judge(&folder, &path).expect("it is good");
    assert_eq!((addition.place, addition.standing), (folder.join("mine.toml"), Standing::Same));
    std::fs::write(&path, SMALL.replace("label = \"TM-1\"", "label = \"TM-1 new\"")).expect("a file");
    let addition = Addition::judge(&folder, &path).expect("it is good");
    assert_eq!((addition.place, addition.standing), (folder.join("mine.toml"), Standing::Other));
}

#[test]
fn a_place_where_another_model_stands_is_not_taken() {
    let (_root, folder, path) = folder_and_file("module.toml", SMALL);
    std::fs::write(folder.join("tm-1.toml"), SMALL.replace("id = \"tm-1\"", "id = \"tm-2\"")).expect("a file");
    let told = Addition::judge(&folder, &path).expect_err("it is taken").to_string();
    assert!(told.contains("tm-1.toml: it defines another model, tm-2 – rename it"), "{told}");
}

#[test]
fn a_definition_may_be_based_on_one_of_the_users_own() {
    let text = "id = \"tm-2\"\nlabel = \"TM-2\"\nbased_on = \"tm-1\"\nidentity = { dcon = [\"TM2\"] }\n";
    let (_root, folder, path) = folder_and_file("tm-2.toml", text);
    let told = Addition::judge(&folder, &path).expect_err("its base is missing").to_string();
    assert!(told.contains("\"tm-1\", which is not there"), "{told}");
    std::fs::write(folder.join("tm-1.toml"), SMALL).expect("a file");
    assert_eq!(Addition::judge(&folder, &path).expect("it is good").id, "tm-2");
}

#[test]
fn a_model_that_says_the_same_of_itself_as_another_is_pointed_out() {
    let (_, errors) = with_user_file("twin.toml", "id = \"twin\"\nlabel = \"Twin\"\nbased_on = \"pir-234\"\n");
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(errors[0].contains("twin.toml") && errors[0].contains("pir-234"), "{}", errors[0]);
}

#[test]
fn every_item_and_action_of_the_pir_modules_is_explained() {
    let (catalogue, _) = Catalogue::built_in();
    for model in ["pir-130", "pir-230", "pir-234"] {
        let definition = catalogue.get(model).unwrap();
        let items = definition.items.iter().map(|item| (&item.id, &item.label, &item.help, &item.source));
        let actions = definition.actions.iter().map(|action| (&action.id, &action.label, &action.help, &action.source));
        for (id, label, help, source) in items.chain(actions) {
            assert!(help.len() > label.len() + 5 && help.ends_with('.'), "{model} {id}: \"{help}\"");
            assert!(!source.trim().is_empty(), "{model} {id} names no section of the manual");
        }
        for item in &definition.items {
            assert!(!item.accesses.is_empty() && !item.allowed().is_empty(), "{model} {}", item.id);
        }
    }
}
