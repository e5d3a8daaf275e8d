//! Somebody who listens on the simulated line and counts how often each module is told to change something.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crate::protocol::{LineSettings, modbus};
use crate::sim::Guest;

/// Modbus functions that change something.
const WRITES: [u8; 4] = [0x05, 0x06, 0x0F, 0x10];

/// What was heard; clones share it.
#[derive(Debug, Clone, Default)]
pub struct Ear {
    writes: Arc<Mutex<BTreeMap<u8, u64>>>,
}

impl Ear {
    /// How many whole Modbus writes the module at `address` has heard so far.
    pub fn writes(&self, address: u8) -> u64 {
        let writes = self.writes.lock().unwrap_or_else(PoisonError::into_inner);
        writes.get(&address).copied().unwrap_or_default()
    }

    /// Hears what is sent at this speed.
    pub fn guest(&self, settings: LineSettings) -> Listener {
        Listener { ear: self.clone(), settings }
    }

    fn hear(&self, frame: &[u8]) {
        let Some((body, _)) = frame.split_last_chunk::<2>() else { return };
        if let [address, function, ..] = *body
            && WRITES.contains(&function)
            && modbus::with_crc(body) == frame
        {
            let mut writes = self.writes.lock().unwrap_or_else(PoisonError::into_inner);
            let count = writes.entry(address).or_default();
            *count = count.saturating_add(1);
        }
    }
}

/// A guest on the line that never answers.
#[derive(Debug)]
pub struct Listener {
    ear: Ear,
    settings: LineSettings,
}

impl Guest for Listener {
    /// The address of broadcasts, at which nobody is.
    fn address(&self) -> u8 {
        0
    }

    fn settings(&self) -> LineSettings {
        self.settings
    }

    fn response_delay(&self) -> Duration {
        Duration::ZERO
    }

    fn live(&mut self, _now: Duration) {}

    fn hear(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        self.ear.hear(frame);
        None
    }

    fn power_cycle(&mut self) {}

    fn set_init(&mut self, _on: bool) {}

    fn value(&self, _id: &str) -> Option<String> {
        None
    }

    fn set_value(&mut self, _id: &str, _value: &str) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_writes_are_counted_by_module_and_nothing_else_is() {
        let ear = Ear::default();
        let write = modbus::with_crc(&[7, 6, 2, 3, 0, 10]);
        ear.hear(&write);
        ear.hear(&modbus::with_crc(&[7, 3, 2, 3, 0, 1]));
        ear.hear(write.get(..6).unwrap());
        ear.hear(b"$01M\r");
        assert_eq!((ear.writes(7), ear.writes(1)), (1, 0));
    }
}
