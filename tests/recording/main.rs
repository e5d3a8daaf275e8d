//! Recordings as a whole: written by the recorder, read by the program and by others, through everything that can
//! happen.

mod common;
mod damaged;
mod files;
mod growing;
mod kill;
mod problems;
mod readers;
