//! What stands beneath the view of commands: typed commands and what exactly they put on the wire, scripts, raw Modbus
//! by function and register, the reference of a module's commands, and what was sent before. Pure: no I/O, no clock;
//! only `session` speaks to the bus, for repeated commands and scripts.

mod command;
mod exchange;
mod history;
mod modbus_form;
mod pattern;
mod reference;
mod reference_field;
mod register_table;
mod script;
mod script_run;
mod session;

pub use command::{Hint, RawCommand, check_typed};
pub use exchange::{EXCHANGES_KEPT, Exchange, ExchangeLog, RepeatPlan};
pub use history::{HISTORY_KEPT, History};
pub use modbus_form::{FormFunction, ModbusForm, Numbering};
pub use reference::{Direction, ReferenceEntry, recognise, reference, search};
pub use reference_field::{FieldChoice, FieldDefault, FieldPart, ReferenceField};
pub use register_table::{RegisterEntry, Space, describe_registers, register_table, search_registers};
pub use script::{Script, ScriptError, ScriptHint};
pub use script_run::{Progress, ScriptRun, Step};
pub use session::{Console, Repeating, Running};
