//! The real window on a simulated line.

mod analog;
mod commands;
mod configuration;
mod dashboard;
mod diagnosis;
mod events;
mod form;
mod general;
mod harness;
mod init;
mod log;
mod panes;
mod poll_plan;
mod recording;
mod relay;
mod summary;
mod traffic;
mod trends;
mod watchdog;
