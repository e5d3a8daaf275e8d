//! Captures as a user makes and reads them: by the real program, and by another one.

#[path = "../common/program.rs"]
mod program;

mod readers;

use std::path::Path;

use dcon_bench::bus::{Direction, Frame, Verdict};
use dcon_bench::capture;
use program::{bad, bench, good, text};
use serde_json::Value;

/// Writes a capture of a scan of the simulated line.
fn scanned(path: &Path) {
    let file = path.to_str().unwrap();
    good(&["scan", "--demo", "--addresses", "1,2,0xA0,A3h", "--json", "--capture", file]);
}

fn frames(path: &Path) -> Vec<Frame> {
    capture::read_file(path).unwrap().collect::<Result<_, _>>().unwrap()
}

fn rows(file: &Path, more: &[&str]) -> Vec<Value> {
    let printed = good(&[&["replay", file.to_str().unwrap(), "--json"], more].concat());
    printed.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_scan_is_captured_and_replayed_with_what_the_frames_mean() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["scan.pcapng", "scan.txt"] {
        let path = folder.path().join(name);
        scanned(&path);
        let rows = rows(&path, &[]);
        let [frames @ .., summary] = rows.as_slice() else { panic!("nothing in {name}") };
        let has = |key: &str, words: &str| frames.iter().any(|row| row[key].as_str().unwrap().contains(words));
        assert!(has("meaning", "name PIR234") && has("text", "!A3PIR234\\r"), "{rows:?}");
        assert!(has("error", "no answer"), "{rows:?}");
        assert_eq!(summary["summary"]["frames"], frames.len());
        assert!(summary["summary"]["errors"]["no answer"].as_u64().unwrap() > 0);
        assert_eq!(frames.len(), capture::read_file(&path).unwrap().count());
    }
}

#[test]
fn replay_knows_a_module_by_what_it_said_or_by_its_given_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("show.pcapng");
    good(&["show", "--demo", "--address", "1", "--capture", path.to_str().unwrap()]);
    let meant =
        |more: &[&str]| rows(&path, more).iter().any(|row| row["meaning"].to_string().contains("temperature_c"));
    assert!(meant(&[]) && meant(&["--model", "PIR-234"]));
    assert!(bad(2, &["replay", path.to_str().unwrap(), "--model", "pir-999"]).contains("pir-234"));
}

#[test]
fn replay_for_people_ends_with_a_summary_and_can_show_errors_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.pcapng");
    scanned(&path);
    let all = good(&["replay", path.to_str().unwrap()]);
    let errors = good(&["replay", path.to_str().unwrap(), "--errors"]);
    assert!(all.contains("PIR234") && all.contains(" exchanges in "), "{all}");
    assert!(errors.contains("No answer") && errors.contains("× no answer"), "{errors}");
    assert!(errors.lines().count() < all.lines().count(), "{errors}");
    assert!(!errors.contains("name PIR234"), "{errors}");
}

#[test]
fn a_cut_or_damaged_capture_is_shown_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.pcapng", "a.log"] {
        let path = folder.path().join(name);
        scanned(&path);
        let whole = std::fs::read(&path).unwrap();
        let all = frames(&path).len();
        std::fs::write(&path, &whole[..whole.len() - 3]).unwrap();
        let output = bench(&["replay", path.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(text(&output.stdout).lines().count(), all, "all but one, and the summary");
        assert!(text(&output.stderr).contains("in the middle of a frame"), "{}", text(&output.stderr));
        let middle = whole.len() / 2;
        std::fs::write(&path, [&whole[..middle], &[0xFF; 16], &whole[middle..]].concat()).unwrap();
        let output = bench(&["replay", path.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(1));
        let shown = text(&output.stdout).lines().count();
        assert!(shown > 1 && shown < all, "{shown} of {all}");
    }
    let path = folder.path().join("notes.txt");
    std::fs::write(&path, "buy milk\n").unwrap();
    assert!(bad(1, &["replay", path.to_str().unwrap()]).contains("no capture"));
    assert!(bad(1, &["replay", "not-there.pcapng"]).contains("not-there.pcapng"));
}

#[test]
fn only_captures_are_replaced_and_only_known_endings_taken() {
    let folder = tempfile::tempdir().unwrap();
    let notes = folder.path().join("notes.txt");
    std::fs::write(&notes, "buy milk\n").unwrap();
    let scan =
        |path: &Path| bench(&["scan", "--demo", "--addresses", "1", "--capture", path.to_str().unwrap()]).status.code();
    assert_eq!(scan(&notes), Some(2));
    assert_eq!(std::fs::read_to_string(&notes).unwrap(), "buy milk\n");
    let path = folder.path().join("a.pcapng");
    assert_eq!([scan(&path), scan(&path)], [Some(0), Some(0)]);
    assert!(!frames(&path).is_empty());
    let refused = bad(2, &["scan", "--demo", "--capture", "a.pcap"]);
    assert!(refused.contains(".pcapng") && refused.contains(".txt"), "{refused}");
    assert_eq!(scan(&folder.path().join("none").join("a.pcapng")), Some(1));
}

#[test]
fn what_happened_before_an_error_is_captured_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    bad(1, &["show", "--demo", "--address", "99", "--capture", path.to_str().unwrap()]);
    let frames = frames(&path);
    assert_eq!(frames[0].direction, Direction::Sent);
    let silent = frames.iter().find(|frame| frame.verdict == Verdict::Silent).unwrap();
    assert_eq!((silent.bytes.len(), silent.address), (0, Some(99)));
}

#[cfg(unix)]
#[test]
fn a_capture_can_be_read_while_it_grows_and_is_whole_after_an_interrupt() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcapng");
    let file = path.to_str().unwrap();
    let mut watch =
        program::Running::start(&["watch", "--demo", "--address", "1", "--interval", "100ms", "--capture", file]);
    watch.line();
    let early = frames(&path).len();
    assert!(early > 1);
    watch.line();
    assert_eq!(watch.end_by("-INT"), Some(0));
    assert!(frames(&path).len() > early);
}
