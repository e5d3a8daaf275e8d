//! Being asked to end: Ctrl-C and termination.

use super::Outcome;

#[cfg(not(unix))]
pub use elsewhere::Interrupt;
#[cfg(unix)]
pub use unix::Interrupt;

#[cfg(unix)]
mod unix {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    use super::super::stop::Stop;
    use super::Outcome;

    /// SIGINT, SIGTERM and SIGHUP (the terminal was closed), once caught. A second one ends the program at once.
    pub struct Interrupt {
        came: Arc<AtomicBool>,
        signals: Signals,
    }

    impl Interrupt {
        pub fn catch() -> Outcome<Self> {
            let failed = |error| Stop::failed(format!("signals cannot be caught: {error}"));
            let came = Arc::new(AtomicBool::new(false));
            for signal in [SIGHUP, SIGINT, SIGTERM] {
                // In this order: the first signal finds the flag not yet set.
                signal_hook::flag::register_conditional_shutdown(signal, 1, came.clone()).map_err(failed)?;
                signal_hook::flag::register(signal, came.clone()).map_err(failed)?;
            }
            Ok(Self { came, signals: Signals::new([SIGHUP, SIGINT, SIGTERM]).map_err(failed)? })
        }

        pub fn came(&self) -> bool {
            self.came.load(Ordering::Relaxed)
        }

        /// Sleeps until it comes.
        pub fn wait(mut self) {
            self.signals.forever().next();
        }
    }
}

#[cfg(not(unix))]
mod elsewhere {
    use super::Outcome;

    /// Nothing to be caught: the system ends the program.
    pub struct Interrupt;

    impl Interrupt {
        pub fn catch() -> Outcome<Self> {
            Ok(Self)
        }

        pub fn came(&self) -> bool {
            false
        }

        /// Sleeps for ever.
        pub fn wait(self) {
            loop {
                std::thread::park();
            }
        }
    }
}
