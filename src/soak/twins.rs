//! When and where two modules shared an address.
//!
//! Answers of the two that do not overlap are whole and right, and nobody can tell from one of them which of the two it is
//! from. So a value that comes from such an address while it is shared is not called wrong: it was answered by the other
//! module at the same address, and is counted as that.

use crate::record::Micros;
use crate::sim::{FaultKind, Faults, Strength};

/// Addresses that were shared, with the time on the line's clock.
#[derive(Debug, Default)]
pub struct Twins {
    times: Vec<(u8, Micros, Option<Micros>)>,
}

/// A value that was answered before the end may be told some time after it.
const MARGIN: Micros = 500_000;

impl Twins {
    /// What goes wrong from `at` on, on the line's clock.
    pub fn note(&mut self, faults: &Faults, at: Micros) {
        for (_, _, end) in self.times.iter_mut().filter(|(_, _, end)| end.is_none()) {
            *end = Some(at.saturating_add(MARGIN));
        }
        if let Some(Strength::Address(address)) = faults.get(FaultKind::Twin) {
            self.times.push((address, at.saturating_sub(MARGIN), None));
        }
    }

    /// Whether two modules shared the address at that time.
    pub fn shared(&self, address: u8, at: Micros) -> bool {
        let inside = |&(twin, from, to): &(u8, Micros, Option<Micros>)| {
            twin == address && from <= at && to.is_none_or(|to| at <= to)
        };
        self.times.iter().any(inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Fault;

    #[test]
    fn an_address_is_shared_from_the_fault_to_its_end_and_no_other_is() {
        let (mut twins, mut faults) = (Twins::default(), Faults::default());
        faults.set(Fault { kind: FaultKind::Twin, strength: Strength::Address(3) }).unwrap();
        twins.note(&faults, 10_000_000);
        assert!(twins.shared(3, 12_000_000) && !twins.shared(4, 12_000_000));
        twins.note(&Faults::default(), 20_000_000);
        assert!(twins.shared(3, 20_100_000) && !twins.shared(3, 21_000_000) && !twins.shared(3, 9_000_000));
    }
}
