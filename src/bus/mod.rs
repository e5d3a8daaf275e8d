//! One conversation at a time, in time: a background thread owns the port, everyone else sends it [`BusCommand`]s and
//! receives [`BusEvent`]s.
//!
//! From the wire upwards: [`line`] (bytes and a clock), `judge` (what came back), [`transaction`] (one exchange),
//! `codec` and `tcp` (Modbus), [`dialogue`] (questions to a module), [`scan`], `schedule` (whose turn it is
//! to be polled), and `worker`, which decides what is asked next.

mod adapters;
#[cfg(any(windows, test))]
mod asked;
mod client;
mod codec;
pub mod dialogue;
mod judge;
mod latency;
mod lookout;
mod message;
mod name;
mod ports;
mod probes;
mod problem;
mod repeat;
mod resync;
pub mod scan;
mod schedule;
mod serial;
mod tap;
mod target;
mod tcp;
pub mod transaction;
mod watch;
mod worker;

pub use crate::line;
pub use adapters::{NoPort, WithoutPort, adapters_without_port};
pub use client::{Bus, BusGone};
pub use latency::LatencyTimer;
pub use lookout::Lookout;
pub use message::{Answer, BusCommand, BusEvent, ItemSet, RawRequest, RequestId, Statistics, Values};
pub use ports::{KnownPort, ListPorts, PortInfo, UsbIdentity, ports};
pub use probes::may_be_probe;
pub use problem::{LineProblem, Obstacle, ProblemKind};
pub use scan::{ScanPlan, ScanProgress, ScanSummary};
pub use serial::port_name;

pub use tap::{Direction, Frame, Tap, UNASKED, Verdict};
pub use target::{LineAddress, MODBUS_TCP_PORT, Patience, Target, Tuning};
pub use tcp::NETWORK_ALLOWANCE;
