//! The real window on a simulated line.

mod commands;
mod general;
mod harness;
