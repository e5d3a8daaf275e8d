//! The module itself: how it is reached, and what it holds.

use std::sync::Arc;
use std::time::Duration;

use super::store::Store;
use super::{dcon, modbus};
use crate::module::{Definition, Value};
use crate::protocol::{LineSettings, Protocol};
use crate::sim::{Guest, Placing};

/// What takes effect at the next power-on only.
#[derive(Debug, Clone, Copy)]
struct Language {
    protocol: Protocol,
    settings: LineSettings,
    checksum: bool,
}

/// A simulated module that is what its definition says.
///
/// Values begin at their factory setting, or at something plausible; live numbers run slowly within their range. It has
/// all optional parts of its definition, and no Ethernet.
#[derive(Debug)]
pub struct Mimic {
    store: Store,
    address: u8,
    in_force: Language,
}

impl Mimic {
    pub fn new(definition: Arc<Definition>, placing: Placing) -> Self {
        let Placing { address, protocol, settings, checksum, .. } = placing;
        Self { store: Store::new(definition, placing), address, in_force: Language { protocol, settings, checksum } }
    }

    /// The word that the item `id` holds, read as what it is.
    fn stored<T: std::str::FromStr>(&self, id: &str) -> Option<T> {
        self.store.value_of(id)?.to_string().parse().ok()
    }
}

impl Guest for Mimic {
    fn address(&self) -> u8 {
        self.address
    }

    fn settings(&self) -> LineSettings {
        self.in_force.settings
    }

    fn response_delay(&self) -> Duration {
        Duration::from_millis(self.stored::<u16>("response_delay").unwrap_or(0).min(1000).into())
    }

    fn live(&mut self, now: Duration) {
        self.store.live(now);
    }

    fn hear(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        match self.in_force.protocol {
            Protocol::Dcon => dcon::hear(&mut self.store, &mut self.address, self.in_force.checksum, frame),
            Protocol::ModbusRtu | Protocol::ModbusTcp => modbus::hear(&mut self.store, &mut self.address, frame),
        }
    }

    fn power_cycle(&mut self) {
        let Language { protocol, settings, checksum } = self.in_force;
        self.in_force = Language {
            protocol: self.stored("protocol").unwrap_or(protocol),
            settings: LineSettings {
                baud_rate: self.stored("baud_rate").unwrap_or(settings.baud_rate),
                data_format: self.stored("data_format").unwrap_or(settings.data_format),
            },
            checksum: self.store.value_of("checksum").and_then(|value| value.as_bool()).unwrap_or(checksum),
        };
        self.store.power_on();
    }

    fn set_init(&mut self, on: bool) {
        self.store.init = on;
    }

    fn value(&self, id: &str) -> Option<String> {
        self.store.value_of(id).map(|value: Value| value.to_string())
    }

    fn set_value(&mut self, id: &str, value: &str) -> bool {
        let taken = self.store.set_text(id, value);
        self.address = dcon::address_in(&self.store).unwrap_or(self.address);
        taken
    }
}
