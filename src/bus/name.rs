//! The name of a DCON module: it never changes, and no other answer looks like one, so it can be told from all others.

use super::judge::{Content, Expected};
use super::target::Target;
use crate::protocol::{AnswerFrom, Query, dcon};

/// What a DCON module answered when it was asked for its name.
#[derive(Debug, Clone)]
pub struct Name {
    known: Vec<u8>,
    /// Another name, told once: without checksum it may be a damaged one, so only the second time it is believed.
    claimed: Option<Vec<u8>>,
}

impl Name {
    pub fn new(answer: &[u8]) -> Self {
        Self { known: answer.to_vec(), claimed: None }
    }

    /// The whole answer.
    pub fn known(&self) -> &[u8] {
        &self.known
    }

    pub fn hear(&mut self, answer: &[u8]) {
        if answer == self.known {
            self.claimed = None;
        } else if self.claimed.as_deref() == Some(answer) {
            *self = Self::new(answer);
        } else {
            self.claimed = Some(answer.to_vec());
        }
    }

    /// The other name that was told is right.
    pub fn believe(&mut self) {
        if let Some(claimed) = self.claimed.take() {
            self.known = claimed;
        }
    }

    /// What comes back from `target` when it is asked for this name.
    pub fn expected(&self, target: &Target) -> Expected {
        let from = AnswerFrom::Addresses(vec![target.address]);
        Expected::Dcon { checksum: target.checksum, from, content: Content::Name(self.known.clone()) }
    }
}

/// `$AAM` (PIR-234 manual 5.20, PIR-130 manual 2.6).
pub fn question(address: u8) -> String {
    format!("${address:02X}M")
}

pub fn query(address: u8) -> Query {
    Query::Dcon { text: question(address), from: AnswerFrom::Addresses(vec![address]), write: false }
}

/// Whether this DCON command asks for the module's name: an answer that comes late is as good.
pub fn asks_for_name(request: &[u8]) -> bool {
    request.first() == Some(&b'$') && request.get(3) == Some(&b'M')
}

/// Most answers are digits and signs; a name that looks like one of those proves nothing. A checksum is digits too.
pub fn is_name(answer: &[u8]) -> bool {
    let other_than_digits = |c: char| !c.is_ascii_hexdigit() && !matches!(c, '+' | '-' | '.' | ' ');
    dcon::decode(answer, false)
        .is_ok_and(|answer| matches!(answer, dcon::Answer::Valid { text, .. } if text.chars().any(other_than_digits)))
}
