//! Commands that wait for their turn.

use std::collections::VecDeque;

use super::super::message::{BusCommand, RequestId};
use super::super::target::Target;

/// Writes before everything else; but opening or closing a line is a wall that nothing passes.
#[derive(Default)]
pub struct Queue {
    urgent: VecDeque<BusCommand>,
    others: VecDeque<BusCommand>,
}

impl Queue {
    pub fn push(&mut self, command: BusCommand) {
        let wall = |command: &BusCommand| matches!(command, BusCommand::Open { .. } | BusCommand::Close { .. });
        let urgent = matches!(command, BusCommand::Write { .. } | BusCommand::Act { .. } | BusCommand::Repeat { .. });
        if urgent && !self.others.iter().any(wall) {
            self.urgent.push_back(command);
        } else {
            self.others.push_back(command);
        }
    }

    pub fn urgent(&mut self) -> Option<BusCommand> {
        self.urgent.pop_front()
    }

    pub fn next(&mut self) -> Option<BusCommand> {
        self.others.pop_front()
    }

    pub fn has_scan(&self) -> bool {
        self.others.iter().any(|command| matches!(command, BusCommand::Scan { .. }))
    }

    /// Takes out the scans that have not begun.
    pub fn take_scans(&mut self) -> Vec<RequestId> {
        let mut taken = Vec::new();
        self.others.retain(|command| match command {
            BusCommand::Scan { id, .. } => {
                taken.push(*id);
                false
            }
            BusCommand::PauseScan(_) => false,
            _ => true,
        });
        taken
    }

    /// Forgets everything that only reads.
    pub fn forget_reads(&mut self) {
        let reads = |command: &BusCommand| {
            matches!(command, BusCommand::Identify { .. } | BusCommand::Read { .. } | BusCommand::Watch { .. })
        };
        self.others.retain(|command| !reads(command));
    }

    /// Forgets repetitions that have not begun.
    pub fn forget_repeats(&mut self, target: &Target, action: &str) {
        let meant = |command: &BusCommand| matches!(command, BusCommand::Repeat { target: at, action: known, .. } if at == target && known == action);
        self.urgent.retain(|command| !meant(command));
        self.others.retain(|command| !meant(command));
    }

    /// Forgets watches of `target` that have not begun.
    pub fn forget_watches(&mut self, target: &Target) {
        self.others
            .retain(|command| !matches!(command, BusCommand::Watch { target: waiting, .. } if waiting == target));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::LineAddress;
    use crate::module::Catalogue;
    use crate::protocol::{LineSettings, Protocol};

    fn target() -> Target {
        Target { address: 1, protocol: Protocol::Dcon, settings: LineSettings::default(), checksum: false }
    }

    fn act() -> BusCommand {
        let definition = Catalogue::built_in().0.get("pir-234").unwrap();
        BusCommand::Act { id: RequestId(2), target: target(), definition, action: "clear_alarm".into() }
    }

    #[test]
    fn a_write_goes_before_reads_but_not_before_the_opening_of_its_line() {
        let mut queue = Queue::default();
        queue.push(BusCommand::Identify { id: RequestId(1), target: target() });
        queue.push(act());
        assert!(matches!(queue.urgent(), Some(BusCommand::Act { .. })));
        queue.push(BusCommand::Open {
            id: RequestId(3),
            line: LineAddress::tcp("localhost").unwrap(),
            settings: LineSettings::default(),
        });
        queue.push(act());
        assert!(queue.urgent().is_none());
        let order: Vec<_> = std::iter::from_fn(|| queue.next()).collect();
        assert!(matches!(
            order.as_slice(),
            [BusCommand::Identify { .. }, BusCommand::Open { .. }, BusCommand::Act { .. }]
        ));
    }
}
