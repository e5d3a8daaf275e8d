//! Raw frames: sent as they are, once.

use super::super::message::{BusEvent, RawRequest, RequestId};
use super::super::target::Patience;
use super::Worker;
use crate::protocol::LineSettings;

impl Worker {
    /// What is sent may be a write, after which a module may store something before it answers; where the user has set a
    /// longer timeout, that is waited.
    pub(super) fn raw(&mut self, id: RequestId, request: &RawRequest, settings: LineSettings) {
        let window = self.patience().window.max(Patience::WRITE_WINDOW);
        let result = self.dialogue().and_then(|dialogue| {
            dialogue.configure(settings)?;
            dialogue.raw(request, window)
        });
        self.note_loss(result.as_ref().err().cloned());
        self.tell(BusEvent::RawAnswer { id, result });
    }
}
