//! Being asked to end: Ctrl-C and termination.

use super::Outcome;

#[cfg(unix)]
pub use unix::Interrupt;
#[cfg(windows)]
pub use windows::Interrupt;

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

#[cfg(windows)]
mod windows {
    use std::process;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;

    use super::super::stop::Stop;
    use super::Outcome;

    /// Ctrl-C, Ctrl-Break and the end of the console, once caught. A second one ends the program at once.
    pub struct Interrupt {
        came: Arc<AtomicBool>,
    }

    impl Interrupt {
        pub fn catch() -> Outcome<Self> {
            let interrupt = Self { came: Arc::new(AtomicBool::new(false)) };
            let (came, waiting) = (interrupt.came.clone(), thread::current());
            let handler = move || {
                if came.swap(true, Ordering::Relaxed) {
                    process::exit(1);
                }
                waiting.unpark();
            };
            ctrlc::set_handler(handler).map_err(|error| Stop::failed(format!("Ctrl-C cannot be caught: {error}")))?;
            Ok(interrupt)
        }

        pub fn came(&self) -> bool {
            self.came.load(Ordering::Relaxed)
        }

        /// Sleeps until it comes; for the thread that has caught it.
        pub fn wait(self) {
            while !self.came() {
                thread::park();
            }
        }
    }
}
