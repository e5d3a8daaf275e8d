//! Whether the host watchdog of a module has tripped, told from its answers. While it has, only commands to the outputs are
//! ignored and everything else is answered as ever, so that an ordinary answer alone shows nothing.

use crate::bus::Frame;
use crate::protocol::dcon;

/// Delimiter and address of a DCON command.
const HEAD: usize = 3;
/// Bit of the status in `!AASS`: tripped (PIR-234 manual 5.1, `~AA0`).
const TRIPPED: u8 = 0x04;

/// What is known of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Watchdog {
    /// The command that was ignored last; `None` if it has not tripped, or was cleared.
    ignored: Option<Vec<u8>>,
}

impl Watchdog {
    pub fn is_tripped(&self) -> bool {
        self.ignored.is_some()
    }

    pub fn ignored(&mut self, request: &[u8]) {
        self.ignored = Some(request.to_vec());
    }

    pub fn answered(&mut self, request: &[u8], answer: &Frame) {
        if self.ignored.as_deref().is_some_and(|ignored| is_alike(ignored, request) || is_clear(request, answer)) {
            self.ignored = None;
        }
    }
}

/// A command of the same form as the one that was ignored is obeyed again.
fn is_alike(ignored: &[u8], request: &[u8]) -> bool {
    ignored.len() == request.len() && ignored.get(..HEAD) == request.get(..HEAD)
}

/// `~AA1` clears it; `~AA0` tells whether it has tripped.
fn is_clear(request: &[u8], answer: &Frame) -> bool {
    match (request.first(), request.get(HEAD)) {
        (Some(b'~'), Some(b'1')) => true,
        (Some(b'~'), Some(b'0')) => status(answer).is_some_and(|status| status & TRIPPED == 0),
        _ => false,
    }
}

fn status(answer: &Frame) -> Option<u8> {
    let found = answer.bytes.get(dcon::find_answer(&answer.bytes)?)?;
    let Ok(dcon::Answer::Valid { text, .. }) = dcon::decode(found, answer.checksum) else { return None };
    u8::from_str_radix(text.get(2..4)?, 16).ok()
}
