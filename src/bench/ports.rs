//! Which ports there are, as far as is known. The system is asked on threads of their own; what was known stays until it has
//! answered.

use std::sync::Arc;

use super::Bench;
use crate::bus::{Lookout, PortInfo, WithoutPort, adapters_without_port, ports};

pub(super) struct Ports {
    pub present: Vec<PortInfo>,
    /// What is to be known of adapters that have no port, as whole sentences.
    hints: Vec<String>,
    /// The system has answered.
    known: bool,
    look: Lookout<Vec<PortInfo>>,
    /// Of its own, because Windows tells of them much later.
    look_for_portless: Lookout<Vec<WithoutPort>>,
}

impl Default for Ports {
    fn default() -> Self {
        Self {
            present: Vec::new(),
            hints: Vec::new(),
            known: false,
            look: Lookout::new("ports", ports),
            look_for_portless: Lookout::new("adapters", adapters_without_port),
        }
    }
}

impl Ports {
    pub fn wake_with(&mut self, wake: Arc<dyn Fn() + Send + Sync>) {
        self.look.wake_with(wake.clone());
        self.look_for_portless.wake_with(wake);
    }
}

impl Bench {
    /// Lets `list` tell which ports there are, and not the system.
    pub fn with_ports(mut self, list: impl Fn() -> Vec<PortInfo> + Send + Sync + 'static) -> Self {
        self.ports.look = Lookout::new("ports", list);
        self.ports.look.wake_with(self.wake.clone());
        self
    }

    /// Those that were there when they were last looked for.
    pub fn ports(&self) -> &[PortInfo] {
        &self.ports.present
    }

    /// What is known of adapters that have no port, as whole sentences.
    pub fn port_hints(&self) -> &[String] {
        &self.ports.hints
    }

    /// Whether the ports are being looked for, so that those that are known may be others by now.
    pub fn is_looking_for_ports(&self) -> bool {
        self.ports.look.is_looking()
    }

    /// Whether the ports are being looked for, and were not known before.
    pub fn knows_no_ports_yet(&self) -> bool {
        self.is_looking_for_ports() && !self.ports.known
    }

    pub(super) fn look_for_ports(&mut self) {
        self.ports.look.look();
        self.ports.look_for_portless.look();
    }

    /// Takes note of what was seen. True if there was anything.
    pub(super) fn take_ports(&mut self) -> bool {
        let (present, portless) = (self.ports.look.take(), self.ports.look_for_portless.take());
        let changed = present.is_some() || portless.is_some();
        if let Some(portless) = portless {
            self.ports.hints = portless.iter().map(ToString::to_string).collect();
        }
        if let Some(present) = present {
            (self.ports.present, self.ports.known) = (present, true);
            if self.line.is_open() {
                self.note_adapter();
            }
        }
        changed
    }
}
