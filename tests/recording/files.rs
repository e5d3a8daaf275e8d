//! Recordings in a folder: new files, old files, and what is fetched from them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::time::Duration;

use dcon_bench::record::{
    Archive, Destination, Fetcher, History, Keeping, Micros, ModuleInfo, SeriesId, SeriesInfo, SeriesKind, seconds,
};

use crate::common::{SECOND, START, Watched, described, read, record, values};

fn into(folder: &Path, file_size: u64, total_size: Option<u64>) -> Destination {
    Destination::Folder { folder: folder.to_owned(), keeping: Keeping { file_size, total_size, days: None } }
}

fn names(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

const PORTION: i64 = 3_000;

/// Values that do not let themselves be written in few bytes.
fn noise(n: i64) -> i64 {
    n.wrapping_mul(0x5851_f42d_4c95_7f2d) >> 16
}

/// So many portions of samples, each on the disk before the next comes.
fn play(watched: &mut Watched, portions: i64) {
    watched.recorder.put(described(1));
    for portion in 0..portions {
        let records = (0..PORTION).map(|n| portion * PORTION + n).map(|n| record(0, START + n * SECOND, noise(n)));
        watched.recorder.put(records.collect());
        watched.wait(|status| status.waiting == 0 && status.problem.is_none());
    }
}

#[test]
fn a_new_file_is_begun_when_one_is_large_and_all_of_it_can_be_fetched() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("recordings");
    let mut watched = Watched::start(into(&inner, 1, None));
    play(&mut watched, 8);
    let mut archive = watched.recorder.archive();
    let expected: Vec<i64> = (0..24_000).map(noise).collect();
    let all = archive.samples(SeriesId(0), Micros::MIN, Micros::MAX).unwrap();
    assert_eq!(values(&all), expected);
    assert!(all.iter().all(|sample| !sample.gap), "a new file is no gap");
    let part = archive.samples(SeriesId(0), START + 400 * SECOND, START + 22_000 * SECOND).unwrap();
    assert_eq!(values(&part), expected[400..=22_000]);
    archive.rest();

    let status = watched.recorder.finish().unwrap();
    assert!(status.files.len() >= 2, "{:?}", status.files);
    assert_eq!(status.samples, 24_000);
    assert!(status.files.is_sorted());
    let files: Vec<PathBuf> = status.files.iter().map(|(_, path)| path.clone()).collect();
    assert_eq!(names(&inner).len(), files.len(), "neither locks nor journals stay");
    let parts: Vec<i64> = files.iter().flat_map(|path| values(&read(path)[0])).collect();
    assert_eq!(parts, expected);
    assert_eq!(
        values(&archive.samples(SeriesId(0), Micros::MIN, Micros::MAX).unwrap()),
        expected,
        "also after its end"
    );
}

#[test]
fn the_oldest_files_go_and_what_is_not_ours_stays() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("dcon-bench 2020-01-01 00.00.00.sqlite"), "somebody's").unwrap();
    fs::write(folder.path().join("notes.sqlite"), "somebody's").unwrap();
    let mut watched = Watched::start(into(folder.path(), 1, Some(300_000)));
    play(&mut watched, 14);
    let mut archive = watched.recorder.archive();
    let status = watched.recorder.finish().unwrap();
    let mut left = names(folder.path());
    left.retain(|name| name != "notes.sqlite" && !name.starts_with("dcon-bench 2020"));
    assert_eq!(left.len(), names(folder.path()).len() - 2);
    assert_eq!(left.len(), status.files.len());
    assert!((1..4).contains(&left.len()), "{left:?}");
    let rest = archive.samples(SeriesId(0), Micros::MIN, Micros::MAX).unwrap();
    assert!(!rest.is_empty() && rest.last().unwrap().value == noise(14 * PORTION - 1));
}

#[test]
fn what_a_live_history_gave_up_comes_back_when_it_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let mut watched = Watched::start(into(folder.path(), 1, None));
    let mut history = History::default();
    let module = history.module(ModuleInfo::default());
    let (item, label, unit) = ("t".to_owned(), "T".to_owned(), String::new());
    let id = history.series_for(SeriesInfo { module, item, label, unit, kind: SeriesKind::Switch });
    history.begin_news();
    for n in 0..40_000 {
        history.push(id, START + n * SECOND, noise(n));
        if n % 10_000 == 9_999 {
            watched.recorder.put(history.take_news());
            watched.wait(|status| status.waiting == 0);
        }
    }
    let [from, to] = history.span().unwrap().map(seconds);
    let draw = |history: &History| history.get(id).unwrap().trend.lines(from, to, 20_000);
    let whole = draw(&history);
    let saved = watched.recorder.status().saved_until.unwrap();
    let trend = history.trend_mut(id).unwrap();
    let look = trend.looks();
    assert!(trend.give_up(saved, look) > 39_000);
    assert_ne!(draw(&history), whole);

    let (wake, woken) = channel();
    let fetcher = Fetcher::start(Box::new(watched.recorder.archive()), move || {
        let _ = wake.send(());
    });
    let fetcher = fetcher.unwrap();
    while draw(&history) != whole {
        let wanted = history.trend_mut(id).unwrap().take_wanted();
        wanted.into_iter().for_each(|stretch| fetcher.want(id, stretch));
        woken.recv_timeout(Duration::from_secs(60)).unwrap();
        fetcher.take().into_iter().for_each(|(id, samples)| history.fill(id, &samples));
    }
    watched.recorder.finish().unwrap();
}
