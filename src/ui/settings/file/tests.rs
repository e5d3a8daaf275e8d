use std::fs;

use tempfile::TempDir;

use super::super::ThemeChoice;
use super::*;

fn folder_with(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    fs::write(&path, text).unwrap();
    (folder, path)
}

fn opened(folder: &TempDir) -> (SettingsFile, Settings, Vec<String>) {
    let Opened { settings, file, warnings } = open(Some(folder.path()));
    (file.unwrap(), settings, warnings)
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn dark(settings: &Settings) -> Settings {
    Settings { theme: ThemeChoice::Dark, ..settings.clone() }
}

#[test]
fn what_was_chosen_is_there_at_the_next_start() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("not").join("there yet");
    let Opened { settings, file, warnings } = open(Some(&folder));
    assert_eq!((&settings, warnings.len()), (&Settings::default(), 0));
    let chosen = Settings { layout: Some("tiles".to_owned()), recent_ports: vec!["COM3".into()], ..dark(&settings) };
    assert_eq!(file.unwrap().keep_now(&chosen), None);
    assert_eq!(names(&folder), [NAME]);
    let again = open(Some(&folder));
    assert_eq!((again.settings, again.warnings.len()), (chosen, 0));
    assert!(fs::read_to_string(folder.join(NAME)).unwrap().contains("version = 1\n"));
}

#[test]
fn nothing_is_written_unless_something_changed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut file, settings, _) = opened(&folder);
    assert_eq!(file.keep(&settings, Instant::now()), Outcome::default());
    assert_eq!(file.keep_now(&settings), None);
    // A span that was zoomed to is no change.
    assert_eq!(file.keep_now(&Settings { span: 73.0, ..settings }), None);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_change_is_written_some_seconds_later_together_with_the_next_one() {
    let folder = tempfile::tempdir().unwrap();
    let (mut file, settings, _) = opened(&folder);
    let start = Instant::now();
    let first = file.keep(&dark(&settings), start);
    assert_eq!(first, Outcome { warning: None, look_again: Some(WRITE_AFTER) });
    let both = Settings { strips: false, ..dark(&settings) };
    let second = file.keep(&both, start + Duration::from_secs(1));
    assert_eq!(second.look_again, Some(WRITE_AFTER - Duration::from_secs(1)));
    assert!(names(folder.path()).is_empty());
    assert_eq!(file.keep(&both, start + WRITE_AFTER), Outcome::default());
    assert_eq!(opened(&folder).1, both);
}

#[test]
fn a_change_that_was_taken_back_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let (mut file, settings, _) = opened(&folder);
    let start = Instant::now();
    file.keep(&dark(&settings), start);
    assert_eq!(file.keep(&settings, start + WRITE_AFTER), Outcome::default());
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_zoomed_span_leaves_the_named_one_in_the_file() {
    let (folder, _) = folder_with("span = 300.0");
    let (mut file, settings, _) = opened(&folder);
    assert_eq!(file.keep_now(&Settings { span: 73.0, ..dark(&settings) }), None);
    let (_, read, warnings) = opened(&folder);
    assert_eq!((read, warnings.len()), (dark(&settings), 0));
}

#[test]
fn unknown_keys_and_wrong_values_survive_a_rewrite() {
    let (folder, path) = folder_with("zoom = 'big'\nlater = 5\n[plugin]\nlist = [1, 2]\n");
    let (mut file, settings, warnings) = opened(&folder);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains(&path.display().to_string()) && warnings[0].contains("\"zoom\""), "{warnings:?}");
    assert_eq!(file.keep_now(&dark(&settings)), None);
    let table: Table = fs::read_to_string(path).unwrap().parse().unwrap();
    let expected = "version = 1\nzoom = 'big'\nlater = 5\ntheme = 'dark'\n[plugin]\nlist = [1, 2]\n";
    assert_eq!(table, expected.parse().unwrap());
}

#[test]
fn two_copies_of_the_program_keep_what_each_changed() {
    let (folder, _) = folder_with("zoom = 1.0");
    let (mut one, settings, _) = opened(&folder);
    let (mut other, _, _) = opened(&folder);
    one.keep_now(&dark(&settings));
    other.keep_now(&Settings { zoom: 2.0, ..settings.clone() });
    assert_eq!(opened(&folder).1, Settings { zoom: 2.0, ..dark(&settings) });
}

#[test]
fn a_file_of_a_newer_version_is_read_as_far_as_possible_and_left_as_it_is() {
    let text = "version = 2\ntheme = { from = 'dusk' }\nstrips = false\n";
    let (folder, path) = folder_with(text);
    let (mut file, settings, warnings) = opened(&folder);
    assert_eq!(settings, Settings { strips: false, ..Settings::default() });
    assert!(warnings[0].contains("newer version") && warnings[1].contains("\"theme\""), "{warnings:?}");
    assert_eq!(file.keep(&dark(&settings), Instant::now()), Outcome::default());
    assert_eq!(file.keep_now(&dark(&settings)), None);
    assert_eq!(fs::read_to_string(path).unwrap(), text);
}

#[test]
fn a_newer_file_that_appears_meanwhile_is_left_as_it_is_and_told_once() {
    let (folder, path) = folder_with("version = 1");
    let (mut file, settings, _) = opened(&folder);
    let newer = "version = 7\n";
    fs::write(&path, newer).unwrap();
    assert!(file.keep_now(&dark(&settings)).unwrap().contains("newer version"));
    assert_eq!(file.keep_now(&dark(&settings)), None);
    assert_eq!(fs::read_to_string(path).unwrap(), newer);
}

#[test]
fn a_broken_file_is_kept_aside_and_named_once() {
    for broken in ["version = 1\nzoom = = 2\n".as_bytes(), &[0xFF, 0xFE, 0x00], b"[[[["] {
        let (folder, path) = folder_with("");
        fs::write(&path, broken).unwrap();
        let (mut file, settings, warnings) = opened(&folder);
        assert_eq!((&settings, warnings.len()), (&Settings::default(), 1));
        assert!(warnings[0].contains("settings.toml.broken"), "{warnings:?}");
        assert_eq!(names(folder.path()), ["settings.toml.broken"]);
        assert!(opened(&folder).2.is_empty());
        assert_eq!(file.keep_now(&dark(&settings)), None);
        assert_eq!(fs::read(folder.path().join("settings.toml.broken")).unwrap(), broken);
        assert_eq!(opened(&folder).1, dark(&settings));
    }
}

#[test]
fn a_file_saved_by_an_editor_that_marks_its_encoding_is_read() {
    let (folder, _) = folder_with("\u{feff}strips = false\r\ntab = 'log'\r\n");
    let (_, settings, warnings) = opened(&folder);
    assert_eq!((settings.strips, settings.tab.as_str(), warnings.len()), (false, "log", 0));
}

#[test]
fn the_line_of_the_mistake_is_named() {
    let (folder, _) = folder_with("version = 1\nzoom = = 2\n");
    let warnings = opened(&folder).2;
    assert!(warnings[0].contains("(line 2: "), "{warnings:?}");
}

#[test]
fn a_folder_or_a_huge_file_in_place_of_the_file_is_put_aside() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join(NAME)).unwrap();
    assert!(opened(&folder).2[0].contains("not a file"));
    let (folder, path) = folder_with("");
    File::options().write(true).open(path).unwrap().set_len(LARGEST + 1).unwrap();
    assert!(opened(&folder).2[0].contains("larger than 4 MB"));
    assert_eq!(names(folder.path()), ["settings.toml.broken"]);
}

#[test]
fn a_broken_file_that_cannot_be_renamed_is_not_overwritten() {
    let (folder, path) = folder_with("zoom = = 2");
    fs::create_dir_all(folder.path().join("settings.toml.broken").join("full")).unwrap();
    let (mut file, settings, warnings) = opened(&folder);
    assert!(warnings[0].contains("nor renamed"), "{warnings:?}");
    assert_eq!(file.keep_now(&dark(&settings)), None);
    assert_eq!(fs::read_to_string(path).unwrap(), "zoom = = 2");
}

#[test]
fn a_write_that_fails_half_way_leaves_the_old_file_and_nothing_else() {
    let (folder, path) = folder_with("theme = 'light'");
    let outcome = replace(&path, |file| {
        file.write_all(b"theme = 'da")?;
        Err(io::Error::other("disk full"))
    });
    assert_eq!(outcome.unwrap_err().to_string(), "disk full");
    assert_eq!(fs::read_to_string(&path).unwrap(), "theme = 'light'");
    assert_eq!(names(folder.path()), [NAME]);
}

#[test]
fn where_nothing_can_be_written_one_warning_is_given_and_no_frame_tries_again() {
    let (folder, path) = folder_with("strips = false");
    let (mut file, settings, _) = opened(&folder);
    // Stands where the new file would be written.
    let obstacle = temporary(&fs::canonicalize(&path).unwrap());
    fs::create_dir(&obstacle).unwrap();
    let start = Instant::now();
    file.keep(&dark(&settings), start);
    let warning = file.keep(&dark(&settings), start + WRITE_AFTER).warning.unwrap();
    assert!(warning.contains("not kept") && warning.contains("writable"), "{warning}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "strips = false");
    for second in 4..20 {
        assert_eq!(file.keep(&dark(&settings), start + Duration::from_secs(second)), Outcome::default());
    }
    assert_eq!(file.keep_now(&dark(&settings)), None);
    // At the end it is tried once more.
    fs::remove_dir(&obstacle).unwrap();
    assert_eq!(file.keep(&dark(&settings), start + Duration::from_secs(60)), Outcome::default());
    assert_eq!(fs::read_to_string(&path).unwrap(), "strips = false");
    assert_eq!(file.keep_now(&dark(&settings)), None);
    assert_eq!(opened(&folder).1, dark(&settings));
}

#[test]
fn a_folder_that_cannot_be_made_is_told_and_not_a_panic() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("config");
    let Opened { settings, file, .. } = open(Some(&folder));
    fs::write(&folder, "a file stands where the folder should be").unwrap();
    let mut file = file.unwrap();
    let first = file.keep_now(&dark(&settings));
    assert!(first.is_some_and(|text| text.contains("not kept")));
    assert_eq!(file.keep_now(&dark(&settings)), None);
    assert!(open(None).warnings[0].contains("DCON_BENCH_CONFIG"));
}

#[cfg(unix)]
#[test]
fn a_link_to_the_file_stays_a_link() {
    let (target, real) = folder_with("");
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(&real, folder.path().join(NAME)).unwrap();
    let (mut file, settings, _) = opened(&folder);
    assert_eq!(file.keep_now(&dark(&settings)), None);
    assert!(folder.path().join(NAME).is_symlink());
    assert_eq!(opened(&target).1, dark(&settings));
}
