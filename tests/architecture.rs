//! The table of rooms in ARCHITECTURE.md is true: a room uses only rooms below it.

use std::collections::BTreeSet;
use std::path::Path;

/// The rooms from the table's first line to its last.
fn rooms(root: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let names = text.lines().filter_map(|line| line.strip_prefix("| `")?.split(['/', '.']).next());
    names.map(str::to_owned).collect()
}

/// The code of a room, without comments and tests.
fn code(path: &Path) -> String {
    if path.is_dir() {
        return std::fs::read_dir(path).unwrap().map(|entry| code(&entry.unwrap().path())).collect();
    }
    if path.file_stem().is_some_and(|stem| stem == "tests") {
        return String::new();
    }
    let text = std::fs::read_to_string(path).unwrap();
    let code = text.lines().take_while(|line| !line.starts_with("#[cfg(test)]"));
    code.filter(|line| !line.trim_start().starts_with("//")).map(|line| format!("{line}\n")).collect()
}

fn is_used(room: &str, code: &str) -> bool {
    let named = code.match_indices("crate::").map(|(at, path)| &code[at + path.len()..]);
    let mut starts = named.flat_map(|rest| match rest.strip_prefix('{') {
        Some(list) => list.split('}').next().unwrap_or_default().split(',').map(str::trim).collect(),
        None => vec![rest],
    });
    starts.any(|start| {
        start.strip_prefix(room).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    })
}

#[test]
fn no_room_uses_one_above_it_and_none_is_missing() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let rooms = rooms(root);
    let stem = |path: std::path::PathBuf| path.file_stem().unwrap().to_string_lossy().into_owned();
    let there: BTreeSet<String> =
        std::fs::read_dir(root.join("src")).unwrap().map(|entry| stem(entry.unwrap().path())).collect();
    let listed: BTreeSet<String> = rooms.iter().cloned().chain(["lib", "console"].map(str::to_owned)).collect();
    assert_eq!(listed, there);
    for (index, room) in rooms.iter().enumerate() {
        let path = root.join("src").join(room);
        let code = code(&if path.is_dir() { path } else { path.with_extension("rs") });
        let above: Vec<&String> = rooms[..index].iter().filter(|above| is_used(above, &code)).collect();
        assert!(above.is_empty(), "{room} uses {above:?}");
    }
}
