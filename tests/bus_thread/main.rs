//! The bus thread from outside: commands in, events out, on simulated lines.

mod faults;
mod harness;
mod line;
mod network;
mod raw;
mod repeating;
mod scanning;
mod watching;
mod writing;
