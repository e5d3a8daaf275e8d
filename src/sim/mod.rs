//! A simulated RS-485 line with PIR-130 and PIR-234 modules on it, which answer what their manuals say.
//!
//! Independent of the program's own DCON and Modbus on purpose: checksums, codes and texts are stated here once more
//! from the manuals, so that a mistake on either side shows. Bytes that come in cannot make it panic.
//!
//! ```text
//! SimLine, PtyServer, TcpServer --frame--> World --> Device --> dcon or modbus --> answer
//!                                                --> Guest  --> answer
//! ```
//!
//! A [`Guest`] is a module that another room brings along.

mod alarm;
mod climate;
mod comms;
mod dcon;
mod device;
mod ethernet;
mod faults;
mod guest;
mod handle;
mod identity;
mod line;
mod modbus;
mod motion;
mod outputs;
#[cfg(unix)]
mod pty;
mod refusal;
mod settings;
mod spec;
mod tcp;
mod watchdog;
mod world;

pub use faults::{Fault, FaultError, FaultKind, Faults, Injected, Strength};
pub use guest::Guest;
pub use handle::{Adapter, Sim};
pub use line::SimLine;
#[cfg(unix)]
pub use pty::PtyServer;
pub use spec::{MODBUS_ADDRESSES, Model, ModuleSpec, Placing, SWITCH_ADDRESSES, SpecError};
pub use tcp::TcpServer;
pub use world::Pace;

/// The modules of [`Sim::demo`]: both models in both protocols, and a stranger at 0x11.
pub const DEMO: &[&str] = &[
    "pir-234@1:modbus_rtu:9600",
    "pir-130@0xA0:modbus_rtu:9600",
    "pir-234@0xA3:dcon:9600",
    "pir-130@0x12:dcon:19200:checksum",
    "unknown@17:modbus_rtu:9600",
];
