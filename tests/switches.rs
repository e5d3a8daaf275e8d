//! The switches of the built-in models: where their settings say that they stand.

use std::sync::Arc;

use dcon_bench::module::{Catalogue, Definition, Position, SwitchPanel, Value};
use dcon_bench::picture::switch_picture;

use Position::{Off, On, Unknown};

fn definition(model: &str) -> Arc<Definition> {
    let (catalogue, errors) = Catalogue::built_in();
    assert_eq!(errors, []);
    catalogue.get(model).expect("a definition")
}

/// Factory settings, but for those given here as a user would write them; an empty one is not known.
fn switches(model: &str, address: u8, changed: &[(&str, &str)]) -> SwitchPanel {
    let definition = definition(model);
    let known = |id: &str| -> Option<Value> {
        let item = definition.item(id)?;
        match changed.iter().find(|(changed, _)| *changed == id) {
            Some((_, "")) => None,
            Some((_, text)) if item.read_only => Some(Value::Bool(*text == "true")),
            Some((_, text)) => Some(item.parse(text).expect("a value that the item takes")),
            None => item.factory.clone(),
        }
    };
    definition.switches(address, &known)
}

/// `^` is ON, `v` is OFF, `?` is unknown.
fn drawn(panel: &SwitchPanel) -> Vec<String> {
    let mark = |position| match position {
        On => '^',
        Off => 'v',
        Unknown => '?',
    };
    panel.banks.iter().map(|bank| bank.positions.iter().map(|state| mark(state.position)).collect()).collect()
}

/// Numbers of the switches of a bank that are in force.
fn in_force(panel: &SwitchPanel, bank: usize) -> Vec<u8> {
    panel.banks[bank].positions.iter().filter(|state| state.in_force).map(|state| state.number).collect()
}

#[test]
fn a_pir_234_from_the_factory_has_its_sensors_on_and_everything_else_off() {
    let panel = switches("pir-234", 160, &[("init_mode", "false")]);
    assert_eq!(drawn(&panel), ["^^^^", "v?vvvvvvvv"]);
    assert_eq!(panel.rotary.as_ref().expect("a dial").position, Some(0));
    assert_eq!(panel.notes.len(), 1, "{:?}", panel.notes);
    assert!(panel.notes[0].contains("DIP 2 is not told by the settings: Address 160 can come from the switches"));
    assert_eq!(in_force(&panel, 1).len(), 10);
}

#[test]
fn at_address_1_dip_2_is_on_and_the_others_do_not_count() {
    let panel = switches("pir-234", 1, &[("init_mode", "true")]);
    assert_eq!(drawn(&panel), ["^^^^", "v^?^vvvvvv"]);
    assert_eq!(in_force(&panel, 0), [0; 0]);
    assert_eq!(in_force(&panel, 1), [2, 4]);
    let rotary = panel.rotary.as_ref().expect("a dial");
    assert_eq!((rotary.position, rotary.in_force), (None, false));
    assert!(panel.notes[0].starts_with("Address 1 cannot come from the switches, so DIP 2 is ON."));
}

#[test]
fn the_ends_of_the_switches_addresses_are_160_and_191() {
    for (address, told, range, rotary) in [
        (0, On, Unknown, None),
        (159, On, Unknown, None),
        (160, Unknown, Off, Some(0)),
        (175, Unknown, Off, Some(15)),
        (176, Unknown, On, Some(0)),
        (191, Unknown, On, Some(15)),
        (192, On, Unknown, None),
        (255, On, Unknown, None),
    ] {
        for model in ["pir-130", "pir-230", "pir-234"] {
            let panel = switches(model, address, &[]);
            let bank = panel.banks.last().expect("a bank");
            assert_eq!((bank.positions[1].position, bank.positions[2].position), (told, range), "{model} {address}");
            assert_eq!(panel.rotary.expect("a dial").position, rotary, "{model} {address}");
        }
    }
}

#[test]
fn each_pair_of_output_sources_has_the_row_of_the_manual() {
    // PIR-234 manual 2.5, DIP 5 to 7.
    for (dips, do0, do1) in [
        ("vvv", "pir", "pir"),
        ("^vv", "pir", "temperature"),
        ("v^v", "temperature", "pir"),
        ("^^v", "temperature", "temperature"),
        ("vv^", "pir", "command"),
        ("^v^", "temperature", "command"),
        ("v^^", "command", "pir"),
        ("^^^", "command", "command"),
    ] {
        let panel = switches("pir-234", 178, &[("do0_source", do0), ("do1_source", do1)]);
        assert_eq!(&drawn(&panel)[1][4..7], dips, "{do0} {do1}");
        assert_eq!(panel.rotary.as_ref().expect("a dial").position, Some(2));
        assert_eq!(panel.notes.len(), 1, "{:?}", panel.notes);
    }
    // The one pair that no row gives.
    let panel = switches("pir-234", 178, &[("do0_source", "command"), ("do1_source", "temperature")]);
    assert_eq!(&drawn(&panel)[1][4..7], "???");
    let note = "No position of DIP 5 to 7 gives DO0 trigger source = Command and DO1 trigger source = Temperature. \
                DIP 2 is probably ON.";
    assert_eq!(panel.notes[1], note);
}

#[test]
fn one_known_output_source_tells_the_switches_that_all_its_rows_share() {
    let panel = switches("pir-234", 160, &[("do0_source", "command"), ("do1_source", "")]);
    assert_eq!(&drawn(&panel)[1][4..7], "?^^");
    assert!(panel.banks[1].positions[4].explanation.contains("because DO1 trigger source is not known"));
}

#[test]
fn on_times_and_sensors_follow_the_manual_on_both_models() {
    // PIR-130 manual 1.5 and PIR-234 manual 2.5, DIP 8 to 10.
    for (dips, seconds) in [
        ("vvv", "6"),
        ("vv^", "16"),
        ("v^v", "33"),
        ("v^^", "66"),
        ("^vv", "131"),
        ("^v^", "262"),
        ("^^v", "524"),
        ("^^^", "1049"),
        ("???", "2"),
    ] {
        for model in ["pir-130", "pir-234"] {
            let panel = switches(model, 165, &[("pir_on_time", seconds)]);
            assert_eq!(&drawn(&panel).last().expect("a bank")[7..], dips, "{model} {seconds}");
        }
    }
    let panel = switches("pir-234", 165, &[("pir2_enabled", "false"), ("pir4_enabled", "")]);
    assert_eq!(drawn(&panel)[0], "^v^?");
}

#[test]
fn a_pir_130_tells_lux_level_and_the_ends_of_its_sensitivity() {
    for (sensitivity, lux, dips) in [
        ("0", "disabled", "vvv"),
        ("9", "200", "^^^"),
        // Which numbers the two steps between have is not in the manual.
        ("1", "200", "^??"),
        ("5", "1000", "???"),
        ("", "disabled", "v??"),
    ] {
        let panel = switches("pir-130", 176, &[("sensitivity", sensitivity), ("lux_level", lux)]);
        assert_eq!(&drawn(&panel)[0][4..7], dips, "{sensitivity} {lux}");
        // The PIR-130 has no way to ask for INIT mode.
        assert_eq!(&drawn(&panel)[0][3..4], "?");
    }
}

#[test]
fn the_pir_230_has_the_switches_of_the_pir_234() {
    assert_eq!(definition("pir-230").switch_layout, definition("pir-234").switch_layout);
    assert_eq!(switches("pir-230", 160, &[]), switches("pir-234", 160, &[]));
}

#[test]
fn the_factory_rows_are_those_of_the_factory_settings() {
    for model in ["pir-130", "pir-234"] {
        let definition = definition(model);
        for group in definition.switch_layout.banks.iter().flat_map(|bank| &bank.groups) {
            let factory: Vec<_> = group.rows.iter().filter(|row| row.factory).collect();
            assert_eq!(factory.len(), 1, "{model} {}", group.label);
        }
        let panel = switches(model, 160, &[]);
        for state in panel.banks.iter().flat_map(|bank| &bank.positions) {
            let factory = format!("{}: ", if state.position == On { "ON" } else { "OFF" });
            let mut lines = state.explanation.lines();
            let told = state.position != Unknown;
            let own = lines.find(|line| line.starts_with(&factory) && line.ends_with("(factory setting)"));
            assert!(!told || own.is_some(), "{model} {}\n{}", state.title, state.explanation);
        }
    }
}

#[test]
fn every_position_explains_on_and_off_and_can_be_pointed_at_in_the_picture() {
    for (model, address, count) in [("pir-130", 186, 11), ("pir-230", 1, 15), ("pir-234", 1, 15), ("pir-234", 163, 15)]
    {
        let panel = switches(model, address, &[]);
        for state in panel.banks.iter().flat_map(|bank| &bank.positions) {
            let says = |word: &str| state.explanation.lines().any(|line| line.starts_with(word));
            assert!(says("ON") && says("OFF"), "{}\n{}", state.title, state.explanation);
        }
        let picture = switch_picture(&panel);
        assert_eq!(picture.hot.len(), count, "{model}");
        assert!(picture.size[0] <= 430.0 && picture.size[1] <= 150.0, "{:?}", picture.size);
    }
}

fn refused(text: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("ours.toml"), text).expect("a file");
    let (catalogue, errors) = Catalogue::with_folder(folder.path());
    assert!(catalogue.get("pir-234").is_some());
    errors.iter().map(ToString::to_string).collect()
}

const OURS: &str = r#"id = "ours"
label = "Ours"
based_on = "pir-234"
[identity]
dcon = ["OURS"]
[rotary]
label = "Dial"
help = "The address."
item = "address"
first = [32]
[[dip]]
id = "pir"
label = "Sensors"
name = "S"
positions = 1
[[dip.group]]
positions = "1"
label = "All"
help = "All sensors."
rows = [
    { set = "on", means = "enabled", when = { pir1_enabled = true } },
    { set = "off", means = "disabled", when = { pir1_enabled = false } },
]
"#;

#[test]
fn a_users_file_replaces_a_bank_and_the_dial_of_the_model_it_is_based_on() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("ours.toml"), OURS).expect("a file");
    let (catalogue, errors) = Catalogue::with_folder(folder.path());
    assert_eq!(errors, []);
    let panel = catalogue.get("ours").expect("ours").switches(35u8, &|_| None);
    let sizes: Vec<_> = panel.banks.iter().map(|bank| (bank.label.as_str(), bank.positions.len())).collect();
    assert_eq!(sizes, [("Sensors", 1), ("Configuration", 10)]);
    assert_eq!(panel.rotary.expect("a dial").position, Some(3));
}

#[test]
fn a_users_item_with_other_values_no_longer_tells_the_inherited_switches() {
    let text = r#"id = "ours"
label = "Ours"
based_on = "pir-130"
[identity]
dcon = ["OURS"]
[[parameter]]
id = "lux_level"
label = "Light"
help = "Changed."
tab = "pir"
type = "number"
range = [0, 4]
modbus = [{ register = 514 }]
"#;
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("ours.toml"), text).expect("a file");
    let (catalogue, errors) = Catalogue::with_folder(folder.path());
    assert_eq!(errors, []);
    let ours = catalogue.get("ours").expect("ours");
    let panel = ours.switches(1u8, &|id| ours.item(id)?.parse("2").ok());
    assert_eq!(panel.banks[0].positions[4].position, Unknown);
    assert!(panel.banks[0].positions[4].explanation.contains("No setting that can be read tells its position."));
}

#[test]
fn faulty_switches_in_a_users_file_are_refused_with_the_line_of_their_entry() {
    for (from, to, line, reason) in [
        ("pir1_enabled = true", "pir9_enabled = true", "line 12", "\"pir9_enabled\""),
        ("first = [32]", "first = [250]", "line 7", "address cannot be 250 to 265"),
        ("positions = 1", "positions = \"1\"", "line 15", "string"),
        ("means = \"enabled\"", "meaning = \"enabled\"", "line 21", "meaning"),
    ] {
        let errors = refused(&OURS.replacen(from, to, 1));
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert!(errors[0].contains(line) && errors[0].contains(reason), "{}", errors[0]);
    }
}
