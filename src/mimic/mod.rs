//! A simulated module made from any definition file, so that a module can be tried before it is at hand.
//!
//! It says what its definition says of it: that shows whether a new file is complete and can be used, not whether it is
//! true. The modules of [`crate::sim`] are written from their manuals instead and stay independent of the definitions.
//!
//! ```text
//! Sim --frame--> Mimic --> dcon --> fields --> Store
//!                      --> modbus --> places ----^
//! ```

mod dcon;
mod fields;
mod modbus;
mod module;
mod places;
mod spec;
mod store;
mod texts;

pub use module::Mimic;
pub use spec::{MimicSpec, MimicSpecError};
