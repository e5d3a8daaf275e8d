//! The real window on a simulated line.

mod analog;
mod dashboard;
mod general;
mod harness;
mod panes;
mod relay;
mod watchdog;
