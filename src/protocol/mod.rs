//! Bytes ↔ messages. Pure: no I/O, no clock, no knowledge of any module; no input can make it panic.

mod address;
pub mod dcon;
pub mod hex;
mod message;
pub mod modbus;
mod settings;

pub use address::{parse_address, parse_addresses};
pub use message::{AnswerFrom, Failure, Query, Reply};
pub use settings::{BaudRate, DataFormat, LineSettings, Protocol, UnknownWord};
