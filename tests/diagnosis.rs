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
        "200 ms in use, which is ample; it could be lowered to",
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
fn a_port_that_takes_no_bytes_is_the_reason_why_it_ended_early() {
    let output = bench(&demo("diagnose --address 1 --fault blocked_write"));
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("the port takes no bytes"), "{}", text(&output.stdout));
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
    assert_eq!(report["line"]["findings"][0]["symptom"], "no_such_port", "{report}");
    let step = report["line"]["findings"][0]["next_step"].as_str().unwrap();
    assert!(step.contains("`dcon-bench ports`") && !step.contains("nplug"), "{step}");
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

fn zip_of(path: &std::path::Path) -> zip::ZipArchive<std::fs::File> {
    zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap()
}

#[test]
fn a_bundle_tells_how_patient_the_line_was_and_how_the_program_was_started() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("help.zip");
    let words = format!("diagnose --address 1 --reads 5 --timeout 300ms --repeats 1 --bundle {}", path.display());
    good(&demo(&words));
    let mut setup = String::new();
    zip_of(&path).by_name("setup.txt").unwrap().read_to_string(&mut setup).unwrap();
    for part in
        ["timeout        300 ms", "repeats        1", "latency timer  none", "dcon-bench diagnose --demo --address 1"]
    {
        assert!(setup.contains(part), "{part}\n{setup}");
    }
}

#[test]
fn what_it_does_is_told_while_it_runs() {
    let output = bench(&demo("diagnose --address 1 --address 163:dcon --reads 5"));
    let told = text(&output.stderr);
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(
        lines,
        [
            "Opening Simulated line at 9600 N81; timeout 200 ms, repeats 2",
            "Looking for a module at address 1 (01h), Modbus RTU 9600 N81",
            "Looking for a module at address 163 (A3h), DCON 9600 N81",
            "Reading the same of PIR-234 at address 1 (01h), Modbus RTU 9600 N81 5 times",
            "Reading the same of PIR-234 at address 163 (A3h), DCON 9600 N81 5 times",
        ]
    );
}

#[test]
fn a_bundle_that_cannot_be_written_is_told_before_anything_is_asked() {
    let folder = TempDir::new().unwrap();
    let missing = folder.path().join("nowhere/help.zip");
    let words = format!("diagnose --address 1 --bundle {}", missing.display());
    let told = bad(2, &demo(&words));
    assert!(told.contains("there is no folder") && !told.contains("Opening"), "{told}");
    let words = format!("diagnose --address 1 --bundle {}", folder.path().display());
    let told = bad(2, &demo(&words));
    assert!(told.contains("is a folder: add the name of a file") && !told.contains("Opening"), "{told}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_place_where_nothing_may_be_written_is_told_before_anything_is_asked() {
    let told = bad(1, &demo("diagnose --address 1 --bundle /proc/help.zip"));
    assert!(told.contains("/proc/help.zip cannot be written") && !told.contains("Opening"), "{told}");
}

#[test]
fn a_host_that_takes_no_connection_is_told_with_advice_for_a_network() {
    // A port that was free a moment ago.
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let output = bench(&["diagnose", "--tcp", &format!("127.0.0.1:{port}"), "--address", "1"]);
    assert_eq!(output.status.code(), Some(1));
    let told = text(&output.stdout);
    assert!(told.contains("The host cannot be reached") && told.contains("the port number"), "{told}");
    assert!(!told.contains("dapter") && !told.contains("nplug"), "{told}");
    assert!(told.ends_with("1 fault needs attention.\n"), "{told}");
}

#[test]
fn answers_later_than_the_timeout_are_told_with_one_that_would_do() {
    let output = bench(&demo("diagnose --address 160:modbus_rtu --reads 12 --timeout 20ms --fault late=30%"));
    let told = text(&output.stdout);
    assert!(told.contains("came later than the timeout of 20 ms"), "{told}");
    assert!(told.contains("Answers come too late") && !told.contains("could be lowered"), "{told}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_tells_what_was_heard_until_then_and_writes_the_bundle() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("help.zip");
    let words = format!("diagnose --address 1 --reads 1000 --bundle {}", path.display());
    let mut running = program::Running::start(&demo(&words));
    let mut told = std::io::BufRead::lines(std::io::BufReader::new(running.child.stderr.take().unwrap()));
    told.by_ref().map(Result::unwrap).find(|line| line.starts_with("Reading the same")).unwrap();
    assert_eq!(running.end_by("-INT"), Some(1));
    let report: Vec<String> = running.lines.by_ref().map(Result::unwrap).collect();
    let report = report.join("\n");
    for part in ["Stopped early: it was interrupted.", "PIR-234 at address 1"] {
        assert!(report.contains(part), "{part}\n{report}");
    }
    assert!(report.ends_with("Nothing was wrong until it was stopped."), "{report}");
    assert!(told.map(Result::unwrap).any(|line| line.contains("help.zip written")));
    assert!(zip_of(&path).file_names().count() > 5);
}
