//! A line that does what the fuzzer's bytes say, in virtual time.
//!
//! Each request takes steps from the bytes until one that ends them; what was not received stays on the line, so that
//! answers can be late.
//!
//! | step | what happens |
//! |---|---|
//! | `00` to `3F` | nothing for so many times 4 ms |
//! | `40` to `7F` | so many of the next bytes come |
//! | `80` | the right answer comes |
//! | `81 n` | its first n bytes come |
//! | `82 n` | it comes with bit n flipped |
//! | `83 n` | it comes from address n, with a right check sum |
//! | `84` | the request's echo comes |
//! | `85 n` | the first n bytes of the echo come |
//! | `86 n` | noise comes for n times 16 ms, a byte each time |
//! | `87` | an exception, or a refusal, comes |
//! | `C0` to `FE` | the request has had its steps |
//! | `FF` | the adapter disappears |

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use dcon_bench::bus::line::{Line, LineLost};
use dcon_bench::protocol::LineSettings;

use crate::{sums, take_byte, take_bytes};

/// See the module.
pub struct Scripted {
    now: Instant,
    steps: Vec<u8>,
    incoming: VecDeque<(Instant, u8)>,
    lost: bool,
    dcon: bool,
    checksum: bool,
}

impl Scripted {
    pub fn new(steps: &[u8], dcon: bool, checksum: bool) -> Self {
        let now = Instant::now();
        Self { now, steps: steps.to_vec(), incoming: VecDeque::new(), lost: false, dcon, checksum }
    }

    fn play(&mut self, request: &[u8]) {
        let steps = std::mem::take(&mut self.steps);
        let mut rest = steps.as_slice();
        let mut at = self.now;
        while !rest.is_empty() {
            let step = take_byte(&mut rest);
            let mut bytes = Vec::new();
            match step {
                0x00..=0x3F => at += Duration::from_millis(4 * u64::from(step)),
                0x40..=0x7F => bytes = take_bytes(&mut rest, usize::from(step & 0x3F)).to_vec(),
                0x81 => bytes = first(self.answer(request, None), take_byte(&mut rest)),
                0x82 => bytes = flipped(self.answer(request, None), take_byte(&mut rest)),
                0x83 => bytes = self.answer(request, Some(take_byte(&mut rest))),
                0x84 => bytes = request.to_vec(),
                0x85 => bytes = first(request.to_vec(), take_byte(&mut rest)),
                0x86 => {
                    for place in 0..take_byte(&mut rest) {
                        at += Duration::from_millis(16);
                        self.incoming.push_back((at, if place % 3 == 0 { 0x5A } else { 0xFF }));
                    }
                }
                0x87 => bytes = self.refusal(request),
                0x80..=0xBF => bytes = self.answer(request, None),
                0xC0..=0xFE => break,
                0xFF => {
                    self.lost = true;
                    break;
                }
            }
            self.incoming.extend(bytes.into_iter().map(|byte| (at, byte)));
        }
        self.incoming.make_contiguous().sort_by_key(|(at, _)| *at);
        self.steps = rest.to_vec();
    }

    fn answer(&self, request: &[u8], address: Option<u8>) -> Vec<u8> {
        if self.dcon {
            let asked =
                request.get(1..3).map(|digits| String::from_utf8_lossy(digits).into_owned()).unwrap_or_default();
            let from = address.map_or(asked, |address| format!("{address:02X}"));
            return self.dcon_frame(&format!("!{from}PIR130"));
        }
        let at = |index: usize| request.get(index).copied().unwrap_or_default();
        let count = usize::from(u16::from_be_bytes([at(4), at(5)]));
        let head = [address.unwrap_or(at(0)), at(1)];
        let data = match at(1) {
            1 | 2 => counted(count.div_ceil(8)),
            3 | 4 => counted(count * 2),
            5 | 6 | 15 | 16 => request.get(2..6).unwrap_or_default().to_vec(),
            0x46 if matches!(at(2), 5 | 6) => vec![at(2), 0, 6, 0, 0, 0, 1, 0, 0],
            0x46 if at(2) == 0x20 => vec![0x20, 1, 0, 0],
            0x46 => vec![0, 0x54, 0x20, 0x26, 0],
            _ => vec![1, 2, 3],
        };
        sums::with_crc(&[&head, data.as_slice()].concat())
    }

    fn refusal(&self, request: &[u8]) -> Vec<u8> {
        if self.dcon {
            let asked = String::from_utf8_lossy(request.get(1..3).unwrap_or_default());
            return self.dcon_frame(&format!("?{asked}"));
        }
        let at = |index: usize| request.get(index).copied().unwrap_or_default();
        sums::with_crc(&[at(0), at(1) | 0x80, 2])
    }

    fn dcon_frame(&self, text: &str) -> Vec<u8> {
        let sum = if self.checksum { sums::dcon(text.as_bytes()).to_vec() } else { Vec::new() };
        [text.as_bytes(), &sum, b"\r"].concat()
    }

    fn check(&self) -> Result<(), LineLost> {
        if self.lost { Err(LineLost::new("unplugged")) } else { Ok(()) }
    }
}

/// A count of bytes, and so many bytes.
fn counted(count: usize) -> Vec<u8> {
    std::iter::once(count as u8).chain((0..count).map(|place| place as u8)).collect()
}

fn first(mut bytes: Vec<u8>, count: u8) -> Vec<u8> {
    bytes.truncate(usize::from(count));
    bytes
}

fn flipped(mut bytes: Vec<u8>, bit: u8) -> Vec<u8> {
    let bit = usize::from(bit) % (bytes.len() * 8).max(1);
    if let Some(byte) = bytes.get_mut(bit / 8) {
        *byte ^= 1 << (bit % 8);
    }
    bytes
}

impl Line for Scripted {
    fn configure(&mut self, _: LineSettings) -> Result<(), LineLost> {
        self.purge()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        self.check()?;
        self.play(bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        self.check()?;
        match self.incoming.front() {
            Some((at, _)) if *at <= self.now.max(deadline) => self.now = self.now.max(*at),
            _ => self.now = self.now.max(deadline),
        }
        let mut count = 0;
        while count < buffer.len() && self.incoming.front().is_some_and(|(at, _)| *at <= self.now) {
            buffer[count] = self.incoming.pop_front().map(|(_, byte)| byte).unwrap_or_default();
            count += 1;
        }
        Ok(count)
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.check()?;
        let now = self.now;
        self.incoming.retain(|(at, _)| *at > now);
        Ok(())
    }

    fn look(&mut self) -> Result<(), LineLost> {
        self.check()
    }

    fn now(&self) -> Instant {
        self.now
    }

    fn wait_until(&mut self, instant: Instant) {
        self.now = self.now.max(instant);
    }
}
