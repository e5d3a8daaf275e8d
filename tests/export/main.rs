//! What is recorded and taken away by the real program: it agrees with what the simulated modules were, also as other
//! programs read it.

#[path = "../common/program.rs"]
mod program;
mod usage;
#[cfg(unix)]
mod way;
