//! Where a trend view has its samples from.

use crate::bench::{Bench, RecordingId};
use crate::record::{History, seconds};

/// The live history or an opened recording.
pub struct Source<'a> {
    pub history: &'a History,
    /// `None` for the live one.
    pub recording: Option<RecordingId>,
    /// What a file made of it is called.
    pub name: String,
}

impl<'a> Source<'a> {
    pub fn live(bench: &'a Bench) -> Self {
        Self { history: bench.history(), recording: None, name: "dcon-bench".to_owned() }
    }

    /// An opened recording, or what is to be said in its place.
    pub fn recording(bench: &'a Bench, id: RecordingId) -> Result<Self, Vec<String>> {
        let Some(viewer) = bench.opened_recording(id) else {
            return Err(vec!["This recording is closed".to_owned(), "Open it again from the menu.".to_owned()]);
        };
        let path = viewer.path();
        match (viewer.history(), viewer.problem()) {
            (Some(history), _) => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                Ok(Self { history, recording: Some(id), name })
            }
            (None, Some(problem)) => Err(vec!["The recording cannot be shown".to_owned(), problem.to_string()]),
            (None, None) => Err(vec!["Opening the recording".to_owned(), path.display().to_string()]),
        }
    }

    pub fn is_live(&self) -> bool {
        self.recording.is_none()
    }

    /// First and last time of all samples, in seconds since 1970 UTC.
    pub fn span(&self) -> Option<[f64; 2]> {
        self.history.span().map(|span| span.map(seconds))
    }
}
