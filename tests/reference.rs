//! What the program prints of itself: the command reference and the licences.

#[path = "common/program.rs"]
mod program;

use program::{bad, good};

#[test]
fn the_reference_of_a_model_has_its_commands_and_registers() {
    let text = good(&["reference", "PIR-234"]);
    let lines =
        ["# PIR-234\n", "## Commands\n", "### Read or set the PIR output ON time\n", "`$AALC8C0`", "\n| 513 | 0200 | "];
    for line in lines {
        assert!(text.contains(line), "{line}");
    }
    assert!(good(&["reference"]).contains("# PIR-130\n"));
    assert!(bad(2, &["reference", "nothing"]).contains("known are dl-302, pir-130"));
}

#[test]
fn licences_are_printed_as_a_list_and_with_their_texts() {
    let list = good(&["licences", "--list"]);
    assert!(list.lines().any(|line| line.starts_with("serde ") && line.ends_with("MIT OR Apache-2.0")), "{list}");
    let whole = good(&["licences"]);
    assert!(whole.contains("Permission is hereby granted") && whole.contains("blessing"));
    assert!(whole.len() > list.len() * 10);
}
