//! A recording that is looked at while it is written.

use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use dcon_bench::record::{Recording, SeriesId, StoreError, Viewer, seconds};

use crate::common::{SECOND, START, Watched, described, file, record, samples, values};

#[test]
fn a_reader_sees_what_comes_and_misses_nothing_when_rows_become_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(2));
    let mut reader: Option<(Recording, _)> = None;
    let mut next = 0;
    for portion in [10, 4_000, 3, 5_500, 200, 400] {
        let range = next..next + portion;
        next += portion;
        watched.recorder.put(range.clone().map(|n| record(0, START + n * SECOND, n)).collect());
        watched.recorder.put(range.map(|n| record(1, START + n * SECOND, 2 * n)).collect());
        watched.wait(|status| status.samples == 2 * next as u64);
        match &mut reader {
            Some((recording, history)) => assert!(recording.refresh(history).unwrap()),
            None => {
                let mut recording = Recording::open(&path).unwrap();
                let history = recording.load().unwrap();
                reader = Some((recording, history));
            }
        }
        let (recording, history) = reader.as_mut().unwrap();
        assert!(!recording.refresh(history).unwrap());
        let all = samples(recording, history);
        assert_eq!(values(&all[0]), (0..next).collect::<Vec<_>>());
        assert_eq!(values(&all[1]), (0..next).map(|n| 2 * n).collect::<Vec<_>>());
    }
    watched.recorder.finish().unwrap();
}

fn open(path: &Path) -> (Viewer, Receiver<()>) {
    let (wake, woken) = channel();
    (
        Viewer::open(path.to_owned(), move || {
            let _ = wake.send(());
        })
        .unwrap(),
        woken,
    )
}

fn pump_until(viewer: &mut Viewer, woken: &Receiver<()>, is_so: impl Fn(&Viewer) -> bool) {
    viewer.pump();
    while !is_so(viewer) {
        // Asks for what was looked at; then nothing draws the window until it is woken.
        viewer.pump();
        woken.recv_timeout(Duration::from_secs(60)).unwrap();
        viewer.pump();
    }
}

#[test]
fn a_viewer_reads_what_there_is_what_comes_and_what_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    let (mut viewer, woken) = open(&path);
    pump_until(&mut viewer, &woken, |viewer| viewer.problem().is_some());
    assert_eq!(viewer.problem(), Some(&StoreError::NotThere { path: path.clone() }));

    let mut watched = Watched::start(file(&path));
    watched.recorder.put(described(1));
    watched.recorder.put((0..9_000).map(|n| record(0, START + n * SECOND, n % 100)).collect());
    watched.wait(|status| status.samples == 9_000);
    let count = |viewer: &Viewer| {
        viewer.history().and_then(|history| history.get(SeriesId(0))).map_or(0, |series| series.trend.len())
    };
    pump_until(&mut viewer, &woken, |viewer| count(viewer) == 9_000);
    assert_eq!(viewer.problem(), None);

    let look = |viewer: &Viewer| {
        let trend = &viewer.history().unwrap().get(SeriesId(0)).unwrap().trend;
        let from = seconds(START);
        trend.lines(from + 100.0, from + 200.0, 1_000).iter().map(Vec::len).sum::<usize>()
    };
    assert!(look(&viewer) < 100, "it is on the disk only");
    pump_until(&mut viewer, &woken, |viewer| look(viewer) == 103);

    watched.recorder.put((9_000..9_050).map(|n| record(0, START + n * SECOND, n % 100)).collect());
    pump_until(&mut viewer, &woken, |viewer| count(viewer) == 9_050);
    watched.recorder.finish().unwrap();
}
