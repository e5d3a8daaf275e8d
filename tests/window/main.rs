//! The real window on a simulated line.

mod analog;
mod general;
mod harness;
