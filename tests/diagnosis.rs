//! `diagnose` as a user and a script see it.

#[path = "common/program.rs"]
mod program;

use std::io::Read;

use program::{bad, bench, demo, good, object, text};
use serde_json::json;
use tempfile::TempDir;

#[test]
fn a_healthy_module_is_told_to_be_fine() {
    let told = good(&demo("diagnose --address 1 --reads 12"));
    for part in [
        "PIR-234 at address 1 (01h), Modbus RTU 9600 N81",
        "consistent – 12 of 12 reads answered, all the same",
        "median",
        "█",
        "ms suggested: 99 of 100 answers began within",
        "Nothing is wrong.",
    ] {
        assert!(told.contains(part), "{part}\n{told}");
    }
}

#[test]
fn the_report_is_one_object_for_programs() {
    let report = object(&demo("diagnose --address 1 --address 163:dcon --reads 5 --json"));
    let modules = report["modules"].as_array().unwrap();
    assert_eq!(modules.len(), 2, "{report}");
    assert_eq!((&modules[0]["address"], &modules[0]["name"]), (&json!(1), &json!("PIR-234")));
    assert_eq!((&modules[1]["protocol"], &modules[1]["consistency"]["judgement"]), (&json!("dcon"), &json!("fine")));
    assert!(modules[0]["answer_time"]["median_ms"].as_f64().unwrap() > 0.0);
    assert_eq!(report["line"]["silent_addresses"], 0);
}

#[test]
fn an_address_where_nobody_is_ends_with_1_and_the_next_step() {
    let output = bench(&demo("diagnose --address 77 --reads 5"));
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(told.contains("Nothing at this address – address 77 (4Dh) was asked"), "{told}");
    assert!(told.contains("quick scan, which asks at 1 and at 160 to 191"), "{told}");
}

#[test]
fn answers_that_a_repeater_doubles_are_told_as_such() {
    let output = bench(&demo("diagnose --address 1 --reads 30 --fault doubled=100%"));
    let told = text(&output.stdout);
    assert!(told.contains("answers come twice – 30 of 30 reads answered, all the same;"), "{told}");
    assert!(!told.contains("Line noise"), "{told}");
}

#[test]
fn a_port_that_is_not_there_is_a_finding() {
    let output = bench(&["diagnose", "--port", "/dev/no-such-port", "--address", "1", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["line"]["findings"][0]["symptom"], "port_vanished", "{report}");
}

#[test]
fn without_an_address_modules_are_looked_for_first() {
    let report = object(&demo("diagnose --reads 5 --json"));
    let addresses: Vec<_> = report["modules"].as_array().unwrap().iter().map(|module| &module["address"]).collect();
    assert_eq!(addresses, [&json!(1), &json!(160), &json!(163)], "{report}");
    assert!(report["line"]["silent_addresses"].as_u64().unwrap() > 20, "a scan's silence is told apart: {report}");
    assert_eq!(report["line"]["failed"], 0);
}

#[test]
fn a_bundle_holds_what_others_need_to_help() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("help.zip");
    good(&demo(&format!("diagnose --address 1 --reads 5 --bundle {}", path.display())));
    let mut zip = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
    let mut read = |name: &str| {
        let mut text = String::new();
        zip.by_name(name).unwrap_or_else(|_| panic!("{name}")).read_to_string(&mut text).unwrap();
        text
    };
    assert!(read("README.txt").contains("Wi-Fi"));
    assert!(read("report.txt").contains("Nothing is wrong."));
    assert!(read("traffic.csv").lines().count() > 10);
    assert!(read("versions.txt").starts_with("dcon-bench "));
    read("ports.json");
    let lines = read("traffic.csv").lines().count();
    let capture = zip.by_name("traffic.pcapng").unwrap();
    let frames = dcon_bench::capture::read(capture).unwrap().collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!(frames.len() + 1, lines, "the same frames in both, and the names of the columns");
}

#[test]
fn wrong_usage_ends_with_2() {
    for words in ["diagnose --reads 4", "diagnose --address 300", "diagnose --address 0:modbus_rtu"] {
        bad(2, &demo(words));
    }
}
