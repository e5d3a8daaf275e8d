//! What kind of line it is, because each has other troubles.

use std::time::Duration;

use crate::bus::NETWORK_ALLOWANCE;
use crate::protocol::Protocol;

/// How the modules are reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Medium {
    /// RS-485 behind a serial port.
    #[default]
    Wire,
    /// Modbus TCP.
    Network,
}

impl Medium {
    pub fn of(protocol: Protocol) -> Self {
        if protocol == Protocol::ModbusTcp { Self::Network } else { Self::Wire }
    }

    /// How much longer than the timeout that is set every answer is waited for.
    pub fn allowance(self) -> Duration {
        if self == Self::Network { NETWORK_ALLOWANCE } else { Duration::ZERO }
    }
}
