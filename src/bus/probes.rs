//! How the questions that the bus asks on its own, to come into step with a module, are told from others.

use crate::protocol::{Protocol, Query};

/// What reads something harmless of any module: functions 01, 03 and 04.
pub(super) const PROBES: [Query; 3] = [
    Query::ReadCoils { first: 0, count: 1 },
    Query::ReadHoldingRegisters { first: 0, count: 1 },
    Query::ReadInputRegisters { first: 0, count: 1 },
];

/// Whether `request` looks like a question that was sent only to come into step (`resync`): a read of the very first coil
/// or register alone. A module that refuses it has refused nothing that anybody wanted. Over DCON the bus asks for the
/// module's name, which no module refuses.
pub fn may_be_probe(protocol: Protocol, request: &[u8]) -> bool {
    let first_alone = matches!(request, [_, 0x01 | 0x03 | 0x04, 0, 0, 0, 1, _, _]);
    protocol == Protocol::ModbusRtu && first_alone
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::modbus::with_crc;

    #[test]
    fn only_a_read_of_the_first_place_alone_may_be_a_probe() {
        for function in [0x01, 0x03, 0x04] {
            assert!(may_be_probe(Protocol::ModbusRtu, &with_crc(&[7, function, 0, 0, 0, 1])));
            assert!(!may_be_probe(Protocol::ModbusRtu, &with_crc(&[7, function, 0, 0, 0, 2])));
            assert!(!may_be_probe(Protocol::ModbusRtu, &with_crc(&[7, function, 0, 1, 0, 1])));
        }
        assert!(!may_be_probe(Protocol::ModbusRtu, &with_crc(&[7, 6, 0, 0, 0, 1])), "a write");
        assert!(!may_be_probe(Protocol::Dcon, b"$07M\r"));
    }
}
