//! The diagnosis: what is wrong with the line, the numbers behind it, and what to do.

use dcon_bench::sim::Pace;
use eframe::egui::accesskit::Role;

use crate::harness::*;
use crate::traffic::{save_to_from, window_with_field};

fn opened(window: &mut Window) {
    open(window, "PIR-234, address 1");
    click(window, Role::Button, "Diagnosis");
    until(window, "it is listed", |window| shows(window, "Diagnosis of PIR-234 @1"));
}

/// Whatever was found of it.
fn choose(window: &mut Window) {
    let label = window_label(window, "Diagnosis of PIR-234 @1").unwrap();
    click(window, Role::ListItem, &label);
}

#[test]
fn an_empty_diagnosis_tells_what_will_be_there() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    click(&mut window, Role::Button, "Diagnosis");
    assert!(shows(&window, "Nothing to diagnose yet") && shows(&window, "Scan the line"));
}

#[test]
fn a_healthy_module_shows_its_answer_times_and_a_timeout_to_use() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    opened(&mut window);
    assert!(shows(&window, "Nothing is wrong."));
    assert!(shows(&window, "addresses, which count nowhere else"), "the scan's silence is told apart");
    choose(&mut window);
    until(&mut window, "enough answers", |window| shows(window, "99 of 100 answers began within"));
    assert!(shows(&window, "Answer times:") && shows(&window, "Failed exchanges: 0 of"));
    assert!(shows(&window, "median "));
    assert!(shows(&window, "200 ms in use, which is ample"), "no longer timeout is suggested");
    let lower = window_label(&window, "Lower to ").unwrap();
    click(&mut window, Role::Button, &lower);
}

#[test]
fn the_consistency_test_runs_beside_the_polls_and_tells_its_result() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    opened(&mut window);
    choose(&mut window);
    click(&mut window, Role::Button, "Test consistency");
    until(&mut window, "the result", |window| shows(window, "50 of 50 reads answered, all the same"));
    assert!(shows(&window, "Consistent – "));
}

#[test]
fn a_module_that_stops_answering_is_a_fault_with_cause_and_next_step() {
    let sim = sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip);
    let mut window = window(&sim);
    opened(&mut window);
    sim.set_dead(1, true);
    until(&mut window, "it is found", |window| shows(window, "Diagnosis of PIR-234 @1, Fault"));
    choose(&mut window);
    until(&mut window, "enough silence", |window| shows(window, "It has stopped answering"));
    assert!(shows(&window, "Likely cause: Its power or cable is gone"));
    assert!(shows(&window, "Next step: Check its power and terminals"));
}

#[test]
fn a_bundle_for_others_is_saved_as_one_zip() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with_field(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    opened(&mut window);
    let path = folder.path().join("help.zip");
    click(&mut window, Role::Button, "Save bundle…");
    save_to_from(&mut window, &path);
    let zip = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
    let names: Vec<String> = zip.file_names().map(|name| name.unwrap().into_owned()).collect();
    for name in ["README.txt", "report.txt", "traffic.csv", "traffic.pcapng"] {
        assert!(names.iter().any(|known| known == name), "{names:?}");
    }
}

/// The label of the button that begins so.
fn window_label(window: &Window, start: &str) -> Option<String> {
    use egui_kittest::kittest::{NodeT, Queryable};
    let nodes = window.query_all_by_label_contains(start);
    nodes.filter_map(|node| node.accesskit_node().label()).find(|label| label.starts_with(start))
}
