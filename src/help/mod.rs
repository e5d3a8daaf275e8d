//! The built-in help: what its articles say, how they are found, and what the program is built from. It needs no network.
//!
//! Articles are Markdown files in `assets/help`. What the program knows elsewhere is made from there and not written again:
//! the command reference and the switches from the definitions, troubleshooting from the diagnosis. Nothing here knows of the window.

mod library;
pub mod licences;
pub mod markdown;
pub mod reference;
mod search;
mod switches;
mod troubleshooting;

pub use library::{Article, Group, Library, commands_of, registers_of};
pub use search::{Hit, MOST_HITS};
