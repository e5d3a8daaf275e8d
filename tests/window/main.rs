//! The real window on a simulated line.

mod configuration;
mod general;
mod harness;
mod init;
