//! The real window on a simulated line.

mod analog;
mod commands;
mod dashboard;
mod general;
mod harness;
mod log;
mod panes;
mod relay;
mod summary;
mod traffic;
mod watchdog;
