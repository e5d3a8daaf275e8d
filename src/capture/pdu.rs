//! The packets of link type `WIRESHARK_UPPER_PDU`: words about the content, each with a tag and a length, then the content
//! (<https://www.tcpdump.org/linktypes/LINKTYPE_WIRESHARK_UPPER_PDU.html>).

use crate::bus::{Direction, Frame};
use crate::protocol::Protocol;

const END: u16 = 0;
/// The dissector that is to decode the content.
const DISSECTOR: u16 = 12;
const IPV4_SOURCE: u16 = 20;
const IPV4_DESTINATION: u16 = 21;
const PORT_TYPE: u16 = 24;
const SOURCE_PORT: u16 = 25;
const DESTINATION_PORT: u16 = 26;
/// What stands in the column "Protocol" where the dissector writes nothing there.
const PROTOCOL_COLUMN: u16 = 33;

/// "TCP", of which the dissectors of Modbus want to know the ports.
const PORT_TYPE_TCP: u32 = 2;
/// The modules' port for each protocol. By it Wireshark tells requests from answers: for Modbus TCP at once, for Modbus RTU
/// when it is told so (`mbrtu.tcp.port:5020`), otherwise it goes by the content.
const MODBUS_TCP_PORT: u32 = 502;
const MODBUS_RTU_PORT: u32 = 5_020;
const OWN_PORT: u32 = 50_000;
/// This computer; modules are 0.0.0.ADDRESS, which no real computer is.
const OWN_ADDRESS: [u8; 4] = [127, 0, 0, 1];
/// Everybody, or nobody knows who.
const ANY_ADDRESS: [u8; 4] = [255; 4];

pub(super) const MODBUS_RTU: &str = "mbrtu";
pub(super) const MODBUS_TCP: &str = "mbtcp";
const TEXT: &str = "data-text-lines";
const BYTES: &str = "data";

/// The words before the content. What is not `whole` is a piece that makes no sense alone.
pub(super) fn head(frame: &Frame, is_whole: bool) -> Vec<u8> {
    let mut head = Vec::new();
    let dissector = match frame.protocol {
        _ if !is_whole => BYTES,
        Protocol::ModbusRtu => MODBUS_RTU,
        Protocol::ModbusTcp => MODBUS_TCP,
        Protocol::Dcon => TEXT,
    };
    put(&mut head, DISSECTOR, dissector.as_bytes());
    if frame.protocol == Protocol::Dcon || !is_whole {
        put(&mut head, PROTOCOL_COLUMN, frame.protocol.label().as_bytes());
    }
    let module = frame.address.map_or(ANY_ADDRESS, |address| [0, 0, 0, address]);
    let port = if frame.protocol == Protocol::ModbusTcp { MODBUS_TCP_PORT } else { MODBUS_RTU_PORT };
    let [from, to] = match frame.direction {
        Direction::Sent => [(OWN_ADDRESS, OWN_PORT), (module, port)],
        Direction::Received => [(module, port), (OWN_ADDRESS, OWN_PORT)],
    };
    put(&mut head, IPV4_SOURCE, &from.0);
    put(&mut head, IPV4_DESTINATION, &to.0);
    put(&mut head, PORT_TYPE, &PORT_TYPE_TCP.to_be_bytes());
    put(&mut head, SOURCE_PORT, &from.1.to_be_bytes());
    put(&mut head, DESTINATION_PORT, &to.1.to_be_bytes());
    put(&mut head, END, &[]);
    head
}

/// Adds a word, filled up to a multiple of four bytes.
fn put(head: &mut Vec<u8>, tag: u16, value: &[u8]) {
    let padded = value.len().next_multiple_of(4);
    head.extend(tag.to_be_bytes());
    head.extend(u16::try_from(padded).unwrap_or_default().to_be_bytes());
    head.extend(value);
    head.extend(std::iter::repeat_n(0, padded.saturating_sub(value.len())));
}

/// The dissector's name and the content; `None` if the words do not end.
pub(super) fn open(packet: &[u8]) -> Option<(String, &[u8])> {
    let mut dissector = String::new();
    let mut rest = packet;
    loop {
        let (tag, after) = rest.split_first_chunk::<2>()?;
        let (length, after) = after.split_first_chunk::<2>()?;
        let (value, after) = after.split_at_checked(usize::from(u16::from_be_bytes(*length)))?;
        match u16::from_be_bytes(*tag) {
            END => return Some((dissector, after)),
            DISSECTOR => dissector = String::from_utf8_lossy(value).trim_end_matches('\0').to_owned(),
            _ => {}
        }
        rest = after;
    }
}
