//! What the system tells of this process: its memory, what its threads waited for, and whether one of them panicked.

use std::fs;
use std::panic;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Bytes of this process in memory; nothing is known of it but on Linux.
pub fn resident() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes.saturating_mul(1_024))
}

/// How long this thread was ready to run but had to leave the processor to others; zero where the system does not tell.
pub fn waited_for_processor() -> Duration {
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().nth(1)?.parse().ok());
    Duration::from_nanos(nanoseconds.unwrap_or_default())
}

/// Counts the panics of all threads, which are reported as ever.
#[derive(Debug, Clone, Default)]
pub struct Panics {
    count: Arc<AtomicU64>,
}

impl Panics {
    /// Counts from now on, until the process ends.
    pub fn catch() -> Self {
        let panics = Self::default();
        let count = panics.count.clone();
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            count.fetch_add(1, Ordering::Relaxed);
            before(info);
        }));
        panics
    }

    pub fn count(&self) -> u64 {
        self.count.load(Ordering::Relaxed)
    }
}
