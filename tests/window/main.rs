//! The real window on a simulated line.

mod analog;
mod bad_line;
mod commands;
mod configuration;
mod copying;
mod dashboard;
mod diagnosis;
mod dropping;
mod events;
mod faults;
mod form;
mod general;
mod harness;
mod help;
mod init;
mod log;
mod lost_line;
mod names;
mod panes;
mod poll_plan;
mod recording;
mod relay;
mod summary;
mod traffic;
mod trends;
mod watchdog;
