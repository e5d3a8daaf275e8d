//! dcon-bench: a commissioning bench for ICP DAS PIR-130 and PIR-234 modules.
//!
//! `ARCHITECTURE.md` shows the rooms and how they depend on each other.

pub mod bench;
pub mod bus;
pub mod cli;
pub mod folders;
pub mod module;
pub mod protocol;
pub mod record;
pub mod sim;
