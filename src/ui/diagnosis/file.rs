//! The bundle as a file, made in steps so that the window goes on.

use std::io;

use crate::bench::Bench;
use crate::bench::traffic::FrameRef;
use crate::diagnosis::bundle::{Traffic, last_frames};
use crate::ui::saving::{Contents, Step};

/// Frames written at a time.
const AT_ONCE: u64 = 1_000;

/// Gathers the last traffic, then makes the zip.
pub struct BundleFile {
    first: u64,
    next: u64,
    end: u64,
    /// `None` before the first step.
    traffic: Option<Traffic>,
}

impl BundleFile {
    pub fn new(bench: &Bench) -> Self {
        let log = bench.traffic();
        let frames = last_frames(log.first_seq()..log.next_seq());
        Self { first: frames.start, next: frames.start, end: frames.end, traffic: None }
    }
}

impl Contents for BundleFile {
    fn step(&mut self, bench: &Bench) -> io::Result<Step> {
        let mut traffic = match self.traffic.take() {
            Some(traffic) if self.next >= self.end => {
                let bytes = bench.support_bundle(traffic)?.to_bytes()?;
                return Ok(Step { bytes, is_last: true });
            }
            Some(traffic) => traffic,
            None => Traffic::new(&bench.diagnosis_report().line.name)?,
        };
        let explain =
            |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
        let end = self.next.saturating_add(AT_ONCE).min(self.end);
        bench.traffic().add_to_bundle(self.next..end, &explain, &mut traffic)?;
        self.next = end;
        self.traffic = Some(traffic);
        Ok(Step { bytes: Vec::new(), is_last: false })
    }

    fn part(&self) -> f32 {
        self.next.saturating_sub(self.first) as f32 / self.end.saturating_sub(self.first).max(1) as f32
    }

    fn what(&self) -> String {
        "The diagnostic bundle".to_owned()
    }
}
