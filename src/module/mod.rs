//! What a module has, and how to say it in DCON and in Modbus.
//!
//! Everything about a module stands in its definition file (`assets/modules/*.toml`); this room reads those files
//! and turns questions about parameters into protocol messages and answers into values. It does no I/O with modules:
//! whoever can hold a conversation passes itself in as [`Ask`].

pub(crate) mod access;
mod adding;
mod catalogue;
mod check;
pub(crate) mod definition;
mod explain;
mod file;
mod identify;
pub(crate) mod notation;
mod read;
mod switches;
mod value;
pub(crate) mod write;

pub(crate) use access::raw_of_value;
pub use adding::{Addition, Standing};
pub use catalogue::{Catalogue, FileError, load_file};
pub use definition::{
    Access, Action, Applies, Bits, Choice, Command, CommandAccess, Definition, Encoding, Field, FillFrom, Identity,
    Item, ItemKind, Kind, ModbusPlace, Optional,
};
pub use explain::{Danger, ExplainedField, Explanation, danger, explain};
pub use identify::{Identified, identify};
pub use notation::{Fields, Template};
pub use read::{Answer, ReadPlan, ReadRun, present_options, read_items};
pub use switches::{BankState, Position, PositionState, RotaryState, SwitchLayout, SwitchPanel};
pub use value::{Fixed, Value, ValueError};
pub use write::{WriteError, check_write, moves_to, run_action, write_item};

use jiff::Timestamp;

use crate::protocol::{Failure, Query, Reply};

/// Someone who can hold a conversation with one module.
pub trait Ask {
    fn ask(&mut self, query: &Query) -> Result<Reply, Failure>;

    /// Makes certain that the answers so far belong to the questions on which they were taken.
    ///
    /// # Errors
    /// If they may not: then they must not be used.
    fn certain(&mut self) -> Result<(), Failure> {
        Ok(())
    }

    /// When the last byte of the last answer had arrived, or when the wait for it was given up.
    fn answered_at(&self) -> Timestamp;

    /// The module has been given another address: what follows is asked there.
    fn follow(&mut self, address: u8);
}
