//! Frames as packets of pcapng.

use std::borrow::Cow;
use std::io::{self, Read};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use pcap_file::DataLink;
use pcap_file::pcapng::blocks::enhanced_packet::{EnhancedPacketBlock, EnhancedPacketOption};
use pcap_file::pcapng::blocks::interface_description::{
    InterfaceDescriptionBlock, InterfaceDescriptionOption, InterfaceTsResolution,
};
use pcap_file::pcapng::blocks::opt_common::CommonOption;
use pcap_file::pcapng::blocks::section_header::{SectionHeaderBlock, SectionHeaderOption};
use pcap_file::pcapng::{Block, PcapNgReadError, PcapNgReader, PcapNgWriteError, PcapNgWriter};

use super::parts::{self, Parts};
use super::words::{self, Details};
use super::{APPLICATION, CaptureError, MOST_BYTES, pdu};
use crate::bus::{Direction, Frame, Verdict};
use crate::protocol::Protocol;

/// Which way a packet went, in its flags.
const DIRECTION_MASK: u32 = 0b11;
const INBOUND: u32 = 0b01;
const OUTBOUND: u32 = 0b10;
const CRC_ERROR: u32 = 1 << 24;
/// Bytes of a packet at most: those of a frame with the words before it.
const MOST_IN_PACKET: u32 = 128 << 10;
/// A block that is longer is not taken in.
const MOST_IN_BLOCK: usize = 1 << 20;

/// Comments of packets that are pieces of the next one, in whose place Wireshark shall find the answer alone.
const ECHO: &str = "echo of the request, before the answer in the next packet";
const BEFORE: &str = "stray bytes before the answer in the next packet";
const AFTER: &str = "stray bytes after the answer in the next packet";

/// Makes the bytes of the file.
pub(super) struct Writer {
    blocks: PcapNgWriter<Vec<u8>>,
    /// What was sent last.
    request: Vec<u8>,
}

impl Writer {
    /// The writer, and how the file begins.
    pub fn begin(line: &str) -> io::Result<(Self, Vec<u8>)> {
        let application = format!("{APPLICATION}{}", env!("CARGO_PKG_VERSION"));
        let section = SectionHeaderBlock {
            options: vec![
                SectionHeaderOption::OS(std::env::consts::OS.into()),
                SectionHeaderOption::UserApplication(application.into()),
            ],
            ..SectionHeaderBlock::default()
        };
        let mut blocks = PcapNgWriter::with_section_header(Vec::new(), section).map_err(not_written)?;
        let line: Cow<'_, str> = Cow::Borrowed(line.get(..line.floor_char_boundary(1_000)).unwrap_or_default());
        let interface = InterfaceDescriptionBlock {
            linktype: DataLink::WIRESHARK_UPPER_PDU,
            snaplen: MOST_IN_PACKET,
            options: vec![
                InterfaceDescriptionOption::IfName(line),
                InterfaceDescriptionOption::IfTsResol(InterfaceTsResolution::NANO),
            ],
        };
        blocks.write_pcapng_block(interface).map_err(not_written)?;
        let beginning = std::mem::take(blocks.get_mut());
        Ok((Self { blocks, request: Vec::new() }, beginning))
    }

    /// The packets of a frame.
    pub fn frame(&mut self, frame: &Frame) -> io::Result<Vec<u8>> {
        let bytes = frame.bytes.get(..MOST_BYTES).unwrap_or(&frame.bytes);
        let Parts { echo, before, answer, after } = parts::of(frame, bytes, &self.request);
        for (piece, comment) in [(echo, ECHO), (before, BEFORE), (after, AFTER)] {
            if !piece.is_empty() {
                self.packet(frame, piece, comment, false, 0)?;
            }
        }
        let cut = frame.bytes.len().saturating_sub(bytes.len());
        self.packet(frame, answer, &words::write(frame, &[]), true, cut)?;
        if frame.direction == Direction::Sent {
            bytes.clone_into(&mut self.request);
        }
        Ok(std::mem::take(self.blocks.get_mut()))
    }

    /// One packet; `cut` bytes of it are left out.
    fn packet(&mut self, frame: &Frame, bytes: &[u8], comment: &str, is_whole: bool, cut: usize) -> io::Result<()> {
        let mut data = pdu::head(frame, is_whole && !bytes.is_empty());
        data.extend(bytes);
        let direction = if frame.direction == Direction::Sent { OUTBOUND } else { INBOUND };
        let packet = EnhancedPacketBlock {
            interface_id: 0,
            timestamp: since_1970(frame.at),
            original_len: u32::try_from(data.len().saturating_add(cut)).unwrap_or(u32::MAX),
            data: data.into(),
            options: vec![
                EnhancedPacketOption::Common(CommonOption::Comment(comment.into())),
                EnhancedPacketOption::Flags(direction | if is_whole { crc_error(frame, bytes) } else { 0 }),
            ],
        };
        self.blocks.write_pcapng_block(packet).map_err(not_written)?;
        Ok(())
    }
}

/// The flag of a wrong CRC, which Wireshark shows also where it does not look at CRCs itself.
fn crc_error(frame: &Frame, bytes: &[u8]) -> u32 {
    let concerned = frame.protocol == Protocol::ModbusRtu && frame.direction == Direction::Received;
    if concerned && !bytes.is_empty() && !parts::is_right(bytes) { CRC_ERROR } else { 0 }
}

/// As the file counts time: in nanoseconds since 1970, until 2554.
fn since_1970(at: Timestamp) -> Duration {
    let nanoseconds = u64::try_from(at.as_nanosecond().max(0)).unwrap_or(u64::MAX);
    Duration::from_nanos(nanoseconds)
}

fn not_written(error: PcapNgWriteError) -> io::Error {
    match error {
        PcapNgWriteError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}

/// Makes frames of the packets.
pub(super) struct Reader<R: Read> {
    blocks: PcapNgReader<R>,
    /// The pieces that belong before and after the answer that is to come.
    before: Vec<u8>,
    after: Vec<u8>,
    /// Which way the last packet went, for those that do not say it.
    last: Option<Direction>,
    packets: u64,
    frames: u64,
}

/// What a packet contains.
struct Packet {
    at: Timestamp,
    direction: Option<Direction>,
    comments: Vec<String>,
    dissector: String,
    bytes: Vec<u8>,
}

impl<R: Read> Reader<R> {
    pub fn begin(from: R) -> Result<Self, CaptureError> {
        let blocks = PcapNgReader::with_capacity(from, MOST_IN_BLOCK).map_err(|error| damaged(error, 0))?;
        Ok(Self { blocks, before: Vec::new(), after: Vec::new(), last: None, packets: 0, frames: 0 })
    }

    pub fn next_frame(&mut self) -> Result<Option<Frame>, CaptureError> {
        while let Some(packet) = self.next_packet()? {
            if !self.take_piece(&packet)?
                && let Some(frame) = self.frame(packet)
            {
                self.last = Some(frame.direction);
                self.frames = self.frames.saturating_add(1);
                return Ok(Some(frame));
            }
        }
        match (self.packets, self.frames) {
            _ if !self.before.is_empty() || !self.after.is_empty() => Err(CaptureError::Cut),
            (packets @ 1.., 0) => Err(CaptureError::NothingKnown { packets }),
            _ => Ok(None),
        }
    }

    /// The next packet of a link type that is known.
    fn next_packet(&mut self) -> Result<Option<Packet>, CaptureError> {
        loop {
            let place = self.blocks.bytes_parsed();
            let Some(next) = self.blocks.next_block() else { return Ok(None) };
            let (block, state) = next.map_err(|error| damaged(error, place))?;
            let Block::EnhancedPacket(block) = block else { continue };
            self.packets = self.packets.saturating_add(1);
            let interface = usize::try_from(block.interface_id).ok().and_then(|id| state.interfaces().get(id));
            let Some(link_type) = interface.map(|interface| interface.linktype) else { continue };
            let at = SignedDuration::try_from(block.timestamp).ok().and_then(|at| Timestamp::from_duration(at).ok());
            let at = at.ok_or_else(|| damage(place, "a packet has an impossible time"))?;
            let (dissector, bytes) = match link_type {
                DataLink::WIRESHARK_UPPER_PDU => {
                    pdu::open(&block.data).ok_or_else(|| damage(place, "the words before a packet do not end"))?
                }
                DataLink::USER0 => (pdu::MODBUS_RTU.to_owned(), &*block.data),
                _ => continue,
            };
            let bytes = bytes.get(..MOST_BYTES).unwrap_or(bytes).to_vec();
            let (direction, comments) = options(&block.options);
            return Ok(Some(Packet { at, direction, comments, dissector, bytes }));
        }
    }

    /// True if the packet is a piece of the next one.
    fn take_piece(&mut self, packet: &Packet) -> Result<bool, CaptureError> {
        let is = |words: &str| packet.comments.iter().any(|comment| comment == words);
        let place = if is(ECHO) || is(BEFORE) {
            &mut self.before
        } else if is(AFTER) {
            &mut self.after
        } else {
            return Ok(false);
        };
        place.extend(&packet.bytes);
        if place.len() > MOST_BYTES {
            let place = self.blocks.bytes_parsed();
            return Err(damage(place, "more stray bytes than a frame can have"));
        }
        Ok(true)
    }

    /// `None` if the packet is of another protocol.
    fn frame(&mut self, packet: Packet) -> Option<Frame> {
        let Packet { at, direction, comments, dissector, bytes } = packet;
        let direction = direction
            .unwrap_or_else(|| if self.last == Some(Direction::Sent) { Direction::Received } else { Direction::Sent });
        let own = comments.iter().find_map(|comment| words::read(comment));
        let details = own.or_else(|| guessed(&dissector, direction, &bytes))?;
        let mut whole = std::mem::take(&mut self.before);
        whole.extend(bytes);
        whole.append(&mut self.after);
        whole.truncate(MOST_BYTES);
        Some(details.into_frame(at, direction, whole))
    }
}

fn options(options: &[EnhancedPacketOption<'_>]) -> (Option<Direction>, Vec<String>) {
    let mut direction = None;
    let mut comments = Vec::new();
    for option in options {
        match option {
            EnhancedPacketOption::Flags(flags) => {
                direction = match flags & DIRECTION_MASK {
                    INBOUND => Some(Direction::Received),
                    OUTBOUND => Some(Direction::Sent),
                    _ => None,
                }
            }
            EnhancedPacketOption::Common(CommonOption::Comment(comment)) => comments.push(comment.to_string()),
            _ => {}
        }
    }
    (direction, comments)
}

/// What the bytes themselves tell of a frame that another program has captured.
fn guessed(dissector: &str, direction: Direction, bytes: &[u8]) -> Option<Details> {
    let (protocol, address) = match dissector {
        pdu::MODBUS_RTU => (Protocol::ModbusRtu, bytes.first()),
        pdu::MODBUS_TCP => (Protocol::ModbusTcp, bytes.get(6)),
        _ => return None,
    };
    let function = match protocol {
        Protocol::ModbusTcp => bytes.get(7),
        _ => bytes.get(1),
    };
    let verdict = match direction {
        Direction::Sent => Verdict::Request,
        Direction::Received if protocol == Protocol::ModbusRtu && !parts::is_right(bytes) => {
            Verdict::Broken("wrong CRC".to_owned())
        }
        Direction::Received if function.is_some_and(|function| function & 0x80 != 0) => Verdict::Refusal,
        Direction::Received => Verdict::Answer,
    };
    let address = address.copied().filter(|address| *address != 0);
    Some(Details { address, ..Details::bare(protocol, verdict) })
}

fn damaged(error: PcapNgReadError, place: u64) -> CaptureError {
    match error {
        PcapNgReadError::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => CaptureError::Cut,
        PcapNgReadError::Io(error) => CaptureError::Io(error),
        other => damage(place, &other.to_string()),
    }
}

fn damage(place: u64, reason: &str) -> CaptureError {
    CaptureError::Damaged { place: format!("byte {place}"), reason: reason.to_owned() }
}
