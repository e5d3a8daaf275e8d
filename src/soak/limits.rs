//! What must hold, in numbers, and why these.

use std::time::Duration;

/// Less would not bring a single phase with its recovery.
pub const SHORTEST_RUN: Duration = Duration::from_secs(5);
pub const LONGEST_RUN: Duration = Duration::from_secs(30 * 24 * 60 * 60);
/// A run of so long has every fault at least once.
pub const EVERY_FAULT_IN: Duration = Duration::from_secs(120);

/// How often each module is polled: what a new module gets in the window.
pub const POLL_PERIOD: Duration = crate::bench::DEFAULT_INTERVAL;
/// Pictures of the window: thirty a second are enough for an eye.
pub const FRAME: Duration = Duration::from_millis(33);

/// The window answers within 50 ms. A build without optimisation is no measure of the program that people get, so that only
/// a standstill counts there.
pub const MOST_STALL: Duration = Duration::from_millis(if cfg!(debug_assertions) { 2_000 } else { 50 });
/// A scan ends after the question under way, and polls of other modules go on question by question: three attempts of
/// 200 ms with their pauses at worst.
pub const MOST_CANCEL: Duration = Duration::from_millis(1_000);
/// A write waits for one exchange, reads first what shares the command, writes, and reads back, each with its repeats on a
/// line that may garble every answer.
pub const MOST_WRITE: Duration = Duration::from_secs(10);
/// Joining the bus thread and closing the file.
pub const MOST_QUIT: Duration = Duration::from_secs(2);
/// The first module is heard within one poll period; before that a port that was gone is looked for twice a second. A build
/// without optimisation, beside other tests, is no measure of times.
pub const MOST_LINE_RECOVERY: Duration = Duration::from_millis(if cfg!(debug_assertions) { 3_000 } else { 1_500 });
/// A module that has just fallen silent is asked at its interval, but all silent ones together have half of the line: its turn
/// comes within two poll periods. Answers that are under way when the fault ends come up to 1.5 s later, and where a module
/// cannot be asked anything else they are waited for up to 2 s.
pub const MOST_MODULE_RECOVERY: Duration = Duration::from_millis(if cfg!(debug_assertions) { 8_000 } else { 4_000 });
/// After that a module counts as lost for good, and the next phase begins.
pub const GIVE_UP_RECOVERY: Duration = Duration::from_secs(15);
/// All samples that a history holds in memory (3 million, 12 bytes each), the traffic (48 MB of bytes, 1 million frames of
/// some 50 bytes), and room for what is drawn.
pub const MOST_GROWTH: u64 = 200_000_000;

/// A value may be so much older than the end of its answer: the answer's time-out of 200 ms, within which the module has
/// answered, the time of the longest answer on the wire at 9600 bps, and the error of the estimated clock.
pub const MOST_AGE: Duration = Duration::from_millis(300);
/// The estimated clock of the line may be late by some pictures.
pub const CLOCK_ERROR: Duration = Duration::from_millis(150);
/// Details of wrong values that are told.
pub const MOST_DETAILS: usize = 20;
