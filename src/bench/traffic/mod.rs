//! All that passed the line, kept in little room: the log, views of it through a filter, and files made of it.
//!
//! The log grows while views stand still: a view that is not advanced is paused.

mod export;
mod filter;
mod log;

pub use export::{append_csv, write_csv, write_json_lines};
pub use filter::{FilteredTraffic, FrameFilter};
pub use log::{FrameRef, Outcome, TrafficLog};

use crate::bus::Direction;
use crate::module::{Definition, Explanation, explain};

/// What `frame` means to a module of this definition; `request` is the one that it answers
/// ([`TrafficLog::request_of`]).
pub fn explain_frame(
    frame: &FrameRef<'_>,
    request: Option<&FrameRef<'_>>,
    definition: Option<&Definition>,
) -> Explanation {
    let FrameRef { protocol, checksum, bytes, .. } = *frame;
    match frame.direction {
        Direction::Sent => explain(definition, protocol, checksum, bytes, None),
        Direction::Received => {
            let request = request.map_or(&[][..], |request| request.bytes);
            explain(definition, protocol, checksum, request, Some(bytes))
        }
    }
}

#[cfg(test)]
mod tests;
