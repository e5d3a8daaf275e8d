//! What stands in the columns that several lists have, and what their filters do.

pub const TIME: &str = "When it began on the line, or happened";
pub const DIRECTION: &str = "To a module, or from one";
pub const ADDRESS: &str = "Of the module that is meant";
pub const BYTES: &str = "As they went over the line: text for DCON, hexadecimal for Modbus";
pub const MEANING: &str = "What the frame says, by the definitions of the modules";
pub const TOOK: &str =
    "Of a request the time on the wire, of an answer the time from the request's end to the answer's";
pub const STATE: &str = "Whether the frame is whole, right and answered";
pub const MODULE: &str = "Where it happened";
pub const KIND: &str = "What kind of event it is";
pub const EVENT: &str = "What happened";
pub const EVENT_OR_MEANING: &str = "What happened, or what the frame says";

pub const ONLY_ERRORS: &str = "Only refusals, answers that cannot be used, and those that did not come";
pub const ONLY_KIND: &str = "Only events of this kind; several add up, none is all";
