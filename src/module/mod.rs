//! What a module has, and how to say it in DCON and in Modbus.
//!
//! Everything about a module stands in its definition file (`assets/modules/*.toml`); this room reads those files
//! and turns questions about parameters into protocol messages and answers into values. It does no I/O with modules:
//! whoever can hold a conversation passes itself in as [`Ask`].

mod access;
mod catalogue;
mod check;
mod definition;
mod file;
mod identify;
mod notation;
mod read;
mod switches;
mod value;
mod write;

pub use catalogue::{Catalogue, FileError, add_file};
pub use definition::{
    Access, Action, Applies, Choice, Command, Definition, Field, Identity, Item, ItemKind, Kind, ModbusPlace, Optional,
};
pub use identify::{Identified, identify};
pub use notation::Template;
pub use read::{ReadPlan, ReadRun, present_options, read_items};
pub use switches::{BankState, Position, PositionState, RotaryState, SwitchLayout, SwitchPanel};
pub use value::{Fixed, Value, ValueError};
pub use write::{WriteError, check_write, moves_to, run_action, write_item};

use crate::protocol::{Failure, Query, Reply};

/// Someone who can hold a conversation with one module.
pub trait Ask {
    fn ask(&mut self, query: &Query) -> Result<Reply, Failure>;

    /// The module has been given another address: what follows is asked there.
    fn follow(&mut self, address: u8);
}
