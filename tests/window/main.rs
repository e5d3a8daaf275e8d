//! The real window on a simulated line.

mod general;
mod harness;
mod log;
mod traffic;
