//! What can go wrong while it is recorded.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use dcon_bench::record::{Destination, Keeping, Recorder, Recording, StoreError};

use crate::common::{SECOND, START, Watched, described, file, read, record, values};

#[test]
fn a_full_disk_is_told_and_everything_is_written_when_there_is_room_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let pages = Arc::new(AtomicU32::new(u32::MAX));
    let mut watched = Watched::with(|wake| Recorder::start_limited(file(&path), Some(pages.clone()), wake));
    watched.recorder.put(described(2));
    let news = |range: std::ops::Range<i64>| {
        range.flat_map(|n| [record(0, START + n * SECOND, n), record(1, START + n * SECOND, -n)]).collect()
    };
    watched.recorder.put(news(0..1_000));
    watched.wait(|status| status.samples == 2_000);

    pages.store(1, Ordering::Relaxed);
    watched.recorder.put(news(1_000..4_000));
    watched.recorder.put(news(4_000..9_000));
    let status = watched.wait(|status| status.problem.is_some());
    assert!(status.problem.unwrap().contains("is full – make room"));
    assert_eq!((status.waiting, status.samples, status.lost), (16_000, 2_000, 0));
    assert_eq!(status.saved_until, Some(START + 999 * SECOND));
    assert_eq!(read(&path)[0].len(), 1_000, "what was written before can be read");

    pages.store(u32::MAX, Ordering::Relaxed);
    let status = watched.wait(|status| status.problem.is_none());
    assert_eq!((status.waiting, status.samples), (0, 18_000));
    assert_eq!(status.saved_until, Some(START + 8_999 * SECOND));
    watched.recorder.finish().unwrap();
    let all = read(&path);
    assert_eq!(values(&all[0]), (0..9_000).collect::<Vec<_>>());
    assert!(all.iter().flatten().all(|sample| !sample.gap));
}

#[test]
fn what_cannot_be_written_at_the_end_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("not").join("there").join("a.sqlite");
    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(1));
    watched.recorder.put(vec![record(0, START, 1)]);
    let status = watched.wait(|status| status.problem.is_some());
    assert_eq!(status.waiting, 1);
    let problem = StoreError::NoFolder { path }.to_string();
    assert_eq!(status.problem.as_ref(), Some(&problem));
    assert_eq!(watched.recorder.finish(), Err(StoreError::Unwritten { count: 1, reason: problem }));
}

#[test]
fn what_was_not_written_can_be_given_to_another_recorder() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("not").join("there").join("a.sqlite");
    let path = folder.path().join("b.sqlite");
    let mut watched = Watched::start(file(&nowhere));
    watched.recorder.put(described(1));
    watched.recorder.put((0..10).map(|n| record(0, START + n, n)).collect());
    watched.wait(|status| status.problem.is_some());
    let (finished, unwritten) = watched.recorder.finish_keeping();
    assert!(matches!(finished, Err(StoreError::Unwritten { count: 10, .. })));

    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(1));
    watched.recorder.put(unwritten);
    let (finished, unwritten) = watched.recorder.finish_keeping();
    assert_eq!((finished.unwrap().samples, unwritten), (10, Vec::new()));
    assert_eq!(values(&read(&path)[0]), (0..10).collect::<Vec<_>>());
}

#[test]
fn what_cannot_be_written_into_a_damaged_file_goes_into_a_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let keeping = Keeping { file_size: u64::MAX, total_size: None, days: None };
    let mut watched = Watched::start(Destination::Folder { folder: folder.path().to_owned(), keeping });
    watched.recorder.put(described(1));
    watched.recorder.put(vec![record(0, START, 1)]);
    let first = watched.wait(|status| status.samples == 1).file.unwrap();
    // The file opens and reads as before, but nothing can be added.
    let connection = rusqlite::Connection::open(&first).unwrap();
    let refuse = "CREATE TRIGGER refuse BEFORE INSERT ON fresh BEGIN SELECT RAISE(ABORT, 'broken'); END";
    connection.execute_batch(refuse).unwrap();
    drop(connection);
    watched.recorder.put(vec![record(0, START + 1, 2)]);
    watched.wait(|status| status.problem.as_ref().is_some_and(|problem| problem.contains("is damaged")));
    let status = watched.wait(|status| status.problem.is_none() && status.waiting == 0);
    watched.recorder.finish().unwrap();
    assert_eq!(status.files.len(), 2);
    assert_eq!(values(&read(&first)[0]), [1]);
    assert_eq!(values(&read(&status.file.unwrap())[0]), [2]);
}

#[test]
fn a_folder_that_comes_later_is_recorded_into() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stick").join("a.sqlite");
    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(1));
    watched.recorder.put((0..10).map(|n| record(0, START + n, n)).collect());
    watched.wait(|status| status.problem.is_some());
    fs::create_dir(path.parent().unwrap()).unwrap();
    watched.wait(|status| status.problem.is_none() && status.samples == 10);
    watched.recorder.finish().unwrap();
    assert_eq!(values(&read(&path)[0]), (0..10).collect::<Vec<_>>());
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_told_until_it_may_be_written() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let allow = |mode| fs::set_permissions(&inner, fs::Permissions::from_mode(mode)).unwrap();
    allow(0o555);
    if fs::write(inner.join("try"), "").is_ok() {
        // Nothing is read-only for the system's own account.
        return;
    }
    for destination in [
        file(&inner.join("a.sqlite")),
        Destination::Folder {
            folder: inner.clone(),
            keeping: Keeping { file_size: u64::MAX, total_size: None, days: None },
        },
    ] {
        allow(0o555);
        let mut watched = Watched::start(destination);
        watched.recorder.put(described(1));
        watched.recorder.put(vec![record(0, START, 5)]);
        let status = watched.wait(|status| status.problem.is_some());
        assert!(status.problem.unwrap().contains("read-only"));
        allow(0o755);
        let status = watched.wait(|status| status.problem.is_none() && status.samples == 1);
        watched.recorder.finish().unwrap();
        assert_eq!(values(&read(&status.file.unwrap())[0]), [5]);
    }
    for journal in ["DELETE", "WAL"] {
        // What a program that was not killed leaves behind, and what one leaves that was looked at meanwhile.
        let change = format!("PRAGMA journal_mode = {journal}");
        let connection = rusqlite::Connection::open(inner.join("a.sqlite")).unwrap();
        connection.query_row(&change, [], |_| Ok(())).unwrap();
        drop(connection);
        allow(0o555);
        assert_eq!(values(&read(&inner.join("a.sqlite"))[0]), [5], "it can be read in a read-only folder");
        allow(0o755);
    }
}

#[test]
fn a_file_that_is_no_recording_is_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("letter.txt");
    fs::write(&path, "Dear reader, this is no recording.").unwrap();
    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(1));
    watched.recorder.put(vec![record(0, START, 1)]);
    let status = watched.wait(|status| status.problem.is_some());
    assert!(status.problem.unwrap().contains("not a recording of this program and was not changed"));
    watched.recorder.finish().unwrap_err();
    assert_eq!(fs::read_to_string(&path).unwrap(), "Dear reader, this is no recording.");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_second_writer_of_a_file_waits_until_the_first_has_ended() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut first = Watched::start(file(&path));
    first.recorder.put(described(1));
    first.recorder.put(vec![record(0, START, 1)]);
    first.wait(|status| status.samples == 1);
    let mut second = Watched::start(file(&path));
    second.recorder.put(described(1));
    second.recorder.put(vec![record(0, START + 5, 2)]);
    let status = second.wait(|status| status.problem.is_some());
    assert!(status.problem.unwrap().contains("another copy of this program – end that recording"));
    assert_eq!(values(&read(&path)[0]), [1], "readers are not disturbed");
    first.recorder.finish().unwrap();
    second.wait(|status| status.problem.is_none() && status.waiting == 0);
    second.recorder.finish().unwrap();
    assert_eq!(values(&read(&path)[0]), [1, 2]);
    assert!(read(&path)[0][1].gap, "what comes after a new start does not continue the line");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "neither lock nor journal stays");
}

#[cfg(unix)]
#[test]
fn a_file_that_is_removed_is_told_and_begun_anew() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(1));
    watched.recorder.put(vec![record(0, START, 1)]);
    watched.wait(|status| status.samples == 1);
    let mut reader = Recording::open(&path).unwrap();
    let mut history = reader.load().unwrap();
    fs::remove_file(&path).unwrap();
    assert!(matches!(reader.refresh(&mut history), Err(StoreError::Removed { .. })));
    watched.recorder.put(vec![record(0, START + 1, 2)]);
    let status = watched.wait(|status| status.problem.is_some());
    assert!(status.problem.unwrap().contains("was removed or replaced"));
    watched.wait(|status| status.problem.is_none());
    watched.recorder.finish().unwrap();
    assert_eq!(values(&read(&path)[0]), [2]);
}

#[test]
fn a_clock_that_was_set_back_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    for (at, lost) in [(START, 0), (START - 10, 1)] {
        let mut watched = Watched::start(file(&path));
        watched.recorder.put(described(1));
        watched.recorder.put(vec![record(0, at, 1)]);
        let status = watched.wait(|status| status.waiting == 0 && status.samples == 1);
        let status = if lost > 0 { watched.wait(|status| status.problem.is_some()) } else { status };
        assert_eq!(status.lost, lost);
        assert_eq!(status.problem.is_some_and(|problem| problem.contains("set the clock")), lost > 0);
        watched.recorder.finish().unwrap();
    }
}
