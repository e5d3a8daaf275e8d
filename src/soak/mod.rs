//! The whole program on a simulated line with every fault in turn, watched for what must hold.
//!
//! [`run`] starts a bench with its bus thread, polls 16 simulated modules, records them into a file and draws the window
//! off screen, while [`phases`] says which faults strike when. Before anything else all modules are frozen to values that
//! none of the others has, so that [`truth`], which asks the simulated modules themselves, knows of each value that the
//! program takes in whether that module ever had it. What came of it is a [`Report`].

mod ear;
mod hands;
mod limits;
mod line;
mod phases;
mod program;
mod recorded;
mod recovery;
mod report;
mod run;
mod system;
mod truth;
mod twins;
mod watch;
#[cfg(feature = "window")]
mod window;

pub use limits::{LONGEST_RUN, SHORTEST_RUN};
pub use report::{Report, Row};
pub use run::{Options, SoakError, run};
