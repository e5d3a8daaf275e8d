//! An export that runs on a thread of its own, into a file.

use std::fs::File;
use std::io;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use jiff::tz::TimeZone;

use super::{EventRows, Export, ExportError, Format, Progress, Rows, Source};
use crate::record::whole::write_whole;

/// An export under way. Dropping it stops the export; unless it was whole before, no file is left behind, and one that
/// stood there stays as it was.
pub struct ExportJob {
    shared: Arc<Shared>,
    outcome: Receiver<Result<Progress, ExportError>>,
}

#[derive(Default)]
struct Shared {
    progress: Mutex<Progress>,
    stopped: AtomicBool,
}

impl ExportJob {
    /// Begins to write `source` to the file `path`; `wake` is called when there is progress to be shown, and when it is
    /// over.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn start(
        path: PathBuf,
        source: Source,
        format: Format,
        rows: Rows,
        zone: TimeZone,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        Self::spawn(path, wake, move |file, progress| Export::run(source, format, rows, &zone, file, progress))
    }

    /// The same with events.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn start_events(
        path: PathBuf,
        events: EventRows,
        format: Format,
        zone: TimeZone,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        Self::spawn(path, wake, move |file, progress| Export::run_events(events, format, &zone, file, progress))
    }

    fn spawn(
        path: PathBuf,
        wake: impl Fn() + Send + 'static,
        export: impl FnOnce(&File, &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Progress, ExportError>
        + Send
        + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (tell, outcome) = sync_channel(1);
        let of_thread = shared.clone();
        let work = move || {
            let ended = write_whole(&path, |file| export(file, &mut |progress| of_thread.note(progress, &wake)));
            // Nobody waits any more if the window was closed meanwhile.
            let _ = tell.send(ended);
            wake();
        };
        std::thread::Builder::new().name("export".to_owned()).spawn(work)?;
        Ok(Self { shared, outcome })
    }

    pub fn progress(&self) -> Progress {
        *self.shared.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks it to end; [`ExportJob::outcome`] tells when it has.
    pub fn cancel(&self) {
        self.shared.stopped.store(true, Ordering::Relaxed);
    }

    /// How it ended, once; `None` while it goes on.
    pub fn outcome(&self) -> Option<Result<Progress, ExportError>> {
        match self.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(io::Error::other("the export ended").into())),
        }
    }
}

impl Drop for ExportJob {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl Shared {
    /// Wakes for every hundredth, not for every row.
    fn note(&self, progress: Progress, wake: &impl Fn()) -> ControlFlow<()> {
        let mut shown = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let hundredths = |progress: &Progress| (progress.part * 100.0) as u32;
        let further = hundredths(&progress) != hundredths(&shown);
        *shown = progress;
        drop(shown);
        if further {
            wake();
        }
        if self.stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
