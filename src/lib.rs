//! dcon-bench: a commissioning bench for ICP DAS PIR-130 and PIR-234 modules.
//!
//! `ARCHITECTURE.md` shows the rooms and how they depend on each other.

#![forbid(unsafe_code)]
// Nothing from outside may panic: bytes, files, arguments and answers are taken apart with `get` and `?` only.
#![cfg_attr(
    not(test),
    warn(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::todo,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

pub mod bench;
pub mod bus;
pub mod capture;
pub mod cli;
pub mod diagnosis;
#[cfg(feature = "window")]
pub mod errors;
pub mod folders;
pub mod help;
pub mod line;
pub mod mimic;
pub mod module;
pub mod picture;
pub mod protocol;
pub mod record;
#[cfg(feature = "window")]
pub mod renderer;
pub mod sim;
pub mod soak;
#[cfg(feature = "window")]
pub mod ui;
pub mod version;
