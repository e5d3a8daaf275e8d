//! The bundle as a file, made in steps so that the window goes on.

use std::io;

use crate::bench::Bench;
use crate::bench::traffic::{FrameRef, append_csv, write_csv};
use crate::diagnosis::bundle::{MOST_FRAMES, Part, TRAFFIC};
use crate::ui::saving::{Contents, Step};

/// Frames written at a time.
const AT_ONCE: u64 = 1_000;

/// Gathers the last traffic, then makes the zip.
pub struct BundleFile {
    first: u64,
    next: u64,
    end: u64,
    csv: Vec<u8>,
}

impl BundleFile {
    pub fn new(bench: &Bench) -> Self {
        let log = bench.traffic();
        let end = log.next_seq();
        let first = end.saturating_sub(MOST_FRAMES).max(log.first_seq());
        Self { first, next: first, end, csv: Vec::new() }
    }

    fn is_gathered(&self) -> bool {
        self.next >= self.end && !self.csv.is_empty()
    }
}

impl Contents for BundleFile {
    fn step(&mut self, bench: &Bench) -> io::Result<Step> {
        if self.is_gathered() {
            let traffic = Part::new(TRAFFIC, std::mem::take(&mut self.csv));
            let bytes = bench.support_bundle(vec![traffic]).to_bytes()?;
            return Ok(Step { bytes, is_last: true });
        }
        let explain =
            |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
        let end = self.next.saturating_add(AT_ONCE).min(self.end);
        if self.csv.is_empty() {
            write_csv(bench.traffic(), self.next..end, &explain, &mut self.csv)?;
        } else {
            append_csv(bench.traffic(), self.next..end, &explain, &mut self.csv)?;
        }
        self.next = end;
        Ok(Step { bytes: Vec::new(), is_last: false })
    }

    fn part(&self) -> f32 {
        self.next.saturating_sub(self.first) as f32 / self.end.saturating_sub(self.first).max(1) as f32
    }

    fn what(&self) -> String {
        "The diagnostic bundle".to_owned()
    }
}
