//! A place on the line for modules that are made elsewhere.

use std::fmt::Debug;
use std::time::Duration;

use crate::protocol::LineSettings;

/// A module on the simulated line that this room knows nothing of: it only passes on what is heard and said.
pub trait Guest: Debug + Send {
    /// Where it answers, as a program sees it.
    fn address(&self) -> u8;

    /// The speed and format at which it hears.
    fn settings(&self) -> LineSettings;

    /// What it waits before it answers, beyond the turnaround of every module.
    fn response_delay(&self) -> Duration;

    /// Lives on until `now`, counted from when the line began.
    fn live(&mut self, now: Duration);

    /// The answer to a frame, if it is for this module and there is one.
    fn hear(&mut self, frame: &[u8]) -> Option<Vec<u8>>;

    /// Off and on again: what is stored comes into force.
    fn power_cycle(&mut self);

    /// In INIT mode speed, format, checksum and protocol can be stored.
    fn set_init(&mut self, on: bool);

    /// What it has stored, or shows, by the public name of a parameter or reading; nothing if it has no such.
    fn value(&self, id: &str) -> Option<String>;

    /// Lets it hold or show `value` from now on; false if it has no such item or that takes no such value.
    fn set_value(&mut self, id: &str, value: &str) -> bool;
}

/// A guest and whether its wire is cut.
#[derive(Debug)]
pub(super) struct Seat {
    pub guest: Box<dyn Guest>,
    pub dead: bool,
}
